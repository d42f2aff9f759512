//! `solver.relative_error` for results that depend on places: its value, and the warning where it is not met.

use crate::DisplayError;
use crate::run::{Control, Progress, Refined, refine_or_fail};
use crate::scene::{Method, Scene, Stop};
use crate::setup::Setup;

/// Target of a scene whose stopping rule has none.
const USUAL_TARGET: f64 = 0.001;

/// The target of a stopping rule, if it has one.
pub(super) fn target(stop: &Stop) -> Option<f64> {
    match stop {
        Stop::RelativeError { target, .. } => Some(*target),
        Stop::Paths(_) | Stop::Target(_) => None,
    }
}

/// Refines what is seen of a view until the target of the scene, or the finest level, is met; reports the error
/// of each level.
///
/// # Errors
/// Those of a level; [`DisplayError::Interrupted`] if it was stopped before.
pub(super) fn refined<T>(
    setup: &Setup,
    finest: usize,
    at: impl FnMut(usize) -> Result<T, DisplayError>,
    error: impl Fn([&T; 2]) -> f64,
    control: &Control<'_>,
) -> Result<Refined<T>, DisplayError> {
    let target = target(&setup.scene.solver.stop).unwrap_or(USUAL_TARGET);
    let report = |error, _| {
        (control.progress)(Progress::of_views(0, setup.views.len()).with_error(error, target));
    };
    let found = refine_or_fail(target, finest, 1.0, at, |levels, _| error(levels), report)?;
    if found.finished { Ok(found) } else { Err(DisplayError::Interrupted) }
}

/// A warning if the largest error of a result, `what`, is above the target of the scene.
pub(super) fn missed_target(scene: &Scene, error: f64, what: &str) -> Option<String> {
    let target = target(&scene.solver.stop)?;
    let (is_missed, remedy) = match scene.solver.method {
        // The number of paths is an estimate.
        Method::MonteCarlo => (error > 1.5 * target, "solver.paths sets the number of paths"),
        Method::Adding | Method::Auto => (
            error > target,
            "the finest level of adding is reached; solver.method = \"monte-carlo\" traces as many paths as the target needs",
        ),
    };
    is_missed.then(|| {
        format!("solver.relative_error = {target} is not met: the error of {what} is {error:.1e}; {remedy}")
    })
}
