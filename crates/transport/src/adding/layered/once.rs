//! Light that a rough face or a kernel sends once, between a view and a light.
//!
//! Near the horizon such a kernel is as narrow in azimuth as its distance from the horizon: thousands of
//! Fourier orders. But between two given directions its value is known, and what else happens to light on this way, in
//! flat layers and straight through others, does not depend on the azimuth (for bulks, Nakajima & Tanaka, J. Quant. Spectrosc.
//! Radiat. Transfer 40, 51 (1988)). So azimuthal orders hold what is sent more than once, which is smoother; this holds
//! the rest, exactly.

use papilio_optics::rough::{Rough, Side};
use papilio_optics::scatter::Scatter;
use papilio_optics::{Beta, Scatterer};

use super::azimuth;
use super::base::Above;
use super::rough::azimuth_width;

/// A way of one scatterer, and for each group what light that it sends once is multiplied by.
#[derive(Debug, Clone)]
pub(super) struct Once {
    pub(super) way: Way,
    pub(super) above: Vec<Option<Above>>,
}

/// How one scatterer sends light between two extra nodes.
#[derive(Debug, Clone)]
pub(super) struct Way {
    pub(super) kernel: Kernel,
    pub(super) pairs: Pairs,
}

/// What sends.
#[derive(Debug, Clone)]
pub(super) enum Kernel {
    /// A face, from one side to another, by one microfacet.
    Rough { face: Box<Rough>, from: Side, to: Side },
    /// A kernel in a disc of this radius.
    Scatter { scatter: Scatter, disc: f64 },
}

/// Which pairs of extra nodes a pass is about: where light takes another way back, two passes tell them apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Pairs {
    All,
    /// From a node to itself or one that stands later, or the other way.
    Ascending,
    Descending,
}

impl Pairs {
    /// Whether light from one node to another counts.
    pub(super) fn hold(self, from: usize, to: usize) -> bool {
        match self {
            Self::All => true,
            Self::Ascending => from <= to,
            Self::Descending => from > to,
        }
    }
}

impl Way {
    /// The kernel between two extra nodes, by number and `|beta|`, so far apart in azimuth, or its mean over azimuth.
    pub(super) fn density(&self, one: (usize, f64), other: (usize, f64), turn: Option<f64>) -> f64 {
        let [from, to] = if self.pairs.hold(one.0, other.0) { [one.1, other.1] } else { [other.1, one.1] };
        match turn {
            Some(turn) => self.kernel.value(from, to, turn),
            None => self.kernel.mean(from, to),
        }
    }
}

impl Kernel {
    /// Ways with which light that comes back takes those same.
    pub(super) fn pairs(&self) -> &'static [Pairs] {
        let same = match self {
            Self::Rough { from, to, .. } => from == to,
            Self::Scatter { scatter, .. } => scatter.is_reciprocal(),
        };
        if same { &[Pairs::All] } else { &[Pairs::Ascending, Pairs::Descending] }
    }

    fn value(&self, from: f64, to: f64, turn: f64) -> f64 {
        let (sin, cos) = turn.sin_cos();
        let [arrives, leaves] = [Beta { x: from, y: 0.0 }, Beta { x: to * cos, y: to * sin }];
        match self {
            Self::Rough { face, from, to } => face.single(*from, arrives, *to, leaves),
            Self::Scatter { scatter, disc } => {
                let [arrives, leaves] = [arrives, leaves].map(|b| Beta { x: b.x / disc, y: b.y / disc });
                scatter.evaluate(arrives, leaves) / (disc * disc)
            }
        }
    }

    /// Over all azimuths.
    fn mean(&self, from: f64, to: f64) -> f64 {
        let width = match self {
            Self::Rough { face, from: side, to: other } => azimuth_width(face, [(*side, from), (*other, to)]),
            Self::Scatter { scatter, disc } => scatter.azimuth_width(from / disc, to / disc),
        };
        let mut mean = [0.0];
        azimuth::graded(width.clamp(1e-9, 0.4), &mut mean, |turn| self.value(from, to, turn));
        mean[0]
    }
}
