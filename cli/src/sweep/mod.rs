//! `papilio sweep`: a scenario at every point of its `[sweep]`; stopped and gone on with at will.
//!
//! Each point is computed as `papilio run` computes it, on one thread, and many points at once; so a point's
//! numbers do not depend on which were computed before, and a sweep that was killed and gone on with ends in the
//! same bytes as one that was not. What is done is in the journal at once.

mod draw;
mod journal;

use std::collections::{BTreeMap, HashSet};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc;
use std::time::Instant;

use indicatif::{ProgressBar, ProgressStyle};
use papilio_display::{Control, DisplayError};
use papilio_formats::{SweepHead, SweepPoint, sweep_parquet, sweep_value, write_file, write_sweep_csv};
use papilio_scenario::Sweep;

use self::journal::Journal;
use crate::arguments::{Sweep as Command, SweepCommand, SweepMerge, SweepRun, default_out};
use crate::{Failure, interrupt, output, report, say};

/// Points whose scenario is looked at before any is computed.
const MOST_SAMPLES: usize = 1000;

/// More points are not listed on the terminal.
const MOST_LISTED: usize = 40;

pub(crate) fn sweep(command: &Command) -> Result<(), Failure> {
    match (&command.command, &command.run) {
        (Some(SweepCommand::Merge(merge)), _) => self::merge(merge),
        (None, Some(run)) => self::run(run),
        // Clap asks for the scenario before this can be.
        (None, None) => Err(Failure::Input("a scenario is needed".to_owned())),
    }
}

fn run(arguments: &SweepRun) -> Result<(), Failure> {
    let sweep = Sweep::load(&arguments.file, &arguments.set)?;
    for point in sweep.samples().into_iter().take(MOST_SAMPLES) {
        sweep.scenario(point)?.resolve()?;
    }
    let folder = arguments.out.clone().unwrap_or_else(|| default_out(&arguments.file));
    output::check(&folder)?;
    output::make_folder(&folder)?;
    let head = sweep.head(env!("CARGO_PKG_VERSION"), &report::file_title(&arguments.file));
    let mut journal = Journal::open(&folder, &journal::name(arguments.shard), head.clone())?;
    let (k, n) = arguments.shard.unwrap_or((1, 1));
    let mine: Vec<usize> = (0..sweep.len()).filter(|point| point % n == k - 1).collect();
    let started = Instant::now();
    let done = compute(&sweep, &head, &mine, &mut journal, arguments.threads)?;
    let computed = done.values().filter(|done| done.computed).count();
    let points: Vec<(usize, String)> = done.into_iter().map(|(point, done)| (point, done.hash)).collect();
    if points.len() < mine.len() {
        say(&format!("{} of {} points are done and kept", points.len(), mine.len()));
        return Err(Failure::Interrupted("the same command goes on from here"));
    }
    let known: Vec<SweepPoint> = points.iter().filter_map(|(_, hash)| journal.find(hash).cloned()).collect();
    interrupt::whole(|| journal.finish(&points))?;
    let seconds = started.elapsed().as_secs_f64();
    let title = head.title.clone().unwrap_or_default();
    say(&format!("{}: {} points, {computed} computed in {seconds:.2} s", report::plain(&title), mine.len()));
    if arguments.shard.is_some() {
        say(&format!("part {k} of {n} is done; when all are: papilio sweep merge {}", folder.display()));
        return Ok(());
    }
    let refs: Vec<&SweepPoint> = known.iter().collect();
    finish(&folder, &head, &refs, Also { png: arguments.png, parquet: arguments.parquet })
}

