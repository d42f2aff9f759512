//! Five methods of integrating x from 0 to 4: Feng 2012, Table 4.1.
//!
//! Variances of the estimate from N samples, in closed form and by experiment. The
//! integral is 8; the table's last column is the number of samples for a standard error of 0.08.

use crate::{SampleStream, Sampler};

/// Integration method: a row of the table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Estimator {
    /// Density (6 - x)/16: few samples where the integrand is large.
    Poor,
    /// Density 1/4.
    Uniform,
    /// Density x/8.
    Ideal,
    /// Density (0.1 + 0.95 x)/8.
    NearIdeal,
    /// Density 1/4, one sample in each of N equal intervals.
    Stratified,
}

/// The integral of x from 0 to 4.
pub const INTEGRAL: f64 = 8.0;

impl Estimator {
    /// All methods, in the order of the table.
    pub const ALL: [Self; 5] = [Self::Poor, Self::Uniform, Self::Ideal, Self::NearIdeal, Self::Stratified];

    /// The density, in the notation of the table.
    pub fn density_in_words(self) -> &'static str {
        match self {
            Self::Poor => "(6 - x)/16",
            Self::Uniform => "1/4",
            Self::Ideal => "x/8",
            Self::NearIdeal => "(0.1 + 0.95 x)/8",
            Self::Stratified => "1/4, stratified",
        }
    }

    /// Returns (factor, power) of `variance = factor / N^power`, exactly (eq. 4-9: the integral of
    /// x^2/density, minus 64).
    pub fn variance(self) -> (f64, i32) {
        match self {
            Self::Poor => (16.0 * (36.0 * 3.0_f64.ln() - 32.0) - 64.0, 1),
            Self::Uniform => (64.0 / 3.0, 1),
            Self::Ideal => (0.0, 1),
            Self::NearIdeal => {
                // 8 times the integral of x^2/(a + c x).
                let (a, c) = (0.1_f64, 0.95_f64);
                let logarithm = a * a / (c * c * c) * ((a + 4.0 * c) / a).ln();
                (8.0 * (8.0 / c - 4.0 * a / (c * c) + logarithm) - 64.0, 1)
            }
            Self::Stratified => (64.0 / 3.0, 3),
        }
    }

    /// Number of samples for a given standard error.
    pub fn samples_for(self, error: f64) -> u64 {
        let (factor, power) = self.variance();
        ((factor / (error * error)).powf(1.0 / f64::from(power)) - 1e-9).ceil().max(1.0) as u64
    }

    /// Draws a sample by inversion; returns it with its density.
    fn draw(self, u: f64) -> (f64, f64) {
        match self {
            Self::Poor => {
                let x = 6.0 - (36.0 - 32.0 * u).sqrt();
                (x, (6.0 - x) / 16.0)
            }
            Self::Uniform | Self::Stratified => (4.0 * u, 0.25),
            Self::Ideal => {
                let x = 4.0 * u.sqrt();
                (x, x / 8.0)
            }
            Self::NearIdeal => {
                let (a, c) = (0.1, 0.95);
                let x = ((a * a + 16.0 * c * u).sqrt() - a) / c;
                (x, (a + c * x) / 8.0)
            }
        }
    }

    /// Mean squared error of estimates from N samples over many experiments, and its standard error.
    pub fn experiment(self, samples: u64, experiments: u64, seed: u64) -> (f64, f64) {
        let squares: Vec<f64> = (0..experiments)
            .map(|stream| {
                let numbers = SampleStream::new(Sampler::Random, seed, stream);
                let one = |k: u64| {
                    let u = numbers.block(k, 0)[0];
                    let stratified = self == Self::Stratified;
                    let (x, density) =
                        self.draw(if stratified { (k as f64 + u) / samples as f64 } else { u });
                    x / density
                };
                let estimate = (0..samples).map(one).sum::<f64>() / samples as f64;
                (estimate - INTEGRAL).powi(2)
            })
            .collect();
        let n = experiments as f64;
        let mean = squares.iter().sum::<f64>() / n;
        let variance = squares.iter().map(|square| (square - mean).powi(2)).sum::<f64>() / (n - 1.0);
        (mean, (variance / n).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Feng 2012, Table 4.1: printed variances (0.1645 in its text) and numbers of samples for 0.08. The
    /// table's 8875 and 3328 follow from its rounded variances, 56.8 and 21.3; 26 agrees.
    #[test]
    fn variances_and_sample_counts_equal_table_4_1() {
        let printed = [(56.80, 1), (21.33, 1), (0.0, 1), (0.1646, 1), (21.33, 3)];
        for (way, (factor, power)) in Estimator::ALL.into_iter().zip(printed) {
            let exact = way.variance();
            assert!(
                (exact.0 - factor).abs() < 0.006_f64.min(0.0002_f64.max(2e-4 * factor)),
                "{way:?}: {exact:?}"
            );
            assert_eq!(exact.1, power);
        }
        let samples: Vec<u64> = Estimator::ALL.iter().map(|way| way.samples_for(0.08)).collect();
        assert_eq!(samples, [8876, 3334, 1, 26, 15]);
    }

    #[test]
    fn densities_integrate_to_one() {
        for way in Estimator::ALL {
            let steps = 100_000;
            let mean: f64 = (0..steps).map(|k| 1.0 / way.draw((k as f64 + 0.5) / f64::from(steps)).1).sum();
            assert!((mean / f64::from(steps) - 4.0).abs() < 0.02, "{way:?}");
        }
    }

    /// Within 4.5 standard errors, for five rows.
    #[test]
    fn experiments_agree_with_closed_form_variances() {
        for way in Estimator::ALL {
            let (factor, power) = way.variance();
            let (found, error) = way.experiment(16, 20_000, 1);
            let exact = factor / 16.0_f64.powi(power);
            assert!((found - exact).abs() < 4.5 * error + 1e-20, "{way:?}: {found} +- {error}, {exact}");
        }
    }
}
