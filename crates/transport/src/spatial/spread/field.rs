//! Light from many directions through a lobe, tabulated over directions in the glass.
//!
//! **What.** The sum of the lobes about all directions of a field is asked at many more directions than it has
//! details. Its poles are one width off the real directions: a polynomial on a square of [`SIDE`] widths
//! converges by a factor of 1.87 with each order. (On smaller squares it converges faster, and they need more
//! values in all: 1.7 times as many with half of the width.) Squares are computed when they are asked for.

use std::f64::consts::PI;
use std::sync::OnceLock;

use papilio_optics::lobe::{KCorrelation, Lobe};
use papilio_optics::{Beta, Scatterer, with_widest_simd};

use super::Bundle;
use crate::light::cone_points::Point;

/// Width of a square, in widths of the lobe: half of it is 1.5 times the distance to the poles.
const SIDE: f64 = 3.0;

/// Natural logarithm of the factor of convergence, `h + sqrt(1 + h^2)` with h = 2/3 (Bernstein's ellipse).
const BY_ORDER: f64 = 0.625;

/// Natural digits by which the field itself is less accurate than other directions.
const COARSER: f64 = 4.0;

/// Most squares along an axis: a narrower lobe is not tabulated.
const MOST_SQUARES: f64 = 512.0;

/// Fewest directions of a field that is tabulated.
const FEWEST: usize = 64;

/// Most coefficients along an axis.
const MOST_ORDER: usize = 24;

/// Light from everywhere, through a lobe.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::spatial) struct FieldLight {
    pub(in crate::spatial) bundle: Bundle,
    table: Option<Table>,
}

/// Squares over directions in the glass.
#[derive(Debug, Clone, PartialEq)]
struct Table {
    width: f64,
    /// Directions are between this, with both signs.
    end: f64,
    count: usize,
    order: usize,
    /// Coefficients of Chebyshev polynomials, rows along x.
    squares: Vec<OnceLock<Vec<f64>>>,
}

impl FieldLight {
    /// Prepares the light of a field, in directions up to `end` from the normal.
    pub(in crate::spatial) fn new(bundle: Bundle, lobe: Lobe, (end, digits): (f64, f64)) -> Self {
        let Lobe::KCorrelation { width } = lobe else { return Self { bundle, table: None } };
        let squares = (2.0 * end / (SIDE * width)).ceil();
        if bundle.points.len() < FEWEST || squares > MOST_SQUARES {
            return Self { bundle, table: None };
        }
        let count = squares as usize;
        let order = (((digits - COARSER) / BY_ORDER).ceil() as usize + 3).clamp(4, MOST_ORDER);
        let squares = vec![OnceLock::new(); count * count];
        Self { bundle, table: Some(Table { width, end, count, order, squares }) }
    }

    /// Sum of the lobes around the directions of the field.
    pub(super) fn through(&self, lobe: Lobe, beta: Beta) -> f64 {
        match &self.table {
            Some(table) => table.at(&self.bundle.points, beta),
            None => lobes_around(lobe, &self.bundle.points, beta),
        }
    }
}

impl Table {
    /// Value at a direction.
    fn at(&self, points: &[Point], beta: Beta) -> f64 {
        let side = 2.0 * self.end / self.count as f64;
        let place = [beta.x, beta.y].map(|x| (x + self.end) / side);
        let [column, row] = place.map(|place| (place.max(0.0) as usize).min(self.count - 1));
        let middle = [column, row].map(|k| (k as f64 + 0.5) * side - self.end);
        let middle = Beta { x: middle[0], y: middle[1] };
        let square =
            self.squares[row * self.count + column].get_or_init(|| self.square(points, middle, side));
        let [x, y] = [beta.x - middle.x, beta.y - middle.y].map(|x| 2.0 * x / side);
        let (along, across) = (polynomials(x, self.order), polynomials(y, self.order));
        let of_row = |row: &[f64]| row.iter().zip(&along).map(|(c, t)| c * t).sum::<f64>();
        square.chunks_exact(self.order).zip(&across).map(|(row, t)| t * of_row(row)).sum()
    }

