//! Directions of a source and of a view, grouped for the lobe of the diffuser: beams as they are, discs and
//! fields of view as rules of points, fields as circles about the normal. What is computed from them alone
//! (their light on the grid, and fields below the diffuser) is stored with a source.

use papilio_optics::Beta;
use papilio_optics::lobe::Lobe;

use super::super::first_pass::Pass;
use super::super::projected::{Circle, Projected};
use super::super::recycling::{Exact, Group, Lit, Recycling};
use super::Kernel;
use crate::light::cone_points::{Point, disc_points};
use crate::light::rings::{Peaks, Ring, radii, rings};
use crate::{Field, Source};

/// A source: its directions, and its light on the grid and below the diffuser.
#[derive(Debug, Clone)]
pub(super) struct Light {
    pub(super) source: Source,
    pub(super) groups: Vec<Bundle>,
    /// For each index and group.
    pub(super) recycled: Vec<Vec<Group>>,
    /// Of a field: for each index and group its light below the diffuser; empty if that is too large.
    pub(super) projected: Vec<Vec<Projected>>,
}

/// Points that are treated together: all points of a cone, or, where the direction of unscattered light
/// matters, a single point.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Bundle {
    pub(super) axis: Point,
    pub(super) points: Vec<Point>,
    /// Light of a field instead: `points` are then its means over azimuth.
    pub(super) circles: Vec<Circle>,
    /// Whether weights at azimuths equally far from the axis on its two sides are opposite instead of equal.
    pub(super) odd: bool,
}

impl Bundle {
    fn new(axis: Point, points: Vec<Point>) -> Self {
        Self { axis, points, circles: Vec::new(), odd: false }
    }

    /// Returns one part of a field, or of some of its rings.
    fn of_rings(rings: &[Ring], odd: bool) -> Self {
        let at = |radius: f64, weight: f64| Point { beta: Beta { x: radius, y: 0.0 }, weight };
        let axis = at(rings.get(rings.len() / 2).map_or(0.0, |ring| ring.radius), 1.0);
        let circles: Vec<Circle> = rings.iter().map(|ring| Circle::part(ring, odd)).collect();
        let points = circles.iter().map(|circle| at(circle.radius, circle.orders[0])).collect();
        Self { axis, points, circles, odd }
    }

    /// Returns its light for a closed form; `exact` are the passes of points to a view.
    pub(super) fn lit(&self, exact: Exact) -> Lit<'_> {
        if self.circles.is_empty() {
            return Lit::Points(&self.points, exact);
        }
        Lit::Circles(&self.circles, self.odd)
    }

    pub(super) fn azimuth(&self) -> f64 {
        self.axis.beta.y.atan2(self.axis.beta.x)
    }
}

/// Returns the points of each.
pub(super) fn points(bundles: &[Bundle]) -> Vec<&[Point]> {
    bundles.iter().map(|bundle| &bundle.points[..]).collect()
}

impl Kernel {
    /// Returns points for the width of the lobe, together or one by one.
    pub(super) fn bundles(&self, points: Vec<Point>, axis: Point) -> Vec<Bundle> {
        if self.diffuser.regular_fraction == 0.0 || self.table.is_none() {
            return vec![Bundle::new(axis, points)];
        }
        points.into_iter().map(|point| Bundle::new(point, vec![point])).collect()
    }

    pub(super) fn scale(&self) -> f64 {
        match self.diffuser.lobe {
            Lobe::KCorrelation { width } => width.min(SMOOTH),
            Lobe::Lambertian => SMOOTH,
        }
    }

    pub(super) fn light(&self, source: Source) -> Light {
        let groups = match &source {
            Source::Diffuse => Vec::new(),
            Source::Beam(beta) => {
                let point = Point { beta: *beta, weight: 1.0 };
                vec![Bundle::new(point, vec![point])]
            }
            Source::Disc(cone) => {
                let axis = Point { beta: cone.mirrored().axis_towards(), weight: 1.0 };
                self.bundles(disc_points(cone, self.scale(), self.digits), axis)
            }
            Source::Field(field) => self.of_field(field),
        };
        let recycled = self.groups(&groups);
        let projected = if matches!(source, Source::Field(_)) { self.stored(&groups) } else { Vec::new() };
        Light { source, groups, recycled, projected }
    }

    /// Returns the even part of a field and, if it has one, its odd part, together or ring by ring.
    fn of_field(&self, field: &Field) -> Vec<Bundle> {
        let rings = rings(
            field,
            Peaks { views: &self.directions, width: self.width_of_peaks() },
            self.digits - DIGITS_LESS_OF_FIELDS,
        );
        let parts: &[bool] = if field.is_ring() { &[false] } else { &[false, true] };
        let together = self.diffuser.regular_fraction == 0.0 || self.table.is_none();
        // Rings close together see the same reflectance.
        let span = if together { f64::INFINITY } else { SMOOTH / (self.digits - 3.0) };
        let place = |ring: &Ring| (ring.radius / span).floor();
        let close = rings.chunk_by(|one, next| place(one) == place(next));
        close.flat_map(|rings| parts.iter().map(move |odd| Bundle::of_rings(rings, *odd))).collect()
    }

    /// Returns the width of the peaks of a view's response to a field.
    fn width_of_peaks(&self) -> f64 {
        // Light that is scattered twice has a peak of twice the width.
        let passes = if self.diffuser.regular_fraction == 0.0 { 2.0 } else { 1.0 };
        (passes * self.scale()).min(SMOOTH)
    }

    /// Projects a group of a field.
    pub(super) fn projected(&self, pass: &Pass<'_>, bundle: &Bundle) -> Projected {
        let width = self.width_of_peaks();
        let mut views: Vec<f64> = self.directions.iter().flat_map(|view| radii(view, width)).collect();
        views.sort_by(f64::total_cmp);
        views.dedup();
        let lit: Vec<f64> = bundle.circles.iter().map(|circle| circle.radius).collect();
        pass.project(&lit, &views, |_| bundle.circles.clone())
    }

    /// Projects the groups of a field for each index, unless they have too many numbers.
    fn stored(&self, groups: &[Bundle]) -> Vec<Vec<Projected>> {
        let (mut all, mut numbers) = (Vec::new(), 0);
        for pass in (0..self.indices.nodes.len()).filter_map(|index| self.pass(index)) {
            let mut of_index = Vec::with_capacity(groups.len());
            for bundle in groups {
                let projected = self.projected(&pass, bundle);
                numbers += projected.numbers();
                if numbers > MOST_STORED {
                    return Vec::new();
                }
                of_index.push(projected);
            }
            all.push(of_index);
        }
        all
    }

    /// Returns the groups of a source on the grid.
    fn groups(&self, bundles: &[Bundle]) -> Vec<Vec<Group>> {
        let at = |(recycling, index): (&Recycling, &f64)| {
            let group = |b: &Bundle| {
                if b.circles.is_empty() {
                    return recycling.group(&b.points, b.axis, *index, false);
                }
                recycling.group_of_circles(&b.circles, b.odd, b.axis, *index)
            };
            bundles.iter().map(group).collect()
        };
        self.grids().zip(&self.indices.nodes).map(at).collect()
    }
}

/// Most numbers of the projected light of a source that are stored (64 MB); more are computed again for each view.
const MOST_STORED: usize = 1 << 23;

/// Natural digits that the directions of a field have less than everything else: there are many directions,
/// and where their error is large, light is faint.
const DIGITS_LESS_OF_FIELDS: f64 = 4.0;

/// Angle over which reflectances change, whatever the lobe.
const SMOOTH: f64 = 0.3;
