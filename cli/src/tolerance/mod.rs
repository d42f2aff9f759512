//! `papilio tolerance`: the distribution of metrics in production, the yield, and sensitivities; can be
//! interrupted and resumed.
//!
//! A sample depends only on its number. Shards can therefore be computed anywhere, and a larger number of
//! samples begins with those of a smaller one.

mod report;

use std::io::Write;
use std::time::Instant;

use papilio_design::output::{tolerance_figures, tolerance_tables};
use papilio_design::tolerance::{Production, Report};
use papilio_design::{DesignError, Evaluator};
use papilio_display::DisplayError;
use papilio_formats::{JournalRows, ToleranceHead, write_file, write_json};
use papilio_scenario::Tolerance;

use crate::arguments::{Tolerance as Arguments, default_out};
use crate::journal::open_rows;
use crate::parallel::compute_parallel;
use crate::{Failure, costs, input, interrupt, output, print_message, print_notes};

/// Names of files begin with this.
const STEM: &str = "tolerance";

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let tolerance = input::scenario::<Tolerance>(&arguments.file, &arguments.set)?;
    print_notes(&tolerance.notes);
    let production = Production::new(&tolerance);
    let paths = tolerance.keys.iter().flat_map(|key| key.paths.iter().map(|(path, ..)| path.as_str()));
    let numbers = tolerance.metrics.len() + tolerance.limits.len();
    costs::check_evaluations(
        &costs::own(&arguments.file, &arguments.set)?,
        (production.displays() as f64, "displays", "tolerance.samples, tolerance.sensitivity_samples"),
        costs::are_of_film(paths),
        costs::samples_bytes(production.displays(), numbers),
        arguments.workers.threads,
    )?;
    production.check(&tolerance)?;
    let folder = arguments.out.clone().unwrap_or_else(|| default_out(&arguments.file));
    output::check(&folder)?;
    output::make_folder(&folder)?;
    let head = ToleranceHead {
        papilio: env!("CARGO_PKG_VERSION").to_owned(),
        hash: tolerance.hash.clone(),
        metrics: tolerance.metrics.iter().map(|metric| metric.name.clone()).collect(),
    };
    let mut rows = open_rows(&folder, STEM, arguments.shard, head, &arguments.merge)?;
    let (k, n) = arguments.shard.unwrap_or((1, 1));
    let mine: Vec<usize> = (0..production.rows()).filter(|row| row % n == k - 1).collect();
    let started = Instant::now();
    let computed = compute(&production, &mine, &mut rows, arguments.workers.threads)?;
    let done = mine.iter().filter(|row| is_known(&production, &rows, **row)).count();
    if done < mine.len() {
        print_message(&format!("{done} of {} samples are finished and saved", mine.len()));
        return Err(Failure::Interrupted("run the same command again to resume"));
    }
    interrupt::uninterrupted(|| rows.finish(mine.iter().copied()))?;
    let title = tolerance.title.clone().unwrap_or_else(|| crate::report::file_title(&arguments.file));
    let title = crate::report::plain(&title);
    let seconds = started.elapsed().as_secs_f64();
    print_message(&format!("{title}: {} samples, {computed} computed in {seconds:.2} s", mine.len()));
    if arguments.shard.is_some() {
        print_message(&format!(
            "shard {k} of {n} is done. When all shards are done, run the same command without --shard (with --merge DIR for other \
             folders)"
        ));
        return Ok(());
    }
    let rows: Vec<&[f64]> = mine.iter().filter_map(|row| rows.get(*row)).collect();
    let found = Report::new(&tolerance, &production, &rows);
    let names = interrupt::uninterrupted(|| {
        output::remove(&folder, |name| {
            name.starts_with("tolerance_") && (name.ends_with(".svg") || name.ends_with(".png"))
        })?;
        let mut names = Vec::new();
        for (name, bytes) in tolerance_tables(&tolerance, &production, &rows, &found)? {
            write_file(&folder.join(name), |out| out.write_all(&bytes))?;
            names.push(name.to_owned());
        }
        let drawn = tolerance_figures(&title, &tolerance, &production, &rows, &found);
        names.extend(output::write_figures(&folder, drawn, arguments.png)?);
        Ok::<_, Failure>(names)
    })?;
    let mut stdout = crate::terminal::output(arguments.json);
    if arguments.json {
        write_json(&mut stdout, &found)?;
    } else {
        stdout
            .write_all(report::tolerance_report(&title, &production, &tolerance.keys, &found).as_bytes())?;
    }
    stdout.flush()?;
    output::print_written(&folder, &names);
    Ok(())
}

/// True if all numbers of a row are known.
fn is_known(production: &Production, rows: &JournalRows<ToleranceHead>, row: usize) -> bool {
    rows.get(row).is_some_and(|values| values.len() >= production.width(row))
}

/// Computes the missing rows and saves them. Returns their number; ends early if interrupted.
fn compute(
    production: &Production,
    mine: &[usize],
    rows: &mut JournalRows<ToleranceHead>,
    threads: Option<u16>,
) -> Result<usize, Failure> {
    let missing: Vec<usize> = mine.iter().copied().filter(|row| !is_known(production, rows, *row)).collect();
    let mut computed = 0;
    let worker = |_| {
        let mut evaluator = Evaluator::new(production.study().clone(), &interrupt::STOP);
        move |row: usize| match production.evaluate(&mut evaluator, row) {
            Ok(values) => Ok(Some((row, values))),
            Err(DesignError::Display(DisplayError::Interrupted)) => Ok(None),
            Err(error) => Err(Failure::of_one(error, &format!("in sample {row}"))),
        }
    };
    compute_parallel(&missing, "samples", threads, worker, |(row, values)| {
        computed += 1;
        rows.add(row, values)?;
        Ok(true)
    })?;
    Ok(computed)
}
