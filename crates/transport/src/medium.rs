//! What fills the space between two interfaces: an index, absorption, bulk scattering.

use papilio_spectra::Spectrum;

/// A homogeneous medium: the layer between two interfaces.
#[derive(Debug, Clone, PartialEq)]
pub struct Medium {
    index: Spectrum,
    constant: Option<f64>,
    largest: f64,
    transmittance: Option<Spectrum>,
    scattering: Option<Scattering>,
}

/// Bulk scattering in a medium of constant index (Henyey & Greenstein 1941).
#[derive(Debug, Clone, PartialEq)]
pub struct Scattering {
    /// Extinction along the normal, above 0.
    pub optical_thickness: f64,
    /// Mean cosine of the scattering angle, -1 to 1 (both excluded).
    pub anisotropy: f64,
    /// Share of the extinguished light that is scattered, 0 to 1, per wavelength.
    pub albedo: Spectrum,
}

impl Medium {
    /// A clear medium of this index, at least 1 at every wavelength.
    pub fn new(index: Spectrum) -> Self {
        let constant = index.is_constant().then(|| index[0]);
        Self { constant, largest: index.max(), index, transmittance: None, scattering: None }
    }

    /// The same medium with this internal transmittance along the normal, 0 to 1; at an angle
    /// the path is longer: `t^(1/cos theta)` (Beer & Lambert).
    pub fn with_transmittance(self, transmittance: Spectrum) -> Self {
        let clear = transmittance.iter().all(|t| *t == 1.0);
        Self { transmittance: (!clear).then_some(transmittance), ..self }
    }

    /// The same medium with scattering in its bulk; its index must be constant.
    pub fn with_scattering(self, scattering: Scattering) -> Self {
        Self { scattering: Some(scattering), ..self }
    }

    /// Internal transmittance along the normal, where the medium absorbs.
    pub fn transmittance(&self) -> Option<&Spectrum> {
        self.transmittance.as_ref()
    }

    /// Scattering in the bulk.
    pub fn scattering(&self) -> Option<&Scattering> {
        self.scattering.as_ref()
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
