//! Data of a stack that do not depend on its base.

use std::sync::atomic::{AtomicBool, Ordering};

use super::base::{Above, Ends};
use super::beam_response::BeamResponse;
use super::convergence::{Convergence, Stage};
use super::directions::{Directions, extras, turned_extras};
use super::elements::{Elements, elements, scatters_again};
use super::first_bounce::FirstBounce;
use super::grid::Grid;
use super::known::Known;
use super::once::{Once, ScatterMode};
use super::part::{Absorbed, Part};
use super::precision::{Precision, density, rough_surface};
use super::scatterers::{Scattered, Scatterers};
use super::splits::splits;
use super::wavelengths;
use crate::front::Flat;
use crate::{Reflector, Stack};

/// Wavelengths at which the layers above the base are equal, and the operators of these layers.
#[derive(Debug, Clone)]
pub(super) struct Group {
    pub(super) bins: Vec<usize>,
    /// Number of nodes, with weight and extra ones; of the latter alone.
    pub(super) nodes: usize,
    pub(super) extras: usize,
    /// Index of the medium above the base.
    pub(super) index: f64,
    /// `|beta|` of the nodes that the medium below the last scatterer carries.
    pub(super) beta: Vec<f64>,
    /// By azimuthal order: the layers down to the last scatterer; empty if they were not stored.
    pub(super) orders: Vec<Above>,
    /// Flat layers below it, at the same nodes.
    pub(super) lower: Lower,
    /// Extra nodes of the views' and of the sources' rays, ascending.
    pub(super) views: Vec<usize>,
    pub(super) lights: Vec<usize>,
    /// Distribution of the light that falls on the display, and of the light that rises: down to the last
    /// scatterer and from below it; over a Lambertian base, to and from the base.
    pub(super) shares: Shares,
}

/// Flat layers, by node.
#[derive(Debug, Clone, Default)]
pub(super) struct Lower {
    pub(super) flats: Vec<Flat>,
    /// Absorbed fractions of light from above and of light from the base.
    pub(super) absorbed: [Absorbed; 2],
}

/// Fractions of light by where it ends, by node: those with weight that the medium below carries, then the
/// extra ones.
#[derive(Debug, Clone, Default)]
pub(super) struct Shares {
    /// Square root of the weight of each node.
    pub(super) scale: Vec<f64>,
    /// Fraction of light from above that is transmitted.
    pub(super) arriving: Vec<f64>,
    /// Fraction of rising light that returns.
    pub(super) returning: Vec<f64>,
    /// Fraction of rising light that leaves.
    pub(super) leaving: Vec<f64>,
    /// Fraction of light from above that leaves without having been transmitted.
    pub(super) leaving_front: Vec<f64>,
    /// Absorbed fractions of light from above and of rising light.
    pub(super) absorbed: [Absorbed; 2],
}

impl Shares {
    /// Computes the fractions of a part of order 0 above a medium of this index.
    fn new(part: &Part, index: f64, grid: &Grid) -> Self {
        let (air, medium) = (grid.below(1.0), grid.below(index));
        let kept = grid.kept(index);
        let on_kept = |all: Vec<f64>| -> Vec<f64> { kept.iter().map(|&i| all[i]).collect() };
        let absorbed = part.absorbed.clone().unwrap_or_default();
        Self {
            scale: on_kept(grid.scale.clone()),
            arriving: on_kept(part.down.pull_back(&medium, &grid.scale)),
            returning: on_kept(part.below.pull_back(&medium, &grid.scale)),
            leaving: on_kept(part.down.transposed().pull_back(&air, &grid.scale)),
            leaving_front: on_kept(part.above.pull_back(&air, &grid.scale)),
            absorbed: absorbed.map(|places| places.map(on_kept)),
        }
    }
}

impl Lower {
    /// Selects the values of a flat part at these nodes.
    fn new(part: &Part, kept: &[usize]) -> Self {
        let flat = |i: &usize| Flat {
            t: part.down.straight[*i],
            above: part.above.straight[*i],
            below: part.below.straight[*i],
        };
        let absorbed = part.absorbed.clone().unwrap_or_default();
        let on_kept = |all: Vec<f64>| kept.iter().map(|&i| all[i]).collect();
        Self { flats: kept.iter().map(flat).collect(), absorbed: absorbed.map(|places| places.map(on_kept)) }
    }
}

