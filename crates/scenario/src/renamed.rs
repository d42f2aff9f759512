//! Old names of keys and values, which scenarios may still use.
//!
//! [`RENAMED`] is the only list. Files, `--set`, the keys of studies, Python and the page's edits are all
//! converted to the new names with it, and so does `papilio migrate` with the text of a file. Both names of
//! one key together are an error.
//!
//! [`FORMAT`] is the number of the grammar. It changes when a key is renamed, and is part of the hash.

use std::ops::Range;

use crate::error::Errors;
use crate::mistake;
use crate::origin::Origin;
use crate::path::{KeyPath, below, quoted};
use crate::tree::{Entry, Node, Value};

/// Number of the present grammar, as the key `format` of a scenario states it.
pub(crate) const FORMAT: u64 = 2;

/// A key or a value with its old and its new name.
#[derive(Debug, Clone, Copy)]
pub(crate) enum NamePair {
    /// A key of these tables; `*` stands for any index.
    Key { tables: &'static [&'static str], old: &'static str, new: &'static str },
    /// A value of the keys at these paths of present names.
    Value { keys: &'static [&'static str], old: &'static str, new: NewValue },
}

/// The present value for an old one.
#[derive(Debug, Clone, Copy)]
pub(crate) enum NewValue {
    Word(&'static str),
    Flag(bool),
}

use NamePair::{Key, Value as Choice};
use NewValue::{Flag, Word};

/// Every key and value that has been renamed.
pub(crate) const RENAMED: &[NamePair] = &[
    Choice { keys: &["solver.method"], old: "walk", new: Word("monte-carlo") },
    Choice { keys: &["lighting.preset"], old: "d8", new: Word("d8-included") },
    Key { tables: &["solver"], old: "every_bin", new: "per_wavelength" },
    Key { tables: DIFFUSERS, old: "straight_through", new: "regular_fraction" },
    Choice {
        keys: &["display.diffuser.spectral_mean", "display.layers.*.spectral_mean"],
        old: "even",
        new: Word("uniform"),
    },
    Key {
        tables: &["display.diffuser", "display.layers.*", "display.pixel"],
        old: "fill",
        new: "extrapolate_tails",
    },
    Choice { keys: TAILS, old: "none", new: Flag(false) },
    Choice { keys: TAILS, old: "tail", new: Flag(true) },
    Choice { keys: &["display.glass.surface"], old: "coated", new: Word("ideal-ar") },
    Choice { keys: &["display.layers.*.kind"], old: "coated", new: Word("ideal-ar") },
    Choice { keys: &["display.layers.*.kind"], old: "sheet", new: Word("component") },
    Key { tables: &["lighting.environment.*"], old: "turn_deg", new: "rotation_deg" },
    Key { tables: &["optimize.variables.*"], old: "against", new: "compensated_by" },
];

/// Keys that exist no more: table, key, and the key that has taken over. Their only value was 0, which is
/// ignored with a note.
const GONE: &[(&str, &str, &str)] = &[("display.matrix", "spread_um", "display.pixel.spread_um")];

const DIFFUSERS: &[&str] = &["display.diffuser", "display.layers.*"];

const TAILS: &[&str] = &[
    "display.diffuser.extrapolate_tails",
    "display.layers.*.extrapolate_tails",
    "display.pixel.extrapolate_tails",
];

/// Pattern for any single key of a path: the index of an item.
const ANY: &str = "*";

/// Values of studies that are paths of other keys.
const PATHS: &[&str] = &[
    "optimize.variables.*.key",
    "optimize.variables.*.keys.*",
    "optimize.variables.*.compensated_by",
    "fit.variables.*.key",
    "fit.variables.*.keys.*",
    "fit.variables.*.compensated_by",
    "tolerance.keys.*.key",
    "tolerance.keys.*.keys.*",
    "tolerance.correlations.*.keys.*",
];

/// An axis of a sweep: its keys are those of the scenario, with lists of values.
const SWEPT: &str = "sweep.axes.*";

/// Table of keys of the scenario with their values, as in `--set`.
const CHANGES: &str = "optimize.conditions.*.set";

/// An old name that was found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct OldName {
    pub(crate) origin: Origin,
    /// The old name as it is written in TOML.
    pub(crate) old: String,
    pub(crate) new: String,
    /// Whether the key exists no more.
    pub(crate) is_gone: bool,
}

/// Returns one note for each old name.
pub(crate) fn notes(old: &[OldName]) -> Vec<String> {
    let mut notes: Vec<String> = Vec::new();
    for note in old.iter().map(OldName::note) {
        if !notes.contains(&note) {
            notes.push(note);
        }
    }
    notes
}

