//! Changes of a scenario: `--set PATH=VALUE` from the command line, and those of sweeps and searches.
//!
//! PATH is a [`KeyPath`]. Of two keys that exclude each other (`haze` and `width`), one that is set
//! replaces the one in the file; setting both is an error. VALUE is TOML, or otherwise a string. Missing
//! tables are created; whether the grammar has such a key is checked when the scenario is read.

use papilio_diagnostics::Diagnostic;

use crate::describe::sweep::range;
use crate::error::Errors;
use crate::here::relocate;
use crate::mistake;
use crate::origin::Origin;
use crate::path::{Grow, KeyPath, Position, Step, split_assignment};
use crate::renamed::{self, OldName, rename};
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

/// Applies each `--set` in order, then the other changes: with `presets` only those of the preset, otherwise
/// all others. Old names in them are added to `old`.
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
    let mut axes = Vec::new();
    for source in 1..=sources.overrides() {
        let text = sources.text(source);
        if sources.is_axis(source) {
            axes.extend(if presets { None } else { axis(text, source, errors) });
            continue;
        }
        let Some((path, value)) = split_assignment(text) else {
            if !presets {
                let wrong = Diagnostic::new("this is not PATH=VALUE");
                let all = Origin { source, start: 0, end: text.len().max(1) };
                errors.push(all, wrong.expected("PATH=VALUE, for example display.glass.index=1.52"));
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
    if let Some(first) = axes.first() {
        let place = Place { path: first.origin, whole: true };
        let all = Node { origin: first.origin, value: Value::Array(axes) };
        put(root, &KeyPath::new("sweep.axes"), place, all, old, errors);
    }
    for change in changes.iter().filter(|change| (change.path == preset) == presets) {
        let place = Place { path: change.origin, whole: true };
        put(root, &change.path, place, change.value.clone(), old, errors);
    }
}

/// The axis `KEY=VALUES` of a sweep: `FROM:TO:STEP`, or values with commas between them, or what
/// `[[sweep.axes]]` has as TOML.
fn axis(text: &str, source: usize, errors: &mut Errors) -> Option<Node> {
    let at = |start: usize, end: usize| Origin { source, start, end: end.max(start + 1) };
    let Some((key, values)) =
        split_assignment(text).filter(|(key, values)| !key.is_empty() && !values.is_empty())
    else {
        let wrong = Diagnostic::new("this is not KEY=VALUES");
        let example =
            "for example display.diffuser.haze=0.3:0.8:0.1 (from:to:step) or viewer.theta_deg=0,8,30";
        errors.push(at(0, text.len()), wrong.expected(example));
        return None;
    };
    if let Some(plain) = without_quotes(key, values) {
        let wrong =
            Diagnostic::new("an axis has no quotes or brackets around its key, its values or the whole");
        let wrong = wrong.expected("KEY=VALUES, with FROM:TO:STEP or values with commas between them");
        errors.push(at(0, text.len()), wrong.hint(format!("--axis {plain}")));
        return None;
    }
    let begin = key.len() + 1;
    let mut parse = |text: &str, from: usize| {
        let (node, wrong) = Node::parse_value(text, from, source);
        wrong.into_iter().for_each(|(origin, wrong)| errors.push(origin, wrong));
        node
    };
    let value = if range(values).is_some() {
        // Read where the values of an axis are; as TOML, it may be a time.
        Value::Text(values.trim().to_owned())
    } else if values.trim_start().starts_with(['[', '{']) {
        parse(text, begin).value
    } else {
        let (mut start, mut missing, mut items) = (begin, None, Vec::new());
        for item in values.split(',') {
            let from = start + item.len() - item.trim_start().len();
            let end = start + item.trim_end().len();
            start += item.len() + 1;
            if from < end {
                items.push(parse(&text[..end], from));
            } else {
                missing = missing.or(Some(from.min(text.len() - 1)));
            }
        }
        if let Some(from) = missing {
            let wrong =
                Diagnostic::new("a value is missing here").expected("values with commas between them");
            errors.push(at(from, from), wrong);
        }
        Value::Array(items)
    };
    let node = Node { origin: at(begin, text.len()), value };
    let entry = Entry { key: key.trim().to_owned(), key_origin: at(0, key.len()), node };
    Some(Node { origin: at(0, text.len()), value: Value::Table(vec![entry]) })
}

/// Returns an axis without the quotes or brackets that do not belong to it, if there are any: those of another shell, or around a range.
fn without_quotes(key: &str, values: &str) -> Option<String> {
    const PAIRS: [(char, char); 3] = [('"', '"'), ('\'', '\''), ('[', ']')];
    let (key, values) = (key.trim(), values.trim());
    if let Some((open, close)) = PAIRS.into_iter().find(|pair| key.starts_with(pair.0)) {
        let bare = key.trim_matches([open, close]);
        // Those around the whole end after the values; a list has brackets of its own.
        let whole = !key.ends_with(close) && !values.starts_with(open);
        return Some(format!("{bare}={}", if whole { values.trim_end_matches(close) } else { values }));
    }
    let inner = |(open, close)| values.strip_prefix(open)?.strip_suffix(close);
    let [quoted, literal, listed] = PAIRS.map(inner);
    let several = quoted.or(literal).filter(|inner| inner.contains(',') && !inner.contains(['"', '\'']));
    let ranged = quoted.or(literal).or(listed).filter(|inner| range(inner).is_some());
    several.or(ranged).map(|inner| format!("{key}={inner}"))
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
        old.push(OldName {
            origin: place.of(range),
            old: name.to_owned(),
            new: new.to_owned(),
            is_gone: false,
        });
    }
    let keys: Vec<&str> = path.keys().collect();
    if let Some((key, table)) = keys.split_last()
        && let Some(gone) = renamed::gone(table, key, &value.value, place.path)
    {
        return old.push(gone);
    }
    rename(&mut value, &keys, old, errors);
    match path.put(root, false, &mut NodeBuilder { place }) {
        Ok(node) => *node = value,
        Err(error) => {
            let mut wrong = *error.wrong;
            if let Some(factor) = factor_of_material(root, path) {
                wrong = wrong.expected("a table above this key").hint(factor);
            }
            errors.push(place.of(error.range), mistake::of_path(wrong));
        }
    }
}

/// Hint for a factor of a material that is a name: which table has the factor.
fn factor_of_material(root: &Node, path: &KeyPath) -> Option<String> {
    let (Some(above), factor @ ("n_scale" | "k_scale")) = path.split_last() else { return None };
    let Value::Text(material) = &above.get(root)?.value else { return None };
    let key = above.split_last().1.to_owned();
    Some(format!(
        "the factor needs a table: write {key} = {{ material = \"{material}\", {factor} = 1 }} in the scenario"
    ))
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
pub(crate) const EXCLUSIVE_KEYS: [[&str; 2]; 9] = [
    ["field_deg", "numerical_aperture"],
    ["relative_error", "paths"],
    ["haze", "width"],
    ["transmittance", "total_transmittance"],
    ["reflectance", "total_reflectance"],
    ["pitch_um", "ppi"],
    ["layout", "subpixel"],
    ["layout", "subpixel_file"],
    ["subpixel", "subpixel_file"],
];

/// Removes the keys that `key` excludes from a table, if their values are from the file and not from another
/// `--set`.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quotes_and_brackets_around_an_axis_are_found() {
        let plain = |axis: &str| axis.split_once('=').and_then(|(key, values)| without_quotes(key, values));
        for axis in [
            "[a.b]=0,10",
            "\"a.b=0,10\"",
            "'a.b=0,10'",
            "\"a.b\"=0,10",
            "[a.b=0,10]",
            "a.b='0,10'",
            "a.b=\"0,10\"",
        ] {
            assert_eq!(plain(axis).as_deref(), Some("a.b=0,10"), "{axis}");
        }
        assert_eq!(plain("a.b=[0:30:10]").as_deref(), Some("a.b=0:30:10"));
        assert_eq!(plain("a.b=\"0:30:10\"").as_deref(), Some("a.b=0:30:10"));
        for right in
            ["a.b=0,10", "a.b=[0,10]", "a.b=\"D65\",\"A\"", "a.b=\"D65\"", "a.b=0:30:10", "a.b={ from = 0 }"]
        {
            assert_eq!(plain(right), None, "{right}");
        }
    }
}
