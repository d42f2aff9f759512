//! `papilio optimize`: a search for better designs, which can be interrupted and resumed.
//!
//! The result of a task depends only on the scenario and the task, and is saved in the journal immediately. A
//! resumed search therefore writes the same files as an uninterrupted one, for any number of threads.

mod check;
mod journal;
mod report;

use std::io::Write;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Instant;

use papilio_design::output::{design_texts, search_figures, search_table};
use papilio_design::search::{
    Record, Search, SearchProgress, SearchRecords, SearchResult, SearchSchedule, SelectedDesign, was_stopped,
};
use papilio_design::{DesignError, Evaluator, Study};
use papilio_formats::{LockedJournal, SearchHead, write_file};
use papilio_scenario::{Edit, Optimisation, edit};

use self::check::{SolverComparison, check};
use crate::arguments::Optimize;
use crate::progress::FractionBar;
use crate::terminal::not_in;
use crate::{Failure, costs, input, interrupt, output, print_message, print_notes, print_warnings};

/// Fraction of the progress that is the search, about; the rest is the check of its designs.
const SEARCH: f64 = 0.8;

pub(crate) fn run(arguments: &Optimize) -> Result<(), Failure> {
    let mut overrides = arguments.scenario.set.clone();
    overrides.extend(arguments.seed.map(|seed| format!("optimize.seed={seed}")));
    let optimisation = input::scenario::<Optimisation>(&arguments.scenario.file, &overrides)?;
    print_notes(&optimisation.notes);
    // Of a front, each point is a search.
    let searches = if optimisation.objectives.len() > 1 { optimisation.points } else { 1 };
    let count = (optimisation.evaluations * searches * optimisation.conditions.len().max(1)) as f64;
    let paths = optimisation.variables.iter().flat_map(|one| one.keys.iter().map(|key| key.path.as_str()));
    let own = costs::own(&arguments.scenario.file, &arguments.scenario.set)?;
    print_warnings(&not_in(&optimisation.warnings, &own.warnings));
    costs::check_evaluations(
        &own,
        (count, "designs", "optimize.evaluations, optimize.points"),
        costs::are_of_film(paths),
        0.0,
        arguments.workers.threads,
    )?;
    let folder = arguments.scenario.out.clone().unwrap_or_else(|| arguments.scenario.default_out());
    output::check(&folder)?;
    interrupt::catch_ctrl_c();
    let head =
        SearchHead { papilio: env!("CARGO_PKG_VERSION").to_owned(), search: optimisation.hash.clone() };
    let started = Instant::now();
    let mut evaluator = Evaluator::new(Arc::new(Study::of(&optimisation)), &interrupt::STOP);
    let search = Arc::new(or_interrupted(Search::new(optimisation, &mut evaluator))?);
    arguments.shard.map_or(Ok(()), |shard| check_shard(shard, &search))?;
    output::make_folder(&folder)?;
    let (mut journal, records) = journal::open(&folder, arguments.shard, &head, &arguments.merge)?;
    let threads = arguments
        .workers
        .threads
        .map_or_else(|| std::thread::available_parallelism().map_or(1, usize::from), usize::from);
    let mut schedule = match arguments.shard {
        Some(shard) => SearchSchedule::shard(Arc::clone(&search), records, threads, shard),
        None => SearchSchedule::new(Arc::clone(&search), records, threads),
    };
    let bar = FractionBar::new();
    let new = run_schedule(&mut schedule, &evaluator, threads, &mut journal, &bar)?;
    let found = schedule.results();
    let seconds = started.elapsed().as_secs_f64();
    let all = report::evaluations(&found);
    let now = if new < all { format!(", {new} of them now,") } else { String::new() };
    let evaluated = format!("{all} designs evaluated{now} in {seconds:.2} s");
    if let Some((k, n)) = arguments.shard {
        interrupt::uninterrupted(|| journal.put(&head, found.iter()))?;
        drop(bar);
        print_message(&evaluated);
        print_message(&format!(
            "shard {k} of {n} is done. When all shards are done, run the same command without --shard (with --merge DIR for other \
             folders)"
        ));
        return Ok(());
    }
    let chosen = or_interrupted(search.selected(&found, &mut evaluator))?;
    bar.print(&evaluated);
    let (stopped, descents) = search.cut_short(&found);
    if stopped > 0 {
        bar.print(&format!(
            "note: {stopped} of {descents} gradient searches stopped because their part of `evaluations` ({}) was used up\n  = help: increase \
             optimize.evaluations to let them converge",
            search.spec().evaluations
        ));
    }
    let comparison = match arguments.no_check {
        true => {
            drop(bar);
            Vec::new()
        }
        false => check(&search, &chosen, arguments.workers.threads, bar)?.ok_or(INTERRUPTED)?,
    };
    interrupt::uninterrupted(|| journal.put(&head, found.iter()))?;
    finish(arguments, &folder, &search, &found, &chosen, &comparison)
}

