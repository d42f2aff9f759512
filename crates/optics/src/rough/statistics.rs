//! Statistics of slopes: what profilometers and haze meters state, and alpha.
//!
//! Along one axis the mean absolute slope and the root mean square slope differ by the weight of the tail;
//! the latter does not exist for GGX. On a profile with Gaussian heights that are independent of the slopes,
//! the mean absolute slope is `2 pi Ra/RSm` (S. O. Rice, Bell Syst. Tech. J. 24, 46 (1945)), whatever the
//! distribution of the slopes: RSm is twice the mean distance of crossings of the mean line.

use std::f64::consts::{PI, SQRT_2};

use super::shadowing::Distribution;
use super::student;

impl Distribution {
    /// Returns the mean absolute slope along one axis of an interface of this roughness.
    pub fn mean_slope(self, alpha: f64) -> f64 {
        alpha
            * match self {
                Self::Ggx => 1.0,
                Self::Beckmann => 1.0 / PI.sqrt(),
                Self::StudentT { tail } => student::mean_slope(tail),
            }
    }

    /// Returns the root mean square slope along one axis, if it exists.
    pub fn slope_rms(self, alpha: f64) -> Option<f64> {
        match self {
            Self::Ggx => None,
            Self::Beckmann => Some(alpha / SQRT_2),
            Self::StudentT { tail } => {
                (tail > 2.0).then(|| alpha * (0.5 * (tail - 1.0) / (tail - 2.0)).sqrt())
            }
        }
    }

    /// Returns the kurtosis of the slopes along one axis (3 if they are Gaussian), if it exists.
    pub fn kurtosis(self) -> Option<f64> {
        match self {
            Self::Ggx => None,
            Self::Beckmann => Some(3.0),
            Self::StudentT { tail } => (tail > 3.0).then(|| 3.0 + 3.0 / (tail - 3.0)),
        }
    }

    /// Returns the tail of the Student's t-distribution whose slopes along one axis have this kurtosis, above
    /// 3.
    pub fn tail_from_kurtosis(kurtosis: f64) -> f64 {
        3.0 + 3.0 / (kurtosis - 3.0)
    }

    /// Returns the fraction of the area, seen from above, that is steeper than this slope in any direction.
    pub fn steeper(self, alpha: f64, slope: f64) -> f64 {
        let ratio = (slope / alpha).powi(2);
        match self {
            Self::Ggx => 1.0 / (1.0 + ratio),
            Self::Beckmann => (-ratio).exp(),
            Self::StudentT { tail } => (1.0 + ratio / (tail - 1.0)).powf(1.0 - tail),
        }
    }

    /// Returns the roughness of which this fraction, 0 to 1 (both excluded), is steeper than this slope.
    pub fn alpha_from_steeper(self, fraction: f64, slope: f64) -> f64 {
        let ratio = match self {
            Self::Ggx => 1.0 / fraction - 1.0,
            Self::Beckmann => -fraction.ln(),
            Self::StudentT { tail } => (tail - 1.0) * (fraction.powf(-1.0 / (tail - 1.0)) - 1.0),
        };
        slope / ratio.sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Distribution; 5] = [
        Distribution::Ggx,
        Distribution::Beckmann,
        Distribution::StudentT { tail: 2.0 },
        Distribution::StudentT { tail: 2.6 },
        Distribution::StudentT { tail: 7.0 },
    ];

    /// Moments of the slopes by the midpoint rule over their tangents: along one axis, `|cos phi|` has the mean
    /// 2/pi, its square 1/2 and its fourth power 3/8.
    #[test]
    fn moments_equal_integrals_over_slopes() {
        let alpha = 0.3;
        for distribution in ALL {
            let moment = |order: i32| {
                let steps = 400_000;
                let one = |k: i32| {
                    let w = 0.5 * PI * (f64::from(k) + 0.5) / f64::from(steps);
                    distribution.slopes(w) * (alpha * w.tan()).powi(order)
                };
                0.5 * PI / f64::from(steps) * (0..steps).map(one).sum::<f64>()
            };
            assert!((moment(0) - 1.0).abs() < 1e-9, "{distribution:?}");
            let mean = 2.0 / PI * moment(1);
            assert!((mean / distribution.mean_slope(alpha) - 1.0).abs() < 1e-5, "{distribution:?}: {mean}");
            if let Some(rms) = distribution.slope_rms(alpha).filter(|_| distribution != ALL[3]) {
                assert!((0.5 * moment(2) / (rms * rms) - 1.0).abs() < 1e-6, "{distribution:?}");
                let kurtosis = 0.375 * moment(4) / rms.powi(4);
                let expected = distribution.kurtosis().unwrap();
                assert!((kurtosis / expected - 1.0).abs() < 1e-4, "{distribution:?}: {kurtosis} {expected}");
            }
        }
        assert!((Distribution::tail_from_kurtosis(3.75) - 7.0).abs() < 1e-12);
    }

    #[test]
    fn fractions_and_roughness_are_inverse() {
        for distribution in ALL {
            for fraction in [1e-6, 0.03, 0.7] {
                let alpha = distribution.alpha_from_steeper(fraction, 0.087);
                let found = distribution.steeper(alpha, 0.087);
                assert!((found / fraction - 1.0).abs() < 1e-9, "{distribution:?}");
            }
        }
    }

    /// The published alphas of the etched grades: 11.14 Ra/RSm for Gaussian slopes.
    #[test]
    fn mean_slope_of_a_gaussian_profile_is_that_of_its_crossings() {
        let (ra, rsm) = (0.58, 110.0);
        let alpha = 2.0 * PI * ra / rsm / Distribution::Beckmann.mean_slope(1.0);
        assert!((alpha / (11.14 * ra / rsm) - 1.0).abs() < 1e-3, "{alpha}");
    }
}
