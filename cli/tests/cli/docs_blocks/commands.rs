//! Blocks of `sh`: the commands of a page, run as a reader pastes them.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use papilio_scenario::{Fit, Optimisation, Scenario, SurfaceScenario, Sweep, Tolerance};

use super::output::compare;

/// A command of a page.
pub(super) struct Line<'a> {
    /// As it stands there, on one line, without its comment.
    pub(super) text: String,
    /// The comment after it.
    pub(super) comment: &'a str,
}

/// Commands that are not run: their beginning, and what tests them.
const ELSEWHERE: [(&str, &str); 4] = [
    ("cargo ", "xtask's tests check the names of tasks; CI runs them"),
    (
        "pip install ",
        "`cargo xtask python` installs the package; python/tests/test_docs.py checks the names of extras",
    ),
    ("target/python/bin/python python/tests/", "`cargo xtask python` runs these tests"),
    ("papilio serve", "it does not end: only its arguments are checked here; tests/cli/serve.rs starts it"),
];

/// Words of commands that take a third of a second or more in the development profile, or that need a feature
/// that it lacks.
const LONG: [&str; 19] = [
    "--cone",
    "fit",
    "steps",
    "measure",
    "calibrate",
    "optimize",
    "tolerance",
    "validate",
    "study",
    "sparkle",
    "gonio",
    "brdf",
    "mtf",
    "crosstalk",
    "monte-carlo",
    "--png",
    "--parquet",
    "scenarios/rayleigh-film.toml",
    "halftone.csv",
];

/// Endings of names of files.
const ENDINGS: [&str; 14] = [
    ".csv", ".svg", ".json", ".html", ".npz", ".npy", ".png", ".toml", ".exr", ".xml", ".bsdf", ".parquet",
    ".jpg", ".gpl",
];

/// What became of a command.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Fate {
    Ran(Output),
    /// Only its arguments were checked: it takes long.
    Parsed,
    /// It is tested elsewhere.
    Elsewhere(&'static str),
}

/// Returns the commands of a block; a backslash continues a line.
pub(super) fn lines(block: &str) -> Vec<Line<'_>> {
    let mut found: Vec<Line<'_>> = Vec::new();
    let mut begun = String::new();
    for line in block.lines() {
        if let Some(first) = line.trim_end().strip_suffix('\\') {
            begun += first;
            continue;
        }
        let (command, comment) = line
            .split_once("  #")
            .or_else(|| line.strip_prefix('#').map(|all| ("", all)))
            .unwrap_or((line, ""));
        let text =
            (std::mem::take(&mut begun) + command.trim()).replace("cargo run --release -- ", "papilio ");
        if !text.is_empty() {
            found.push(Line { text, comment });
        }
    }
    found
}

/// A folder in which the commands of a page run, and the program.
pub(super) struct Shell<'a> {
    pub(super) folder: &'a Path,
    /// Folder of the program.
    pub(super) program: &'a Path,
    /// True if commands that take long are run, too.
    pub(super) runs_long: bool,
}

