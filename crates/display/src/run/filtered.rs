//! Runs of displays with a colour filter at a height above their pixels.

use std::cell::Cell;

use papilio_transport::walk::places::Estimate as PlacedEstimate;

use super::adding::run_levels;
use super::{Progress, Run};
use crate::DisplayError;
use crate::filtered::{Filtered, by_reciprocity};
use crate::meter::Sample;
use crate::result::{RunResult, SolverReport};
use crate::scene::{Method, Stop};
use crate::spatial::walk::{Placed, REPLICATES};

/// Paths of the first round of a view, by which factor each further round has more, and the most.
const FIRST_PATHS: u64 = 1 << 13;
const MORE: u64 = 4;
const MOST_PATHS: u64 = 1 << 26;

/// Runs a scene with a filter.
pub(super) fn run(run: &Run<'_>) -> Result<RunResult, DisplayError> {
    if run.scene.solver.method == Method::MonteCarlo {
        return by_paths(run);
    }
    let Some(filtered) = Filtered::new(run.setup, run.control)? else {
        return Err(DisplayError::FilterWithoutPlace);
    };
    let (mut failure, nodes) = (None, Cell::new(0));
    let result = run_levels(
        run,
        filtered.finest(),
        |level| {
            samples(run, &filtered, level, &nodes).unwrap_or_else(|error| {
                // What is stopped has the levels before.
                failure = Some(error).filter(|error| !matches!(error, DisplayError::Interrupted));
                None
            })
        },
        || nodes.get(),
    );
    match failure {
        Some(error) => Err(error),
        None => result,
    }
}

/// Samples of all views at a level, whose number of nodes is stored; `None` if the run was stopped.
fn samples(
    run: &Run<'_>,
    filtered: &Filtered<'_>,
    level: usize,
    nodes: &Cell<u64>,
) -> Result<Option<Vec<Sample>>, DisplayError> {
    let setup = run.setup;
    let lit = filtered.lit(level, 1)?;
    nodes.set(lit.nodes());
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

/// Runs a scene by Monte Carlo with places.
fn by_paths(run: &Run<'_>) -> Result<RunResult, DisplayError> {
    let (setup, solver) = (run.setup, &run.scene.solver);
    let placed = Placed::new(setup)?;
    if run.has_images_of_pixels() {
        return Err(DisplayError::NoPlaces {
            what: "mirror images of lamps in pixels below a colour filter",
            key: "lighting.directed",
        });
    }
    let specular = run.specular();
    let (mut views, mut all_paths, mut reached) = (Vec::new(), 0, 0.0_f64);
    for view in &setup.views {
        let mut paths = if let Stop::Paths(paths) = solver.stop { paths } else { FIRST_PATHS };
        let samples = loop {
            let estimates = placed.filtered(view, paths, run.control)?;
            let of = |estimate: PlacedEstimate| {
                let mut rho = estimate.rho;
                rho.truncate(setup.sources.len());
                run.meter.sample(&by_reciprocity(rho))
            };
            let samples: Vec<Sample> = estimates.into_iter().map(of).collect();
            let (target, per_wavelength) = match &solver.stop {
                Stop::Paths(_) => (f64::INFINITY, false),
                Stop::RelativeError { target, per_wavelength } => (*target, *per_wavelength),
                Stop::Target(_) => {
                    return Err(DisplayError::NoPlaces {
                        what: "a target of a metric",
                        key: "solver.target",
                    });
                }
            };
            let error = run.meter.standard_error(&samples, per_wavelength);
            if error <= target || paths >= MOST_PATHS {
                reached = reached.max(error);
                break samples;
            }
            paths *= MORE;
        };
        if !samples.iter().all(Sample::is_finite) {
            return Err(DisplayError::NotFinite);
        }
        all_paths += paths;
        views.push(run.meter.view_of_replicates(view, &samples, 0.0, &specular));
        (run.control.progress)(Progress::of_views(views.len(), setup.views.len()));
    }
    let report = SolverReport {
        method: "monte-carlo".to_owned(),
        chosen_because: None,
        paths: Some(all_paths),
        nodes: None,
        degrees_of_freedom: REPLICATES - 1,
        relative_error_reached: reached,
        target: None,
        is_final: true,
        interrupted: false,
    };
    Ok(run.result(views, report, &specular, &format!("that would take more than {MOST_PATHS} paths")))
}
