//! `--set PATH=VALUE`: changes to a scenario from the command line, and those of a sweep or a search.
//!
//! The path is dotted; arrays are indexed from 0, and the index one beyond the
//! last appends. Of two keys that exclude each other (`haze` and `width`) a set one
//! replaces the file's; two set ones are an error. VALUE is TOML, or else a string. What is not there is made;
//! whether the schema has such a key is found out when the scenario is read.

use crate::error::Errors;
use crate::problem::Problem;
use crate::renamed::{OldName, present, rename};
use crate::source::{Origin, Sources};
use crate::tree::{Entry, Node, Value};

/// A path longer than this leads nowhere.
pub(crate) const MOST_SEGMENTS: usize = 16;

/// Where presets are named; they are set before any other key.
pub(crate) const PRESET_PATH: &str = "lighting.preset";

/// A change that is none of the user's `--set`: a value of a sweep, a search or a condition.
#[derive(Debug, Clone)]
pub(crate) struct Change {
    /// Dotted, as of `--set`.
    pub(crate) path: String,
    /// Where the path stands.
    pub(crate) origin: Origin,
    pub(crate) value: Node,
}

/// Applies each `--set` in turn, then the other changes: those of the preset alone, or all others. Old names of keys and
/// values that are set go to `old`.
pub(crate) fn apply(
    root: &mut Node,
    sources: &Sources,
    changes: &[Change],
    presets: bool,
    old: &mut Vec<OldName>,
    errors: &mut Errors,
) {
    let mut set: Vec<(Vec<&str>, Vec<&str>)> = Vec::new();
    for source in 1..=sources.overrides() {
        let text = sources.text(source);
        let Some((path, value)) = text.split_once('=') else {
            if !presets {
                errors.push(Origin { source, start: 0, end: text.len().max(1) }, Problem::SetWithoutValue);
            }
            continue;
        };
        if (path.trim() == PRESET_PATH) == presets {
            let blanks = value.len() - value.trim_start().len();
            let value = Node::parse_value(text, path.len() + 1 + blanks, source, errors);
            let path = segments(path, source);
            let spelt: Vec<&str> = path.iter().map(|(key, _)| *key).collect();
            let now = present(&spelt);
            if let Some((_, other)) = set.iter().find(|(path, other)| *path == now && *other != spelt) {
                let problem = Problem::BothNames { old: other.join("."), new: spelt.join(".") };
                errors.push(Origin { source, start: 0, end: text.len().max(1) }, problem);
            }
            set.push((now, spelt));
            if let Err((origin, problem)) = put(root, &path, value, old, errors) {
                errors.push(origin, problem);
            }
        }
    }
    for change in changes.iter().filter(|change| (change.path == PRESET_PATH) == presets) {
        let path: Vec<_> = change.path.split('.').map(|key| (key.trim(), change.origin)).collect();
        if let Err((origin, problem)) = put(root, &path, change.value.clone(), old, errors) {
            errors.push(origin, problem);
        }
    }
}

/// The keys of a path, each with its place.
fn segments(path: &str, source: usize) -> Vec<(&str, Origin)> {
    let mut start = 0;
    let mut segments = Vec::new();
    for part in path.split('.') {
        let trimmed = part.trim();
        let lead = part.len() - part.trim_start().len();
        let end = start + lead + trimmed.len().max(1);
        segments.push((trimmed, Origin { source, start: start + lead, end }));
        start += part.len() + 1;
    }
    segments
}

/// Puts a value at a path, whose old names are brought to the present ones, as are those in the value.
fn put(
    root: &mut Node,
    path: &[(&str, Origin)],
    mut value: Node,
    old: &mut Vec<OldName>,
    errors: &mut Errors,
) -> Result<(), (Origin, Problem)> {
    if let Some((_, origin)) = path.iter().find(|(key, _)| key.is_empty()) {
        return Err((*origin, Problem::SetPath { why: "this key is empty".to_owned() }));
    }
    if let Some((_, origin)) = path.get(MOST_SEGMENTS) {
        return Err((*origin, Problem::SetPath { why: "this path is too long".to_owned() }));
    }
    let spelt: Vec<&str> = path.iter().map(|(key, _)| *key).collect();
    let now = present(&spelt);
    for ((key, origin), new) in path.iter().zip(&now).filter(|((key, _), new)| key != *new) {
        old.push(OldName { origin: *origin, old: (*key).to_owned(), new: (*new).to_owned() });
    }
    rename(&mut value, &now, old, errors);
    let mut node = root;
    for (i, (key, (_, origin))) in now.iter().zip(path).enumerate() {
        if i + 1 == path.len() {
            drop_rival(node, key);
        }
        let next_is_index = path.get(i + 1).is_some_and(|(key, _)| key.parse::<usize>().is_ok());
        node = child(node, key, *origin, next_is_index)?;
    }
    *node = value;
    Ok(())
}

/// Keys of which a table may have one: setting one means to replace the other.
pub(crate) const RIVALS: [[&str; 2]; 4] = [
    ["relative_error", "paths"],
    ["haze", "width"],
    ["transmittance", "total_transmittance"],
    ["internal_transmittance", "thickness_mm"],
];

/// Takes the rival of `key` out of a table, where its value is the file's and not that of another `--set`.
fn drop_rival(table: &mut Node, key: &str) {
    let rival = RIVALS.iter().find_map(|[a, b]| match key {
        _ if key == *a => Some(*b),
        _ if key == *b => Some(*a),
        _ => None,
    });
    if let (Value::Table(entries), Some(rival)) = (&mut table.value, rival) {
        entries.retain(|entry| entry.key != rival || entry.node.origin.source != Origin::FILE.source);
    }
}

/// The node under `key`, made if it may be.
fn child<'a>(
    node: &'a mut Node,
    key: &str,
    origin: Origin,
    next_is_index: bool,
) -> Result<&'a mut Node, (Origin, Problem)> {
    let kind = node.kind();
    let value = if next_is_index { Value::Array(Vec::new()) } else { Value::Table(Vec::new()) };
    let new = Node { origin, value };
    match &mut node.value {
        Value::Table(entries) => {
            let at = entries.iter().position(|entry| entry.key == key).unwrap_or(entries.len());
            if at == entries.len() {
                entries.push(Entry { key: key.to_owned(), key_origin: origin, node: new });
            }
            Ok(&mut entries[at].node)
        }
        Value::Array(items) => {
            let why = match key.parse::<usize>() {
                Ok(i) if i < items.len() => return Ok(&mut items[i]),
                Ok(i) if i == items.len() => {
                    items.push(new);
                    return Ok(&mut items[i]);
                }
                Ok(_) if items.is_empty() => {
                    "this array is empty or not there, its first index is 0".to_owned()
                }
                Ok(_) => format!("this array has the indices 0 to {}", items.len() - 1),
                Err(_) if key.parse::<i64>().is_ok() && !items.is_empty() => {
                    format!("indices count from 0: this array has 0 to {}", items.len() - 1)
                }
                Err(_) => "this is an array: an index is needed here".to_owned(),
            };
            Err((origin, Problem::SetPath { why }))
        }
        _ => Err((origin, Problem::SetPath { why: format!("what stands here is {kind}, it has no keys") })),
    }
}
