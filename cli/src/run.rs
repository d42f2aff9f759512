//! `papilio run`.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

use indicatif::{ProgressBar, ProgressStyle};
use papilio_display::result::RunResult;
use papilio_display::scene::{AngleMedium, Method, Scene};
use papilio_display::{
    ConeGrid, ConeResult, Control, DisplayError, Progress, RoomLight, adding_seconds, room_light,
};
use papilio_formats::{ResultFile, write_json};
use papilio_scenario::{Resolved, Scenario};

use crate::arguments::{Run, Solver};
use crate::progress::in_log;
use crate::{Failure, folder, interrupt, output, report, say};

/// Less goes without saying, in seconds of one processor.
const LONG_SECONDS: f64 = 20.0;

pub(crate) fn run(arguments: &Run) -> Result<(), Failure> {
    let resolved = resolve(arguments)?;
    let out = out_folder(arguments, &resolved.hash)?;
    cost(&resolved)?.iter().for_each(|note| say(note));
    let started = Instant::now();
    let mut result = compute(&resolved, arguments.workers.threads)?;
    let seconds = started.elapsed().as_secs_f64();
    let started = Instant::now();
    let cone = if arguments.cone && !result.solver.interrupted {
        survey(&resolved, arguments.allow_error, arguments.workers.threads)?
    } else {
        None
    };
    let cone_seconds = started.elapsed().as_secs_f64();
    result.warnings.splice(0..0, resolved.warnings.iter().cloned());
    let file = ResultFile {
        papilio: env!("CARGO_PKG_VERSION"),
        scenario: &resolved.canonical,
        hash: &resolved.hash,
        seed: resolved.scene.solver.seed,
        notes: &resolved.notes,
        result: &result,
    };
    let title = resolved.title.clone().unwrap_or_else(|| report::file_title(&arguments.scenario.file));
    let light = light(&resolved.scene)?;
    let files = output::Files {
        title: &title,
        result: &file,
        light: light.as_ref(),
        cone: cone.as_ref(),
        png: arguments.png,
    };
    let written = out.as_deref().map(|folder| interrupt::whole(|| output::write_run(folder, &files)));
    // What was computed is shown even if it cannot be written.
    let mut stdout = crate::terminal::stdout();
    if arguments.json {
        write_json(&mut stdout, &file)?;
    } else {
        let in_glass = resolved.scene.solver.angle_medium == AngleMedium::Glass;
        let cone = cone.as_ref().map(|cone| report::cone(cone, cone_seconds)).unwrap_or_default();
        stdout.write_all(report::run(&title, in_glass, &result, seconds).as_bytes())?;
        stdout.write_all(cone.as_bytes())?;
    }
    stdout.flush()?;
    tell(out.as_deref(), written.transpose()?, &resolved.notes, &result);
    let of_cone = cone.iter().flat_map(|cone| &cone.warnings).filter(|w| !result.warnings.contains(w));
    of_cone.for_each(|warning| say(&format!("warning: cone: {warning}")));
    match (result.solver.interrupted, arguments.cone && cone.is_none()) {
        (true, _) => Err(Failure::Interrupted("the result is that of the work done so far")),
        (false, true) => Err(Failure::Interrupted("the cone is not there, all else is")),
        (false, false) => Ok(()),
    }
}

/// Says beforehand that adding will take long, if it will.
fn cost(resolved: &Resolved) -> Result<Option<String>, Failure> {
    if resolved.scene.solver.method != Method::Adding {
        return Ok(None);
    }
    let seconds = adding_seconds(&resolved.scene).map_err(|error| Failure::of(resolved, error))?;
    Ok((seconds >= LONG_SECONDS).then(|| {
        format!(
            "note: adding will take about {seconds:.0} s of one processor for these layers (an estimate, right to within a \
             factor of ten); --solver walk needs no such preparation"
        )
    }))
}

/// Where the light comes from, where that is more than one direction or the same from all.
fn light(scene: &Scene) -> Result<Option<RoomLight>, Failure> {
    let is_plain = scene.lighting.environment.is_empty() && scene.lighting.directed.len() < 2;
    Ok(if is_plain { None } else { Some(room_light(scene)?) })
}

