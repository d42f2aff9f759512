//! `papilio fit`: keys of a scenario from measured data, with their intervals.

mod report;

use std::io::Write;
use std::path::Path;
use std::time::Instant;

use papilio_design::DesignError;
use papilio_design::fit::{FitReport, Fitting};
use papilio_design::output::{fit_figures, fit_table, fitted_text};
use papilio_design::search::was_stopped;
use papilio_formats::{write_file, write_json};
use papilio_scenario::{Edit, Fit, edit};

use crate::arguments::FitCommand;
use crate::compare::{measurement, names_of};
use crate::progress::FractionBar;
use crate::terminal::not_in;
use crate::{Failure, costs, folder, input, interrupt, output, print_message, print_notes, print_warnings};

/// Files of an earlier fit, besides figures.
const FILES: [&str; 3] = ["fitted.toml", "fit.json", "fit.csv"];

pub(crate) fn run(arguments: &FitCommand) -> Result<(), Failure> {
    let spec = input::scenario::<Fit>(&arguments.scenario.file, &arguments.scenario.set)?;
    let mut notes = spec.notes.clone();
    print_notes(&notes);
    let own = costs::own(&arguments.scenario.file, &arguments.scenario.set)?;
    costs::check_fit(&own, &spec, arguments.workers.threads)?;
    let (measured, of_files) = measurement(&arguments.measured)?;
    print_notes(&of_files);
    notes.extend(of_files);
    interrupt::catch_ctrl_c();
    let started = Instant::now();
    let title = spec.title.clone().unwrap_or_else(|| crate::report::file_title(&arguments.scenario.file));
    let fitting = Fitting::new(spec, &measured, &interrupt::STOP).map_err(|error| match error {
        DesignError::Fit { reason } => {
            let (file, measured) = (arguments.scenario.file.display(), names_of(&arguments.measured));
            Failure::Input(format!("{file} and {measured}: {reason}"))
        }
        other => interrupted(other),
    })?;
    let folder = folder::choose_for_fit(&arguments.scenario, fitting.hash())?;
    let threads = arguments.workers.threads.map(usize::from);
    let threads = threads.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from));
    let found = {
        let bar = FractionBar::new();
        let _log = bar.in_log(String::new);
        fitting
            .run(threads, &|fraction, words| bar.advance(fraction, words.to_owned()))
            .map_err(interrupted)?
    };
    let Some(mut found) = found else {
        print_warnings(&not_in(fitting.warnings(), &own.warnings));
        print_notes(fitting.notes());
        return Err(Failure::Infeasible(
            "no start led to a minimum\n  = help: use more starts (fit.starts), or narrower bounds around what is known",
        ));
    };
    print_message(&format!(
        "{} fitted in {:.2} s",
        report::counted(found.observations, "number"),
        started.elapsed().as_secs_f64()
    ));
    // Those of the fit are printed after it, and written with the others.
    let of_fit = found.notes.clone();
    found.notes.splice(0..0, notes);
    // Those of the scenario are printed before it.
    let warnings = not_in(&found.warnings, &own.warnings);
    found.warnings = [&own.warnings[..], &warnings].concat();
    output::make_folder(&folder)?;
    let names = interrupt::uninterrupted(|| write(arguments, &folder, &title, &fitting, &found))?;
    let mut stdout = crate::terminal::output(arguments.json);
    if arguments.json {
        write_json(&mut stdout, &found)?;
    } else {
        stdout.write_all(report::text(&title, &found).as_bytes())?;
    }
    stdout.flush()?;
    folder.print_written(&names);
    print_warnings(&warnings);
    print_notes(&of_fit);
    Ok(())
}

fn interrupted(error: DesignError) -> Failure {
    match was_stopped(&error) {
        true => Failure::Interrupted("the fit is not saved; run the same command again"),
        false => error.into(),
    }
}

fn write(
    arguments: &FitCommand,
    folder: &Path,
    title: &str,
    fitting: &Fitting<'_>,
    found: &FitReport,
) -> Result<Vec<String>, Failure> {
    let path = &arguments.scenario.file;
    let file = input::file(path)?;
    let from = path.parent().unwrap_or(Path::new(""));
    let set: Vec<Edit> =
        arguments.scenario.set.iter().filter_map(|text| Edit::of_set_in(text, from)).collect();
    let text = edit(file.text().map_err(Failure::Data)?, &set)?;
    let text = fitted_text(&text, [from, folder], fitting, found)?;
    // After its text is read: it may be that of an earlier fit.
    output::remove(folder, |name| FILES.contains(&name) || output::is_figure_of(&["fit-"], name))?;
    write_file(&folder.join("fitted.toml"), |out| out.write_all(text.as_bytes()))?;
    write_file(&folder.join("fit.json"), |out| write_json(out, found))?;
    write_file(&folder.join("fit.csv"), |out| out.write_all(fit_table(found).as_bytes()))?;
    let mut names = FILES.map(str::to_owned).to_vec();
    names.extend(output::write_figures(folder, fit_figures(title, found), arguments.png)?);
    Ok(names)
}
