//! Distribution of a metric.

use schemars::JsonSchema;
use serde::Serialize;

use super::estimate::{Estimate, Sums, is_rounding};
use super::plan::{REPLICATES, replicate};

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
    /// Values at [`PERCENTILES`], median-unbiased: interpolated between neighbouring displays.
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
        let mut moments = [[0.0; 3]; REPLICATES];
        for (value, replicate) in &sorted {
            let [sum, squares, count] = &mut moments[*replicate];
            *sum += value - centre;
            *squares += (value - centre).powi(2);
            *count += 1.0;
        }
        let terms = moments.iter().enumerate().map(|(replicate, [sum, squares, count])| {
            (replicate, [*sum, *squares, count * squares - sum * sum, count * count, *count])
        });
        let sums = Sums::of(terms);
        let mean = Estimate::jackknife(|left_out| {
            let [sum, .., count] = sums.without(left_out);
            centre + sum / count
        });
        let known: Vec<f64> = sorted.iter().map(|(value, _)| *value).collect();
        let deviation = with_tails(deviation(&sums), mean.value, &known);
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

/// Standard deviation, from sums of values, of their squares, of `n squares - sum^2` and `n^2` of each replicate with n values, and
/// of n.
///
/// Values of different replicates are independent, those of one are not: the mean of half the squared differences of all pairs of
/// values of different replicates is an unbiased estimate of the variance. The root of an estimate with the standard error e is too
/// small by `e^2 / (2 sigma)`, which is added.
fn deviation(sums: &Sums<5>) -> Estimate {
    let found = Estimate::jackknife(|left_out| {
        let [sum, squares, within, pairs_within, count] = sums.without(left_out);
        ((count * squares - sum * sum - within) / (count * count - pairs_within)).max(0.0).sqrt()
    });
    let missing = found.standard_error.powi(2) / (2.0 * found.value);
    Estimate { value: if found.value > 0.0 { found.value + missing } else { found.value }, ..found }
}

/// Logit by which the largest value of other samples may lie beyond that of this one: with 95 % probability less.
const BEYOND: f64 = 3.0;

/// Adds to the standard error of a standard deviation what the jackknife does not know of long tails.
///
/// Most samples of a long tail lack its far values: their deviation and its jackknife error are both too small, and few samples have
/// both too large. Two more errors are added as squares: of each tail, the change of the deviation if its last value lay as far out
/// as the line of the [`TailLine`] puts it after [`BEYOND`]; and the change if the value that is farthest from the mean were absent,
/// half of its share in the variance, as far as this is more than that of a normal distribution, about `2 ln n / n`. Tails that end
/// have neither.
fn with_tails(found: Estimate, mean: f64, sorted: &[f64]) -> Estimate {
    let count = sorted.len() as f64;
    let far = [sorted.first(), sorted.last()].map(|end| end.map_or(0.0, |end| (end - mean).abs()));
    let variance = found.value.powi(2);
    if variance.is_nan() || is_rounding(mean, variance) {
        return found;
    }
    let tail = |end: usize| {
        let (rank, outwards) = if end == 0 { (1.0, -1.0) } else { (count, 1.0) };
        let Some(line) = TailLine::of(sorted, rank) else { return 0.0 };
        let bend = outwards * line.bend;
        let growth = if bend.abs() < 1e-9 { BEYOND } else { (BEYOND * bend).exp_m1() / bend };
        let beyond = line.level.exp() * growth;
        beyond * (2.0 * far[end] + beyond) / (2.0 * count * found.value)
    };
    let share = (far[0].max(far[1]).powi(2) / (count * variance)).min(1.0);
    let of_farthest = 0.5 * (share - 2.0 * count.ln() / count).max(0.0) * found.value;
    let errors = [found.standard_error, tail(0), tail(1), of_farthest];
    Estimate { standard_error: errors.iter().map(|error| error * error).sum::<f64>().sqrt(), ..found }
}

