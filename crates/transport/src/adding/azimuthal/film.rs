//! The diffuser on its glass, and the directions of light above it.

use std::f64::consts::PI;

use papilio_optics::lobe::Lobe;
use papilio_optics::{Beta, Scatterer};

use super::grid::Grid;
use super::{DIGITS, FEWER_DIGITS};
use crate::adding::panel::lobes::poles;
use crate::layers::{LobeReflection, ReflectedLobe};
use crate::light::cone_points::{Nodes as ConeNodes, Point, cone_points_of, disc_points, smooth_at};
use crate::light::rings::{Peaks, Ring, rings};
use crate::numerics::quadrature::{Pole, radial};
use crate::{AngularTable, Base, Cone, Diffuser, Interface, Layer, Medium, Nodes, Source, Stack};

/// Angle over which the pixel changes, in direction cosines.
const SMOOTH: f64 = 0.3;

/// Reflectance of the diffuser from below beyond which orders decrease too slowly.
const MOST_RETURNED: f64 = 0.9;

/// The diffuser on its glass.
#[derive(Debug, Clone)]
pub(super) struct Film {
    pub(super) diffuser: Diffuser,
    /// What it reflects from above and from below.
    pub(super) sides: [Option<LobeReflection>; 2],
    pub(super) medium: Medium,
    pub(super) index: f64,
}

/// Light of a source, or of a view, above the diffuser.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Light {
    Diffuse,
    /// Directions with their weights.
    Points(Vec<Point>),
}

impl Film {
    /// The only layer of a stack; `None` if it is not covered.
    pub(super) fn of(stack: &Stack) -> Option<Self> {
        let [Layer { interface, medium, .. }] = &stack.layers[..] else { return None };
        if !stack.base().is_azimuthal() || medium.transmittance().is_some() || medium.scattering().is_some() {
            return None;
        }
        let (through, sides) = match interface {
            Interface::Reflecting(film) => (film.transmission(), film.reflections().clone()),
            other => (other, [None, None]),
        };
        let Interface::Diffuser(diffuser) = through else { return None };
        let is_lobe = |side: &LobeReflection| matches!(side.lobe(), ReflectedLobe::Lobe(_));
        let [_, below] = &sides;
        let is_left_out = below
            .as_ref()
            .is_some_and(|below| below.shares()[1] > 0.0 || below.scattered().max() > MOST_RETURNED);
        (sides.iter().flatten().all(is_lobe) && !is_left_out).then_some(Self {
            diffuser: diffuser.clone(),
            sides,
            index: medium.constant_index()?,
            medium: medium.clone(),
        })
    }

    /// Width of the narrowest lobe below it.
    pub(super) fn width(&self) -> f64 {
        let width = |lobe: Lobe| match lobe {
            Lobe::KCorrelation { width } => width,
            Lobe::Lambertian => SMOOTH,
        };
        [Some(self.diffuser.lobe), self.lobe_back()].into_iter().flatten().map(width).fold(SMOOTH, f64::min)
    }

    /// Width of the narrowest lobe, that of the light which it reflects above, too.
    pub(super) fn narrowest(&self) -> f64 {
        match self.sides[0].as_ref().map(LobeReflection::lobe) {
            Some(ReflectedLobe::Lobe(Lobe::KCorrelation { width })) => self.width().min(*width),
            _ => self.width(),
        }
    }

    /// Directions of views; regular light resolves the table of the pixel.
    pub(super) fn views(&self, base: &Base, views: &[Cone], digits: f64) -> Vec<Vec<Point>> {
        let scale = |view: &Cone| self.narrowest().min(smooth_at(view, SMOOTH));
        let across =
            |view: &Cone| if self.regular() > 0.0 { base.nodes_across(view, &self.medium) } else { 0.0 };
        let points = |view: &Cone| {
            cone_points_of(view, scale(view), digits, ConeNodes { rings: 0, across: across(view) })
        };
        views.iter().map(points).collect()
    }

    /// Directions of the sources; diffuse light has none.
    pub(super) fn points_of(&self, sources: &[Source], views: &[Cone], digits: f64) -> Vec<Vec<Point>> {
        let points = |source: &Source| match source {
            Source::Beam(beta) => vec![Point { beta: *beta, weight: 1.0 }],
            Source::Disc(cone) => disc_points(cone, self.narrowest().min(smooth_at(cone, SMOOTH)), digits),
            Source::Field(field) => {
                let rings = rings(field, Peaks { views, width: self.narrowest() }, digits);
                rings.iter().flat_map(Ring::points).collect()
            }
            Source::Diffuse => Vec::new(),
        };
        sources.iter().map(points).collect()
    }

