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
use super::{Looked, Meter};
use crate::run::largest;
use crate::setup::{ViewPoint, base_under};

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
    /// The largest relative difference of Y over the states; with `every_bin`, also of the
    /// radiance at each wavelength, against the spectrum's maximum.
    pub(crate) fn difference(&self, finer: &Sample, coarser: &Sample, every_bin: bool) -> f64 {
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
        worst * error_over_difference(&self.setup.stack)
    }

    /// A view's result from two levels; `specular` has shape `[state][light]`.
    pub(crate) fn view_of_levels(
        &self,
        at: &ViewPoint,
        finer: &Sample,
        coarser: &Sample,
        specular: &[Vec<f64>],
    ) -> Looked {
        let bare = self.bare_peaks(at, base_under(&self.setup.stack));
        let (scalars, before) = (self.scalars(finer, &bare), self.scalars(coarser, &bare));
        let least = Some(self.difference(finer, coarser, false)).filter(|least| least.is_finite());
        let of_levels =
            LevelError { times: error_over_difference(&self.setup.stack), least: least.unwrap_or(0.0) };
        let error = |a: f64, b: f64| of_levels.of(a, b);
        let discretisation = Numbers {
            linear: finer.combine(coarser, error),
            scalars: ViewScalars::combine(&scalars, &before, error),
        };
        let noise = Numbers { linear: Sample::zeros(finer), scalars: scalars.zeros() };
        let colours = [&scalars, &before].map(ViewScalars::colours).to_vec();
        let value = Numbers { linear: finer.clone(), scalars };
        let view = self.view(at, value, noise, Some(discretisation), specular);
        Looked { view, colours, of_levels: Some(of_levels) }
    }
}
