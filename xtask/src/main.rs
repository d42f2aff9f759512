//! Tasks of the project: `cargo xtask TASK`. Without a task, it lists all tasks.
//!
//! Each task runs the tools that it needs as processes. If a tool is missing, the message names it and the
//! command that installs it.

#![allow(clippy::print_stdout, clippy::print_stderr, reason = "a program for the terminal")]

mod count;
mod licences;
mod mutants;
mod oracle;
mod package;
mod page;
mod pairs;
mod peers;
mod pictures;
mod programs;
mod python;
mod release;
mod serve;
mod shell;
mod site;
mod test;
mod versions;
mod workflows;

use std::process::ExitCode;

use shell::{Needs, Outcome, cargo};

/// Name, description and function of a task.
type Task = (&'static str, &'static str, fn() -> Outcome);

const TASKS: &[Task] = &[
    (
        "test",
        "run all checks: format, lints, tests, documentation, three example scenarios, web page, Python package",
        test::test,
    ),
    (
        "full",
        "run test with far more seeds and random displays, longer fuzzing, all example scenarios, all commands of the documentation, and all tests of the page, of the documentation site and of Python; then oracle, workflows and deny",
        full,
    ),
    ("page", "build the page of the web app, and run all its tests in Chromium", page::page),
    (
        "python",
        "build the wheel of the Python package, and run all its tests in a clean environment",
        package::package,
    ),
    (
        "oracle",
        "compare the reference tables of validation/ and the CIE tables with the Python programs that made them",
        oracle::oracle,
    ),
    ("peers", "measure the speed of Papilio and other programs, for docs/peers.md", peers::peers),
    ("docs", "write what is generated from the code: tables of docs/, and README.md of each crate", docs),
    (
        "licences",
        "write release/THIRD-PARTY.md: the licences of all that is distributed, with their texts",
        licences::licences,
    ),
    ("deny", "check licences, advisories and sources of all dependencies", deny),
    ("workflows", "check the workflows of .github and the container file", workflows::workflows),
    (
        "oldest-rust",
        "compile everything with the oldest Rust that the manifests allow",
        versions::oldest_rust,
    ),
    ("semver", "compare what the published crates offer with the last version", versions::semver),
    ("bench", "run all benchmarks", bench),
    ("picture", "make the pictures of docs/pictures again", pictures::pictures),
    ("accuracy", "measure accuracy against time of both solvers, for docs/pictures", pictures::accuracy),
];

/// Name, description and function of a task with arguments.
type TaskWithArguments = (&'static str, &'static str, fn(&[String]) -> Outcome);

const WITH_ARGUMENTS: &[TaskWithArguments] = &[
    (
        "serve",
        "build the page of the web app and the program, and start it: cargo xtask serve [FILE] [--open]",
        serve::serve,
    ),
    (
        "measure-page",
        "measure the page in a browser into target/page: cargo xtask measure-page soak [MINUTES] (memory of the server) | latency | looks (screenshots of all tools)",
        page::measure,
    ),
    (
        "site",
        "build the documentation site into target/site; --api: with the documentation of the crates; --check: test it in a browser",
        site::site,
    ),
    (
        "release",
        "make packages for users in target/packages, and install and run each: cargo xtask release [program] [wheel] [sdist] [crates] [sums] [--target TRIPLE]",
        release::release,
    ),
    (
        "mutants",
        "change the sources of a crate in every place, and list the changes that no test finds: cargo xtask mutants [CRATE...] [--shard K/N]",
        mutants::mutants,
    ),
    (
        "bench-pairs",
        "compare the processor time of two programs, in turn: cargo xtask bench-pairs OLD NEW",
        pairs::pairs,
    ),
];

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    let name = arguments.next();
    let rest: Vec<String> = arguments.collect();
    if let Some((.., run)) = WITH_ARGUMENTS.iter().find(|(known, ..)| Some(*known) == name.as_deref()) {
        return exit_code(run(&rest));
    }
    let extra = rest.into_iter().next();
    let task = TASKS.iter().find(|(known, ..)| Some(*known) == name.as_deref());
    match (task, name, extra) {
        (Some((.., run)), _, None) => exit_code(run()),
        (None, None, _) => {
            let simple = TASKS.iter().map(|(name, description, _)| (name, description));
            let all = simple.chain(WITH_ARGUMENTS.iter().map(|(name, description, _)| (name, description)));
            all.for_each(|(name, description)| println!("cargo xtask {name:<11} {description}"));
            ExitCode::SUCCESS
        }
        (_, name, extra) => {
            let arguments = name.into_iter().chain(extra).collect::<Vec<_>>().join(" ");
            eprintln!("xtask: unknown task `{arguments}`; `cargo xtask` lists all tasks");
            ExitCode::from(2)
        }
    }
}