    /// Radii of points, without those that are equal to a lobe.
    pub(super) fn radii<'a>(&self, points: impl Iterator<Item = &'a Vec<Point>>) -> Vec<f64> {
        let same = 0.1 * self.width();
        let mut radii: Vec<f64> = points.flatten().map(|point| point.beta.length()).collect();
        radii.sort_unstable_by(f64::total_cmp);
        radii.dedup_by(|a, b| (*a - *b).abs() < same);
        radii
    }

    /// The lobe of light that is sent back down.
    pub(super) fn lobe_back(&self) -> Option<Lobe> {
        match self.sides[1].as_ref()?.lobe() {
            ReflectedLobe::Lobe(lobe) => Some(*lobe),
            ReflectedLobe::Kernel(_) => None,
        }
    }

    pub(super) fn regular(&self) -> f64 {
        self.diffuser.regular_fraction
    }

    /// Light that arrives in a direction below a diffuser that transmits everything; of points, what is scattered.
    #[inline(always)]
    pub(super) fn arrives(&self, light: &Light, beta: Beta) -> f64 {
        let (lobe, regular) = (self.diffuser.lobe, self.regular());
        match light {
            Light::Diffuse => {
                let length = beta.length();
                let straight = if length <= 1.0 { regular } else { 0.0 };
                straight + (1.0 - regular) * lobe.fraction_in_disc(length, 1.0)
            }
            Light::Points(points) => {
                let of = |point: &Point| point.weight * lobe.evaluate(point.beta, beta);
                (1.0 - regular) * points.iter().map(of).sum::<f64>()
            }
        }
    }

    /// All light that arrives of a view.
    pub(super) fn arrives_in_all(&self, points: &[Point]) -> f64 {
        let lobe = self.diffuser.lobe;
        let of = |point: &Point| {
            let scattered = lobe.fraction_in_disc(point.beta.length(), self.index);
            point.weight * (self.regular() + (1.0 - self.regular()) * scattered)
        };
        points.iter().map(of).sum()
    }

    /// What the lobe sends back of light from one direction to another, per unit of its reflectance.
    pub(super) fn sends_back(&self, lobe: Lobe, from: Beta, to: Beta) -> f64 {
        match lobe {
            Lobe::KCorrelation { .. } => lobe.evaluate(from, to),
            Lobe::Lambertian => (PI * self.index * self.index).recip(),
        }
    }

    /// Light that it reflects above, over that of a source, by wavelength.
    pub(super) fn front(&self, view: &[Point], light: &Light) -> Vec<f64> {
        let bins = self.diffuser.transmittance.len();
        let Some(above) = &self.sides[0] else { return vec![0.0; bins] };
        match light {
            Light::Diffuse => {
                let of = |bin: usize| {
                    view.iter().map(|v| v.weight * above.returned(bin, v.beta.length(), 1.0)).sum()
                };
                (0..bins).map(of).collect()
            }
            Light::Points(points) => {
                let pairs = view.iter().flat_map(|v| points.iter().map(move |l| (v, l)));
                let density = |(v, l): (&Point, &Point)| v.weight * l.weight * above.density(v.beta, l.beta);
                let sum: f64 = pairs.map(density).sum();
                above.scattered().iter().map(|scattered| PI * scattered * sum).collect()
            }
        }
    }

    /// The grid of light between points of these radii, with as many azimuths as `more` harmonics take, too.
    pub(super) fn grid(
        &self,
        lobes: &[Lobe],
        radii: &[f64],
        nodes: &Nodes,
        (digits, more): (f64, usize),
    ) -> Grid {
        let (mut sharp, mut breaks) = (Vec::new(), nodes.breaks(self.index));
        if matches!(nodes.of_inclination(), Nodes::AnglesInAir(_)) {
            // The angle in air has a square root on the rim.
            sharp.push(Pole { at: 1.0, off: 0.0 });
        }
        for lobe in lobes {
            radii.iter().for_each(|radius| poles(*lobe, *radius, &mut sharp));
            poles(*lobe, 1.0, &mut sharp);
        }
        breaks.push(1.0);
        let rings = radial(self.index, &breaks, &sharp, digits);
        let farthest = radii.iter().copied().fold(0.0, f64::max);
        // The trapezoid rule over the azimuth errs by exp(-azimuths x distance of the pole).
        let distance = (self.width() / farthest.max(1e-6)).asinh();
        let azimuths = (digits / distance).ceil() as usize + more;
        Grid { rings, azimuths: azimuths.next_multiple_of(2).max(8) }
    }

    /// The grid of the first order.
    pub(super) fn grid_of(&self, table: &AngularTable, radii: &[f64], digits: f64) -> Grid {
        self.grid(&[self.diffuser.lobe], radii, &table.nodes, (digits, table.harmonics()))
    }

    /// The grid of further orders, with their number of azimuthal orders.
    pub(super) fn grid_back(
        &self,
        table: &AngularTable,
        lobe: Lobe,
        radii: &[f64],
        digits: f64,
    ) -> (Grid, usize) {
        let digits = (digits - FEWER_DIGITS).max(DIGITS[2]);
        let lobes = [self.diffuser.lobe, lobe];
        let grid = self.grid(&lobes, radii, &Nodes::Constant, (digits, table.harmonics()));
        let orders = match lobe {
            Lobe::KCorrelation { .. } => grid.azimuths / 2,
            Lobe::Lambertian => 1,
        };
        (grid, orders)
    }

    /// Multiplies columns by the reflectance from below.
    pub(super) fn times_reflectance(&self, values: &mut [f64], bins: usize) {
        let Some(below) = &self.sides[1] else { return values.fill(0.0) };
        let rows = values.chunks_exact_mut(bins);
        rows.for_each(|row| row.iter_mut().zip(below.scattered().iter()).for_each(|(value, r)| *value *= r));
    }
}

/// Reflectance of the pixel, `[state][wavelength]`.
pub(super) fn reflectance(table: &AngularTable, film: &Film, beta: Beta) -> Vec<f64> {
    let mut out = vec![0.0; table.state_count() * table.common.len()];
    table.reflectance_towards(beta, &film.medium, &mut out);
    out
}
