//! What a layer does to light at the nodes of *adding*, as numbers of scatterers, and how narrow its
//! scattering is.

use papilio_optics::lobe::{BalancedLobe, Lobe};
use papilio_optics::rough::Rough;
use papilio_optics::scatter::Scatter;

/// Effect of a layer on light at the nodes, at one wavelength; scatterers by number.
#[derive(Debug, Clone)]
pub(crate) enum Action {
    /// Light keeps its direction: there is a regular part only.
    Regular,
    /// A clear medium of this internal transmittance along the normal.
    Clear { transmittance: f64 },
    /// A scatterer reflects and transmits it.
    Whole { number: usize },
    /// As `Whole`; this fraction of the absorption is absorption besides the scattering.
    Slab { number: usize, absorbing_share: f64 },
    /// Sums of kernels, each with a factor, besides the regular part: transmission from above, reflection
    /// from above, reflection from below.
    Kernels([Vec<(usize, f64)>; 3]),
}

/// Context in which a layer determines its [`Action`] at one wavelength: it registers its scatterers, which
/// get numbers.
pub(crate) trait Preparation<'a> {
    /// Number of the wavelength.
    fn bin(&self) -> usize;

    /// The index of the medium above (0) or below (1).
    fn index(&self, side: usize) -> f64;

    /// The number of a lobe that transmits everything.
    fn lobe(&mut self, lobe: Lobe) -> usize;

    /// The number of a lobe that reflects everything, of light from above (0) or from below (1): within the
    /// disc of the medium there.
    fn reflected_lobe(&mut self, lobe: Lobe, side: usize) -> usize;

    /// The number of a balanced lobe.
    fn balanced_lobe(&mut self, lobe: &'a BalancedLobe) -> usize;

    /// The number of a rough interface.
    fn rough(&mut self, face: &'a Rough) -> usize;

    /// The number of a kernel in a disc of this radius.
    fn kernel(&mut self, scatter: &'a Scatter, disc: f64) -> usize;

    /// The number of a medium that scatters in its volume, of this extinction along the normal.
    fn slab(&mut self, thickness: f64, albedo: f64, anisotropy: f64) -> usize;
}

/// A scatterer, by the quantity that makes it narrow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Narrowness {
    /// A diffuser's lobe.
    Lobe {
        /// Its width b, direction cosines.
        width: f64,
    },
    /// An interface given by its BSDF.
    Face {
        /// Width of its narrowest kernel, as of a k-correlation lobe, direction cosines.
        width: f64,
    },
    /// A rough interface.
    Rough {
        /// Its roughness.
        alpha: f64,
        /// Width of the narrowest lobe into which it refracts light, direction cosines.
        width: f64,
    },
    /// A medium that scatters in its volume.
    Slab {
        /// Mean cosine of the scattering angle.
        anisotropy: f64,
    },
}

impl Narrowness {
    /// Returns the distance in direction cosines over which its scattered light changes.
    pub(crate) fn smoothness(self) -> f64 {
        match self {
            Self::Lobe { width } | Self::Face { width } | Self::Rough { width, .. } => width,
            // The pole of the phase function lies at this imaginary angle.
            Self::Slab { anisotropy } => -anisotropy.abs().max(1e-9).ln(),
        }
    }
}
