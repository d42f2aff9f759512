//! What is prepared of a stack before its base is known.

use std::f64::consts::PI;

use papilio_optics::Beta;
use papilio_optics::lobe::Lobe;

use super::base::Above;
use super::elements::{Element, compose, elements};
use super::grid::{Density, Grid};
use super::part::{Absorbed, Part, nothing};
use super::scatterers::{Scattered, Scatterers};
use crate::adding::quadrature::{Point, cone_points, disc_points};
use crate::{Cone, Diffuser, Interface, Layered, Source};

/// What a level stands for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Precision {
    /// Natural digits of lobes, fields of view and round sources.
    pub(super) digits: f64,
    /// Nodes between two indices, besides those that lobes ask for.
    nodes: usize,
    /// Natural digits of the forward peak beyond the Legendre terms that are kept.
    terms: f64,
    /// Of orders of azimuth.
    pub(super) tolerance: f64,
    /// Of light that goes to and fro between layers and base.
    pub(super) iteration: f64,
}

impl Precision {
    pub(super) fn new(level: u32) -> Self {
        let level = f64::from(level);
        Self {
            digits: 7.0 + 2.0 * level,
            nodes: 8 + (4.0 * level) as usize,
            terms: 3.0 + 1.5 * level,
            tolerance: 1e-6 * (-2.0 * level).exp(),
            iteration: 1e-8 * (-2.0 * level).exp(),
        }
    }

    pub(super) fn legendre_terms(&self, anisotropy: f64) -> usize {
        let g = anisotropy.abs();
        if g < 1e-9 {
            return 1;
        }
        // Wide phase functions cost little: they are kept whole.
        let few = 2 * self.nodes;
        ((self.terms / -g.ln()).ceil() as usize).max(few.min((-25.0 / g.ln()).ceil() as usize)).max(2)
    }
}

/// A direction of a view or a source: the number of its extra node, its azimuth, its weight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ray {
    pub(super) extra: usize,
    pub(super) turn: f64,
    pub(super) weight: f64,
}

/// The directions of all views and sources: they share extra nodes where they have `|beta|` in
/// common.
#[derive(Debug, Clone, Default)]
pub(super) struct Directions {
    pub(super) beta: Vec<f64>,
    /// For each view, its rays; the weights sum to one.
    pub(super) views: Vec<Vec<Ray>>,
    /// For each source, its rays: none for diffuse light.
    pub(super) sources: Vec<Vec<Ray>>,
}

impl Directions {
    pub(super) fn new(stack: &Layered, views: &[Cone], sources: &[Source], precision: &Precision) -> Self {
        let (scale, digits) = (smoothness(stack), precision.digits);
        let mut directions = Self { beta: Vec::new(), views: Vec::new(), sources: Vec::new() };
        for view in views {
            let rays = directions.rays(&cone_points(view, scale, digits));
            directions.views.push(rays);
        }
        for source in sources {
            let points = match source {
                Source::Diffuse => Vec::new(),
                Source::Beam(beta) => vec![Point { beta: *beta, weight: 1.0 }],
                Source::Disc(cone) => disc_points(cone, scale, digits),
            };
            let rays = directions.rays(&points);
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
            })
            .collect()
    }

    fn extra(&mut self, beta: Beta) -> usize {
        // Grazing light has no use for the last digits; it must stay within the air.
        let length = beta.length().min(1.0 - 1e-12);
        self.beta.iter().position(|known| (known - length).abs() < 1e-13).unwrap_or_else(|| {
            self.beta.push(length);
            self.beta.len() - 1
        })
    }
}

/// The distance in direction cosines over which what is seen changes.
fn smoothness(stack: &Layered) -> f64 {
    // Films and faces, whatever scatters.
    let mut scale = 0.3_f64;
    for layer in &stack.layers {
        match &layer.interface {
            Interface::Diffuser(diffuser) => {
                if let Lobe::KCorrelation { width } = diffuser.lobe {
                    scale = scale.min(width);
                }
            }
            Interface::Rough(face) => scale = scale.min(face.alpha()),
            _ => {}
        }
        if let Some(scattering) = layer.medium.scattering() {
            // The phase function's pole lies at this imaginary angle.
            scale = scale.min(-scattering.anisotropy.abs().max(1e-9).ln());
        }
    }
    scale
}

/// Wavelengths at which the layers above the base are alike, and what these do.
#[derive(Debug, Clone)]
pub(super) struct Group {
    pub(super) bins: Vec<usize>,
    pub(super) grid: Grid,
    /// Index of the medium above the base.
    pub(super) index: f64,
    /// By azimuthal order.
    pub(super) orders: Vec<Above>,
    /// Extra nodes of the sources' rays, ascending.
    pub(super) lights: Vec<usize>,
    /// Of light from above at each node, the share that arrives at the base.
    pub(super) arriving: Vec<f64>,
    /// Of light that rises from the base, the share that returns to it.
    pub(super) returning: Vec<f64>,
    /// Of light that rises from the base, the share that leaves.
    pub(super) leaving: Vec<f64>,
    /// Of light from above, the share that leaves without having met the base.
    pub(super) leaving_front: Vec<f64>,
    /// Absorbed shares of light from above and of light that rises from the base.
    pub(super) absorbed: [Absorbed; 2],
}

