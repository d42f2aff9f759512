//! Light that the views see over one base, accumulated azimuthal order by order, so that operators need not
//! be stored beyond their order.
//!
//! All kernels are reciprocal: the beam that enters against a view's direction gives the light that the view
//! sees of a beam from a source (the kernel towards it). So does the beam that enters from the source. Beams
//! are followed from whichever side has fewer directions.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::base::{Above, Ends, Rising};
use super::columns::{BaseColumns, Columns};
use super::diffuse_response::DiffuseResponse;
use super::directions::{Directions, extras};
use super::first_bounce::FirstBounce;
use super::gather::{Gathering, Kernels};
use super::matrix::Matrix;
use super::once::Once;
use super::prepare::Group;
use crate::{Base, Estimate, Layered, Ledger, ReflectanceFactor};

/// Light that the views see over one base.
#[derive(Debug)]
pub(super) struct BeamResponse {
    pub(super) base: Base,
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
}

impl BeamResponse {
    /// Returns an empty response.
    pub(super) fn new(stack: &Layered, directions: &Directions) -> Self {
        let (states, bins) = (stack.base.states(), stack.base.bins());
        let zeros = || ReflectanceFactor { via_pixel: vec![0.0; states * bins], front: vec![0.0; bins] };
        let beams = directions.views.iter().map(|_| directions.sources.iter().map(|_| zeros()).collect());
        Self { base: stack.base.clone(), beams: beams.collect(), families: Vec::new(), known: Vec::new() }
    }

    /// Takes over what `before`, a response of the same layers, knows of this base: diffuse light and ledgers depend on
    /// no source.
    pub(super) fn knowing(mut self, before: &Self) -> Self {
        if before.base == self.base {
            self.known = before.families.iter().map(|family| family.seen.clone()).collect();
        }
        self
    }

