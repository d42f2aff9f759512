//! *adding*: the deterministic solver.
//!
//! A [`Kernel`] holds what depends neither on the pixel nor on spectra, for one stack of layers,
//! its views and its sources, at one level of discretisation. An [`Estimate`] through it costs
//! little: new pixels, states, spectra and (of a panel) new fronts of screen.
//!
//! Levels are nested in accuracy: the difference between the estimates of two levels is the
//! coarser one's discretisation error.

mod field;
mod gradient;
mod images;
mod layered;
mod panel;
pub(crate) mod quadrature;

use std::sync::atomic::{AtomicBool, Ordering};

use crate::{Cone, Estimate, ReflectanceFactor, Source, Stack};
pub use gradient::TableGradient;
pub(crate) use layered::{Action, Preparation, rough_width};

/// The finest level.
pub const FINEST: u32 = 6;

/// More radial nodes than this are beyond *adding* ([`nodes_needed`]): a minute, and a gigabyte.
pub const MOST_NODES: usize = 300;

/// Radial nodes that these layers take at a level, besides the directions of views and sources;
/// 0 for a panel, which finds its own. They grow as 1/width of the narrowest lobe, 1/(alpha times the
/// difference of indices) of a rough face and 1/(1 - g) of a phase function; work grows with their cube and more. The caller refuses what takes more than
/// [`MOST_NODES`], or leaves it to the walk.
pub fn nodes_needed(stack: &Stack, level: u32) -> usize {
    match stack {
        Stack::Panel(_) => 0,
        Stack::Layered(layered) => layered::nodes_needed(layered, level),
    }
}

/// The one among all that scatters whose nodes a stack needs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Narrowest {
    /// Which one, counted from the top among what scatters, from 1.
    pub number: usize,
    /// What it is.
    pub scatterer: Narrowness,
}

/// What scatters, by what makes it narrow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Narrowness {
    /// A diffuser's lobe.
    Lobe {
        /// Its width b, direction cosines.
        width: f64,
    },
    /// A face given by its BSDF.
    Face {
        /// That of its narrowest kernel, as of a k-correlation lobe, direction cosines.
        width: f64,
    },
    /// A rough face.
    Rough {
        /// Its roughness.
        alpha: f64,
        /// The narrowest that it refracts light into, direction cosines.
        width: f64,
    },
    /// A medium that scatters in its bulk.
    Slab {
        /// Mean cosine of the scattering angle.
        anisotropy: f64,
    },
}

impl Narrowness {
    /// The distance in direction cosines over which what is seen of it changes.
    fn smoothness(self) -> f64 {
        match self {
            Self::Lobe { width } | Self::Face { width } | Self::Rough { width, .. } => width,
            // The phase function's pole lies at this imaginary angle.
            Self::Slab { anisotropy } => -anisotropy.abs().max(1e-9).ln(),
        }
    }
}

/// What makes a stack need so many nodes ([`nodes_needed`]); none in a panel or where nothing scatters.
pub fn narrowest(stack: &Stack) -> Option<Narrowest> {
    match stack {
        Stack::Panel(_) => None,
        Stack::Layered(layered) => layered::narrowest(layered),
    }
}

/// By how much the difference between two levels must be multiplied to bound the error of the
/// finer one: a rough face's refracted light ends abruptly in direction, and its levels gain as
/// little as a factor of 1.3 (the sum of the differences to come is then up to 4 times the last); what
/// a front sends back through a lobe too narrow for a grid gains 1.2 on the mean, now more and now less (the rest
/// was up to 6.3 times the last in `tests/transport/narrow_lobes.rs`); all others gain 2 or far more.
pub fn error_over_difference(stack: &Stack) -> f64 {
    match stack {
        Stack::Layered(layered) => {
            layered.elements().map(|(kind, _)| kind.error_over_difference()).fold(1.0, f64::max)
        }
        Stack::Panel(panel) if panel::narrows(panel) => 10.0,
        _ => 1.0,
    }
}

/// Prepared angular kernels of one level.
#[derive(Debug, Clone)]
pub struct Kernel {
    level: u32,
    kind: Kind,
}

#[derive(Debug, Clone)]
enum Kind {
    Empty,
    Panel(panel::Kernel),
    Layered(Box<layered::Kernel>),
}

impl Kernel {
    /// An empty kernel of this level, 0 (coarsest) to [`FINEST`].
    pub fn new(level: u32) -> Self {
        Self { level, kind: Kind::Empty }
    }

    /// An empty kernel of the same level.
    pub fn unprepared(&self) -> Self {
        Self::new(self.level)
    }

