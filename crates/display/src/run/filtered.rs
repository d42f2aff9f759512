//! Runs of displays with a colour filter at a height above their pixels.

use super::Run;
use super::adding::run_levels;
use crate::DisplayError;
use crate::filtered::Filtered;
use crate::meter::Sample;
use crate::result::RunResult;
use crate::scene::Method;

/// Runs a scene with a filter.
pub(super) fn run(run: &Run<'_>) -> Result<RunResult, DisplayError> {
    if run.scene.solver.method == Method::MonteCarlo {
        return Err(DisplayError::PlacesNotComputed {
            what: "a colour filter in the Monte Carlo solver".to_owned(),
            key: "solver.method".to_owned(),
        });
    }
    let Some(filtered) = Filtered::new(run.setup)? else { return Err(DisplayError::FilterWithoutPlace) };
    let mut failure = None;
    let result = run_levels(
        run,
        filtered.finest(),
        |level| {
            samples(run, &filtered, level).unwrap_or_else(|error| {
                failure = Some(error);
                None
            })
        },
        0,
    );
    match failure {
        Some(error) => Err(error),
        None => result,
    }
}

/// Samples of all views at a level; `None` if the run was stopped.
fn samples(
    run: &Run<'_>,
    filtered: &Filtered<'_>,
    level: usize,
) -> Result<Option<Vec<Sample>>, DisplayError> {
    let setup = run.setup;
    let lit = filtered.lit(level, 1)?;
    let mut irradiance = Vec::with_capacity(setup.sources.len());
    for source in 0..setup.sources.len() {
        if run.control.stopped() {
            return Ok(None);
        }
        let states = 0..setup.states.len();
        irradiance.push(states.map(|state| filtered.irradiance(&lit, source, &[state])).collect());
    }
    let mut all = Vec::with_capacity(setup.views.len());
    for (number, view) in setup.views.iter().enumerate() {
        let leaving = filtered.leaving(&lit, view, level)?;
        let estimate = filtered.estimate(&lit, (number, &leaving), &irradiance);
        all.push(run.meter.sample(&estimate));
    }
    Ok(Some(all))
}
