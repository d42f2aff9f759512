//! Quantiles of many differences without keeping them.

/// Steps of a difference of 1.
const STEPS: f32 = 256.0;

/// Differences of this size and larger ones are counted together.
const MOST: usize = 200;

/// Numbers of differences by size, of which 0 has a place of its own.
#[derive(Debug, Clone)]
pub(super) struct Histogram {
    counts: Vec<u32>,
}

impl Default for Histogram {
    fn default() -> Self {
        Self { counts: vec![0; MOST * STEPS as usize + 2] }
    }
}

impl Histogram {
    /// Counts differences, and adds them to a sum. What is not a number counts as 0.
    #[inline(always)]
    pub(super) fn count(&mut self, differences: &[f32], sum: &mut f64) {
        let last = self.counts.len() - 1;
        // Several sums do not wait for each other.
        let mut sums = [0.0; 8];
        for part in differences.chunks(8) {
            for (sum, difference) in sums.iter_mut().zip(part) {
                // A conversion saturates, and makes 0 of what is not a number.
                let step = (difference * STEPS) as usize + usize::from(*difference > 0.0);
                self.counts[step.min(last)] += 1;
                *sum += f64::from(*difference);
            }
        }
        *sum += sums.iter().sum::<f64>();
    }

    pub(super) fn add(&mut self, other: &Self) {
        self.counts.iter_mut().zip(&other.counts).for_each(|(count, other)| *count += other);
    }

    /// The difference below which this fraction lies, with equal distances inside a step.
    pub(super) fn quantile(&self, fraction: f64) -> f64 {
        let all: u64 = self.counts.iter().map(|count| u64::from(*count)).sum();
        let at = ((all.max(1) - 1) as f64 * fraction).round();
        let mut below = 0.0;
        for (step, count) in self.counts.iter().enumerate() {
            let count = f64::from(*count);
            if below + count > at {
                let part = (at - below + 0.5) / count;
                return if step == 0 { 0.0 } else { ((step - 1) as f64 + part) / f64::from(STEPS) };
            }
            below += count;
        }
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_the_sorted_differences() {
        let mut values: Vec<f32> =
            (0..9999).map(|k| 40.0 * ((0.618_034 * k as f64).fract() as f32).powi(3)).collect();
        let [mut one, mut other] = [Histogram::default(), Histogram::default()];
        let mut sum = 0.0;
        one.count(&values[..5000], &mut sum);
        other.count(&values[5000..], &mut sum);
        one.add(&other);
        values.sort_by(f32::total_cmp);
        assert!((sum - values.iter().map(|one| f64::from(*one)).sum::<f64>()).abs() < 1e-9);
        for fraction in [0.0_f64, 0.1, 0.5, 0.95, 1.0] {
            let expected = f64::from(values[(9998.0 * fraction).round() as usize]);
            assert!((one.quantile(fraction) - expected).abs() < 1.0 / 256.0, "{fraction}");
        }
        let mut same = Histogram::default();
        same.count(&[0.0; 5], &mut 0.0);
        assert_eq!(same.quantile(0.95), 0.0);
    }
}
