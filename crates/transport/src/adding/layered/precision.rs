//! What a level of discretisation asks for.

use std::f64::consts::PI;

use papilio_optics::lobe::Lobe;

use super::grid::Density;
use super::rough;
use crate::{Diffuser, Interface, Layered};

/// What a level stands for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Precision {
    /// Natural digits of lobes, fields of view and round sources.
    pub(super) digits: f64,
    /// Nodes between two indices, besides those that scattering asks for.
    nodes: usize,
    /// Natural digits of the forward peak beyond the Legendre terms that are kept.
    terms: f64,
    /// Of orders of azimuth.
    pub(super) tolerance: f64,
    /// Of light that goes to and fro between layers and base.
    pub(super) iteration: f64,
}

impl Precision {
    pub(super) fn new(level: u32) -> Self {
        let level = f64::from(level);
        Self {
            digits: 7.0 + 2.0 * level,
            nodes: 8 + (4.0 * level) as usize,
            terms: 3.0 + 1.5 * level,
            tolerance: 1e-6 * (-2.0 * level).exp(),
            iteration: 1e-8 * (-2.0 * level).exp(),
        }
    }

    /// Legendre terms of a phase function of this anisotropy.
    pub(super) fn legendre_terms(&self, anisotropy: f64) -> usize {
        let g = anisotropy.abs();
        if g < 1e-9 {
            return 1;
        }
        // Wide phase functions cost little: they are kept whole.
        let few = 2 * self.nodes;
        ((self.terms / -g.ln()).ceil() as usize).max(few.min((-25.0 / g.ln()).ceil() as usize)).max(2)
    }
}

/// How densely the nodes of a stack must lie at a wavelength.
pub(super) fn density(stack: &Layered, bin: usize, precision: &Precision) -> Density {
    let mut density = Density { least: precision.nodes, spacing: f64::INFINITY, angle: None };
    for layer in &stack.layers {
        // The trapezoid rule's error for a pole at distance w is exp(-2 pi w/spacing).
        let width = match &layer.interface {
            Interface::Diffuser(Diffuser { lobe: Lobe::KCorrelation { width }, .. }) => *width,
            Interface::Rough(face) => rough::width(face),
            _ => f64::INFINITY,
        };
        density.spacing = density.spacing.min(2.0 * PI * width / precision.digits);
        if let Some(scattering) = layer.medium.scattering() {
            let terms = precision.legendre_terms(scattering.anisotropy) as f64;
            let spacing = PI / terms;
            let index = layer.medium.index()[bin];
            if density.angle.is_none_or(|(_, known)| spacing < known) {
                density.angle = Some((index, spacing));
            }
        }
    }
    density
}
