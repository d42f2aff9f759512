//! Every block of code of the documentation: commands, scenarios and outputs are run and compared, so that no page says what the program
//! does not do. docs/writing.md describes how the language of a block and the comments above it decide what is tested.
//!
//! `cargo xtask test` checks the arguments of commands that take long; `cargo xtask full` runs them, with the program that
//! [`PROGRAM`] names. Blocks in Python are tested by `python/tests/test_docs.py`.

mod commands;
mod markdown;
mod output;
mod scenarios;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use commands::{Fate, Shell, compare_output};
use markdown::{Block, Note};

/// If this variable is set, commands that take long are run, too, and the times of all commands are printed.
const ALL: &str = "PAPILIO_DOCS_ALL";
/// Path of the program to run, instead of that of the tests.
const PROGRAM: &str = "PAPILIO_DOCS_PROGRAM";
/// Page to test; otherwise all.
const PAGE: &str = "PAPILIO_DOCS_PAGE";

/// Numbers of blocks and commands by what became of them.
type Counts = BTreeMap<&'static str, usize>;

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize().unwrap()
}

/// Paths of all pages from the top of the repository: those at the top without the changelog, and those in docs/.
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

/// Copies files and folders: commands may write there.
fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap().flatten() {
        let target = to.join(entry.file_name());
        if entry.path().is_dir() {
            copy(&entry.path(), &target)
        } else {
            drop(fs::copy(entry.path(), target).unwrap())
        }
    }
}

/// The blocks of one page while they are tested, in order.
struct Page<'a> {
    name: &'a str,
    shell: Shell<'a>,
    /// The commands that were run so far, with their outputs; `None` if it was not run.
    outputs: Vec<(String, Option<Output>)>,
    counts: Counts,
    times: Vec<(Duration, String)>,
}

impl Page<'_> {
    fn count(&mut self, what: &'static str) {
        *self.counts.entry(what).or_default() += 1;
    }

    /// Tests a block.
    fn test(&mut self, block: &Block) -> Result<(), String> {
        if block.notes.iter().any(|note| matches!(note, Note::Skip(_))) {
            self.count("skipped");
            return Ok(());
        }
        let text = block.replaced()?;
        for note in &block.notes {
            match note {
                Note::File(name, content) => self.write(name, content.as_deref().unwrap_or(&text))?,
                Note::From(file) => is_excerpt(&text, file)?,
                Note::Setup(command) if block.language != "python" => {
                    let output = self.shell.run(command)?;
                    if !output.status.success() {
                        return Err(format!("{command}\n{}", String::from_utf8_lossy(&output.stderr)));
                    }
                }
                _ => {}
            }
        }
        let is_file = block.notes.iter().any(|note| matches!(note, Note::File(_, None) | Note::From(_)));
        match &*block.language {
            "sh" => self.commands(block, &text),
            "text" if !is_file => self.output(block, &text),
            "toml" => {
                self.count("toml");
                self.scenario(block, &text)
            }
            "python" => {
                self.count("python");
                Ok(())
            }
            "rust" | "csv" | "json" | "text" if is_file => {
                self.count("files and excerpts");
                Ok(())
            }
            "math" | "mermaid" => Ok(()),
            "" => Err("the block has no language".to_owned()),
            other => {
                Err(format!("the test needs a comment for a block in `{other}`: docs/writing.md lists them"))
            }
        }
    }

    fn write(&self, name: &str, content: &str) -> Result<(), String> {
        let path = self.shell.folder.join(name);
        fs::create_dir_all(path.parent().unwrap_or(self.shell.folder)).map_err(|error| error.to_string())?;
        fs::write(path, content).map_err(|error| error.to_string())
    }

    fn commands(&mut self, block: &Block, text: &str) -> Result<(), String> {
        self.count("sh");
        let is_long = block.notes.contains(&Note::Long);
        let exit =
            block.notes.iter().find_map(|note| if let Note::Exit(code) = note { Some(*code) } else { None });
        let lines = commands::lines(text);
        if lines.is_empty() {
            return Err("the block has no command".to_owned());
        }
        for line in lines {
            let start = Instant::now();
            let fate = self.shell.line(&line, is_long, exit.unwrap_or(0));
            let fate = fate.map_err(|error| format!("{}\n{error}", line.text))?;
            self.times.push((start.elapsed(), format!("{}: {}", self.name, line.text)));
            let (what, output) = match fate {
                Fate::Ran(output) => ("commands run", Some(output)),
                Fate::Parsed => ("commands parsed", None),
                Fate::Elsewhere(_) => ("commands elsewhere", None),
            };
            self.count(what);
            self.outputs.push((line.text, output));
        }
        Ok(())
    }

    fn output(&mut self, block: &Block, text: &str) -> Result<(), String> {
        let of = block
            .notes
            .iter()
            .find_map(|note| if let Note::Output(command) = note { Some(command) } else { None });
        let found = match of {
            Some(command) => self.outputs.iter().rev().find(|(line, _)| line == command),
            None => self.outputs.last(),
        };
        let (command, output) = found.ok_or("no command stands before this output")?;
        match output {
            Some(output) => {
                compare_output(text, output).map_err(|error| format!("output of {command}: {error}"))?
            }
            None if self.shell.runs_long => return Err(format!("{command} was not run")),
            None => {}
        }
        self.count("outputs");
        Ok(())
    }

    fn scenario(&self, block: &Block, text: &str) -> Result<(), String> {
        let mut base =
            block.notes.iter().filter_map(|note| if let Note::Base(file) = note { Some(file) } else { None });
        let mut files = block
            .notes
            .iter()
            .filter_map(|note| if let Note::File(file, None) = note { Some(file) } else { None });
        let base = base.next();
        let place = base.or_else(|| files.next()).map_or(Path::new(""), |file| Path::new(file));
        let read = |file: &String| {
            fs::read_to_string(self.shell.folder.join(file)).map_err(|error| format!("{file}: {error}"))
        };
        let base = base.map(read).transpose()?;
        let folder = self.shell.folder.join(place.parent().unwrap_or(Path::new("")));
        scenarios::resolve(text, base.as_deref(), &folder)
    }
}

