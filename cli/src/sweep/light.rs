//! Light sweeps: of every point a few metrics, so that a hundred thousand points fit on a page of memory and disk.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

use papilio_design::{DesignError, Evaluator, LightStudy};
use papilio_display::DisplayError;
use papilio_figures::of_sweep;
use papilio_formats::{
    JournalRow, LightHead, RowsHead, SweepHead, light_parquet, light_points, write_file, write_light_csv,
    write_light_json,
};
use papilio_scenario::{LightSweep, Sweep};

use super::compute::failed_at;
use super::{listed, merge};
use crate::arguments::{SweepMerge, SweepRun, SweepWanted};
use crate::journal;
use crate::side_by_side::side_by_side;
use crate::{Failure, interrupt, output, report, say};

/// Names of journals begin so.
pub(super) const STEM: &str = "sweep-light";

/// Computes the points that are not known yet, and writes what is kept of all.
pub(super) fn run(
    arguments: &SweepRun,
    wanted: SweepWanted,
    sweep: &Sweep,
    light: LightSweep,
    folder: &Path,
) -> Result<(), Failure> {
    let metrics = light.metrics.iter().map(|metric| metric.name.clone()).collect();
    let mut head = sweep.head(env!("CARGO_PKG_VERSION"), &report::file_title(&arguments.file));
    head.light = Some(LightHead { metrics, views: light.views.clone(), hash: light.hash.clone() });
    let study = LightStudy::new(light);
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
    side_by_side(&missing, "points", arguments.threads, worker, |(point, values)| {
        rows.add(point, values)?;
        Ok(true)
    })?;
    let left = mine.iter().filter(|point| rows.get(**point).is_none()).count();
    if left > 0 {
        say(&format!("{} of {} points are done and kept", mine.len() - left, mine.len()));
        return Err(Failure::Interrupted("the same command goes on from here"));
    }
    interrupt::whole(|| rows.finish(mine.iter().copied()))?;
    let seconds = started.elapsed().as_secs_f64();
    let title = report::plain(&head.title.clone().unwrap_or_default());
    say(&format!("{title}: {} points, {} computed in {seconds:.2} s", mine.len(), missing.len()));
    if arguments.shard.is_some() {
        say(&format!("part {k} of {n} is done; when all are: papilio sweep merge {}", folder.display()));
        return Ok(());
    }
    let all: Vec<&[f64]> = mine.iter().filter_map(|point| rows.get(*point)).collect();
    finish(folder, &head, &all, wanted)
}

/// Joins the journals of parts, if those in these folders are of a light sweep.
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
    finish(out, &head, &all, arguments.wanted).map(|()| true)
}

/// The table, the figures, and what the terminal shows of them.
fn finish(folder: &Path, head: &SweepHead, rows: &[&[f64]], wanted: SweepWanted) -> Result<(), Failure> {
    // Figures are of the last two axes, the others at their first values.
    let drawn: usize = head.axes.iter().rev().take(2).map(|axis| axis.values.len()).product();
    let first = light_points(head, &rows[..rows.len().min(drawn.max(listed::MOST_LISTED))]);
    let refs: Vec<_> = first.iter().collect();
    let names = interrupt::whole(|| -> Result<Vec<String>, Failure> {
        write_file(&folder.join("sweep.csv"), |out| write_light_csv(out, head, rows))?;
        let mut names = vec!["sweep.csv".to_owned()];
        if wanted.parquet {
            let bytes = light_parquet(head, rows)?;
            write_file(&folder.join("sweep.parquet"), |out| out.write_all(&bytes))?;
            names.push("sweep.parquet".to_owned());
        }
        let svgs = of_sweep(head, &refs[..refs.len().min(drawn)]);
        names.extend(output::write_figures(folder, svgs, wanted.png)?);
        Ok(names)
    })?;
    let mut stdout = crate::terminal::stdout();
    if wanted.json {
        write_light_json(&mut stdout, head, rows)?;
    } else {
        stdout.write_all(listed::listed(head, &refs, rows.len()).as_bytes())?;
    }
    stdout.flush()?;
    output::announce(folder, &names);
    Ok(())
}
