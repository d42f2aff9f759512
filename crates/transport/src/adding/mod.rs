//! *adding*: the deterministic solver.
//!
//! A [`Kernel`] contains the data that depend neither on the pixel nor on spectra, for one stack of layers,
//! its views and its sources, at one level of discretisation. An [`Estimate`] from it takes little time:
//! pixels, states, spectra and (of a panel) the front of screen may change.
//!
//! Accuracy increases with the level: the difference between the estimates of two levels is the
//! discretisation error of the coarser one.

mod azimuthal;
mod layered;
pub mod mirror_lobe;
mod panel;
mod rays;
mod table_sums;

use std::borrow::Cow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

pub use crate::layers::Narrowness;
use crate::{Cone, Estimate, ReflectanceFactor, Source, Stack, WholeView};
pub use layered::{LayeredSpread, NotCovered, PaperLight, Seen};
pub use panel::ViewSums;
pub(crate) use panel::{Shares, diffuse_shares, smooth_points};
pub use table_sums::{TableGradient, TableSums, TableValues};

/// The finest level.
pub const FINEST: u32 = 6;

/// Largest number of radial nodes for which *adding* is practicable ([`nodes_needed`]): a few minutes, and a
/// gigabyte.
pub const MOST_NODES: usize = 450;

/// Largest number of nodes of levels after the second; a result exists without them.
pub const MOST_NODES_OF_FURTHER: usize = 300;

/// Returns the number of radial nodes that these layers take at a level, besides the directions of views and
/// sources; 0 for a panel, and a diffuser above a pixel that depends on azimuth, which determine their own. The number grows as 1/width of the narrowest lobe,
/// 1/(alpha times the difference of indices) of a rough interface and 1/(1 - g) of a phase function; work
/// grows with its cube and more. The caller refuses stacks that take more than [`MOST_NODES`], or uses the
/// Monte Carlo solver.
pub fn nodes_needed(stack: &Stack, level: u32) -> usize {
    if stack.panel().is_some() || azimuthal::applies(stack) { 0 } else { layered::nodes_needed(stack, level) }
}

/// The scatterer that determines the number of nodes of a stack.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Narrowest {
    /// Its number among the scatterers, counted from the top, from 1.
    pub number: usize,
    /// Its narrowness.
    pub scatterer: Narrowness,
}

/// Returns the scatterer that determines the number of nodes of a stack ([`nodes_needed`]); `None` in a
/// panel or where nothing scatters.
pub fn narrowest(stack: &Stack) -> Option<Narrowest> {
    if stack.panel().is_some() { None } else { layered::narrowest(stack) }
}

/// Estimates the work of a level for a diffuser above a pixel that depends on azimuth, in seconds of one processor; `None` where it
/// is not covered, and for all other pixels.
pub fn azimuthal_seconds(stack: &Stack, views: &[Cone], sources: &[Source], level: u32) -> Option<f64> {
    azimuthal::seconds(stack.in_runs(), views, sources, f64::from(level))
}

/// Returns whether these are a diffuser above a pixel that depends on azimuth, as this solver knows them; views and sources may
/// still take too much work ([`azimuthal_seconds`]).
pub fn is_azimuthal(stack: &Stack) -> bool {
    azimuthal::applies(stack.in_runs())
}

/// Returns the factor by which the difference between two levels must be multiplied to bound the error of
/// the finer one. Refracted light of a rough interface ends abruptly in direction, and its error decreases
/// by as little as a factor of 1.3 per level (the sum of the remaining differences is then up to 4 times the
/// last). So does, irregularly, light that a front sends back through a lobe too narrow for a grid. All
/// others gain 2 or far more.
pub fn error_over_difference(stack: &Stack, sources: &[Source]) -> f64 {
    match stack.panel() {
        None => stack.elements().map(|(kind, _)| kind.error_over_difference()).fold(1.0, f64::max),
        Some(panel) if panel::narrows(panel) => panel::error_over_difference_of_narrow(panel, sources),
        Some(_) => 1.0,
    }
}

/// Number of levels of a first answer ([`Kernel::first`]).
pub const FIRST_LEVELS: u32 = 2;

/// Levels by which a level of a first answer is coarser than the next one.
const FIRST_STEP: f64 = 0.7;

/// Prepared angular kernels of one level.
#[derive(Debug, Clone)]
pub struct Kernel {
    /// The level; negative for a first answer.
    level: f64,
    /// Whether its estimates have a ledger.
    ledger: bool,
    kind: Kind,
    /// Views with which its own share data; if there are none, its own alone.
    together: Arc<[Cone]>,
    /// Its own views and the sources, where any light is polarised.
    asked: Arc<(Vec<Cone>, Vec<Source>)>,
    /// Of a kernel of s or of p in polarised light: all that views see.
    rays: Option<Arc<rays::Rays>>,
}

