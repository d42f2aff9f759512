//! Coherent thin films between two media.

use papilio_optics::film::Coating;

use super::{Incidence, LayerKind};
use crate::front::Flat;

impl LayerKind for Coating {
    fn regular(&self, at: &Incidence) -> Flat {
        let part = self.part(at.beta_squared, at.bin);
        Flat { t: part.transmittance, above: part.above, below: part.below }
    }

    fn pieces(&self, bin: usize) -> Vec<f64> {
        self.pieces(bin)
    }

    fn spectral_key(&self, bin: usize, key: &mut Vec<u64>) {
        key.push(bin as u64);
    }
}
