//! A material by the parameters of a model of its dispersion, which a fit can determine.

use papilio_spectra::{Absorption, DispersionModel, OscillatorTerm, SellmeierTerm};

use super::numbers::{
    Coefficient, Damping, Extinction, HighPermittivity, OscillatorStrength, PhotonEnergy, PositiveEnergy,
    Wavelength,
};
use crate::grammar::{kinds, table};
use crate::read::Spanned;
use crate::tree::Node;

/// Whether a table of an index is a model of dispersion.
pub(crate) fn has_model(node: &Node) -> bool {
    node.get("model").is_some()
}

kinds! {
    /// A model of n + ik; its keys depend on `model`.
    DispersionSpec by "model" {
        /// Cauchy's formula, for transparent media.
        Cauchy(Cauchy) = "cauchy",
        /// Sellmeier's formula, for transparent media.
        Sellmeier(Sellmeier) = "sellmeier",
        /// A sum of oscillators.
        Oscillators(Oscillators) = "oscillators",
    }
}

table! {
    /// A transparent medium by Cauchy's formula, n = a + b/wavelength^2 + c/wavelength^4, with a k of its own.
    Cauchy {
        /// n at long wavelengths.
        a as "Cauchy coefficient a": Coefficient,
        /// Coefficient of 1/wavelength^2, in um^2.
        b_um2 as "Cauchy coefficient b": Coefficient = Coefficient(0.0),
        /// Coefficient of 1/wavelength^4, in um^4.
        c_um4 as "Cauchy coefficient c": Coefficient = Coefficient(0.0),
        /// Extinction coefficient at `k_at_nm`.
        k as "Extinction coefficient k": Extinction = Extinction(0.0),
        /// Wavelength of `k`.
        k_at_nm as "Wavelength of k": Wavelength = Wavelength(400.0),
        /// Photon energy in which k grows by a factor e. Default: k is the same at all wavelengths.
        urbach_ev as "Urbach energy": Option<PositiveEnergy>,
    }
}

table! {
    /// A transparent medium by Sellmeier's formula, n^2 = eps_inf + sum b/(1 - (resonance/wavelength)^2), with a k of its own.
    Sellmeier {
        /// Permittivity far above the resonances.
        eps_inf as "High-energy permittivity": HighPermittivity = HighPermittivity(1.0),
        /// The resonances, up to 64.
        terms as "Terms": Vec<Spanned<SellmeierTermSpec>>,
        /// Extinction coefficient at `k_at_nm`.
        k as "Extinction coefficient k": Extinction = Extinction(0.0),
        /// Wavelength of `k`.
        k_at_nm as "Wavelength of k": Wavelength = Wavelength(400.0),
        /// Photon energy in which k grows by a factor e. Default: k is the same at all wavelengths.
        urbach_ev as "Urbach energy": Option<PositiveEnergy>,
    }
}

table! {
    /// A resonance of Sellmeier's formula.
    SellmeierTermSpec {
        /// Strength.
        b as "Sellmeier strength b": OscillatorStrength,
        /// Wavelength of the resonance, outside the wavelengths of the computation.
        resonance_nm as "Resonance": Wavelength,
    }
}

table! {
    /// A permittivity (n + ik)^2 by a sum of oscillators, each of which obeys the relations of Kramers and Kronig.
    Oscillators {
        /// Permittivity far above the oscillators.
        eps_inf as "High-energy permittivity": HighPermittivity = HighPermittivity(1.0),
        /// The oscillators, up to 64.
        terms as "Terms": Vec<Spanned<OscillatorSpec>>,
    }
}

kinds! {
    /// An oscillator; its keys depend on `kind`.
    OscillatorSpec by "kind" {
        /// A bound resonance.
        Lorentz(Lorentz) = "lorentz",
        /// Free electrons.
        Drude(Drude) = "drude",
        /// A resonance broadened by a Gaussian.
        Gauss(Gauss) = "gauss",
        /// An amorphous semiconductor or insulator.
        TaucLorentz(TaucLorentz) = "tauc-lorentz",
    }
}

