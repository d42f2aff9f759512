//! Every block of code of the documentation: commands, scenarios and outputs are run and compared, so that no
//! page says what the program does not do. docs/writing.md describes how the language of a block and the
//! comments above it decide what is tested.
//!
//! `cargo xtask test` checks the arguments of commands that take long; `cargo xtask full` runs them, with the
//! program that [`PROGRAM`] names. Blocks in Python are tested by `python/tests/test_docs.py`.

mod commands;
mod markdown;
mod output;
mod page;
mod scenarios;

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::Duration;

use commands::Shell;
use page::Page;

/// If this variable is set, commands that take long are run, too.
const ALL: &str = "PAPILIO_DOCS_ALL";
/// Path of the program to run, instead of that of the tests.
const PROGRAM: &str = "PAPILIO_DOCS_PROGRAM";
/// Page to test; otherwise all.
const PAGE: &str = "PAPILIO_DOCS_PAGE";
/// Folders of the repository that are beside every page.
const SHIPPED: [&str; 2] = ["scenarios", "surfaces"];

/// Numbers of blocks and commands by what became of them.
type Counts = BTreeMap<&'static str, usize>;

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize().unwrap()
}

/// Paths of all pages from the top of the repository: those at the top without the changelog, and those in
/// docs/.
fn pages() -> Vec<String> {
    fn of(folder: &Path, within: &str, deep: bool, pages: &mut Vec<String>) {
        for entry in fs::read_dir(folder).unwrap().flatten() {
            let name = format!("{within}{}", entry.file_name().to_string_lossy());
            if deep && entry.path().is_dir() {
                of(&entry.path(), &format!("{name}/"), deep, pages);
            } else if name.ends_with(".md") && name != "CHANGELOG.md" {
                pages.push(name);
            }
        }
    }
    let mut pages = Vec::new();
    of(&repository(), "", false, &mut pages);
    of(&repository().join("docs"), "docs/", true, &mut pages);
    pages.sort();
    pages
}

/// Makes a folder like another one: its files by `copy`.
fn make(from: &Path, to: &Path, copy: fn(PathBuf, PathBuf) -> io::Result<()>) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap().flatten() {
        let target = to.join(entry.file_name());
        if entry.path().is_dir() {
            make(&entry.path(), &target, copy)
        } else {
            copy(entry.path(), target).unwrap();
        }
    }
}

/// Tests a page beside the folders that `shipped` has; returns its numbers of blocks, the times of its
/// commands, and all mistakes.
fn test_page(name: &str, shipped: &Path) -> (Counts, Vec<(Duration, String)>, Vec<String>) {
    let text = fs::read_to_string(repository().join(name)).unwrap();
    let blocks = match markdown::blocks(&text) {
        Ok(blocks) => blocks,
        Err(error) => return (Counts::new(), Vec::new(), vec![format!("{name}, {error}")]),
    };
    let folder = tempfile::tempdir().unwrap();
    if !blocks.is_empty() {
        SHIPPED.iter().for_each(|part| make(&shipped.join(part), &folder.path().join(part), fs::hard_link));
    }
    let program =
        std::env::var_os(PROGRAM).map_or_else(|| PathBuf::from(env!("CARGO_BIN_EXE_papilio")), PathBuf::from);
    let program = repository().join(program);
    let runs_long = std::env::var_os(ALL).is_some();
    let shell = Shell { folder: folder.path(), program: program.parent().unwrap(), runs_long };
    let mut page = Page { name, shell, outputs: Vec::new(), counts: Counts::new(), times: Vec::new() };
    let mut wrong = Vec::new();
    for block in &blocks {
        if let Err(error) = page.test(block) {
            wrong.push(format!("{name}:{}: {error}", block.line));
        }
    }
    (page.counts, page.times, wrong)
}

/// Every file of a folder and the folders in it, with its content.
fn contents(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut all = BTreeMap::new();
    for entry in fs::read_dir(folder).unwrap().flatten() {
        match entry.path() {
            path if path.is_dir() => all.extend(contents(&path)),
            path => _ = all.insert(path.clone(), fs::read(path).unwrap()),
        }
    }
    all
}

/// All blocks of all pages, by two threads.
#[test]
fn blocks_of_the_documentation_run_and_their_outputs_are_those_shown() {
    let one = std::env::var(PAGE).ok();
    let left = Mutex::new(one.clone().map_or_else(pages, |page| vec![page]));
    let found = Mutex::new((Counts::new(), Vec::new(), Vec::new()));
    // One copy for all pages: seven thousand files take seconds.
    let shipped = tempfile::tempdir().unwrap();
    let shipped = shipped.path();
    let copy = |from, to| fs::copy(from, to).map(drop);
    SHIPPED.iter().for_each(|part| make(&repository().join(part), &shipped.join(part), copy));
    let before = contents(shipped);
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                loop {
                    let Some(page) = left.lock().unwrap().pop() else { break };
                    let (counts, times, wrong) = test_page(&page, shipped);
                    let mut all = found.lock().unwrap();
                    counts.into_iter().for_each(|(what, count)| *all.0.entry(what).or_default() += count);
                    all.1.extend(times);
                    all.2.extend(wrong);
                }
            });
        }
    });
    let is_changed = |(path, bytes): &(&PathBuf, &Vec<u8>)| fs::read(path).ok().as_ref() != Some(*bytes);
    let changed: Vec<&PathBuf> = before.iter().filter(is_changed).map(|(path, _)| path).collect();
    assert!(changed.is_empty(), "pages change files that others read: {changed:?}");
    let (counts, mut times, wrong) = found.into_inner().unwrap();
    times.sort();
    let slow = times.iter().rev().take(20).map(|(time, line)| format!("{:.1} s  {line}", time.as_secs_f64()));
    assert!(
        wrong.is_empty(),
        "{}\n\n{counts:?}\n{}",
        wrong.join("\n\n"),
        slow.collect::<Vec<_>>().join("\n")
    );
    if one.is_none() {
        for (what, least) in
            [("sh", 58), ("toml", 20), ("outputs compared", 12), ("commands run", 60), ("python", 15)]
        {
            assert!(
                counts.get(what).is_some_and(|count| *count >= least),
                "at least {least} {what}: {counts:?}"
            );
        }
        assert!(counts.get("skipped").is_none_or(|count| *count < 10), "few blocks are skipped: {counts:?}");
    }
}
