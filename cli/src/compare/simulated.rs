//! The simulated side of a comparison: a result, or a scenario, which is computed.

use std::path::{Path, PathBuf};

use papilio_design::DesignError;
use papilio_design::measured::{SAMPLES, add_metrics, add_tolerances};
use papilio_design::search::was_stopped;
use papilio_display::compare::{Measurement, Simulated};
use papilio_formats::{ReadResult, read_result_with};
use papilio_scenario::{ParameterisedScenario, Scenario, Tolerance};

use crate::arguments::Compare;
use crate::progress::{FractionBar, with_progress};
use crate::{Failure, input, interrupt, print_message, print_notes, print_warnings};

/// Reads or computes the simulated side; returns the path of its file, too.
pub(super) fn read(
    arguments: &Compare,
    measured: &Measurement,
) -> Result<(PathBuf, ReadResult, Vec<String>), Failure> {
    let path = &arguments.result;
    if path.extension().is_some_and(|end| end.eq_ignore_ascii_case("toml")) {
        let (read, notes) = computed(arguments, measured)?;
        return Ok((path.clone(), read, notes));
    }
    if !arguments.set.is_empty() {
        return Err(Failure::Input(format!(
            "--set changes a scenario, but {} is a result\n  = help: give the scenario file instead",
            path.display()
        )));
    }
    // For a folder, the `result.json` in it.
    let file = if path.is_dir() { path.join(RESULT) } else { path.clone() };
    if path.is_dir() && !file.exists() {
        return Err(without_result(path));
    }
    let read = read_result_with(&super::open(&file)?, &measured.metrics).map_err(Failure::Data)?;
    print_warnings(&read.warnings);
    Ok((file, read, Vec::new()))
}

const RESULT: &str = "result.json";

/// Largest number of folders that are proposed.
const MOST_PROPOSED: usize = 3;

/// The error of a folder without a result; those in it may have one.
fn without_result(folder: &Path) -> Failure {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut there: Vec<PathBuf> =
        entries.map(|entry| entry.path()).filter(|path| path.join(RESULT).is_file()).collect();
    there.sort();
    let there: Vec<String> =
        there.iter().take(MOST_PROPOSED).map(|path| format!("`{}`", path.display())).collect();
    let help = match there.is_empty() {
        true => "`papilio run SCENARIO` writes one; or give the scenario file itself".to_owned(),
        false => format!("did you mean {}?", there.join(" or ")),
    };
    Failure::Input(format!("the folder {} contains no {RESULT}\n  = help: {help}", folder.display()))
}

/// Computes a scenario, its measured metrics, and the spread by its `[tolerance]`.
fn computed(arguments: &Compare, measured: &Measurement) -> Result<(ReadResult, Vec<String>), Failure> {
    let (path, set) = (&arguments.result, &arguments.set);
    let scenario = input::scenario::<Scenario>(path, set)?;
    let resolved = scenario.resolve()?;
    print_notes(&resolved.notes);
    print_warnings(&resolved.warnings);
    let threads = arguments.workers.threads;
    let result = with_progress(&resolved, threads, |control| papilio_display::run(&resolved.scene, control))?;
    let result = result.filter(|result| !result.solver.interrupted).ok_or(INTERRUPTED)?;
    print_warnings(&result.warnings);
    let warnings = [&resolved.warnings[..], &result.warnings].concat();
    let mut simulated = Simulated::of(&result, &resolved.scene).ok_or_else(|| {
        Failure::Input(format!(
            "{}: all of its light comes from the front light, so it has no reflectance factors to compare",
            path.display()
        ))
    })?;
    let varied = ParameterisedScenario::load(path, set, &[])?;
    or_interrupted(add_metrics(&mut simulated, measured, varied, &interrupt::STOP))?;
    if scenario.has_tolerance() {
        add_spread(&mut simulated, measured, path, arguments)?;
    }
    let (title, hash) = (resolved.title.clone(), Some(resolved.hash.clone()));
    let read = ReadResult { title, hash, warnings, simulated };
    Ok((read, resolved.notes.clone()))
}

/// Adds the spread by the tolerances of the inputs.
fn add_spread(
    simulated: &mut Simulated,
    measured: &Measurement,
    path: &Path,
    arguments: &Compare,
) -> Result<(), Failure> {
    let tolerance = input::scenario::<Tolerance>(path, &arguments.set)?;
    papilio_design::tolerance::Production::new(&tolerance).check(&tolerance)?;
    let threads = arguments.workers.threads.map(usize::from);
    let threads = threads.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from));
    let bar = FractionBar::new();
    let _log = bar.in_log(String::new);
    let progress = |done: usize| {
        bar.advance(done as f64 / SAMPLES as f64, format!("{done} of {SAMPLES} displays of [tolerance]"))
    };
    let spread = add_tolerances(simulated, measured, &tolerance, (threads, &interrupt::STOP), &progress);
    or_interrupted(spread)?;
    drop(bar);
    print_message(&format!("the spread by [tolerance] is that of {SAMPLES} displays"));
    Ok(())
}

const INTERRUPTED: Failure = Failure::Interrupted("run the same command again");

fn or_interrupted<T>(result: Result<T, DesignError>) -> Result<T, Failure> {
    result.map_err(|error| if was_stopped(&error) { INTERRUPTED } else { error.into() })
}
