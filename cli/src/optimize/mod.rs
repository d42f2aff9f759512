//! `papilio optimize`: a search for better designs; stopped and gone on with at will.
//!
//! What a task of the search finds depends on nothing but the scenario and the task, and is in the journal at once:
//! a search that was killed and gone on with ends in the same files as one that was not, whatever the number of threads.

mod check;
mod journal;
mod report;

use std::io::Write;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Instant;

use papilio_design::search::{Chosen, Course, Found, Kept, Record, Search, was_stopped};
use papilio_design::{DesignError, Evaluator, Study};
use papilio_findings::{design_texts, search_figures, search_table};
use papilio_formats::{DataFile, HeldJournal, SearchHead, write_file};
use papilio_scenario::{Edit, Optimisation, edit};

use self::check::{Checked, check};
use crate::arguments::Optimize;
use crate::progress::{self, in_log};
use crate::{Failure, interrupt, output, say};

pub(crate) fn run(arguments: &Optimize) -> Result<(), Failure> {
    let mut overrides = arguments.scenario.set.clone();
    overrides.extend(arguments.seed.map(|seed| format!("optimize.seed={seed}")));
    let said = Optimisation::load(&arguments.scenario.file, &overrides)?;
    let folder = arguments.scenario.out.clone().unwrap_or_else(|| arguments.scenario.default_out());
    output::check(&folder)?;
    interrupt::heed();
    let head = SearchHead { papilio: env!("CARGO_PKG_VERSION").to_owned(), search: said.hash.clone() };
    let started = Instant::now();
    let mut evaluator = Evaluator::new(Arc::new(Study::of(&said)), &interrupt::STOP);
    let search = Arc::new(stopped(Search::new(said, &mut evaluator))?);
    arguments.shard.map_or(Ok(()), |part| check_part(part, &search))?;
    output::make_folder(&folder)?;
    let (mut journal, kept) = journal::open(&folder, arguments.shard, &head, &arguments.merge)?;
    let threads = arguments
        .workers
        .threads
        .map_or_else(|| std::thread::available_parallelism().map_or(1, usize::from), usize::from);
    let mut course = match arguments.shard {
        Some(part) => Course::part(Arc::clone(&search), kept, threads, part),
        None => Course::new(Arc::clone(&search), kept, threads),
    };
    let new = go(&mut course, &evaluator, threads, &mut journal)?;
    let found = course.found();
    let seconds = started.elapsed().as_secs_f64();
    let all = report::evaluations(&found);
    let of_them = if new < all { format!(", {new} of them now,") } else { String::new() };
    let evaluated = format!("{all} designs were evaluated{of_them} in {seconds:.2} s");
    if let Some((k, n)) = arguments.shard {
        interrupt::whole(|| journal.put(&head, found.iter()))?;
        say(&evaluated);
        say(&format!(
            "part {k} of {n} is done; when all are: the same command without --shard, here or with --merge DIR"
        ));
        return Ok(());
    }
    let chosen = stopped(search.chosen(&found, &mut evaluator))?;
    say(&evaluated);
    let (cut, descents) = search.cut_short(&found);
    if cut > 0 {
        say(&format!(
            "{cut} of {descents} descents used up their share of `evaluations` ({}); a larger one lets them go on",
            search.said().evaluations
        ));
    }
    let checked = match chosen.first() {
        Some(best) if !arguments.no_check => {
            check(&search, best, arguments.workers.threads)?.ok_or(INTERRUPTED)?
        }
        _ => Vec::new(),
    };
    interrupt::whole(|| journal.put(&head, found.iter()))?;
    finish(arguments, &folder, &search, &found, &chosen, &checked)
}