    /// Makes it ready for these layers, views (cones of directions in air) and sources. What
    /// was prepared before and still serves is kept.
    pub fn prepare(&mut self, stack: &Stack, views: &[Cone], sources: &[Source]) {
        self.prepare_until(stack, views, sources, &AtomicBool::new(false));
    }

    /// The same, given up when `stop` is set, which is looked at many times a second: then it is empty, and this returns false.
    #[must_use]
    pub fn prepare_unless(
        &mut self,
        stack: &Stack,
        views: &[Cone],
        sources: &[Source],
        stop: &AtomicBool,
    ) -> bool {
        self.prepare_until(stack, views, sources, stop);
        let done = !stop.load(Ordering::Relaxed);
        if !done {
            self.kind = Kind::Empty;
        }
        done
    }

    fn prepare_until(&mut self, stack: &Stack, views: &[Cone], sources: &[Source], stop: &AtomicBool) {
        match (stack, &mut self.kind) {
            (Stack::Panel(panel), Kind::Panel(kernel)) => kernel.prepare(panel, views, sources, stop),
            (Stack::Layered(layered), Kind::Layered(kernel)) => kernel.prepare(layered, views, sources, stop),
            (Stack::Panel(panel), kind) => {
                let mut kernel = panel::Kernel::new(self.level);
                kernel.prepare(panel, views, sources, stop);
                *kind = Kind::Panel(kernel);
            }
            (Stack::Layered(layered), kind) => {
                let mut kernel = layered::Kernel::new(self.level);
                kernel.prepare(layered, views, sources, stop);
                *kind = Kind::Layered(Box::new(kernel));
            }
        }
    }

    /// Whether an estimate of this stack, whose layers it was prepared for, needs nothing that is not prepared: a panel's
    /// kernel depends on the nodes of the base's table, and on how much light the base sends back at most; that of any layers on
    /// how many of those nodes lie across a field of view.
    pub fn serves(&self, stack: &Stack) -> bool {
        match (stack, &self.kind) {
            (Stack::Panel(panel), Kind::Panel(kernel)) => kernel.serves(panel),
            (Stack::Layered(layered), Kind::Layered(kernel)) => kernel.serves(layered),
            _ => false,
        }
    }

    /// What is seen from view number `view`; the stack's layers, the views and the sources are
    /// those it was prepared for, its base and spectra may be others.
    pub fn estimate(&self, stack: &Stack, view: usize) -> Estimate {
        self.estimate_unless(stack, view, &AtomicBool::new(false)).unwrap_or_default()
    }

    /// The same; `None` if `stop` was set before it was found. Over another base than the last this can take long.
    pub fn estimate_unless(&self, stack: &Stack, view: usize, stop: &AtomicBool) -> Option<Estimate> {
        let estimate = match (stack, &self.kind) {
            (Stack::Panel(panel), Kind::Panel(kernel)) => kernel.estimate(panel, view),
            (Stack::Layered(layered), Kind::Layered(kernel)) => kernel.estimate(layered, view, stop),
            _ => {
                debug_assert!(false, "a kernel is prepared before it is used");
                Estimate::default()
            }
        };
        (!stop.load(Ordering::Relaxed)).then_some(estimate)
    }

    /// The `rho` of an estimate alone, which costs less: nothing is said of where light ends.
    pub fn seen(&self, stack: &Stack, view: usize) -> Vec<ReflectanceFactor> {
        match (stack, &self.kind) {
            (Stack::Panel(panel), Kind::Panel(kernel)) => kernel.seen(panel, view),
            _ => self.estimate(stack, view).rho,
        }
    }

    /// The gradients, with respect to the table of a specular base, of numbers that change with what is seen: `seen` has shape
    /// `[number][source][state][wavelength]` and tells how each number changes with each source's `rho.base` of an estimate of this stack.
    /// Exact to rounding, and little more work than an estimate. `None` where this has to be found by differences of
    /// estimates: this road is that of a panel's scattered light.
    pub fn pull_back(&self, stack: &Stack, view: usize, seen: &[f64]) -> Option<Vec<TableGradient>> {
        match (stack, &self.kind) {
            (Stack::Panel(panel), Kind::Panel(kernel)) => kernel.pull_back(panel, view, seen),
            _ => None,
        }
    }

    /// Directions at which light is followed: radial nodes, over all views and sources.
    pub fn nodes(&self) -> usize {
        match &self.kind {
            Kind::Empty => 0,
            Kind::Panel(kernel) => kernel.nodes(),
            Kind::Layered(kernel) => kernel.nodes(),
        }
    }
}
