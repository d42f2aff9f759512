//! `papilio sweep`: a scenario at every point of its `[sweep]`, which can be interrupted and resumed.
//!
//! Points are computed in parallel, each on one thread and as by `papilio run`. The numbers of a point
//! therefore do not depend on other points, and a resumed sweep writes the same bytes as an uninterrupted
//! one. Each finished point is saved in the journal immediately.

mod compute;
mod journal;
mod light;
mod merge;
mod table;

use std::collections::BTreeSet;
use std::io::Write;
use std::path::Path;
use std::time::Instant;

use papilio_display::metric_label;
use papilio_figures::of_sweep;
use papilio_formats::{
    SweepHead, SweepPoint, journal_name, sweep_columns, sweep_parquet, write_file, write_sweep_csv,
    write_sweep_json,
};
use papilio_scenario::{Sweep, label, labelled_names, nearest};

use self::compute::compute;
use self::journal::Journal;
use crate::arguments::{Sweep as Command, SweepCommand, SweepOutputs as Outputs, SweepRun, default_out};
use crate::{Failure, costs, input, interrupt, output, print_message, print_notes, report, terminal};

/// Number of points from which a note says that a compact sweep takes less time and space.
const MANY_POINTS: usize = 1000;

/// Most points whose scenario is checked before any point is computed.
const MOST_SAMPLES: usize = 1000;

pub(crate) fn sweep(command: &Command) -> Result<(), Failure> {
    match (&command.command, &command.run) {
        (Some(SweepCommand::Merge(merge)), _) => merge::merge(merge),
        (None, Some(run)) => self::run(run, &command.outputs),
        // Not reached: clap requires the scenario.
        (None, None) => Err(Failure::Input("a scenario file is required".to_owned())),
    }
}

fn run(arguments: &SweepRun, outputs: &Outputs) -> Result<(), Failure> {
    check_columns(&outputs.columns)?;
    let mut overrides = arguments.set.clone();
    overrides.extend(arguments.axis.iter().map(|axis| Sweep::axis_override(axis)));
    if !arguments.metrics.is_empty() {
        // Without axes, nothing of them is stated.
        input::scenario::<Sweep>(&arguments.file, &overrides)?;
        overrides.push(format!("--metrics sweep.metrics={:?}", arguments.metrics));
        // The figures of the file may be of other metrics.
        if !arguments.set.iter().any(|set| set.starts_with("sweep.figures")) {
            overrides.push(format!("--metrics sweep.figures={:?}", arguments.metrics));
        }
    }
    let mut sweep = input::scenario::<Sweep>(&arguments.file, &overrides)?;
    print_notes(sweep.notes());
    let samples: Vec<usize> = sweep.samples().into_iter().take(MOST_SAMPLES).collect();
    let mut warnings = Vec::new();
    for point in &samples {
        warnings.extend(sweep.scenario(*point)?.resolve()?.warnings);
    }
    let light = sweep.light()?;
    if light.is_none() {
        let count = sweep.len().div_ceil(arguments.shard.map_or(1, |(_, n)| n));
        costs::check_evaluations(
            &sweep.scenario(0)?.resolve()?,
            (count as f64, "points", "values of the axes of sweep.axes, or --shard"),
            false,
            0.0,
            arguments.threads,
        )?;
    }
    let folder = arguments.out.clone().unwrap_or_else(|| default_out(&arguments.file));
    output::check(&folder)?;
    output::make_folder(&folder)?;
    if let Some(light) = light {
        // Its points keep numbers alone.
        terminal::print_counted(warnings.iter().map(String::as_str), samples.len(), "checked points");
        let warnings: Vec<String> = BTreeSet::from_iter(warnings).into_iter().collect();
        return light::run(arguments, outputs, &sweep, (light, &warnings), &folder);
    }
    note_size(&sweep);
    let head = sweep.head(env!("CARGO_PKG_VERSION"), &report::file_title(&arguments.file));
    let mut journal = Journal::open(&folder, &journal_name(journal::STEM, arguments.shard), head.clone())?;
    let (k, n) = arguments.shard.unwrap_or((1, 1));
    let mine: Vec<usize> = (0..sweep.len()).filter(|point| point % n == k - 1).collect();
    let started = Instant::now();
    let done = compute(&sweep, &head, &mine, &mut journal, arguments.threads)?;
    let computed = done.values().filter(|done| done.computed).count();
    let points: Vec<(usize, String)> = done.into_iter().map(|(point, done)| (point, done.hash)).collect();
    if points.len() < mine.len() {
        print_message(&format!("{} of {} points are finished and saved", points.len(), mine.len()));
        return Err(Failure::Interrupted("run the same command again to resume"));
    }
    let known: Vec<SweepPoint> = points.iter().filter_map(|(_, hash)| journal.find(hash).cloned()).collect();
    interrupt::uninterrupted(|| journal.finish(&points))?;
    let seconds = started.elapsed().as_secs_f64();
    let title = head.title.clone().unwrap_or_default();
    print_message(&format!(
        "{}: {} points, {computed} computed in {seconds:.2} s",
        report::plain(&title),
        mine.len()
    ));
    if arguments.shard.is_some() {
        print_message(&format!(
            "shard {k} of {n} is done. When all shards are done, run: papilio sweep merge {}",
            folder.display()
        ));
        return Ok(());
    }
    let refs: Vec<&SweepPoint> = known.iter().collect();
    finish(&folder, &head, sweep.notes(), &refs, outputs)
}

