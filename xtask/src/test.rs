//! `cargo xtask test`: the checks that must pass before every commit.
//!
//! All checks run, even if earlier ones fail. The last line counts the tests, with each
//! other check as one more: `N passed, N failed`.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

use crate::package::{self, Profile};
use crate::page;
use crate::python::Environment;
use crate::shell::{self, Apart, Needs, Outcome, cargo, command};

/// Number of seeds of the statistical tests in `cargo xtask full`; 8 in `cargo xtask test`.
pub(crate) const SEEDS: u64 = 480;

/// Number of seeds, read by the statistical tests of `crates/transport` and the test of sensitivities in `crates/design`.
const SEEDS_VARIABLE: &str = "PAPILIO_SEEDS";

/// Number of random displays, read by validation's comparison of the two solvers.
const STACKS_VARIABLE: &str = "PAPILIO_STACKS";

/// Number of random scenario files, read by validation's comparison of the two solvers.
const SCENARIOS_VARIABLE: &str = "PAPILIO_SCENARIOS";

/// With this number, the mean square of the z-scores is known to 10 %.
const SCENARIOS: &str = "300";

/// Duration for each format, read by the mutation tests of BSDF files in `crates/formats`. If it is set, the mutation
/// tests of scenarios use 25 times as many mutations.
const FUZZ_VARIABLE: &str = "PAPILIO_FUZZ_SECONDS";

/// Enough for some hundred thousand files of each format.
const FUZZ_SECONDS: &str = "180";

/// Number of seeds, read by validation's search for a better pixel, which compares each with a population.
const SEARCH_VARIABLE: &str = "PAPILIO_SEARCH_SEEDS";

/// Duration of the web app's test of fifty simultaneous clients.
const LOAD_VARIABLE: &str = "PAPILIO_LOAD_SECONDS";

/// Number of points, read by the program's test of long sweeps.
const POINTS_VARIABLE: &str = "PAPILIO_SWEEP_POINTS";

/// The largest number of points of a sweep.
const POINTS: &str = "100000";

/// Duration of the requests.
const LOAD_SECONDS: &str = "60";

/// Example scenarios that the program runs in `cargo xtask test`; together they have all kinds of figures. The tests
/// compute all example scenarios in-process, with both solvers.
const EXAMPLES: [&str; 3] = ["map", "table-pixel", "two-diffusers"];

/// The integration tests that take longest. In `cargo xtask test` they run at the same time as the others, so that no core
/// waits for the last test of a program.
const LONGEST: [&str; 2] = ["cli", "transport"];

/// Runs `cargo xtask test`.
pub(crate) fn test() -> Outcome {
    let tests = || {
        let mut tests = cargo(TESTS);
        tests.args(features(page::EVERYDAY));
        tests
    };
    all_checks(tests, page::EVERYDAY)
}

/// Runs the checks with this number of seeds and random displays in the statistical tests.
pub(crate) fn with_more(seeds: u64, stacks: u64) -> Outcome {
    let tests = || {
        let mut tests = cargo(TESTS);
        tests
            .env(SEEDS_VARIABLE, seeds.to_string())
            .env(STACKS_VARIABLE, stacks.to_string())
            .env(SCENARIOS_VARIABLE, SCENARIOS)
            .env(FUZZ_VARIABLE, FUZZ_SECONDS)
            .env(SEARCH_VARIABLE, "10")
            .env(LOAD_VARIABLE, LOAD_SECONDS)
            .env(POINTS_VARIABLE, POINTS);
        tests
    };
    all_checks(tests, page::ALL)
}

/// Returns the feature flags. `cargo xtask test` does not compile Parquet and PNG, and their tests check the messages
/// about the missing features; `cargo xtask full` compiles them.
fn features(of_page: &str) -> Option<&'static str> {
    (of_page == page::EVERYDAY).then_some("--no-default-features")
}

