//! Light with its spectra, and its transport by the flat skeleton.

use crate::skeleton::{Field, Ray};

/// Light of a path, or a sum of it. Light that has not met the base is the same in all states.
#[derive(Debug, Clone)]
pub(super) struct Light {
    /// Light that has not met the base; shape `[wavelength]`.
    pub(super) fresh: Vec<f64>,
    /// Light that has met the base; shape `[state][wavelength]`.
    pub(super) met: Vec<f64>,
}

/// Fraction of emitted light that arrives at one place; shape `[wavelength]`.
#[derive(Debug, Clone)]
pub(super) struct Share {
    /// Light that has not met the base.
    direct: Vec<f64>,
    /// Light via the base, per unit that rises from it.
    risen: Vec<f64>,
}

impl Light {
    pub(super) fn zeros(states: usize, bins: usize) -> Self {
        Self { fresh: vec![0.0; bins], met: vec![0.0; states * bins] }
    }

    /// Resets to one unit of light that has met nothing.
    pub(super) fn start(&mut self) {
        self.fresh.fill(1.0);
        self.met.fill(0.0);
    }

    /// True if nothing is left.
    pub(super) fn is_dark(&self) -> bool {
        self.fresh.iter().chain(&self.met).all(|value| *value == 0.0)
    }

    pub(super) fn scale(&mut self, factor: f64) {
        self.fresh.iter_mut().chain(&mut self.met).for_each(|value| *value *= factor);
    }

    pub(super) fn add(&mut self, other: &Self, scale: f64) {
        super::add_scaled(&mut self.fresh, &other.fresh, scale);
        super::add_scaled(&mut self.met, &other.met, scale);
    }

    /// Multiplies by a fraction per wavelength; adds the rest to `loss`.
    pub(super) fn keep(&mut self, kept: impl Fn(usize) -> f64, loss: &mut Self) {
        let bins = self.fresh.len();
        for bin in 0..bins {
            let kept = kept(bin);
            let keep = |(value, lost): (&mut f64, &mut f64)| {
                let rest = *value * kept;
                *lost += *value - rest;
                *value = rest;
            };
            keep((&mut self.fresh[bin], &mut loss.fresh[bin]));
            let (met, lost) = (self.met.iter_mut().skip(bin), loss.met.iter_mut().skip(bin));
            met.step_by(bins).zip(lost.step_by(bins)).for_each(keep);
        }
    }

    /// Multiplies by a factor per wavelength.
    pub(super) fn multiply(&mut self, factor: impl Fn(usize) -> f64) {
        let bins = self.fresh.len();
        for bin in 0..bins {
            let factor = factor(bin);
            if factor != 1.0 {
                self.fresh[bin] *= factor;
                self.met.iter_mut().skip(bin).step_by(bins).for_each(|value| *value *= factor);
            }
        }
    }

    /// Multiplies `rows[state][wavelength]` by all of this light.
    pub(super) fn multiply_rows(&self, rows: &mut [f64]) {
        let bins = self.fresh.len();
        for (row, met) in rows.chunks_exact_mut(bins).zip(self.met.chunks_exact(bins)) {
            for bin in 0..bins {
                row[bin] *= self.fresh[bin] + met[bin];
            }
        }
    }

    /// Adds the product of two pieces of light and the fraction that connects them; `rising` includes all of `before`.
    pub(super) fn add_joined(&mut self, of: &Self, before: &Self, share: &Share, rising: &[f64]) {
        let bins = self.fresh.len();
        for bin in 0..bins {
            self.fresh[bin] += of.fresh[bin] * before.fresh[bin] * share.direct[bin];
        }
        for (k, sum) in self.met.iter_mut().enumerate() {
            let bin = k % bins;
            let met = before.met[k] * share.direct[bin] + rising[k] * share.risen[bin];
            *sum += (of.fresh[bin] + of.met[k]) * met + of.met[k] * before.fresh[bin] * share.direct[bin];
        }
    }

    /// Adds the fraction of other light that arrives; `rising` is that of the [`Field`].
    pub(super) fn add_share(&mut self, of: &Self, share: &Share, rising: &[f64], scale: f64) {
        let bins = self.fresh.len();
        for ((sum, value), direct) in self.fresh.iter_mut().zip(&of.fresh).zip(&share.direct) {
            *sum += scale * value * direct;
        }
        let rows = self.met.chunks_exact_mut(bins).zip(of.met.chunks_exact(bins));
        for ((sum, met), rising) in rows.zip(rising.chunks_exact(bins)) {
            for bin in 0..bins {
                let by_way_of_base = (of.fresh[bin] + met[bin]) * rising[bin] * share.risen[bin];
                sum[bin] += scale * (met[bin] * share.direct[bin] + by_way_of_base);
            }
        }
    }

    /// Reduces itself to the fraction that arrives.
    pub(super) fn carry(&mut self, share: &Share, rising: &[f64], scale: f64) {
        let bins = self.fresh.len();
        let rows = self.met.chunks_exact_mut(bins).zip(rising.chunks_exact(bins));
        for (met, rising) in rows {
            for bin in 0..bins {
                let by_way_of_base = (self.fresh[bin] + met[bin]) * rising[bin] * share.risen[bin];
                met[bin] = scale * (met[bin] * share.direct[bin] + by_way_of_base);
            }
        }
        self.fresh.iter_mut().zip(&share.direct).for_each(|(value, direct)| *value *= scale * direct);
    }

    /// Largest fraction of any state and wavelength that arrives.
    pub(super) fn largest(&self, share: &Share, rising: &[f64]) -> f64 {
        let bins = self.fresh.len();
        let mut largest = 0.0_f64;
        for (met, rising) in self.met.chunks_exact(bins).zip(rising.chunks_exact(bins)) {
            for bin in 0..bins {
                let all = self.fresh[bin] + met[bin];
                largest = largest.max(all * (share.direct[bin] + rising[bin] * share.risen[bin]));
            }
        }
        largest
    }
}

impl Share {
    pub(super) fn zeros(bins: usize) -> Self {
        Self { direct: vec![0.0; bins], risen: vec![0.0; bins] }
    }

    pub(super) fn clear(&mut self) {
        self.direct.fill(0.0);
        self.risen.fill(0.0);
    }

    /// Sets itself to all light that rises from the base.
    pub(super) fn set_rising(&mut self) {
        self.direct.fill(0.0);
        self.risen.fill(1.0);
    }

    /// Adds the light that travels as `ray`, times a factor per wavelength.
    pub(super) fn add(&mut self, field: &Field, ray: Ray, factor: impl Fn(usize) -> f64) {
        let (direct, risen) = field.at(ray);
        for bin in 0..direct.len() {
            let factor = factor(bin);
            self.direct[bin] += factor * direct[bin];
            self.risen[bin] += factor * risen[bin];
        }
    }

    /// Sets itself to the light that travels as `ray`, times a factor per wavelength.
    pub(super) fn set(&mut self, field: &Field, ray: Ray, factor: impl Fn(usize) -> f64) {
        self.clear();
        self.add(field, ray, factor);
    }
}