    fn square(&self, points: &[Point], middle: Beta, side: f64) -> Vec<f64> {
        let order = self.order;
        let angle = |k: usize| PI * (k as f64 + 0.5) / order as f64;
        let lobe = Lobe::KCorrelation { width: self.width };
        let at = |k: usize| {
            let [x, y] = [k % order, k / order].map(|k| 0.5 * side * angle(k).cos());
            lobes_around(lobe, points, middle + Beta { x, y })
        };
        let values: Vec<f64> = (0..order * order).map(at).collect();
        // Along rows, then along columns.
        let transformed = |values: &[f64]| -> Vec<f64> {
            let mut all = vec![0.0; order * order];
            for line in 0..order {
                for degree in 0..order {
                    let factor = if degree == 0 { 1.0 } else { 2.0 } / order as f64;
                    let sum: f64 =
                        (0..order).map(|k| values[line * order + k] * (degree as f64 * angle(k)).cos()).sum();
                    // Transposed.
                    all[degree * order + line] = factor * sum;
                }
            }
            all
        };
        transformed(&transformed(&values))
    }
}

/// The first Chebyshev polynomials at a place between -1 and 1.
fn polynomials(t: f64, order: usize) -> [f64; MOST_ORDER] {
    let mut all = [1.0; MOST_ORDER];
    all[1] = t;
    for k in 2..order {
        all[k] = 2.0 * t * all[k - 1] - all[k - 2];
    }
    all
}

/// Sum of the lobes around some directions.
pub(super) fn lobes_around(lobe: Lobe, points: &[Point], beta: Beta) -> f64 {
    if let [only] = points {
        return only.weight * lobe.density(only.beta, beta);
    }
    let Lobe::KCorrelation { width } = lobe else {
        return points.iter().map(|point| point.weight * lobe.density(point.beta, beta)).sum();
    };
    let lobe = KCorrelation { width };
    with_widest_simd(
        #[inline(always)]
        || {
            // Several sums side by side.
            let mut sums = [0.0; 8];
            let (pieces, rest) = points.as_chunks::<8>();
            for piece in pieces {
                for (sum, point) in sums.iter_mut().zip(piece) {
                    *sum += point.weight * lobe.at_squared_distance((point.beta - beta).squared());
                }
            }
            let rest = rest.iter().map(|p| p.weight * lobe.at_squared_distance((p.beta - beta).squared()));
            sums.iter().sum::<f64>() + rest.sum::<f64>()
        },
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Squares against the sum over all directions, also between their nodes and at their borders.
    #[test]
    fn squares_hold_the_sum_of_the_lobes() {
        let spiral = |k: usize| {
            let (radius, turn) = ((k as f64 + 0.5) / 200.0, 2.4 * k as f64);
            let beta = Beta { x: radius.sqrt() * turn.cos(), y: radius.sqrt() * turn.sin() };
            Point { beta, weight: 1.0 + (3.0 * turn).sin() }
        };
        let points: Vec<Point> = (0..200).map(spiral).collect();
        for (width, digits) in [(0.05, 12.0), (0.05, 16.0), (0.3, 12.0)] {
            let lobe = Lobe::KCorrelation { width };
            let bundle = Bundle { points: points.clone(), centre: Beta { x: 0.0, y: 0.0 }, radius: 1.0 };
            let field = FieldLight::new(bundle, lobe, (1.5, digits));
            assert!(field.table.is_some());
            let pairs: Vec<[f64; 2]> = (0..2000)
                .map(|k| {
                    let at = |factor: f64| 2.0 * (factor * f64::from(k)).fract() - 1.0;
                    let beta = Beta { x: at(0.618_034), y: at(0.754_878) };
                    [field.through(lobe, beta), lobes_around(lobe, &points, beta)]
                })
                .collect();
            let largest = pairs.iter().fold(0.0_f64, |most, [_, sum]| most.max(*sum));
            let error = pairs.iter().fold(0.0_f64, |most, [table, sum]| most.max((table - sum).abs()));
            assert!(error < (COARSER - digits).exp() * largest, "{width} {digits}: {:e}", error / largest);
        }
    }
}
