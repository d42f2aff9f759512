//! Standard errors of the Monte Carlo solver, from the spread of its replicates.
//!
//! Standard errors are computed by the jackknife (Efron 1982): from the metrics of the mean with each
//! replicate left out in turn. For linear quantities this is the usual
//! standard error; for ratios and colour coordinates it includes all correlations between
//! wavelengths and states.

use super::metrics::ViewScalars;
use super::sample::{Layout, Sample, relative, spread};
use super::view::Numbers;
use super::{Meter, ViewSamples};
use crate::setup::ViewPoint;

/// Rounding error of a fraction of the light.
const ROUNDING: f64 = 1e-12;

/// Fraction of the light of one path to which replicates agree if they have met an event equally often.
const AGREEMENT: f64 = 0.1;

/// Smallest standard errors: replicates may all meet an event equally often, or all miss it.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct LeastErrors {
    /// Relative to each value.
    pub(crate) relative: f64,
    /// Number of random paths of the energy balance; 0 if it is a smooth sum over directions.
    pub(crate) paths: u64,
    /// Whether all paths may miss what lies below a thick slab.
    pub(crate) is_below_slabs: bool,
}

impl LeastErrors {
    /// Returns the light of one path, and the standard error of a fraction of the light that all paths may have
    /// missed. By the rule of three, its probability is below 3/n with a confidence of 95 %, which is two standard errors.
    fn of_balance(self) -> Option<(f64, f64)> {
        (self.paths > 0).then(|| (1.0 / self.paths as f64, 1.5 / self.paths as f64))
    }
}

impl Meter<'_> {
    /// Returns the largest relative standard error of Y over the states and, with `per_wavelength`, of
    /// the radiance at each wavelength, relative to the maximum of the spectrum.
    pub(crate) fn standard_error(&self, samples: &[Sample], per_wavelength: bool) -> f64 {
        let mut worst = 0.0_f64;
        for state in 0..self.layout.states {
            let y = |sample: &Sample| self.luminous(state, sample);
            worst = worst.max(relative(spread(samples.iter().map(y))));
            if per_wavelength {
                let at = self.layout.radiance(state);
                let bins: Vec<(f64, f64)> = at.map(|k| spread(samples.iter().map(|s| s.0[k]))).collect();
                let most = bins.iter().map(|(mean, _)| *mean).fold(0.0, f64::max);
                worst = bins.iter().map(|(_, error)| relative((most, *error))).fold(worst, f64::max);
            }
        }
        worst
    }

    /// Returns Y of each state, and its standard error.
    pub(crate) fn luminous_means(&self, samples: &[Sample]) -> Vec<(f64, f64)> {
        (0..self.layout.states)
            .map(|state| spread(samples.iter().map(|sample| self.luminous(state, sample))))
            .collect()
    }

    /// Returns Y of each state in each sample.
    pub(crate) fn luminous_values(&self, samples: &[Sample]) -> Vec<Vec<f64>> {
        let of_state = |state| samples.iter().map(|sample| self.luminous(state, sample)).collect();
        (0..self.layout.states).map(of_state).collect()
    }

    /// Computes the result of a view from the samples of all replicates; `specular` has shape
    /// `[state][light]`. No standard error is below `least`.
    pub(crate) fn view_of_replicates(
        &self,
        at: &ViewPoint,
        samples: &[Sample],
        least: LeastErrors,
        specular: &[Vec<f64>],
    ) -> ViewSamples {
        let bare = self.bare_peaks(at, self.setup.stack.base());
        let mean = Sample::mean(samples, None);
        let left_out: Vec<ViewScalars> =
            (0..samples.len()).map(|k| self.scalars(&Sample::mean(samples, Some(k)), &bare)).collect();
        let (of_mean, jackknife) = (self.scalars(&mean, &bare), ViewScalars::jackknife(&left_out));
        let at_least = |error: f64, value: f64| error.max(least.relative * value.abs());
        let mut linear = Sample::standard_errors(samples).combine(&mean, at_least);
        (0..self.layout.states).for_each(|state| self.raise_errors(state, (&mean, &mut linear), least));
        let errors = Numbers {
            linear,
            scalars: if least.relative > 0.0 {
                ViewScalars::combine(&jackknife, &of_mean, at_least)
            } else {
                jackknife
            },
        };
        let value = Numbers { scalars: of_mean, linear: mean };
        let colours = std::iter::once(&value.scalars).chain(&left_out).map(ViewScalars::colours).collect();
        ViewSamples { view: self.view(at, value, errors, None, specular), colours, of_levels: None }
    }
    /// Raises the errors of the energy balance where the replicates agree too well, and those of light from below thick
    /// slabs.
    fn raise_errors(&self, state: usize, (mean, errors): (&Sample, &mut Sample), least: LeastErrors) {
        let Some((of_path, missed)) = least.of_balance() else { return };
        let balance = self.layout.ledger(state);
        for entry in balance.clone().filter(|entry| mean.0[*entry].abs() > ROUNDING) {
            if errors.0[entry] < AGREEMENT * of_path {
                errors.0[entry] = missed;
            }
        }
        if least.is_below_slabs {
            let is_inactive = self.setup.stack.base().inactive_absorptance.max() > 0.0;
            // Exactly 0 if no path has passed.
            let pixel = [balance.start + Layout::OF_PIXEL].into_iter();
            let inactive = is_inactive.then_some(balance.start + Layout::OF_INACTIVE);
            for entry in pixel.chain(inactive).chain(self.layout.terms(state)) {
                errors.0[entry] = errors.0[entry].max(missed);
            }
        }
    }
}
