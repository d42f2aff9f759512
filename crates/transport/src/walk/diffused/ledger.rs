//! Sums over paths, and the reflectance factors and the ledger that follow from them.

use papilio_optics::Beta;
use papilio_spectra::StateSpectra;

use super::Diffused;
use crate::Source;
use crate::walk::accumulator::{Channel, Incident};
use crate::walk::scale_rows;
use crate::{Estimate, Ledger, ReflectanceFactor, specular};

/// Sums of a replicate, and a workspace.
#[derive(Debug, Clone)]
pub(in crate::walk) struct Accumulator {
    pub(super) sums: Sums,
    pub(super) workspace: Workspace,
}

#[derive(Debug, Clone)]
pub(super) struct Sums {
    /// Light that enters the diffuser from above.
    pub(super) entering: Incident,
    /// Light that reaches the base.
    pub(super) arriving: Incident,
    /// Light reflected by the base, except for look-ups in panels: their sum is that of `leaving` without
    /// weights.
    pub(super) reflected: Channel,
    /// Light that leaves the diffuser upwards, into directions from which diffuse light comes.
    pub(super) leaving: Channel,
    /// For each source: contributions after the base, by connection or (for a disc) by chance.
    pub(super) from_source: Vec<Channel>,
    /// For each beam: connections before the base, to light that passed the diffuser unscattered.
    pub(super) from_straight_beam: Vec<Incident>,
}

/// Spectra of the current path; shape `[state][wavelength]`.
#[derive(Debug, Clone)]
pub(super) struct Workspace {
    /// Spectra that the path carries; meaningful from its second pass on.
    pub(super) carried: Vec<f64>,
    /// `carried` times the reflectance of the base.
    pub(super) reflected: Vec<f64>,
    /// The same for light sampled backwards from a source.
    pub(super) backwards: Vec<f64>,
}

