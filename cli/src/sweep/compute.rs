//! Parallel computation of the points of a sweep. Known points are reused; new ones are saved immediately.

use std::collections::{BTreeMap, HashSet};

use papilio_design::DesignError;
use papilio_display::{Control, DisplayError, Prepared};
use papilio_formats::{SweepHead, SweepPoint, sweep_value};
use papilio_scenario::Sweep;

use super::journal::Journal;
use crate::parallel::compute_parallel;
use crate::{Failure, interrupt};

/// A finished point.
pub(super) struct FinishedPoint {
    pub(super) hash: String,
    /// True if it was computed now, false if it was known.
    pub(super) computed: bool,
}

/// Number and hash of a point, and its result unless that is known.
type PointResult = (usize, String, Option<SweepPoint>);

/// Computes the missing points and saves them. Returns the finished points by number; ends early if
/// interrupted.
pub(super) fn compute(
    sweep: &Sweep,
    head: &SweepHead,
    points: &[usize],
    journal: &mut Journal,
    threads: Option<u16>,
) -> Result<BTreeMap<usize, FinishedPoint>, Failure> {
    let known = journal.hashes();
    let mut done = BTreeMap::new();
    let worker = |threads: usize| {
        let (known, mut prepared) = (&known, None);
        move |point: usize| compute_point(sweep, head, point, known, threads, &mut prepared)
    };
    compute_parallel(points, "points", threads, worker, |result| store(result, sweep, journal, &mut done))?;
    Ok(done)
}

/// Computes a point unless it is known; `None` if interrupted. `prepared` is the display of the worker's
/// previous point.
fn compute_point(
    sweep: &Sweep,
    head: &SweepHead,
    point: usize,
    known: &HashSet<String>,
    threads: usize,
    prepared: &mut Option<Prepared>,
) -> Result<Option<PointResult>, Failure> {
    let resolved = sweep.scenario(point).and_then(|scenario| scenario.resolve());
    let resolved = resolved.map_err(|errors| failed_at(head, point, errors))?;
    if known.contains(&resolved.hash) {
        return Ok(Some((point, resolved.hash, None)));
    }
    let control = Control { threads: Some(threads), progress: &|_| {}, stop: &interrupt::STOP };
    let result = match prepared {
        Some(prepared) => prepared.run(&resolved.scene, &control),
        None => Prepared::new(&resolved.scene, &control)
            .and_then(|new| prepared.insert(new).run(&resolved.scene, &control)),
    };
    match result {
        Ok(result) if result.solver.interrupted => Ok(None),
        Ok(mut result) => {
            result.warnings.splice(0..0, resolved.warnings);
            let computed = SweepPoint::new(point, resolved.hash.clone(), env!("CARGO_PKG_VERSION"), &result);
            Ok(Some((point, resolved.hash, Some(computed))))
        }
        Err(DisplayError::Interrupted) => Ok(None),
        Err(error) => Err(match resolved.located(&error) {
            Some(errors) => failed_at(head, point, errors),
            None => failed_at(head, point, error),
        }),
    }
}

/// Error at a point, with the swept values of the point.
pub(super) fn failed_at(head: &SweepHead, point: usize, error: impl Into<DesignError>) -> Failure {
    let swept = head.swept(point).map(|(key, value)| format!("{key} = {}", sweep_value(value)));
    Failure::of_one(error, &format!("at {}", swept.collect::<Vec<_>>().join(", ")))
}

/// Saves a result; returns whether it was computed now. The first point also shows whether the requested
/// figures exist.
fn store(
    (point, hash, result): PointResult,
    sweep: &Sweep,
    journal: &mut Journal,
    done: &mut BTreeMap<usize, FinishedPoint>,
) -> Result<bool, Failure> {
    let computed = result.is_some();
    if let Some(result) = result {
        journal.add(result)?;
    }
    if done.is_empty()
        && let Some(first) = journal.find(&hash)
    {
        sweep.check_figures(&first.metrics())?;
    }
    done.insert(point, FinishedPoint { hash, computed });
    Ok(computed)
}
