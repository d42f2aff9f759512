//! One version everywhere, and the oldest Rust.

use crate::manifests::{all, compiled};
use crate::{read, root};

fn workspace() -> toml::Table {
    read("Cargo.toml").parse().unwrap()
}

#[test]
fn all_packages_have_one_version() {
    let root_manifest = workspace();
    let version = root_manifest["workspace"]["package"]["version"].as_str().unwrap();
    for package in all() {
        assert_eq!(package.about["version"].as_str(), Some(version), "{}", package.name);
    }
    for (name, about) in root_manifest["workspace"]["dependencies"].as_table().unwrap() {
        let required = about.get("version").filter(|_| about.get("path").is_some());
        assert!(required.is_none_or(|required| required.as_str() == Some(version)), "{name}");
    }
    // The Python package takes the version of its crate.
    let python: toml::Table = read("python/pyproject.toml").parse().unwrap();
    let dynamic = python["project"]["dynamic"].as_array().unwrap();
    assert!(
        dynamic.iter().any(|key| key.as_str() == Some("version"))
            && !python["project"].as_table().unwrap().contains_key("version")
    );
    let Ok(citation) = std::fs::read_to_string(root().join("CITATION.cff")) else { return };
    let cited = citation.lines().find_map(|line| line.strip_prefix("version:")).unwrap();
    assert_eq!(cited.trim().trim_matches('"'), version, "CITATION.cff");
}

#[test]
fn changes_of_the_version_come_before_those_of_older_ones() {
    let root_manifest = workspace();
    let version = root_manifest["workspace"]["package"]["version"].as_str().unwrap();
    let changes = read("CHANGELOG.md");
    let mut titles = changes.lines().filter_map(|line| line.strip_prefix("## "));
    let first = titles.next().unwrap();
    let is_released = first.contains(version);
    assert!(is_released || first.to_lowercase().contains("unreleased"), "{first}");
}

/// rust-version is a promise: no library may need a newer Rust.
#[test]
fn no_library_needs_a_newer_rust_than_this_project() {
    let root_manifest = workspace();
    let number = |text: &str| -> Vec<u32> { text.split('.').map(|part| part.parse().unwrap()).collect() };
    let ours = number(root_manifest["workspace"]["package"]["rust-version"].as_str().unwrap());
    let mut known = 0;
    for package in compiled() {
        let Some(theirs) = package["rust_version"].as_str() else { continue };
        known += 1;
        assert!(
            number(theirs)[..2] <= ours[..2],
            "{} {} needs Rust {theirs}",
            package["name"],
            package["version"]
        );
    }
    assert!(known > 100, "cargo metadata lists the libraries");
}