impl Group {
    /// Returns the index of an extra node among its nodes.
    pub(super) fn node(&self, extra: usize) -> usize {
        self.beta.len() - self.extras + extra
    }

    /// Returns the extra nodes between which light is computed.
    pub(super) fn ends(&self) -> Ends<'_> {
        Ends { views: &self.views, lights: &self.lights }
    }

    /// Returns the index of its fractions of light.
    pub(super) fn share(&self, extra: usize) -> usize {
        self.shares.scale.len() - self.extras + extra
    }
}

/// Data prepared of a stack, and the response that its views see over its base.
#[derive(Debug, Clone, Default)]
pub(super) struct Prepared {
    /// Groups of equal indices: they share nodes and scatterers.
    pub(super) families: Vec<Vec<Group>>,
    /// Light scattered once, of each family.
    once: Vec<Vec<Once>>,
    /// Light that the layers below a rough surface reflect once, of each family.
    first: Vec<Option<FirstBounce>>,
    /// Whether the groups store their operators.
    kept: bool,
    /// Kernels for the next preparation.
    known: Known,
    /// The wavelengths that are computed.
    pub(super) wavelengths: Vec<usize>,
}

/// Size in bytes above which operators are not stored.
const MOST_KEPT: usize = 128 << 20;

impl Prepared {
    /// Returns the kernels that the next preparation may use.
    pub(super) fn into_known(self) -> Known {
        self.known
    }

    /// Prepares a stack, with the kernels of the preparation before, and the response `before` if it is that
    /// of the same layers; incomplete if `stop` is set during the computation.
    pub(super) fn new(
        stack: &Stack,
        directions: &Directions,
        precision: &Precision,
        known: &Known,
        before: Option<&BeamResponse>,
        stop: &AtomicBool,
    ) -> (Self, BeamResponse) {
        let mut over = BeamResponse::new(stack, directions);
        if let Some(before) = before {
            over = over.knowing(before);
        }
        let wavelengths = wavelengths::computed(stack, precision.wavelengths);
        let mut prepared = Self { kept: true, wavelengths, ..Self::default() };
        let mut bytes = 0;
        for bins in families(stack, &prepared.wavelengths) {
            let mut add = |order: usize, growing: &mut [Growing<'_>], above: Vec<Option<Above>>| {
                let groups: Vec<&Group> = growing.iter().map(|one| &one.group).collect();
                let each: Vec<Option<&Above>> = above.iter().map(Option::as_ref).collect();
                over.add(stack, directions, order, &groups, &each, precision, stop);
                let sizes = || above.iter().flatten().map(Above::bytes);
                bytes += sizes().map(|[own, _]| own).sum::<usize>()
                    + sizes().map(|[_, shared]| shared).max().unwrap_or(0);
                for (one, above) in growing.iter_mut().zip(above) {
                    one.group.orders.extend(above);
                    if bytes > MOST_KEPT {
                        one.group.orders = Vec::new();
                    }
                }
            };
            let context = Context { stack, directions, precision, known, stop };
            let grid = context.grid(bins[0][0]);
            let (family, once) = prepare(&context, bins, grid.clone(), &mut prepared.known, &mut add);
            let groups: Vec<&Group> = family.iter().collect();
            let first = context.first_bounce(&groups, &grid);
            if let Some(first) = &first {
                over.add_first(directions, &groups, first, stop);
            }
            prepared.first.push(first);
            for once in &once {
                over.add_once(directions, &groups, once, precision, stop);
            }
            prepared.families.push(family);
            prepared.once.push(once);
            if stop.load(Ordering::Relaxed) {
                // They may be incomplete.
                prepared.known = Known::default();
                return (prepared, over);
            }
        }
        prepared.kept = bytes <= MOST_KEPT;
        if !prepared.kept {
            prepared.families.iter_mut().flatten().for_each(|group| group.orders = Vec::new());
            prepared.once.clear();
        }
        (prepared, over)
    }