/// Joins the journals of parts into the sweep's table and figures.
fn merge(arguments: &SweepMerge) -> Result<(), Failure> {
    let mut head: Option<(PathBuf, SweepHead)> = None;
    let mut points: BTreeMap<usize, SweepPoint> = BTreeMap::new();
    for folder in &arguments.folders {
        for (path, journal) in journal::read_all(folder)? {
            let Some(own) = journal.head else { continue };
            match &head {
                Some((first, head)) if *head != own => {
                    return Err(Failure::Input(format!(
                        "{} and {} are of two sweeps\n  = help: give the folders of one sweep's parts",
                        first.display(),
                        path.display()
                    )));
                }
                Some(_) => {}
                None => head = Some((path, own)),
            }
            points.extend(journal.points.into_iter().filter_map(|point| Some((point.point?, point))));
        }
    }
    let folders = arguments.folders.iter().map(|folder| folder.display().to_string()).collect::<Vec<_>>();
    let Some((_, head)) = head else {
        return Err(Failure::Input(format!("there is no journal of a sweep in {}", folders.join(", "))));
    };
    let missing: Vec<usize> = (0..head.points()).filter(|point| !points.contains_key(point)).collect();
    if !missing.is_empty() {
        return Err(Failure::Input(format!(
            "{} of {} points are not done: {}\n  = help: run the parts that they belong to (part K of N has points K-1, K-1+N, ...)",
            missing.len(),
            head.points(),
            ranges(&missing)
        )));
    }
    let out = arguments.out.as_ref().unwrap_or(&arguments.folders[0]);
    output::check(out)?;
    output::make_folder(out)?;
    let points: Vec<&SweepPoint> = (0..head.points()).filter_map(|point| points.get(&point)).collect();
    finish(out, &head, &points, Also { png: arguments.png, parquet: arguments.parquet })
}

/// What is written besides the table and its figures as SVG.
#[derive(Debug, Clone, Copy)]
struct Also {
    png: bool,
    parquet: bool,
}

/// The table, the figures, and what the terminal shows of them.
fn finish(folder: &Path, head: &SweepHead, points: &[&SweepPoint], also: Also) -> Result<(), Failure> {
    let names = interrupt::whole(|| -> Result<Vec<String>, Failure> {
        write_file(&folder.join("sweep.csv"), |out| write_sweep_csv(out, head, points))?;
        let mut names = vec!["sweep.csv".to_owned()];
        if also.parquet {
            let bytes = sweep_parquet(head, points)?;
            write_file(&folder.join("sweep.parquet"), |out| out.write_all(&bytes))?;
            names.push("sweep.parquet".to_owned());
        }
        names.extend(draw::figures(folder, head, points, also.png)?);
        Ok(names)
    })?;
    let mut stdout = anstream::stdout().lock();
    stdout.write_all(listed(head, points).as_bytes())?;
    stdout.flush()?;
    output::announce(folder, &names);
    let mut warnings: BTreeMap<&str, usize> = BTreeMap::new();
    points.iter().flat_map(|point| &point.warnings).for_each(|text| *warnings.entry(text).or_default() += 1);
    for (warning, count) in warnings {
        say(&format!("warning: at {count} of {} points: {warning}", points.len()));
    }
    Ok(())
}

/// A line for each point: what is swept, and the metrics that are drawn.
fn listed(head: &SweepHead, points: &[&SweepPoint]) -> String {
    let keys = head.axes.iter().flat_map(|axis| &axis.keys).map(|key| draw::short(head, key));
    let mut rows: Vec<Vec<String>> = vec![keys.chain(head.figures.iter().cloned()).collect()];
    for (number, point) in points.iter().enumerate().take(MOST_LISTED) {
        let swept = head.swept(number).map(|(_, value)| sweep_value(value));
        let metrics = head.figures.iter().map(|name| match point.metric(name) {
            Some(value) => format!("{value:.5}"),
            None => "-".to_owned(),
        });
        rows.push(swept.chain(metrics).collect());
    }
    let more = points.len().saturating_sub(MOST_LISTED);
    let rest = if more > 0 { format!("  ... and {more} more points in sweep.csv\n") } else { String::new() };
    report::table(&rows) + &rest
}

/// A point that is done.
struct Done {
    hash: String,
    /// Now, not earlier.
    computed: bool,
}

/// What a worker found at a point; without a result if that is known.
type Found = Result<(usize, String, Option<SweepPoint>), Failure>;

