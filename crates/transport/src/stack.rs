//! The layered display as transport sees it, top to bottom: front of screen, then a
//! face or a diffuser, then a medium (the glass), then the base (the pixel).
//!
//! Every layer is an operator on direction cosines and carries *basic radiance*
//! (radiance over index squared), which flat interfaces conserve.

use papilio_optics::lobe::Lobe;
use papilio_spectra::Spectrum;

use crate::{AngularTable, Front};

/// The whole layered display.
#[derive(Debug, Clone)]
pub struct Stack {
    /// Front of screen, in air.
    pub front: Front,
    /// What stands between air and the medium.
    pub top: Top,
    /// The medium above the base.
    pub medium: Medium,
    /// The pixel.
    pub base: Base,
    /// Light is not followed into a second pass through the panel (Feng 2012, eq. 3-5).
    pub single_pass: bool,
}

/// What stands between air and the medium.
#[derive(Debug, Clone)]
pub enum Top {
    /// A perfect antireflection face: passes |beta| <= 1 whole, reflects the rest whole.
    Coated,
    /// A bare face of a solid of this index, unpolarised Fresnel.
    Fresnel(Spectrum),
    /// A diffuser, its faces included.
    Diffuser(Diffuser),
}

/// A diffuser given by its BTDF: it reflects nothing; what its lobe sends beyond
/// |beta| = 1 upwards, or beyond the medium's index downwards, is absorbed in it.
#[derive(Debug, Clone)]
pub struct Diffuser {
    /// Angular shape of the scattered part.
    pub lobe: Lobe,
    /// T, straight-through included, per wavelength.
    pub transmittance: Spectrum,
    /// Share of the transmitted light that keeps its direction.
    pub straight_through: f64,
}

/// A homogeneous medium.
#[derive(Debug, Clone, PartialEq)]
pub struct Medium {
    index: Spectrum,
    constant: Option<f64>,
    largest: f64,
}

impl Medium {
    /// A medium of this index, at least 1 at every wavelength.
    pub fn new(index: Spectrum) -> Self {
        Self { constant: index.is_constant().then(|| index[0]), largest: index.max(), index }
    }

    /// Its index, per wavelength.
    pub fn index(&self) -> &Spectrum {
        &self.index
    }

    /// Its index where that does not depend on wavelength.
    #[inline]
    pub fn constant_index(&self) -> Option<f64> {
        self.constant
    }

    /// Its largest index: the disc that holds every direction cosine in it.
    #[inline]
    pub fn largest_index(&self) -> f64 {
        self.largest
    }
}

/// What lies under the medium and sends light back.
#[derive(Debug, Clone)]
pub struct Base {
    /// How it reflects.
    pub reflector: Reflector,
    /// Absorptance of the inactive share of the panel, times that share, per wavelength.
    pub inactive_absorptance: Spectrum,
}

/// How a base reflects.
#[derive(Debug, Clone)]
pub enum Reflector {
    /// Like a mirror.
    Specular(AngularTable),
    /// The same basic radiance in every direction of the medium; shape `[state][wavelength]`.
    Lambertian(Vec<f64>),
}

impl Base {
    /// The number of wavelengths.
    pub fn bins(&self) -> usize {
        self.inactive_absorptance.len()
    }

    /// The number of states.
    pub fn states(&self) -> usize {
        match &self.reflector {
            Reflector::Specular(table) => table.state_count(),
            Reflector::Lambertian(reflectance) => reflectance.len() / self.bins(),
        }
    }

    /// The reflectance of every state at `|beta|^2`; `out` has shape `[state][wavelength]`.
    pub fn reflectance(&self, beta_squared: f64, medium: &Medium, out: &mut [f64]) {
        match &self.reflector {
            Reflector::Specular(table) => table.reflectance(beta_squared, medium, out),
            Reflector::Lambertian(reflectance) => out.copy_from_slice(reflectance),
        }
    }

    /// An upper bound of every state's reflectance at any angle.
    pub(crate) fn largest_reflectance(&self) -> f64 {
        let largest = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
        match &self.reflector {
            Reflector::Specular(table) => (largest(&table.basis) + largest(&table.common)).min(1.0),
            Reflector::Lambertian(reflectance) => largest(reflectance).min(1.0),
        }
    }
}