/// Percentiles of sorted values, each given with its replicate.
///
/// **Value**: the median-unbiased estimate, R. J. Hyndman and Y. Fan, Am. Stat. 50, 361 (1996), definition 8. Definition 7, which
/// many programs use, lies too far inside where few values lie outside: by 0.4 standard deviations for 1 % of 64 normal values.
///
/// **Standard error**: that of the logit of the fraction of displays below the percentile, times the [`slope`] of the metric over
/// the logit. This is the method of R. S. Woodruff (J. Am. Stat. Assoc. 47, 635 (1952)) in a coordinate in which the tails of most
/// distributions are almost straight, so that it holds where one value, or none, lies outside. For independent displays, the fraction
/// below the value of rank r of n has the beta distribution of r and n + 1 - r, and its logit the variance
/// `trigamma(r) + trigamma(n + 1 - r)`. Sobol points have less: by the ratio of the variances of the fraction, which the replicates
/// state. (The jackknife does not estimate the error of a percentile, because it depends only on the few values next to it.)
fn percentiles(sorted: &[(f64, usize)]) -> [Estimate; PERCENTILES.len()] {
    let values: Vec<f64> = sorted.iter().map(|(value, _)| *value).collect();
    let count = values.len() as f64;
    PERCENTILES.map(|percent| {
        let fraction = percent / 100.0;
        let value = interpolated(&values, fraction);
        let below = |other: f64| if other == value { 0.5 } else { f64::from(u8::from(other < value)) };
        let terms = sorted.iter().map(|(other, replicate)| (*replicate, [below(*other), 1.0]));
        let of_replicates = Sums::of(terms).fraction().standard_error;
        // Variances of the number of displays below. Whole numbers of each replicate are uncertain by rounding; where fewer
        // displays lie outside, they are independent.
        let independent = count * fraction * (1.0 - fraction);
        let outside = count * fraction.min(1.0 - fraction);
        let variance = (of_replicates * count).powi(2).max(outside.min(REPLICATES as f64 / 12.0));
        let rank = (count * fraction + 0.5).clamp(1.0, count);
        let of_logit = trigamma(rank) + trigamma(count + 1.0 - rank);
        let error = (variance / independent * of_logit).sqrt();
        Estimate { value, standard_error: slope(&values, rank, error) * error }
    })
}

/// Number of intervals between neighbouring values from which the slope in a tail is computed.
const TAIL_INTERVALS: f64 = 24.0;
/// Standard deviation of the change of the logarithm of the slope over the logit, before the values are known: 1 and -1 for a tail
/// with a uniform end, 0 for an exponential one, 1 for a density that falls with the square of the distance.
const BEND: f64 = 1.0;
/// Largest interval far from the rank, relative to its expected value: a gap in the distribution has no influence.
const GAP: f64 = 6.0;
/// Iterations of the fit of a slope, and the change at which they end.
const ITERATIONS: usize = 60;
const SAME: f64 = 1e-6;

/// Logarithm of the slope of sorted values over the logit of the fraction below, near a rank: a straight line over the logit.
///
/// The intervals between neighbouring values, divided by the difference of the expected logits of the ranks k and k + 1 of n,
/// `1/k + 1/(n - k)`, have an exponential distribution, whose mean is the slope. Its logarithm is a straight line over the logit
/// near the rank: the slope changes quickly in tails that are long, or that end. The line is that of the largest likelihood, with a
/// normal prior of its slope.
struct TailLine {
    /// Value at the rank.
    level: f64,
    /// Change with the logit.
    bend: f64,
    /// Variance of the level.
    variance: f64,
}