impl OldName {
    /// Note for the user.
    fn note(&self) -> String {
        if self.is_gone {
            return format!("`{}` exists no more: its value 0 is ignored; see `{}`", self.old, self.new);
        }
        format!(
            "`{}` is the old name of `{}`; it is still accepted, and `papilio migrate` replaces it",
            self.old, self.new
        )
    }
}

impl NewValue {
    fn value(self) -> Value {
        match self {
            Word(word) => Value::Text(word.to_owned()),
            Flag(flag) => Value::Bool(flag),
        }
    }

    fn written(self) -> String {
        match self {
            Word(word) => format!("\"{word}\""),
            Flag(flag) => flag.to_string(),
        }
    }
}

/// Returns the present name of the key `key` in the table at `table`, if it has been renamed.
pub(crate) fn new_key(table: &[&str], key: &str) -> Option<&'static str> {
    RENAMED.iter().find_map(|row| match row {
        Key { tables, old, new } if *old == key && is_any_of(table, tables) => Some(*new),
        _ => None,
    })
}

/// Returns the old name of the key `key` in the table at `table`, if it has one.
pub(crate) fn old_key(table: &[&str], key: &str) -> Option<&'static str> {
    RENAMED.iter().find_map(|row| match row {
        Key { tables, old, new } if *new == key && is_any_of(table, tables) => Some(*old),
        _ => None,
    })
}

/// Returns the present value for the old word `word` of the key at `path`, if it has been renamed.
pub(crate) fn new_value(path: &[&str], word: &str) -> Option<NewValue> {
    RENAMED.iter().find_map(|row| match row {
        Choice { keys, old, new } if *old == word && is_any_of(path, keys) => Some(*new),
        _ => None,
    })
}

/// Returns [`RENAMED`] as a table of Markdown, for the documentation.
pub(crate) fn table() -> String {
    let places =
        |places: &[&str]| places.iter().map(|place| format!("`{place}`")).collect::<Vec<_>>().join(", ");
    let rows = RENAMED.iter().map(|row| match row {
        Key { tables, old, new } => format!("- `{old}`: `{new}`, key of {}\n", places(tables)),
        Choice { keys, old, new } => {
            format!("- `\"{old}\"`: `{}`, value of {}\n", new.written(), places(keys))
        }
    });
    // The old names come first: who looks for one finds it at the beginning of a line, and so does the search of
    // the site.
    let gone =
        GONE.iter().map(|(table, key, new)| format!("- `{key}` = 0: `{new}`, key of `{table}`, ignored\n"));
    rows.chain(gone).collect()
}

/// True if `path` matches one of the patterns, in which `*` is any single key.
fn is_any_of(path: &[&str], patterns: &[&str]) -> bool {
    patterns.iter().any(|pattern| {
        let keys = pattern.split('.');
        keys.clone().count() == path.len() && keys.zip(path).all(|(key, found)| key == ANY || key == *found)
    })
}

/// Converts a value at `path` (of present names; empty for a whole scenario) to present names.
/// Both names of a key in one table are an error.
pub(crate) fn rename(node: &mut Node, path: &[&str], found: &mut Vec<OldName>, errors: &mut Errors) {
    match &mut node.value {
        Value::Text(word) => {
            if let Some(new) = new_value(path, word) {
                found.push(OldName {
                    origin: node.origin,
                    old: format!("\"{word}\""),
                    new: new.written(),
                    is_gone: false,
                });
                node.value = new.value();
            }
        }
        Value::Array(items) => {
            let path = [path, &[ANY]].concat();
            items.iter_mut().for_each(|item| rename(item, &path, found, errors));
        }
        Value::Table(entries) => {
            for i in 0..entries.len() {
                let Some(new) = new_key(path, &entries[i].key) else { continue };
                if entries.iter().any(|entry| entry.key == new) {
                    errors.push(entries[i].key_origin, mistake::both_names(&entries[i].key, new));
                }
                let old = std::mem::replace(&mut entries[i].key, new.to_owned());
                found.push(OldName {
                    origin: entries[i].key_origin,
                    old,
                    new: new.to_owned(),
                    is_gone: false,
                });
            }
            entries.retain(|entry| {
                let gone = gone(path, &entry.key, &entry.node.value, entry.key_origin);
                let stays = gone.is_none();
                found.extend(gone);
                stays
            });
            for Entry { key, node, .. } in entries {
                rename(node, &[path, &[&**key]].concat(), found, errors);
            }
        }
        _ => {}
    }
}

