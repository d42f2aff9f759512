//! The chores of the project: `cargo xtask CHORE`; without a chore, their list.
//!
//! Each chore runs the tools that it needs as processes. A tool that is missing is
//! named in one line, with the command that installs it.

#![allow(clippy::print_stdout, clippy::print_stderr, reason = "a program for the terminal")]

mod oracle;
mod package;
mod page;
mod peers;
mod pictures;
mod python;
mod serve;
mod shell;
mod test;

use std::process::ExitCode;

use shell::{Needs, Outcome, cargo};

/// A name, what the chore does, and the chore.
type Chore = (&'static str, &'static str, fn() -> Outcome);

const CHORES: [Chore; 11] = [
    (
        "test",
        "format, lints, all tests, documentation, every example scenario, the web app's page, the Python package",
        test::test,
    ),
    (
        "full",
        "test, with ten times the seeds and random displays, longer fuzzing, all of the page and of the Python package; then oracle and deny",
        full,
    ),
    ("page", "build the web app's page, and all of its tests in Chromium", page::page),
    (
        "python",
        "build the Python package's wheel, and all of its tests in a clean environment",
        package::package,
    ),
    ("oracle", "recompute the reference tables of validation/ with their Python oracles", oracle::oracle),
    ("peers", "time Papilio beside other programs, for docs/peers.md", peers::peers),
    ("docs", "write the tables of docs/ that are made of the code", docs),
    ("deny", "licences, advisories and sources of all dependencies", deny),
    ("bench", "all benchmarks", bench),
    ("picture", "make the pictures of docs/pictures anew", pictures::pictures),
    ("accuracy", "measure both solvers' accuracy against cost, for docs/pictures", pictures::accuracy),
];

/// The chore that takes arguments: those of `papilio serve`.
const SERVE: (&str, &str) =
    ("serve", "build the web app's page and the program, and serve it: cargo xtask serve [FILE] [--open]");

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    let name = arguments.next();
    let rest: Vec<String> = arguments.collect();
    if name.as_deref() == Some(SERVE.0) {
        return ended(serve::serve(&rest));
    }
    let more = rest.into_iter().next();
    let chore = CHORES.iter().find(|(known, ..)| Some(*known) == name.as_deref());
    match (chore, name, more) {
        (Some((.., chore)), _, None) => ended(chore()),
        (None, None, _) => {
            let all = CHORES.iter().map(|(name, what, _)| (*name, *what)).chain([SERVE]);
            all.for_each(|(name, what)| println!("cargo xtask {name:<8} {what}"));
            ExitCode::SUCCESS
        }
        (_, name, more) => {
            let said = name.into_iter().chain(more).collect::<Vec<_>>().join(" ");
            eprintln!("xtask: no chore `{said}`; `cargo xtask` lists them");
            ExitCode::from(2)
        }
    }
}

fn ended(chore: Outcome) -> ExitCode {
    match chore {
        Ok(()) => ExitCode::SUCCESS,
        Err(why) => {
            eprintln!("xtask: {why}");
            ExitCode::FAILURE
        }
    }
}

fn full() -> Outcome {
    test::with_more(10 * test::SEEDS, 2000)?;
    package::package()?;
    oracle::oracle()?;
    deny()
}

/// The tests that compare these tables write them when they are told to.
fn docs() -> Outcome {
    for (package, test, name) in [
        ("papilio-scenario", "scenario", "tables_of_keys_in_the_docs_are_those_of_the_grammar"),
        ("papilio-formats", "bsdf", "table_of_formats_in_the_docs_is_that_of_the_readers"),
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
