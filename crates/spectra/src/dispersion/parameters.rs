//! Dispersion by parameters, which a fit can determine: Cauchy, Sellmeier, and sums of oscillators.
//!
//! With l the wavelength in um and E the photon energy in eV:
//!
//! | model | formula |
//! |---|---|
//! | Cauchy | n = a + b/l^2 + c/l^4 |
//! | Sellmeier | n^2 = eps_inf + sum b_j l^2/(l^2 - l_j^2) |
//! | oscillators | (n + ik)^2 = eps_inf + sum chi_j |
//!
//! Cauchy and Sellmeier describe transparent media; k, constant or an exponential of the photon energy (Urbach 1953),
//! is added to n, which it does not change. Each oscillator obeys the relations of Kramers and Kronig:
//!
//! - Lorentz: `chi = f E0^2/(E0^2 - E^2 - i E G)`;
//! - Drude: `chi = -Ep^2/(E (E + i G))`;
//! - Gauss: `Im chi = A (exp(-x-^2) - exp(-x+^2))` with `x+- = 2 sqrt(ln 2) (E +- E0)/G`; with W the Faddeeva function,
//!   `chi = i A (W(x-) - W(x+))`;
//! - Tauc-Lorentz: `Im chi = A E0 C (E - Eg)^2/(((E^2 - E0^2)^2 + C^2 E^2) E)` above the gap Eg, and 0 below it. The real part is
//!   `(2/pi) P int_Eg^inf x Im chi(x)/(x^2 - E^2) dx`, here by the residues r of the integrand at its six poles p:
//!   `-sum r ln(Eg - p)`, also for C > 2 E0.
//!
//! Source: G. E. Jellison, F. A. Modine, Appl. Phys. Lett. 69, 371 and 2137 (1996); F. Urbach, Phys. Rev. 92, 1324 (1953).

use std::f64::consts::{LN_2, PI};

use num_complex::Complex64;

use super::checked;
use super::faddeeva::faddeeva;
use super::oscillators::{drude, photon_ev, resonance};
use crate::SpectraError;

/// k of a medium whose n is that of a transparent one: `k exp((E - E_at)/urbach)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Absorption {
    /// k at `at_nm`.
    pub k: f64,
    /// Wavelength of `k`, nm.
    pub at_nm: f64,
    /// Photon energy in which k changes by a factor e, eV; `None`: k is the same at all wavelengths.
    pub urbach_ev: Option<f64>,
}

/// A term of [`DispersionModel::Sellmeier`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SellmeierTerm {
    /// Strength.
    pub b: f64,
    /// Wavelength of the resonance, nm.
    pub resonance_nm: f64,
}

/// A term of [`DispersionModel::Oscillators`]; the head of this file has the formulas.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum OscillatorTerm {
    /// A bound resonance.
    Lorentz {
        /// What it adds to the permittivity at low energy, f.
        strength: f64,
        /// Energy of the resonance, eV.
        energy_ev: f64,
        /// Damping G, eV.
        damping_ev: f64,
    },
    /// Free electrons.
    Drude {
        /// Plasma energy, eV, with the permittivity of vacuum.
        plasma_ev: f64,
        /// Damping G, eV.
        damping_ev: f64,
    },
    /// A resonance broadened by a Gaussian.
    Gauss {
        /// Imaginary part of the permittivity at the resonance, A.
        amplitude: f64,
        /// Energy of the resonance, eV.
        energy_ev: f64,
        /// Full width at half maximum G, eV.
        width_ev: f64,
    },
    /// An amorphous semiconductor or insulator.
    TaucLorentz {
        /// Amplitude A, eV.
        amplitude_ev: f64,
        /// Energy of the resonance, eV.
        energy_ev: f64,
        /// Broadening C, eV.
        damping_ev: f64,
        /// Gap Eg, eV.
        gap_ev: f64,
    },
}

/// A model of n + ik by parameters, for [`Dispersion::model`](crate::Dispersion::model).
#[derive(Debug, Clone, PartialEq)]
pub enum DispersionModel {
    /// n by Cauchy's formula.
    Cauchy {
        /// Coefficients a, b (um^2) and c (um^4).
        coefficients: [f64; 3],
        /// k.
        absorption: Absorption,
    },
    /// n by Sellmeier's formula.
    Sellmeier {
        /// Permittivity at short wavelengths.
        eps_inf: f64,
        /// Resonances.
        terms: Vec<SellmeierTerm>,
        /// k.
        absorption: Absorption,
    },
    /// Permittivity by a sum of oscillators.
    Oscillators {
        /// Permittivity at high energy.
        eps_inf: f64,
        /// Oscillators.
        terms: Vec<OscillatorTerm>,
    },
}

