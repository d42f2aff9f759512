//! Intervals by the profile likelihood: a variable is held while all others minimise chi-square again.

use super::levenberg_marquardt::{Minimum, descend, dot};
use super::matrix::solve;
use super::problem::Problem;
use crate::DesignError;

/// Relative accuracy of the distance of an end from the value.
const ACCURACY: f64 = 0.005;
/// Most minimisations for an end.
const MOST: usize = 12;

/// End of an interval, in the unit cube.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum End {
    /// Found; a bound if chi-square does not grow enough before it.
    At(f64),
    /// Chi-square is smaller here than at the minimum.
    Better(Vec<f64>),
}

/// Finds the value of a coordinate above (`side` 1) or below (-1) that of the minimum where the smallest
/// chi-square exceeds that of the minimum by `distance` squared. `deviation` is the standard error.
pub(super) fn end(
    problem: &mut Problem<'_, '_>,
    best: &Minimum,
    (variable, side): (usize, f64),
    (distance, deviation): (f64, f64),
) -> Result<End, DesignError> {
    let at_best = best.point[variable];
    let room = if side > 0.0 { 1.0 - at_best } else { at_best };
    // Lengths of the step and roots of the increase of chi-square: below and above the end.
    let (mut below, mut above): ((f64, f64), Option<(f64, f64)>) = ((0.0, 0.0), None);
    let mut length = (distance * deviation).min(room);
    let mut warm = best.clone();
    for _ in 0..MOST {
        if length <= 0.0 {
            break;
        }
        let Some(found) = constrained(problem, (best, &warm), variable, at_best + side * length)? else {
            above = Some((length, f64::INFINITY));
            length = 0.5 * (below.0 + length);
            continue;
        };
        let increase = found.chi_square - best.chi_square;
        if increase < -0.01 {
            return Ok(End::Better(found.point));
        }
        let root = increase.max(0.0).sqrt();
        warm = found;
        if (root - distance).abs() <= ACCURACY * distance {
            break;
        }
        if root < distance {
            if length >= room {
                return Ok(End::At(at_best + side * room));
            }
            below = (length, root);
        } else {
            above = Some((length, root));
        }
        length = next(below, above, distance, room);
        if above.is_some_and(|(above, _)| above - below.0 < 1e-9) {
            break;
        }
    }
    Ok(End::At((at_best + side * length.min(room)).clamp(0.0, 1.0)))
}

/// Next length: the root of the increase is almost proportional to the length.
fn next(below: (f64, f64), above: Option<(f64, f64)>, distance: f64, room: f64) -> f64 {
    match above {
        Some((length, root)) if root.is_finite() => {
            let by_line = below.0 + (length - below.0) * (distance - below.1) / (root - below.1);
            let inside = 0.05 * (length - below.0);
            by_line.clamp(below.0 + inside, length - inside)
        }
        Some((length, _)) => 0.5 * (below.0 + length),
        None if below.1 > 0.0 => (below.0 * (distance / below.1).min(4.0)).max(1.01 * below.0).min(room),
        None => (2.0 * below.0).min(room),
    }
}

/// Minimum with one coordinate held at `u`, from the step that the Jacobian of the minimum predicts.
fn constrained(
    problem: &mut Problem<'_, '_>,
    (best, warm): (&Minimum, &Minimum),
    variable: usize,
    u: f64,
) -> Result<Option<Minimum>, DesignError> {
    let n = best.point.len();
    let others: Vec<usize> =
        (0..n).filter(|k| *k != variable && best.jacobian[*k].iter().any(|one| *one != 0.0)).collect();
    let by = u - warm.point[variable];
    let pairs = others.iter().flat_map(|i| others.iter().map(move |k| (*i, *k)));
    let mut matrix: Vec<f64> = pairs.map(|(i, k)| dot(&warm.jacobian[i], &warm.jacobian[k])).collect();
    let count = others.len();
    (0..count).for_each(|i| matrix[i * count + i] *= 1.0 + 1e-9);
    let slopes: Vec<f64> =
        others.iter().map(|i| -by * dot(&warm.jacobian[*i], &warm.jacobian[variable])).collect();
    let mut start = warm.point.clone();
    start[variable] = u;
    if let Some(step) = solve(&matrix, &slopes) {
        others.iter().zip(step).for_each(|(k, step)| start[*k] = (start[*k] + step).clamp(0.0, 1.0));
    }
    let held: Vec<bool> = (0..n).map(|k| k == variable).collect();
    descend(problem, &start, &held, Some(warm.jacobian.clone()))
}
