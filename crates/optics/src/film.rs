//! Coherent thin films: any stack of flat layers on a substrate, s and p.
//!
//! **Model.** Light of vacuum wavelength `lambda` comes from a transparent medium
//! (real n) through layers (n + ik, thickness in nm) to a semi-infinite
//! substrate (n + ik). All multiple reflections interfere.
//!
//! **Parameters.** `beta = n sin(theta)`, conserved through the stack, from 0 to
//! the index of the incidence medium; where it exceeds a layer's own index the
//! field there is evanescent and may tunnel. In a medium, with k0 = 2 pi/lambda:
//! `q = sqrt(n^2 - beta^2)` with Im q >= 0 (the wave decays where it travels),
//! phase `delta = k0 q d`, admittance `eta = q/g` with g = 1 for s and n^2 for p.
//!
//! **Method.** U is the tangential field along the layers (E for s, H for p), V its
//! partner. Both are continuous, and across a layer
//! `U_top = cos(delta) U - i g (sin(delta)/q) V`,
//! `V_top = cos(delta) V - i (q/g) sin(delta) U`,
//! from the substrate (U, V) = (1, eta) up. Then `r = (eta0 U - V)/(eta0 U + V)`.
//! Three things make this safe where characteristic matrices fail:
//! - `sin(delta)/q` and `q sin(delta)` are even in q: the branch of q matters in
//!   the substrate only, and q = 0 (grazing inside a layer) is not special;
//! - each layer is divided by its growth exp(Im delta), so that opaque layers
//!   neither overflow nor lose r;
//! - powers are Poynting fluxes Re(U* V), right in absorbing media too.
//!
//! **Validity.** Flat, homogeneous, isotropic layers, local bulk indices. A layer
//! of metal of a few nm is rarely bulk.
//!
//! **Signs.** Fields vary as exp(-i omega t), so that absorbers have k > 0. The
//! amplitude r_p is that of H: at normal incidence r_p = -r_s.
//!
//! **Two implementations.** [`coherent`] is the reference: one wavelength, one beta, all quantities.
//! [`absorbed`] is the absorptance of each layer from it. [`GapFilm`] is fast: reflectance of many
//! wavelengths, betas and gaps. [`FilmRow`] is fast for arrays, in which every point may have a stack of its
//! own. The tests compare each with the reference.
//!
//! Source: M. Born, E. Wolf, "Principles of Optics", 7th ed., section 1.6;
//! A. Macleod, "Thin-Film Optical Filters", 4th ed., chapter 2.

mod absorbed;
mod coating;
mod coherent;
mod derivative;
mod forms;
mod fringes;
mod gap;
mod harmonic;
mod kernel;
mod lanes;
mod media;
mod points;

pub use absorbed::{Absorbed, absorbed};
pub use coating::{Coating, CoatingPart, Products};
pub use coherent::{Coherent, Field, Film, Layer, Polarisation, coherent};
pub use derivative::Variable;
pub use fringes::{LayerFringes, fringe_spacing_nm, most_fringes};
pub use gap::{GapFilm, SpectralLayer, Thickness};
pub use lanes::SimdLevel;
pub use points::{Along, FilmRow, IndexAlong, LayerAlong};

use num_complex::Complex64;

use crate::OpticsError;

pub(crate) fn checked_index(index: Complex64) -> Result<Complex64, OpticsError> {
    let passive = index.re >= 0.0 && index.im >= 0.0 && index.is_finite();
    if passive && index != Complex64::ZERO {
        Ok(index)
    } else {
        Err(OpticsError::Index { n: index.re, k: index.im })
    }
}

pub(crate) fn checked_thickness(nm: f64) -> Result<f64, OpticsError> {
    if nm >= 0.0 && nm.is_finite() { Ok(nm) } else { Err(OpticsError::Thickness { nm }) }
}

pub(crate) fn checked_wavelength(nm: f64) -> Result<f64, OpticsError> {
    if nm > 0.0 && nm.is_finite() { Ok(nm) } else { Err(OpticsError::Wavelength { nm }) }
}

pub(crate) fn checked_incidence(n: f64) -> Result<f64, OpticsError> {
    if n > 0.0 && n.is_finite() { Ok(n) } else { Err(OpticsError::Incidence { n }) }
}
