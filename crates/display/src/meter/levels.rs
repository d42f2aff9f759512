//! Errors of adding: the difference between two levels of discretisation.
//!
//! The finer level's numbers are reported. Each level gains much on the one before, so the
//! difference is nearly the coarser one's error, and bounds the finer one's from above (where
//! levels gain little, it is multiplied: [`error_over_difference`]). One number may have hardly
//! changed by chance: none is claimed to be better, relatively, than the worst Y of its view.

use papilio_transport::adding::error_over_difference;

use super::metrics::ViewScalars;
use super::sample::{Sample, relative};
use super::view::Numbers;
use super::{ViewSamples, Meter};
use crate::run::{largest, level_error};
use crate::setup::{ViewPoint, base_under};

/// No number is claimed to be better, relatively: what is tabulated over direction (films) and summed over wavelengths is not.
const LEAST_CLAIMED: f64 = 1e-7;

/// Of the largest Y, what is no more than rounding of sums.
const ROUNDING: f64 = 1e-9;

/// How a number's error follows from its values at two levels.
#[derive(Debug, Clone, Copy)]
pub(super) struct LevelError {
    /// Errors over differences.
    times: f64,
    /// The least error claimed, relative.
    least: f64,
}

impl LevelError {
    pub(super) fn of(&self, finer: f64, coarser: f64) -> f64 {
        (self.times * (finer - coarser).abs()).max(self.least * finer.abs())
    }
}

impl Meter<'_> {
    /// The largest relative error of Y over the states, of the last of two or three levels; with `every_bin`, also of the
    /// radiance at each wavelength, against the spectrum's maximum. Of a Y below zero, which no light has, it is one at least.
    pub(crate) fn level_error(
        &self,
        [finer, coarser]: [&Sample; 2],
        before: Option<&Sample>,
        every_bin: bool,
    ) -> f64 {
        let times = error_over_difference(&self.setup.stack);
        let now = self.difference(finer, coarser, every_bin);
        let before = before.map(|before| self.difference(coarser, before, every_bin));
        let error = level_error(times, now, before);
        if self.is_negative(finer) { largest(error, 1.0) } else { error }
    }

    /// True if a state's Y is below zero by more than rounding.
    fn is_negative(&self, sample: &Sample) -> bool {
        let y = || (0..self.layout.states).map(|state| self.luminous(state, sample));
        let most = y().map(f64::abs).fold(0.0, f64::max);
        y().any(|y| y < -ROUNDING * most)
    }

    /// The largest relative difference.
    fn difference(&self, finer: &Sample, coarser: &Sample, every_bin: bool) -> f64 {
        let mut worst = 0.0_f64;
        for state in 0..self.layout.states {
            let (y, before) = (self.luminous(state, finer), self.luminous(state, coarser));
            worst = largest(worst, relative((y, (y - before).abs())));
            if every_bin {
                let at = self.layout.radiance(state);
                let (finer, coarser) = (&finer.0[at.clone()], &coarser.0[at]);
                let most = finer.iter().copied().fold(0.0, f64::max);
                let bins = finer.iter().zip(coarser).map(|(a, b)| relative((most, (a - b).abs())));
                worst = bins.fold(worst, largest);
            }
        }
        worst
    }

    /// A view's result from two or three levels; `specular` has shape `[state][light]`.
    pub(crate) fn view_of_levels(
        &self,
        at: &ViewPoint,
        [finer, coarser]: [&Sample; 2],
        before: Option<&Sample>,
        specular: &[Vec<f64>],
    ) -> ViewSamples {
        let bare = self.bare_peaks(at, base_under(&self.setup.stack));
        let (scalars, of_coarser) = (self.scalars(finer, &bare), self.scalars(coarser, &bare));
        let least = Some(self.level_error([finer, coarser], before, false)).filter(|least| least.is_finite());
        let of_levels = LevelError {
            times: error_over_difference(&self.setup.stack),
            least: least.unwrap_or(0.0).max(LEAST_CLAIMED),
        };
        let error = |a: f64, b: f64| of_levels.of(a, b);
        // Neither light nor what becomes of it is below zero: a number that is errs by as much.
        let of_light = |a: f64, b: f64| error(a, b).max(-a);
        let discretisation = Numbers {
            linear: finer.combine(coarser, of_light),
            scalars: ViewScalars::combine(&scalars, &of_coarser, error),
        };
        let noise = Numbers { linear: Sample::zeros(finer), scalars: scalars.zeros() };
        let colours = [&scalars, &of_coarser].map(ViewScalars::colours).to_vec();
        let value = Numbers { linear: finer.clone(), scalars };
        let view = self.view(at, value, noise, Some(discretisation), specular);
        ViewSamples { view, colours, of_levels: Some(of_levels) }
    }
}
