//! `cargo xtask mutants [CRATE...] [OPTION...]`: changes of the sources that no test finds.
//!
//! `cargo-mutants` changes one function or operator at a time in a copy of the sources, and runs the tests of the
//! crate. A change that all tests pass is a survivor: it is either equivalent to the original, or a test is missing.
//! Options are those of `cargo mutants`, such as `--shard 0/10`, which tries one mutant in ten.
//!
//! Results are in `target/mutants/CRATE`. A mutant that was found there is not tried again: an interrupted task is
//! resumed. To begin again, delete the folder.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use crate::shell::{self, Needs, Outcome, cargo};

/// Crates whose numbers have no other guard than tests.
const CRATES: [&str; 7] = ["sampling", "spectra", "colour", "optics", "goniometry", "transport", "design"];

/// What no test has to find: texts for developers.
const NOT_TRIED: [&str; 2] = [r"impl (fmt::)?Debug", r"impl (fmt::)?Display"];

/// Exit codes of `cargo mutants` that mean that it has tried all mutants: all found, some not, some endless.
const COMPLETE: [i32; 3] = [0, 2, 3];

/// Runs the task.
pub(crate) fn mutants(arguments: &[String]) -> Outcome {
    shell::need(Needs { tool: &["cargo", "mutants"], install: "cargo install cargo-mutants --locked" })?;
    let options = arguments.iter().position(|word| word.starts_with('-')).unwrap_or(arguments.len());
    let (crates, options) = arguments.split_at(options);
    let crates: Vec<&str> = match crates {
        [] => CRATES.to_vec(),
        some => some.iter().map(|name| name.strip_prefix("papilio-").unwrap_or(name)).collect(),
    };
    if let Some(unknown) = crates.iter().find(|name| !shell::root().join("crates").join(name).is_dir()) {
        return Err(format!("there is no crate `{unknown}` in crates/; usual ones: {}", CRATES.join(", ")));
    }
    let mut table = String::from(
        "| crate | mutants | found | endless | not compiled | survivors |\n|---|---|---|---|---|---|\n",
    );
    let mut survivors = String::new();
    for name in crates {
        let out = shell::target().join("mutants").join(name);
        fs::create_dir_all(&out).map_err(|error| format!("{}: {error}", out.display()))?;
        let mut tried = cargo(["mutants", "--iterate", "--no-shuffle", "--no-default-features", "--package"]);
        tried.arg(format!("papilio-{name}")).arg("--output").arg(&out);
        NOT_TRIED.iter().for_each(|not| _ = tried.args(["--exclude-re", not]));
        tried.args(options);
        let status = tried.status().map_err(|error| format!("cargo mutants: {error}"))?;
        if !status.code().is_some_and(|code| COMPLETE.contains(&code)) {
            return Err(format!("cargo mutants of {name}: {status}; the same command resumes it"));
        }
        let results = Results::read(&out.join("mutants.out"));
        table += &results.row(name);
        survivors += &results.by_file();
    }
    println!("\n{survivors}\n{table}");
    Ok(())
}

/// Names of the mutants of a crate, by what became of them.
#[derive(Debug, Default, PartialEq)]
struct Results {
    found: usize,
    endless: usize,
    not_compiled: usize,
    missed: Vec<String>,
}

impl Results {
    /// Reads the lists in a folder of `cargo mutants`.
    fn read(folder: &Path) -> Self {
        let lines = |name: &str| -> Vec<String> {
            let text = fs::read_to_string(folder.join(name)).unwrap_or_default();
            text.lines().map(str::to_owned).collect()
        };
        Self {
            // Those of earlier runs are in a list of their own.
            found: lines("caught.txt").len() + lines("previously_caught.txt").len(),
            endless: lines("timeout.txt").len(),
            not_compiled: lines("unviable.txt").len(),
            missed: lines("missed.txt"),
        }
    }

    fn row(&self, name: &str) -> String {
        let Self { found, endless, not_compiled, missed } = self;
        let tried = found + endless + missed.len();
        let percent = 100.0 * missed.len() as f64 / tried.max(1) as f64;
        format!(
            "| {name} | {tried} | {found} | {endless} | {not_compiled} | {} ({percent:.0} %) |\n",
            missed.len()
        )
    }

    /// The survivors of each file, with the line and the change.
    fn by_file(&self) -> String {
        let mut files: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
        for one in &self.missed {
            let (file, change) = one.split_once(':').unwrap_or((one, ""));
            files.entry(file).or_default().push(change);
        }
        files.iter().map(|(file, changes)| format!("{file}\n  {}\n", changes.join("\n  "))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn survivors_are_listed_by_file() {
        let folder = shell::target().join("tmp/mutants-of-a-test");
        fs::create_dir_all(&folder).unwrap();
        fs::write(folder.join("caught.txt"), "a\nb\n").unwrap();
        fs::write(folder.join("previously_caught.txt"), "c\n").unwrap();
        fs::write(
            folder.join("missed.txt"),
            "src/b.rs:3:5: replace - with +\nsrc/a.rs:1:1: x\nsrc/b.rs:9:1: y\n",
        )
        .unwrap();
        let results = Results::read(&folder);
        assert_eq!(results.by_file(), "src/a.rs\n  1:1: x\nsrc/b.rs\n  3:5: replace - with +\n  9:1: y\n");
        assert_eq!(results.row("spectra"), "| spectra | 6 | 3 | 0 | 0 | 3 (50 %) |\n");
    }
}
