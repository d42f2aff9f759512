//! Discretisation errors of adding, from the difference between two levels.
//!
//! The values of the finer level are reported. Each level is much more accurate than the previous one. The
//! difference is therefore nearly the error of the coarser level, and an upper bound of that of the finer
//! level (if the levels converge slowly, it is multiplied by a factor: [`error_over_difference`]). A single
//! value may change little by chance: no relative error is reported to be smaller than that of the worst Y of
//! the view, and no error of a metric to be smaller than what such errors of X, Y and Z change it by. Metrics that are
//! differences, such as a* and b* of a neutral colour, would otherwise state hardly any error where they are near 0.

use papilio_transport::adding::error_over_difference;

use super::angle::Changes;
use super::metrics::{StateObservation, ViewScalars};
use super::sample::{Sample, relative};
use super::view::Numbers;
use super::{Meter, ViewSamples};
use crate::run::{largest, level_error};
use crate::setup::ViewPoint;

/// Smallest relative error that is reported: tables over direction (films) and sums over wavelengths are not
/// more accurate.
const LEAST_CLAIMED: f64 = 1e-7;

/// Rounding error of sums, relative to the largest Y.
const ROUNDING: f64 = 1e-9;

/// Largest relative change of X, Y and Z for which the change of a metric is computed; those of larger ones are in proportion.
/// Colours remain colours, and rounding errors are below a millionth of the change.
const LARGEST_CHANGE: f64 = 1e-4;

/// Error model: the error of a value from its values at two levels.
#[derive(Debug, Clone, Copy)]
pub(super) struct LevelError {
    /// Ratio of the error to the difference.
    times: f64,
    /// Smallest relative error.
    least: f64,
}

impl LevelError {
    pub(super) fn of(&self, finer: f64, coarser: f64) -> f64 {
        (self.times * (finer - coarser).abs()).max(self.least * finer.abs())
    }
}

impl Meter<'_> {
    /// Returns the largest relative error, over the states, of Y at the last of two or three levels and, with
    /// `per_wavelength`, of the radiance at each wavelength, relative to the maximum of the spectrum. It is
    /// at least 1 if a Y is negative, which is unphysical.
    pub(crate) fn level_error(
        &self,
        [finer, coarser]: [&Sample; 2],
        before: Option<&Sample>,
        per_wavelength: bool,
    ) -> f64 {
        let times = error_over_difference(&self.setup.stack, &self.setup.sources);
        let now = self.difference(finer, coarser, per_wavelength);
        let before = before.map(|before| self.difference(coarser, before, per_wavelength));
        let error = level_error(times, now, before);
        if self.is_negative(finer) { largest(error, 1.0) } else { error }
    }

    /// Returns true if Y of a state is negative by more than rounding errors.
    fn is_negative(&self, sample: &Sample) -> bool {
        let y = || (0..self.layout.states).map(|state| self.luminous(state, sample));
        let most = y().map(f64::abs).fold(0.0, f64::max);
        y().any(|y| y < -ROUNDING * most)
    }

    /// Returns the largest relative difference between two levels.
    fn difference(&self, finer: &Sample, coarser: &Sample, per_wavelength: bool) -> f64 {
        let mut worst = 0.0_f64;
        for state in 0..self.layout.states {
            let (y, before) = (self.luminous(state, finer), self.luminous(state, coarser));
            worst = largest(worst, relative((y, (y - before).abs())));
            if per_wavelength {
                let at = self.layout.radiance(state);
                let (finer, coarser) = (&finer.0[at.clone()], &coarser.0[at]);
                let most = finer.iter().copied().fold(0.0, f64::max);
                let bins = finer.iter().zip(coarser).map(|(a, b)| relative((most, (a - b).abs())));
                worst = bins.fold(worst, largest);
            }
        }
        worst
    }

    /// Computes the result of a view from two or three levels, whose errors are `raised` by this factor; `specular` has shape
    /// `[state][light]`. No relative error is below `least`.
    pub(crate) fn view_of_levels(
        &self,
        at: &ViewPoint,
        [finer, coarser]: [&Sample; 2],
        (before, raised): (Option<&Sample>, f64),
        (specular, least): (&[Vec<f64>], f64),
    ) -> ViewSamples {
        let bare = self.bare_peaks(at, self.setup.stack.base());
        let (scalars, of_coarser) = (self.scalars(finer, &bare), self.scalars(coarser, &bare));
        let of_worst = self.level_error([finer, coarser], before, false);
        let least = [of_worst, least].into_iter().filter(|least| least.is_finite()).reduce(f64::max);
        let of_levels = LevelError {
            times: raised * error_over_difference(&self.setup.stack, &self.setup.sources),
            least: (raised * least.unwrap_or(0.0)).max(LEAST_CLAIMED),
        };
        let change = of_levels.least.min(LARGEST_CHANGE);
        let changed = self.changed(finer, &bare, change);
        let per_change = of_levels.least / change;
        let error = |a: f64, b: f64| of_levels.of(a, b);
        // Amounts of light cannot be negative: the error of a negative value is at least its magnitude.
        let of_light = |a: f64, b: f64| error(a, b).max(-a);
        let mut errors = ViewScalars::combine(&scalars, &of_coarser, error);
        for changed in &changed {
            errors.raise_to(&scalars.sum_of_changes(changed, per_change));
        }
        let discretisation = Numbers { linear: finer.combine(coarser, of_light), scalars: errors };
        let noise = Numbers { linear: Sample::zeros(finer), scalars: scalars.zeros() };
        let colours = [&scalars, &of_coarser].map(ViewScalars::colours).to_vec();
        let changes = Changes { colours: changed[0].each_ref().map(ViewScalars::colours), per_change };
        let value = Numbers { linear: finer.clone(), scalars };
        let view = self.view(at, value, noise, Some(discretisation), specular);
        ViewSamples { view, colours, of_levels: Some((of_levels, changes)) }
    }

    /// Computes the metrics with X, Y (and the luminance) or Z increased by this fraction: first in all states, then in every
    /// second one, where the others decrease, for metrics that compare states.
    fn changed(&self, sample: &Sample, bare: &[Option<f64>], change: f64) -> [[ViewScalars; 3]; 2] {
        let observations: Vec<StateObservation> =
            (0..self.layout.states).map(|state| self.observation(state, sample, bare[state])).collect();
        let metrics = |component: usize, signs: [f64; 2]| {
            let mut changed = observations.clone();
            for (one, sign) in changed.iter_mut().zip(signs.iter().cycle()) {
                let factor = 1.0 + sign * change;
                match component {
                    0 => one.xyz.x *= factor,
                    1 => {
                        one.xyz.y *= factor;
                        one.luminance_cd_m2 *= factor;
                    }
                    _ => one.xyz.z *= factor,
                }
            }
            self.reference(&changed).view(&changed)
        };
        [[1.0, 1.0], [1.0, -1.0]].map(|signs| [0, 1, 2].map(|component| metrics(component, signs)))
    }
}
