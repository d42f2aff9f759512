//! A diffuser given by its BTDF, including its surfaces. It reflects nothing (see
//! [`reflecting`](super::reflecting)).
//!
//! Light that its lobe scatters beyond the index of the medium, above (1 in air) or below, is absorbed.

use papilio_optics::Scatterer;
use papilio_optics::lobe::Lobe;
use papilio_spectra::Spectrum;

use super::{Action, Narrowness, Preparation};
use super::{Arrival, Channel, Departure, Incidence, LayerKind, Scattered, ScatteringInterface};
use crate::estimate::Account;
use crate::front::Flat;
use crate::skeleton::Propagation;

/// A diffuser given by its BTDF.
#[derive(Debug, Clone, PartialEq)]
pub struct Diffuser {
    /// Angular shape of the scattered part.
    pub lobe: Lobe,
    /// T, including regular transmittance, per wavelength.
    pub transmittance: Spectrum,
    /// Fraction of the transmitted light that keeps its direction.
    pub regular_fraction: f64,
}

impl LayerKind for Diffuser {
    fn passes_regularly(&self) -> bool {
        self.regular_fraction > 0.0
    }

    fn regular(&self, at: &Incidence) -> Flat {
        let straight = if at.both_carry() { self.transmittance[at.bin] * self.regular_fraction } else { 0.0 };
        Flat { t: straight, above: 0.0, below: 0.0 }
    }

    fn scattered(&self, at: &Incidence) -> [f64; 2] {
        [self.transmittance[at.bin] * (1.0 - self.regular_fraction); 2]
    }

    fn account(&self) -> Account {
        Account::Diffuser
    }

    fn narrowness(&self) -> Option<Narrowness> {
        match self.lobe {
            Lobe::KCorrelation { width } => Some(Narrowness::Lobe { width }),
            Lobe::Lambertian => None,
        }
    }

    fn spectral_key(&self, bin: usize, key: &mut Vec<u64>) {
        key.push(self.transmittance[bin].to_bits());
    }

    fn action<'a>(&'a self, prepare: &mut dyn Preparation<'a>) -> Option<Action> {
        let scattered = self.transmittance[prepare.bin()] * (1.0 - self.regular_fraction);
        Some(Action::Kernels([vec![(prepare.lobe(self.lobe), scattered)], Vec::new(), Vec::new()]))
    }

    fn scattering_interface(&self) -> Option<&dyn ScatteringInterface> {
        Some(self)
    }
}

impl ScatteringInterface for Diffuser {
    fn channels(&self, _: Propagation) -> Vec<Channel> {
        vec![Channel::Through]
    }

    fn scatter(&self, from: Arrival, to: Departure) -> Scattered {
        Scattered::exactly(self.lobe.density(from.beta, to.beta))
    }

    fn sample(&self, from: Arrival, u: [f64; 4]) -> Option<(Departure, Scattered)> {
        let sample = self.lobe.sample(from.beta, u)?;
        let to = Departure { beta: sample.direction, going: from.going };
        Some((to, Scattered::exactly(sample.density)))
    }

    fn scatters_beyond_media(&self) -> bool {
        true
    }
}
