//! Distribution of a metric.

use schemars::JsonSchema;
use serde::Serialize;

use super::estimate::{Estimate, Sums, is_rounding};
use super::plan::replicate;

/// Percentiles that are reported.
pub const PERCENTILES: [f64; 7] = [1.0, 5.0, 25.0, 50.0, 75.0, 95.0, 99.0];

/// Distribution of a metric over the displays for which it is defined.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct MetricDistribution {
    /// Number of displays for which it is undefined.
    pub undefined: usize,
    /// Mean.
    pub mean: Estimate,
    /// Standard deviation.
    pub deviation: Estimate,
    /// Smallest and largest value.
    pub range: [f64; 2],
    /// Values at [`PERCENTILES`], by linear interpolation between neighbouring displays.
    pub percentiles: [Estimate; PERCENTILES.len()],
}

impl MetricDistribution {
    /// Computes the distribution of a metric from its values for all displays, NaN where undefined; `None` if
    /// it is undefined everywhere.
    pub fn of(values: &[f64]) -> Option<Self> {
        let known = values.iter().copied().enumerate().filter(|(_, value)| !value.is_nan());
        let mut sorted: Vec<(f64, usize)> = known.map(|(row, value)| (value, replicate(row))).collect();
        sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (first, last) = (sorted.first()?.0, sorted.last()?.0);
        // Centred, because squares of large values lose the digits of a small spread.
        let centre = sorted[sorted.len() / 2].0;
        let terms = sorted
            .iter()
            .map(|(value, replicate)| (*replicate, [value - centre, (value - centre).powi(2), 1.0]));
        let sums = Sums::of(terms);
        let mean = Estimate::jackknife(|left_out| {
            let [sum, _, count] = sums.without(left_out);
            centre + sum / count
        });
        let deviation = Estimate::jackknife(|left_out| {
            let [sum, squares, count] = sums.without(left_out);
            ((squares - sum * sum / count) / (count - 1.0)).max(0.0).sqrt()
        });
        Some(Self {
            undefined: values.len() - sorted.len(),
            mean,
            deviation,
            range: [first, last],
            percentiles: percentiles(&sorted),
        })
    }

    /// Returns whether the metric varies by more than rounding errors.
    pub fn varies(&self) -> bool {
        !is_rounding(self.mean.value, self.deviation.value.powi(2))
    }
}

/// Percentiles of sorted values, each given with its replicate.
///
/// Standard errors follow Woodruff (J. Am. Stat. Assoc. 47, 635 (1952)): the standard error of the fraction
/// of displays below the percentile, from the replicates, times the slope of the metric between percentiles
/// on both sides. These are far enough apart for enough displays to lie between them. (The jackknife does not
/// estimate the error of a percentile, because it depends only on the few values next to it.)
fn percentiles(sorted: &[(f64, usize)]) -> [Estimate; PERCENTILES.len()] {
    let values: Vec<f64> = sorted.iter().map(|(value, _)| *value).collect();
    PERCENTILES.map(|percent| {
        let fraction = percent / 100.0;
        let value = interpolated(&values, fraction);
        let below = |other: f64| if other == value { 0.5 } else { f64::from(u8::from(other < value)) };
        let terms = sorted.iter().map(|(other, replicate)| (*replicate, [below(*other), 1.0]));
        let count = values.len() as f64;
        // The count is uncertain by at least half a display.
        let error = Sums::of(terms).fraction().standard_error.max(0.5 / count);
        let off = count.sqrt().recip().min(0.5 * fraction).min(0.5 * (1.0 - fraction)).max(error);
        let (low, high) = ((fraction - off).max(0.0), (fraction + off).min(1.0));
        let slope = (interpolated(&values, high) - interpolated(&values, low)) / (high - low);
        Estimate { value, standard_error: slope * error }
    })
}

/// Value below which a fraction of the sorted values lies.
fn interpolated(sorted: &[f64], fraction: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else { return f64::NAN };
    let position = fraction * last as f64;
    let below = (position.floor() as usize).min(last);
    let above = (below + 1).min(last);
    sorted[below] + (position - below as f64) * (sorted[above] - sorted[below])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_of_equidistant_values_are_exact() {
        let values: Vec<f64> = (0..=4000).rev().map(f64::from).collect();
        let spread = MetricDistribution::of(&values).unwrap();
        let values = spread.percentiles.map(|one| one.value);
        assert_eq!(values, PERCENTILES.map(|percent| 40.0 * percent));
        assert_eq!((spread.range, spread.mean.value, spread.undefined), ([0.0, 4000.0], 2000.0, 0));
    }

    #[test]
    fn undefined_values_are_counted_and_excluded() {
        let mut values = vec![1e9 + 1.0; 100];
        values[3] = f64::NAN;
        let spread = MetricDistribution::of(&values).unwrap();
        assert_eq!((spread.undefined, spread.mean.value, spread.deviation.value), (1, 1e9 + 1.0, 0.0));
        assert!(MetricDistribution::of(&[f64::NAN; 50]).is_none());
    }

    /// Noise of the last digits, of any size of the metric, is no variation; a millionth is.
    #[test]
    fn rounding_errors_are_no_variation() {
        for (mean, deviation, varies) in [
            (0.0, 1e-14, false),
            (0.0, 1e-6, true),
            (0.3, 1e-17, false),
            (4e9, 1e-2, false),
            (4e9, 10.0, true),
        ] {
            let values: Vec<f64> = (0..64).map(|row| mean + deviation * f64::from(row % 4)).collect();
            assert_eq!(MetricDistribution::of(&values).unwrap().varies(), varies, "{mean} {deviation}");
        }
    }
}
