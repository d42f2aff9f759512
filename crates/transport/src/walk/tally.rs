//! What a replicate reports, and the sums that the tracers keep.

use super::add_scaled;
use crate::angular::Stencil;
use crate::stack::{Base, Reflector};

/// The means over one replicate's paths.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Estimate {
    /// For each source, in the order they were given.
    pub rho: Vec<Rho>,
    /// Where a unit beam from the view direction ends.
    pub ledger: Ledger,
}

/// Reflectance factor under one source alone.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Rho {
    /// Light that met the base; shape `[state][wavelength]`.
    pub base: Vec<f64>,
    /// Light mirrored before it met the base, alike in all states; shape `[wavelength]`.
    pub front: Vec<f64>,
}

/// Shares of a unit beam, per state and wavelength (shape `[state][wavelength]`).
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Ledger {
    /// Back into the room.
    pub returned: Vec<f64>,
    /// Absorbed in the front of screen.
    pub front: Vec<f64>,
    /// Absorbed in the diffuser, or beyond its lobe's reach.
    pub diffuser: Vec<f64>,
    /// Absorbed in the active pixel.
    pub pixel: Vec<f64>,
    /// Absorbed in the inactive share of the panel.
    pub inactive: Vec<f64>,
    /// Not followed to its end.
    pub unaccounted: Vec<f64>,
}

impl Ledger {
    pub(super) fn zeros(len: usize) -> Self {
        let zeros = || vec![0.0; len];
        Self {
            returned: zeros(),
            front: zeros(),
            diffuser: zeros(),
            pixel: zeros(),
            inactive: zeros(),
            unaccounted: zeros(),
        }
    }
}

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
            Reflector::Lambertian(_) => 1,
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
