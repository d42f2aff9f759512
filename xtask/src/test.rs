//! `cargo xtask test`: the checks that must pass before every commit.
//!
//! All checks run, even if earlier ones fail. The last line counts the tests, with each
//! other check as one more: `N passed, N failed`.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::thread;

use crate::count::{Count, Job};
use crate::package::{self, Profile};
use crate::page;
use crate::shell::{self, Needs, Outcome, cargo, command};
use crate::site;

/// Number of seeds of the statistical tests in `cargo xtask full`; 8 in `cargo xtask test`.
pub(crate) const SEEDS: u64 = 120;

/// Number of seeds, read by the statistical tests of `crates/transport` and the test of sensitivities in
/// `crates/design`.
const SEEDS_VARIABLE: &str = "PAPILIO_SEEDS";

/// Number of random displays, read by validation's comparison of the two solvers.
const STACKS_VARIABLE: &str = "PAPILIO_STACKS";

/// Duration for each format, read by the mutation tests of BSDF files and of pictures in `crates/formats`. If
/// it is set, the mutation tests of scenarios use 25 times as many mutations.
const FUZZ_VARIABLE: &str = "PAPILIO_FUZZ_SECONDS";

/// Enough for some hundred thousand files of each format.
const FUZZ_SECONDS: &str = "180";

/// Number of seeds, read by validation's search for a better pixel, which compares each with a population.
const SEARCH_VARIABLE: &str = "PAPILIO_SEARCH_SEEDS";

/// Duration of the web app's test of fifty simultaneous clients.
const LOAD_VARIABLE: &str = "PAPILIO_LOAD_SECONDS";

/// Duration of the web app's test of fifty hostile clients.
const SOAK_VARIABLE: &str = "PAPILIO_SOAK_SECONDS";

/// Number of points, read by the program's test of long sweeps.
const POINTS_VARIABLE: &str = "PAPILIO_SWEEP_POINTS";

/// The largest number of points of a sweep.
const POINTS: &str = "100000";

/// Duration of the requests.
const LOAD_SECONDS: &str = "60";

/// Example scenarios that the program runs in `cargo xtask test`; together they have all kinds of figures.
/// The tests compute all example scenarios in-process, with both solvers.
const EXAMPLES: [&str; 3] = ["map", "table-pixel", "two-diffusers"];

/// Runs `cargo xtask test`.
pub(crate) fn test() -> Outcome {
    let tests = || {
        let mut tests = cargo(TESTS);
        tests.arg(features(page::EVERYDAY));
        tests
    };
    all_checks(tests, page::EVERYDAY)
}

/// Runs the checks with this number of seeds and random displays in the statistical tests.
pub(crate) fn with_more(seeds: u64, stacks: u64) -> Outcome {
    let tests = || {
        let mut tests = cargo(TESTS);
        tests
            .arg(features(page::ALL))
            .env(SEEDS_VARIABLE, seeds.to_string())
            .env(STACKS_VARIABLE, stacks.to_string())
            .env(FUZZ_VARIABLE, FUZZ_SECONDS)
            .env(SEARCH_VARIABLE, "10")
            .env(LOAD_VARIABLE, LOAD_SECONDS)
            .env(SOAK_VARIABLE, "3600")
            .env(POINTS_VARIABLE, POINTS);
        tests
    };
    all_checks(tests, page::ALL)
}

/// Returns the feature flags. `cargo xtask test` does not compile Parquet and PNG, and their tests check the
/// messages about the missing features; `cargo xtask full` compiles them.
fn features(of_page: &str) -> &'static str {
    if of_page == page::EVERYDAY { "--no-default-features" } else { "--all-features" }
}

const TESTS: [&str; 4] = ["test", "--workspace", "--no-fail-fast", "--quiet"];

/// Selects the targets that have tests. Without it, cargo would link the examples, too, which lints check; `--lib` would compile the Python
/// package's extension module, which its wheel compiles again with settings of its interpreter.
const UNITS: &str = "--tests";

