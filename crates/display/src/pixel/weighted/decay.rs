//! How fast the coefficients of a film decrease, and what this tells about the missing ones.

use papilio_optics::with_widest_simd;

use super::rule::{Aliases, LAST};

/// Geometric bound of coefficients, by pairs, from the last three of them.
#[derive(Debug, Clone, Copy)]
pub(super) struct Decay {
    /// Bound of the last pair.
    size: f64,
    /// Factor from each pair to the next one.
    ratio: f64,
}

/// Largest ratio of pairs that is extrapolated.
const SLOWEST: f64 = 0.95;

impl Decay {
    /// Returns the decay of magnitudes.
    pub(super) fn of(last: [f64; LAST]) -> Self {
        let [first, second, third] = [0, 2, 4].map(|k: usize| last[k] + last[k + 1]);
        let ratio = if first > 0.0 { (third / first).sqrt().min(SLOWEST) } else { 0.0 };
        // A pair may be small by chance: the bound holds for all three.
        Self { size: third.max(second * ratio).max(first * ratio * ratio), ratio }
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

/// Returns the sum of products.
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    with_widest_simd(
        #[inline(always)]
        || dot_in_lanes(a, b),
    )
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
            let done = add_columns::<16>(values, weights, &mut sums, 0);
            add_columns::<1>(values, weights, &mut sums, done);
        },
    );
    sums
}

/// Computes the sums `N` columns at a time from this one on: all of a block remain in registers. Returns the next column.
#[inline(always)]
fn add_columns<const N: usize>(
    values: &[f64],
    weights: &[Vec<f64>; LAST],
    out: &mut [f64],
    first: usize,
) -> usize {
    let columns = out.len() / LAST;
    let mut at = first;
    while at + N <= columns {
        let mut sums = [[0.0; N]; LAST];
        for (node, row) in values.chunks_exact(columns).enumerate() {
            let row = &row[at..][..N];
            for k in 0..LAST {
                let weight = weights[k][node];
                for lane in 0..N {
                    sums[k][lane] += weight * row[lane];
                }
            }
        }
        for (row, sums) in out.chunks_exact_mut(columns).zip(&sums) {
            row[at..][..N].copy_from_slice(sums);
        }
        at += N;
    }
    at
}