/// Goes to the end of a course, each record into the journal; how many designs were evaluated.
fn go(
    course: &mut Course,
    evaluator: &Evaluator<'_>,
    threads: usize,
    journal: &mut HeldJournal,
) -> Result<usize, Failure> {
    let (bar, mut new) = (progress::bar(course.progress().1, "searches"), 0);
    let counter = evaluator.evaluated();
    let log = in_log(&bar, move |bar| {
        let (done, of) = (bar.position(), bar.length().unwrap_or_default());
        format!("{done} of {of} searches, {} designs", counter.load(Ordering::Relaxed))
    });
    let mut tell = |record: &Record, (done, of): (usize, usize)| {
        if let Record::Found(found) = record {
            new += found.evaluations;
        }
        bar.set_length(of as u64);
        bar.set_position(done as u64);
        journal.add(record).map_err(Failure::from)
    };
    let ran = course.run(evaluator, threads, &mut tell);
    bar.finish_and_clear();
    drop(log);
    ran.map_err(|failure| match failure {
        Failure::Design(error) => stopped::<()>(Err(error)).err().unwrap_or(INTERRUPTED),
        other => other,
    })?;
    Ok(new)
}

/// Whether a part has something to do.
fn check_part((k, n): (usize, usize), search: &Arc<Search>) -> Result<(), Failure> {
    let (_, tasks) = Course::new(Arc::clone(search), Kept::default(), 1).progress();
    if k <= tasks {
        return Ok(());
    }
    Err(Failure::Input(format!(
        "part {k} of {n} has nothing to do: this search begins with {tasks} {}\n  = help: parts share the starts of every \
         combination of choices, or the populations of every objective",
        if tasks == 1 { "task" } else { "tasks" }
    )))
}

const INTERRUPTED: Failure = Failure::Interrupted("what is done is kept, the same command goes on from here");

/// Tells a search that was stopped from one that failed.
fn stopped<T>(result: Result<T, DesignError>) -> Result<T, Failure> {
    result.map_err(|error| if was_stopped(&error) { INTERRUPTED } else { error.into() })
}

/// Writes the files, and shows what was found.
fn finish(
    arguments: &Optimize,
    folder: &Path,
    search: &Search,
    found: &[Found],
    chosen: &[Chosen],
    checked: &[Checked],
) -> Result<(), Failure> {
    let title =
        search.said().title.clone().unwrap_or_else(|| crate::report::file_title(&arguments.scenario.file));
    let names = interrupt::whole(|| write(arguments, folder, &title, search, found, chosen))?;
    let mut stdout = crate::terminal::stdout();
    if arguments.json {
        let all = report::json(&title, search, chosen, found, checked);
        serde_json::to_writer_pretty(&mut stdout, &all).map_err(std::io::Error::from)?;
        stdout.write_all(b"\n")?;
    } else {
        stdout.write_all(report::text(&title, search, chosen).as_bytes())?;
        if !checked.is_empty() {
            let titles = ["", "adding", "walk", "standard error"].map(str::to_owned).to_vec();
            let rows: Vec<Vec<String>> =
                std::iter::once(titles).chain(checked.iter().map(Checked::row)).collect();
            write!(stdout, "\nThe best design by both solvers:\n{}", crate::report::table(&rows))?;
        }
    }
    stdout.flush()?;
    output::announce(folder, &names);
    if chosen.is_empty() {
        return Err(Failure::Infeasible(
            "no design could be evaluated: what is asked is not defined anywhere",
        ));
    }
    if !chosen.iter().any(Chosen::meets_limits) {
        return Err(Failure::Infeasible(
            "no design was found that meets all limits; closest.toml holds the one that misses them least",
        ));
    }
    Ok(())
}

fn write(
    arguments: &Optimize,
    folder: &Path,
    title: &str,
    search: &Search,
    found: &[Found],
    chosen: &[Chosen],
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

/// The scenario file with each design.
fn designs(
    arguments: &Optimize,
    folder: &Path,
    search: &Search,
    chosen: &[Chosen],
) -> Result<Vec<(String, String)>, Failure> {
    let path = &arguments.scenario.file;
    let file = DataFile::open(path, &path.display().to_string()).map_err(Failure::Data)?;
    let set: Vec<Edit> = arguments.scenario.set.iter().filter_map(|text| Edit::of_set(text)).collect();
    let text = edit(file.text().map_err(Failure::Data)?, &set)?;
    let folders = [path.parent().unwrap_or(Path::new("")), folder];
    Ok(design_texts(&text, folders, search, chosen)?)
}
