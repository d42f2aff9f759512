//! Light with its spectra, and its transport by the flat skeleton.
//!
//! Directions are drawn once for all states and wavelengths. What depends on these is a product of a few
//! numbers for each state and wavelength, in the widest registers; what depends on layers alone has one
//! number for each band of the [skeleton](crate::skeleton), which [`Share`] repeats for the wavelengths.

use papilio_optics::with_widest_simd;

use super::controls::Brightness;
use crate::base::largest;
use crate::skeleton::{Field, Ray};
use crate::walk::{add_rows_times, add_scaled};

/// Number of wavelengths whose factors are computed before they are applied to all states.
const TOGETHER: usize = 64;

/// Light of a path, or a sum of it. Light that has not met the base is the same in all states.
#[derive(Debug, Default)]
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
    /// True if no light comes via the base.
    only_direct: bool,
    /// True if no light arrives.
    dark: bool,
}

impl Clone for Light {
    fn clone(&self) -> Self {
        Self { fresh: self.fresh.clone(), met: self.met.clone() }
    }

    fn clone_from(&mut self, other: &Self) {
        self.fresh.clone_from(&other.fresh);
        self.met.clone_from(&other.met);
    }
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

    /// The largest light of any state and wavelength, at most.
    pub(super) fn brightest(&self) -> f64 {
        largest(&self.fresh) + largest(&self.met)
    }

    /// The largest light that has not met the base, and the largest and smallest that has.
    pub(super) fn brightness(&self) -> Brightness {
        // Several at a time, as in `largest`.
        let (pieces, rest) = self.met.as_chunks::<8>();
        let smaller = |least: f64, value: &f64| if *value < least { *value } else { least };
        let mut least = [f64::INFINITY; 8];
        for values in pieces {
            least.iter_mut().zip(values).for_each(|(least, value)| *least = smaller(*least, value));
        }
        let least = least.iter().chain(rest).fold(f64::INFINITY, smaller);
        [largest(&self.fresh), largest(&self.met), least]
    }

    /// Reflection by a base with these reflectances, shape `[state][wavelength]`: all of it has met the base
    /// then.
    pub(super) fn meet(&mut self, reflectance: &[f64]) {
        let bins = self.fresh.len();
        for (row, reflectance) in self.met.chunks_exact_mut(bins).zip(reflectance.chunks_exact(bins)) {
            for ((met, fresh), r) in row.iter_mut().zip(&self.fresh).zip(reflectance) {
                *met = (*met + fresh) * r;
            }
        }
        self.fresh.fill(0.0);
    }

    /// Resets to no light.
    pub(super) fn clear(&mut self) {
        self.fresh.fill(0.0);
        self.met.fill(0.0);
    }

    pub(super) fn scale(&mut self, factor: f64) {
        if factor == 1.0 {
            return;
        }
        self.fresh.iter_mut().chain(&mut self.met).for_each(|value| *value *= factor);
    }

    pub(super) fn add(&mut self, other: &Self, scale: f64) {
        if scale == 0.0 {
            return;
        }
        if let ([fresh], [of]) = (&mut self.fresh[..], &other.fresh[..]) {
            *fresh += scale * of;
            self.met.iter_mut().zip(&other.met).for_each(|(sum, value)| *sum += scale * value);
            return;
        }
        add_scaled(&mut self.fresh, &other.fresh, scale);
        add_scaled(&mut self.met, &other.met, scale);
    }

    /// Multiplies by a fraction per wavelength; adds the rest to `loss`.
    pub(super) fn keep(&mut self, kept: impl Fn(usize) -> f64, loss: &mut Self) {
        loss.add(self, 1.0);
        self.multiply(kept);
        loss.add(self, -1.0);
    }