/// Computes what is not known yet, and keeps it; ends early if interrupted. The points that are done, by number.
fn compute(
    sweep: &Sweep,
    head: &SweepHead,
    points: &[usize],
    journal: &mut Journal,
    threads: Option<u16>,
) -> Result<BTreeMap<usize, Done>, Failure> {
    interrupt::heed();
    let threads =
        threads.map_or_else(|| std::thread::available_parallelism().map_or(1, usize::from), usize::from);
    let workers = threads.min(points.len()).max(1);
    let (next, stop) = (AtomicUsize::new(0), AtomicBool::new(false));
    let known = journal.hashes();
    let bar = progress_bar(points.len());
    let (sender, receiver) = mpsc::channel::<Found>();
    let (mut done, mut failure) = (BTreeMap::new(), None);
    std::thread::scope(|scope| {
        for _ in 0..workers {
            let sender = sender.clone();
            let (next, stop, known) = (&next, &stop, &known);
            scope.spawn(move || {
                while !stop.load(Ordering::Relaxed) && !interrupt::STOP.load(Ordering::Relaxed) {
                    let Some(&point) = points.get(next.fetch_add(1, Ordering::Relaxed)) else { break };
                    match at(sweep, head, point, known, threads / workers) {
                        Ok(None) => break,
                        Ok(Some(found)) => drop(sender.send(Ok(found))),
                        Err(failure) => drop(sender.send(Err(failure))),
                    }
                }
            });
        }
        drop(sender);
        for found in receiver {
            let kept = found.and_then(|found| keep(found, sweep, journal, &mut done));
            match kept {
                Ok(()) => bar.inc(1),
                Err(error) => {
                    stop.store(true, Ordering::Relaxed);
                    failure.get_or_insert(error);
                }
            }
        }
    });
    bar.finish_and_clear();
    failure.map_or(Ok(done), Err)
}

/// Computes a point unless it is known; `None` if interrupted.
fn at(
    sweep: &Sweep,
    head: &SweepHead,
    point: usize,
    known: &HashSet<String>,
    threads: usize,
) -> Result<Option<(usize, String, Option<SweepPoint>)>, Failure> {
    let resolved = sweep.scenario(point).and_then(|scenario| scenario.resolve());
    let resolved = resolved.map_err(|errors| failed_at(head, point, &errors))?;
    if known.contains(&resolved.hash) {
        return Ok(Some((point, resolved.hash, None)));
    }
    let control = Control { threads: Some(threads), progress: &|_| {}, stop: &interrupt::STOP };
    match papilio_display::run(&resolved.scene, &control) {
        Ok(result) if result.solver.interrupted => Ok(None),
        Ok(mut result) => {
            result.warnings.splice(0..0, resolved.warnings);
            let kept = SweepPoint::new(point, resolved.hash.clone(), env!("CARGO_PKG_VERSION"), &result);
            Ok(Some((point, resolved.hash, Some(kept))))
        }
        Err(DisplayError::Interrupted) => Ok(None),
        Err(error) => Err(failed_at(head, point, &error)),
    }
}

/// What is wrong at a point, and which point that is.
fn failed_at(head: &SweepHead, point: usize, error: &dyn std::fmt::Display) -> Failure {
    let (error, swept) = (error.to_string(), head.swept(point));
    let swept: Vec<String> = swept.map(|(key, value)| format!("{key} = {}", sweep_value(value))).collect();
    let said = error.strip_prefix("error: ").unwrap_or(&error);
    Failure::Input(format!("{said}\n  = note: at {}", swept.join(", ")))
}

/// Keeps what was found. The first point also tells whether there is what is to be drawn.
fn keep(
    (point, hash, result): (usize, String, Option<SweepPoint>),
    sweep: &Sweep,
    journal: &mut Journal,
    done: &mut BTreeMap<usize, Done>,
) -> Result<(), Failure> {
    let computed = result.is_some();
    if let Some(result) = result {
        journal.add(result)?;
    }
    if done.is_empty()
        && let Some(first) = journal.find(&hash)
    {
        sweep.check_figures(&first.metrics())?;
    }
    done.insert(point, Done { hash, computed });
    Ok(())
}

fn progress_bar(points: usize) -> ProgressBar {
    let bar = ProgressBar::new(points as u64);
    if let Ok(style) =
        ProgressStyle::with_template("  {bar:30} {pos} of {len} points  {elapsed}, {eta} to go")
    {
        bar.set_style(style);
    }
    bar
}

/// `0-3, 7, 9-10`; the first few.
fn ranges(numbers: &[usize]) -> String {
    const MOST: usize = 12;
    let mut ranges: Vec<(usize, usize)> = Vec::new();
    for &number in numbers {
        match ranges.last_mut() {
            Some((_, last)) if *last + 1 == number => *last = number,
            _ => ranges.push((number, number)),
        }
    }
    let text =
        |(from, to): &(usize, usize)| if from == to { from.to_string() } else { format!("{from}-{to}") };
    let shown: Vec<String> = ranges.iter().take(MOST).map(text).collect();
    shown.join(", ") + if ranges.len() > MOST { ", ..." } else { "" }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn missing_points_are_named_in_ranges() {
        assert_eq!(ranges(&[0, 1, 2, 5, 7, 8]), "0-2, 5, 7-8");
    }
}