table! {
    /// A bound resonance: strength E0^2/(E0^2 - E^2 - i E damping).
    Lorentz {
        /// What it adds to the permittivity at low energy.
        strength as "Oscillator strength": OscillatorStrength,
        /// Energy of the resonance E0.
        energy_ev as "Resonance energy": PositiveEnergy,
        /// Damping: full width at half maximum. 0 only far from the wavelengths of the computation.
        damping_ev as "Damping": Damping,
    }
}

table! {
    /// Free electrons: -plasma^2/(E (E + i damping)).
    Drude {
        /// Plasma energy, with the permittivity of vacuum.
        plasma_ev as "Plasma energy": PhotonEnergy,
        /// Damping: h/(2 pi) over the time between collisions.
        damping_ev as "Damping": Damping,
    }
}

table! {
    /// A resonance whose absorption is a Gaussian of the photon energy.
    Gauss {
        /// Imaginary part of the permittivity at the resonance.
        amplitude as "Amplitude": OscillatorStrength,
        /// Energy of the resonance.
        energy_ev as "Resonance energy": PositiveEnergy,
        /// Full width at half maximum.
        width_ev as "Width": PositiveEnergy,
    }
}

table! {
    /// An amorphous semiconductor or insulator (Jellison and Modine 1996).
    TaucLorentz {
        /// Amplitude A.
        amplitude_ev as "Amplitude": OscillatorStrength,
        /// Energy of the resonance E0.
        energy_ev as "Resonance energy": PositiveEnergy,
        /// Broadening C.
        damping_ev as "Damping": PositiveEnergy,
        /// Gap Eg, below which it does not absorb.
        gap_ev as "Gap energy": PhotonEnergy,
    }
}

impl DispersionSpec {
    /// The model.
    pub(crate) fn model(&self) -> DispersionModel {
        let absorption = |k: &Extinction, at: &Wavelength, urbach: &Option<PositiveEnergy>| Absorption {
            k: k.0,
            at_nm: at.0,
            urbach_ev: urbach.map(|one| one.0),
        };
        match self {
            Self::Cauchy(one) => DispersionModel::Cauchy {
                coefficients: [one.a.0, one.b_um2.0, one.c_um4.0],
                absorption: absorption(&one.k, &one.k_at_nm, &one.urbach_ev),
            },
            Self::Sellmeier(one) => DispersionModel::Sellmeier {
                eps_inf: one.eps_inf.0,
                terms: one
                    .terms
                    .iter()
                    .map(|term| SellmeierTerm { b: term.b.0, resonance_nm: term.resonance_nm.0 })
                    .collect(),
                absorption: absorption(&one.k, &one.k_at_nm, &one.urbach_ev),
            },
            Self::Oscillators(one) => DispersionModel::Oscillators {
                eps_inf: one.eps_inf.0,
                terms: one.terms.iter().map(|term| term.term()).collect(),
            },
        }
    }

    /// Number of its terms.
    pub(crate) fn term_count(&self) -> usize {
        match self {
            Self::Cauchy(_) => 1,
            Self::Sellmeier(one) => one.terms.len(),
            Self::Oscillators(one) => one.terms.len(),
        }
    }

    /// Name of the model in reports.
    pub(crate) fn name(&self) -> &'static str {
        match self {
            Self::Cauchy(_) => "model = \"cauchy\"",
            Self::Sellmeier(_) => "model = \"sellmeier\"",
            Self::Oscillators(_) => "model = \"oscillators\"",
        }
    }
}

impl OscillatorSpec {
    fn term(&self) -> OscillatorTerm {
        match self {
            Self::Lorentz(one) => OscillatorTerm::Lorentz {
                strength: one.strength.0,
                energy_ev: one.energy_ev.0,
                damping_ev: one.damping_ev.0,
            },
            Self::Drude(one) => {
                OscillatorTerm::Drude { plasma_ev: one.plasma_ev.0, damping_ev: one.damping_ev.0 }
            }
            Self::Gauss(one) => OscillatorTerm::Gauss {
                amplitude: one.amplitude.0,
                energy_ev: one.energy_ev.0,
                width_ev: one.width_ev.0,
            },
            Self::TaucLorentz(one) => OscillatorTerm::TaucLorentz {
                amplitude_ev: one.amplitude_ev.0,
                energy_ev: one.energy_ev.0,
                damping_ev: one.damping_ev.0,
                gap_ev: one.gap_ev.0,
            },
        }
    }
}