    /// Multiplies by a factor per wavelength.
    pub(super) fn multiply(&mut self, factor: impl Fn(usize) -> f64) {
        let bins = self.fresh.len();
        if bins == 1 {
            return self.scale(factor(0));
        }
        for start in (0..bins).step_by(TOGETHER) {
            let mut factors = [0.0; TOGETHER];
            let piece = start..bins.min(start + TOGETHER);
            factors.iter_mut().zip(piece.clone()).for_each(|(value, bin)| *value = factor(bin));
            let rows = std::iter::once(&mut self.fresh[..]).chain(self.met.chunks_exact_mut(bins));
            for row in rows {
                row[piece.clone()].iter_mut().zip(&factors).for_each(|(value, factor)| *value *= factor);
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

    /// Adds the product of two pieces of light and the fraction that connects them; `rising` includes all of
    /// `before`.
    pub(super) fn add_joined(&mut self, of: &Self, before: &Self, share: &Share, rising: &[f64]) {
        let bins = self.fresh.len();
        for bin in 0..bins {
            self.fresh[bin] += of.fresh[bin] * before.fresh[bin] * share.direct[bin];
        }
        let rows = self.met.chunks_exact_mut(bins).zip(of.met.chunks_exact(bins));
        let others = before.met.chunks_exact(bins).zip(rising.chunks_exact(bins));
        for ((sum, of_met), (before_met, rising)) in rows.zip(others) {
            for bin in 0..bins {
                let met = before_met[bin] * share.direct[bin] + rising[bin] * share.risen[bin];
                let whole = of.fresh[bin] + of_met[bin];
                sum[bin] += whole * met + of_met[bin] * before.fresh[bin] * share.direct[bin];
            }
        }
    }

    /// Adds the fraction of other light that arrives; `rising` is that of the [`Field`].
    pub(super) fn add_share(&mut self, of: &Self, share: &Share, rising: &[f64], scale: f64) {
        if share.dark {
            return;
        }
        let Share { direct, risen, .. } = share;
        if let ([direct], [risen], [fresh]) = (&direct[..], &risen[..], &of.fresh[..]) {
            self.fresh[0] += scale * fresh * direct;
            for ((sum, met), rising) in self.met.iter_mut().zip(&of.met).zip(rising) {
                *sum += scale * (met * direct + (fresh + met) * rising * risen);
            }
            return;
        }
        add_rows_times(&mut self.fresh, &of.fresh, direct, scale);
        if share.only_direct {
            return add_rows_times(&mut self.met, &of.met, direct, scale);
        }
        let bins = self.fresh.len();
        let sums = &mut self.met;
        with_widest_simd(
            #[inline(always)]
            || {
                let rows = sums.chunks_exact_mut(bins).zip(of.met.chunks_exact(bins));
                for ((sum, met), rising) in rows.zip(rising.chunks_exact(bins)) {
                    let lights = met.iter().zip(&of.fresh).zip(rising);
                    let shares = direct.iter().zip(risen);
                    for ((sum, ((met, fresh), rising)), (direct, risen)) in
                        sum.iter_mut().zip(lights).zip(shares)
                    {
                        *sum += scale * (met * direct + (fresh + met) * rising * risen);
                    }
                }
            },
        );
    }

    /// Reduces itself to the fraction that arrives.
    pub(super) fn carry(&mut self, share: &Share, rising: &[f64], scale: f64) {
        let bins = self.fresh.len();
        let Share { direct, risen, .. } = share;
        let Self { fresh, met } = self;
        if let ([direct], [risen], [fresh]) = (&direct[..], &risen[..], &mut fresh[..]) {
            for (met, rising) in met.iter_mut().zip(rising) {
                *met = scale * (*met * direct + (*fresh + *met) * rising * risen);
            }
            *fresh *= scale * direct;
            return;
        }
        with_widest_simd(
            #[inline(always)]
            || {
                for (met, rising) in met.chunks_exact_mut(bins).zip(rising.chunks_exact(bins)) {
                    let shares = fresh.iter().zip(rising).zip(direct).zip(risen);
                    for (met, (((fresh, rising), direct), risen)) in met.iter_mut().zip(shares) {
                        *met = scale * (*met * direct + (fresh + *met) * rising * risen);
                    }
                }
                fresh.iter_mut().zip(direct).for_each(|(value, direct)| *value *= scale * direct);
            },
        );
    }

    /// Largest fraction of any state and wavelength that arrives.
    pub(super) fn largest(&self, share: &Share, rising: &[f64]) -> f64 {
        if share.dark {
            return 0.0;
        }
        let bins = self.fresh.len();
        let Share { direct, risen, .. } = share;
        if let ([direct], [risen], [fresh]) = (&direct[..], &risen[..], &self.fresh[..]) {
            let arriving = self.met.iter().zip(rising);
            let arriving = arriving.map(|(met, rising)| (fresh + met) * (direct + rising * risen));
            return arriving.fold(0.0, f64::max);
        }
        let mut most = [0.0; TOGETHER];
        with_widest_simd(
            #[inline(always)]
            || {
                for (met, rising) in self.met.chunks_exact(bins).zip(rising.chunks_exact(bins)) {
                    for start in (0..bins).step_by(TOGETHER) {
                        let piece = start..bins.min(start + TOGETHER);
                        let lights = met[piece.clone()].iter().zip(&self.fresh[piece.clone()]);
                        let shares =
                            rising[piece.clone()].iter().zip(&direct[piece.clone()]).zip(&risen[piece]);
                        for ((most, (met, fresh)), ((rising, direct), risen)) in
                            most.iter_mut().zip(lights).zip(shares)
                        {
                            let value = (fresh + met) * (direct + rising * risen);
                            *most = if value > *most { value } else { *most };
                        }
                    }
                }
            },
        );
        largest(&most)
    }
}

impl Share {
    pub(super) fn zeros(bins: usize) -> Self {
        Self { direct: vec![0.0; bins], risen: vec![0.0; bins], only_direct: true, dark: true }
    }

    pub(super) fn clear(&mut self) {
        if self.dark {
            return;
        }
        self.direct.fill(0.0);
        self.risen.fill(0.0);
        (self.only_direct, self.dark) = (true, true);
    }

    /// Sets itself to all light that rises from the base.
    pub(super) fn set_rising(&mut self) {
        self.direct.fill(0.0);
        self.risen.fill(1.0);
        (self.only_direct, self.dark) = (false, false);
    }

    /// Adds the light that travels as `ray`, times a factor per wavelength.
    pub(super) fn add(&mut self, field: &Field, ray: Ray, factor: impl Fn(usize) -> f64) {
        match field.at(ray) {
            (&[direct], &[risen]) => {
                let factor = factor(0);
                let (direct, risen) = (factor * direct, factor * risen);
                self.only_direct &= risen == 0.0;
                self.dark &= direct == 0.0 && risen == 0.0;
                if direct != 0.0 {
                    self.direct.iter_mut().for_each(|value| *value += direct);
                }
                if risen != 0.0 {
                    self.risen.iter_mut().for_each(|value| *value += risen);
                }
            }
            (direct, risen) => {
                for bin in 0..direct.len() {
                    let factor = factor(bin);
                    self.direct[bin] += factor * direct[bin];
                    self.risen[bin] += factor * risen[bin];
                }
                (self.only_direct, self.dark) = (false, false);
            }
        }
    }

    /// Sets itself to the light that travels as `ray`, times a factor per wavelength.
    pub(super) fn set(&mut self, field: &Field, ray: Ray, factor: impl Fn(usize) -> f64) {
        self.clear();
        self.add(field, ray, factor);
    }
}