    /// Returns the response that the views see over another base; incomplete if `stop` is set during the
    /// computation.
    pub(super) fn over(
        &self,
        stack: &Stack,
        directions: &Directions,
        precision: &Precision,
        stop: &AtomicBool,
    ) -> BeamResponse {
        if !self.kept {
            return Self::new(stack, directions, precision, &self.known, None, stop).1;
        }
        let mut over = BeamResponse::new(stack, directions);
        for ((family, once), first) in self.families.iter().zip(&self.once).zip(&self.first) {
            let groups: Vec<&Group> = family.iter().collect();
            for order in 0..family.iter().map(|group| group.orders.len()).max().unwrap_or(0) {
                let above: Vec<Option<&Above>> = family.iter().map(|group| group.orders.get(order)).collect();
                over.add(stack, directions, order, &groups, &above, precision, stop);
            }
            for once in once {
                over.add_once(directions, &groups, once, precision, stop);
            }
            if let Some(first) = first {
                over.add_first(directions, &groups, first, stop);
            }
        }
        over
    }
}

/// Groups some wavelengths by family and group.
fn families(stack: &Stack, wavelengths: &[usize]) -> Vec<Vec<Vec<usize>>> {
    let mut kinds: Vec<(Vec<u64>, Vec<usize>)> = Vec::new();
    for &bin in wavelengths {
        let key = optics(stack, bin);
        match kinds.iter_mut().find(|(known, _)| *known == key) {
            Some((_, bins)) => bins.push(bin),
            None => kinds.push((key, vec![bin])),
        }
    }
    let mut families: Vec<(Vec<f64>, Vec<Vec<usize>>)> = Vec::new();
    for (_, bins) in kinds {
        let indices = indices(stack, bins[0]);
        match families.iter_mut().find(|(known, _)| *known == indices) {
            Some((_, family)) => family.push(bins),
            None => families.push((indices, vec![bins])),
        }
    }
    families.into_iter().map(|(_, family)| family).collect()
}

/// Returns the indices of all media at a wavelength, air first.
pub(super) fn indices(stack: &Stack, bin: usize) -> Vec<f64> {
    std::iter::once(1.0).chain(stack.layers.iter().map(|layer| layer.medium.index()[bin])).collect()
}

/// Returns all data on which the layers above the base depend at a wavelength.
pub(super) fn optics(stack: &Stack, bin: usize) -> Vec<u64> {
    let mut key = Vec::new();
    stack.elements().for_each(|(kind, _)| kind.spectral_key(bin, &mut key));
    key
}

/// Returns the largest number of nodes with weight that the stack takes, over its wavelengths.
pub(super) fn nodes_needed(stack: &Stack, precision: &Precision) -> usize {
    let at = |bin| density(stack, bin, precision).total(&splits(stack, bin));
    (0..stack.base().bins()).map(at).max().unwrap_or(0)
}

/// Receives the operators of an order, for each group that has it.
type AddOrder<'f> = dyn FnMut(usize, &mut [Growing<'_>], Vec<Option<Above>>) + 'f;

/// A stack in preparation.
struct Context<'a> {
    stack: &'a Stack,
    directions: &'a Directions,
    precision: &'a Precision,
    /// Kernels of the preparation before.
    known: &'a Known,
    stop: &'a AtomicBool,
}

impl Context<'_> {
    /// Returns the nodes for wavelengths with the indices of this one.
    fn grid(&self, bin: usize) -> Grid {
        let density = density(self.stack, bin, self.precision);
        Grid::new(&splits(self.stack, bin), density, &self.directions.beta)
    }

    /// Returns the light that layers below a rough surface reflect once, if any do.
    fn first_bounce(&self, groups: &[&Group], grid: &Grid) -> Option<FirstBounce> {
        let face = rough_surface(self.stack)?;
        let specular = matches!(self.stack.base().reflector, Reflector::Specular(_));
        let reflects = |group: &&Group| group.lower.flats.iter().any(|flat| flat.above != 0.0);
        let any = specular || groups.iter().any(reflects);
        any.then(|| FirstBounce::new(face, self.directions, grid, self.precision.digits + 4.0, self.stop))
    }
}

