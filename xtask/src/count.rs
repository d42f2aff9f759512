//! Jobs that run in parallel, and the count of what they checked.

use std::path::PathBuf;
use std::process::Command;
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use crate::page;
use crate::programs;
use crate::python::Environment;
use crate::shell::{self, Apart, Outcome};

/// What the outcome of a command means.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Purpose {
    /// Its output counts tests.
    Tests,
    /// It is one check.
    Check,
    /// The rest of its list needs it.
    Needed,
}

/// A command that may run in parallel with others.
pub(crate) struct Job {
    name: &'static str,
    command: Command,
    purpose: Purpose,
}

/// A job that has run.
pub(crate) struct Done {
    name: &'static str,
    run: Apart,
    purpose: Purpose,
    took: Duration,
}

impl Job {
    pub(crate) fn tests(name: &'static str, command: Command) -> Self {
        Self { name, command, purpose: Purpose::Tests }
    }

    pub(crate) fn check(name: &'static str, command: Command) -> Self {
        Self { name, command, purpose: Purpose::Check }
    }

    pub(crate) fn needed(name: &'static str, command: Command) -> Self {
        Self { name, command, purpose: Purpose::Needed }
    }

    fn run(self) -> Done {
        let begun = Instant::now();
        let run = shell::run_apart(self.command);
        Done { name: self.name, run, purpose: self.purpose, took: begun.elapsed() }
    }

    /// Runs jobs one after the other, up to the first failure of one that the rest needs.
    pub(crate) fn run_all(list: Vec<Self>) -> Vec<Done> {
        let mut all = Vec::new();
        for job in list {
            let done = job.run();
            let is_end = done.purpose == Purpose::Needed && done.run.outcome.is_err();
            all.push(done);
            if is_end {
                break;
            }
        }
        all
    }
}

/// Numbers of passed and failed checks, with reasons and times.
#[derive(Default)]
pub(crate) struct Count {
    passed: u64,
    failed: u64,
    reasons: Vec<String>,
    skipped: Vec<String>,
    /// Names and durations of the steps.
    steps: Vec<(&'static str, Duration)>,
}

impl Count {
    /// Runs a step and records its duration.
    pub(crate) fn step<T>(&mut self, name: &'static str, work: impl FnOnce(&mut Self) -> T) -> T {
        let begun = Instant::now();
        let done = work(self);
        self.steps.push((name, begun.elapsed()));
        done
    }

    pub(crate) fn check(&mut self, outcome: Outcome) {
        match outcome {
            Ok(()) => self.passed += 1,
            Err(why) => self.fail(1, why),
        }
    }

    fn fail(&mut self, count: u64, why: String) {
        self.failed += count;
        self.reasons.push(why);
    }

    /// Runs the test programs, and in parallel the others: the jobs of each list one after the other.
    pub(crate) fn together<const LISTS: usize>(&mut self, tests: Command, others: [Vec<Job>; LISTS]) {
        let others = others.map(|list| thread::spawn(move || Job::run_all(list)));
        self.step("  cargo", |count| count.programs(tests));
        for list in others {
            match list.join() {
                Ok(list) => list.into_iter().for_each(|done| self.counted(&done)),
                Err(_) => self.fail(1, "the other tests: panicked".to_owned()),
            }
        }
    }

    /// Runs the test programs of `cargo test`, several at a time.
    fn programs(&mut self, tests: Command) {
        match programs::compiled(tests) {
            Ok(all) => programs::run_all(all, &mut |run| self.shown(&run, Purpose::Tests)),
            Err(why) => self.fail(1, why),
        }
    }

    /// Shows and counts a job that ran in parallel with others.
    pub(crate) fn counted(&mut self, done: &Done) {
        self.steps.push((done.name, done.took));
        self.shown(&done.run, done.purpose);
    }

    /// Shows and counts what a command wrote.
    fn shown(&mut self, run: &Apart, purpose: Purpose) {
        run.show();
        let summaries = run.texts[0].lines().filter_map(counts);
        let (passed, failed) = summaries.fold((0, 0), |sum, (p, f)| (sum.0 + p, sum.1 + f));
        match &run.outcome {
            Ok(()) if purpose == Purpose::Check => self.passed += 1,
            Ok(()) => self.passed += passed,
            Err(why) => {
                self.passed += passed;
                self.fail(failed.max(1), why.clone());
            }
        }
    }

    /// Runs the tests and adds up the summaries of the test programs.
    pub(crate) fn tests(&mut self, tests: Command) {
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

    /// Builds the page and returns the browser to test it in. The page and its tests need additional tools;
    /// if one is missing, both are skipped, which the output states.
    pub(crate) fn page(&mut self) -> Option<PathBuf> {
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

    /// Waits for the environment of the Python package. `None` if Python is missing, which the output states.
    pub(crate) fn environment(
        &mut self,
        created: JoinHandle<Result<Environment, String>>,
    ) -> Option<Environment> {
        let created = self.step("Python, environment", |_| created.join());
        match created.unwrap_or_else(|_| Err("its environment: panicked".to_owned())) {
            Ok(environment) => Some(environment),
            Err(missing) => {
                self.skipped.push(format!("the Python package: {missing}"));
                None
            }
        }
    }

    pub(crate) fn conclude(self) -> Outcome {
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

/// Returns the numbers of passed and failed tests from a line like
/// `test result: ok. 5 passed; 0 failed; 0 ignored; ...`.
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

/// Returns the numbers of passed and failed tests from the last line of pytest like
/// `1 failed, 12 passed, 1 error in 1.33s`.
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
