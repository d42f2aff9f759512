//! Rounds of paths until a target is met: the one loop of all computations by Monte Carlo.
//!
//! A round has numbers with standard errors and the ratio of its error to the target. A further round follows
//! as long as the target is not met, or the standard errors are not reliable ([`Confidence`]). A computation
//! either adds paths to those of the rounds before, or traces all paths of a round again ([`until`]): the
//! first round is then a pilot, from whose error follows the number of paths that the target needs.

use papilio_transport::walk::Walk;

use crate::DisplayError;
use crate::scene::Stop;

/// Number of independent replicates of each view; standard errors have one degree of freedom less.
pub const REPLICATES: u64 = 32;

/// Paths of the pilot, and the fewest of the second round.
pub(crate) const PILOT: u64 = 1 << 13;
const FEWEST: u64 = 1 << 15;

/// Number of paths from the begin of a round of [`until`] on, if each of its paths is traced in several `passes`; `None` for the pilot
/// of a target, from which the number follows. A pilot of [`Stop::Paths`] has one pass.
pub(crate) fn paths_from_round(stop: &Stop, paths: u64, passes: u64) -> Option<u64> {
    match stop {
        Stop::Paths(wanted) if paths != *wanted => Some(paths + passes * wanted),
        Stop::RelativeError { .. } | Stop::Target(_) if paths == PILOT => None,
        _ => Some(passes * paths),
    }
}

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

/// A computation in rounds.
pub(super) trait Rounds {
    /// What a round finds.
    type Found;

    /// Number of all paths after the next round; `missed` is the error over the target after `paths` of them.
    fn next(&self, paths: u64, missed: f64) -> u64;

    /// Computes what this number of all paths finds.
    fn round(&mut self, paths: u64) -> Result<Round<Self::Found>, DisplayError>;

    /// Reports a round, and whether it was the last.
    fn report(&self, _is_last: bool) {}
}

/// Computes rounds of at most `most` paths until the stopping rule is met; returns what the last one found, and
/// its number of paths.
///
/// # Errors
/// Those of the rounds.
pub(super) fn meet<R: Rounds>(
    stop: &Stop,
    most: u64,
    mut confidence: Confidence,
    rounds: &mut R,
) -> Result<(R::Found, u64), DisplayError> {
    let (mut paths, mut last) = (0, f64::INFINITY);
    loop {
        paths = rounds.next(paths, last);
        let Round { found, missed, means } = rounds.round(paths)?;
        confidence.add(means);
        let is_last = match stop {
            Stop::Paths(wanted) => paths >= *wanted,
            // More paths do not make a number defined.
            _ => (missed <= 1.0 && confidence.holds(paths)) || !missed.is_finite() || paths >= most,
        };
        rounds.report(is_last);
        if is_last {
            return Ok((found, paths));
        }
        last = missed;
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
    round: impl FnMut(u64) -> Result<Round<T>, DisplayError>,
) -> Result<(T, u64), DisplayError> {
    let confidence = Confidence::new(0, true);
    meet(stop, most, confidence, &mut Again { stop, most, round })
}

/// Rounds that trace all paths again.
struct Again<'a, F> {
    stop: &'a Stop,
    most: u64,
    round: F,
}

impl<T, F: FnMut(u64) -> Result<Round<T>, DisplayError>> Rounds for Again<'_, F> {
    type Found = T;

    fn next(&self, paths: u64, missed: f64) -> u64 {
        let least = match (self.stop, paths) {
            (Stop::Paths(wanted), _) => return *wanted,
            (_, 0) => return PILOT,
            (_, PILOT) => FEWEST,
            (_, paths) => 2 * paths,
        };
        let wanted = (paths as f64 * missed * missed) as u64;
        wanted.clamp(least, self.most.max(least)).next_power_of_two()
    }

    fn round(&mut self, paths: u64) -> Result<Round<T>, DisplayError> {
        (self.round)(paths)
    }
}

/// A change of Y by more than this many standard errors in a round contradicts the standard error.
const UNEXPECTED: f64 = 4.0;

/// Check of whether the spread of a view's replicates is a reliable standard error.
///
/// All replicates may miss light that few paths meet; their spread then does not include it. A view therefore
/// needs a number of paths that is given by the least probable event of the solver, and a further round must
/// confirm the result of an earlier one within its errors.
pub(super) struct Confidence {
    /// Smallest number of paths.
    least: u64,
    /// False if the estimate has no noise.
    is_random: bool,
    /// Y of each state after the last round, and its standard error.
    before: Vec<(f64, f64)>,
    confirmed: bool,
}

impl Confidence {
    fn new(least: u64, is_random: bool) -> Self {
        Self { least, is_random, before: Vec::new(), confirmed: false }
    }

    /// Confidence in rounds of a walk, of which at least `least` paths are needed.
    pub(super) fn in_walk(walk: &Walk<'_>, least: u64) -> Self {
        Self::new(least, walk.rarest() < 1.0)
    }

    /// Adds the Y of each state after a round, with their standard errors.
    pub(super) fn add(&mut self, now: Vec<(f64, f64)>) {
        let expected = |((now, _), (before, error)): (&(f64, f64), &(f64, f64))| {
            (now - before).abs() <= UNEXPECTED * error + 1e-12 * before.abs()
        };
        self.confirmed = !self.before.is_empty() && now.iter().zip(&self.before).all(expected);
        self.before = now;
    }

    /// Returns true if this number of paths, and their results, suffice to stop.
    pub(super) fn holds(&self, paths: u64) -> bool {
        paths >= self.least && (self.confirmed || !self.is_random)
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

    /// A pilot is no part of the work whose end is known: it is small, however many paths its target needs.
    #[test]
    fn paths_from_the_pilot_of_a_target_on_are_unknown() {
        let target = Stop::RelativeError { target: 1e-3, per_wavelength: false };
        assert_eq!([PILOT, 1 << 20].map(|paths| paths_from_round(&target, paths, 4)), [None, Some(4 << 20)]);
        let paths = |paths| paths_from_round(&Stop::Paths(1 << 20), paths, 4);
        assert_eq!([PILOT, 1 << 20].map(paths), [Some(PILOT + (4 << 20)), Some(4 << 20)]);
    }

    #[test]
    fn rounds_that_contradict_each_other_are_followed_by_another() {
        let target = Stop::RelativeError { target: 0.1, per_wavelength: false };
        let off = |paths| if paths == 1 << 13 { 9.0 } else { 0.0 };
        assert_eq!(rounds(&target, off), [1 << 13, 1 << 15, 1 << 16]);
    }
}
