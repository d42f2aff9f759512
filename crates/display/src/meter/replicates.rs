//! Standard errors of the Monte Carlo solver, from the spread of its replicates.
//!
//! Standard errors are computed by the jackknife (Efron 1982): from the metrics of the mean with each
//! replicate left out in turn. For linear quantities this is the usual
//! standard error; for ratios and colour coordinates it includes all correlations between
//! wavelengths and states.

use super::metrics::ViewScalars;
use super::sample::{Sample, relative, spread};
use super::view::Numbers;
use super::{Meter, ViewSamples};
use crate::setup::ViewPoint;

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

    /// Computes the result of a view from the samples of all replicates; `specular` has shape
    /// `[state][light]`. No standard error is below `least` times the value.
    pub(crate) fn view_of_replicates(
        &self,
        at: &ViewPoint,
        samples: &[Sample],
        least: f64,
        specular: &[Vec<f64>],
    ) -> ViewSamples {
        let bare = self.bare_peaks(at, self.setup.stack.base());
        let mean = Sample::mean(samples, None);
        let left_out: Vec<ViewScalars> =
            (0..samples.len()).map(|k| self.scalars(&Sample::mean(samples, Some(k)), &bare)).collect();
        let (of_mean, jackknife) = (self.scalars(&mean, &bare), ViewScalars::jackknife(&left_out));
        let at_least = |error: f64, value: f64| error.max(least * value.abs());
        let errors = Numbers {
            linear: Sample::standard_errors(samples).combine(&mean, at_least),
            scalars: if least > 0.0 {
                ViewScalars::combine(&jackknife, &of_mean, at_least)
            } else {
                jackknife
            },
        };
        let value = Numbers { scalars: of_mean, linear: mean };
        let colours = std::iter::once(&value.scalars).chain(&left_out).map(ViewScalars::colours).collect();
        ViewSamples { view: self.view(at, value, errors, None, specular), colours, of_levels: None }
    }
}
