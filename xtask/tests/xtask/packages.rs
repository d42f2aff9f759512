//! What the registry asks of the crates, and what a package must carry.

use std::collections::BTreeSet;

use crate::manifests::{all, public};
use crate::root;

/// Categories of the registry that fit some crate here.
const CATEGORIES: [&str; 11] = [
    "command-line-utilities",
    "development-tools",
    "graphics",
    "mathematics",
    "multimedia::images",
    "parser-implementations",
    "rendering",
    "science",
    "simulation",
    "visualization",
    "web-programming::http-server",
];

#[test]
fn tools_and_tests_alone_cannot_be_published() {
    let private: BTreeSet<String> =
        all().into_iter().filter(|package| !package.is_public()).map(|package| package.name).collect();
    for name in ["papilio-python", "papilio-testing", "papilio-validation", "xtask"] {
        assert!(private.contains(name), "{name}");
    }
    let of_users = ["papilio", "papilio-display", "papilio-scenario", "papilio-web", "papilio-examples"];
    assert!(of_users.iter().all(|name| !private.contains(*name)), "{private:?}");
}

#[test]
fn public_crates_have_what_the_registry_asks_for() {
    for package in public() {
        let name = &package.name;
        let text = |key: &str| package.about[key].as_str().unwrap_or_default().to_owned();
        assert!(text("description").len() > 20 && text("license").contains("MIT OR Apache-2.0"), "{name}");
        assert_eq!(package.list("authors"), ["The Papilio developers"], "{name}");
        let keywords = package.list("keywords");
        assert!((1..=5).contains(&keywords.len()), "{name}: at most five keywords: {keywords:?}");
        for word in keywords {
            let plain = |letter: char| letter.is_ascii_alphanumeric() || "-_+".contains(letter);
            assert!(
                word.len() <= 20 && word.starts_with(char::is_alphabetic) && word.chars().all(plain),
                "{name}: {word}"
            );
        }
        let categories = package.list("categories");
        assert!((1..=5).contains(&categories.len()), "{name}: {categories:?}");
        assert!(categories.iter().all(|category| CATEGORIES.contains(category)), "{name}: {categories:?}");
        // No address is known yet where the project could be found (RELEASING.md).
        assert!(
            ["repository", "homepage", "documentation"].iter().all(|key| package.about[*key].is_null()),
            "{name}"
        );
    }
}

/// Cargo leaves out development dependencies without a version; any other must be in the registry, too.
#[test]
fn public_crates_depend_on_public_crates_with_versions() {
    let names: BTreeSet<String> = public().into_iter().map(|package| package.name).collect();
    for package in public() {
        for dependency in package.about["dependencies"].as_array().unwrap() {
            let other = dependency["name"].as_str().unwrap();
            let required = dependency["req"].as_str().unwrap();
            if dependency["path"].is_null() || (dependency["kind"] == "dev" && required == "*") {
                continue;
            }
            assert!(names.contains(other) && required != "*", "{} needs {other} {required}", package.name);
        }
    }
}

#[test]
fn public_crates_carry_the_licences_and_no_file_of_other_folders() {
    for package in public() {
        for licence in ["LICENSE-MIT", "LICENSE-APACHE"] {
            let own = std::fs::read_to_string(package.folder.join(licence)).unwrap();
            let of_project = std::fs::read_to_string(root().join(licence)).unwrap();
            // A checkout without symbolic links has the path of the file instead.
            assert!(own == of_project || own.ends_with(licence), "{}: {licence}", package.name);
        }
        // The package at the top has no folder `src`, and includes by paths of its own.
        for (path, text) in sources(&package.folder.join("src")) {
            let depth = path.strip_prefix(&package.folder).unwrap().components().count() - 1;
            let outside = format!("include_str!(\"{}", "../".repeat(depth + 1));
            assert!(!text.contains(&outside), "{}", path.display());
            assert!(!text.contains(&outside.replace("str", "bytes")), "{}", path.display());
        }
    }
}

/// Paths and texts of the Rust files in a folder.
fn sources(folder: &std::path::Path) -> Vec<(std::path::PathBuf, String)> {
    let Ok(entries) = folder.read_dir() else { return Vec::new() };
    let mut found = Vec::new();
    for path in entries.flatten().map(|entry| entry.path()) {
        if path.is_dir() {
            found.extend(sources(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push((path.clone(), std::fs::read_to_string(&path).unwrap()));
        }
    }
    found
}
