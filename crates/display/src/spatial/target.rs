//! `solver.relative_error` for results that depend on places: its value, and the warning where it is not met.

use crate::scene::{Method, Scene, Stop};

/// Target of a scene whose stopping rule has none.
pub(super) const USUAL_TARGET: f64 = 0.001;

/// The target of a stopping rule, if it has one.
pub(super) fn target(stop: &Stop) -> Option<f64> {
    match stop {
        Stop::RelativeError { target, .. } => Some(*target),
        Stop::Paths(_) | Stop::Target(_) => None,
    }
}

/// A warning if the largest error of a result, `what`, is above the target of the scene.
pub(super) fn missed_target(scene: &Scene, error: f64, what: &str) -> Option<String> {
    let target = target(&scene.solver.stop)?;
    let (is_missed, remedy) = match scene.solver.method {
        // The number of paths is an estimate.
        Method::MonteCarlo => (error > 1.5 * target, "solver.paths sets the number of paths"),
        Method::Adding | Method::Auto => (
            error > target,
            "the finest level of adding is reached; `--solver monte-carlo` traces as many paths as the target needs",
        ),
    };
    is_missed.then(|| {
        format!("solver.relative_error = {target} is not met: the error of {what} is {error:.1e}; {remedy}")
    })
}