    /// Adds an order of the family added last, or the first of a new one.
    #[allow(clippy::too_many_arguments, reason = "the data of an order, and when to stop")]
    pub(super) fn add(
        &mut self,
        stack: &Layered,
        directions: &Directions,
        order: usize,
        groups: &[&Group],
        above: &[Option<&Above>],
        tolerance: f64,
        stop: &AtomicBool,
    ) {
        if order == 0 {
            let known = self.known.get_mut(self.families.len()).map(std::mem::take).unwrap_or_default();
            self.families.push(Followed::new(stack, directions, groups, known, tolerance));
        }
        if let Some(family) = self.families.last_mut() {
            let kernels = family.follow(order, groups, above, tolerance, stop);
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
        tolerance: f64,
        stop: &AtomicBool,
    ) {
        if let Some(family) = self.families.last_mut() {
            let above: Vec<Option<&Above>> = once.above.iter().map(Option::as_ref).collect();
            // Any order but the first, which also computes diffuse light.
            let kernels = family.follow(1, groups, &above, tolerance, stop);
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
        let places = self.base.states() * self.base.bins();
        let mut estimate = Estimate { rho: self.beams[view].clone(), ledger: Ledger::zeros(places) };
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
    fn new(stack: &Layered, directions: &Directions, groups: &[&Group], known: Seen, tolerance: f64) -> Self {
        let views = extras(&directions.views);
        let beta = views.iter().map(|extra| directions.beta[*extra]).collect();
        let bins: Vec<Vec<usize>> = groups.iter().map(|group| group.bins.clone()).collect();
        let known = if known.bins == bins { known } else { Seen::default() };
        Self {
            columns: Columns::new(stack, groups, tolerance),
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

    /// Returns the index of the pair of a view's and a light's extra nodes.
    fn pair(&self, view: usize, light: usize) -> usize {
        view * self.lights.len() + light
    }

    /// Follows beams through an order of every group that has it.
    fn follow(
        &mut self,
        order: usize,
        groups: &[&Group],
        above: &[Option<&Above>],
        tolerance: f64,
        stop: &AtomicBool,
    ) -> Kernels {
        let pairs = self.views.len() * self.lights.len();
        let columns = self.columns.iter().map(Columns::len).sum();
        let mut kernels = Kernels {
            base: Matrix::zeros(columns, pairs),
            front: Matrix::zeros(self.bins.iter().map(Vec::len).sum(), pairs),
        };
        let mut first = (0, 0);
        for (number, (group, above)) in groups.iter().zip(above).enumerate() {
            if let Some(above) = above {
                self.follow_group(order, (number, group), above, tolerance, first, &mut kernels, stop);
            }
            first = (first.0 + self.columns[number].len(), first.1 + self.bins[number].len());
        }
        kernels
    }

    #[allow(clippy::too_many_arguments, reason = "the data of a group, and where its results go")]
    fn follow_group(
        &mut self,
        order: usize,
        (number, group): (usize, &Group),
        above: &Above,
        tolerance: f64,
        first: (usize, usize),
        kernels: &mut Kernels,
        stop: &AtomicBool,
    ) {
        let ends = Ends { views: &self.views, lights: &self.lights };
        let (from_views, beams) = (ends.from_views(), ends.beams().to_vec());
        // Later orders have no nodes with weight.
        let extras_alone =
            (above.carried() == 0).then(|| self.columns[number].below.rows_from(group.node(0)));
        if order == 0 && !from_views && !self.ledger {
            let columns = &self.columns[number];
            let seen = DiffuseResponse::of_views(group, columns, above, &self.views, tolerance);
            self.seen.groups[number] = seen.into_iter().map(Arc::new).collect();
        } else if order == 0 && !from_views {
            for view in 0..self.views.len() {
                if stop.load(Ordering::Relaxed) {
                    return;
                }
                self.see(view, (number, group), above, tolerance, None);
            }
        }
        let mut floors = std::mem::take(&mut self.floors[number]);
        for (beam, extra) in beams.iter().enumerate() {
            if stop.load(Ordering::Relaxed) {
                return;
            }
            let below = extras_alone.as_ref().unwrap_or(&self.columns[number].below);
            floors.resize_with(beams.len(), || vec![0.0; below.columns()]);
            let pivots = self.columns[number].pivots.as_ref();
            let rising = above.rise(*extra, below, pivots, tolerance, &mut floors[beam]);
            if order == 0 && from_views {
                self.see(beam, (number, group), above, tolerance, Some(&rising));
            }
            let below = extras_alone.as_ref().unwrap_or(&self.columns[number].below);
            self.pass_on(order, (number, group), (above, below), (from_views, beam), &rising, first, kernels);
        }
        self.floors[number] = floors;
    }

    /// Adds the response of a view to diffuse light, unless it is known; `rising` is the light of its beam, if that
    /// has been followed.
    fn see(
        &mut self,
        view: usize,
        (number, group): (usize, &Group),
        above: &Above,
        tolerance: f64,
        rising: Option<&Rising>,
    ) {
        let known = self.known.beta.iter().position(|beta| *beta == self.seen.beta[view]);
        let known = known.and_then(|view| self.known.groups.get(number)?.get(view));
        let response = known.map(Arc::clone).unwrap_or_else(|| {
            let columns = &self.columns[number];
            let new = |rising: &Rising| Arc::new(DiffuseResponse::new(group, columns, above, rising));
            rising.map(new).unwrap_or_else(|| {
                let mut floor = vec![0.0; columns.below.columns()];
                let pivots = columns.pivots.as_ref();
                new(&above.rise(self.views[view], &columns.below, pivots, tolerance, &mut floor))
            })
        });
        self.seen.groups[number].push(response);
    }

    /// Adds the light of a beam that leaves the display to the kernels.
    #[allow(clippy::too_many_arguments, reason = "a beam, and where its light goes")]
    fn pass_on(
        &self,
        order: usize,
        (number, group): (usize, &Group),
        (above, below): (&Above, &Matrix),
        (from_views, beam): (bool, usize),
        rising: &Rising,
        first: (usize, usize),
        kernels: &mut Kernels,
    ) {
        let columns = &self.columns[number];
        let others = if from_views { &self.lights } else { &self.views };
        let scattered = above.rising_to(rising, others, below);
        for (other, to) in others.iter().enumerate() {
            let (view, light) = if from_views { (beam, other) } else { (other, beam) };
            let pair = (self.views[view], light);
            let sums = scattered.each_ref().map(|sums| sums.column(other));
            let mut kernel = above.leaves(rising, sums, pair, *to, below);
            let dark = kernel.pop().unwrap_or(0.0);
            let front = above.front(self.views[view], light) + dark;
            let pair = self.pair(view, light);
            kernels.front.column_mut(pair)[first.1..][..group.bins.len()].fill(front);
            let column = &mut kernels.base.column_mut(pair)[first.0..][..columns.len()];
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