#[derive(Debug, Clone)]
enum Kind {
    Empty,
    Panel(panel::Kernel),
    Layered(Box<layered::Kernel>),
    Azimuthal(Box<azimuthal::Kernel>),
    /// Of a stack that keeps s and p apart: a kernel for each.
    Polarised(Box<[Kernel; 2]>),
}

impl Kernel {
    /// Returns an empty kernel of this level, 0 (coarsest) to [`FINEST`].
    pub fn new(level: u32) -> Self {
        let level = f64::from(level);
        Self {
            level,
            ledger: true,
            kind: Kind::Empty,
            together: Arc::default(),
            asked: Arc::default(),
            rays: None,
        }
    }

    /// Returns an empty kernel of a first answer: number 0 is coarser than number 1, and both are coarser
    /// than level 0. They take a fraction of the work of levels 0 and 1, for an error of some per cent.
    pub fn first(number: u32) -> Self {
        let coarser = f64::from(FIRST_LEVELS.saturating_sub(number));
        Self { level: -FIRST_STEP * coarser, ..Self::new(0) }
    }

    /// Returns an empty kernel of the same level that computes the light of the views alone: their ledgers
    /// are zero. Between general layers many views then take hardly more time than one.
    pub fn without_ledger(self) -> Self {
        Self { ledger: false, kind: Kind::Empty, ..self }
    }

    /// Returns an empty kernel that computes the same as this one once it is prepared.
    pub fn unprepared(&self) -> Self {
        Self { together: Arc::clone(&self.together), ledger: self.ledger, level: self.level, ..Self::new(0) }
    }

    /// Prepares the kernel for these layers, views (cones of directions in air) and sources. Data prepared
    /// before are reused if they are still valid.
    pub fn prepare(&mut self, stack: &Stack, views: &[Cone], sources: &[Source]) {
        let _done = self.prepare_until(stack, (views, None), sources, &AtomicBool::new(false));
    }

    /// Prepares the kernel in the same way, unless `stop` is set, which is tested many times a second: then
    /// the kernel is empty, and this returns false.
    #[must_use]
    pub fn prepare_unless(
        &mut self,
        stack: &Stack,
        views: &[Cone],
        sources: &[Source],
        stop: &AtomicBool,
    ) -> bool {
        self.prepare_until(stack, (views, None), sources, stop)
    }

    /// Prepares the data that kernels of these views share: in a panel the grid of recycled light, the
    /// reflectances there, and the sources. A kernel of some of the views is then prepared from it
    /// ([`prepare_part`](Self::prepare_part)). False if `stop` was set: then the kernel is empty.
    #[must_use]
    pub fn prepare_common(
        &mut self,
        stack: &Stack,
        views: &[Cone],
        sources: &[Source],
        stop: &AtomicBool,
    ) -> bool {
        self.together = views.into();
        self.prepare_until(stack, (&[], None), sources, stop)
    }

    /// Prepares the kernel for some of the views of `common`, a kernel of the same level with the data that
    /// all of them share, for the same stack and sources. What a view shows depends on the others of
    /// this part only within the error of the level: where many are at one inclination, they share what they
    /// see of each azimuthal order. False if `stop` was set: then the kernel is empty.
    #[must_use]
    pub fn prepare_part(
        &mut self,
        common: &Self,
        stack: &Stack,
        views: &[Cone],
        sources: &[Source],
        stop: &AtomicBool,
    ) -> bool {
        self.together = Arc::clone(&common.together);
        self.prepare_until(stack, (views, Some(common)), sources, stop)
    }

