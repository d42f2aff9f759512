//! Light that a rough interface or a kernel scatters once, between a view and a source.
//!
//! Near the horizon such a kernel is as narrow in azimuth as its distance from the horizon: thousands of
//! Fourier orders. But between two given directions its value is known, and the other factors on this path,
//! flat layers and the regular transmittance of other scatterers, do not depend on the azimuth (for
//! scattering media, Nakajima & Tanaka, J. Quant. Spectrosc. Radiat. Transfer 40, 51 (1988)). So azimuthal
//! orders contain the light that is scattered more than once, which is smoother; this module computes the
//! rest, exactly.

use papilio_optics::rough::{Rough, Side};
use papilio_optics::scatter::Scatter;
use papilio_optics::{Beta, Scatterer};

use super::azimuth;
use super::base::Above;
use super::rough::azimuth_width;

/// One mode of scattering of one scatterer, and for each group the factors of light that it scatters once.
#[derive(Debug, Clone)]
pub(super) struct Once {
    pub(super) way: ScatterMode,
    pub(super) above: Vec<Option<Above>>,
}

/// Scattering of one scatterer between two extra nodes.
#[derive(Debug, Clone)]
pub(super) struct ScatterMode {
    pub(super) kernel: Kernel,
    pub(super) pairs: Pairs,
}

/// Kernel of the scattering.
#[derive(Debug, Clone)]
pub(super) enum Kernel {
    /// A rough interface, from one side to another, by one microfacet.
    Rough { face: Box<Rough>, from: Side, to: Side },
    /// A kernel in a disc of this radius.
    Scatter { scatter: Scatter, disc: f64 },
}

/// Pairs of extra nodes to which a pass applies: if light returns by another path, two passes distinguish
/// them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Pairs {
    All,
    /// From a node to itself or a later one, or the reverse.
    Ascending,
    Descending,
}

impl Pairs {
    /// Returns whether light from one node to another is included.
    pub(super) fn hold(self, from: usize, to: usize) -> bool {
        match self {
            Self::All => true,
            Self::Ascending => from <= to,
            Self::Descending => from > to,
        }
    }
}

impl ScatterMode {
    /// Returns the kernel between two extra nodes, given by number and `|beta|`, at this difference in
    /// azimuth, or its mean over azimuth.
    pub(super) fn density(&self, one: (usize, f64), other: (usize, f64), turn: Option<f64>) -> f64 {
        let [from, to] = if self.pairs.hold(one.0, other.0) { [one.1, other.1] } else { [other.1, one.1] };
        match turn {
            Some(turn) => self.kernel.value(from, to, turn),
            None => self.kernel.mean(from, to),
        }
    }
}

impl Kernel {
    /// Returns the pairs of the passes: one if light that returns takes the same path.
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

    /// Returns the mean over all azimuths.
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
