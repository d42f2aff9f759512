//! What a level of discretisation asks for.

use std::f64::consts::PI;

use super::grid::Density;
use crate::adding::{Narrowest, Narrowness};
use crate::layers::LayerKind;
use crate::{Layered, Medium};

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
    /// Spacing of nodes at a rough face, at most. What facets refract along the face jumps to
    /// zero there: it is resolved with the number of nodes alone.
    jump: f64,
}

impl Precision {
    pub(super) fn new(level: u32) -> Self {
        let level = f64::from(level);
        Self {
            digits: 5.0 + 2.0 * level,
            nodes: 8 + (4.0 * level) as usize,
            terms: 3.0 + 1.5 * level,
            tolerance: 1e-5 * (-2.0 * level).exp(),
            iteration: 1e-7 * (-2.0 * level).exp(),
            jump: 0.06 * 1.5_f64.powf(-level),
        }
    }

    /// Legendre terms of a phase function of this anisotropy that nodes are made to resolve.
    fn legendre_terms(&self, anisotropy: f64) -> usize {
        let g = anisotropy.abs();
        if g < 1e-9 {
            return 1;
        }
        // Wide phase functions cost little: they are kept whole.
        let few = 2 * self.nodes;
        ((self.terms / -g.ln()).ceil() as usize).max(few.min((-25.0 / g.ln()).ceil() as usize)).max(2)
    }

    /// Legendre terms that are kept of it: at the same nodes, twice those that they were made for leave a
    /// hundredth of the error, as Gauss's rule integrates products of two.
    pub(super) fn kept_terms(&self, anisotropy: f64) -> usize {
        let g = anisotropy.abs();
        let whole = if g < 1e-9 { 1 } else { (-30.0 / g.ln()).ceil() as usize };
        let resolved = self.legendre_terms(anisotropy);
        resolved.max(whole.min(2 * resolved))
    }
}

/// How densely the nodes of a stack must lie at a wavelength.
pub(super) fn density(stack: &Layered, bin: usize, precision: &Precision) -> Density {
    let mut density = precision.least();
    for (scatterer, medium) in scatterers(stack) {
        precision.resolve(scatterer, medium.index()[bin], &mut density);
    }
    density
}

/// What scatters, and the medium there or below.
fn scatterers(stack: &Layered) -> impl Iterator<Item = (Narrowness, &Medium)> {
    let narrow = |(kind, [_, below]): (&dyn LayerKind, [Option<_>; 2])| kind.narrowness().zip(below);
    stack.elements().filter_map(narrow)
}

/// What asks for the most nodes at the first wavelength, whose indices lie at `splits`.
pub(super) fn narrowest(stack: &Layered, splits: &[f64], precision: &Precision) -> Option<Narrowest> {
    let nodes = |(number, (scatterer, medium)): (usize, (Narrowness, &Medium))| {
        let mut density = precision.least();
        precision.resolve(scatterer, medium.index()[0], &mut density);
        (density.total(splits), Narrowest { number: number + 1, scatterer })
    };
    // Of several alike the first one.
    scatterers(stack)
        .enumerate()
        .map(nodes)
        .reduce(|a, b| if b.0 > a.0 { b } else { a })
        .map(|(_, narrowest)| narrowest)
}

impl Precision {
    /// What is asked for where nothing scatters.
    fn least(&self) -> Density {
        Density { least: self.nodes, spacing: f64::INFINITY, angle: None }
    }

    /// Nodes that resolve this, too, in a medium of this index.
    fn resolve(&self, scatterer: Narrowness, index: f64, density: &mut Density) {
        // The trapezoid rule's error for a pole at distance w is exp(-2 pi w/spacing).
        let by_width = |width: f64| 2.0 * PI * width / self.digits;
        match scatterer {
            Narrowness::Lobe { width } | Narrowness::Face { width } => {
                density.spacing = density.spacing.min(by_width(width));
            }
            Narrowness::Rough { width, .. } => {
                density.spacing = density.spacing.min(by_width(width)).min(self.jump);
            }
            Narrowness::Slab { anisotropy } => {
                let spacing = PI / self.legendre_terms(anisotropy) as f64;
                if density.angle.is_none_or(|(_, known)| spacing < known) {
                    density.angle = Some((index, spacing));
                }
            }
        }
    }
}
