//! The sums of the paths, and what they mean: reflectance factors and the ledger.

use papilio_optics::Beta;

use super::Diffused;
use crate::Source;
use crate::walk::scale_rows;
use crate::walk::tally::{Channel, Incident};
use crate::{Estimate, Ledger, Rho, specular};

/// The sums of a replicate, and room to work in.
#[derive(Debug, Clone)]
pub(in crate::walk) struct Tally {
    pub(super) sums: Sums,
    pub(super) room: Room,
}

#[derive(Debug, Clone)]
pub(super) struct Sums {
    /// Enters the diffuser from above.
    pub(super) entering: Incident,
    /// Reaches the base.
    pub(super) arriving: Incident,
    /// Reflected by the base.
    pub(super) reflected: Channel,
    /// Leaves the diffuser upwards: what diffuse light sees.
    pub(super) leaving: Channel,
    /// For each source: after the base, by connection or (a disc) by chance.
    pub(super) from_source: Vec<Channel>,
    /// For each beam: connections before the base, to light that came straight through.
    pub(super) from_straight_beam: Vec<Incident>,
}

/// Spectra of the path at hand; shape `[state][wavelength]`.
#[derive(Debug, Clone)]
pub(super) struct Room {
    /// What the path carries; meaningful from its second pass on.
    pub(super) carried: Vec<f64>,
    /// `carried` times the base's reflectance.
    pub(super) reflected: Vec<f64>,
    /// The same for light sampled backwards from a source.
    pub(super) backwards: Vec<f64>,
}

impl Diffused<'_> {
    pub(in crate::walk) fn tally(&self) -> Tally {
        let base = &self.stack.base;
        let len = base.states() * base.bins();
        Tally {
            sums: Sums {
                entering: Incident::new(len),
                arriving: Incident::new(len),
                reflected: Channel::new(base),
                leaving: Channel::new(base),
                from_source: self.sources.iter().map(|_| Channel::new(base)).collect(),
                from_straight_beam: self.sources.iter().map(|_| Incident::new(len)).collect(),
            },
            room: Room { carried: vec![0.0; len], reflected: vec![0.0; len], backwards: vec![0.0; len] },
        }
    }

    pub(in crate::walk) fn estimate(&self, tally: &Tally, scale: f64) -> Estimate {
        let sums = &tally.sums;
        let base = &self.stack.base;
        let reflected = sums.reflected.sum(base, scale);
        let leaving = sums.leaving.sum(base, scale);
        let rho = (0..self.sources.len()).map(|i| self.rho(i, sums, &leaving, scale)).collect();
        let ledger = self.ledger(&sums.entering.sum(scale), &sums.arriving.sum(scale), &reflected, &leaving);
        Estimate { rho, ledger }
    }

    /// Reflectance factor under source `i` alone.
    fn rho(&self, i: usize, sums: &Sums, leaving: &[f64], scale: f64) -> Rho {
        let front = &self.stack.front;
        let through: Vec<f64> = front
            .transmittance
            .iter()
            .zip(self.diffuser.transmittance.iter())
            .map(|(t, diffuser)| (t * diffuser).powi(2))
            .collect();
        let mut base = match &self.sources[i] {
            Source::Diffuse => leaving.to_vec(),
            Source::Beam(beam) => self.beam_light(i, *beam, sums, scale),
            Source::Disc(_) | Source::Field(_) => sums.from_source[i].sum(&self.stack.base, scale),
        };
        let front = match &self.sources[i] {
            Source::Diffuse => front.reflectance_above.to_vec(),
            _ => vec![0.0; through.len()],
        };
        scale_rows(&mut base, &through);
        Rho { base, front }
    }

    /// A beam's light reaches the diffuser also by way of its own specular round trips.
    fn beam_light(&self, i: usize, beam: Beta, sums: &Sums, scale: f64) -> Vec<f64> {
        let mut base = sums.from_source[i].sum(&self.stack.base, scale);
        if self.straight() == 0.0 || !self.specular {
            return base;
        }
        let mut r = vec![0.0; base.len()];
        self.reflectance(beam, &mut r);
        let before = sums.from_straight_beam[i].sum(scale);
        let round_trips = specular::round_trips(self.stack, self.diffuser, &r);
        for (k, value) in base.iter_mut().enumerate() {
            *value = (*value + self.straight() * r[k] * before[k]) * round_trips[k];
        }
        base
    }

    fn ledger(&self, entering: &[f64], arriving: &[f64], reflected: &[f64], leaving: &[f64]) -> Ledger {
        let mut ledger = Ledger::zeros(entering.len());
        let (front, inactive) = (&self.stack.front, &self.stack.base.inactive_absorptance);
        for k in 0..entering.len() {
            let bin = k % inactive.len();
            let (flat, diffuser) = (front.at(bin), self.diffuser.transmittance[bin]);
            // Shares at the diffuser's upper and lower side.
            let (above, below) = (flat.t, flat.t * diffuser);
            let up = below * diffuser * leaving[k];
            ledger.inactive[k] = below * arriving[k] * inactive[bin];
            ledger.pixel[k] = below * (arriving[k] - reflected[k]) - ledger.inactive[k];
            ledger.diffuser[k] = above * entering[k] - below * arriving[k] + below * reflected[k] - up;
            ledger.returned[k] = flat.above + up * flat.t;
            ledger.front[k] = 1.0 - flat.t - flat.above + up * (1.0 - flat.t - flat.below);
            ledger.unaccounted[k] = up * flat.below - above * (entering[k] - 1.0);
        }
        ledger
    }
}
