//! The sums that the tracers keep.

use super::add_scaled;
use crate::angular::Stencil;
use crate::{Base, CosinePanels, Reflector};

/// Light that has met the base, as a path carries it.
#[derive(Debug, Clone, Copy)]
pub(super) enum Reflected<'a> {
    /// On a first pass: the look-up that gives the base's reflectance.
    LookUp(Stencil),
    /// Later: spectra that hold everything the path has met; shape `[state][wavelength]`.
    Spectra(&'a [f64]),
}

/// Paths whose moments are added side by side.
pub(super) const SIDE_BY_SIDE: usize = 8;

/// Sums of look-ups in a panel of a table, as [`CosinePanels::add_moments`] takes them: for each polynomial that of
/// each path's place among those side by side.
pub(super) type Moments = [[f64; SIDE_BY_SIDE]; CosinePanels::NODES];

/// A sum of weighted [`Reflected`] light: weights on table nodes, and spectra.
#[derive(Debug, Clone)]
pub(super) struct Channel {
    nodes: Vec<f64>,
    /// Of look-ups that were added by their moments, for each panel of the table.
    moments: Vec<Moments>,
    spectra: Vec<f64>,
}

impl Channel {
    pub(super) fn new(base: &Base) -> Self {
        let nodes = match &base.reflector {
            Reflector::Specular(table) => table.nodes.count(),
            Reflector::Lambertian(_) | Reflector::Scattering(_) => 1,
        };
        // A look-up always touches `Stencil::LEN` consecutive slots.
        let moments = Vec::new();
        Self {
            nodes: vec![0.0; nodes + Stencil::LEN],
            moments,
            spectra: vec![0.0; base.states() * base.bins()],
        }
    }

    #[inline]
    pub(super) fn add(&mut self, light: Reflected<'_>, weight: f64) {
        match light {
            Reflected::LookUp(stencil) => self.look_up(&stencil, weight),
            Reflected::Spectra(spectra) => add_scaled(&mut self.spectra, spectra, weight),
        }
    }

    /// Light on its first pass.
    #[inline(always)]
    pub(super) fn look_up(&mut self, stencil: &Stencil, weight: f64) {
        let slots = &mut self.nodes[stencil.first..][..Stencil::LEN];
        slots.iter_mut().zip(&stencil.weights).for_each(|(slot, w)| *slot += w * weight);
    }

    /// The sums of look-ups by their moments in a panel of so many.
    #[inline(always)]
    pub(super) fn moments(&mut self, panel: usize, panels: usize) -> &mut Moments {
        if self.moments.is_empty() {
            self.moments.resize(panels, [[0.0; SIDE_BY_SIDE]; CosinePanels::NODES]);
        }
        &mut self.moments[panel]
    }

    /// The weights on so many nodes of a table.
    fn node_weights(&self, count: usize) -> Vec<f64> {
        let mut weights = self.nodes[..count].to_vec();
        for (moments, weights) in self.moments.iter().zip(weights.as_chunks_mut().0) {
            // Light that reaches a panel at all has a moment of degree 0.
            if moments[0] != [0.0; SIDE_BY_SIDE] {
                CosinePanels::add_moments(&moments.map(|side_by_side| side_by_side.iter().sum()), weights);
            }
        }
        weights
    }

    /// The whole sums of several, each times its scale; shape `[state][wavelength]`.
    pub(super) fn sums(channels: &[(&Self, f64)], base: &Base) -> Vec<Vec<f64>> {
        let mut sums: Vec<Vec<f64>> = match &base.reflector {
            Reflector::Specular(table) => {
                let nodes: Vec<Vec<f64>> =
                    channels.iter().map(|(channel, _)| channel.node_weights(table.nodes.count())).collect();
                let nodes: Vec<&[f64]> = nodes.iter().map(Vec::as_slice).collect();
                let len = (base.states() * base.bins()).max(1);
                table.weighted_sums(&nodes).chunks_exact(len).map(<[f64]>::to_vec).collect()
            }
            Reflector::Lambertian(reflectance) => {
                channels.iter().map(|(channel, _)| scaled(reflectance, channel.nodes[0])).collect()
            }
            // Any layers are over such a base, no panel.
            Reflector::Scattering(_) => {
                channels.iter().map(|(channel, _)| scaled(&channel.spectra, 0.0)).collect()
            }
        };
        for (sum, (channel, scale)) in sums.iter_mut().zip(channels) {
            sum.iter_mut().zip(&channel.spectra).for_each(|(value, s)| *value = (*value + s) * scale);
        }
        sums
    }
}

fn scaled(values: &[f64], scale: f64) -> Vec<f64> {
    values.iter().map(|value| value * scale).collect()
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