const TESTS: [&str; 4] = ["test", "--workspace", "--no-fail-fast", "--quiet"];

fn all_checks(tests: impl Fn() -> Command, of_page: &str) -> Outcome {
    shell::need(Needs { tool: &["cargo", "fmt"], install: "rustup component add rustfmt" })?;
    shell::need(Needs { tool: &["cargo", "clippy"], install: "rustup component add clippy" })?;
    let mut count = Count::default();
    count.step("format", |count| count.check(shell::run(cargo(["fmt", "--all", "--check"]))));
    let mut lints = cargo(["clippy", "--workspace", "--all-targets"]);
    lints.args(features(of_page)).args(["--", "-D", "warnings"]);
    count.step("lints", |count| count.check(shell::run(lints)));
    // The page is built first; otherwise the program would be compiled again once there is a page.
    let browser = count.step("page, built", Count::page);
    // Compiled separately, so that the time of the tests does not include it. If it fails, the tests fail again below,
    // and the failure is counted there.
    let mut compile = tests();
    compile.arg("--no-run");
    let _ = count.step("tests, compiled", |_| shell::run(compile));
    let environment = count.package();
    let mut others = Vec::new();
    if let Some(browser) = &browser {
        others.push(("  page, unit tests", page::unit_tests()));
        others.push(("  page, in a browser", page::end_to_end(of_page, browser)));
    }
    others.extend(environment.map(|environment| ("  Python", package::tests(&environment, Profile::Dev))));
    if of_page == page::EVERYDAY {
        let [mut longest, mut rest, mut examples] = [tests(), tests(), tests()];
        rest.args(["--lib", "--bins"]);
        examples.arg("--doc");
        for name in integration_tests()? {
            let tests = if LONGEST.contains(&name.as_str()) { &mut longest } else { &mut rest };
            tests.args(["--test", &name]);
        }
        let longest = vec![("  cargo, longest", longest), ("  cargo, examples", examples)];
        count.step("tests", |count| count.together(rest, [others, longest]));
    } else {
        // The long tests measure times and must not run in parallel with others.
        count.step("tests", |count| count.tests(tests()));
        others
            .into_iter()
            .for_each(|(name, other)| count.step(name.trim_start(), |count| count.tests(other)));
    }
    let mut docs = cargo(["doc", "--workspace", "--no-deps"]);
    docs.args(features(of_page)).env("RUSTDOCFLAGS", "-D warnings");
    count.step("documentation", |count| count.check(shell::run(docs)));
    let mut scenarios = scenarios()?;
    if of_page == page::EVERYDAY {
        scenarios
            .retain(|path| EXAMPLES.iter().any(|name| path.file_stem().is_some_and(|stem| stem == *name)));
    }
    count
        .step("scenarios", |count| scenarios.iter().for_each(|scenario| count.check(run_scenario(scenario))));
    count.conclude()
}

/// Returns the names of the integration tests of all crates, in order.
fn integration_tests() -> Result<Vec<String>, String> {
    let output = cargo(["metadata", "--no-deps", "--format-version", "1"]).output();
    let output = output.map_err(|error| format!("cargo metadata: {error}"))?;
    let text = String::from_utf8_lossy(&output.stdout);
    // `"kind":["test"],"crate_types":["bin"],"name":"optics","src_path":...`
    let mut found: Vec<String> = text
        .split("\"kind\":[\"test\"]")
        .skip(1)
        .filter_map(|target| Some(target.split_once("\"name\":\"")?.1.split_once('"')?.0.to_owned()))
        .collect();
    found.sort();
    if found.is_empty() { Err("cargo metadata lists no integration tests".to_owned()) } else { Ok(found) }
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
    // Not through cargo: for this program alone it would compile nearly everything again, with other features of the
    // dependencies.
    let mut papilio = command(shell::papilio_for_tests(), ["run"]);
    papilio.arg(scenario).arg("--out").arg(out);
    shell::run(papilio)
}