fn all_checks(tests: impl Fn() -> Command, of_page: &str) -> Outcome {
    shell::need(Needs { tool: &["cargo", "fmt"], install: "rustup component add rustfmt" })?;
    shell::need(Needs { tool: &["cargo", "clippy"], install: "rustup component add clippy" })?;
    let mut count = Count::default();
    count.step("format", |count| count.check(shell::run(cargo(["fmt", "--all", "--check"]))));
    // Downloaded and unpacked on one core while cargo compiles: cargo does not use all cores all the time.
    let environment = thread::spawn(package::environment);
    // The page is built first; otherwise the program would be compiled again once there is a page.
    let browser = count.step("page, built", Count::page);
    // Compiled separately, so that the time of the tests does not include it. If it fails, the tests fail
    // again below, and the failure is counted there.
    let mut compile = tests();
    compile.arg("--no-run");
    if of_page == page::EVERYDAY {
        // What the tests below select.
        compile.arg(UNITS);
    }
    let _ = count.step("tests, compiled", |_| shell::run(compile));
    let environment = count.environment(environment);

    let mut python = Vec::new();
    if let Some(environment) = &environment {
        let [wheel, installed] = package::wheel(environment, Profile::Dev);
        python.push(Job::needed("  Python, wheel", wheel));
        python.push(Job::needed("  Python, installed", installed));
        python.push(Job::tests("  Python", package::tests(environment, Profile::Dev)));
    }
    let mut others = Vec::new();
    if let Some(browser) = &browser {
        others.push(Job::tests("  page, unit tests", page::unit_tests()));
        others.push(Job::tests("  site, search", site::search_tests()));
        others.push(Job::tests("  page, in a browser", page::end_to_end(of_page, browser)));
    }
    let mut lints = cargo(["clippy", "--workspace", "--all-targets"]);
    lints.arg(features(of_page)).args(["--", "-D", "warnings"]);
    let mut docs = cargo(["doc", "--workspace", "--no-deps"]);
    docs.arg(features(of_page))
        .env("RUSTDOCFLAGS", "-D warnings")
        .envs(shell::checked_by_clippy("-D warnings"));
    let texts = [Job::check("  lints", lints), Job::check("  documentation", docs)];
    if of_page == page::EVERYDAY {
        let [mut units, mut examples] = [tests(), tests()];
        units.arg(UNITS);
        examples.arg("--doc");
        // Lints and documentation use the time in which tests wait. While they are compiled, cargo builds
        // nothing else: they come last.
        others.push(Job::tests("  cargo, examples", examples));
        others.extend(texts);
        count.step("tests and lints", |count| count.together(units, [python, others]));
    } else {
        // The long tests measure times and must not run in parallel with others.
        count.step("tests", |count| count.tests(tests()));
        let others = Job::run_all(others.into_iter().chain(texts).chain(python).collect());
        others.iter().for_each(|done| count.counted(done));
    }
    let mut scenarios = scenarios()?;
    if of_page == page::EVERYDAY {
        scenarios
            .retain(|path| EXAMPLES.iter().any(|name| path.file_stem().is_some_and(|stem| stem == *name)));
    }
    count
        .step("scenarios", |count| scenarios.iter().for_each(|scenario| count.check(run_scenario(scenario))));
    count.conclude()
}

/// Returns the paths of the example scenarios, in order.
fn scenarios() -> Result<Vec<PathBuf>, String> {
    let folder = shell::root().join("scenarios");
    let entries = folder.read_dir().map_err(|error| format!("scenarios: {error}"))?;
    let mut found: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    found.retain(|path| path.extension().is_some_and(|extension| extension == "toml"));
    found.sort();
    Ok(found)
}

fn run_scenario(scenario: &Path) -> Outcome {
    let out = shell::target().join("examples").join(scenario.file_stem().unwrap_or_default());
    // Not through cargo: for this program alone it would compile nearly everything again, with other features
    // of the dependencies.
    let mut papilio = command(shell::papilio_for_tests(), ["run"]);
    papilio.arg(scenario).arg("--out").arg(out);
    shell::run(papilio)
}
