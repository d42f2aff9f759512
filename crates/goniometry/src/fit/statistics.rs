//! Covariance of fitted parameters, and their confidence intervals, for errors of any sizes.
//!
//! With `A = J^T W J` and residuals `r` of readings with the slopes `j`, the covariance is `A^-1 M A^-1`,
//! `M = sum of j j^T (r/(1 - h))^2`: the heteroscedasticity-consistent estimate HC3 (MacKinnon & White, Journal of
//! Econometrics 29, 305 (1985)). The leverage `h = j^T A^-1 j` of a reading is the fraction by which the fit follows
//! its error. Copies of a reading have the same error, and are one reading with the sum of their slopes (each times the residual).
//!
//! The estimated variance of a parameter is a sum of one square for each reading. If few of them dominate, as at the peak of
//! a narrow lobe, it is uncertain; Student's quantile is that of the degrees of freedom `3 (sum of squares)^2/(sum of their
//! squares)` (Satterthwaite; the fourth power of a normal error is 3 times its squared variance), at most the number of readings
//! less that of the parameters.

use super::linear;
use super::problem::dot;
use crate::models::Meaning;

/// Smallest difference of a leverage from 1. At a smaller one, the residual is rounding, and that of all cells is used.
const LEAST_FREE: f64 = 1e-6;

/// Covariance of the parameters, and the degrees of freedom of each variance.
pub(super) struct Spread {
    /// Covariance, row by row; infinite if the data do not determine the parameters.
    pub(super) covariance: Vec<f64>,
    freedom: Vec<f64>,
}

impl Spread {
    /// Statistics of derivatives by parameter and residuals of all cells, with the number of each cell's reading, and
    /// the number of readings.
    pub(super) fn new(slopes: &[Vec<f64>], residuals: &[f64], (readings, count): (&[usize], usize)) -> Self {
        let size = slopes.len();
        let normal: Vec<f64> = slopes.iter().flat_map(|a| slopes.iter().map(|b| dot(a, b))).collect();
        let Some(inverse) = linear::inverse(&normal, size) else {
            return Self { covariance: vec![f64::INFINITY; size * size], freedom: vec![1.0; size] };
        };
        let freedom = count.saturating_sub(size).max(1) as f64;
        // Of each reading: the sum of slopes times residuals, the squared residual, and the leverage.
        let mut sums = vec![vec![0.0; size]; count];
        let (mut squares, mut leverages) = (vec![0.0; count], vec![0.0; count]);
        for (cell, reading) in readings.iter().enumerate() {
            let of_cell = |k: usize| slopes[k][cell];
            for (k, sum) in sums[*reading].iter_mut().enumerate() {
                *sum += of_cell(k) * residuals[cell];
                leverages[*reading] +=
                    (0..size).map(|j| of_cell(k) * inverse[k * size + j] * of_cell(j)).sum::<f64>();
            }
            squares[*reading] += residuals[cell] * residuals[cell];
        }
        let variance = dot(residuals, residuals) / freedom;
        let moves: Vec<Vec<f64>> = (sums.iter().zip(squares).zip(leverages))
            .map(|((sum, square), leverage)| {
                let free = 1.0 - leverage;
                let factor = match free > LEAST_FREE {
                    true => 1.0 / free,
                    false => (variance / square.max(f64::MIN_POSITIVE)).sqrt(),
                };
                let moved = |k: usize| factor * dot(&inverse[k * size..][..size], sum);
                (0..size).map(moved).collect()
            })
            .collect();
        let total = |of: &dyn Fn(&[f64]) -> f64| moves.iter().map(|moves| of(moves)).sum::<f64>();
        let covariance = (0..size * size).map(|at| total(&|m| m[at / size] * m[at % size])).collect();
        let of_variance = |k: usize| {
            let (sum, squares) = (total(&|m| m[k].powi(2)), total(&|m| m[k].powi(4)));
            if squares > 0.0 { (3.0 * sum * sum / squares).min(freedom) } else { freedom }
        };
        Self { covariance, freedom: (0..size).map(of_variance).collect() }
    }

    /// Confidence interval of 95 % of parameter `k`: of its logarithm if that is varied, and within the range of the
    /// parameter.
    pub(super) fn interval(&self, k: usize, value: f64, meaning: &Meaning) -> [f64; 2] {
        let [low, high] = meaning.range;
        let size = self.freedom.len();
        let half = linear::student_975(self.freedom[k]) * self.covariance[k * size + k].sqrt();
        let ends = match meaning.logarithmic {
            true => [-1.0, 1.0].map(|sign| value * (sign * half / value).exp()),
            false => [value - half, value + half],
        };
        ends.map(|end| end.clamp(low, high))
    }
}
