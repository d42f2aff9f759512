//! Tasks of the project: `cargo xtask TASK`. Without a task, it lists all tasks.
//!
//! Each task runs the tools that it needs as processes. If a tool is missing, the message names it and the command that
//! installs it.

#![allow(clippy::print_stdout, clippy::print_stderr, reason = "a program for the terminal")]

mod count;
mod oracle;
mod package;
mod page;
mod pairs;
mod peers;
mod pictures;
mod python;
mod release;
mod serve;
mod shell;
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
        "run test with far more seeds and random displays, longer fuzzing, all example scenarios, and all tests of the page and of Python; then oracle, workflows and deny",
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

/// The task whose arguments are those of `papilio serve`.
const SERVE: (&str, &str) = (
    "serve",
    "build the page of the web app and the program, and start it: cargo xtask serve [FILE] [--open]",
);

/// The task with parts and a system.
const RELEASE: (&str, &str) = (
    "release",
    "make packages for users in target/packages, and install and run each: cargo xtask release [program] [wheel] [sdist] [crates] [sums] [--target TRIPLE]",
);

/// The task with the paths of two programs.
const PAIRS: (&str, &str) =
    ("bench-pairs", "compare the processor time of two programs, in turn: cargo xtask bench-pairs OLD NEW");

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    let name = arguments.next();
    let rest: Vec<String> = arguments.collect();
    if name.as_deref() == Some(SERVE.0) {
        return exit_code(serve::serve(&rest));
    }
    if name.as_deref() == Some(RELEASE.0) {
        return exit_code(release::release(&rest));
    }
    if name.as_deref() == Some(PAIRS.0) {
        return exit_code(pairs::pairs(&rest));
    }
    let extra = rest.into_iter().next();
    let task = TASKS.iter().find(|(known, ..)| Some(*known) == name.as_deref());
    match (task, name, extra) {
        (Some((.., run)), _, None) => exit_code(run()),
        (None, None, _) => {
            let all = TASKS
                .iter()
                .map(|(name, description, _)| (*name, *description))
                .chain([SERVE, RELEASE, PAIRS]);
            all.for_each(|(name, description)| println!("cargo xtask {name:<8} {description}"));
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
    package::package()?;
    oracle::oracle()?;
    workflows::workflows()?;
    deny()
}

/// The tests that compare these tables write them when they are told to.
fn docs() -> Outcome {
    for (package, test, name) in [
        ("papilio-scenario", "scenario", "tables_of_keys_in_the_docs_are_those_of_the_grammar"),
        (
            "papilio-scenario",
            "scenario",
            "tables_of_materials_and_illuminants_in_the_docs_are_those_of_the_program",
        ),
        ("papilio-formats", "formats", "table_of_formats_in_the_docs_is_that_of_the_readers"),
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
