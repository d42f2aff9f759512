//! Least squares of linear residuals within bounds, by an active set.

use super::levenberg_marquardt::dot;
use super::matrix::solve;

/// Step `s` of the coordinates that minimises `|residuals + J s|^2 + damping * sum_k |J_k|^2 s_k^2` while `point + s` stays in the
/// unit cube; those of `held` do not move. The sum without damping never grows. `None` if the equations cannot be solved.
pub(super) fn step(
    jacobian: &[Vec<f64>],
    residuals: &[f64],
    point: &[f64],
    held: &[bool],
    damping: f64,
) -> Option<Vec<f64>> {
    let n = point.len();
    let moves = |k: usize| !held[k] && jacobian[k].iter().any(|one| *one != 0.0);
    let mut matrix: Vec<f64> =
        jacobian.iter().flat_map(|a| jacobian.iter().map(move |b| dot(a, b))).collect();
    (0..n).for_each(|k| matrix[k * n + k] *= 1.0 + damping);
    let slopes: Vec<f64> = jacobian.iter().map(|column| dot(column, residuals)).collect();
    let slope = |step: &[f64], k: usize| slopes[k] + dot(&matrix[k * n..(k + 1) * n], step);
    let mut step = vec![0.0; n];
    let mut free: Vec<usize> =
        (0..n).filter(|k| moves(*k)).filter(|k| !leaves(point[*k], slopes[*k])).collect();
    // Every pass lowers the sum, so that no set of free coordinates comes twice.
    for _ in 0..20 + 10 * n {
        let of_free = free
            .iter()
            .flat_map(|&i| free.iter().map(move |k| (i, *k)))
            .map(|(i, k)| matrix[i * n + k])
            .collect::<Vec<f64>>();
        let down: Vec<f64> = free.iter().map(|k| -slope(&step, *k)).collect();
        let further = solve(&of_free, &down)?;
        // The part of the way until the first bound.
        let (mut part, mut hit) = (1.0, None);
        for (at, (&k, by)) in free.iter().zip(&further).enumerate() {
            let now = point[k] + step[k];
            let bound = if *by > 0.0 { 1.0 } else { 0.0 };
            if *by != 0.0 && (bound - now) / by < part {
                (part, hit) = (((bound - now) / by).max(0.0), Some((at, bound)));
            }
        }
        free.iter().zip(&further).for_each(|(k, by)| step[*k] += part * by);
        if let Some((at, bound)) = hit {
            let k = free.remove(at);
            step[k] = bound - point[k];
            continue;
        }
        // At the minimum of the free ones: a coordinate at its bound that wants to come back.
        let back = (0..n)
            .filter(|k| moves(*k) && !free.contains(k))
            .map(|k| (k, slope(&step, k)))
            .filter(|(k, slope)| !leaves(point[*k] + step[*k], *slope))
            .map(|(k, slope)| (k, slope.abs() / matrix[k * n + k].sqrt()))
            .filter(|(_, slope)| *slope > 1e-9)
            .max_by(|a, b| a.1.total_cmp(&b.1));
        match back {
            Some((k, _)) => free.push(k),
            None => break,
        }
    }
    Some(step)
}

/// Whether a coordinate at a bound would leave it along a slope of the sum.
fn leaves(u: f64, slope: f64) -> bool {
    u <= 0.0 && slope > 0.0 || u >= 1.0 && slope < 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against the best point of a fine grid: two correlated coordinates, of which the free minimum has one beyond its bound.
    #[test]
    fn step_to_a_bound_moves_the_others_to_their_minimum_there() {
        let jacobian = [vec![3.0, 1.0, 0.5], vec![2.8, 1.3, 0.2]];
        let sum = |residuals: &[f64], step: &[f64]| -> f64 {
            (0..3).map(|i| (residuals[i] + jacobian[0][i] * step[0] + jacobian[1][i] * step[1]).powi(2)).sum()
        };
        for residuals in [[1.0, -2.0, 0.3], [-1.0, 2.0, -0.3], [0.2, 0.1, -2.0], [-0.4, 0.9, 1.5]] {
            for point in [[0.1, 0.6], [0.0, 0.5], [1.0, 0.0]] {
                let found = step(&jacobian, &residuals, &point, &[false; 2], 1e-12).unwrap();
                let to = |k: usize, i: usize| i as f64 / 500.0 - point[k];
                let best = (0..=500)
                    .flat_map(|i| (0..=500).map(move |k| [to(0, i), to(1, k)]))
                    .map(|step| sum(&residuals, &step))
                    .fold(f64::INFINITY, f64::min);
                let ours = sum(&residuals, &found);
                assert!(ours <= best + 1e-9 && ours > best - 1e-3, "{residuals:?} {point:?}: {ours} {best}");
                assert!((0..2).all(|k| (0.0..=1.0).contains(&(point[k] + found[k]))), "{found:?}");
            }
        }
    }
}
