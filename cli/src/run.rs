//! `papilio run`: the result of a scenario.

use std::io::Write;
use std::path::Path;
use std::time::Instant;

use papilio_diagnostics::short_numbers;
use papilio_display::result::RunResult;
use papilio_display::scene::{AngleMedium, Method};
use papilio_display::{ConeGrid, ConeResult, Prepared, adding_seconds, ambient_light_by_direction, forecast};
use papilio_formats::{ResultFile, write_json};
use papilio_scenario::{Resolved, Scenario};

use crate::arguments::{Run, Solver};
use crate::folder::ResultFolder;
use crate::long_work::Expected;
use crate::progress::{Computation, with_progress};
use crate::saved::SavedTable;
use crate::{
    Failure, costs, folder, input, interrupt, output, print_message, print_notes, print_warnings, report,
};

/// Fractions of the progress that are the views and their cone, about.
const PARTS: [f64; 2] = [0.2, 0.8];

/// Shortest computation that is announced, in seconds of one processor.
const LONG_SECONDS: f64 = 1.0;

pub(crate) fn run(arguments: &Run) -> Result<(), Failure> {
    let resolved = resolve(arguments)?;
    let out = out_folder(arguments, &resolved)?;
    costs::check_paths(&resolved, None, (1.0, "solver.paths"), arguments.workers.threads)?;
    let views = resolved.scene.viewer.directions().count();
    let views = (!arguments.cone).then_some(views);
    costs::check_views(&resolved, views, arguments.workers.threads)?;
    if arguments.cone {
        costs::check_map(&resolved, arguments.workers.threads)?;
    }
    cost_note(&resolved, arguments.workers.threads)?.iter().for_each(|note| print_message(note));
    let started = Instant::now();
    let threads = arguments.workers.threads;
    let mut computation = Computation::in_parts(if arguments.cone { &PARTS } else { &[1.0] });
    let mut prepared = Prepared::empty();
    let result = computation.part(&resolved, threads, |control| prepared.run(&resolved.scene, control))?;
    let mut result = result.ok_or(Failure::Interrupted("no result was computed; no file was written"))?;
    let seconds = started.elapsed().as_secs_f64();
    let started = Instant::now();
    let mut saved = None;
    let mut cone = None;
    if let Some(folder) = out.as_deref().filter(|_| arguments.cone && !result.solver.interrupted) {
        // The reference is one of the rows.
        let directions = format!("maps, reference {:?}", arguments.cone_reference);
        let table = saved.insert(SavedTable::open(folder, "cone", &resolved.hash, directions)?);
        let found = compute_cone(&resolved, arguments, (&mut prepared, table), &mut computation);
        if let (Err(_), Some(table)) = (&found, saved.take_if(|_| found.is_err())) {
            table.discard()?;
        }
        cone = found?;
    }
    drop(computation);
    let cone_seconds = started.elapsed().as_secs_f64();
    resolved.warn_before(&mut result.warnings);
    result.notes.splice(0..0, resolved.notes.iter().cloned());
    let file = ResultFile {
        papilio: env!("CARGO_PKG_VERSION"),
        scenario: &resolved.canonical,
        hash: &resolved.hash,
        seed: resolved.scene.solver.seed,
        notes: &result.notes,
        result: &result,
    };
    let title = resolved.title.clone().unwrap_or_else(|| report::file_title(&arguments.scenario.file));
    let light = ambient_light_by_direction(&resolved.scene)?;
    let files = output::Files {
        title: &title,
        result: &file,
        light: light.as_ref(),
        cone: cone.as_ref(),
        png: arguments.png,
        report: arguments.report,
        in_glass: resolved.scene.solver.angle_medium == AngleMedium::Glass,
    };
    let mut write = |folder: &Path| {
        let names = output::write_run(folder, &files)?;
        // With its maps, there is nothing to resume.
        saved.take().filter(|_| cone.is_some()).map_or(Ok(()), SavedTable::discard)?;
        Ok::<_, Failure>(names)
    };
    let written = out.as_deref().map(|folder| interrupt::uninterrupted(|| write(folder)));
    // Print the result even if the files cannot be written.
    let mut stdout = crate::terminal::output(arguments.json);
    if arguments.json {
        write_json(&mut stdout, &file)?;
    } else {
        let cone = cone.as_ref().map(|cone| report::cone(cone, cone_seconds)).unwrap_or_default();
        let text = report::run(&title, files.in_glass, &result, seconds);
        stdout.write_all(short_numbers(&text).as_bytes())?;
        stdout.write_all(cone.as_bytes())?;
    }
    stdout.flush()?;
    print_messages(out.as_ref(), written.transpose()?, &result);
    let cone_warnings = cone.iter().flat_map(|cone| &cone.warnings).filter(|w| !result.warnings.contains(w));
    cone_warnings.for_each(|warning| print_message(&format!("warning: cone: {warning}")));
    match (result.solver.interrupted, arguments.cone && cone.is_none()) {
        (true, _) => Err(Failure::Interrupted("the result contains the work done so far")),
        (false, true) => Err(Failure::Interrupted(
            "the cone map is not complete; all other results were written, and the same command resumes it",
        )),
        (false, false) => Ok(()),
    }
}

