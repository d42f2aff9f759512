//! Gauss-Legendre rules, for this crate and those above it.

use std::f64::consts::PI;
use std::sync::LazyLock;

/// Largest number of points of [`gauss`].
const MOST_POINTS: usize = 40;

/// Nodes and weights on (-1, 1), by the number of points.
static RULES: LazyLock<Vec<Vec<(f64, f64)>>> =
    LazyLock::new(|| (0..=MOST_POINTS).map(|points| legendre(points, 0.0)).collect());

/// Returns nodes and weights of the rule of this many points, 1 to 40, on an interval.
pub fn gauss(from: f64, to: f64, points: usize) -> impl Iterator<Item = (f64, f64)> {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    RULES[points.clamp(1, MOST_POINTS)].iter().map(move |(x, weight)| (middle + half * x, half * weight))
}

/// Returns ascending nodes and their weights of the Gauss-Legendre rule of this many points on (-1, 1), by
/// Newton's method from Tricomi's first approximation. Nodes are within 1e-15; after a step below `last_step`
/// no further one is made (0: all eight steps).
pub fn legendre(points: usize, last_step: f64) -> Vec<(f64, f64)> {
    let n = points as f64;
    let node = |i: usize| {
        let mut x = (PI * (n - i as f64 - 0.25) / (n + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..8 {
            let (mut before, mut value) = (1.0, x);
            for k in 2..=points {
                let k = k as f64;
                (before, value) = (value, ((2.0 * k - 1.0) * x * value - (k - 1.0) * before) / k);
            }
            slope = n * (x * value - before) / (x * x - 1.0);
            let step = value / slope;
            x -= step;
            if step.abs() < last_step {
                break;
            }
        }
        (x, 2.0 / ((1.0 - x * x) * slope * slope))
    };
    (0..points).map(node).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rule_of_p_points_integrates_degree_2p_minus_1() {
        for points in [1, 2, 3, 7, 40] {
            let degree = 2 * points as i32 - 2;
            let sum: f64 = gauss(-1.0, 1.0, points).map(|(x, weight)| weight * x.powi(degree)).sum();
            assert!((sum - 2.0 / f64::from(degree + 1)).abs() < 1e-13, "{points}: {sum}");
        }
    }
}
