//! The points of a sweep, side by side: what is known is taken, what is new is kept at once.

use std::collections::{BTreeMap, HashSet};

use papilio_design::DesignError;
use papilio_display::{Control, DisplayError, Prepared};
use papilio_formats::{SweepHead, SweepPoint, sweep_value};
use papilio_scenario::Sweep;

use super::journal::Journal;
use crate::side_by_side::side_by_side;
use crate::{Failure, interrupt};

/// A point that is done.
pub(super) struct Done {
    pub(super) hash: String,
    /// Now, not earlier.
    pub(super) computed: bool,
}

/// What a worker found at a point; without a result if that is known.
type Found = (usize, String, Option<SweepPoint>);

/// Computes what is not known yet, and keeps it; ends early if interrupted. The points that are done, by number.
pub(super) fn compute(
    sweep: &Sweep,
    head: &SweepHead,
    points: &[usize],
    journal: &mut Journal,
    threads: Option<u16>,
) -> Result<BTreeMap<usize, Done>, Failure> {
    let known = journal.hashes();
    let mut done = BTreeMap::new();
    let worker = |threads: usize| {
        let (known, mut prepared) = (&known, None);
        move |point: usize| at(sweep, head, point, known, threads, &mut prepared)
    };
    side_by_side(points, "points", threads, worker, |found| keep(found, sweep, journal, &mut done))?;
    Ok(done)
}

/// Computes a point unless it is known, from what is left of the worker's last one; `None` if interrupted.
fn at(
    sweep: &Sweep,
    head: &SweepHead,
    point: usize,
    known: &HashSet<String>,
    threads: usize,
    prepared: &mut Option<Prepared>,
) -> Result<Option<Found>, Failure> {
    let resolved = sweep.scenario(point).and_then(|scenario| scenario.resolve());
    let resolved = resolved.map_err(|errors| failed_at(head, point, errors))?;
    if known.contains(&resolved.hash) {
        return Ok(Some((point, resolved.hash, None)));
    }
    let control = Control { threads: Some(threads), progress: &|_| {}, stop: &interrupt::STOP };
    let result = match prepared {
        Some(prepared) => prepared.run(&resolved.scene, &control),
        None => {
            Prepared::new(&resolved.scene).and_then(|new| prepared.insert(new).run(&resolved.scene, &control))
        }
    };
    match result {
        Ok(result) if result.solver.interrupted => Ok(None),
        Ok(mut result) => {
            result.warnings.splice(0..0, resolved.warnings);
            let kept = SweepPoint::new(point, resolved.hash.clone(), env!("CARGO_PKG_VERSION"), &result);
            Ok(Some((point, resolved.hash, Some(kept))))
        }
        Err(DisplayError::Interrupted) => Ok(None),
        Err(error) => Err(failed_at(head, point, error)),
    }
}

/// What is wrong at a point, and which point that is.
pub(super) fn failed_at(head: &SweepHead, point: usize, error: impl Into<DesignError>) -> Failure {
    let swept = head.swept(point).map(|(key, value)| format!("{key} = {}", sweep_value(value)));
    Failure::of_one(error, &format!("at {}", swept.collect::<Vec<_>>().join(", ")))
}

/// Keeps what was found; whether it was computed now. The first point also tells whether there is what is to be drawn.
fn keep(
    (point, hash, result): Found,
    sweep: &Sweep,
    journal: &mut Journal,
    done: &mut BTreeMap<usize, Done>,
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
    done.insert(point, Done { hash, computed });
    Ok(computed)
}
