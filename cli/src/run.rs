//! `papilio run`.

use std::io::Write;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use indicatif::{ProgressBar, ProgressStyle};
use papilio_display::{Control, DisplayError, Progress};
use papilio_formats::{ResultFile, write_json};
use papilio_scenario::{Resolved, Scenario};

use crate::arguments::{Run, Solver};
use crate::{Failure, output, report};

/// Set by Ctrl-C.
static STOP: AtomicBool = AtomicBool::new(false);

pub(crate) fn run(arguments: &Run) -> Result<(), Failure> {
    if let Some(Solver::Adding) = arguments.solver {
        let message =
            "the solver `adding` is not in this version\n  = help: leave --solver out, or use --solver walk";
        return Err(Failure::Input(message.to_owned()));
    }
    let resolved = resolve(arguments)?;
    let out = match (&arguments.scenario.out, arguments.json) {
        (Some(folder), _) => Some(folder.clone()),
        (None, true) => None,
        (None, false) => Some(arguments.scenario.default_out()),
    };
    if let Some(folder) = &out {
        output::folder(folder)?;
    }
    let started = Instant::now();
    let mut result = compute(&resolved, arguments.threads)?;
    let seconds = started.elapsed().as_secs_f64();
    result.warnings.splice(0..0, resolved.warnings.iter().cloned());
    let file = ResultFile {
        papilio: env!("CARGO_PKG_VERSION"),
        scenario: &resolved.canonical,
        hash: &resolved.hash,
        seed: resolved.scene.solver.seed,
        result: &result,
    };
    let written = out.as_ref().map(|folder| Ok::<_, Failure>((folder, output::write_run(folder, &file)?)));
    let written: Option<(&PathBuf, Vec<String>)> = written.transpose()?;
    let mut stdout = anstream::stdout().lock();
    if arguments.json {
        write_json(&mut stdout, &file)?;
    } else {
        let title = resolved.title.as_deref().unwrap_or("Untitled");
        stdout.write_all(report::run(title, &result, seconds).as_bytes())?;
    }
    stdout.flush()?;
    if let Some((folder, names)) = written {
        output::announce(folder, &names);
    }
    for warning in &result.warnings {
        anstream::eprintln!("warning: {warning}");
    }
    if result.solver.interrupted {
        return Err(Failure::Interrupted("the result is that of the paths traced so far"));
    }
    Ok(())
}

fn resolve(arguments: &Run) -> Result<Resolved, Failure> {
    let mut overrides = arguments.scenario.set.clone();
    overrides.extend(arguments.seed.map(|seed| format!("solver.seed={seed}")));
    Ok(Scenario::load(&arguments.scenario.file, &overrides)?.resolve()?)
}

fn compute(resolved: &Resolved, threads: Option<u16>) -> Result<papilio_display::result::RunResult, Failure> {
    // Without a handler Ctrl-C still ends the program, only less politely.
    let _ = ctrlc::set_handler(|| {
        if STOP.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
    });
    let bar = progress_bar();
    let show = |progress: Progress| show(&bar, progress);
    let control = Control { threads: threads.map(usize::from), progress: &show, stop: &STOP };
    let result = papilio_display::run(&resolved.scene, &control);
    bar.finish_and_clear();
    match result {
        Err(DisplayError::Interrupted) => {
            Err(Failure::Interrupted("nothing was computed yet, nothing is written"))
        }
        other => Ok(other?),
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

fn show(bar: &ProgressBar, progress: Progress) {
    let done = match (progress.target, progress.paths_wanted) {
        (Some(target), _) => (target / progress.relative_error).min(1.0),
        (None, Some(wanted)) => progress.paths as f64 / wanted as f64,
        (None, None) => 0.0,
    };
    bar.set_position((1000.0 * done) as u64);
    let target = progress.target.map_or(String::new(), |target| format!(" (target {:.2} %)", 100.0 * target));
    let views = match progress.views_done {
        (_, 1) => String::new(),
        (done, all) => format!(", {done} of {all} views done"),
    };
    bar.set_message(format!(
        "error {:.2} %{target}, {} paths{views}",
        100.0 * progress.relative_error,
        progress.paths
    ));
}
