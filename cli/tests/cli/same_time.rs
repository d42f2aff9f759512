//! Several programs at the same time that write results without `--out`: each one has a folder of its own.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use crate::common::{files, papilio_command, same, scenario, stderr};

/// A run of the indoor scenario in a folder, by a number of paths with a seed.
fn run(folder: &Path, paths: &str, seed: u32) -> Command {
    let mut command = papilio_command();
    command.current_dir(folder).arg("run").arg(scenario("indoor")).args(["--solver", "monte-carlo"]);
    command.args(["--set", &format!("solver.paths={paths}"), "--set", &format!("solver.seed={seed}")]);
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

/// The folders of results.
fn results(folder: &Path) -> Vec<PathBuf> {
    fs::read_dir(folder.join("out")).unwrap().map(|entry| entry.unwrap().path()).collect()
}

#[test]
fn runs_at_the_same_time_have_a_whole_folder_each() {
    let seeds = [1, 2, 3, 4];
    let alone = seeds.map(|seed| {
        let folder = tempfile::tempdir().unwrap();
        let output = run(folder.path(), "20000", seed).args(["--out", "here"]).output().unwrap();
        assert!(output.status.success(), "{}", stderr(&output));
        files(&folder.path().join("here"))
    });
    let together = tempfile::tempdir().unwrap();
    let children = seeds.map(|seed| run(together.path(), "20000", seed).spawn().unwrap());
    for child in children {
        let output = child.wait_with_output().unwrap();
        assert!(output.status.success(), "{}", stderr(&output));
    }
    let found: Vec<BTreeMap<String, Vec<u8>>> =
        results(together.path()).iter().map(|folder| files(folder)).collect();
    assert_eq!(found.len(), seeds.len(), "{:?}", results(together.path()));
    for expected in &alone {
        let own = found.iter().find(|files| files.get("result.json") == expected.get("result.json"));
        same(own.unwrap(), expected);
    }
}

/// A run that takes very long, as soon as it has begun.
fn long_run(folder: &Path) -> Child {
    let child = run(folder, "2000000000", 1).spawn().unwrap();
    let begun = Instant::now();
    while !folder.join("out").join("indoor").exists() {
        assert!(begun.elapsed() < Duration::from_secs(60), "the run does not begin");
        thread::sleep(Duration::from_millis(5));
    }
    // The folder exists for a moment before it is claimed.
    thread::sleep(Duration::from_millis(200));
    child
}

#[test]
fn folder_of_a_killed_run_is_used_again() {
    let folder = tempfile::tempdir().unwrap();
    let own = folder.path().join("out").join("indoor");
    let mut child = long_run(folder.path());
    let other = run(folder.path(), "2000", 2).output().unwrap();
    let said = stderr(&other);
    assert!(other.status.success() && said.contains("is being written by another program"), "{said}");
    assert_eq!(results(folder.path()).len(), 2);
    child.kill().unwrap();
    child.wait().unwrap();
    let again = run(folder.path(), "2000", 3).output().unwrap();
    let said = stderr(&again);
    assert!(again.status.success() && !said.contains("another program"), "{said}");
    assert!(files(&own).contains_key("result.json"));
    let hidden = files(&own).into_keys().find(|name| name.starts_with('.'));
    assert_eq!(hidden, None, "a file of the claim is left");
}

/// A command that fails after it has claimed a folder removes the folder.
#[test]
fn failed_command_leaves_no_folder() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["compare", "result.json", "missing.csv"];
    let output = papilio_command().current_dir(folder.path()).args(arguments).output().unwrap();
    assert!(!output.status.success() && stderr(&output).contains("missing.csv"), "{}", stderr(&output));
    assert!(!folder.path().join("out").exists());
}