impl Diffused<'_> {
    pub(in crate::walk) fn tally(&self) -> Accumulator {
        let base = &self.stack.base;
        let len = base.states() * base.bins();
        Accumulator {
            sums: Sums {
                entering: Incident::new(len),
                arriving: Incident::new(len),
                reflected: Channel::new(base),
                leaving: Channel::new(base),
                from_source: self.sources.iter().map(|_| Channel::new(base)).collect(),
                from_straight_beam: self.sources.iter().map(|_| Incident::new(len)).collect(),
            },
            workspace: Workspace {
                carried: vec![0.0; len],
                reflected: vec![0.0; len],
                backwards: vec![0.0; len],
            },
        }
    }

    /// Returns the means of several replicates, each from its sums and the factor that turns them into
    /// means.
    pub(in crate::walk) fn estimates(&self, replicates: &[(&Accumulator, f64)]) -> Vec<Estimate> {
        let base = &self.stack.base;
        let mut channels = Vec::with_capacity(replicates.len() * (2 + self.sources.len()));
        for (tally, scale) in replicates {
            let Sums { reflected, leaving, from_source, .. } = &tally.sums;
            let [of_leaving, looked_up] = leaving.node_weights();
            let [mut of_reflected, _] = reflected.node_weights();
            of_reflected.iter_mut().zip(&looked_up).for_each(|(weight, more)| *weight += more);
            channels.extend([(reflected, of_reflected, *scale), (leaving, of_leaving, *scale)]);
            for channel in self.directed_only(from_source) {
                let [weights, _] = channel.node_weights();
                channels.push((channel, weights, *scale));
            }
        }
        let spectra = Channel::sums(&channels, base);
        let of_one = (2 + self.directed_only(&self.sources).count()) * base.states() * base.bins();
        replicates
            .iter()
            .zip(spectra.chunks_exact(of_one.max(1)))
            .map(|((tally, scale), spectra)| self.estimate(&tally.sums, spectra, *scale))
            .collect()
    }

    /// Selects the directed sources from a list by source.
    fn directed_only<'s, T>(&'s self, of_source: &'s [T]) -> impl Iterator<Item = &'s T> {
        let directed = |(source, of): (&Source, &'s T)| (*source != Source::Diffuse).then_some(of);
        self.sources.iter().zip(of_source).filter_map(directed)
    }

    /// Returns the mean of one replicate; `spectra`: reflected, leaving, and by directed source.
    fn estimate(&self, sums: &Sums, spectra: &[f64], scale: f64) -> Estimate {
        let mut spectra = spectra.chunks_exact(self.through.len() * self.stack.base.states());
        let mut next = || spectra.next().unwrap_or_default();
        let (reflected, leaving) = (next(), next());
        let of_source = |(i, source): (usize, &Source)| {
            let mut base = match source {
                Source::Diffuse => leaving.to_vec(),
                Source::Beam(beam) => {
                    self.beam_light(*beam, &sums.from_straight_beam[i], next().to_vec(), scale)
                }
                Source::Disc(_) | Source::Field(_) => next().to_vec(),
            };
            scale_rows(&mut base, &self.through);
            let front = match source {
                Source::Diffuse => self.stack.front.reflectance_above.to_vec(),
                _ => vec![0.0; self.through.len()],
            };
            ReflectanceFactor { via_pixel: StateSpectra::new(base, self.through.len()), front }
        };
        let rho = self.sources.iter().enumerate().map(of_source).collect();
        let ledger = self.ledger(&sums.entering.sum(scale), &sums.arriving.sum(scale), reflected, leaving);
        Estimate { rho, ledger }
    }

    /// Returns the light of a beam, which reaches the diffuser also through its own specular round trips.
    fn beam_light(&self, beam: Beta, before: &Incident, connected: Vec<f64>, scale: f64) -> Vec<f64> {
        let mut base = connected;
        if self.straight() == 0.0 || !self.specular {
            return base;
        }
        let mut r = vec![0.0; base.len()];
        self.reflectance(beam, &mut r);
        let before = before.sum(scale);
        let round_trips = specular::round_trips(self.stack, self.diffuser, &r);
        for (k, value) in base.iter_mut().enumerate() {
            *value = (*value + self.straight() * r[k] * before[k]) * round_trips[k];
        }
        base
    }

    fn ledger(&self, entering: &[f64], arriving: &[f64], reflected: &[f64], leaving: &[f64]) -> Ledger {
        let base = &self.stack.base;
        let mut ledger = Ledger::zeros(base.states(), base.bins());
        let (front, inactive) = (&self.stack.front, &self.stack.base.inactive_absorptance);
        // Rows of equal length, so that no bound is checked at each wavelength.
        let bins = inactive.len();
        let [t, r_above, r_below] =
            [&front.transmittance, &front.reflectance_above, &front.reflectance_below].map(|of| &of[..bins]);
        let (diffuser, inactive) = (&self.diffuser.transmittance[..bins], &inactive[..bins]);
        for state in (0..entering.len()).step_by(bins.max(1)) {
            let at = state..state + bins;
            let [entering, arriving, reflected, leaving] =
                [entering, arriving, reflected, leaving].map(|of| &of[at.clone()][..bins]);
            let Ledger {
                returned,
                front,
                diffuser: by_diffuser,
                pixel,
                inactive: by_inactive,
                unaccounted,
                ..
            } = &mut ledger;
            let [returned, front, by_diffuser, pixel, by_inactive, unaccounted] =
                [returned, front, by_diffuser, pixel, by_inactive, unaccounted]
                    .map(|of| &mut of[at.clone()][..bins]);
            for k in 0..bins {
                // Fractions at the upper and lower side of the diffuser.
                let (above, below) = (t[k], t[k] * diffuser[k]);
                let up = below * diffuser[k] * leaving[k];
                by_inactive[k] = below * arriving[k] * inactive[k];
                pixel[k] = below * (arriving[k] - reflected[k]) - by_inactive[k];
                by_diffuser[k] = above * entering[k] - below * arriving[k] + below * reflected[k] - up;
                returned[k] = r_above[k] + up * t[k];
                front[k] = 1.0 - t[k] - r_above[k] + up * (1.0 - t[k] - r_below[k]);
                unaccounted[k] = up * r_below[k] - above * (entering[k] - 1.0);
            }
        }
        ledger
    }
}