/// Prepares groups of wavelengths at which all indices are equal; `add` receives the operators of each order
/// in turn, `kept` the kernels for the next preparation.
fn prepare(
    context: &Context<'_>,
    family: Vec<Vec<usize>>,
    mut grid: Grid,
    kept: &mut Known,
    add: &mut AddOrder<'_>,
) -> (Vec<Group>, Vec<Once>) {
    let Context { stack, directions, precision, known, stop } = *context;
    let first = family[0][0];
    let index = stack.layers.last().map_or(1.0, |layer| layer.medium.index()[first]);
    let (views, lights) = (extras(&directions.views), extras(&directions.sources));
    // Sources that are the same at all azimuths need only order 0.
    let turned = turned_extras(&directions.sources);
    let turned: Vec<usize> = turned.iter().filter_map(|extra| lights.binary_search(extra).ok()).collect();
    let farthest = |extras: &[usize]| extras.iter().map(|extra| directions.beta[*extra]).fold(0.0, f64::max);
    let turned_extras: Vec<usize> = turned.iter().map(|light| lights[*light]).collect();
    let lambertian = matches!(stack.base().reflector, Reflector::Lambertian(_));
    let first_apart = rough_surface(stack).is_some();
    // Light that a Lambertian base returns has no azimuth.
    let again = || !lambertian || family.iter().any(|bins| scatters_again(stack, bins[0], &grid));
    let beyond_first = (!turned.is_empty() && again()).then(|| [farthest(&views), farthest(&turned_extras)]);
    let mut scatterers = Scatterers::default();
    let mut growing: Vec<Growing<'_>> = family
        .into_iter()
        .map(|bins| {
            let all =
                elements(stack, bins[0], (&grid, precision), beyond_first, known, &mut scatterers, stop);
            let elements = Elements::new(all, stack.base().is_specular());
            let kept = grid.kept(elements.index());
            let group = Group {
                bins,
                nodes: grid.len(),
                extras: directions.beta.len(),
                index,
                beta: kept.iter().map(|&i| grid.beta[i]).collect(),
                orders: Vec::new(),
                lower: Lower::new(&elements.lower(&grid), &kept),
                views: views.clone(),
                lights: lights.clone(),
                shares: Shares::default(),
            };
            let convergence = Convergence::new(views.clone(), turned.clone());
            Growing {
                group,
                elements,
                convergence,
                stage: Stage::All,
                lambertian,
                first_apart,
                ledger: directions.ledger,
                flat: None,
                regular: Vec::new(),
            }
        })
        .collect();
    for order in 0.. {
        let beyond = order >= scatterers.orders().max(1);
        if grid.regular > 0 && (beyond || growing.iter().all(|one| one.stage != Stage::All)) {
            scatterers = scatterers.extras(&grid, kept);
            grid = grid.extras();
        }
        let scattered = scatterers.scattered(order, &grid);
        let grow = |one: &mut Growing<'_>| {
            (one.stage != Stage::Done && !stop.load(Ordering::Relaxed))
                .then(|| one.grow(&scattered, order, &grid, precision.tolerance))
        };
        let above = growing.iter_mut().map(grow).collect();
        add(order, &mut growing, above);
        if stop.load(Ordering::Relaxed) || growing.iter().all(|one| one.stage == Stage::Done) {
            break;
        }
    }
    if stop.load(Ordering::Relaxed) {
        return (growing.into_iter().map(|one| one.group).collect(), Vec::new());
    }
    if grid.regular > 0 {
        scatterers = scatterers.extras(&grid, kept);
        grid = grid.extras();
    }
    let once = if lights.is_empty() { Vec::new() } else { sent_once(scatterers, &grid, &growing) };
    (growing.into_iter().map(|one| one.group).collect(), once)
}