impl TailLine {
    /// Fits the line at a rank; `None` if the values there are equal.
    fn of(sorted: &[f64], rank: f64) -> Option<Self> {
        let count = sorted.len() as f64;
        let outside = rank.min(count + 1.0 - rank);
        let half = count.sqrt().min((0.75 * outside).max(TAIL_INTERVALS / 6.0));
        let least = if outside < count.sqrt() { TAIL_INTERVALS } else { 0.0 };
        let mut low = (rank - half).round().max(1.0);
        let mut high = (rank + half).round().min(count);
        let is_below = 2.0 * rank < count;
        if is_below {
            high = high.max(low + least).min(count);
        } else {
            low = low.min(high - least).max(1.0);
        }
        let logit = |rank: f64| (rank / (count + 1.0 - rank)).ln();
        let intervals: Vec<(f64, f64, f64)> = (low as usize..high as usize)
            .map(|k| {
                let (below, middle) = (k as f64, k as f64 + 0.5);
                let size = (sorted[k] - sorted[k - 1]) / (1.0 / below + 1.0 / (count - below));
                let most = if (middle - rank).abs() > half { GAP } else { f64::INFINITY };
                (logit(middle) - logit(rank), size, most)
            })
            .collect();
        let mean = intervals.iter().map(|(_, size, _)| size).sum::<f64>() / intervals.len() as f64;
        // Also NaN, without intervals.
        if !(mean > 0.0 && mean.is_finite()) {
            return None;
        }
        let products = intervals
            .iter()
            .fold([0.0, 0.0, BEND.powi(-2)], |[n, x, xx], (at, ..)| [n + 1.0, x + at, xx + at * at]);
        let [n, x, xx] = products;
        let determinant = n * xx - x * x;
        let (mut level, mut bend) = (mean.ln(), 0.0);
        for _ in 0..ITERATIONS {
            let slopes = intervals.iter().fold([0.0, -bend * BEND.powi(-2)], |[of_level, of_bend], one| {
                let (at, size, most) = *one;
                let excess = (size * (-level - bend * at).exp()).min(most) - 1.0;
                [of_level + excess, of_bend + excess * at]
            });
            let steps = [
                (xx * slopes[0] - x * slopes[1]) / determinant,
                (n * slopes[1] - x * slopes[0]) / determinant,
            ];
            let largest = steps[0].abs().max(steps[1].abs());
            let part = 1.0 / largest.max(1.0);
            (level, bend) = (level + part * steps[0], bend + part * steps[1]);
            if largest < SAME {
                break;
            }
        }
        Some(Self { level, bend, variance: xx / determinant })
    }
}

/// Slope of the sorted values at a rank, over the logit of the fraction below, as far as an error of the logit reaches. The mean of
/// the square of the estimate is that of the slope: errors of the line are included.
fn slope(sorted: &[f64], rank: f64, error: f64) -> f64 {
    let Some(TailLine { level, bend, variance }) = TailLine::of(sorted, rank) else { return 0.0 };
    // Outwards, a slope that grows counts at half of the error, beyond the last value.
    let outwards = if 2.0 * rank < sorted.len() as f64 { -bend } else { bend };
    (level + variance + 0.5 * error * outwards.max(0.0)).exp()
}

/// Trigamma function of x from 1 on, with an error of at most 1.4 %: Abramowitz and Stegun 6.4.12.
fn trigamma(x: f64) -> f64 {
    (1.0 + (0.5 + 1.0 / (6.0 * x)) / x) / x
}

/// Value below which a fraction of the distribution lies, by interpolation between sorted values; at most the outermost ones.
fn interpolated(sorted: &[f64], fraction: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else { return f64::NAN };
    let rank = (sorted.len() as f64 + 1.0 / 3.0) * fraction + 1.0 / 3.0;
    let position = (rank - 1.0).clamp(0.0, last as f64);
    let below = position.floor() as usize;
    let above = (below + 1).min(last);
    sorted[below] + (position - below as f64) * (sorted[above] - sorted[below])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Those of `numpy.percentile(..., method="median_unbiased")`.
    #[test]
    fn percentiles_of_equidistant_values_are_median_unbiased() {
        let values: Vec<f64> = (0..100).rev().map(f64::from).collect();
        let spread = MetricDistribution::of(&values).unwrap();
        let values = spread.percentiles.map(|one| one.value);
        let expected = [101.0 / 300.0, 4.35, 293.0 / 12.0, 49.5, 895.0 / 12.0, 94.65, 29_599.0 / 300.0];
        for (value, expected) in values.into_iter().zip(expected) {
            assert!((value - expected).abs() < 1e-12, "{values:?}");
        }
        assert_eq!((spread.range, spread.mean.value, spread.undefined), ([0.0, 99.0], 49.5, 0));
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