impl DispersionModel {
    /// n + ik at a wavelength, nm.
    pub(super) fn index(&self, nm: f64) -> Result<Complex64, SpectraError> {
        let undefined = |model, value: f64| SpectraError::ModelUndefined { model, nm, value };
        let um2 = 1e-6 * nm * nm;
        let index = match self {
            Self::Cauchy { coefficients: [a, b, c], absorption } => {
                let n = a + (b + c / um2) / um2;
                if n <= 0.0 || !n.is_finite() {
                    return Err(undefined("Cauchy's formula: n", n));
                }
                Complex64::new(n, absorption.k(nm))
            }
            Self::Sellmeier { eps_inf, terms, absorption } => {
                let term = |one: &SellmeierTerm| one.b / (1.0 - (one.resonance_nm / nm).powi(2));
                let square = eps_inf + terms.iter().map(term).sum::<f64>();
                if !(square > 0.0 && square.is_finite()) {
                    return Err(undefined("Sellmeier's formula: n^2", square));
                }
                Complex64::new(square.sqrt(), absorption.k(nm))
            }
            Self::Oscillators { eps_inf, terms } => {
                let energy = photon_ev(nm);
                let permittivity =
                    eps_inf + terms.iter().map(|one| one.susceptibility(energy)).sum::<Complex64>();
                let index = permittivity.sqrt();
                if !index.is_finite() {
                    return Err(undefined("the sum of oscillators: the permittivity", permittivity.re));
                }
                index
            }
        };
        checked(index)
    }
}

impl Absorption {
    fn k(&self, nm: f64) -> f64 {
        let exponent = self.urbach_ev.map_or(0.0, |urbach| (photon_ev(nm) - photon_ev(self.at_nm)) / urbach);
        if self.k == 0.0 { 0.0 } else { self.k * exponent.exp() }
    }
}

impl OscillatorTerm {
    /// What the oscillator adds to the permittivity at a photon energy, eV.
    fn susceptibility(&self, energy: f64) -> Complex64 {
        match *self {
            Self::Lorentz { strength, energy_ev, damping_ev } => {
                resonance(energy, strength * energy_ev * energy_ev, damping_ev, energy_ev)
            }
            Self::Drude { plasma_ev, damping_ev } => drude(energy, plasma_ev * plasma_ev, (1.0, damping_ev)),
            Self::Gauss { amplitude, energy_ev, width_ev } => {
                let at = |centre: f64| 2.0 * LN_2.sqrt() * (energy - centre) / width_ev;
                let [near, far] = [at(energy_ev), at(-energy_ev)];
                let real = faddeeva(far.into()).im - faddeeva(near.into()).im;
                amplitude * Complex64::new(real, (-near * near).exp() - (-far * far).exp())
            }
            Self::TaucLorentz { amplitude_ev, energy_ev, damping_ev, gap_ev } => {
                let strength = amplitude_ev * energy_ev * damping_ev;
                tauc_lorentz(energy, strength, (energy_ev, damping_ev, gap_ev))
            }
        }
    }
}

