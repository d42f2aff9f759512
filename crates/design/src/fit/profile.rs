//! Intervals by the profile likelihood: a variable is held while all others minimise chi-square again.

use super::bounded::step;
use super::levenberg_marquardt::{Minimum, descend, dot};
use super::problem::Problem;
use crate::DesignError;

/// Relative accuracy of the distance of an end from the value.
const ACCURACY: f64 = 0.005;
/// Most minimisations for an end.
const MOST: usize = 24;
/// Minimisations after which every second one is in the middle: the root of the increase has a kink where another coordinate
/// reaches its bound.
const KINK: usize = 4;
/// Increase of chi-square relative to the predicted one above which it is confirmed.
const UNPREDICTED: f64 = 1.05;

/// Distance from a bound that counts as being there, in widths of the bounds.
const AT_BOUND: f64 = 1e-6;

/// Whether a coordinate is at a bound.
pub(super) fn is_at_bound(u: f64) -> bool {
    u <= AT_BOUND || u >= 1.0 - AT_BOUND
}

/// End of an interval, in the unit cube.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum End {
    /// Found, a bound if chi-square does not grow enough before it; with the coordinates that are at their bounds there.
    At(f64, Vec<usize>),
    /// Chi-square is smaller here than at the minimum.
    Better(Vec<f64>),
}

/// Finds the values of a coordinate above (`side` 1) or below (-1) that of the minimum where the smallest
/// chi-square exceeds that of the minimum by the squares of `distances`, the smaller first. `deviation` is the standard
/// error. The search of the second end begins at the first. With `is_last`, no better minimum is sought.
pub(super) fn ends(
    problem: &mut Problem<'_, '_>,
    best: &Minimum,
    (variable, side): (usize, f64),
    (distances, deviation, is_last): ([f64; 2], f64, bool),
) -> Result<[End; 2], DesignError> {
    let mut warm = best.clone();
    let mut from = (0.0, 0.0);
    let mut ends = [0, 1].map(|_| End::At(best.point[variable], Vec::new()));
    for (end, distance) in ends.iter_mut().zip(distances) {
        let search = (&mut from, distance, deviation, is_last);
        *end = next_end(problem, (best, &mut warm), (variable, side), search)?;
    }
    Ok(ends)
}

/// The next end beyond `from`, a length and a root of the increase of chi-square, which becomes that of the end.
fn next_end(
    problem: &mut Problem<'_, '_>,
    (best, warm): (&Minimum, &mut Minimum),
    (variable, side): (usize, f64),
    (from, distance, deviation, is_last): (&mut (f64, f64), f64, f64, bool),
) -> Result<End, DesignError> {
    let at_best = best.point[variable];
    let room = if side > 0.0 { 1.0 - at_best } else { at_best };
    // Lengths of the step and roots of the increase of chi-square: below and above the end.
    let (mut below, mut above): ((f64, f64), Option<(f64, f64)>) = (*from, None);
    let mut length = match from.1 > 0.0 {
        true => next(below, above, distance, room),
        false => (distance * deviation).max(from.0).min(room),
    };
    // Coordinates that are at their bounds below and above the end.
    let mut at_bounds = [Vec::new(), Vec::new()];
    for number in 0..MOST {
        if length <= 0.0 {
            break;
        }
        let Some(found) = constrained(problem, (best, warm), variable, at_best + side * length)? else {
            above = Some((length, f64::INFINITY));
            length = 0.5 * (below.0 + length);
            continue;
        };
        let increase = found.chi_square - best.chi_square;
        if increase < -0.01 && !is_last {
            return Ok(End::Better(found.point));
        }
        let root = increase.max(0.0).sqrt();
        at_bounds[usize::from(root >= distance)] =
            (0..best.point.len()).filter(|k| is_at_bound(found.point[*k])).collect();
        *warm = found;
        if (root - distance).abs() <= ACCURACY * distance {
            below = (length, root);
            break;
        }
        if root < distance {
            below = (length, root);
            if length >= room {
                break;
            }
        } else {
            above = Some((length, root));
        }
        length = next(below, above, distance, room);
        if let Some((above, _)) = above {
            if number >= KINK && number % 2 == 0 {
                length = 0.5 * (below.0 + above);
            }
            if above - below.0 < 0.5 * ACCURACY * above {
                break;
            }
        }
    }
    let length = length.max(from.0).min(room);
    *from = (length, below.1);
    let is_cut = |k: &usize| match *k == variable {
        true => length >= room && below.1 < (1.0 - ACCURACY) * distance,
        false => at_bounds.iter().any(|all| all.contains(k)),
    };
    let cut_by = (0..best.point.len()).filter(is_cut).collect();
    Ok(End::At((at_best + side * length).clamp(0.0, 1.0), cut_by))
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

/// Minimum with one coordinate held at `u`, from the step within the bounds that the last Jacobian predicts. A minimum that
/// this Jacobian does not predict, or with a coordinate at a bound, is confirmed with derivatives of its own.
fn constrained(
    problem: &mut Problem<'_, '_>,
    (best, warm): (&Minimum, &Minimum),
    variable: usize,
    u: f64,
) -> Result<Option<Minimum>, DesignError> {
    let n = best.point.len();
    let held: Vec<bool> = (0..n).map(|k| k == variable).collect();
    let mut moved = vec![0.0; n];
    moved[variable] = u - warm.point[variable];
    let mut start = warm.point.clone();
    start[variable] = u;
    let residuals = warm.moved(&moved);
    if let Some(others) = step(&warm.jacobian, &residuals, &start, &held, 1e-9) {
        for k in (0..n).filter(|k| *k != variable) {
            moved[k] = others[k];
            start[k] = (start[k] + others[k]).clamp(0.0, 1.0);
        }
    }
    let predicted = warm.moved(&moved);
    let predicted = (dot(&predicted, &predicted) - best.chi_square).max(0.0);
    let Some(found) = descend(problem, &start, &held, Some(warm.jacobian.clone()))? else { return Ok(None) };
    let is_predicted = found.chi_square - best.chi_square <= UNPREDICTED * predicted + 0.01;
    let is_inside = (0..n).all(|k| k == variable || (found.point[k] > 0.0 && found.point[k] < 1.0));
    if found.has_converged && is_predicted && is_inside {
        return Ok(Some(found));
    }
    let confirmed = descend(problem, &found.point, &held, None)?;
    Ok(Some(confirmed.filter(|one| one.chi_square <= found.chi_square).unwrap_or(found)))
}
