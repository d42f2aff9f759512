//! Reflectance factors and ledger, computed from the light at the underside of the diffuser.

use papilio_spectra::StateSpectra;

use crate::{Diffuser, Estimate, Ledger, Panel, ReflectanceFactor, Source};

/// Whether the ledger is requested.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum LedgerRequest {
    Requested,
    /// `arriving` and `reflected` lack recycled light.
    Omitted,
}

/// All orders of light between diffuser and base for one view, without the factors `t^2 T^2` (see the tracer
/// of the Monte Carlo solver); shapes `[state][wavelength]`.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Sums {
    /// Light that reaches the base.
    pub(super) arriving: Vec<f64>,
    /// Light reflected by the base.
    pub(super) reflected: Vec<f64>,
    /// Light that leaves the diffuser upwards, into directions from which diffuse light comes.
    pub(super) leaving: Vec<f64>,
    /// `pi` times the kernel towards each directed source; empty for diffuse light.
    pub(super) directed: Vec<Vec<f64>>,
}

impl Sums {
    pub(super) fn zeros(len: usize, sources: &[Source]) -> Self {
        let directed = |source: &Source| vec![0.0; if *source == Source::Diffuse { 0 } else { len }];
        Self {
            arriving: vec![0.0; len],
            reflected: vec![0.0; len],
            leaving: vec![0.0; len],
            directed: sources.iter().map(directed).collect(),
        }
    }

    /// Combines with another set, array by array.
    pub(super) fn zip(&mut self, other: &Self, mut f: impl FnMut(&mut [f64], &[f64])) {
        f(&mut self.arriving, &other.arriving);
        f(&mut self.reflected, &other.reflected);
        f(&mut self.leaving, &other.leaving);
        self.directed.iter_mut().zip(&other.directed).for_each(|(a, b)| f(a, b));
    }

    pub(super) fn estimate(self, stack: &Panel, diffuser: &Diffuser, sources: &[Source]) -> Estimate {
        let ledger = self.ledger(stack, diffuser);
        Estimate { rho: self.rho(stack, diffuser, sources), ledger }
    }

    pub(super) fn rho(
        self,
        stack: &Panel,
        diffuser: &Diffuser,
        sources: &[Source],
    ) -> Vec<ReflectanceFactor> {
        let front = &stack.front;
        let through: Vec<f64> = front
            .transmittance
            .iter()
            .zip(diffuser.transmittance.iter())
            .map(|(t, d)| (t * d).powi(2))
            .collect();
        let rho = sources.iter().zip(self.directed).map(|(source, directed)| {
            let (mut base, front) = match source {
                Source::Diffuse => (self.leaving.clone(), front.reflectance_above.to_vec()),
                _ => (directed, vec![0.0; through.len()]),
            };
            for row in base.chunks_exact_mut(through.len()) {
                row.iter_mut().zip(&through).for_each(|(value, t)| *value *= t);
            }
            ReflectanceFactor { via_pixel: StateSpectra::new(base, through.len()), front }
        });
        rho.collect()
    }

    fn ledger(&self, stack: &Panel, diffuser: &Diffuser) -> Ledger {
        let mut ledger = Ledger::zeros(stack.base.states(), stack.base.bins());
        let (front, inactive) = (&stack.front, &stack.base.inactive_absorptance);
        let bins = inactive.len();
        for first in (0..self.arriving.len()).step_by(bins.max(1)) {
            for bin in 0..bins {
                let k = first + bin;
                let (flat, t) = (front.at(bin), diffuser.transmittance[bin]);
                // Fractions at the upper and lower side of the diffuser.
                let (above, below) = (flat.t, flat.t * t);
                let up = below * t * self.leaving[k];
                let sent_back = up * flat.below;
                let entering = if stack.single_pass { above } else { above + sent_back };
                ledger.inactive[k] = below * self.arriving[k] * inactive[bin];
                ledger.pixel[k] = below * (self.arriving[k] - self.reflected[k]) - ledger.inactive[k];
                ledger.diffuser[k] = entering - below * self.arriving[k] + below * self.reflected[k] - up;
                ledger.returned[k] = flat.above + up * flat.t;
                ledger.front[k] = 1.0 - flat.t - flat.above + up * (1.0 - flat.t - flat.below);
                ledger.unaccounted[k] = if stack.single_pass { sent_back } else { 0.0 };
            }
        }
        ledger
    }
}
