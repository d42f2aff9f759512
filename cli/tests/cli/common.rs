//! Helpers that the tests of several commands share.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// The program, without colours.
pub(crate) fn papilio_command() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_papilio"));
    command.env("NO_COLOR", "1");
    command
}

/// Path of a shipped scenario.
pub(crate) fn scenario(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios").join(name).with_extension("toml")
}

/// A coarse spectrum, with which a cone map is fast; the files that are written do not depend on it.
pub(crate) const COARSE: [&str; 2] = ["--set", "spectrum.step_nm=20"];

/// Runs `papilio run` on a shipped scenario.
pub(crate) fn run_scenario(name: &str, more: &[&str]) -> Output {
    papilio_command().arg("run").arg(scenario(name)).args(more).output().unwrap()
}

/// Sorted names of the files of a folder.
pub(crate) fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap().map(Result::unwrap);
    let mut names: Vec<String> = entries.map(|entry| entry.file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// Runs the program.
pub(crate) fn papilio(arguments: &[&str]) -> Output {
    papilio_command().args(arguments).output().unwrap()
}

pub(crate) fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

pub(crate) fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

/// Every file of a folder.
pub(crate) fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(folder).unwrap().map(Result::unwrap);
    entries.map(|entry| (entry.file_name().into_string().unwrap(), fs::read(entry.path()).unwrap())).collect()
}

/// The same names, and the same bytes under each.
pub(crate) fn same(found: &BTreeMap<String, Vec<u8>>, expected: &BTreeMap<String, Vec<u8>>) {
    assert_eq!(found.keys().collect::<Vec<_>>(), expected.keys().collect::<Vec<_>>());
    let other: Vec<_> = found.keys().filter(|name| found[*name] != expected[*name]).collect();
    assert!(other.is_empty(), "{other:?} are not what they should be");
}

/// A scenario in a folder of its own, and where results go.
pub(crate) fn place(text: &str) -> (tempfile::TempDir, String, String) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("s.toml");
    fs::write(&file, text).unwrap();
    let out = folder.path().join("out");
    let [file, out] = [file, out].map(|path| path.to_str().unwrap().to_owned());
    (folder, file, out)
}