/// Returns the light that scatterers without a closed series scatter once.
fn sent_once(mut scatterers: Scatterers<'_>, grid: &Grid, growing: &[Growing<'_>]) -> Vec<Once> {
    let ways = scatterers.ways();
    let once = |(number, way): (usize, ScatterMode)| {
        let scattered = scatterers.once((number, &way), grid);
        let above = |one: &Growing<'_>| Some(one.above(&scattered, grid));
        Once { above: growing.iter().map(above).collect(), way }
    };
    ways.into_iter().map(once).collect()
}

/// A group in preparation.
struct Growing<'a> {
    group: Group,
    elements: Elements<'a>,
    convergence: Convergence,
    stage: Stage,
    lambertian: bool,
    /// Whether the views have ledgers.
    ledger: bool,
    first_apart: bool,
    /// The layers above the last scatterer, if they are flat: the same in all orders.
    flat: Option<Part>,
    /// Regular part of the last scatterer, on the grid of the order before.
    regular: Vec<Flat>,
}

impl Growing<'_> {
    /// Returns the operators of extra nodes alone, for this set of scatterers.
    fn above(&self, scattered: &[Scattered], grid: &Grid) -> Above {
        // Only order 0 computes absorption.
        let upper = self.elements.upper(scattered, 1, grid);
        self.layers(&upper, (scattered, &self.elements.regular_of_last(grid)), 1, grid, 0)
    }

    /// Returns the operators of the layers down to the last scatterer, below `upper`.
    fn layers(
        &self,
        upper: &Part,
        (scattered, regular): (&[Scattered], &[Flat]),
        order: usize,
        grid: &Grid,
        carried: usize,
    ) -> Above {
        let ends = self.group.ends();
        match self.elements.single(upper, scattered, regular) {
            Some(single) => {
                // The ledger of a view is that of the beam that enters there, which has only order 0.
                let mut entering = ends.beams().to_vec();
                if self.first_apart {
                    entering = (0..self.group.extras).collect();
                } else if order == 0 && self.ledger {
                    entering.extend_from_slice(ends.views);
                    entering.sort_unstable();
                    entering.dedup();
                }
                Above::of_single(&single, ends, entering, carried, grid)
            }
            None => {
                let last = self.elements.last(scattered, order, grid);
                Above::new(upper, &last, ends, carried)
            }
        }
    }

    /// Returns the operators of an order.
    fn grow(&mut self, scattered: &[Scattered], order: usize, grid: &Grid, tolerance: f64) -> Above {
        let known = self.flat.take().filter(|part| part.down.len() == grid.len());
        let upper = known.unwrap_or_else(|| self.elements.upper(scattered, order, grid));
        let index = self.elements.index();
        if self.regular.len() != grid.len() {
            self.regular = self.elements.regular_of_last(grid);
        }
        if order == 0 {
            self.group.shares = self.shares(&upper, scattered, grid);
        }
        let carried = grid.kept(index).len() - (grid.len() - grid.regular);
        let mut above = self.layers(&upper, (scattered, &self.regular), order, grid, carried);
        above.first_apart = self.first_apart;
        self.stage = self.convergence.add(&above, tolerance);
        self.flat = self.elements.flat_above().then_some(upper);
        above
    }

    /// Returns the distribution of light, given the layers above the last scatterer in order 0.
    fn shares(&self, upper: &Part, scattered: &[Scattered], grid: &Grid) -> Shares {
        let index = if self.lambertian { self.group.index } else { self.elements.index() };
        let lower = self.lambertian.then(|| self.elements.lower(grid));
        let returns = |lower: &Part| lower.above.straight.iter().any(|r| *r != 0.0);
        if !lower.as_ref().is_some_and(returns)
            && let Some(single) = self.elements.single(upper, scattered, &self.regular)
        {
            let books = self.elements.absorbed_by_last(single.lost(grid, self.elements.indices()));
            return single.shares(&books, lower.as_ref(), index, grid);
        }
        let part = upper.over(&self.elements.last(scattered, 0, grid), grid);
        Shares::new(&lower.map_or_else(|| part.clone(), |lower| part.over(&lower, grid)), index, grid)
    }
}
