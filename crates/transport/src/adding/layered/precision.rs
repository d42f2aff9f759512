//! Accuracy of a level of discretisation.

use std::f64::consts::PI;

use papilio_optics::rough::{Rough, Side};

use super::grid::Density;
use super::rough::inside_width;
use super::splits::Splits;
use crate::adding::{FIRST_STEP, Narrowest, Narrowness};
use crate::layers::LayerKind;
use crate::{Interface, Medium, Reflector, Stack};

/// Density of nodes for interpolation between them over that for integration, which is exact for polynomials
/// of twice the degree.
const INTERPOLATION: f64 = 2.0;

/// The same where light between two scatterers is interpolated, which the second one smooths.
const INTERPOLATION_BETWEEN: f64 = 1.4;

/// Accuracy of a level; the levels of a first answer are negative.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Precision {
    /// Natural digits of lobes, fields of view and round sources.
    pub(super) digits: f64,
    /// Nodes between two indices, besides those that scattering requires.
    nodes: usize,
    /// Natural digits of the forward peak beyond the retained Legendre terms.
    terms: f64,
    /// Tolerance of the series of azimuthal orders.
    pub(super) tolerance: f64,
    /// Tolerance of the iteration between layers and base.
    pub(super) iteration: f64,
    /// Largest spacing of nodes at a rough interface that is not the surface of a display. Light that
    /// microfacets refract along the interface jumps to zero there: it is resolved only in proportion to the
    /// number of nodes.
    jump: f64,
    /// Largest number of wavelengths over a film, and of different operators; at others, light is
    /// interpolated.
    pub(super) wavelengths: usize,
    /// Coarseness of tables of rough interfaces.
    pub(super) coarseness: usize,
}

/// Wavelengths of the finer level of a first answer; the coarser one has half of them.
const FIRST_WAVELENGTHS: f64 = 28.0;

impl Precision {
    pub(super) fn new(level: f64) -> Self {
        // Number of the level of a first answer, counted from level 0.
        let coarser = (-level / FIRST_STEP).round().max(0.0) as usize;
        Self {
            digits: 5.0 + 2.0 * level,
            nodes: (8.0 + 4.0 * level).max(4.0) as usize,
            terms: 3.0 + 1.5 * level,
            tolerance: 1e-5 * (-2.0 * level).exp(),
            iteration: 1e-7 * (-2.0 * level).exp(),
            jump: 0.06 * 1.5_f64.powf(-level),
            wavelengths: if coarser == 0 {
                usize::MAX
            } else {
                (FIRST_WAVELENGTHS * 0.5_f64.powi(coarser as i32 - 1)) as usize
            },
            coarseness: coarser,
        }
    }

    /// Returns the number of Legendre terms of a phase function of this anisotropy that the nodes resolve.
    fn legendre_terms(&self, anisotropy: f64) -> usize {
        let g = anisotropy.abs();
        if g < 1e-9 {
            return 1;
        }
        // Wide phase functions cost little: all terms are retained.
        let few = 2 * self.nodes;
        ((self.terms / -g.ln()).ceil() as usize).max(few.min((-25.0 / g.ln()).ceil() as usize)).max(2)
    }

    /// Returns the number of retained Legendre terms: at the same nodes, twice as many as those for which
    /// they were made leave a hundredth of the error, as the Gauss rule integrates products of two.
    pub(super) fn kept_terms(&self, anisotropy: f64) -> usize {
        let g = anisotropy.abs();
        let whole = if g < 1e-9 { 1 } else { (-30.0 / g.ln()).ceil() as usize };
        let resolved = self.legendre_terms(anisotropy);
        resolved.max(whole.min(2 * resolved))
    }
}

/// Returns the required density of the nodes of a stack at a wavelength.
pub(super) fn density(stack: &Stack, bin: usize, precision: &Precision) -> Density {
    let mut density = precision.least();
    if let Some(face) = rough_surface(stack) {
        precision.resolve_surface(face, &mut density);
        return density;
    }
    for (scatterer, medium) in scatterers(stack, true) {
        precision.resolve(scatterer, medium.index()[bin], &mut density);
    }
    density
}

/// Returns the density of nodes between which light is interpolated, whatever the surface is.
pub(super) fn density_between(stack: &Stack, bin: usize, precision: &Precision) -> Density {
    let mut density = precision.least();
    for (scatterer, medium) in scatterers(stack, false) {
        precision.resolve(scatterer, medium.index()[bin], &mut density);
    }
    density.spacing /= INTERPOLATION_BETWEEN;
    density
}

/// Returns the rough interface between air and the first medium, if nothing else scatters and the medium is
/// the denser one: light that is reflected inside then needs fewer nodes than the light that it refracts.
pub(in super::super) fn rough_surface(stack: &Stack) -> Option<&Rough> {
    let alone = stack.elements().filter(|(kind, _)| kind.scatters()).count() == 1;
    let scattering_base = matches!(stack.base().reflector, Reflector::Scattering(_));
    match &stack.layers.first()?.interface {
        Interface::Rough(face) if alone && !scattering_base && face.index(Side::Below) > 1.0 => Some(face),
        _ => None,
    }
}

/// Returns the scatterers, each with its medium or the medium below it; without those that nodes between
/// their kinks resolve, if there are such nodes.
fn scatterers(stack: &Stack, between_kinks: bool) -> impl Iterator<Item = (Narrowness, &Medium)> {
    let narrow = move |(kind, [_, below]): (&dyn LayerKind, [Option<_>; 2])| {
        kind.narrowness().filter(|_| !between_kinks || kind.kinks().is_empty()).zip(below)
    };
    stack.elements().filter_map(narrow)
}

/// Returns the scatterer that requires the most nodes at the first wavelength, whose indices are `splits`.
pub(super) fn narrowest(stack: &Stack, splits: &Splits, precision: &Precision) -> Option<Narrowest> {
    let nodes = |(number, (scatterer, medium)): (usize, (Narrowness, &Medium))| {
        let mut density = precision.least();
        precision.resolve(scatterer, medium.index()[0], &mut density);
        (density.total(splits), Narrowest { number: number + 1, scatterer })
    };
    // The first of several equal ones.
    scatterers(stack, false)
        .enumerate()
        .map(nodes)
        .reduce(|a, b| if b.0 > a.0 { b } else { a })
        .map(|(_, narrowest)| narrowest)
}

impl Precision {
    /// Returns the density where nothing scatters.
    fn least(&self) -> Density {
        Density { least: self.nodes, spacing: f64::INFINITY, angle: None }
    }

    /// Increases the density of nodes to interpolate the light that a rough surface reflects inside.
    fn resolve_surface(&self, face: &Rough, density: &mut Density) {
        let width = inside_width(face.alpha(), face.index(Side::Below));
        density.spacing = density.spacing.min(2.0 * PI * width / (INTERPOLATION * self.digits));
    }

    /// Increases the density of nodes to resolve this scatterer in a medium of this index.
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