/// All groups, prepared.
pub(super) fn groups(stack: &Layered, directions: &Directions, precision: &Precision) -> Vec<Group> {
    let mut kinds: Vec<(Vec<u64>, Vec<usize>)> = Vec::new();
    for bin in 0..stack.base.bins() {
        let key = optics(stack, bin);
        match kinds.iter_mut().find(|(known, _)| *known == key) {
            Some((_, bins)) => bins.push(bin),
            None => kinds.push((key, vec![bin])),
        }
    }
    // Groups of the same indices share their nodes, and what scatters.
    let mut families: Vec<(Vec<f64>, Vec<Vec<usize>>)> = Vec::new();
    for (_, bins) in kinds {
        let indices = indices(stack, bins[0]);
        match families.iter_mut().find(|(known, _)| *known == indices) {
            Some((_, family)) => family.push(bins),
            None => families.push((indices, vec![bins])),
        }
    }
    families.into_iter().flat_map(|(_, family)| prepare(stack, family, directions, precision)).collect()
}

/// Indices of all media at a wavelength, air first.
fn indices(stack: &Layered, bin: usize) -> Vec<f64> {
    std::iter::once(1.0).chain(stack.layers.iter().map(|layer| layer.medium.index()[bin])).collect()
}

/// Everything that the layers above the base depend on at a wavelength.
fn optics(stack: &Layered, bin: usize) -> Vec<u64> {
    let mut key = Vec::new();
    for layer in &stack.layers {
        match &layer.interface {
            Interface::Sheet { reflectance, absorptance } => {
                key.extend([reflectance[bin].to_bits(), absorptance[bin].to_bits()]);
            }
            Interface::Coating(_) => key.push(bin as u64),
            Interface::Diffuser(diffuser) => key.push(diffuser.transmittance[bin].to_bits()),
            Interface::Open | Interface::Coated | Interface::Fresnel | Interface::Rough(_) => {}
        }
        key.push(layer.medium.index()[bin].to_bits());
        key.extend(layer.medium.transmittance().map(|t| t[bin].to_bits()));
        key.extend(layer.medium.scattering().map(|s| s.albedo[bin].to_bits()));
    }
    key
}

fn density(stack: &Layered, bin: usize, precision: &Precision) -> Density {
    let mut density = Density { least: precision.nodes, spacing: f64::INFINITY, angle: None };
    for layer in &stack.layers {
        // The trapezoid rule's error for a pole at distance w is exp(-2 pi w/spacing).
        let width = match &layer.interface {
            Interface::Diffuser(Diffuser { lobe: Lobe::KCorrelation { width }, .. }) => *width,
            Interface::Rough(face) => face.alpha(),
            _ => f64::INFINITY,
        };
        density.spacing = density.spacing.min(2.0 * PI * width / precision.digits);
        if let Some(scattering) = layer.medium.scattering() {
            let terms = precision.legendre_terms(scattering.anisotropy) as f64;
            let spacing = PI / terms;
            let index = layer.medium.index()[bin];
            if density.angle.is_none_or(|(_, known)| spacing < known) {
                density.angle = Some((index, spacing));
            }
        }
    }
    density
}

/// Where the nodes of a wavelength are split, ascending.
fn splits(stack: &Layered, bin: usize) -> Vec<f64> {
    let mut splits = indices(stack, bin);
    splits.sort_by(f64::total_cmp);
    splits.dedup();
    splits
}

/// Nodes with weight that the stack takes at most, over its wavelengths.
pub(super) fn nodes_needed(stack: &Layered, precision: &Precision) -> usize {
    let at = |bin| density(stack, bin, precision).total(&splits(stack, bin));
    (0..stack.base.bins()).map(at).max().unwrap_or(0)
}

/// Groups of wavelengths at which all indices are alike.
fn prepare(
    stack: &Layered,
    family: Vec<Vec<usize>>,
    directions: &Directions,
    precision: &Precision,
) -> Vec<Group> {
    let first = family[0][0];
    let index = stack.layers.last().map_or(1.0, |layer| layer.medium.index()[first]);
    let mut grid = Grid::new(&splits(stack, first), density(stack, first, precision), &directions.beta);
    let lights = extras(&directions.sources);
    let mut scatterers = Scatterers::default();
    let mut growing: Vec<Growing<'_>> = family
        .into_iter()
        .map(|bins| {
            let beyond_first = !lights.is_empty();
            let elements = elements(stack, bins[0], &grid, precision, beyond_first, &mut scatterers);
            let convergence = Convergence::new(extras(&directions.views), lights.clone());
            let group = Group {
                bins,
                grid: grid.clone(),
                index,
                orders: Vec::new(),
                lights: lights.clone(),
                arriving: Vec::new(),
                returning: Vec::new(),
                leaving: Vec::new(),
                leaving_front: Vec::new(),
                absorbed: [nothing(0), nothing(0)],
            };
            Growing { group, elements, convergence, stage: Stage::All }
        })
        .collect();
    for order in 0.. {
        let beyond = order >= scatterers.orders().max(1);
        if grid.regular > 0 && (beyond || growing.iter().all(|one| one.stage != Stage::All)) {
            scatterers = scatterers.extras(&grid);
            grid = grid.extras();
        }
        let scattered = scatterers.scattered(order, &grid);
        for one in growing.iter_mut().filter(|one| one.stage != Stage::Done) {
            one.grow(&scattered, order, &grid, precision.tolerance);
        }
        if growing.iter().all(|one| one.stage == Stage::Done) {
            break;
        }
    }
    growing.into_iter().map(|one| one.group).collect()
}

