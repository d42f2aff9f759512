//! The sums that the tracers keep.

use super::add_scaled;
use crate::angular::Stencil;
use crate::{Base, Reflector};

/// Light that has met the base, as a path carries it.
#[derive(Debug, Clone, Copy)]
pub(super) enum Reflected<'a> {
    /// On a first pass: the look-up that gives the base's reflectance.
    LookUp(Stencil),
    /// Later: spectra that hold everything the path has met; shape `[state][wavelength]`.
    Spectra(&'a [f64]),
}

/// A sum of weighted [`Reflected`] light: weights on table nodes, and spectra.
#[derive(Debug, Clone)]
pub(super) struct Channel {
    nodes: Vec<f64>,
    spectra: Vec<f64>,
}

impl Channel {
    pub(super) fn new(base: &Base) -> Self {
        let nodes = match &base.reflector {
            Reflector::Specular(table) => table.nodes.count(),
            Reflector::Lambertian(_) | Reflector::Scattering(_) => 1,
        };
        // A look-up always touches `Stencil::LEN` consecutive slots.
        Self { nodes: vec![0.0; nodes + Stencil::LEN], spectra: vec![0.0; base.states() * base.bins()] }
    }

    #[inline]
    pub(super) fn add(&mut self, light: Reflected<'_>, weight: f64) {
        match light {
            Reflected::LookUp(stencil) => {
                let slots = &mut self.nodes[stencil.first..][..Stencil::LEN];
                slots.iter_mut().zip(stencil.weights).for_each(|(slot, w)| *slot += w * weight);
            }
            Reflected::Spectra(spectra) => add_scaled(&mut self.spectra, spectra, weight),
        }
    }

    /// The whole sum times `scale`; shape `[state][wavelength]`.
    pub(super) fn sum(&self, base: &Base, scale: f64) -> Vec<f64> {
        let mut sum = vec![0.0; self.spectra.len()];
        match &base.reflector {
            Reflector::Specular(table) => {
                table.weighted_sum(&self.nodes[..table.nodes.count()], &mut sum);
            }
            Reflector::Lambertian(reflectance) => add_scaled(&mut sum, reflectance, self.nodes[0]),
            // Any layers are over such a base, no panel.
            Reflector::Scattering(_) => {}
        }
        sum.iter_mut().zip(&self.spectra).for_each(|(value, s)| *value = (*value + s) * scale);
        sum
    }
}

/// A sum of light that has yet to meet the base: plain weights on first passes, spectra later.
#[derive(Debug, Clone)]
pub(super) struct Incident {
    weight: f64,
    spectra: Vec<f64>,
}

impl Incident {
    pub(super) fn new(len: usize) -> Self {
        Self { weight: 0.0, spectra: vec![0.0; len] }
    }

    #[inline]
    pub(super) fn add(&mut self, carried: Option<&[f64]>, weight: f64) {
        match carried {
            None => self.weight += weight,
            Some(spectra) => add_scaled(&mut self.spectra, spectra, weight),
        }
    }

    /// The whole sum times `scale`; shape `[state][wavelength]`.
    pub(super) fn sum(&self, scale: f64) -> Vec<f64> {
        self.spectra.iter().map(|s| (s + self.weight) * scale).collect()
    }
}
