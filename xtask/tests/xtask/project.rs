//! The lists of the project: every shipped file of data has its source in docs/provenance.md, every package
//! its licence in release/THIRD-PARTY.md; CITATION.cff states the present version.

use std::collections::BTreeSet;
use std::fs;

use serde_json::Value;

use crate::{read, root};

/// The files below a folder, as paths relative to it, without those of the given endings.
fn files(folder: &str, without: &[&str]) -> BTreeSet<String> {
    let root = root().join(folder);
    let mut open = vec![root.clone()];
    let mut found = BTreeSet::new();
    while let Some(folder) = open.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                open.push(path);
            } else if !without.iter().any(|ending| path.to_string_lossy().ends_with(ending)) {
                let name = path.strip_prefix(&root).unwrap().to_string_lossy().replace('\\', "/");
                found.insert(name);
            }
        }
    }
    found
}

/// The names before the colons of the list of a section, or in the first cells of its table.
fn listed(page: &str, section: &str) -> BTreeSet<String> {
    let (_, rest) =
        page.split_once(&format!("## `{section}`")).unwrap_or_else(|| panic!("no section {section}"));
    let rows = rest.split("\n## ").next().unwrap().lines();
    let rows = rows.filter(|line| line.starts_with("- `") || line.starts_with("| `"));
    let cells = rows.map(|row| row.split([':', '|']).find(|cell| cell.contains('`')).unwrap());
    cells.flat_map(|cell| cell.split('`').skip(1).step_by(2)).map(str::to_owned).collect()
}

#[test]
fn files_of_data_are_those_of_the_page_of_provenance() {
    let page = read("docs/provenance.md");
    let no_data = [
        ".rs",
        ".py",
        ".md",
        ".toml",
        ".html",
        ".css",
        ".js",
        "LICENSE",
        "LICENSE.txt",
        "Cargo.lock",
        ".pyc",
    ];
    for folder in [
        "crates/spectra/data",
        "crates/colour/data",
        "crates/imaging/fonts",
        "site/assets",
        "crates/scenario/src/preset",
        "scenarios/data",
        "surfaces",
        "validation",
    ] {
        assert_eq!(files(folder, &no_data), listed(&page, folder), "{folder}: files, and docs/provenance.md");
    }
}

#[test]
fn version_of_the_citation_is_that_of_the_workspace() {
    let version = |name: &str, key: &str| {
        let text = read(name);
        let value = text
            .lines()
            .find_map(|line| line.strip_prefix(key))
            .unwrap_or_else(|| panic!("{name}: no {key}"));
        value.trim_matches('"').to_owned()
    };
    assert_eq!(version("CITATION.cff", "version: "), version("Cargo.toml", "version = "));
}

/// Names and versions in the rows or items of release/THIRD-PARTY.md below a heading.
fn packages(page: &str, heading: &str) -> BTreeSet<(String, String)> {
    let (_, rest) =
        page.split_once(&format!("\n## {heading}\n")).unwrap_or_else(|| panic!("no heading {heading}"));
    let lines = rest.split("\n## ").next().unwrap().lines();
    let words = lines.filter_map(|line| {
        let row = line.strip_prefix("| ").filter(|row| !row.starts_with("package |"));
        let mut words = row.map(|row| row.split(" | ")).into_iter().flatten();
        let item = line.strip_prefix("- ").and_then(|item| item.split_once(' '));
        item.or_else(|| Some((words.next()?, words.next()?)))
    });
    words.map(|(name, version)| (name.to_owned(), version.to_owned())).collect()
}

#[test]
fn third_party_packages_are_those_of_the_lock_files() {
    let page = read("release/THIRD-PARTY.md");
    let linked = packages(&page, "In the program and the Python package");
    let others = packages(&page, "For tests, benchmarks and builds only");
    assert!(linked.len() > 100 && !others.is_empty(), "{} and {}", linked.len(), others.len());
    let lock = read("Cargo.lock");
    let text = |package: &str, key: &str| {
        package.lines().find_map(|line| Some(line.strip_prefix(key)?.trim_matches('"').to_owned())).unwrap()
    };
    let locked = lock.split("[[package]]\n").filter(|package| package.contains("\nsource = "));
    let locked: BTreeSet<_> =
        locked.map(|package| (text(package, "name = "), text(package, "version = "))).collect();
    let listed = &linked | &others;
    let differs: Vec<_> = listed.symmetric_difference(&locked).collect();
    assert!(differs.is_empty(), "run `cargo xtask licences`: {differs:?}");

    let lock: Value = serde_json::from_str(&read("web/page/package-lock.json")).unwrap();
    let locked = lock["packages"].as_object().unwrap().iter();
    let locked = locked.filter(|(place, about)| !place.is_empty() && about["dev"] != true);
    let locked = locked.map(|(place, about)| {
        let name = place.rsplit_once("node_modules/").unwrap().1.to_owned();
        (name, about["version"].as_str().unwrap().to_owned())
    });
    let listed = packages(&page, "In the page of the web app");
    assert_eq!(listed, locked.collect(), "run `cargo xtask licences`");
}
