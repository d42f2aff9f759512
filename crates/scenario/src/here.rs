//! Paths in `--set`: they are relative to the current folder, paths in a scenario to the folder of the
//! scenario.
//!
//! A text in `--set` that is the path of a file in the current folder is replaced by the path of this file
//! from the folder of the scenario, so that all later steps have one kind of path. Other texts do not change:
//! a path that leads nowhere from the current folder is tried from the folder of the scenario.

use std::path::{Component, Path, PathBuf};

use serde_json::Value as Json;

use crate::tree::{Node, Value};

/// Keys whose text is never a path.
const FREE_TEXT: [&str; 2] = ["title", "sample"];

/// Replaces the paths in the value of a key for the folder of the scenario.
pub(crate) fn relocate(node: &mut Node, key: &str, folder: &Path) {
    match &mut node.value {
        Value::Text(text) => {
            if let Some(path) = from_folder(text, key, folder) {
                *text = path;
            }
        }
        Value::Array(items) => items.iter_mut().for_each(|item| relocate(item, key, folder)),
        Value::Table(entries) => {
            entries.iter_mut().for_each(|entry| relocate(&mut entry.node, &entry.key, folder));
        }
        _ => {}
    }
}

/// As [`relocate`], for JSON.
pub(crate) fn relocate_json(value: &mut Json, key: &str, folder: &Path) {
    match value {
        Json::String(text) => {
            if let Some(path) = from_folder(text, key, folder) {
                *text = path;
            }
        }
        Json::Array(items) => items.iter_mut().for_each(|item| relocate_json(item, key, folder)),
        Json::Object(entries) => {
            entries.iter_mut().for_each(|(key, value)| relocate_json(value, key, folder))
        }
        _ => {}
    }
}

/// Returns whether a text has the form of a path, and not that of a name.
pub fn looks_like_path(text: &str) -> bool {
    text.contains(['/', '\\']) || text.rsplit_once('.').is_some_and(|(_, end)| !end.is_empty())
}

/// Returns the path, from a folder, of a file in the current folder; `None` if the text is no path, or from
/// the folder the same.
fn from_folder(text: &str, key: &str, folder: &Path) -> Option<String> {
    let path = Path::new(text);
    if FREE_TEXT.contains(&key) || !looks_like_path(text) || path.is_absolute() || !path.is_file() {
        return None;
    }
    let relative = relative_path(folder, Path::new(""))?.join(path);
    // A link among the folders can lead elsewhere.
    let leads_there = folder.join(&relative).canonicalize().ok() == path.canonicalize().ok();
    let relative = if leads_there { relative } else { std::path::absolute(path).ok()? };
    Some(relative.display().to_string()).filter(|relative| relative != text)
}

/// Returns the path of a file as a user in the current folder would write it: errors state it, and editors find it.
pub(crate) fn path_from_here(path: &Path) -> String {
    let relative = relative_path(Path::new(""), path).filter(|relative| {
        let is_near = path.is_relative() || !relative.starts_with("..");
        // A link among the folders can lead elsewhere.
        is_near && relative.canonicalize().ok() == path.canonicalize().ok()
    });
    let absolute = || {
        let plain: PathBuf = without_parents(path).into_iter().collect();
        if plain.canonicalize().ok() == path.canonicalize().ok() { plain } else { path.to_owned() }
    };
    relative.unwrap_or_else(absolute).display().to_string()
}

/// Returns the relative path from one folder to another; an empty path is the current folder.
pub fn relative_path(from: &Path, to: &Path) -> Option<PathBuf> {
    let absolute =
        |path: &Path| std::path::absolute(if path.as_os_str().is_empty() { Path::new(".") } else { path });
    let (from, to) = (absolute(from).ok()?, absolute(to).ok()?);
    let (from, to) = (without_parents(&from), without_parents(&to));
    let shared = from.iter().zip(&to).take_while(|(a, b)| a == b).count();
    let up = from[shared..].iter().map(|_| Component::ParentDir);
    Some(up.chain(to[shared..].iter().copied()).collect())
}

/// Returns the components of an absolute path, without `..` and what they go back from.
fn without_parents(path: &Path) -> Vec<Component<'_>> {
    let mut components = Vec::new();
    for component in path.components() {
        match component {
            Component::ParentDir => _ = components.pop(),
            other => components.push(other),
        }
    }
    components
}

#[cfg(test)]
mod tests {
    use super::*;

    // Tests run in the folder of the crate.
    #[test]
    fn path_of_a_file_in_the_current_folder_is_given_from_the_folder_of_the_scenario() {
        let scenarios = Path::new("../../scenarios");
        let file = "src/here.rs";
        let here = from_folder(file, "file", scenarios).unwrap();
        assert!(here.ends_with("crates/scenario/src/here.rs") && here.starts_with(".."), "{here}");
        assert!(scenarios.join(&here).is_file());
        assert_eq!(from_folder(file, "file", Path::new("")), None, "the same folder");
        assert_eq!(from_folder(file, "title", scenarios), None, "a title");
        assert_eq!(from_folder("data/H78.bsdf", "file", scenarios), None, "not in the current folder");
        assert_eq!(from_folder("src", "file", scenarios), None, "a folder");
    }

    #[test]
    fn path_of_a_file_is_stated_from_the_current_folder() {
        let shown = |path: &str| path_from_here(Path::new(path));
        assert_eq!(shown("../scenario/src/here.rs"), "src/here.rs");
        assert_eq!(shown("../../scenarios/epaper.toml"), "../../scenarios/epaper.toml");
        let here = std::path::absolute("src/here.rs").unwrap();
        assert_eq!(shown(here.to_str().unwrap()), "src/here.rs");
        assert_eq!(shown("/usr/../no/such.csv"), "/no/such.csv");
    }

    #[test]
    fn paths_in_lists_and_tables_are_replaced() {
        let value =
            "{ file = \"src/here.rs\", title = \"src/here.rs\", many = [\"src/here.rs\", \"Al\", 1] }";
        let (mut node, wrong) = Node::parse_value(value, 0, 1);
        assert!(wrong.is_none());
        let mut json = node.to_json();
        relocate(&mut node, "diffuser", Path::new("src"));
        relocate_json(&mut json, "diffuser", Path::new("src"));
        assert_eq!(node.to_json(), json);
        assert_eq!(json["file"], "../src/here.rs");
        assert_eq!(json["title"], "src/here.rs");
        assert_eq!(json["many"][1], "Al");
    }
}