/// Where files go, if they do.
fn out_folder(arguments: &Run, hash: &str) -> Result<Option<PathBuf>, Failure> {
    if arguments.scenario.out.is_some() || !arguments.json {
        return folder::choose(&arguments.scenario, hash).map(Some);
    }
    if arguments.cone || arguments.png {
        let message = "--json writes no files by itself, and --cone and --png are about files\n  = help: name a folder with --out DIR";
        return Err(Failure::Input(message.to_owned()));
    }
    Ok(None)
}

/// What belongs on standard error.
fn tell(folder: Option<&Path>, written: Option<Vec<String>>, notes: &[String], result: &RunResult) {
    if let (Some(folder), Some(names)) = (folder, written) {
        output::announce(folder, &names);
    }
    notes.iter().for_each(|note| say(&format!("note: {note}")));
    result.warnings.iter().for_each(|warning| say(&format!("warning: {warning}")));
}

fn resolve(arguments: &Run) -> Result<Resolved, Failure> {
    let mut overrides = arguments.scenario.set.clone();
    overrides.extend(arguments.solver.map(|solver| {
        let method = match solver {
            Solver::Adding => "adding",
            Solver::Walk => "walk",
        };
        format!("solver.method={method}")
    }));
    overrides.extend(arguments.seed.map(|seed| format!("solver.seed={seed}")));
    Ok(Scenario::load(&arguments.scenario.file, &overrides)?.resolve()?)
}

/// Computes the display that a scenario describes.
pub(crate) fn compute(resolved: &Resolved, threads: Option<u16>) -> Result<RunResult, Failure> {
    let result = with_progress(resolved, threads, |control| papilio_display::run(&resolved.scene, control))?;
    result.ok_or(Failure::Interrupted("nothing was computed yet, nothing is written"))
}

/// All directions; `None` if interrupted.
fn survey(
    resolved: &Resolved,
    allow_error: Option<f64>,
    threads: Option<u16>,
) -> Result<Option<ConeResult>, Failure> {
    let grid = ConeGrid::within(&resolved.scene)?;
    with_progress(resolved, threads, |control| {
        papilio_display::cone(&resolved.scene, grid, control)?.allowing(allow_error)
    })
}

/// Computes something of a scenario under a progress bar; `None` if it was interrupted before there was a result.
pub(crate) fn with_progress<T>(
    resolved: &Resolved,
    threads: Option<u16>,
    compute: impl FnOnce(&Control<'_>) -> Result<T, DisplayError>,
) -> Result<Option<T>, Failure> {
    interrupt::heed();
    let bar = progress_bar();
    let _log = in_log(&bar, |bar| format!("{} %  {}", bar.position() / 10, bar.message()));
    let show = |progress: Progress<'_>| show(&bar, progress);
    let control = Control { threads: threads.map(usize::from), progress: &show, stop: &interrupt::STOP };
    let result = compute(&control);
    bar.finish_and_clear();
    match result {
        Err(DisplayError::Interrupted) => Ok(None),
        other => other.map(Some).map_err(|error| Failure::of(resolved, error)),
    }
}

/// On standard error, and only where that is a terminal.
fn progress_bar() -> ProgressBar {
    let bar = ProgressBar::new(1000);
    if let Ok(style) = ProgressStyle::with_template("  {bar:30} {percent:>3} %  {msg}  {elapsed}") {
        bar.set_style(style);
    }
    bar
}

fn show(bar: &ProgressBar, progress: Progress<'_>) {
    let (views_done, views) = progress.views_done;
    let of_view = match progress.target {
        Some(target) => (target / progress.relative_error).min(1.0),
        None => progress.share_of_paths.unwrap_or(0.0),
    };
    let of_view = if of_view < 1.0 { of_view } else { 0.0 };
    bar.set_position((1000.0 * (views_done as f64 + of_view) / views as f64) as u64);
    let target = progress.target.map_or(String::new(), |target| format!(" (target {:.2} %)", 100.0 * target));
    let views = if views == 1 { String::new() } else { format!(", {views_done} of {views} views done") };
    let paths = progress.paths.map_or(String::new(), |paths| format!(", {paths} paths"));
    bar.set_message(format!("error {:.2} %{target}{paths}{views}", 100.0 * progress.relative_error));
}
