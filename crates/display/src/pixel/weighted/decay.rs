//! How fast the coefficients of a film decrease, and what this tells about the missing ones.

use papilio_optics::with_widest_simd;

use super::rule::{Aliases, LAST};

/// Geometric bound of the missing coefficients, by pairs, from the last three pairs.
#[derive(Debug, Clone, Copy)]
pub(super) struct Decay {
    /// Bound of the last pairs.
    size: f64,
    /// Factor from each pair to the next one.
    ratio: f64,
}

/// Largest ratio of pairs that is extrapolated.
const SLOWEST: f64 = 0.95;

impl Decay {
    /// Returns the decay of magnitudes. They oscillate where a structure has the same angle at all
    /// wavelengths, and a pair may be small by chance: the bound has the size of the largest pair and the
    /// slowest decay between any two.
    pub(super) fn of(last: [f64; LAST]) -> Self {
        let [first, second, third] = [0, 2, 4].map(|k: usize| last[k] + last[k + 1]);
        let quotient = |next: f64, before: f64| if next > 0.0 { next / before } else { 0.0 };
        let slowest = quotient(second, first).max(quotient(third, second)).max(quotient(third, first).sqrt());
        Self { size: first.max(second).max(third), ratio: slowest.min(SLOWEST) }
    }

    /// Returns the error of light with these factors.
    pub(super) fn error(&self, aliases: &Aliases) -> f64 {
        let Some((others, pairs)) = aliases.split_last() else { return 0.0 };
        let (mut pair, mut sum) = (self.size, 0.0);
        for alias in pairs {
            pair *= self.ratio;
            sum += pair * alias;
        }
        sum + pair * self.ratio / (1.0 - self.ratio) * others
    }
}

/// Returns the products of each row of a matrix with a vector.
pub(super) fn dots(rows: &[f64], vector: &[f64]) -> Vec<f64> {
    let mut products = vec![0.0; rows.len() / vector.len()];
    with_widest_simd(
        #[inline(always)]
        || {
            for (product, row) in products.iter_mut().zip(rows.chunks_exact(vector.len())) {
                *product = dot_in_lanes(row, vector);
            }
        },
    );
    products
}

#[inline(always)]
fn dot_in_lanes(a: &[f64], b: &[f64]) -> f64 {
    const LANES: usize = 16;
    let (a, a_rest) = a.as_chunks::<LANES>();
    let (b, b_rest) = b.as_chunks::<LANES>();
    let mut sums = [0.0; LANES];
    for (a, b) in a.iter().zip(b) {
        for k in 0..LANES {
            sums[k] += a[k] * b[k];
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    sums.iter().sum::<f64>() + rest
}

/// Returns sums over the nodes of values `[node][column]` with several weights each: `[sum][column]`.
pub(super) fn weighted_rows(values: &[f64], weights: &[Vec<f64>; LAST]) -> Vec<f64> {
    let columns = values.len() / weights[0].len();
    let mut sums = vec![0.0; LAST * columns];
    with_widest_simd(
        #[inline(always)]
        || {
            for (sum, weights) in sums.chunks_exact_mut(columns).zip(weights) {
                let done = add_columns::<32>(sum, values, weights, 0);
                let done = add_columns::<8>(sum, values, weights, done);
                add_columns::<1>(sum, values, weights, done);
            }
        },
    );
    sums
}

/// Adds weighted rows to columns from the first one on, `N` at a time, whose sums remain in registers;
/// returns the next column.
#[inline(always)]
fn add_columns<const N: usize>(sum: &mut [f64], rows: &[f64], weights: &[f64], first: usize) -> usize {
    let columns = sum.len();
    let (chunks, _) = sum[first..].as_chunks_mut::<N>();
    for (number, chunk) in chunks.iter_mut().enumerate() {
        let mut sums = *chunk;
        for (row, weight) in rows.chunks_exact(columns).zip(weights) {
            let row = &row[first + number * N..][..N];
            sums.iter_mut().zip(row).for_each(|(sum, value)| *sum += weight * value);
        }
        *chunk = sums;
    }
    first + chunks.len() * N
}
