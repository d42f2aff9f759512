//! Gauss-Legendre rules.

use std::f64::consts::PI;
use std::sync::LazyLock;

/// Largest number of points.
const MOST_POINTS: usize = 40;

/// Nodes and weights on [-1, 1], by the number of points.
static RULES: LazyLock<Vec<Vec<(f64, f64)>>> = LazyLock::new(|| (0..=MOST_POINTS).map(rule).collect());

/// Returns nodes and weights of the rule of this many points, 1 to 40, on an interval.
pub(super) fn gauss(from: f64, to: f64, points: usize) -> impl Iterator<Item = (f64, f64)> {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    RULES[points.clamp(1, MOST_POINTS)].iter().map(move |(x, weight)| (middle + half * x, half * weight))
}

/// Computes a rule by Newton's method from Tricomi's first approximation.
fn rule(points: usize) -> Vec<(f64, f64)> {
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
            x -= value / slope;
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