/// Runs a search to its end, and writes each record to the journal. Returns the number of evaluated designs.
fn run_schedule(
    schedule: &mut SearchSchedule,
    evaluator: &Evaluator<'_>,
    threads: usize,
    journal: &mut LockedJournal,
    bar: &FractionBar,
) -> Result<usize, Failure> {
    let mut new = 0;
    let words = |now: &SearchProgress| format!("{} of {} searches", now.done, now.of);
    let first = schedule.progress();
    bar.advance(SEARCH * first.fraction, words(&first));
    let counter = evaluator.evaluated();
    let log = bar.in_log(move || format!("{} designs", counter.load(Ordering::Relaxed)));
    let mut store = |record: &Record, now: SearchProgress| {
        if let Record::Task(found) = record {
            new += found.evaluations;
        }
        bar.advance(SEARCH * now.fraction, words(&now));
        journal.add(record).map_err(Failure::from)
    };
    let result = schedule.run(evaluator, threads, &mut store);
    drop(log);
    result.map_err(|failure| match failure {
        Failure::Design(error) => or_interrupted::<()>(Err(error)).err().unwrap_or(INTERRUPTED),
        other => other,
    })?;
    Ok(new)
}

/// Fails if a shard has no work.
fn check_shard((k, n): (usize, usize), search: &Arc<Search>) -> Result<(), Failure> {
    let tasks = SearchSchedule::new(Arc::clone(search), SearchRecords::default(), 1).progress().of;
    if k <= tasks {
        return Ok(());
    }
    Err(Failure::Input(format!(
        "shard {k} of {n} has no work: the first round of this search has {tasks} {}\n  = help: use at most this number of \
         shards (a task is a start for a combination of choices, or the population of an objective)",
        if tasks == 1 { "task" } else { "tasks" }
    )))
}

const INTERRUPTED: Failure =
    Failure::Interrupted("finished work is saved; run the same command again to resume");

/// Maps the error of an interrupted search to [`INTERRUPTED`].
fn or_interrupted<T>(result: Result<T, DesignError>) -> Result<T, Failure> {
    result.map_err(|error| if was_stopped(&error) { INTERRUPTED } else { error.into() })
}

/// Writes the files, and prints the result.
fn finish(
    arguments: &Optimize,
    folder: &Path,
    search: &Search,
    found: &[SearchResult],
    chosen: &[SelectedDesign],
    comparison: &[SolverComparison],
) -> Result<(), Failure> {
    let title =
        search.spec().title.clone().unwrap_or_else(|| crate::report::file_title(&arguments.scenario.file));
    let names = interrupt::uninterrupted(|| write(arguments, folder, &title, search, found, chosen))?;
    let is_feasible = chosen.iter().any(SelectedDesign::meets_limits);
    let mut stdout = crate::terminal::output(arguments.json);
    if arguments.json {
        let all = report::json(&title, search, chosen, found, comparison);
        serde_json::to_writer_pretty(&mut stdout, &all).map_err(std::io::Error::from)?;
        stdout.write_all(b"\n")?;
    } else {
        stdout.write_all(report::text(&title, search, chosen).as_bytes())?;
        stdout.write_all(report::comparison(&chosen_as(is_feasible, chosen), comparison).as_bytes())?;
    }
    stdout.flush()?;
    output::print_written(folder, &names);
    if chosen.is_empty() {
        return Err(Failure::Infeasible("no design could be evaluated, because its metrics are undefined"));
    }
    if !is_feasible {
        return Err(Failure::Infeasible(
            "no feasible design was found; closest.toml contains the design with the smallest violation of the constraints",
        ));
    }
    Ok(())
}

/// The selected designs in words.
fn chosen_as(is_feasible: bool, chosen: &[SelectedDesign]) -> String {
    match (is_feasible, chosen.len()) {
        (true, 0 | 1) => "the best design".to_owned(),
        (true, several) => format!("the {several} designs of the front"),
        (false, _) => "the nearest design".to_owned(),
    }
}

fn write(
    arguments: &Optimize,
    folder: &Path,
    title: &str,
    search: &Search,
    found: &[SearchResult],
    chosen: &[SelectedDesign],
) -> Result<Vec<String>, Failure> {
    let mut names = vec!["optimize.csv".to_owned()];
    write_file(&folder.join("optimize.csv"), |out| out.write_all(search_table(search, found).as_bytes()))?;
    output::remove(folder, |name| {
        ["best.toml", "closest.toml"].contains(&name) || name.starts_with("front")
    })?;
    for (name, text) in designs(arguments, folder, search, chosen)? {
        write_file(&folder.join(&name), |out| out.write_all(text.as_bytes()))?;
        names.push(name);
    }
    let drawn = search_figures(title, search, found, chosen);
    names.extend(output::write_figures(folder, drawn, arguments.png)?);
    Ok(names)
}

/// Names and texts of the scenario files of the designs.
fn designs(
    arguments: &Optimize,
    folder: &Path,
    search: &Search,
    chosen: &[SelectedDesign],
) -> Result<Vec<(String, String)>, Failure> {
    let path = &arguments.scenario.file;
    let file = input::file(path)?;
    let from = path.parent().unwrap_or(Path::new(""));
    let set: Vec<Edit> =
        arguments.scenario.set.iter().filter_map(|text| Edit::of_set_in(text, from)).collect();
    let text = edit(file.text().map_err(Failure::Data)?, &set)?;
    let folders = [from, folder];
    Ok(design_texts(&text, folders, search, chosen)?)
}
