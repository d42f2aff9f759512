//! The manifests of the workspace, as cargo reads them.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::LazyLock;

use serde_json::Value;

use crate::{read, root};

/// A package of the workspace.
pub(crate) struct Manifest {
    pub(crate) name: String,
    /// Folder of the package.
    pub(crate) folder: PathBuf,
    /// What `cargo metadata` says of it.
    pub(crate) about: Value,
}

impl Manifest {
    /// True if it can be published.
    pub(crate) fn is_public(&self) -> bool {
        self.about["publish"].is_null()
    }

    /// A list of texts, for example `keywords`.
    pub(crate) fn list(&self, key: &str) -> Vec<&str> {
        self.about[key].as_array().unwrap().iter().map(|item| item.as_str().unwrap()).collect()
    }
}

/// The packages that are compiled for this machine, those of others too, as `cargo metadata` describes them.
pub(crate) fn compiled() -> Vec<Value> {
    let host = Command::new("rustc").args(["--print", "host-tuple"]).output().unwrap();
    metadata(&["--filter-platform", String::from_utf8(host.stdout).unwrap().trim()])
}

static OWN: LazyLock<Vec<Value>> = LazyLock::new(|| metadata(&["--no-deps"]));

fn metadata(options: &[&str]) -> Vec<Value> {
    let mut cargo = Command::new(env!("CARGO"));
    cargo.args(["metadata", "--format-version", "1", "--locked"]).args(options).current_dir(root());
    let output = cargo.output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let mut about: Value = serde_json::from_slice(&output.stdout).unwrap();
    let Value::Array(packages) = about["packages"].take() else { panic!("cargo metadata lists packages") };
    packages
}

/// The packages of the workspace.
pub(crate) fn all() -> Vec<Manifest> {
    let own = OWN.iter().map(|about| Manifest {
        name: about["name"].as_str().unwrap().to_owned(),
        folder: PathBuf::from(about["manifest_path"].as_str().unwrap()).parent().unwrap().to_owned(),
        about: about.clone(),
    });
    own.collect()
}

/// The packages that can be published.
pub(crate) fn public() -> Vec<Manifest> {
    all().into_iter().filter(Manifest::is_public).collect()
}

/// Packages with the features that a selection of the workspace compiles, without those of default features.
fn features(selection: &[&str]) -> BTreeSet<String> {
    let mut cargo = Command::new(env!("CARGO"));
    cargo.args(["tree", "--locked", "--no-default-features", "--prefix", "none"]);
    let output = cargo.args(["--format", "{p} {f}"]).args(selection).current_dir(root()).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    // The mark of a package whose dependencies stand above; each of them repeated would be a million lines.
    text.lines().map(|line| line.trim_end_matches("(*)").trim_end().to_owned()).collect()
}

/// Otherwise the daily checks compile or check the packages that differ, and all above them, twice: the
/// dependencies of `papilio-python` that it does not use itself make them the same.
#[test]
fn tests_wheel_and_documentation_compile_the_same_packages() {
    let tests = features(&["--workspace", "--edges", "normal,build,dev"]);
    for selection in [&["--package", "papilio-python"][..], &["--workspace"]] {
        let all = features(&[selection, &["--edges", "normal,build"]].concat());
        let others: Vec<&String> = all.difference(&tests).collect();
        assert!(all.len() > 100 && others.is_empty(), "{selection:?}: {others:?}");
    }
}

/// The code map of ARCHITECTURE.md lists the crates from the lowest to the highest.
#[test]
fn crates_depend_only_on_crates_above_them_in_the_code_map() {
    let page = read("ARCHITECTURE.md");
    let (_, map) = page.split_once("\n## Code map\n").unwrap();
    let rows = map.split("\n## ").next().unwrap().lines().filter_map(|line| line.strip_prefix("| "));
    let cells: Vec<&str> = rows.map(|row| row.split(" |").next().unwrap().trim_matches('`')).collect();
    let row = |folder: &Path| {
        let folder = folder.strip_prefix(root()).unwrap().to_string_lossy().replace('\\', "/");
        let listed = |cell: &&str| **cell == folder || (folder.is_empty() && cell.starts_with("the top"));
        cells.iter().position(listed).unwrap_or_else(|| panic!("ARCHITECTURE.md: {folder}?"))
    };
    let (mut wrong, mut found) = (Vec::new(), 0);
    for package in all() {
        for dependency in package.about["dependencies"].as_array().unwrap() {
            let Some(path) = dependency["path"].as_str().filter(|_| dependency["kind"] != "dev") else {
                continue;
            };
            found += 1;
            if row(Path::new(path)) >= row(&package.folder) {
                wrong.push(format!("{} depends on {}", package.name, dependency["name"]));
            }
        }
    }
    assert!(found > 50 && wrong.is_empty(), "{found} dependencies: {wrong:?}");
}
