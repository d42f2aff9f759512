//! Runs of displays with a colour filter at a height above their pixels.

use std::cell::Cell;

use papilio_transport::walk::places::Estimate as PlacedEstimate;

use super::adding::run_levels;
use super::rounds::paths_for_a_tenth;
use super::{Control, REPLICATES, Round, Run, each_view, missed, paths_from_round, until};
use crate::DisplayError;
use crate::filtered::{Filtered, by_reciprocity};
use crate::meter::{LeastErrors, Sample, SampleOfSums};
use crate::result::{RunResult, SolverReport, TargetReport};
use crate::scene::{Method, Stop};
use crate::spatial::walk::Placed;

/// Most paths of a view.
const MOST_PATHS: u64 = 1 << 26;

/// Runs a scene with a filter; `auto` is by paths where adding does not compute it.
pub(super) fn run(run: &Run<'_>, run_by_paths: &Run<'_>) -> Result<RunResult, DisplayError> {
    let method = run.scene.solver.method;
    let counts_paths = !matches!(run.scene.solver.stop, Stop::RelativeError { .. });
    if method == Method::MonteCarlo || method == Method::Auto && counts_paths {
        return by_paths(run_by_paths);
    }
    let filtered = match Filtered::new(run.setup, run.control) {
        Err(DisplayError::PlacesByPaths { what, .. }) if method == Method::Auto => {
            let mut result = by_paths(run_by_paths)?;
            let reason = format!("only the Monte Carlo solver computes {what}");
            result.notes.push(format!("`auto` has chosen {}: {reason}", result.solver.method));
            result.solver.chosen_because = Some(reason);
            return Ok(result);
        }
        found => found?.ok_or(DisplayError::FilterWithoutPlace)?,
    };
    let nodes = Cell::new(0);
    run_levels(run, filtered.finest(), |level| samples(run, &filtered, level, &nodes), || nodes.get())
}

/// Samples of all views at a level, whose number of nodes is stored.
fn samples(
    run: &Run<'_>,
    filtered: &Filtered<'_>,
    level: usize,
    nodes: &Cell<u64>,
) -> Result<Vec<SampleOfSums>, DisplayError> {
    let period = filtered.period(level, 1)?;
    nodes.set(period.nodes());
    let views = 0..run.setup.views.len();
    let of_view = |view: usize| {
        let sums = filtered.sums().into_iter();
        let sums = sums.map(|sum| Ok(run.meter.sample(&filtered.estimate((&period, sum), view)?)));
        Ok(SampleOfSums::new(sums.collect::<Result<_, DisplayError>>()?))
    };
    views.map(of_view).collect()
}

/// Runs a scene by Monte Carlo with places.
fn by_paths(run: &Run<'_>) -> Result<RunResult, DisplayError> {
    let (setup, solver) = (run.setup, run.solver);
    let placed = Placed::new(setup)?;
    if run.misses_images_of_pixels() {
        return Err(DisplayError::NoPlaces {
            what: "mirror images of lamps in pixels below a colour filter and general layers",
            key: "lighting.directed",
        });
    }
    let specular = run.specular();
    let per_wavelength = matches!(solver.stop, Stop::RelativeError { per_wavelength: true, .. });
    let of_view = |number: usize, control: &Control<'_>| {
        let (view, mut rounds) = (&setup.views[number], Vec::new());
        let before = placed.traced();
        let seen = |samples: &[Sample], paths: u64| {
            let least = LeastErrors { paths, ..LeastErrors::default() };
            run.meter.view_of_replicates(view, samples, least, &specular)
        };
        let ((samples, error, missed), paths) = until(&solver.stop, MOST_PATHS, |paths| {
            let of = |estimate: PlacedEstimate| {
                let mut rho = estimate.rho;
                rho.truncate(setup.sources.len());
                run.meter.sample(&by_reciprocity(rho))
            };
            let left = paths_from_round(&solver.stop, paths, 1);
            let estimates =
                placed.with_share(before, left, control, |control| placed.filtered(view, paths, control))?;
            let samples: Vec<Sample> = estimates.into_iter().map(of).collect();
            let error = run.meter.standard_error(&samples, per_wavelength);
            let missed = match &solver.stop {
                Stop::Target(target) => {
                    target.missed_by(&seen(&samples, paths).view).unwrap_or(f64::INFINITY)
                }
                stop => missed(stop, error)?,
            };
            rounds.push((paths, missed));
            let means = run.meter.luminous_means(&samples);
            Ok(Round { found: (samples, error, missed), missed, means })
        })?;
        if !samples.iter().all(Sample::is_finite) {
            return Err(DisplayError::NotFinite);
        }
        Ok((seen(&samples, paths), paths, error, missed, paths_for_a_tenth(&rounds, paths)))
    };
    let (mut views, mut all_paths, mut reached, mut over) = (Vec::new(), 0, 0.0_f64, 0.0_f64);
    let mut for_a_tenth = [0.0; 2];
    for (view, paths, error, missed, more) in each_view(setup, true, run.control, of_view)? {
        (all_paths, reached, over) = (all_paths + paths, reached.max(error), over.max(missed));
        for_a_tenth.iter_mut().zip(more).for_each(|(sum, more)| *sum += more);
        views.push(view);
    }
    let target = matches!(solver.stop, Stop::Target(_)).then_some(TargetReport {
        error_over_tolerance: Some(over).filter(|over| over.is_finite()),
        paths_for_a_tenth: for_a_tenth,
    });
    let report = SolverReport {
        method: "monte-carlo".to_owned(),
        chosen_because: None,
        paths: Some(all_paths),
        nodes: None,
        level: None,
        degrees_of_freedom: REPLICATES - 1,
        relative_error_reached: reached,
        target,
        is_final: run.is_final(),
        interrupted: false,
    };
    Ok(run.result(views, report, &specular, &format!("that would take more than {MOST_PATHS} paths")))
}