/// A note if the solver will take long, before it begins, and whether the other one would take less time.
fn cost_note(resolved: &Resolved, threads: Option<u16>) -> Result<Option<String>, Failure> {
    let scene = &resolved.scene;
    // Below a colour filter, paths read places, whose cost is not estimated.
    if scene.display.filter().is_some() {
        return Ok(None);
    }
    let failure = |error| Failure::from_display(resolved, error);
    let is_adding = match scene.solver.method {
        Method::Adding if adding_seconds(scene).map_err(failure)? < LONG_SECONDS => return Ok(None),
        Method::Adding => true,
        Method::MonteCarlo => false,
        // Says itself what it has chosen.
        Method::Auto => return Ok(None),
    };
    // Interrupted: so is the run.
    let Some(forecast) = with_progress(resolved, threads, |control| forecast(scene, control))? else {
        return Ok(None);
    };
    let (adding, monte_carlo) =
        (("adding", forecast.adding_s), ("the Monte Carlo solver", forecast.monte_carlo_s));
    let ((solver, seconds), (other, of_other)) =
        if is_adding { (adding, monte_carlo) } else { (monte_carlo, adding) };
    let Some(seconds) = seconds.filter(|seconds| *seconds >= LONG_SECONDS) else { return Ok(None) };
    let (what, keys) =
        (format!("this result by {solver}"), "solver.paths, or a larger solver.relative_error");
    Expected { what, keys, seconds, bytes: 0.0 }.check(threads)?;
    let faster = of_other.filter(|of_other| *of_other < 0.5 * seconds).map_or(String::new(), |of_other| {
        format!(
            "\n  = help: {other} would take about {}; --solver auto takes the faster one",
            duration(of_other)
        )
    });
    let expected = duration(seconds);
    Ok(Some(format!(
        "note: {solver} will take about {expected} of one processor (estimated to within a factor of ten){faster}"
    )))
}

/// An estimated duration in words.
fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 1.0 => format!("{s:.1e} s"),
        s if s < 120.0 => format!("{s:.0} s"),
        s if s < 7200.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.0} h", s / 3600.0),
    }
}

/// Folder for the files, if any are written.
fn out_folder(arguments: &Run, resolved: &Resolved) -> Result<Option<ResultFolder>, Failure> {
    if arguments.scenario.out.is_some() || !arguments.json {
        return folder::choose(&arguments.scenario, resolved).map(Some);
    }
    if arguments.cone || arguments.png || arguments.report {
        let message = "--cone, --png and --report write files, but --json writes none without --out\n  = help: specify a folder with --out DIR";
        return Err(Failure::Input(message.to_owned()));
    }
    Ok(None)
}

/// Prints the messages of a run on standard error.
fn print_messages(folder: Option<&ResultFolder>, written: Option<Vec<String>>, result: &RunResult) {
    if let (Some(folder), Some(names)) = (folder, written) {
        folder.print_written(&names);
    }
    print_notes(&result.notes);
    print_warnings(&result.warnings);
}

fn resolve(arguments: &Run) -> Result<Resolved, Failure> {
    let mut overrides = arguments.scenario.set.clone();
    overrides.extend(arguments.solver.map(Solver::as_override));
    overrides.extend(arguments.seed.map(|seed| format!("solver.seed={seed}")));
    Ok(input::scenario::<Scenario>(&arguments.scenario.file, &overrides)?.resolve()?)
}

/// Computes the conoscopic maps; `None` if interrupted.
fn compute_cone(
    resolved: &Resolved,
    arguments: &Run,
    (prepared, saved): (&mut Prepared, &SavedTable<'_>),
    computation: &mut Computation,
) -> Result<Option<ConeResult>, Failure> {
    let mut grid = ConeGrid::within(&resolved.scene)?;
    grid.reference_deg = arguments.cone_reference.unwrap_or(grid.reference_deg);
    computation.part(resolved, arguments.workers.threads, |control| {
        prepared
            .cone_resumed(&resolved.scene, grid, control, &saved.part(0, 1))?
            .allowing(arguments.allow_error)
    })
}
