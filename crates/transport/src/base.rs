//! The pixel, below the last medium.

use std::f64::consts::FRAC_PI_2;

use papilio_optics::{Beta, with_widest_simd};
use papilio_spectra::{Spectrum, StateSpectra};

use crate::{AngularTable, Cone, Medium, Nodes, ScatterKernel};

/// The reflector below the last medium.
#[derive(Debug, Clone, PartialEq)]
pub struct Base {
    /// Reflection of the active area.
    pub reflector: Reflector,
    /// Absorptance of the inactive part of the panel, times its fraction of the area, per wavelength.
    pub inactive_absorptance: Spectrum,
}

/// Kind of reflection of a base.
#[derive(Debug, Clone, PartialEq)]
#[allow(clippy::large_enum_variant, reason = "there is one pixel, not many")]
pub enum Reflector {
    /// Like a mirror.
    Specular(AngularTable),
    /// The same basic radiance in every direction of the medium.
    Lambertian(StateSpectra),
    /// By a kernel for each state, with directions in the medium: cosines over its index, which should be
    /// constant; made by [`Reflector::scattering`]. The pixel absorbs all light that it does not send back.
    /// Only general layers can be above it, not a panel.
    Scattering(Vec<ScatterKernel>),
}

impl Reflector {
    /// Builds a diffuse reflector from the reflectances of its states, `[state][wavelength]`.
    pub fn lambertian(reflectance: Vec<f64>, wavelengths: usize) -> Self {
        Self::Lambertian(StateSpectra::new(reflectance, wavelengths))
    }

    /// Builds the reflection by a kernel for each state; each is replaced by the mean of its two readings,
    /// which is reciprocal.
    pub fn scattering(kernels: impl IntoIterator<Item = ScatterKernel>) -> Self {
        Self::Scattering(kernels.into_iter().map(ScatterKernel::reciprocal).collect())
    }
}

impl Base {
    /// Returns the number of nodes of a mirror's table across a cone of directions in air, under this
    /// medium.
    pub(crate) fn nodes_across(&self, cone: &Cone, medium: &Medium) -> f64 {
        let Reflector::Specular(table) = &self.reflector else { return 0.0 };
        let axis = cone.axis_towards().length().min(1.0).asin();
        let ends = [axis - cone.half_angle(), axis + cone.half_angle()];
        let ends = ends.map(|angle| angle.clamp(0.0, FRAC_PI_2).sin());
        let across = |index: f64| table.nodes.between(ends, index);
        let across = medium.index().iter().copied().map(across).fold(0.0, f64::max);
        match table.nodes {
            // A table of one's own has all its harmonics near the normal, where a cone has all azimuths.
            Nodes::Azimuthal(_, harmonics) if table.nodes.has_kinks() => {
                let half_angle = cone.half_angle();
                let turned = if axis > half_angle { half_angle / axis } else { 1.0 };
                across + if half_angle > 0.0 { 2.0 * harmonics as f64 * turned } else { 0.0 }
            }
            _ => across,
        }
    }

    /// Returns the number of wavelengths.
    pub fn bins(&self) -> usize {
        self.inactive_absorptance.len()
    }

    /// Returns the number of states.
    pub fn states(&self) -> usize {
        match &self.reflector {
            Reflector::Specular(table) => table.state_count(),
            Reflector::Lambertian(reflectance) => reflectance.states(),
            Reflector::Scattering(kernels) => kernels.len(),
        }
    }

    /// Returns true if it preserves the direction of light, as a mirror.
    pub fn is_specular(&self) -> bool {
        matches!(self.reflector, Reflector::Specular(_))
    }

    /// Computes the reflectance of every state at `|beta|^2`; `out` has shape `[state][wavelength]`.
    pub fn reflectance(&self, beta_squared: f64, medium: &Medium, out: &mut [f64]) {
        match &self.reflector {
            Reflector::Specular(table) => table.reflectance(beta_squared, medium, out),
            Reflector::Lambertian(reflectance) => out.copy_from_slice(reflectance),
            Reflector::Scattering(kernels) => {
                let index = medium.largest_index();
                let rows = out.chunks_exact_mut(self.bins());
                for (row, kernel) in rows.zip(kernels) {
                    let total = kernel.total(beta_squared.sqrt() / index);
                    row.iter_mut().zip(&*kernel.factor).for_each(|(out, factor)| *out = total * factor);
                }
            }
        }
    }

    /// Computes the reflectance of every state for light that leaves towards `beta`: that of a mirror may depend on azimuth.
    pub fn reflectance_towards(&self, beta: Beta, medium: &Medium, out: &mut [f64]) {
        match &self.reflector {
            Reflector::Specular(table) => table.reflectance_towards(beta, medium, out),
            _ => self.reflectance(beta.squared(), medium, out),
        }
    }

    /// Returns whether its reflectance depends on azimuth.
    pub fn is_azimuthal(&self) -> bool {
        matches!(&self.reflector, Reflector::Specular(table) if table.is_azimuthal())
    }

    /// Returns the number of harmonics over the azimuth of each state's reflectance; 1 if it does not depend on it.
    pub fn harmonics(&self) -> usize {
        if let Reflector::Specular(table) = &self.reflector { table.harmonics() } else { 1 }
    }

    /// Returns an upper bound of the reflectance of every state at any angle.
    pub(crate) fn largest_reflectance(&self) -> f64 {
        match &self.reflector {
            Reflector::Specular(table) => table.largest_reflectance(largest(&table.basis)),
            Reflector::Lambertian(reflectance) => largest(reflectance).min(1.0),
            Reflector::Scattering(_) => 1.0,
        }
    }
}

/// Returns the largest of these values; negative ones count as 0.
pub(crate) fn largest(values: &[f64]) -> f64 {
    let larger = |most: f64, value: &f64| if *value > most { *value } else { most };
    if values.len() <= 4 {
        return values.iter().fold(0.0, larger);
    }
    // Several at a time, as registers hold them: tables are large.
    with_widest_simd(
        #[inline(always)]
        || {
            let mut most = [0.0_f64; 16];
            let (pieces, rest) = values.as_chunks::<16>();
            for values in pieces {
                most.iter_mut().zip(values).for_each(|(most, value)| *most = larger(*most, value));
            }
            most.iter().chain(rest).fold(0.0, larger)
        },
    )
}
