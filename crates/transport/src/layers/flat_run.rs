//! Flat layers between two scatterers, or between a scatterer and the air (or, with the mirror itself, a mirror:
//! `mirror_run.rs`): s and p are kept apart through all of
//! them, and the light that leaves counts as unpolarised, because what it meets next scatters it.
//!
//! Transmittance and reflectances are the means over s and p of those of the whole run, all inter-reflections
//! included, instead of being summed from the means of each face. Each polarisation
//! has interfaces of its own ([`Interface::FresnelOf`], coatings); the media are the same for both.

use super::{Crossed, Incidence, Interface, LayerKind, Medium};
use crate::estimate::Account;
use crate::front::Flat;

/// Flat interfaces with the media between them.
#[derive(Debug, Clone, PartialEq)]
pub struct FlatRun {
    /// Top to bottom, for light of s and of p.
    interfaces: [Vec<Interface>; 2],
    /// Between the interfaces: one fewer.
    media: Vec<Medium>,
}

impl FlatRun {
    /// Returns the run of these interfaces, for s and for p, with the media between them. None may scatter.
    pub fn new(interfaces: [Vec<Interface>; 2], media: Vec<Medium>) -> Self {
        debug_assert!(interfaces.iter().all(|own| own.len() == media.len() + 1));
        Self { interfaces, media }
    }

    /// Its interfaces for s and for p.
    pub(crate) fn interfaces(&self) -> &[Vec<Interface>; 2] {
        &self.interfaces
    }

    /// The run for s and for p.
    pub(crate) fn of_each(&self, at: &Incidence) -> [Flat; 2] {
        self.interfaces.each_ref().map(|own| self.of(own, at))
    }

    /// What the run does to the product of p and s.
    pub(crate) fn crossed(&self, at: &Incidence) -> Crossed {
        let mut above = at.indices[0];
        let mut whole = Crossed::CLEAR;
        for (number, interface) in self.interfaces[0].iter().enumerate() {
            let medium = self.media.get(number);
            let below = medium.map_or(at.indices[1], |medium| medium.index()[at.bin]);
            let here = Incidence { indices: [above, below], ..*at };
            let flats = self.interfaces.each_ref().map(|own| own[number].kind().regular(&here));
            whole = whole.over(Crossed::of(interface, flats, &here));
            if let Some(medium) = medium {
                let passes = medium.regular(&Incidence { indices: [below; 2], ..*at });
                whole = whole.over(Crossed::of_both(passes, 1.0));
            }
            above = below;
        }
        whole
    }

    /// The run for one polarisation.
    fn of(&self, interfaces: &[Interface], at: &Incidence) -> Flat {
        let mut above = at.indices[0];
        let mut whole = Flat::CLEAR;
        for (number, interface) in interfaces.iter().enumerate() {
            let medium = self.media.get(number);
            let below = medium.map_or(at.indices[1], |medium| medium.index()[at.bin]);
            whole = whole.over(interface.kind().regular(&Incidence { indices: [above, below], ..*at }));
            if let Some(medium) = medium {
                whole = whole.over(medium.regular(&Incidence { indices: [below; 2], ..*at }));
            }
            above = below;
        }
        whole
    }
}

impl LayerKind for FlatRun {
    fn regular(&self, at: &Incidence) -> Flat {
        Flat::mean(self.of_each(at))
    }

    fn is_colourless(&self) -> bool {
        let is_clear =
            |medium: &Medium| medium.constant_index().is_some() && medium.transmittance().is_none();
        self.interfaces.iter().flatten().all(|one| one.kind().is_colourless())
            && self.media.iter().all(is_clear)
    }

    /// That of its sheets, if it has any.
    fn account(&self) -> Account {
        let is_sheet = |interface: &Interface| matches!(interface, Interface::Component(_));
        if self.interfaces[0].iter().any(is_sheet) { Account::Front } else { Account::Glass }
    }

    fn edges(&self, bin: usize) -> Vec<f64> {
        self.media.iter().map(|medium| medium.index()[bin]).collect()
    }

    fn pieces(&self, bin: usize) -> Vec<f64> {
        self.interfaces.iter().flatten().flat_map(|interface| interface.kind().pieces(bin)).collect()
    }

    fn spectral_key(&self, bin: usize, key: &mut Vec<u64>) {
        self.interfaces.iter().flatten().for_each(|interface| interface.kind().spectral_key(bin, key));
        self.media.iter().for_each(|medium| medium.spectral_key(bin, key));
    }
}

#[cfg(test)]
pub(super) mod tests {
    use papilio_optics::film::Polarisation;

    use super::*;

    /// Two panes with air between them, for two wavelengths, between media of indices 1.3 and 1.5.
    pub(in super::super) fn of_two_panes() -> FlatRun {
        let of = |polarisation| vec![Interface::FresnelOf(polarisation); 4];
        let medium = |index: f64| Medium::new(vec![index; 2].into());
        let absorbing = medium(1.5).with_transmittance(vec![0.9, 0.8].into());
        FlatRun::new([Polarisation::S, Polarisation::P].map(of), vec![absorbing, medium(1.0), medium(1.5)])
    }

    /// A pane in air: r and (1 - r) of each polarisation, summed over all orders.
    #[test]
    fn pane_is_the_mean_of_two_geometric_series() {
        let of = |polarisation| vec![Interface::FresnelOf(polarisation); 2];
        let glass = Medium::new(vec![1.5].into());
        let run = FlatRun::new([Polarisation::S, Polarisation::P].map(of), vec![glass]);
        let beta = 60.0_f64.to_radians().sin();
        let found = run.regular(&Incidence { bin: 0, indices: [1.0; 2], beta, beta_squared: beta * beta });
        // Fresnel at 60 deg (Born and Wolf, 1.5.2).
        let [s, p] = [0.176_571_0_f64, 0.001_802_4];
        let through = 0.5 * ((1.0 - s) / (1.0 + s) + (1.0 - p) / (1.0 + p));
        assert!((found.t - through).abs() < 1e-6, "{found:?}");
        assert!((found.above - (1.0 - through)).abs() < 1e-6 && found.above == found.below, "{found:?}");
    }
}