/// Tauc-Lorentz oscillator of strength `A E0 C`.
fn tauc_lorentz(energy: f64, strength: f64, (resonance, damping, gap): (f64, f64, f64)) -> Complex64 {
    let square = energy * energy;
    let excess = (energy - gap).max(0.0);
    let denominator = (square - resonance * resonance).powi(2) + damping * damping * square;
    let imaginary = strength * excess * excess / (denominator * energy);
    // Poles of the Lorentzian at +-sqrt(middle +- half): a double one at C = 2 E0, which is avoided.
    let double = (damping - 2.0 * resonance).abs() < 1e-6 * resonance;
    let damping = if double { (2.0 + 1e-6) * resonance } else { damping };
    let middle = Complex64::from(resonance * resonance - 0.5 * damping * damping);
    let half =
        Complex64::I * damping * Complex64::from(resonance * resonance - 0.25 * damping * damping).sqrt();
    let weight = |pole: Complex64| (pole - gap).powi(2) * (gap - pole).ln() / (2.0 * pole);
    let mut sum = Complex64::ZERO;
    for (own, other) in [(middle + half, middle - half), (middle - half, middle + half)] {
        let pole = own.sqrt();
        sum += (weight(pole) + weight(-pole)) / ((own - other) * (own - square));
    }
    // The poles at +-E: the real part alone is that of the principal value.
    let at_energy = |pole: f64| {
        let distance = (gap - pole).abs();
        if distance == 0.0 { 0.0 } else { distance * distance * distance.ln() / (2.0 * pole) }
    };
    let real = sum.re + (at_energy(energy) + at_energy(-energy)) / denominator;
    Complex64::new(-2.0 * strength / PI * real, imaginary)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Dispersion, Grid, liquid_crystal, material};

    const TERMS: [OscillatorTerm; 7] = [
        OscillatorTerm::Lorentz { strength: 1.3, energy_ev: 3.0, damping_ev: 0.4 },
        OscillatorTerm::Lorentz { strength: 2.0, energy_ev: 2.5, damping_ev: 6.0 },
        OscillatorTerm::Gauss { amplitude: 2.0, energy_ev: 2.4, width_ev: 0.5 },
        OscillatorTerm::TaucLorentz { amplitude_ev: 122.0, energy_ev: 3.45, damping_ev: 2.54, gap_ev: 1.2 },
        OscillatorTerm::TaucLorentz { amplitude_ev: 50.0, energy_ev: 3.0, damping_ev: 7.0, gap_ev: 1.0 },
        OscillatorTerm::TaucLorentz { amplitude_ev: 50.0, energy_ev: 3.0, damping_ev: 6.0, gap_ev: 4.0 },
        OscillatorTerm::TaucLorentz { amplitude_ev: 20.0, energy_ev: 4.0, damping_ev: 1.0, gap_ev: 0.0 },
    ];

    /// Real parts by the integral of Kramers and Kronig over the imaginary parts: with the midpoints of intervals about a
    /// photon energy, on which the singularity cancels.
    #[test]
    fn real_parts_are_the_integrals_of_the_imaginary_parts() {
        let step = 0.002;
        for term in TERMS {
            for energy in [1.5, 2.3, 2.9, 3.4] {
                let at = |x: f64| x * term.susceptibility(x).im / (x * x - energy * energy);
                // Up to 2000 eV; beyond, the imaginary parts fall as 1/x^3 or faster.
                let near = (0..10_000).map(|i| step * (f64::from(i) + 0.5) + energy % step);
                let far = (0..10_000).map(|i| 0.2 * (f64::from(i) + 0.5) + 1e4 * step + energy % step);
                let first: f64 = (0..1000).map(|i| at((f64::from(i) + 0.5) * 1e-3 * (energy % step))).sum();
                let sum = step * near.map(at).sum::<f64>()
                    + 0.2 * far.map(at).sum::<f64>()
                    + 1e-3 * (energy % step) * first;
                let (found, expected) = (term.susceptibility(energy).re, 2.0 / PI * sum);
                assert!((found - expected).abs() < 2e-4, "{term:?} at {energy} eV: {found}, not {expected}");
            }
        }
    }

    /// The closed form of Jellison and Modine (1996, with their erratum), with arctangents.
    #[test]
    fn tauc_lorentz_equals_the_published_closed_form() {
        let (a, e0, c, g) = (122.0_f64, 3.45_f64, 2.54_f64, 1.2_f64);
        let amorphous =
            OscillatorTerm::TaucLorentz { amplitude_ev: a, energy_ev: e0, damping_ev: c, gap_ev: g };
        for e in [0.7, 1.1, 1.7, 2.3, 3.1, 4.4] {
            let alpha = (4.0 * e0 * e0 - c * c).sqrt();
            let gamma2 = e0 * e0 - 0.5 * c * c;
            let zeta4 = (e * e - gamma2).powi(2) + 0.25 * (alpha * c).powi(2);
            let a_ln = (g * g - e0 * e0) * e * e + (g * c).powi(2) - e0 * e0 * (e0 * e0 + 3.0 * g * g);
            let a_atan = (e * e - e0 * e0) * (e0 * e0 + g * g) + (g * c).powi(2);
            let ends = (e0 * e0 + g * g + alpha * g) / (e0 * e0 + g * g - alpha * g);
            let angles = PI - ((2.0 * g + alpha) / c).atan() + ((alpha - 2.0 * g) / c).atan();
            let third = PI + 2.0 * (2.0 * (gamma2 - g * g) / (alpha * c)).atan();
            let near = (e - g).abs();
            let last = (near * (e + g) / ((e0 * e0 - g * g).powi(2) + (g * c).powi(2)).sqrt()).ln();
            let sum = c * a_ln / (2.0 * alpha * e0) * ends.ln() - a_atan / e0 * angles
                + 2.0 * e0 * g / alpha * (e * e - gamma2) * third
                - e0 * c * (e * e + g * g) / e * (near / (e + g)).ln()
                + 2.0 * e0 * c * g * last;
            let (found, expected) = (amorphous.susceptibility(e).re, a * sum / (PI * zeta4));
            assert!((found - expected).abs() < 1e-11, "{e} eV: {found}, not {expected}");
        }
    }

    #[test]
    fn models_with_published_constants_are_the_named_materials() {
        let none = Absorption { k: 0.0, at_nm: 400.0, urbach_ev: None };
        let term = |b, um: f64| SellmeierTerm { b, resonance_nm: 1e3 * um };
        let terms = vec![term(0.6961663, 0.0684043), term(0.4079426, 0.1162414), term(0.8974794, 9.896161)];
        let silica = DispersionModel::Sellmeier { eps_inf: 1.0, terms, absorption: none };
        let liquid = DispersionModel::Cauchy { coefficients: [1.4990, 0.0072, 0.0003], absorption: none };
        // Gold of Rakic et al. 1998.
        let lorentz = |(f, damping_ev, energy_ev): (f64, f64, f64)| OscillatorTerm::Lorentz {
            strength: f * (9.03 / energy_ev).powi(2),
            energy_ev,
            damping_ev,
        };
        let bound = [
            (0.024, 0.241, 0.415),
            (0.010, 0.345, 0.830),
            (0.071, 0.870, 2.969),
            (0.601, 2.494, 4.304),
            (4.384, 2.214, 13.32),
        ];
        let mut terms: Vec<OscillatorTerm> = bound.map(lorentz).to_vec();
        terms.push(OscillatorTerm::Drude { plasma_ev: 9.03 * 0.760_f64.sqrt(), damping_ev: 0.053 });
        let gold = Dispersion::model(DispersionModel::Oscillators { eps_inf: 1.0, terms });
        let [silica, liquid] = [silica, liquid].map(Dispersion::model);
        for nm in [400.0, 550.0, 700.0] {
            let same = |model: &Dispersion, expected: Complex64| {
                assert!((model.index(nm).unwrap() - expected).norm() < 1e-12, "{nm} nm");
            };
            same(&silica, material("SiO2").unwrap().index(nm).unwrap());
            same(&liquid, liquid_crystal("E7").unwrap().indices(nm)[0].into());
            same(&gold, material("Au").unwrap().index(nm).unwrap());
        }
    }

    /// Amorphous silicon, with the constants that Jellison and Modine fitted to the measurement of Pierce and Spicer (1972), whose
    /// n and k in Palik's handbook are 4.47 + 1.12i at 500 nm and 4.23 + 0.46i at 620 nm.
    #[test]
    fn amorphous_silicon_is_near_its_measurement() {
        let terms = vec![TERMS[3]];
        let silicon = Dispersion::model(DispersionModel::Oscillators { eps_inf: 1.15, terms });
        for (nm, n, k) in [(500.0, 4.47, 1.12), (620.0, 4.23, 0.46)] {
            assert!((silicon.index(nm).unwrap() - Complex64::new(n, k)).norm() < 0.05, "{nm}");
        }
    }

    #[test]
    fn k_is_an_exponential_of_the_photon_energy() {
        let absorption = Absorption { k: 0.02, at_nm: 400.0, urbach_ev: Some(0.25) };
        let film = Dispersion::model(DispersionModel::Cauchy { coefficients: [1.9, 0.01, 0.0], absorption });
        let expected = 0.02 * ((photon_ev(500.0) - photon_ev(400.0)) / 0.25).exp();
        assert!((film.index(500.0).unwrap() - Complex64::new(1.94, expected)).norm() < 1e-12);
    }

    #[test]
    fn oscillators_are_passive_and_undefined_indices_are_errors() {
        let grid = Grid::new(200.0, 2000.0, 1.0).unwrap();
        for term in TERMS {
            let medium = DispersionModel::Oscillators { eps_inf: 1.0, terms: vec![term] };
            assert!(
                Dispersion::model(medium).on(&grid).unwrap().iter().all(|index| index.im >= 0.0),
                "{term:?}"
            );
        }
        let sharp = OscillatorTerm::Lorentz { strength: 1.0, energy_ev: photon_ev(500.0), damping_ev: 0.0 };
        let sharp = Dispersion::model(DispersionModel::Oscillators { eps_inf: 1.0, terms: vec![sharp] });
        assert!(matches!(sharp.index(500.0), Err(SpectraError::ModelUndefined { .. })));
        let absorption = Absorption { k: 0.0, at_nm: 400.0, urbach_ev: None };
        let terms = vec![SellmeierTerm { b: 1.0, resonance_nm: 450.0 }];
        let near = Dispersion::model(DispersionModel::Sellmeier { eps_inf: 1.0, terms, absorption });
        let error = near.index(430.0).unwrap_err().to_string();
        assert!(error.starts_with("Sellmeier's formula: n^2 = -"), "{error}");
    }
}