/// Prints a note if a sweep of many points stores all results of each, before it begins.
fn note_size(sweep: &Sweep) {
    if sweep.len() >= MANY_POINTS {
        print_message(&format!(
            "note: all results of each of the {} points are stored and written\n  = help: --metrics contrast_ratio,white.Y (or sweep.metrics) stores only \
             the metrics that you name, in a hundredth of the space and a fraction of the time",
            sweep.len()
        ));
    }
}

/// True for names of the files that an earlier sweep has written, except its journal: they would be mistaken
/// for those of this one.
fn is_of_a_sweep(name: &str) -> bool {
    ["sweep.csv", "sweep.parquet"].contains(&name) || output::is_figure_of(&["sweep_"], name)
}

/// Fails for columns that no sweep has, before any point is computed.
fn check_columns(columns: &[String]) -> Result<(), Failure> {
    let known = |name: &&String| metric_label(name).is_none() && !matches!(name.as_str(), "state");
    let Some(wrong) = columns.iter().find(known) else { return Ok(()) };
    let names: Vec<String> = labelled_names().collect();
    let number = wrong.rsplit_once('.').map_or(wrong.as_str(), |(_, number)| number);
    let advice = nearest(number, names.iter().map(String::as_str)).map_or(
        "a sweep without --columns writes all of them; docs/metrics.md describes them".to_owned(),
        |near| format!("did you mean `{}{near}`?", &wrong[..wrong.len() - number.len()]),
    );
    Err(Failure::Input(format!(
        "--columns: there is no column `{wrong}`\n  = note: expected columns of states.csv (Y, L_star, Y_se), or metrics of a view or of one state \
         (contrast_ratio, white.Y), with commas between them\n  = help: {advice}"
    )))
}

/// Error: the finished sweep has no such column.
fn no_column(wrong: &str) -> Failure {
    Failure::Input(format!(
        "--columns: {wrong}\n  = help: all points are saved; run the same command with other columns to write the table"
    ))
}

/// Writes the table and figures, and prints the report.
fn finish(
    folder: &Path,
    head: &SweepHead,
    notes: &[String],
    points: &[&SweepPoint],
    outputs: &Outputs,
) -> Result<(), Failure> {
    let chosen = match outputs.columns.as_slice() {
        [] => None,
        columns => Some(sweep_columns(points, columns).map_err(|wrong| no_column(&wrong))?),
    };
    let table: Vec<&SweepPoint> =
        chosen.as_ref().map_or_else(|| points.to_vec(), |chosen| chosen.iter().collect());
    let names = interrupt::uninterrupted(|| -> Result<Vec<String>, Failure> {
        output::remove(folder, is_of_a_sweep)?;
        write_file(&folder.join("sweep.csv"), |out| write_sweep_csv(out, head, &table))?;
        let mut names = vec!["sweep.csv".to_owned()];
        if outputs.parquet {
            let bytes = sweep_parquet(head, &table)?;
            write_file(&folder.join("sweep.parquet"), |out| out.write_all(&bytes))?;
            names.push("sweep.parquet".to_owned());
        }
        names.extend(output::write_figures(folder, of_sweep(head, points, &label), outputs.png)?);
        Ok(names)
    })?;
    let mut stdout = crate::terminal::output(outputs.json);
    if outputs.json {
        write_sweep_json(&mut stdout, head, notes, points)?;
    } else {
        stdout.write_all(table::sweep_table(head, points, points.len()).as_bytes())?;
    }
    stdout.flush()?;
    output::print_written(folder, &names);
    let warnings = points.iter().flat_map(|point| &point.warnings).map(String::as_str);
    terminal::print_counted(warnings, points.len(), "points");
    Ok(())
}
