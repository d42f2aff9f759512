//! `--set PATH=VALUE`: changes to a scenario from the command line, and those of a sweep or a search.
//!
//! PATH is a [`KeyPath`]. Of two keys that exclude each other (`haze` and `width`) a set one
//! replaces the file's; two set ones are an error. VALUE is TOML, or else a string. What is not there is made;
//! whether the schema has such a key is found out when the scenario is read.

use papilio_diagnostics::Diagnostic;

use crate::error::Errors;
use crate::mistake;
use crate::origin::Origin;
use crate::path::{At, Grow, KeyPath, Step};
use crate::source::Sources;
use crate::tree::{Entry, Node, Value};

/// Where presets are named; they are set before any other key.
pub(crate) const PRESET_PATH: &str = "lighting.preset";

/// A change that is none of the user's `--set`: a value of a sweep, a search or a condition.
#[derive(Debug, Clone)]
pub(crate) struct Change {
    /// The key.
    pub(crate) path: KeyPath,
    /// Where the path stands.
    pub(crate) origin: Origin,
    pub(crate) value: Node,
}

/// Applies each `--set` in turn, then the other changes: those of the preset alone, or all others.
pub(crate) fn apply(
    root: &mut Node,
    sources: &Sources,
    changes: &[Change],
    presets: bool,
    errors: &mut Errors,
) {
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
            let (value, wrong) = Node::parse_value(text, path.text().len() + 1 + blanks, source);
            wrong.into_iter().for_each(|(origin, wrong)| errors.push(origin, wrong));
            let all = Origin { source, start: 0, end: path.text().len() };
            put(root, &path, Place { path: all, whole: false }, value, errors);
        }
    }
    for change in changes.iter().filter(|change| (change.path == preset) == presets) {
        let place = Place { path: change.origin, whole: true };
        put(root, &change.path, place, change.value.clone(), errors);
    }
}

/// Where a path stands.
#[derive(Clone, Copy)]
struct Place {
    path: Origin,
    /// Whether all of it counts as the place of each of its keys: it may be spread over a table.
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

fn put(root: &mut Node, path: &KeyPath, place: Place, value: Node, errors: &mut Errors) {
    match path.put(root, false, &mut Maker { place }) {
        Ok(node) => *node = value,
        Err(error) => errors.push(place.of(error.range), mistake::of_path(Diagnostic::new(error.message))),
    }
}

/// Makes tables and arrays, and takes the rival of the key at the end of the path out.
struct Maker {
    place: Place,
}

impl Grow for Maker {
    type Tree = Node;

    fn child<'a>(&mut self, node: &'a mut Node, at: At<'_>) -> Result<&'a mut Node, String> {
        let origin = self.place.of(at.range());
        let value = if at.array { Value::Array(Vec::new()) } else { Value::Table(Vec::new()) };
        let new = Node { origin, value };
        if let Step::Key(key) = at.step
            && at.is_last()
        {
            drop_rival(node, key);
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
