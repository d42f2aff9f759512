//! The directions of views and sources.

use papilio_optics::Beta;

use super::precision::Precision;
use crate::adding::Narrowness;
use crate::layers::LayerKind;
use crate::light::cone_points::{Nodes, Point, cone_points_of, disc_points, smooth_at};
use crate::light::rings::{Peaks, Ring, rings};
use crate::{Cone, Source, Stack};

/// Direction of a view or a source: the number of its extra node, its azimuth, its weight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ray {
    pub(super) extra: usize,
    pub(super) turn: f64,
    pub(super) weight: f64,
    /// Whether it is a whole ring, the same at all azimuths.
    pub(super) is_ring: bool,
}

/// Directions of all views and sources: they share an extra node if they have the same `|beta|`.
#[derive(Debug, Clone, Default)]
pub(super) struct Directions {
    pub(super) beta: Vec<f64>,
    /// For each view, its rays; the weights sum to one.
    pub(super) views: Vec<Vec<Ray>>,
    /// For each view, the additional nodes for the fringes of the base.
    more: Vec<usize>,
    /// For each source, its rays: none for diffuse light.
    pub(super) sources: Vec<Vec<Ray>>,
    /// Whether the views have ledgers.
    pub(super) ledger: bool,
}

impl Directions {
    /// Returns whether these are also the directions of the views over this base: as many of its fringes lie
    /// across them.
    pub(super) fn serve(&self, stack: &Stack, views: &[Cone]) -> bool {
        let now = views.iter().map(|view| nodes_of(stack, view, 0.0).more());
        now.eq(self.more.iter().copied())
    }

    pub(super) fn new(stack: &Stack, views: &[Cone], sources: &[Source], precision: &Precision) -> Self {
        let (scale, digits) = (smoothness(stack), precision.digits);
        // Other effects of a rough interface converge so early that a single direction would be the largest
        // error.
        let rough = |kind: &dyn LayerKind| matches!(kind.narrowness(), Some(Narrowness::Rough { .. }));
        let is_rough = stack.elements().any(|(kind, _)| rough(kind));
        let of_cones = digits + MORE_DIGITS_OF_CONES[usize::from(scale < SMOOTH && !is_rough)];
        // For scattering layers, and for flat ones.
        let at = |cone: &Cone| scale.min(smooth_at(cone, SMOOTH));
        let mut directions = Self::default();
        for view in views {
            let nodes = nodes_of(stack, view, of_cones);
            let rays = directions.rays(&cone_points_of(view, at(view), of_cones, nodes));
            directions.views.push(rays);
            directions.more.push(nodes.more());
        }
        for source in sources {
            let rays = match source {
                Source::Diffuse => Vec::new(),
                Source::Beam(beta) => directions.rays(&[Point { beta: *beta, weight: 1.0 }]),
                Source::Disc(cone) => directions.rays(&disc_points(cone, at(cone), of_cones)),
                Source::Field(field) => {
                    let rings = rings(field, Peaks { views, width: scale }, digits);
                    directions.of_field(&rings, field.is_ring())
                }
            };
            directions.sources.push(rays);
        }
        directions
    }

    fn rays(&mut self, points: &[Point]) -> Vec<Ray> {
        points
            .iter()
            .map(|Point { beta, weight }| Ray {
                extra: self.extra(*beta),
                turn: beta.y.atan2(beta.x),
                weight: *weight,
                is_ring: false,
            })
            .collect()
    }

    fn of_field(&mut self, rings: &[Ring], is_ring: bool) -> Vec<Ray> {
        if !is_ring {
            return rings.iter().flat_map(|ring| self.rays(&ring.points().collect::<Vec<_>>())).collect();
        }
        let whole = |ring: &Ring| {
            let extra = self.extra(Beta { x: ring.radius, y: 0.0 });
            Ray { extra, turn: 0.0, weight: ring.weight(), is_ring: true }
        };
        rings.iter().map(whole).collect()
    }

    fn extra(&mut self, beta: Beta) -> usize {
        // Light at grazing incidence does not need the last digits; it must stay within the disc of air.
        let length = beta.length().min(1.0 - 1e-12);
        self.beta.iter().position(|known| (known - length).abs() < 1e-13).unwrap_or_else(|| {
            self.beta.push(length);
            self.beta.len() - 1
        })
    }
}

/// Returns the nodes that a field of view needs because it sees the fringes of the base by regular light.
/// Each direction takes time, most where layers scatter: beyond these numbers the difference of two levels
/// gives the remaining error.
fn nodes_of(stack: &Stack, view: &Cone, digits: f64) -> Nodes {
    const MOST: f64 = 256.0;
    const MOST_WHERE_LIGHT_SCATTERS: f64 = 32.0;
    let Some(last) = stack.layers.last() else { return Nodes::default() };
    if !stack.base().is_specular() || !stack.elements().all(|(kind, _)| kind.passes_regularly()) {
        return Nodes::default();
    }
    let across = stack.base().nodes_across(view, &last.medium);
    if stack.elements().any(|(kind, _)| kind.scatters()) {
        return Nodes { rings: 0, across: across.min(MOST_WHERE_LIGHT_SCATTERS) };
    }
    Nodes { rings: (digits / DIGITS_OF_A_RING) as usize, across: across.min(MOST) }
}

/// Digits of the rings of a field, so that two levels differ.
const DIGITS_OF_A_RING: f64 = 2.5;

/// Angle over which films and interfaces change, whatever scatters.
const SMOOTH: f64 = 0.3;

/// Natural digits that cones have more than lobes: otherwise a small cone is a single direction at one level
/// and not at the next, and its error is unknown. First where nothing narrow scatters and directions cost
/// little, then for all other stacks.
const MORE_DIGITS_OF_CONES: [f64; 2] = [6.0, 2.0];

/// Returns the distance in direction cosines over which the reflected light changes.
fn smoothness(stack: &Stack) -> f64 {
    let widths = stack.elements().filter_map(|(kind, _)| kind.narrowness()).map(|one| one.smoothness());
    widths.fold(SMOOTH, f64::min)
}

/// Returns the extra nodes of rays, ascending.
pub(super) fn extras(rays: &[Vec<Ray>]) -> Vec<usize> {
    some_extras(rays, |_| true)
}

/// Returns the extra nodes of rays that have an azimuth.
pub(super) fn turned_extras(rays: &[Vec<Ray>]) -> Vec<usize> {
    some_extras(rays, |ray| !ray.is_ring)
}

fn some_extras(rays: &[Vec<Ray>], counts: impl Fn(&Ray) -> bool) -> Vec<usize> {
    let counted = rays.iter().flatten().filter(|ray| counts(ray));
    let mut extras: Vec<usize> = counted.map(|ray| ray.extra).collect();
    extras.sort_unstable();
    extras.dedup();
    extras
}