    fn prepare_until(
        &mut self,
        stack: &Stack,
        (own, common): (&[Cone], Option<&Self>),
        sources: &[Source],
        stop: &AtomicBool,
    ) -> bool {
        let view = stack.polarised_view();
        let stack = stack.in_runs();
        if view.is_some() || stack.polarised().is_some() {
            self.asked = Arc::new((own.to_vec(), sources.to_vec()));
        }
        if let Some(both) = stack.polarised() {
            let of = |one| view.map_or(Cow::Borrowed(sources), |view| view.sources(sources, Some(one)));
            let seen = view.and_then(|view| view.rays());
            return self.prepare_both(both, (own, common), ([0, 1].map(of), seen), stop);
        }
        let sources = &*view.map_or(Cow::Borrowed(sources), |view| view.sources(sources, None));
        let common = match common.map(|common| &common.kind) {
            Some(Kind::Panel(common)) => Some(common),
            _ => None,
        };
        let views = panel::Views { own, together: &self.together, common };
        match (stack.panel(), &mut self.kind) {
            (Some(panel), Kind::Panel(kernel)) => kernel.prepare(panel, views, sources, stop),
            (None, kind) if azimuthal::applies(stack) => {
                let mut kernel = azimuthal::Kernel::new(self.level, self.ledger);
                kernel.prepare(stack, own, sources, stop);
                *kind = Kind::Azimuthal(Box::new(kernel));
            }
            (None, Kind::Layered(kernel)) => kernel.prepare(stack, own, sources, stop),
            (Some(panel), kind) => {
                let mut kernel = panel::Kernel::new(self.level);
                kernel.prepare(panel, views, sources, stop);
                *kind = Kind::Panel(kernel);
            }
            (None, kind) => {
                let mut kernel = layered::Kernel::new(self.level, self.ledger);
                kernel.prepare(stack, own, sources, stop);
                *kind = Kind::Layered(Box::new(kernel));
            }
        }
        let done = !stop.load(Ordering::Relaxed);
        if !done {
            self.kind = Kind::Empty;
        }
        done
    }