/// Numbers of passed and failed checks, with reasons and times.
#[derive(Default)]
struct Count {
    passed: u64,
    failed: u64,
    reasons: Vec<String>,
    skipped: Vec<String>,
    /// Names and durations of the steps.
    steps: Vec<(&'static str, Duration)>,
}

impl Count {
    /// Runs a step and records its duration.
    fn step<T>(&mut self, name: &'static str, work: impl FnOnce(&mut Self) -> T) -> T {
        let begun = Instant::now();
        let done = work(self);
        self.steps.push((name, begun.elapsed()));
        done
    }

    fn check(&mut self, outcome: Outcome) {
        match outcome {
            Ok(()) => self.passed += 1,
            Err(why) => self.fail(1, why),
        }
    }

    fn fail(&mut self, count: u64, why: String) {
        self.failed += count;
        self.reasons.push(why);
    }

    /// Runs cargo's tests, and in parallel the others: the commands of each list one after the other.
    fn together<const LISTS: usize>(
        &mut self,
        tests: Command,
        others: [Vec<(&'static str, Command)>; LISTS],
    ) {
        let others = others.map(|list| {
            std::thread::spawn(move || -> Vec<(&'static str, Apart, Duration)> {
                let timed = |(name, other)| {
                    let begun = Instant::now();
                    (name, shell::run_apart(other), begun.elapsed())
                };
                list.into_iter().map(timed).collect()
            })
        });
        self.step("  cargo", |count| count.tests(tests));
        for list in others {
            let Ok(list) = list.join() else { return self.fail(1, "the other tests: panicked".to_owned()) };
            list.into_iter().for_each(|(name, other, took)| self.counted(name, &other, took));
        }
    }

    /// Shows and counts tests that ran in parallel with others.
    fn counted(&mut self, name: &'static str, other: &Apart, took: Duration) {
        self.steps.push((name, took));
        other.show();
        let counted = other.texts[0].lines().filter_map(counts);
        let (passed, failed) = counted.fold((0, 0), |sum, (p, f)| (sum.0 + p, sum.1 + f));
        self.passed += passed;
        if let Err(why) = &other.outcome {
            self.fail(failed.max(1), why.clone());
        }
    }

    /// Runs the tests and adds up the summaries of the test programs.
    fn tests(&mut self, tests: Command) {
        let (mut passed, mut failed) = (0, 0);
        let mut read = |line: &str| {
            if let Some((p, f)) = counts(line) {
                passed += p;
                failed += f;
            }
        };
        let outcome = shell::run_and_read(tests, Some(&mut read));
        self.passed += passed;
        if let Err(why) = outcome {
            // Tests that do not compile print no summary.
            self.fail(failed.max(1), why);
        }
    }

    /// Builds the page and returns the browser to test it in. The page and its tests need additional tools; if one is
    /// missing, both are skipped, which the output states.
    fn page(&mut self) -> Option<PathBuf> {
        let browser = match page::browser() {
            Ok(browser) => browser,
            Err(missing) => {
                self.skipped.push(format!("the web app's page: {missing}"));
                return None;
            }
        };
        let built = page::build();
        let is_built = built.is_ok();
        self.check(built);
        is_built.then_some(browser)
    }

    /// Builds the wheel of the Python package in the development profile and returns its environment. Skipped if Python
    /// is missing.
    fn package(&mut self) -> Option<Environment> {
        let environment = match self.step("Python, environment", |_| package::environment()) {
            Ok(environment) => environment,
            Err(missing) => {
                self.skipped.push(format!("the Python package: {missing}"));
                return None;
            }
        };
        match self.step("Python, wheel", |_| package::build(&environment, Profile::Dev)) {
            Ok(()) => Some(environment),
            Err(why) => {
                self.fail(1, why);
                None
            }
        }
    }

    fn conclude(self) -> Outcome {
        println!();
        // An indented step is part of the step below it.
        let whole = self.steps.iter().filter(|(name, _)| !name.starts_with(' '));
        let all: Duration = whole.map(|(_, took)| *took).sum();
        for (name, took) in self.steps.iter().copied().chain([("all", all)]) {
            println!("{name:<20} {:7.1} s", took.as_secs_f64());
        }
        self.skipped.iter().for_each(|what| println!("skipped: {what}"));
        self.reasons.iter().for_each(|why| println!("failed: {why}"));
        println!("{} passed, {} failed", self.passed, self.failed);
        if self.failed == 0 { Ok(()) } else { Err("not green".to_owned()) }
    }
}

/// Returns the numbers of passed and failed tests from a summary line of any test program.
fn counts(line: &str) -> Option<(u64, u64)> {
    summary(line).or_else(|| summary_of_node(line)).or_else(|| summary_of_pytest(line))
}

/// Returns the numbers of passed and failed tests from a line like `test result: ok. 5 passed; 0 failed; 0 ignored; ...`.
fn summary(line: &str) -> Option<(u64, u64)> {
    let (_, counts) = line.strip_prefix("test result: ")?.split_once(". ")?;
    let of = |what: &str| {
        let part = counts.split("; ").find_map(|part| part.strip_suffix(what))?;
        part.trim().parse().ok()
    };
    Some((of("passed")?, of("failed")?))
}

/// Returns the numbers of passed and failed tests from a line of node like `# pass 25` or `# fail 1`.
fn summary_of_node(line: &str) -> Option<(u64, u64)> {
    let (_, counts) = line.split_once([' ']).filter(|(mark, _)| matches!(*mark, "#" | "\u{2139}"))?;
    let of = |what: &str| counts.strip_prefix(what)?.trim().parse().ok();
    of("pass ").map(|passed| (passed, 0)).or_else(|| of("fail ").map(|failed| (0, failed)))
}

/// Returns the numbers of passed and failed tests from the last line of pytest like `1 failed, 12 passed, 1 error in 1.33s`.
fn summary_of_pytest(line: &str) -> Option<(u64, u64)> {
    let (counts, _) = line.trim_matches(['=', ' ']).split_once(" in ")?;
    let of = |what: &[&str]| {
        let part =
            counts.split(", ").find_map(|part| part.split_once(' ').filter(|(_, of)| what.contains(of)));
        part.map_or(Some(0), |(count, _)| count.parse::<u64>().ok())
    };
    let (passed, failed, errors) = (of(&["passed"])?, of(&["failed"])?, of(&["error", "errors"])?);
    (passed + failed + errors > 0).then_some((passed, failed + errors))
}

#[cfg(test)]
mod tests {
    use super::{summary, summary_of_node, summary_of_pytest};

    #[test]
    fn pytest_summary_is_parsed() {
        assert_eq!(summary_of_pytest("12 passed in 1.33s"), Some((12, 0)));
        assert_eq!(
            summary_of_pytest("=== 1 failed, 12 passed, 2 warnings, 3 errors in 70.21s (0:01:10) ==="),
            Some((12, 4))
        );
        assert_eq!(summary_of_pytest("collected 12 items in all"), None);
        assert_eq!(summary_of_pytest("no tests ran in 0.01s"), None);
    }

    #[test]
    fn node_summary_is_parsed() {
        assert_eq!(summary_of_node("# pass 25"), Some((25, 0)));
        assert_eq!(summary_of_node("\u{2139} fail 2"), Some((0, 2)));
        assert_eq!(summary_of_node("# tests 27"), None);
        assert_eq!(summary_of_node("pass 3"), None);
    }

    #[test]
    fn cargo_summary_is_parsed() {
        let line = "test result: FAILED. 12 passed; 3 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.1s";
        assert_eq!(summary(line), Some((12, 3)));
        assert_eq!(summary("running 15 tests"), None);
        assert_eq!(summary("test result: a line that a test printed"), None);
    }
}
