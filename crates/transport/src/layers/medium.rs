//! Medium between two interfaces: index, absorption, scattering in the volume.

use papilio_optics::phase::PhaseMatrix;
use papilio_spectra::Spectrum;

use super::{Action, Narrowness, Preparation};
use super::{Incidence, LayerKind};
use crate::front::Flat;
use crate::skeleton::Part;

/// A homogeneous medium: the layer between two interfaces.
#[derive(Debug, Clone, PartialEq)]
pub struct Medium {
    index: Spectrum,
    constant: Option<f64>,
    largest: f64,
    transmittance: Option<Spectrum>,
    scattering: Option<Scattering>,
}

/// Scattering in the volume of a medium of constant index.
#[derive(Debug, Clone, PartialEq)]
pub struct Scattering {
    /// Extinction along the normal, above 0.
    pub optical_thickness: f64,
    /// Mean cosine of the scattering angle, -1 to 1 (both excluded).
    pub anisotropy: f64,
    /// Fraction of the extinguished light that is scattered, 0 to 1, per wavelength.
    pub albedo: Spectrum,
    /// The phase matrix, of this anisotropy, whose polarised light only the tracer of Stokes parameters knows. `None`:
    /// light is scattered as Henyey & Greenstein (1941) say, and leaves unpolarised.
    pub matrix: Option<PhaseMatrix>,
}

impl Scattering {
    /// Returns the scattering of Henyey and Greenstein.
    pub fn unpolarised(optical_thickness: f64, anisotropy: f64, albedo: Spectrum) -> Self {
        Self { optical_thickness, anisotropy, albedo, matrix: None }
    }

    /// Returns scattering by particles.
    pub fn polarised(optical_thickness: f64, matrix: PhaseMatrix, albedo: Spectrum) -> Self {
        Self { optical_thickness, anisotropy: matrix.mean_cosine(), albedo, matrix: Some(matrix) }
    }
}

impl Medium {
    /// The same medium, with an index of at least this at every wavelength.
    pub(crate) fn with_index_of_at_least(&self, least: f64) -> Self {
        let (transmittance, scattering) = (self.transmittance.clone(), self.scattering.clone());
        Self { transmittance, scattering, ..Self::new(self.index.map(|index| index.max(least))) }
    }

    /// Returns a clear medium of this index, at least 1 at every wavelength.
    pub fn new(index: Spectrum) -> Self {
        let constant = index.is_constant().then(|| index[0]);
        Self { constant, largest: index.max(), index, transmittance: None, scattering: None }
    }

    /// Returns the same medium with this internal transmittance along the normal, 0 to 1; at an angle the
    /// path is longer: `t^(1/cos theta)` (Beer & Lambert).
    pub fn with_transmittance(self, transmittance: Spectrum) -> Self {
        let clear = transmittance.iter().all(|t| *t == 1.0);
        Self { transmittance: (!clear).then_some(transmittance), ..self }
    }

    /// Returns the same medium with scattering in its volume; its index must be constant.
    pub fn with_scattering(self, scattering: Scattering) -> Self {
        Self { scattering: Some(scattering), ..self }
    }

    /// Returns the internal transmittance along the normal, if the medium absorbs.
    pub fn transmittance(&self) -> Option<&Spectrum> {
        self.transmittance.as_ref()
    }

    /// Returns the scattering in the volume.
    pub fn scattering(&self) -> Option<&Scattering> {
        self.scattering.as_ref()
    }

    /// Returns its index, per wavelength.
    pub fn index(&self) -> &Spectrum {
        &self.index
    }

    /// Returns its index if that does not depend on wavelength.
    #[inline]
    pub fn constant_index(&self) -> Option<f64> {
        self.constant
    }

    /// Returns its largest index: the radius of the disc that contains all its direction cosines.
    #[inline]
    pub fn largest_index(&self) -> f64 {
        self.largest
    }
}

impl Medium {
    fn part(&self, at: &Incidence) -> Part {
        let n = at.indices[0];
        if at.beta_squared >= n * n {
            return Part::flat(Flat::OPAQUE);
        }
        if self.transmittance.is_none() && self.scattering.is_none() {
            return Part::flat(Flat::CLEAR);
        }
        let secant = 1.0 / (1.0 - at.beta_squared / (n * n)).sqrt();
        let clear = self.transmittance.as_ref().map_or(1.0, |t| t[at.bin].powf(secant));
        let depth = self.scattering.as_ref().map_or(0.0, |s| s.optical_thickness * secant);
        let t = clear * (-depth).exp();
        Part { flat: Flat { t, above: 0.0, below: 0.0 }, scattered: [-(-depth).exp_m1(); 2] }
    }
}

/// A medium lies between itself and itself: both indices are its own.
impl LayerKind for Medium {
    fn regular(&self, at: &Incidence) -> Flat {
        self.part(at).flat
    }

    fn scattered(&self, at: &Incidence) -> [f64; 2] {
        self.part(at).scattered
    }

    fn parts(&self, media: [&Medium; 2], beta_squared: f64, out: &mut [Part]) {
        for (bin, out) in out.iter_mut().enumerate() {
            *out = self.part(&Incidence::between(media, bin, beta_squared));
        }
    }

    fn scatters(&self) -> bool {
        self.scattering.is_some()
    }

    fn narrowness(&self) -> Option<Narrowness> {
        self.scattering().map(|s| Narrowness::Slab { anisotropy: s.anisotropy })
    }

    fn spectral_key(&self, bin: usize, key: &mut Vec<u64>) {
        key.push(self.index[bin].to_bits());
        key.extend(self.transmittance.as_ref().map(|t| t[bin].to_bits()));
        key.extend(self.scattering.as_ref().map(|s| s.albedo[bin].to_bits()));
    }

    fn action<'a>(&'a self, prepare: &mut dyn Preparation<'a>) -> Option<Action> {
        let transmittance = self.transmittance.as_ref().map_or(1.0, |t| t[prepare.bin()]);
        let Some(scattering) = &self.scattering else {
            return (transmittance < 1.0).then_some(Action::Clear { transmittance });
        };
        // Absorption besides the scattering is additional extinction without scattering.
        let absorbing = -transmittance.max(f64::MIN_POSITIVE).ln();
        let thickness = scattering.optical_thickness + absorbing;
        let scattered = scattering.optical_thickness * scattering.albedo[prepare.bin()];
        let number = prepare.slab(thickness, scattered / thickness, scattering.anisotropy);
        let lost = thickness - scattered;
        Some(Action::Slab { number, absorbing_share: if lost > 0.0 { absorbing / lost } else { 0.0 } })
    }
}