fn exit_code(outcome: Outcome) -> ExitCode {
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(reason) => {
            eprintln!("xtask: {reason}");
            ExitCode::FAILURE
        }
    }
}

fn full() -> Outcome {
    test::with_more(test::SEEDS, 2000)?;
    site::check()?;
    package::package()?;
    blocks()?;
    oracle::oracle()?;
    workflows::workflows()?;
    deny()
}

/// Runs all commands of the documentation, those that take long too, with the release program, which the
/// package was compared with.
fn blocks() -> Outcome {
    let mut blocks = cargo(["test", "--package", "papilio", "--test", "cli", "docs_blocks"]);
    blocks.env("PAPILIO_DOCS_ALL", "1").env("PAPILIO_DOCS_PROGRAM", shell::papilio());
    shell::run(blocks)
}

/// The tests that compare these tables write them when they are told to.
fn docs() -> Outcome {
    for (package, test, name) in [
        ("papilio-scenario", "scenario", "tables_of_keys_in_the_docs_are_those_of_the_grammar"),
        (
            "papilio-scenario",
            "scenario",
            "tables_of_materials_illuminants_and_old_names_in_the_docs_are_those_of_the_program",
        ),
        ("papilio-formats", "formats", "table_of_formats_in_the_docs_is_that_of_the_readers"),
        ("papilio", "cli", "reference::"),
        ("xtask", "xtask", "readme_of_each_crate_is_the_tour_of_its_library"),
    ] {
        let mut written = cargo(["test", "--package", package, "--test", test, name]);
        written.env("PAPILIO_WRITE_DOCS", "1");
        shell::run(written)?;
    }
    Ok(())
}

fn bench() -> Outcome {
    shell::run(cargo(["bench", "--workspace", "--bench", "*"]))
}

fn deny() -> Outcome {
    shell::need(Needs { tool: &["cargo", "deny"], install: "cargo install cargo-deny --locked" })?;
    shell::run(cargo(["deny", "--workspace", "check"]))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every `cargo xtask TASK` of the documentation is a task. The commands are not run there: they run the
    /// tests.
    #[test]
    fn tasks_named_in_the_documentation_exist() {
        let mut folders = vec![shell::root().join("docs")];
        let mut pages = vec![shell::root().join("README.md"), shell::root().join("ARCHITECTURE.md")];
        while let Some(folder) = folders.pop() {
            for path in folder.read_dir().into_iter().flatten().flatten().map(|entry| entry.path()) {
                if path.is_dir() { folders.push(path) } else { pages.push(path) }
            }
        }
        pages.push(shell::root().join("CONTRIBUTING.md"));
        pages.retain(|path| path.extension().is_some_and(|end| end == "md") && path.exists());
        let mut found = 0;
        for path in pages {
            let text = std::fs::read_to_string(&path).unwrap_or_default();
            for rest in text.split("cargo xtask ").skip(1) {
                let end = rest.find(|c: char| !c.is_ascii_lowercase() && c != '-').unwrap_or(rest.len());
                let name = &rest[..end];
                let is_known = TASKS.iter().any(|(known, ..)| *known == name)
                    || WITH_ARGUMENTS.iter().any(|(known, ..)| *known == name);
                assert!(is_known || name.is_empty(), "{}: there is no task `{name}`", path.display());
                found += usize::from(is_known);
            }
        }
        assert!(found > 20, "{found}");
    }
}