/// Returns a note if the key `key` of the table at `table` exists no more and has its only value, with which
/// it is ignored.
pub(crate) fn gone(table: &[&str], key: &str, value: &Value, origin: Origin) -> Option<OldName> {
    let is_zero = matches!(value, Value::Integer(0) | Value::Float(0.0));
    let (table, key, new) =
        GONE.iter().find(|(of, gone, _)| is_zero && *gone == key && is_any_of(table, &[of]))?;
    Some(OldName { origin, old: format!("{table}.{key}"), new: (*new).to_owned(), is_gone: true })
}

/// Returns the changes that convert the text of a scenario to present names, from the last to the first.
pub(crate) fn changes(text: &str, root: &Node, errors: &mut Errors) -> Vec<(Range<usize>, OldName)> {
    let mut found = Vec::new();
    let mut renamed = root.clone();
    rename(&mut renamed, &[], &mut found, errors);
    found.extend(in_studies(&renamed));
    found.sort_by_key(|name| std::cmp::Reverse(name.origin));
    found.dedup();
    // These stay in the text: what to remove with them, a line or an item of a list, is the user's decision.
    found.retain(|name| !name.is_gone);
    let place = |name: OldName| (name.origin.start.min(text.len())..name.origin.end.min(text.len()), name);
    found.into_iter().map(place).collect()
}

/// Returns the old names in the studies of a scenario, whose other names are the present ones.
pub(crate) fn in_studies(root: &Node) -> Vec<OldName> {
    let mut found = Vec::new();
    of_studies(root, &[], &mut found);
    found
}

/// Finds old names in the paths of studies, and in their values for renamed keys.
fn of_studies(node: &Node, path: &[&str], found: &mut Vec<OldName>) {
    match &node.value {
        Value::Text(text) if is_any_of(path, PATHS) => {
            let path = KeyPath::new(text);
            if path.old_names().next().is_some() {
                let (old, new) = (format!("\"{text}\""), format!("\"{}\"", path.present()));
                found.push(OldName { origin: node.origin, old, new, is_gone: false });
            }
        }
        Value::Array(items) => {
            let path = [path, &[ANY]].concat();
            items.iter().for_each(|item| of_studies(item, &path, found));
        }
        Value::Table(entries) if is_any_of(path, &[CHANGES, SWEPT]) => {
            let is_swept = is_any_of(path, &[SWEPT]);
            entries.iter().for_each(|entry| of_change(entry, "", is_swept, found));
        }
        Value::Table(entries) => {
            let key = match node.get("key").map(|key| &key.value) {
                Some(Value::Text(key)) => Some(KeyPath::new(key)),
                _ => None,
            };
            for entry in entries {
                match (&entry.node.value, &key) {
                    (Value::Array(values), Some(key)) if ["values", "choices"].contains(&&*entry.key) => {
                        let key: Vec<&str> = key.keys().collect();
                        let mut values = values.clone();
                        values
                            .iter_mut()
                            .for_each(|value| rename(value, &key, found, &mut Errors::default()));
                    }
                    // The values of a distribution.
                    (Value::Table(_), Some(key)) if entry.key == "choices" => {
                        let key: Vec<&str> = key.keys().collect();
                        if let Some(Value::Array(values)) = entry.node.get("values").map(|node| &node.value) {
                            let mut values = values.clone();
                            values
                                .iter_mut()
                                .for_each(|value| rename(value, &key, found, &mut Errors::default()));
                        }
                    }
                    _ => of_studies(&entry.node, &[path, &[&*entry.key]].concat(), found),
                }
            }
        }
        _ => {}
    }
}

/// Finds old names in a key of a condition or of an axis, dotted or nested below `above`, and in its value;
/// an axis has a list of values.
fn of_change(entry: &Entry, above: &str, is_swept: bool, found: &mut Vec<OldName>) {
    let path = KeyPath::new(&below(above, &entry.key));
    let keys: Vec<&str> = path.keys().collect();
    if path.old_names().next().is_some() {
        let written = |name: &str| match name.contains('.') {
            true if name.contains('"') => format!("'{name}'"),
            true => format!("\"{name}\""),
            false => name.to_owned(),
        };
        let depth = if above.is_empty() { 0 } else { KeyPath::new(above).keys().len() };
        let new: Vec<_> = keys[depth..].iter().map(|key| quoted(key)).collect();
        let (old, new) = (written(&entry.key), written(&new.join(".")));
        found.push(OldName { origin: entry.key_origin, old, new, is_gone: false });
    }
    let mut none = Errors::default();
    match &entry.node.value {
        Value::Table(entries) => {
            let above = path.present();
            entries.iter().for_each(|entry| of_change(entry, &above, is_swept, found));
        }
        Value::Array(values) if is_swept => {
            values.iter().for_each(|value| rename(&mut value.clone(), &keys, found, &mut none));
        }
        _ => rename(&mut entry.node.clone(), &keys, found, &mut none),
    }
}

#[cfg(test)]
mod tests;