impl Shell<'_> {
    /// Runs a command, or checks its arguments.
    pub(super) fn line(&self, line: &Line<'_>, is_long: bool, exit: i32) -> Result<Fate, String> {
        let words = self.words(&line.text)?;
        let is_program = words.first().is_some_and(|word| word == "papilio");
        let elsewhere = ELSEWHERE.iter().find(|(begin, _)| line.text.starts_with(begin));
        let is_long = is_long || (is_program && words.iter().any(|word| LONG.contains(&&**word)));
        let is_run = elsewhere.is_none() && (self.runs_long || !is_long);
        if !is_run {
            if is_program {
                self.check(&words, exit)?;
            }
            return Ok(elsewhere.map_or(Fate::Parsed, |(_, by)| Fate::Elsewhere(by)));
        }
        let (first, tool) = line
            .text
            .split_once(" | ")
            .map_or((&*line.text, None), |(first, tool)| (first, tool.split(' ').next()));
        if tool.is_some_and(|tool| {
            !self.run(&format!("command -v {tool}")).is_ok_and(|found| found.status.success())
        }) {
            self.run(first)?;
            return Ok(Fate::Elsewhere("this machine lacks a tool that reads the output"));
        }
        let output = self.run(&line.text)?;
        if output.status.code() != Some(exit) {
            let text = String::from_utf8_lossy(&output.stderr).into_owned();
            return Err(format!("{} instead of exit code {exit}\n{text}", output.status));
        }
        if exit == 0 {
            self.check_files(&words, line.comment)?;
        }
        Ok(Fate::Ran(output))
    }

    /// Runs a line of the shell.
    pub(super) fn run(&self, line: &str) -> Result<Output, String> {
        let path = std::env::var("PATH").unwrap_or_default();
        let mut shell = Command::new("sh");
        shell
            .env("NO_COLOR", "1")
            .env("HOME", self.folder)
            .env("PATH", format!("{}:{path}", self.program.display()));
        shell.current_dir(self.folder).args(["-c", line]).output().map_err(|error| error.to_string())
    }

    /// The words of the first command of a line, as the shell reads them.
    fn words(&self, line: &str) -> Result<Vec<String>, String> {
        let first = line.split(" | ").next().unwrap_or(line);
        let first = first.split(" && ").next().unwrap_or(first);
        let Some(arguments) = first.strip_prefix("papilio") else {
            return Ok(first.split_whitespace().map(str::to_owned).collect());
        };
        let words = self.run(&format!("printf '%s\\0' papilio{arguments}"))?;
        let words = String::from_utf8(words.stdout).map_err(|error| error.to_string())?;
        Ok(words.split_terminator('\0').map(str::to_owned).collect())
    }

    /// Checks the arguments of the program, and the keys and values of the scenario that they name.
    fn check(&self, words: &[String], exit: i32) -> Result<(), String> {
        let parsed = papilio_cli::command().try_get_matches_from(words).map_err(|error| error.to_string())?;
        let (mut name, mut of) = ("", &parsed);
        while let Some((inner, matches)) = of.subcommand() {
            (name, of) = (inner, matches);
        }
        let file = of.try_get_one::<PathBuf>("file").ok().flatten().map(|file| self.folder.join(file));
        let shipped = ["scenarios", "surfaces"].map(|part| self.folder.join(part));
        let set = of.try_get_many::<String>("set").ok().flatten();
        let axes = of.try_get_many::<String>("axis").ok().flatten().into_iter().flatten();
        let set: Vec<String> =
            set.into_iter().flatten().cloned().chain(axes.map(|axis| Sweep::axis_override(axis))).collect();
        // A file that an earlier command writes may not be there: that one was not run either.
        let is_there =
            |file: &PathBuf| exit == 0 && (file.exists() || shipped.iter().any(|of| file.starts_with(of)));
        // `papilio image PICTURE --on DISPLAY` has no scenario file.
        let is_picture = of.try_contains_id("on").unwrap_or(false);
        let Some(file) = file.filter(is_there).filter(|_| !is_picture) else { return Ok(()) };
        let checked = match name {
            "sweep" => Sweep::load(&file, &set).map(drop),
            "optimize" => Optimisation::load(&file, &set).map(drop),
            "tolerance" => Tolerance::load(&file, &set).map(drop),
            "fit" if of.try_contains_id("measured").unwrap_or(false) => Fit::load(&file, &set).map(drop),
            "gonio" => SurfaceScenario::load(&file, &set).map(drop),
            "run" | "brdf" | "sparkle" | "mtf" | "crosstalk" | "image" | "palette" | "sampling" | "pixel"
            | "serve" => Scenario::load(&file, &set).map(drop),
            _ => Ok(()),
        };
        checked.map_err(|errors| errors.to_string())
    }

    /// Fails if a file that a command or its comment names does not exist, or if a folder of results is
    /// empty.
    fn check_files(&self, words: &[String], comment: &str) -> Result<(), String> {
        let is_file =
            |word: &&str| ENDINGS.iter().any(|end| word.ends_with(end)) && !word.contains(['=', '*', ':']);
        let named = words.iter().map(String::as_str).filter(is_file);
        let in_comment = comment
            .split([' ', ',', ';', '(', ')', '`'])
            .map(|word| word.trim_end_matches('.'))
            .filter(is_file);
        let missing = |name: &&str| !self.folder.join(name).exists();
        if let Some(name) = named.clone().find(missing) {
            return Err(format!("{name} does not exist after the command"));
        }
        if let Some(name) = in_comment.filter(missing).find(|name| !exists_in(&self.folder.join("out"), name))
        {
            return Err(format!("{name}, of the comment, does not exist after the command"));
        }
        let out = words.iter().position(|word| word == "--out").and_then(|at| words.get(at + 1));
        let is_empty = |out: &&String| {
            let out = self.folder.join(out);
            !out.is_file() && out.read_dir().map_or(true, |mut entries| entries.next().is_none())
        };
        match out.filter(is_empty) {
            Some(out) => Err(format!("{out} is empty after the command")),
            None => Ok(()),
        }
    }
}

/// True if a folder or one below it has a file of this name.
fn exists_in(folder: &Path, name: &str) -> bool {
    let mut entries = folder.read_dir().into_iter().flatten().flatten();
    entries.any(|entry| entry.file_name() == *name || exists_in(&entry.path(), name))
}

/// Compares what a page shows with the output of a command: standard error, if it is a message.
pub(super) fn compare_output(shown: &str, output: &Output) -> Result<(), String> {
    let first = shown.split_whitespace().find(|word| *word != "...").unwrap_or_default();
    let is_message = ["error", "warning", "note"].iter().any(|word| first.starts_with(word));
    let bytes = if is_message { &output.stderr } else { &output.stdout };
    compare(shown, &String::from_utf8_lossy(bytes))
}
