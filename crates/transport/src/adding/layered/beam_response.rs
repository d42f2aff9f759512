//! Light that the views see over one base, accumulated azimuthal order by order, so that operators need not
//! be stored beyond their order.
//!
//! All kernels are reciprocal: the beam that enters against a view's direction gives the light that the view
//! sees of a beam from a source (the kernel towards it). So does the beam that enters from the source. Beams
//! are followed from whichever side has fewer directions.

use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::base::{Above, Block, Ends, Rising};
use super::columns::{BaseColumns, Columns};
use super::diffuse_response::DiffuseResponse;
use super::directions::{Directions, extras};
use super::first_bounce::FirstBounce;
use super::gather::{Gathering, Kernels};
use super::matrix::Matrix;
use super::once::Once;
use super::precision::Precision;
use super::prepare::Group;
use crate::{Base, Estimate, Ledger, ReflectanceFactor, Stack};

/// Light that the views see over one base.
#[derive(Debug)]
pub(super) struct BeamResponse {
    pub(super) base: Base,
    /// The mirrors for s and for p, if they are kept apart below the last scatterer.
    pub(super) mirrors: Option<[Base; 2]>,
    /// Reflectance factors of beams, by view and source.
    beams: Vec<Vec<ReflectanceFactor>>,
    families: Vec<Followed>,
    /// Responses to diffuse light of the same layers over the same base, for views before.
    known: Vec<Seen>,
}

/// Responses of the views to diffuse light, and their ledgers, in a family.
#[derive(Debug, Clone, Default)]
struct Seen {
    /// Wavelengths of each group.
    bins: Vec<Vec<usize>>,
    /// `|beta|` of the views' extra nodes.
    beta: Vec<f64>,
    /// `[group][view]`.
    groups: Vec<Vec<Arc<DiffuseResponse>>>,
}

/// Data of a family of groups of wavelengths.
#[derive(Debug)]
pub(super) struct Followed {
    bins: Vec<Vec<usize>>,
    columns: Vec<Columns>,
    /// Extra nodes of the views, ascending, and of the lights.
    views: Vec<usize>,
    lights: Vec<usize>,
    /// Whether the views have ledgers.
    ledger: bool,
    seen: Seen,
    /// The same of the layers and the base before.
    known: Seen,
    /// Largest densities found so far, `[group][beam][column]`.
    floors: Vec<Vec<Vec<f64>>>,
    /// Number of each group's first column among those of all groups, and of its first wavelength.
    firsts: Vec<[usize; 2]>,
    /// Light of each group that has met the base more than once.
    again: Vec<Again>,
}

/// Light of a group that has met the base more than once, in the orders so far.
#[derive(Debug, Clone, Default)]
struct Again {
    /// All light, by pair of directions: the largest of all columns, summed over the orders.
    sums: Vec<f64>,
    /// Largest light of this order that has met the base more than once, by pair.
    now: Vec<f64>,
    /// Number of successive orders in which it was negligible.
    quiet: usize,
}

/// Number of successive orders in which light must be negligible: it may vanish in one by chance.
const QUIET_ORDERS: usize = 3;

impl Again {
    /// Adds kernels of a pair of directions by column: all light, and that which has met the base once.
    fn add(&mut self, pair: usize, all: &[f64], once: &[f64]) {
        if self.sums.len() <= pair {
            self.sums.resize(pair + 1, 0.0);
            self.now.resize(pair + 1, 0.0);
        }
        let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
        self.sums[pair] += largest(&mut all.iter().map(|x| x.abs()));
        self.now[pair] = largest(&mut all.iter().zip(once).map(|(all, once)| (all - once).abs()));
    }

    /// Ends an order, given the tolerance.
    fn end_order(&mut self, order: usize, tolerance: f64) {
        // What remains of a series that decreases by e^14 up to an order, in units of its last term, as for
        // all light.
        let rest = 1.0 + order as f64 / 14.0;
        let is_small = self.now.iter().zip(&self.sums).all(|(now, sum)| now * rest <= tolerance * sum);
        self.quiet = if is_small && !self.now.is_empty() { self.quiet + 1 } else { 0 };
    }

