//! Compact sweeps: they store only a few metrics of each point, about 80 bytes, for sweeps of 100 000 points
//! and more.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

use papilio_design::{DesignError, Evaluator, LightStudy};
use papilio_display::DisplayError;
use papilio_figures::of_sweep;
use papilio_formats::{
    JournalRow, LightHead, RowsHead, SweepHead, light_columns, light_parquet, light_points, write_file,
    write_light_csv, write_light_json,
};
use papilio_scenario::{LightSweep, Sweep, label};

use super::compute::failed_at;
use super::{merge, no_column, table};
use crate::arguments::{SweepMerge, SweepOutputs, SweepRun};
use crate::journal;
use crate::parallel::compute_parallel;
use crate::{Failure, interrupt, output, print_message, report};

/// Names of journals begin with this.
pub(super) const STEM: &str = "sweep-light";

/// Computes the missing points, and writes the table and figures of all points.
pub(super) fn run(
    arguments: &SweepRun,
    outputs: &SweepOutputs,
    sweep: &Sweep,
    (light, warnings): (LightSweep, &[String]),
    folder: &Path,
) -> Result<(), Failure> {
    let mut head = sweep.head(env!("CARGO_PKG_VERSION"), &report::file_title(&arguments.file));
    let (views, hash) = (light.views.clone(), light.hash.clone());
    let study = LightStudy::new(light);
    head.light = Some(LightHead { metrics: study.columns(), views, hash });
    let mut rows = journal::open_rows(folder, STEM, arguments.shard, head.clone(), &[])?;
    let (k, n) = arguments.shard.unwrap_or((1, 1));
    let mine: Vec<usize> = (0..sweep.len()).filter(|point| point % n == k - 1).collect();
    let missing: Vec<usize> = mine.iter().copied().filter(|point| rows.get(*point).is_none()).collect();
    let started = Instant::now();
    let worker = |_| {
        let (study, head) = (&study, &head);
        let mut evaluator = Evaluator::new(study.study().clone(), &interrupt::STOP);
        move |point: usize| match study.evaluate(&mut evaluator, point) {
            Ok(values) => Ok(Some((point, values))),
            Err(DesignError::Display(DisplayError::Interrupted)) => Ok(None),
            Err(error) => Err(failed_at(head, point, error)),
        }
    };
    compute_parallel(&missing, "points", arguments.threads, worker, |(point, values)| {
        rows.add(point, values)?;
        Ok(true)
    })?;
    let left = mine.iter().filter(|point| rows.get(**point).is_none()).count();
    if left > 0 {
        print_message(&format!("{} of {} points are finished and saved", mine.len() - left, mine.len()));
        return Err(Failure::Interrupted("run the same command again to resume"));
    }
    interrupt::uninterrupted(|| rows.finish(mine.iter().copied()))?;
    let seconds = started.elapsed().as_secs_f64();
    let title = report::plain(&head.title.clone().unwrap_or_default());
    print_message(&format!("{title}: {} points, {} computed in {seconds:.2} s", mine.len(), missing.len()));
    if arguments.shard.is_some() {
        print_message(&format!(
            "shard {k} of {n} is done. When all shards are done, run: papilio sweep merge {}",
            folder.display()
        ));
        return Ok(());
    }
    let all: Vec<&[f64]> = mine.iter().filter_map(|point| rows.get(*point)).collect();
    finish(folder, &head, [sweep.notes(), warnings], &all, outputs)
}

/// Merges the journals of shards; false if the folders contain no journal of a compact sweep.
pub(super) fn merged(arguments: &SweepMerge) -> Result<bool, Failure> {
    let mut head: Option<(PathBuf, SweepHead)> = None;
    let mut rows: BTreeMap<usize, Vec<f64>> = BTreeMap::new();
    for folder in &arguments.folders {
        for (path, journal) in journal::read_all::<SweepHead, JournalRow>(folder, STEM, |_| true)? {
            merge::one_sweep(&mut head, &path, journal.head, |a, b| a.is_of(b))?;
            rows.extend(journal.lines.into_iter().map(JournalRow::into_numbers));
        }
    }
    let Some((_, head)) = head else { return Ok(false) };
    merge::complete(head.points(), |point| rows.contains_key(&point))?;
    let all: Vec<&[f64]> = rows.values().map(Vec::as_slice).collect();
    let out = merge::folder(arguments)?;
    finish(out, &head, [&[]; 2], &all, &arguments.outputs).map(|()| true)
}

/// Writes the table and figures, and prints the report.
fn finish(
    folder: &Path,
    head: &SweepHead,
    said: [&[String]; 2],
    rows: &[&[f64]],
    outputs: &SweepOutputs,
) -> Result<(), Failure> {
    let chosen = match outputs.columns.as_slice() {
        [] => None,
        columns => Some(light_columns(head, rows, columns).map_err(|wrong| no_column(&wrong))?),
    };
    let (table_head, table_rows) = match &chosen {
        None => (head, rows.to_vec()),
        Some((head, rows)) => (head, rows.iter().map(Vec::as_slice).collect()),
    };
    // Figures show the last two axes, with the first values of the other axes.
    let drawn: usize = head.axes.iter().rev().take(2).map(|axis| axis.values.len()).product();
    let first = light_points(head, &rows[..rows.len().min(drawn.max(table::MOST_ROWS))]);
    let refs: Vec<_> = first.iter().collect();
    let names = interrupt::uninterrupted(|| -> Result<Vec<String>, Failure> {
        output::remove(folder, super::is_of_a_sweep)?;
        write_file(&folder.join("sweep.csv"), |out| write_light_csv(out, table_head, &table_rows))?;
        let mut names = vec!["sweep.csv".to_owned()];
        if outputs.parquet {
            let bytes = light_parquet(table_head, &table_rows)?;
            write_file(&folder.join("sweep.parquet"), |out| out.write_all(&bytes))?;
            names.push("sweep.parquet".to_owned());
        }
        let svgs = of_sweep(head, &refs[..refs.len().min(drawn)], &label);
        names.extend(output::write_figures(folder, svgs, outputs.png)?);
        Ok(names)
    })?;
    let mut stdout = crate::terminal::output(outputs.json);
    if outputs.json {
        write_light_json(&mut stdout, head, said, rows)?;
    } else {
        stdout.write_all(table::sweep_table(head, &refs, rows.len()).as_bytes())?;
    }
    stdout.flush()?;
    output::print_written(folder, &names);
    Ok(())
}
