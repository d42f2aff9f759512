//! Rounds of paths until a target is met, for computations that trace all paths of a round again.
//!
//! The first round is a pilot: from its error follows the number of paths that the target needs. A further
//! round follows as long as the target is not met, or the results of the last two contradict each other
//! ([`Confidence`]).

use super::walk::Confidence;
use crate::DisplayError;
use crate::scene::Stop;

/// Number of independent replicates of each view; standard errors have one degree of freedom less.
pub const REPLICATES: u64 = 32;

/// Paths of the pilot, and the fewest of the second round.
pub(crate) const PILOT: u64 = 1 << 13;
const FEWEST: u64 = 1 << 15;

/// What a number of paths has found.
pub(crate) struct Round<T> {
    pub(crate) found: T,
    /// Error over that of the target; infinite if it is not defined.
    pub(crate) missed: f64,
    /// Some numbers and their standard errors, which a further round must confirm.
    pub(crate) means: Vec<(f64, f64)>,
}

/// Error over the target of a relative error; 0 for a number of paths.
///
/// # Errors
/// For a target of a metric, which belongs to colours.
pub(crate) fn missed(stop: &Stop, error: f64) -> Result<f64, DisplayError> {
    match stop {
        Stop::Paths(_) => Ok(0.0),
        Stop::RelativeError { target, .. } => Ok(error / target),
        Stop::Target(_) => Err(DisplayError::NoPlaces { what: "a target of a metric", key: "solver.target" }),
    }
}

/// Calls `round` with numbers of paths, at most `most`, until the stopping rule is met; returns what the last
/// one found, and its number.
///
/// # Errors
/// Those of `round`.
pub(crate) fn until<T>(
    stop: &Stop,
    most: u64,
    mut round: impl FnMut(u64) -> Result<Round<T>, DisplayError>,
) -> Result<(T, u64), DisplayError> {
    if let Stop::Paths(paths) = stop {
        return Ok((round(*paths)?.found, *paths));
    }
    let (mut confidence, mut paths) = (Confidence::of_two_rounds(), PILOT);
    loop {
        let Round { found, missed, means } = round(paths)?;
        confidence.add(means);
        let enough = missed <= 1.0 && confidence.holds(paths);
        // More paths do not make a number defined.
        if enough || !missed.is_finite() || paths >= most {
            return Ok((found, paths));
        }
        let wanted = (paths as f64 * missed * missed) as u64;
        let least = if paths == PILOT { FEWEST } else { 2 * paths };
        paths = wanted.clamp(least, most.max(least)).next_power_of_two();
    }
}

/// Estimates the number of paths for a tenth of a target's error: from the decrease of the error with the
/// number of paths, by least squares of the logarithms, and in the worst case. `missed`: number of paths and
/// ratio of error to tolerance after each round; `paths`: of the last one.
pub(super) fn paths_for_a_tenth(missed: &[(u64, f64)], paths: u64) -> [f64; 2] {
    let logs = missed.iter().filter(|(_, missed)| *missed > 0.0 && missed.is_finite());
    let logs: Vec<(f64, f64)> = logs.map(|(paths, missed)| ((*paths as f64).ln(), missed.ln())).collect();
    // The slope of few rounds is uncertain: it is limited to the range of possible methods.
    let power = slope(&logs).map_or(0.5, |(slope, _)| (-slope).clamp(0.5, 1.5));
    [10.0_f64.powf(1.0 / power), 100.0].map(|times| times * paths as f64)
}

/// Slope of the line through points by least squares, and the sum of the squares of x about their mean; `None`
/// unless there are two different x.
pub(super) fn slope(points: &[(f64, f64)]) -> Option<(f64, f64)> {
    let n = points.len().max(1) as f64;
    let (x, y) = (points.iter().map(|p| p.0).sum::<f64>() / n, points.iter().map(|p| p.1).sum::<f64>() / n);
    let xx: f64 = points.iter().map(|p| (p.0 - x).powi(2)).sum();
    let xy: f64 = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    (xx > 0.0).then(|| (xy / xx, xx))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Errors that fall as a power of the number of paths; without rounds, or with errors that do not fall,
    /// the worst case.
    #[test]
    fn paths_for_a_tenth_follow_the_decrease_of_the_error() {
        let of = |power: f64| -> Vec<(u64, f64)> {
            (10..16).map(|k| (1 << k, 3.0 * 2.0_f64.powf(-power * f64::from(k)))).collect()
        };
        for (power, times) in [(0.5, 100.0), (0.75, 21.544_347), (1.0, 10.0), (0.0, 100.0)] {
            let [likely, most] = paths_for_a_tenth(&of(power), 1 << 15);
            assert!((likely / f64::from(1 << 15) - times).abs() < 1e-5 && most == 100.0 * f64::from(1 << 15));
        }
        assert_eq!(paths_for_a_tenth(&[(1024, f64::INFINITY)], 1024), [102_400.0; 2]);
    }

    /// Rounds of a number whose error is 1/sqrt(paths), in units of one standard error from the truth.
    fn rounds(stop: &Stop, off: impl Fn(u64) -> f64) -> Vec<u64> {
        let mut all = Vec::new();
        let found = until(stop, 1 << 26, |paths| {
            all.push(paths);
            let error = 1.0 / (paths as f64).sqrt();
            let means = vec![(1.0 + off(paths) * error, error)];
            Ok(Round { found: paths, missed: missed(stop, error)?, means })
        });
        let (found, paths) = found.unwrap();
        assert_eq!((found, paths), (all[all.len() - 1], all[all.len() - 1]));
        all
    }

    #[test]
    fn second_round_has_the_paths_that_the_target_needs() {
        let target = |target| Stop::RelativeError { target, per_wavelength: false };
        assert_eq!(rounds(&target(1e-3), |_| 0.0), [1 << 13, 1 << 20]);
        assert_eq!(rounds(&target(0.1), |_| 0.0), [1 << 13, 1 << 15]);
        assert_eq!(rounds(&Stop::Paths(5000), |_| 0.0), [5000]);
        // No target is met with more paths than these.
        assert_eq!(rounds(&target(1e-9), |_| 0.0), [1 << 13, 1 << 26]);
    }

    #[test]
    fn rounds_that_contradict_each_other_are_followed_by_another() {
        let target = Stop::RelativeError { target: 0.1, per_wavelength: false };
        let off = |paths| if paths == 1 << 13 { 9.0 } else { 0.0 };
        assert_eq!(rounds(&target, off), [1 << 13, 1 << 15, 1 << 16]);
    }
}
