//! A front-of-screen component in a medium: it reflects and absorbs these fractions at every angle, the same
//! from both sides. The media have the same index.

use papilio_spectra::Spectrum;

use super::{Incidence, Interface, LayerKind};
use crate::estimate::Account;
use crate::front::Flat;

/// A flat component that is the same from both sides and at all angles.
#[derive(Debug, Clone, PartialEq)]
pub struct Component {
    /// Fraction reflected, per wavelength.
    pub reflectance: Spectrum,
    /// Fraction absorbed, per wavelength.
    pub absorptance: Spectrum,
}

impl Interface {
    /// A component that reflects and absorbs these fractions.
    pub fn component(reflectance: Spectrum, absorptance: Spectrum) -> Self {
        Self::Component(Component { reflectance, absorptance })
    }
}

impl LayerKind for Component {
    fn regular(&self, at: &Incidence) -> Flat {
        let r = self.reflectance[at.bin];
        Flat { t: 1.0 - r - self.absorptance[at.bin], above: r, below: r }
    }

    fn account(&self) -> Account {
        Account::Front
    }

    fn lies_in_one_medium(&self) -> bool {
        true
    }

    fn front_component(&self) -> Option<[&Spectrum; 2]> {
        Some([&self.reflectance, &self.absorptance])
    }

    fn spectral_key(&self, bin: usize, key: &mut Vec<u64>) {
        key.extend([self.reflectance[bin].to_bits(), self.absorptance[bin].to_bits()]);
    }
}