    /// Returns whether it can be left out of all orders that follow.
    fn is_negligible(&self) -> bool {
        self.quiet >= QUIET_ORDERS
    }
}

impl BeamResponse {
    /// Returns an empty response.
    pub(super) fn new(stack: &Stack, directions: &Directions) -> Self {
        let (states, bins) = (stack.base().states(), stack.base().bins());
        let zeros = |_| ReflectanceFactor::zeros(states, bins);
        let beams = directions.views.iter().map(|_| directions.sources.iter().map(zeros).collect());
        Self {
            base: stack.base().clone(),
            mirrors: stack.mirrors().cloned(),
            beams: beams.collect(),
            families: Vec::new(),
            known: Vec::new(),
        }
    }

    /// Takes over what `before`, a response of the same layers, knows of this base: diffuse light and ledgers
    /// depend on no source.
    pub(super) fn knowing(mut self, before: &Self) -> Self {
        if before.base == self.base && before.mirrors == self.mirrors {
            self.known = before.families.iter().map(|family| family.seen.clone()).collect();
        }
        self
    }

    /// Adds an order of the family added last, or the first of a new one.
    #[allow(clippy::too_many_arguments, reason = "the data of an order, and when to stop")]
    pub(super) fn add(
        &mut self,
        stack: &Stack,
        directions: &Directions,
        order: usize,
        groups: &[&Group],
        above: &[Option<&Above>],
        precision: &Precision,
        stop: &AtomicBool,
    ) {
        if order == 0 {
            let known = self.known.get_mut(self.families.len()).map(std::mem::take).unwrap_or_default();
            self.families.push(Followed::new(stack, directions, groups, known));
        }
        if let Some(family) = self.families.last_mut() {
            let kernels = family.follow(order, groups, above, precision, stop);
            if !stop.load(Ordering::Relaxed) {
                family.gathering(directions, &mut self.beams).add_order(order, &kernels);
            }
        }
    }

    /// Adds the light that one scatterer scatters only once, of the family added last.
    pub(super) fn add_once(
        &mut self,
        directions: &Directions,
        groups: &[&Group],
        once: &Once,
        precision: &Precision,
        stop: &AtomicBool,
    ) {
        if let Some(family) = self.families.last_mut() {
            let above: Vec<Option<&Above>> = once.above.iter().map(Option::as_ref).collect();
            // Any order but the first, which also computes diffuse light.
            let kernels = family.follow(1, groups, &above, precision, stop);
            family.gathering(directions, &mut self.beams).add_once(&kernels, &once.way, stop);
        }
    }

    /// Adds the light that the layers below a rough surface reflect once, of the family added last.
    pub(super) fn add_first(
        &mut self,
        directions: &Directions,
        groups: &[&Group],
        first: &FirstBounce,
        stop: &AtomicBool,
    ) {
        if let Some(family) = self.families.last_mut() {
            let kernels = family.reflect_once(groups, first);
            family.gathering(directions, &mut self.beams).add_first(&kernels, first, stop);
        }
    }

    /// Returns the estimate of a view.
    pub(super) fn estimate(&self, directions: &Directions, view: usize) -> Estimate {
        let ledger = Ledger::zeros(self.base.states(), self.base.bins());
        let mut estimate = Estimate { rho: self.beams[view].clone(), ledger };
        for family in &self.families {
            for ray in &directions.views[view] {
                let number = family.view(ray.extra);
                let groups = family.columns.iter().zip(&family.bins).zip(&family.seen.groups);
                for ((columns, bins), seen) in groups {
                    let Some(seen) = seen.get(number) else { continue };
                    let diffuse = directions.sources.iter().zip(&mut estimate.rho);
                    for (_, rho) in diffuse.filter(|(source, _)| source.is_empty()) {
                        columns.add(&mut rho.via_pixel, &seen.diffuse, ray.weight);
                        bins.iter().for_each(|&bin| rho.front[bin] += ray.weight * seen.diffuse_front);
                    }
                    let Ledger { returned, front, diffuser, glass, pixel, inactive, unaccounted: _ } =
                        &mut estimate.ledger;
                    let books = [returned, front, diffuser, glass, pixel, inactive];
                    for (book, shares) in books.into_iter().zip(&seen.ledger) {
                        columns.add(book, shares, ray.weight);
                    }
                }
            }
        }
        estimate
    }
}

