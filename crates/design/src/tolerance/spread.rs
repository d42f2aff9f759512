//! How a metric scatters.

use serde::Serialize;

use super::estimate::{Estimate, Sums};
use super::plan::replicate;

/// The percentiles that are given.
pub const PERCENTILES: [f64; 7] = [1.0, 5.0, 25.0, 50.0, 75.0, 95.0, 99.0];

/// How a metric scatters over the pieces that have it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Spread {
    /// Pieces that do not have it.
    pub undefined: usize,
    /// Mean.
    pub mean: Estimate,
    /// Standard deviation.
    pub deviation: Estimate,
    /// The least and the largest.
    pub range: [f64; 2],
    /// At each of [`PERCENTILES`] what so many per cent of the pieces lie below, by linear interpolation between
    /// neighbours.
    pub percentiles: [Estimate; PERCENTILES.len()],
}

impl Spread {
    /// Of a metric of all pieces, NaN where undefined; `None` if it is nowhere defined.
    pub fn of(values: &[f64]) -> Option<Self> {
        let known = values.iter().copied().enumerate().filter(|(_, value)| !value.is_nan());
        let mut sorted: Vec<(f64, usize)> = known.map(|(row, value)| (value, replicate(row))).collect();
        sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (first, last) = (sorted.first()?.0, sorted.last()?.0);
        // Far from 0, squares lose the digits that a small spread is in.
        let centre = sorted[sorted.len() / 2].0;
        let terms = sorted.iter().map(|(value, of)| (*of, [value - centre, (value - centre).powi(2), 1.0]));
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
}

/// Of values in order, each with its replicate.
///
/// Standard errors are Woodruff's (J. Am. Stat. Assoc. 47, 635 (1952)): that of the share of pieces below the percentile, from the
/// replicates, carried over to the metric by the slope between percentiles on both sides, so far off that there are enough pieces
/// between them. (The jackknife is no estimate of a percentile's error: it sees but the few values next to it.)
fn percentiles(sorted: &[(f64, usize)]) -> [Estimate; PERCENTILES.len()] {
    let values: Vec<f64> = sorted.iter().map(|(value, _)| *value).collect();
    PERCENTILES.map(|percent| {
        let share = percent / 100.0;
        let value = interpolated(&values, share);
        let below = |other: f64| if other == value { 0.5 } else { f64::from(u8::from(other < value)) };
        let terms = sorted.iter().map(|(other, of)| (*of, [below(*other), 1.0]));
        let count = values.len() as f64;
        // A piece more or less is always in doubt.
        let error = Sums::of(terms).share().standard_error.max(0.5 / count);
        let off = count.sqrt().recip().min(0.5 * share).min(0.5 * (1.0 - share)).max(error);
        let (low, high) = ((share - off).max(0.0), (share + off).min(1.0));
        let slope = (interpolated(&values, high) - interpolated(&values, low)) / (high - low);
        Estimate { value, standard_error: slope * error }
    })
}

/// The number below which a share of the ordered numbers lies.
fn interpolated(sorted: &[f64], share: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else { return f64::NAN };
    let place = share * last as f64;
    let below = (place.floor() as usize).min(last);
    let above = (below + 1).min(last);
    sorted[below] + (place - below as f64) * (sorted[above] - sorted[below])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_of_even_numbers() {
        let values: Vec<f64> = (0..=4000).rev().map(f64::from).collect();
        let spread = Spread::of(&values).unwrap();
        let found = spread.percentiles.map(|one| one.value);
        assert_eq!(found, PERCENTILES.map(|percent| 40.0 * percent));
        assert_eq!((spread.range, spread.mean.value, spread.undefined), ([0.0, 4000.0], 2000.0, 0));
    }

    #[test]
    fn what_is_undefined_is_counted_and_left_out() {
        let mut values = vec![1e9 + 1.0; 100];
        values[3] = f64::NAN;
        let spread = Spread::of(&values).unwrap();
        assert_eq!((spread.undefined, spread.mean.value, spread.deviation.value), (1, 1e9 + 1.0, 0.0));
        assert!(Spread::of(&[f64::NAN; 50]).is_none());
    }
}