/// Fails unless the lines of `text` stand in a file of the repository, in this order.
fn is_excerpt(text: &str, file: &str) -> Result<(), String> {
    let whole = fs::read_to_string(repository().join(file)).map_err(|error| format!("{file}: {error}"))?;
    let mut lines = whole.lines().map(str::trim);
    let mut missing = text
        .lines()
        .map(|line| line.split("  //").next().unwrap_or(line).trim())
        .filter(|line| !line.is_empty());
    match missing.find(|shown| !lines.any(|line| line.split("  //").next().unwrap_or(line).trim() == *shown))
    {
        Some(line) => Err(format!("{file} does not have the line `{line}` there")),
        None => Ok(()),
    }
}

/// Tests a page; returns its numbers of blocks, the times of its commands, and all mistakes.
fn test_page(name: &str) -> (Counts, Vec<(Duration, String)>, Vec<String>) {
    let text = fs::read_to_string(repository().join(name)).unwrap();
    let blocks = match markdown::blocks(&text) {
        Ok(blocks) => blocks,
        Err(error) => return (Counts::new(), Vec::new(), vec![format!("{name}, {error}")]),
    };
    let folder = tempfile::tempdir().unwrap();
    if !blocks.is_empty() {
        ["scenarios", "surfaces"]
            .iter()
            .for_each(|part| copy(&repository().join(part), &folder.path().join(part)));
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

/// All blocks of all pages, by two threads.
#[cfg(unix)]
#[test]
fn blocks_of_the_documentation_run_and_their_outputs_are_those_shown() {
    let one = std::env::var(PAGE).ok();
    let left = Mutex::new(one.clone().map_or_else(pages, |page| vec![page]));
    let found = Mutex::new((Counts::new(), Vec::new(), Vec::new()));
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                loop {
                    let Some(page) = left.lock().unwrap().pop() else { break };
                    let (counts, times, wrong) = test_page(&page);
                    let mut all = found.lock().unwrap();
                    counts.into_iter().for_each(|(what, count)| *all.0.entry(what).or_default() += count);
                    all.1.extend(times);
                    all.2.extend(wrong);
                }
            });
        }
    });
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
        for (what, least) in [("sh", 58), ("toml", 20), ("outputs", 6), ("commands run", 60), ("python", 24)]
        {
            assert!(
                counts.get(what).is_some_and(|count| *count >= least),
                "at least {least} {what}: {counts:?}"
            );
        }
        assert!(counts.get("skipped").is_none_or(|count| *count < 10), "few blocks are skipped: {counts:?}");
    }
}