impl Followed {
    fn new(stack: &Stack, directions: &Directions, groups: &[&Group], known: Seen) -> Self {
        let views = extras(&directions.views);
        let beta = views.iter().map(|extra| directions.beta[*extra]).collect();
        let bins: Vec<Vec<usize>> = groups.iter().map(|group| group.bins.clone()).collect();
        let known = if known.bins == bins { known } else { Seen::default() };
        let columns = Columns::new(stack, groups);
        let mut next = [0, 0];
        let first = |(columns, bins): (&Columns, &Vec<usize>)| {
            let first = next;
            next = [next[0] + columns.len(), next[1] + bins.len()];
            first
        };
        Self {
            firsts: columns.iter().zip(&bins).map(first).collect(),
            again: vec![Again::default(); groups.len()],
            columns,
            views,
            lights: extras(&directions.sources),
            ledger: directions.ledger,
            seen: Seen { bins: bins.clone(), beta, groups: vec![Vec::new(); groups.len()] },
            known,
            bins,
            floors: vec![Vec::new(); groups.len()],
        }
    }

    /// Returns the index of a view's extra node.
    fn view(&self, extra: usize) -> usize {
        self.views.binary_search(&extra).unwrap_or_default()
    }

    /// Returns the number of the pair of a view's and a light's extra nodes.
    fn pair(&self, view: usize, light: usize) -> usize {
        view * self.lights.len() + light
    }

