//! The errors of a picture of states, correlated with the autocorrelations of the filters.

use std::ops::Range;

use pulp::NullaryFnOnce;

use super::costs::Costs;
use super::filter::Correlation;

/// A picture, and the states that show it.
#[derive(Clone, Copy)]
pub(super) struct Shown<'a, const N: usize> {
    pub(super) wanted: &'a [[f32; N]],
    pub(super) columns: usize,
    pub(super) states: &'a [u8],
    /// From `wanted` to the coordinates.
    pub(super) metric: [[f32; N]; N],
}

/// Some rows of a picture that are correlated; the result is the error E of them.
pub(super) struct Correlate<'a, const N: usize> {
    pub(super) shown: Shown<'a, N>,
    pub(super) costs: &'a Costs<N>,
    pub(super) rows: Range<usize>,
    /// The coordinates of each row one after the other, each between margins of this width.
    pub(super) into: &'a mut [f32],
    pub(super) margin: usize,
}

impl<const N: usize> Shown<'_, N> {
    /// What is shown less what is wanted, of a row and a coordinate; what is not finite is wanted as 0.
    #[inline(always)]
    fn errors(&self, costs: &Costs<N>, row: usize, k: usize, into: &mut [f32]) {
        let pixels = row * self.columns..(row + 1) * self.columns;
        let both = self.wanted[pixels.clone()].iter().zip(&self.states[pixels]);
        for (error, (wanted, state)) in into.iter_mut().zip(both) {
            let mut along = 0.0;
            for (metric, wanted) in self.metric[k].iter().zip(wanted) {
                along += metric * wanted;
            }
            *error = costs.palette[usize::from(*state)][k] - if along.is_finite() { along } else { 0.0 };
        }
    }
}

impl<const N: usize> NullaryFnOnce for Correlate<'_, N> {
    type Output = f64;

    #[inline(always)]
    fn call(self) -> f64 {
        let Self { shown, costs, rows, into, margin } = self;
        let (columns, all) = (shown.columns, shown.wanted.len() / shown.columns);
        let stride = columns + 2 * margin;
        let mut errors = vec![0.0; columns];
        let mut sum = 0.0;
        for (k, correlation) in costs.correlations.iter().enumerate() {
            let [across, down] = correlation.reach;
            let sources = rows.start.saturating_sub(down)..(rows.end + down).min(all);
            let mut padded = vec![0.0; columns + 2 * across];
            let mut line = vec![0.0; columns];
            for from in sources {
                shown.errors(costs, from, k, &mut padded[across..][..columns]);
                if let Some([along, _]) = &correlation.factors {
                    filter(&mut line, &padded, along);
                }
                for to in from.saturating_sub(down).max(rows.start)..(from + down + 1).min(rows.end) {
                    let at = ((to - rows.start) * N + k) * stride + margin;
                    add(&mut into[at..][..columns], correlation, from as isize - to as isize, &line, &padded);
                }
            }
            for row in rows.clone() {
                shown.errors(costs, row, k, &mut errors);
                let correlated = &into[((row - rows.start) * N + k) * stride + margin..][..columns];
                let products = errors.iter().zip(correlated).map(|(error, r)| f64::from(error * r));
                sum += products.sum::<f64>();
            }
        }
        sum
    }
}

/// Adds what a row contributes to another, `down` rows above it: of its filtered line, or of the row itself.
#[inline(always)]
fn add(into: &mut [f32], correlation: &Correlation, down: isize, line: &[f32], padded: &[f32]) {
    if let Some([_, along_y]) = &correlation.factors {
        let weight = along_y[correlation.reach[1].wrapping_add_signed(down)];
        into.iter_mut().zip(line).for_each(|(sum, value)| *sum += weight * value);
        return;
    }
    for (x, weight) in correlation.row(down)[..2 * correlation.reach[0] + 1].iter().enumerate() {
        into.iter_mut().zip(&padded[x..]).for_each(|(sum, error)| *sum += weight * error);
    }
}

/// Filters a row that has zeros on both sides.
#[inline(always)]
fn filter(line: &mut [f32], padded: &[f32], weights: &[f32]) {
    line.fill(0.0);
    for (x, weight) in weights.iter().enumerate() {
        line.iter_mut().zip(&padded[x..]).for_each(|(sum, error)| *sum += weight * error);
    }
}
