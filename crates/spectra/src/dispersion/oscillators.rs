//! Oscillator models of metals: Lorentz-Drude and Brendel-Bormann.
//!
//! The permittivity is that of free electrons (Drude) plus bound ones. Each bound resonance has
//! a strength f, a damping G and a resonance energy w_j. With w the photon energy
//! and wp the plasma energy, all in eV,
//!
//! `eps = 1 - f0 wp^2/(w (w + i G0)) + sum_j chi_j`.
//!
//! Lorentz-Drude: `chi_j = f_j wp^2/(w_j^2 - w^2 - i w G_j)`.
//!
//! Brendel-Bormann: each resonance is broadened by a Gaussian of width s_j, which reproduces the steepness of
//! absorption edges (Lorentzian wings fall too slowly): `chi_j = i sqrt(pi) f_j wp^2/(2 sqrt(2) a_j s_j)
//! (W((a_j - w_j)/(sqrt(2) s_j)) + W((a_j + w_j)/(sqrt(2) s_j)))` with `a_j = sqrt(w^2 + i w G_j)` and W the
//! Faddeeva function.
//!
//! Valid over the energies of the data to which the constants were fitted, for bulk, opaque metal.
//! Films of a few nm may differ.
//!
//! Source: A. D. Rakic, A. B. Djurisic, J. M. Elazar, M. L. Majewski, "Optical
//! properties of metallic films for vertical-cavity optoelectronic devices",
//! Appl. Opt. 37, 5271-5283 (1998), eq. 1-11.

use std::f64::consts::{PI, SQRT_2};

use num_complex::Complex64;

use super::faddeeva::faddeeva;

/// h c in eV nm (exact in the SI of 2019, rounded).
const PHOTON_EV_NM: f64 = 1_239.841_984_332;

/// One bound resonance: strength f, damping G (eV), energy w_j (eV).
pub(crate) type Oscillator = (f64, f64, f64);

/// Lorentz-Drude model; energies in eV.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct LorentzDrude {
    pub(super) plasma_ev: f64,
    /// (f0, G0) of the free electrons.
    pub(super) drude: (f64, f64),
    pub(super) oscillators: Vec<Oscillator>,
}

impl LorentzDrude {
    pub(super) fn index(&self, nm: f64) -> Complex64 {
        let w = photon_ev(nm);
        let wp2 = self.plasma_ev * self.plasma_ev;
        let bound = self.oscillators.iter().map(|&(f, g, wj)| resonance(w, f * wp2, g, wj));
        (1.0 + drude(w, wp2, self.drude) + bound.sum::<Complex64>()).sqrt()
    }
}

/// Brendel-Bormann model; energies in eV.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct BrendelBormann {
    pub(super) plasma_ev: f64,
    /// (f0, G0) of the free electrons.
    pub(super) drude: (f64, f64),
    /// Each resonance with its Gaussian width s_j, eV.
    pub(super) oscillators: Vec<(Oscillator, f64)>,
}

impl BrendelBormann {
    pub(super) fn index(&self, nm: f64) -> Complex64 {
        let w = photon_ev(nm);
        let wp2 = self.plasma_ev * self.plasma_ev;
        let bound = self.oscillators.iter().map(|&((f, g, wj), s)| {
            let a = Complex64::new(w * w, w * g).sqrt();
            let lines = faddeeva((a - wj) / (SQRT_2 * s)) + faddeeva((a + wj) / (SQRT_2 * s));
            Complex64::I * PI.sqrt() * f * wp2 / (2.0 * SQRT_2 * a * s) * lines
        });
        (1.0 + drude(w, wp2, self.drude) + bound.sum::<Complex64>()).sqrt()
    }
}

/// Photon energy of a wavelength in vacuum, eV.
pub(super) fn photon_ev(nm: f64) -> f64 {
    PHOTON_EV_NM / nm
}

/// Susceptibility of a bound resonance: strength in eV^2, damping and resonance in eV.
pub(super) fn resonance(w: f64, strength: f64, g: f64, wj: f64) -> Complex64 {
    strength / Complex64::new(wj * wj - w * w, -w * g)
}

/// Susceptibility of the free electrons.
pub(super) fn drude(w: f64, wp2: f64, (f0, g0): (f64, f64)) -> Complex64 {
    -f0 * wp2 / (w * Complex64::new(w, g0))
}
