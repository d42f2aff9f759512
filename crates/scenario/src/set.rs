//! Changes of a scenario: `--set PATH=VALUE` from the command line, and those of sweeps and searches.
//!
//! PATH is a [`KeyPath`]. Of two keys that exclude each other (`haze` and `width`), one that is set
//! replaces the one in the file; setting both is an error. VALUE is TOML, or otherwise a string. Missing tables are
//! created; whether the grammar has such a key is checked when the scenario is read.

use papilio_diagnostics::Diagnostic;

use crate::error::Errors;
use crate::here::relocate;
use crate::mistake;
use crate::origin::Origin;
use crate::path::{Grow, KeyPath, Position, Step};
use crate::renamed::{OldName, rename};
use crate::source::Sources;
use crate::tree::{Entry, Node, Value};

/// Path of the preset, which is set before any other key.
pub(crate) const PRESET_PATH: &str = "lighting.preset";

/// A change that is not a `--set`: a value of a sweep, a search or a condition.
#[derive(Debug, Clone)]
pub(crate) struct Change {
    /// The key.
    pub(crate) path: KeyPath,
    /// Place of the path in the text.
    pub(crate) origin: Origin,
    pub(crate) value: Node,
}

/// Applies each `--set` in order, then the other changes: with `presets` only those of the preset, otherwise all others.
/// Old names in them are added to `old`.
pub(crate) fn apply(
    root: &mut Node,
    sources: &Sources,
    changes: &[Change],
    presets: bool,
    old: &mut Vec<OldName>,
    errors: &mut Errors,
) {
    let mut set: Vec<KeyPath> = Vec::new();
    let preset = KeyPath::new(PRESET_PATH);
    for source in 1..=sources.overrides() {
        let text = sources.text(source);
        let Some((path, value)) = text.split_once('=') else {
            if !presets {
                let wrong = Diagnostic::new("this is not PATH=VALUE");
                let all = Origin { source, start: 0, end: text.len().max(1) };
                errors.push(all, wrong.expected("for example display.glass.index=1.52"));
            }
            continue;
        };
        let path = KeyPath::new(path);
        if (path == preset) == presets {
            let blanks = value.len() - value.trim_start().len();
            let (mut value, wrong) = Node::parse_value(text, path.text().len() + 1 + blanks, source);
            wrong.into_iter().for_each(|(origin, wrong)| errors.push(origin, wrong));
            if let Some(folder) = sources.folder() {
                relocate(&mut value, path.keys().last().unwrap_or_default(), folder);
            }
            let all = Origin { source, start: 0, end: path.text().len() };
            let differs = |other: &&KeyPath| **other == path && !other.written_keys().eq(path.written_keys());
            if let Some(other) = set.iter().find(differs) {
                errors.push(all, mistake::both_names(other.text(), path.text()));
            }
            put(root, &path, Place { path: all, whole: false }, value, old, errors);
            set.push(path);
        }
    }
    for change in changes.iter().filter(|change| (change.path == preset) == presets) {
        let place = Place { path: change.origin, whole: true };
        put(root, &change.path, place, change.value.clone(), old, errors);
    }
}

/// Place of a path in a text.
#[derive(Clone, Copy)]
struct Place {
    path: Origin,
    /// Whether the whole place is that of each key: a path may be spread over a table.
    whole: bool,
}

impl Place {
    fn of(self, range: std::ops::Range<usize>) -> Origin {
        if self.whole {
            return self.path;
        }
        let end = self.path.start + range.end.max(range.start + 1);
        Origin { source: self.path.source, start: self.path.start + range.start, end }
    }
}

/// Sets a value at a path, and converts both to the present names.
fn put(
    root: &mut Node,
    path: &KeyPath,
    place: Place,
    mut value: Node,
    old: &mut Vec<OldName>,
    errors: &mut Errors,
) {
    for (range, name, new) in path.old_names() {
        old.push(OldName { origin: place.of(range), old: name.to_owned(), new: new.to_owned() });
    }
    rename(&mut value, &path.keys().collect::<Vec<_>>(), old, errors);
    match path.put(root, false, &mut NodeBuilder { place }) {
        Ok(node) => *node = value,
        Err(error) => errors.push(place.of(error.range), mistake::of_path(Diagnostic::new(error.message))),
    }
}

/// Creates tables and arrays, and removes the key that the last key of the path excludes.
struct NodeBuilder {
    place: Place,
}

impl Grow for NodeBuilder {
    type Tree = Node;

    fn child<'a>(&mut self, node: &'a mut Node, at: Position<'_>) -> Result<&'a mut Node, String> {
        let origin = self.place.of(at.range());
        let value = if at.array { Value::Array(Vec::new()) } else { Value::Table(Vec::new()) };
        let new = Node { origin, value };
        if let Step::Key(key) = at.step
            && at.is_last()
        {
            drop_excluded(node, key);
        }
        match (&mut node.value, at.step) {
            (Value::Table(entries), Step::Key(key)) => {
                let found = entries.iter().position(|entry| entry.key == key).unwrap_or(entries.len());
                if found == entries.len() {
                    entries.push(Entry { key: key.to_owned(), key_origin: origin, node: new });
                }
                Ok(&mut entries[found].node)
            }
            (Value::Array(items), Step::Index(index)) if index <= items.len() => {
                if index == items.len() {
                    items.push(new);
                }
                Ok(&mut items[index])
            }
            _ => Err("this key leads nowhere".to_owned()),
        }
    }
}

/// Pairs of keys that exclude each other: setting one replaces the other.
pub(crate) const EXCLUSIVE_KEYS: [[&str; 2]; 8] = [
    ["relative_error", "paths"],
    ["haze", "width"],
    ["transmittance", "total_transmittance"],
    ["reflectance", "total_reflectance"],
    ["pitch_um", "ppi"],
    ["layout", "subpixel"],
    ["layout", "subpixel_file"],
    ["subpixel", "subpixel_file"],
];

/// Removes the keys that `key` excludes from a table, if their values are from the file and not from another `--set`.
fn drop_excluded(table: &mut Node, key: &str) {
    let Value::Table(entries) = &mut table.value else { return };
    for [a, b] in EXCLUSIVE_KEYS {
        let excluded = match key {
            _ if key == a => b,
            _ if key == b => a,
            _ => continue,
        };
        entries.retain(|entry| entry.key != excluded || entry.node.origin.source != Origin::FILE.source);
    }
}