    /// Follows beams through an order of every group that has it.
    fn follow(
        &mut self,
        order: usize,
        groups: &[&Group],
        above: &[Option<&Above>],
        precision: &Precision,
        stop: &AtomicBool,
    ) -> Kernels {
        let pairs = self.views.len() * self.lights.len();
        let columns = std::mem::take(&mut self.columns);
        let mut kernels = Kernels {
            base: Matrix::zeros(columns.iter().map(Columns::len).sum(), pairs),
            front: Matrix::zeros(self.bins.iter().map(Vec::len).sum(), pairs),
        };
        // Later orders have no nodes with weight.
        let below = |number: usize, above: &Above| match above.carried() {
            0 => Cow::Owned(columns[number].below.rows_from(groups[number].node(0))),
            _ => Cow::Borrowed(&columns[number].below),
        };
        let each: Vec<(usize, &Above, Cow<'_, Matrix>)> = above
            .iter()
            .enumerate()
            .filter_map(|(number, above)| above.map(|above| (number, above, below(number, above))))
            .collect();
        for block in Block::divide(each.iter().map(|(number, above, below)| (*number, *above, &**below))) {
            if stop.load(Ordering::Relaxed) {
                break;
            }
            self.follow_block(order, &block, (groups, &columns), precision, &mut kernels, stop);
        }
        self.columns = columns;
        kernels
    }

    /// Follows beams through an order of the groups of a block.
    fn follow_block(
        &mut self,
        order: usize,
        block: &Block<'_>,
        (groups, columns): (&[&Group], &[Columns]),
        precision: &Precision,
        kernels: &mut Kernels,
        stop: &AtomicBool,
    ) {
        let ends = Ends { views: &self.views, lights: &self.lights };
        let (is_from_views, beams) = (ends.is_from_views(), ends.beams().to_vec());
        if order == 0 && !is_from_views {
            self.see_all(block, (groups, columns), precision.iteration, stop);
        }
        let once_alone = block.groups().all(|(number, _)| self.again[number].is_negligible());
        for (beam, extra) in beams.iter().enumerate() {
            if stop.load(Ordering::Relaxed) {
                return;
            }
            let mut floor = self.floor(beam, block);
            let rising = block.rise(*extra, precision.iteration, &mut floor, once_alone);
            self.raise_floor(beam, block, &floor);
            if order == 0 && is_from_views {
                for (number, some) in block.groups() {
                    let above = block.above(&some);
                    let rising = Some(rising.some(some));
                    self.see(beam, (number, groups[number], &columns[number]), above, rising);
                }
            }
            self.pass_on(order, block, (groups, columns), (is_from_views, beam), &rising, kernels);
        }
        for (number, _) in block.groups() {
            // Far from the peak, orders nearly cancel each other: the tolerance is that of the iteration.
            self.again[number].end_order(order, precision.iteration);
        }
    }

    /// Returns the largest densities of a beam so far, by column of a block.
    fn floor(&self, beam: usize, block: &Block<'_>) -> Vec<f64> {
        let of_group = |(number, columns): (usize, Range<usize>)| match self.floors[number].get(beam) {
            Some(floor) => floor.clone(),
            None => vec![0.0; columns.len()],
        };
        block.groups().flat_map(of_group).collect()
    }

    fn raise_floor(&mut self, beam: usize, block: &Block<'_>, floor: &[f64]) {
        for (number, columns) in block.groups() {
            let floors = &mut self.floors[number];
            floors.resize_with(floors.len().max(beam + 1), Vec::new);
            floors[beam] = floor[columns].to_vec();
        }
    }

    /// Adds the responses of all views to diffuse light, where beams are followed from the lights.
    fn see_all(
        &mut self,
        block: &Block<'_>,
        (groups, columns): (&[&Group], &[Columns]),
        tolerance: f64,
        stop: &AtomicBool,
    ) {
        if !self.ledger {
            for (number, some) in block.groups() {
                let above = block.above(&some);
                let seen = DiffuseResponse::of_views(
                    groups[number],
                    &columns[number],
                    above,
                    &self.views,
                    tolerance,
                );
                self.seen.groups[number] = seen.into_iter().map(Arc::new).collect();
            }
            return;
        }
        for view in 0..self.views.len() {
            if stop.load(Ordering::Relaxed) {
                return;
            }
            let is_known = block.groups().all(|(number, _)| self.known_response(number, view).is_some());
            let mut floor = vec![0.0; block.columns()];
            let rising = (!is_known).then(|| block.rise(self.views[view], tolerance, &mut floor, false));
            for (number, some) in block.groups() {
                let rising = rising.as_ref().map(|rising| rising.some(some.clone()));
                self.see(view, (number, groups[number], &columns[number]), block.above(&some), rising);
            }
        }
    }

    /// Returns the response of a view to diffuse light, if it is known.
    fn known_response(&self, group: usize, view: usize) -> Option<&Arc<DiffuseResponse>> {
        let known = self.known.beta.iter().position(|beta| *beta == self.seen.beta[view])?;
        self.known.groups.get(group)?.get(known)
    }

    /// Adds the response of a view to diffuse light, unless it is known; `rising` is the light of its beam,
    /// if it is not.
    fn see(
        &mut self,
        view: usize,
        (number, group, columns): (usize, &Group, &Columns),
        above: &Above,
        rising: Option<Rising>,
    ) {
        let known = self.known_response(number, view).map(Arc::clone);
        let new = |rising: &Rising| Arc::new(DiffuseResponse::new(group, columns, above, rising));
        let response = known.or_else(|| rising.as_ref().map(new));
        self.seen.groups[number].extend(response);
    }

    /// Adds the light of a beam that leaves the display to the kernels.
    fn pass_on(
        &mut self,
        order: usize,
        block: &Block<'_>,
        (groups, columns): (&[&Group], &[Columns]),
        (is_from_views, beam): (bool, usize),
        rising: &Rising,
        kernels: &mut Kernels,
    ) {
        let others = if is_from_views { &self.lights } else { &self.views };
        let scattered = block.rising_to(rising, others);
        let met_once = block.met_once(rising, others);
        for (other, to) in others.iter().enumerate() {
            let (view, light) = if is_from_views { (beam, other) } else { (other, beam) };
            let pair = (self.views[view], light);
            let number_of_pair = self.pair(view, light);
            let leaves = |scattered: &[Matrix; 2], some: &Range<usize>| {
                block.leaves(rising, scattered.each_ref().map(|sums| sums.column(other)), pair, *to, some)
            };
            for (number, some) in block.groups() {
                let mut kernel = leaves(&scattered, &some);
                if let Some(met_once) = &met_once {
                    self.again[number].add(number_of_pair, &kernel, &leaves(met_once, &some));
                }
                let dark = kernel.pop().unwrap_or(0.0);
                let (group, columns) = (groups[number], &columns[number]);
                let front = block.above(&some).front(self.views[view], light) + dark;
                let [first, first_bin] = self.firsts[number];
                kernels.front.column_mut(number_of_pair)[first_bin..][..group.bins.len()].fill(front);
                let column = &mut kernels.base.column_mut(number_of_pair)[first..][..columns.len()];
                match &columns.base {
                    BaseColumns::Specular(_) => {
                        column.iter_mut().zip(&kernel).for_each(|(x, value)| *x = value - dark);
                    }
                    BaseColumns::Lambertian(_) if order == 0 => {
                        let seen = &self.seen.groups[number][view];
                        let by_base = seen.by_way_of_base(group, self.lights[light]);
                        column.iter_mut().zip(by_base).for_each(|(x, value)| *x = value);
                    }
                    BaseColumns::Lambertian(_) => {}
                }
            }
        }
    }

    /// Returns the light that the layers below a rough surface reflect once, by pair of directions.
    fn reflect_once(&self, groups: &[&Group], first: &FirstBounce) -> Kernels {
        let factors = first.factors();
        let columns = self.columns.iter().map(Columns::len).sum();
        let mut kernels = Kernels {
            base: Matrix::zeros(columns, factors.columns()),
            front: Matrix::zeros(self.bins.iter().map(Vec::len).sum(), factors.columns()),
        };
        let mut begin = (0, 0);
        for (columns, group) in self.columns.iter().zip(groups) {
            let carried = group.beta.len() - group.extras;
            let below = Matrix::from_fn(carried, columns.below.columns(), |i, c| columns.below[(i, c)]);
            let factors = factors.first_rows(carried);
            let mut seen = Matrix::zeros(below.columns(), factors.columns());
            seen.add_transposed_product(&below, &factors, 1.0);
            for (pair, seen) in seen.columns_mut() {
                let Some((dark, seen)) = seen.split_last() else { continue };
                kernels.front.column_mut(pair)[begin.1..][..group.bins.len()].fill(*dark);
                let base = &mut kernels.base.column_mut(pair)[begin.0..];
                base.iter_mut().zip(seen).for_each(|(base, seen)| *base = seen - dark);
            }
            begin = (begin.0 + columns.len(), begin.1 + group.bins.len());
        }
        kernels
    }

    /// Returns where the kernels of its pairs are added.
    fn gathering<'a>(
        &'a self,
        directions: &'a Directions,
        beams: &'a mut [Vec<ReflectanceFactor>],
    ) -> Gathering<'a> {
        Gathering {
            directions,
            views: &self.views,
            lights: &self.lights,
            places: self.columns.iter().flat_map(|columns| columns.place.iter().copied()).collect(),
            bins: self.bins.iter().flatten().copied().collect(),
            beams,
        }
    }
}
