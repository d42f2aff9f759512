//! Samples of a view: all quantities that are linear in light, with their mean and spread over replicates.

use std::ops::Range;

/// Sample of a view: one replicate or the mean of several. [`Layout`] defines its entries.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Sample(pub(crate) Vec<f64>);

impl Sample {
    /// Returns true if all entries are finite.
    pub(crate) fn is_finite(&self) -> bool {
        self.0.iter().all(|value| value.is_finite())
    }

    /// Computes the mean of all samples except the one at `left_out`.
    pub(crate) fn mean(samples: &[Self], left_out: Option<usize>) -> Self {
        let mut mean = vec![0.0; samples[0].0.len()];
        let kept = samples.iter().enumerate().filter(|(k, _)| Some(*k) != left_out);
        for (_, sample) in kept {
            mean.iter_mut().zip(&sample.0).for_each(|(m, value)| *m += value);
        }
        let count = samples.len() - usize::from(left_out.is_some());
        mean.iter_mut().for_each(|m| *m /= count as f64);
        Self(mean)
    }

    /// Computes the standard error of the mean of each entry.
    pub(crate) fn standard_errors(samples: &[Self]) -> Self {
        Self((0..samples[0].0.len()).map(|k| spread(samples.iter().map(|s| s.0[k])).1).collect())
    }

    /// Combines the entries of two samples.
    pub(crate) fn combine(&self, other: &Self, with: impl Fn(f64, f64) -> f64) -> Self {
        Self(self.0.iter().zip(&other.0).map(|(a, b)| with(*a, *b)).collect())
    }

    /// Returns a sample of zeros of the same size.
    pub(crate) fn zeros(like: &Self) -> Self {
        Self(vec![0.0; like.0.len()])
    }
}

/// Computes the mean of independent values and its standard error.
pub(crate) fn spread(values: impl Iterator<Item = f64> + Clone) -> (f64, f64) {
    let count = values.clone().count() as f64;
    let mean = values.clone().sum::<f64>() / count;
    let variance = values.map(|value| (value - mean).powi(2)).sum::<f64>() / (count - 1.0);
    (mean, (variance / count).sqrt())
}

/// Computes the relative error; 0 if the error is 0, infinite if only the mean is 0.
pub(crate) fn relative((mean, error): (f64, f64)) -> f64 {
    if error == 0.0 { 0.0 } else { error / mean.abs() }
}

/// Layout of the entries of a [`Sample`].
#[derive(Debug, Clone, Copy)]
pub(crate) struct Layout {
    pub(crate) states: usize,
    pub(crate) bins: usize,
    /// Number of contributions to Y.
    pub(crate) terms: usize,
    /// Whether the spectrum under each light alone is stored.
    pub(crate) by_light: bool,
    /// Number of corrections for lights with narrow lines: 0 without such lights.
    pub(crate) corrections: usize,
    /// Whether X, Y and Z are also computed from the lights at every nanometre.
    pub(crate) every_nm: bool,
    /// Number of estimates of what the display changes within a step.
    pub(crate) within_step: usize,
}

impl Layout {
    /// Entries of the energy balance: returned, front, diffuser, glass, pixel, inactive, unaccounted.
    pub(crate) const LEDGER: usize = 7;
    pub(crate) const OF_PIXEL: usize = 4;
    pub(crate) const OF_INACTIVE: usize = 5;

    fn per_state(&self) -> usize {
        let alone = if self.by_light { self.terms * self.bins } else { 0 };
        2 * self.bins + 2 * self.terms + 1 + Self::LEDGER + alone + self.corrections + self.of_every_nm()
    }

    fn of_every_nm(&self) -> usize {
        if self.every_nm { 3 + 3 * self.within_step } else { 0 }
    }

    pub(crate) fn len(&self) -> usize {
        self.states * self.per_state()
    }

    /// Spectral radiance of a state.
    pub(crate) fn radiance(&self, state: usize) -> Range<usize> {
        let start = state * self.per_state();
        start..start + self.bins
    }

    /// Reflectance factor, weighted by the illuminances of the lights.
    pub(crate) fn factor(&self, state: usize) -> Range<usize> {
        let start = self.radiance(state).end;
        start..start + self.bins
    }

    /// Contributions to Y of light that has met the pixel.
    pub(crate) fn terms(&self, state: usize) -> Range<usize> {
        let start = self.factor(state).end;
        start..start + self.terms
    }

    /// Contribution to Y of light that has not met the pixel.
    pub(crate) fn front_term(&self, state: usize) -> usize {
        self.terms(state).end
    }

    /// Luminance factor under each light alone.
    pub(crate) fn alone(&self, state: usize) -> Range<usize> {
        let start = self.front_term(state) + 1;
        start..start + self.terms
    }

    /// Luminous fractions of the energy balance.
    pub(crate) fn ledger(&self, state: usize) -> Range<usize> {
        let start = self.alone(state).end;
        start..start + Self::LEDGER
    }

    /// Reflectance factor under one light alone; empty unless it is stored.
    pub(crate) fn spectrum_alone(&self, state: usize, term: usize) -> Range<usize> {
        let bins = if self.by_light { self.bins } else { 0 };
        let start = self.ledger(state).end + term * bins;
        start..start + bins
    }

    /// Corrections for lights with narrow lines (`lines::Corrections`).
    pub(crate) fn corrections(&self, state: usize) -> Range<usize> {
        let end = self.every_nm(state).start;
        end - self.corrections..end
    }

    /// X, Y and Z from the lights at every nanometre, relative to Y of a perfect white; empty unless they are computed.
    pub(crate) fn every_nm(&self, state: usize) -> Range<usize> {
        let start = (state + 1) * self.per_state() - self.of_every_nm();
        start..start + if self.every_nm { 3 } else { 0 }
    }

    /// Estimates of what the display changes within a step, X, Y and Z of each.
    pub(crate) fn within_step(&self, state: usize) -> Range<usize> {
        self.every_nm(state).end..(state + 1) * self.per_state()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layout_has_no_overlaps_and_no_gaps() {
        for (by_light, corrections, every_nm) in
            [(false, 0, false), (true, 0, true), (true, 4, true), (false, 4, false)]
        {
            let layout =
                Layout { states: 3, bins: 5, terms: 2, by_light, corrections, every_nm, within_step: 2 };
            let mut used = vec![0; layout.len()];
            for state in 0..3 {
                let spectra = [layout.radiance(state), layout.factor(state)];
                let alone = [0, 1].map(|term| layout.spectrum_alone(state, term));
                let numbers = [
                    layout.terms(state),
                    layout.alone(state),
                    layout.ledger(state),
                    layout.corrections(state),
                    layout.every_nm(state),
                    layout.within_step(state),
                ];
                let all = spectra.into_iter().chain(alone).chain(numbers).flatten();
                all.chain([layout.front_term(state)]).for_each(|k| used[k] += 1);
            }
            assert!(used.iter().all(|count| *count == 1));
        }
    }

    #[test]
    fn spread_of_one_to_five_equals_the_closed_form() {
        let (mean, error) = spread([1.0, 2.0, 3.0, 4.0, 5.0].into_iter());
        assert_eq!(mean, 3.0);
        assert!((error - 0.5_f64.sqrt()).abs() < 1e-15);
        assert_eq!(relative((0.0, 0.0)), 0.0);
        assert_eq!(relative((0.0, 1.0)), f64::INFINITY);
    }
}