/// A group on its way.
struct Growing<'a> {
    group: Group,
    elements: Vec<Element<'a>>,
    convergence: Convergence,
    stage: Stage,
}

impl Growing<'_> {
    /// Adds an order.
    fn grow(&mut self, scattered: &[Scattered], order: usize, grid: &Grid, tolerance: f64) {
        let part = compose(&self.elements, scattered, order, grid);
        let group = &mut self.group;
        if let Some(absorbed) = &part.absorbed {
            let (air, medium) = (grid.below(1.0), grid.below(group.index));
            group.arriving = part.down.pull_back(&medium, &grid.scale);
            group.returning = part.below.pull_back(&medium, &grid.scale);
            group.leaving = part.down.transposed().pull_back(&air, &grid.scale);
            group.leaving_front = part.above.pull_back(&air, &grid.scale);
            group.absorbed = absorbed.clone();
        }
        group.orders.push(Above::new(&part, &group.lights));
        self.stage = self.convergence.add(&part, tolerance);
    }
}

/// The extra nodes of rays, ascending.
fn extras(rays: &[Vec<Ray>]) -> Vec<usize> {
    let mut extras: Vec<usize> = rays.iter().flatten().map(|ray| ray.extra).collect();
    extras.sort_unstable();
    extras.dedup();
    extras
}

/// How far the orders of azimuth have come.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Stage {
    /// Light takes all ways.
    All,
    /// What is scattered more than once has died down; light is scattered once from a source
    /// towards a view.
    Once,
    /// The rest is below the tolerance.
    Done,
}

/// Whether the orders of azimuth so far suffice between any view and any source.
struct Convergence {
    views: Vec<usize>,
    lights: Vec<usize>,
    /// Sums of what each order can hold, by view and light.
    sums: Vec<f64>,
    /// Orders in a row that added next to nothing, at all and by more than one scattering.
    quiet: [usize; 2],
    order: usize,
}

/// So many orders in a row must be small: one may vanish by chance.
const QUIET_ORDERS: usize = 3;

impl Convergence {
    fn new(views: Vec<usize>, lights: Vec<usize>) -> Self {
        Self { sums: vec![0.0; views.len() * lights.len()], views, lights, quiet: [0; 2], order: 0 }
    }

    /// Adds an order.
    fn add(&mut self, part: &Part, tolerance: f64) -> Stage {
        // Orders fall geometrically, some e^14 from the first to the last: this is what is
        // left after this one, in units of it.
        let rest = 1.0 + self.order as f64 / 14.0;
        let mut quiet = [true; 2];
        let n = part.down.regular;
        let pairs = self.views.iter().flat_map(|v| self.lights.iter().map(move |l| (n + v, n + l)));
        for ((v, l), sum) in pairs.zip(&mut self.sums) {
            let (all, often) = most(part, v, l);
            *sum += all;
            // Said such that what is no number ends it, too.
            quiet[0] &= !(all * rest > tolerance * *sum);
            quiet[1] &= !(often * rest > tolerance * *sum);
        }
        for (count, quiet) in self.quiet.iter_mut().zip(quiet) {
            *count = if quiet { *count + 1 } else { 0 };
        }
        self.order += 1;
        match self.quiet.map(|count| count >= QUIET_ORDERS) {
            [true, _] => Stage::Done,
            _ if self.sums.is_empty() => Stage::Done,
            [false, true] => Stage::Once,
            [false, false] => Stage::All,
        }
    }
}

/// The most that light between two extra nodes can be in this order, over a white base, and
/// that part of it which takes other directions between.
fn most(part: &Part, v: usize, l: usize) -> (f64, f64) {
    let Part { above, below, down, .. } = part;
    let scattered = |i: usize, node: usize| down.at(i, node).abs() + above.at(i, node).abs();
    let between: f64 = (0..down.regular).map(|i| scattered(i, v) * scattered(i, l)).sum();
    let [straight_v, straight_l] = [v, l].map(|node| down.straight[node]);
    let direct = above.at(v, l).abs()
        + straight_v * down.at(v, l).abs()
        + straight_l * down.at(l, v).abs()
        + straight_v * straight_l * below.at(v, l).abs();
    (direct + between, between)
}
