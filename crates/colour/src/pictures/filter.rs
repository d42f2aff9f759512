//! Filters of a picture's plane by small kernels.

use super::rows::{LANES, Taps};

/// Pixels that are computed at once.
const BLOCK: usize = 16;

/// A kernel that is the same on both sides of its middle, or the opposite. It is applied to differences of
/// values, so that uniform planes become exactly the total times their value.
pub(super) struct Kernel {
    total: f32,
    /// Weights at distances of 1, 2, ... pixels upwards.
    sides: Vec<f32>,
    is_odd: bool,
}

impl Kernel {
    /// The kernel with these weights in the middle and at distances of 1, 2, ... pixels on both sides.
    pub(super) fn even(weights: &[f64]) -> Self {
        let total = weights[0] + 2.0 * weights[1..].iter().sum::<f64>();
        // Sums that are 0 or 1 are so exactly.
        let total = if (total - total.round()).abs() < 1e-12 { total.round() } else { total };
        Self { total: total as f32, sides: Self::sides(weights), is_odd: false }
    }

    /// The kernel with these weights at distances of 0, 1, ... pixels upwards, and the opposite ones
    /// downwards.
    pub(super) fn odd(weights: &[f64]) -> Self {
        Self { total: 0.0, sides: Self::sides(weights), is_odd: true }
    }

    /// All but the last ones below the rounding.
    fn sides(weights: &[f64]) -> Vec<f32> {
        let most = weights.iter().fold(0.0_f64, |most, weight| most.max(weight.abs()));
        let last = weights.iter().rposition(|weight| weight.abs() > 1e-9 * most).unwrap_or(0);
        weights[1..=last].iter().map(|weight| *weight as f32).collect()
    }

    /// Adds the value and those at its sides, of which `at` returns the one below and the one above at a
    /// distance.
    #[inline(always)]
    fn apply<'a>(&self, middle: &[f32], sums: &mut [f32], at: impl Fn(usize) -> [&'a [f32]; 2]) {
        sums.iter_mut().zip(middle).for_each(|(sum, value)| *sum = self.total * value);
        for (k, weight) in self.sides.iter().enumerate() {
            let [below, above] = at(k + 1);
            let near = sums.iter_mut().zip(middle).zip(below.iter().zip(above));
            if self.is_odd {
                near.for_each(|((sum, _), (below, above))| *sum += weight * (below - above));
            } else {
                near.for_each(|((sum, value), (below, above))| {
                    *sum += weight * ((below - value) + (above - value))
                });
            }
        }
    }

    /// Convolves the rows of a plane. Beyond its borders the picture continues with the values at the border.
    #[inline(always)]
    pub(super) fn along_rows(&self, plane: &[f32], columns: usize) -> Vec<f32> {
        let radius = self.sides.len();
        let mut padded = vec![0.0; columns + 2 * radius + BLOCK];
        let mut result = vec![0.0; plane.len()];
        for (row, into) in plane.chunks_exact(columns).zip(result.chunks_exact_mut(columns)) {
            padded[..radius].fill(row[0]);
            padded[radius..radius + columns].copy_from_slice(row);
            padded[radius + columns..].fill(row[columns - 1]);
            for (block, into) in into.chunks_mut(BLOCK).enumerate() {
                let middle = block * BLOCK + radius;
                let near = |at: usize| &padded[at..at + BLOCK];
                let mut sums = [0.0; BLOCK];
                self.apply(near(middle), &mut sums, |distance| {
                    [near(middle - distance), near(middle + distance)]
                });
                into.copy_from_slice(&sums[..into.len()]);
            }
        }
        result
    }

    /// Convolves the columns of a plane, likewise.
    #[inline(always)]
    pub(super) fn along_columns(&self, plane: &[f32], columns: usize) -> Vec<f32> {
        let last = plane.len() / columns - 1;
        let row = |at: usize| &plane[at * columns..(at + 1) * columns];
        let mut result = vec![0.0; plane.len()];
        for (middle, into) in result.chunks_exact_mut(columns).enumerate() {
            let near =
                |distance: usize| [row(middle.saturating_sub(distance)), row((middle + distance).min(last))];
            self.apply(row(middle), into, near);
        }
        result
    }
}

impl Taps for Kernel {
    #[inline(always)]
    fn reach(&self) -> usize {
        self.sides.len()
    }

    #[inline(always)]
    fn add<'a>(
        &self,
        sums: &mut [f32; LANES],
        middle: &[f32; LANES],
        near: impl Fn(usize) -> [&'a [f32; LANES]; 2],
    ) {
        for lane in 0..LANES {
            sums[lane] += self.total * middle[lane];
        }
        for (k, weight) in self.sides.iter().enumerate() {
            let [below, above] = near(k + 1);
            if self.is_odd {
                for lane in 0..LANES {
                    sums[lane] += weight * (below[lane] - above[lane]);
                }
            } else {
                for lane in 0..LANES {
                    sums[lane] += weight * ((below[lane] - middle[lane]) + (above[lane] - middle[lane]));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kernels_act_along_their_axes_and_hold_borders() {
        let mut plane = vec![0.0; 25];
        plane[12] = 1.0;
        let [even, odd] = [Kernel::even(&[2.0, 1.0]), Kernel::odd(&[0.0, 3.0])];
        let spread = odd.along_columns(&even.along_rows(&plane, 5), 5);
        let expected = [
            [0.0, 0.0, 0.0, 0.0, 0.0],
            [0.0, -3.0, -6.0, -3.0, 0.0],
            [0.0, 0.0, 0.0, 0.0, 0.0],
            [0.0, 3.0, 6.0, 3.0, 0.0],
            [0.0, 0.0, 0.0, 0.0, 0.0],
        ];
        assert_eq!(spread, expected.concat());
        assert_eq!(odd.along_rows(&[1.0, 1.0, 2.0, 2.0], 4), [0.0, -3.0, -3.0, 0.0]);
        let third = Kernel::even(&[1.0 / 3.0, 1.0 / 3.0]);
        assert_eq!(third.along_columns(&third.along_rows(&[0.7; 40], 20), 20), [0.7; 40]);
    }
}