    /// Prepares a kernel for each polarisation.
    fn prepare_both(
        &mut self,
        both: &[Stack; 2],
        (own, common): (&[Cone], Option<&Self>),
        (sources, seen): ([Cow<'_, [Source]>; 2], Option<&WholeView>),
        stop: &AtomicBool,
    ) -> bool {
        let common = match common.map(|common| &common.kind) {
            Some(Kind::Polarised(common)) => Some(common),
            _ => None,
        };
        let mut kernels = match std::mem::replace(&mut self.kind, Kind::Empty) {
            Kind::Polarised(kernels) => kernels,
            _ => Box::new([self.unprepared(), self.unprepared()]),
        };
        let mut done = true;
        for (number, (kernel, stack)) in kernels.iter_mut().zip(both).enumerate() {
            kernel.together = Arc::clone(&self.together);
            let common = common.map(|common| &common[number]);
            done = done && kernel.prepare_until(stack, (own, common), &sources[number], stop);
            let lit = (own, &*sources[number]);
            let rays = |seen| rays::Rays::new(stack, lit, (seen, number), panel::digits(self.level));
            kernel.rays = seen.map(rays).map(Arc::new);
        }
        if done {
            self.kind = Kind::Polarised(kernels);
        }
        done
    }

    /// Returns the kernels of s and p with their stacks, if the stack keeps them apart.
    pub fn polarised<'a>(&'a self, stack: &'a Stack) -> Option<[(&'a Self, &'a Stack); 2]> {
        match (&self.kind, stack.polarised()) {
            (Kind::Polarised(kernels), Some([s, p])) => Some([(&kernels[0], s), (&kernels[1], p)]),
            _ => None,
        }
    }

    /// Returns the weights of s and of p in what this view sees of each source, if the stack keeps them apart.
    pub fn weights_by_source(&self, stack: &Stack, view: usize) -> Vec<[f64; 2]> {
        let (views, sources) = &*self.asked;
        stack.weights_by_source(views.get(view), sources)
    }

    /// Returns whether an estimate of this stack, for whose layers it was prepared, needs no further
    /// preparation. A panel's kernel depends on the nodes of the base's table, and on the largest fraction
    /// of light that the base sends back; that of general layers on how many of those nodes lie across a
    /// field of view.
    pub fn serves(&self, stack: &Stack) -> bool {
        let stack = stack.in_runs();
        if let Some(both) = self.polarised(stack) {
            return both.iter().all(|(kernel, stack)| kernel.serves(stack));
        }
        if self.rays.as_ref().is_some_and(|rays| !rays.serve(stack)) {
            return false;
        }
        match (stack.panel(), &self.kind) {
            (Some(panel), Kind::Panel(kernel)) => kernel.serves(panel),
            (None, Kind::Layered(kernel)) => kernel.serves(stack) && !azimuthal::applies(stack),
            (None, Kind::Azimuthal(kernel)) => kernel.serves(stack),
            _ => false,
        }
    }

    /// Returns the estimate of view number `view`. The layers of the stack, the views and the sources must
    /// be those for which the kernel was prepared; base and spectra may differ.
    pub fn estimate(&self, stack: &Stack, view: usize) -> Estimate {
        self.estimate_unless(stack, view, &AtomicBool::new(false)).unwrap_or_default()
    }

    /// Returns the same estimate; `None` if `stop` was set during the computation. Over another base than
    /// the last this can take long.
    pub fn estimate_unless(&self, stack: &Stack, view: usize, stop: &AtomicBool) -> Option<Estimate> {
        let lit = stack;
        let stack = stack.in_runs();
        if let Some(both) = self.polarised(stack) {
            let [s, p] = both.map(|(kernel, stack)| kernel.estimate_unless(stack, view, stop));
            let weights = self.weights_by_source(lit, view);
            return Some(s?.mixed_with(&p?, &weights, lit.weights_of_polarisations()));
        }
        let mut estimate = match (stack.panel(), &self.kind) {
            (Some(panel), Kind::Panel(kernel)) => kernel.estimate(panel, view),
            (None, Kind::Layered(kernel)) => kernel.estimate(stack, view, stop),
            (None, Kind::Azimuthal(kernel)) => kernel.estimate(stack, view, stop),
            _ => {
                debug_assert!(false, "a kernel is prepared before it is used");
                Estimate::default()
            }
        };
        match &self.rays {
            Some(rays) => estimate.rho = rays.seen(lit, view),
            None => self.change(lit, view, &mut estimate.rho),
        }
        (!stop.load(Ordering::Relaxed)).then_some(estimate)
    }

    /// Changes the light that a view sees to that of polarised sources, and through a polariser.
    fn change(&self, stack: &Stack, view: usize, rho: &mut Vec<ReflectanceFactor>) {
        let (Some(polarised), Some(view)) = (stack.polarised_view(), self.asked.0.get(view)) else { return };
        if let Some(changes) = polarised.changes(view, &self.asked.1) {
            changes.apply(rho);
        }
    }

    /// Returns only the `rho` of an estimate, which takes less time: the ledger is not computed.
    pub fn seen(&self, stack: &Stack, view: usize) -> Vec<ReflectanceFactor> {
        let lit = stack;
        let stack = stack.in_runs();
        if let Some(both) = self.polarised(stack) {
            let [s, p] = both.map(|(kernel, stack)| kernel.seen(stack, view));
            let weights = self.weights_by_source(lit, view);
            return s.iter().zip(&p).zip(weights).map(|((s, p), weights)| s.mixed_with(p, weights)).collect();
        }
        if let Some(rays) = &self.rays {
            return rays.seen(lit, view);
        }
        match (stack.panel(), &self.kind) {
            (Some(panel), Kind::Panel(kernel)) => {
                let mut rho = kernel.seen(panel, view);
                self.change(lit, view, &mut rho);
                rho
            }
            _ => self.estimate(lit, view).rho,
        }
    }

    /// Returns the same; `None` if `stop` was set during the computation.
    pub fn seen_unless(
        &self,
        stack: &Stack,
        view: usize,
        stop: &AtomicBool,
    ) -> Option<Vec<ReflectanceFactor>> {
        match &self.kind {
            Kind::Panel(_) => Some(self.seen(stack, view)),
            _ => Some(self.estimate_unless(stack, view, stop)?.rho),
        }
    }

    /// Returns the gradients, with respect to the table of a specular base, of numbers that depend on the
    /// reflectance factors: `seen` has shape `[number][source][state][wavelength]` and contains the
    /// derivative of each number by each source's `rho.base` of an estimate of this stack. Exact to
    /// rounding, and little more work than an estimate. `None` if the gradients must be found by differences
    /// of estimates: this method covers the scattered light of a panel.
    pub fn pull_back(&self, stack: &Stack, view: usize, seen: &[f64]) -> Option<Vec<TableGradient>> {
        match (stack.panel(), &self.kind) {
            (Some(panel), Kind::Panel(kernel)) => kernel.pull_back(panel, view, seen),
            _ => None,
        }
    }

    /// Returns what a view sees as a function of few sums over the base's table, for each index of a
    /// dispersive medium: its light is the sum over them. `None` where [`pull_back`](Self::pull_back) returns
    /// none, and where recycled light depends on the reflectance at single angles.
    pub fn view_sums(&self, stack: &Stack, view: usize) -> Option<Vec<ViewSums>> {
        match (stack.panel(), &self.kind) {
            (Some(panel), Kind::Panel(kernel)) => kernel.view_sums(panel, view),
            _ => None,
        }
    }

    /// Returns the number of directions at which light is followed: radial nodes, over all views and
    /// sources.
    pub fn nodes(&self) -> usize {
        match &self.kind {
            Kind::Empty => 0,
            Kind::Panel(kernel) => kernel.nodes(),
            Kind::Layered(kernel) => kernel.nodes(),
            Kind::Azimuthal(kernel) => kernel.nodes(),
            Kind::Polarised(kernels) => kernels.iter().map(Self::nodes).sum(),
        }
    }
}
