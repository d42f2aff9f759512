//! The blocks of one page while they are tested, one after the other.

use std::fs;
use std::path::Path;
use std::process::Output;
use std::time::{Duration, Instant};

use super::commands::{self, Fate, Shell, compare_output};
use super::markdown::{Block, Note};
use super::{Counts, repository, scenarios};

/// The page of all commands, whose examples count as long.
const REFERENCE: &str = "docs/cli.md";

/// The blocks of one page while they are tested, in order.
pub(super) struct Page<'a> {
    pub(super) name: &'a str,
    pub(super) shell: Shell<'a>,
    /// The commands that were run so far, with their outputs; `None` if it was not run.
    pub(super) outputs: Vec<(String, Option<Output>)>,
    pub(super) counts: Counts,
    pub(super) times: Vec<(Duration, String)>,
}

impl Page<'_> {
    fn count(&mut self, what: &'static str) {
        *self.counts.entry(what).or_default() += 1;
    }

    /// Tests a block.
    pub(super) fn test(&mut self, block: &Block) -> Result<(), String> {
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
        let is_file = block.find(Note::shown_file).or_else(|| block.find(Note::from)).is_some();
        match &*block.language {
            "sh" => self.commands(block, &text),
            "text" if !is_file => self.output(block, &text),
            "toml" => {
                self.count("toml");
                let start = Instant::now();
                let resolved = self.scenario(block, &text);
                self.times.push((start.elapsed(), format!("{}:{}", self.name, block.line)));
                resolved
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
        let is_long = block.notes.contains(&Note::Long) || self.name == REFERENCE;
        let exit = block.find(Note::exit).unwrap_or(0);
        let lines = commands::lines(text);
        if lines.is_empty() {
            return Err("the block has no command".to_owned());
        }
        let mut wrong = Vec::new();
        for line in lines {
            let start = Instant::now();
            let (what, output) = match self.shell.line(&line, is_long, exit) {
                Ok(Fate::Ran(output)) => ("commands run", Some(output)),
                Ok(Fate::Parsed) => ("commands parsed", None),
                Ok(Fate::Elsewhere(_)) => ("commands elsewhere", None),
                Err(error) => {
                    wrong.push(format!("{}\n{error}", line.text));
                    continue;
                }
            };
            self.times.push((start.elapsed(), format!("{}: {}", self.name, line.text)));
            self.count(what);
            self.outputs.push((line.text, output));
        }
        if wrong.is_empty() { Ok(()) } else { Err(wrong.join("\n")) }
    }

    fn output(&mut self, block: &Block, text: &str) -> Result<(), String> {
        let found = match block.find(Note::output) {
            Some(command) => self.outputs.iter().rev().find(|(line, _)| line == command),
            None => self.outputs.last(),
        };
        let (command, output) = found.ok_or("no command stands before this output")?;
        let Some(output) = output else {
            self.count("outputs of commands that were not run");
            return Ok(());
        };
        compare_output(text, output).map_err(|error| format!("output of {command}: {error}"))?;
        self.count("outputs compared");
        Ok(())
    }

    fn scenario(&self, block: &Block, text: &str) -> Result<(), String> {
        let base = block.find(Note::base);
        let place = Path::new(base.or_else(|| block.find(Note::shown_file)).unwrap_or_default());
        let read = |file| {
            fs::read_to_string(self.shell.folder.join(file)).map_err(|error| format!("{file}: {error}"))
        };
        let base = base.map(read).transpose()?;
        let folder = self.shell.folder.join(place.parent().unwrap_or(Path::new("")));
        let is_resolved = self.shell.runs_long || !block.notes.contains(&Note::Long);
        scenarios::check(text, base.as_deref(), &folder, is_resolved)
    }
}

/// Fails unless the lines of `text` stand in a file of the repository, in this order.
fn is_excerpt(text: &str, file: &str) -> Result<(), String> {
    let whole = fs::read_to_string(repository().join(file)).map_err(|error| format!("{file}: {error}"))?;
    let code = |line: &'_ str| line.split(" //").next().unwrap_or_default().trim().to_owned();
    let mut lines = whole.lines().map(code);
    let mut shown = text.lines().map(code).filter(|line| !line.is_empty());
    match shown.find(|shown| !lines.any(|line| line == *shown)) {
        Some(line) => Err(format!("{file} does not have the line `{line}` there")),
        None => Ok(()),
    }
}
