//! The ordinary panel: a diffuser or a bare surface over the base.
//!
//! A bare panel takes closed forms and one-dimensional integrals ([`bare`]). Under a diffuser, the first
//! pass is an integral over the directions in the glass ([`first_pass`]), expressed as weights on the nodes
//! of the pixel's table. Light that the front of screen sends back into the panel is followed on a grid of
//! its own ([`recycling`]). Over a Lambertian base all of this is a kernel of rank one ([`lambertian`]).
//!
//! One number, `digits`, controls all discretisation: every rule is made for an error of `exp(-digits)`, and
//! each level has 3.5 digits more than the one before (a factor of 33).

mod bare;
mod diffused;
pub(crate) mod first_pass;
mod lambertian;
mod ledger;
pub(super) mod lobes;
mod pairs;
mod projected;
mod recycling;
mod rings;

use std::sync::atomic::AtomicBool;

use papilio_optics::lobe::Lobe;

pub(crate) use bare::{diffuse_shares, smooth_points};
pub use diffused::ViewSums;
pub(crate) use lambertian::Shares;

use super::TableGradient;
use crate::{Cone, Diffuser, Estimate, Nodes, Panel, ReflectanceFactor, Reflector, Source, Top};

/// Returns whether recycled light may have a wider lobe than the diffuser's (see [`recycling`]).
pub(super) fn narrows(panel: &Panel) -> bool {
    let Top::Diffuser(Diffuser { lobe: Lobe::KCorrelation { width }, .. }) = &panel.top else { return false };
    *width < recycling::NARROWEST && !panel.single_pass && panel.front.reflectance_below.max() > 0.0
}

/// Returns the largest ratio of the error of a level to its difference from the level before, under a narrow
/// lobe ([`narrows`]); the ratios seen in `tests/transport/narrow_lobes.rs` are in brackets.
pub(super) fn error_over_difference_of_narrow(panel: &Panel, sources: &[Source]) -> f64 {
    const STRONG: f64 = 0.1;
    match &panel.base.reflector {
        // All passes have a closed form, corrected by a grid (6.3).
        Reflector::Specular(table)
            if matches!(table.nodes, Nodes::AnglesInMedium(_) | Nodes::AnglesInAir(_)) =>
        {
            10.0
        }
        // Passes of fields are interpolated between directions; as strict as when they were corrected by a
        // grid.
        _ if sources.iter().any(|source| matches!(source, Source::Field(_))) => 10.0,
        // The second level computes the third pass, too; late ones matter (4.6).
        _ if panel.front.reflectance_below.max() >= STRONG => 6.0,
        // Two passes are exact, and the others weak (3.5).
        Reflector::Specular(_) | Reflector::Lambertian(_) | Reflector::Scattering(_) => 4.0,
    }
}

/// Views of a kernel.
#[derive(Debug, Clone, Copy)]
pub(super) struct Views<'a> {
    pub(super) own: &'a [Cone],
    /// All views that share data; if there are none, its own alone.
    pub(super) together: &'a [Cone],
    /// Kernel with the data that they share.
    pub(super) common: Option<&'a Kernel>,
}

/// Kernel prepared for a stack, its views and its sources.
#[derive(Debug, Clone)]
pub(super) struct Kernel {
    digits: f64,
    kind: Kind,
}

#[derive(Debug, Clone)]
enum Kind {
    Bare(bare::Kernel),
    Diffused(Box<diffused::Kernel>),
}

impl Views<'_> {
    /// Returns the common data of panels with a diffuser.
    fn diffused(&self) -> Option<&diffused::Kernel> {
        match &self.common?.kind {
            Kind::Diffused(kernel) => Some(kernel),
            Kind::Bare(_) => None,
        }
    }
}

/// Digits of a level.
pub(super) fn digits(level: f64) -> f64 {
    11.5 + 3.5 * level
}

impl Kernel {
    pub(super) fn new(level: f64) -> Self {
        Self { digits: digits(level), kind: Kind::Bare(bare::Kernel::default()) }
    }

    /// Prepares views and sources; incomplete if `stop` is set during the computation.
    pub(super) fn prepare(&mut self, stack: &Panel, views: Views<'_>, sources: &[Source], stop: &AtomicBool) {
        match &stack.top {
            Top::IdealAr | Top::Fresnel(_) => {
                self.kind = Kind::Bare(bare::Kernel::new(stack, views.own, sources, self.digits));
            }
            Top::Diffuser(diffuser) => {
                if let Kind::Diffused(kernel) = &mut self.kind
                    && kernel.serves(stack, diffuser)
                {
                    return kernel.prepare(stack, views, sources, stop);
                }
                let mut kernel = diffused::Kernel::new(stack, diffuser, self.digits);
                kernel.prepare(stack, views, sources, stop);
                self.kind = Kind::Diffused(Box::new(kernel));
            }
        }
    }

    /// Returns whether the data prepared for these layers can be used for this base.
    pub(super) fn serves(&self, stack: &Panel) -> bool {
        match (&self.kind, &stack.top) {
            (Kind::Bare(kernel), _) => kernel.serves(stack),
            (Kind::Diffused(kernel), Top::Diffuser(diffuser)) => {
                kernel.serves(stack, diffuser) && kernel.recycling_serves(stack)
            }
            (Kind::Diffused(_), _) => false,
        }
    }

    pub(super) fn estimate(&self, stack: &Panel, view: usize) -> Estimate {
        match (&self.kind, &stack.top) {
            (Kind::Bare(kernel), _) => kernel.estimate(stack, view),
            (Kind::Diffused(kernel), Top::Diffuser(diffuser)) => kernel.estimate(stack, diffuser, view),
            (Kind::Diffused(_), _) => {
                debug_assert!(false, "a kernel is prepared for the panel's top");
                Estimate::default()
            }
        }
    }

    /// Returns the `rho` of an estimate.
    pub(super) fn seen(&self, stack: &Panel, view: usize) -> Vec<ReflectanceFactor> {
        match (&self.kind, &stack.top) {
            (Kind::Diffused(kernel), Top::Diffuser(diffuser)) => kernel.seen(stack, diffuser, view),
            _ => self.estimate(stack, view).rho,
        }
    }

    pub(super) fn pull_back(&self, stack: &Panel, view: usize, seen: &[f64]) -> Option<Vec<TableGradient>> {
        match (&self.kind, &stack.top) {
            (Kind::Diffused(kernel), Top::Diffuser(diffuser)) => {
                kernel.pull_back(stack, diffuser, view, seen)
            }
            _ => None,
        }
    }

    pub(super) fn view_sums(&self, stack: &Panel, view: usize) -> Option<Vec<ViewSums>> {
        match (&self.kind, &stack.top) {
            (Kind::Diffused(kernel), Top::Diffuser(diffuser)) => kernel.view_sums(stack, diffuser, view),
            _ => None,
        }
    }

    pub(super) fn nodes(&self) -> usize {
        match &self.kind {
            Kind::Bare(kernel) => kernel.nodes(),
            Kind::Diffused(kernel) => kernel.nodes(),
        }
    }
}

/// `sum += scale * values`.
#[inline]
fn add_scaled(sum: &mut [f64], values: &[f64], scale: f64) {
    for (s, v) in sum.iter_mut().zip(values) {
        *s += v * scale;
    }
}
