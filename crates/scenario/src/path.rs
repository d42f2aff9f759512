//! Dotted paths of keys: `display.pixel.film.1.thickness_nm`.
//!
//! `--set`, edits of the text, `[sweep]`, `[optimize]`, `[tolerance]`, batches of designs and error reports
//! all identify a key by such a path. [`KeyPath`] is the only reader of paths in Rust: it splits the text at
//! its points, counts indices from 0, and appends at the index after the last one. A key that contains a point
//! is in quotes, as in TOML: `states."a.b".file`. A path is followed through a
//! [`Tree`]: the scenario's own tree with its places, JSON, or the TOML document of an editor.
//!
//! One more reader of the same paths is not in Rust, because its tree is not: the page's `model/json.ts`.

use std::borrow::Cow;
use std::fmt;
use std::ops::Range;

use papilio_diagnostics::Diagnostic;
use serde_json::Value as Json;

use crate::renamed::new_key;

/// Largest number of keys of a path.
const MOST_KEYS: usize = 16;

/// A dotted path of keys, as in `--set`. Two paths are equal if their keys have the same present names.
///
/// ```
/// use papilio_scenario::KeyPath;
/// let path = KeyPath::new("display.pixel.film.1.thickness_nm");
/// assert_eq!(path.keys().nth(3), Some("1"));
/// assert_eq!(path, KeyPath::new("display . pixel.film.1.thickness_nm"));
/// let scenario = serde_json::json!({ "display": { "pixel": { "film": [{}, { "thickness_nm": 9.5 }] } } });
/// assert_eq!(path.in_json(&scenario).and_then(|value| value.as_f64()), Some(9.5));
///
/// let quoted = KeyPath::new("display.pixel.states.\"red 1.5\".file");
/// assert_eq!(quoted.keys().nth(3), Some("red 1.5"));
/// ```
#[derive(Debug, Clone)]
pub struct KeyPath {
    text: String,
    keys: Vec<Key>,
}

/// A key of a path.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Key {
    /// Range in the text of the path, without blanks; quotes are in it.
    range: Range<usize>,
    /// Name, if the text has it in quotes.
    unquoted: Option<String>,
    /// Present name, if the text has an old one.
    present: Option<&'static str>,
}

/// Why a path cannot be followed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct PathError {
    /// Range of the wrong part in the text of the path, in bytes.
    pub(crate) range: Range<usize>,
    /// What is wrong.
    pub(crate) wrong: Box<Diagnostic>,
}

/// A tree of tables and arrays through which paths can be followed.
pub(crate) trait Tree: Sized {
    /// Shape of this node.
    fn shape(&self) -> Shape;
    /// Returns a child node, if it exists.
    fn child(&self, step: Step<'_>) -> Option<&Self>;
}

/// Shape of a node of a [`Tree`].
pub(crate) enum Shape {
    Table,
    /// Number of items.
    Array(usize),
    /// Type of the value in words; a value has no keys.
    Value(&'static str),
}

/// A step from a node to a child.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Step<'a> {
    Key(&'a str),
    /// An index up to the number of items; the last one appends.
    Index(usize),
}

/// Creates missing nodes of a [`Tree`] along a path.
pub(crate) trait Grow {
    type Tree: Tree;
    /// Returns a child of `node`, which is created if it does not exist.
    fn child<'a>(&mut self, node: &'a mut Self::Tree, at: Position<'_>)
    -> Result<&'a mut Self::Tree, String>;
}

/// The position on a path that is being followed.
pub(crate) struct Position<'a> {
    pub(crate) path: &'a KeyPath,
    /// Index of the key in the path.
    pub(crate) number: usize,
    pub(crate) step: Step<'a>,
    /// Whether a new node is an array instead of a table.
    pub(crate) array: bool,
}

impl KeyPath {
    /// Creates a path. Whether a scenario has it is checked when it is followed.
    pub fn new(text: &str) -> Self {
        let mut above: Vec<String> = Vec::new();
        let mut keys = Vec::new();
        let mut start = 0;
        loop {
            let end = start + end_of_key(&text[start..]);
            let part = &text[start..end];
            let begin = start + part.len() - part.trim_start().len();
            let range = begin..begin + part.trim().len();
            let unquoted = unquoted(part.trim());
            let written = unquoted.as_deref().unwrap_or(part.trim());
            // Longer paths are refused where they are followed.
            let mut present = None;
            if above.len() < MOST_KEYS {
                let names: Vec<&str> = above.iter().map(String::as_str).collect();
                present = new_key(&names, written);
                above.push(present.unwrap_or(written).to_owned());
            }
            keys.push(Key { range, unquoted, present });
            if end == text.len() {
                return Self { text: text.to_owned(), keys };
            }
            start = end + 1;
        }
    }

    /// Returns the keys by their present names, without blanks and quotes; indices of arrays are among them.
    pub fn keys(&self) -> impl ExactSizeIterator<Item = &str> {
        self.keys.iter().map(|key| self.name(key))
    }

    /// Returns the keys as they are written, without blanks and quotes.
    pub(crate) fn written_keys(&self) -> impl ExactSizeIterator<Item = &str> {
        self.keys.iter().map(|key| key.unquoted.as_deref().unwrap_or(&self.text[key.range.clone()]))
    }

    /// The present name of a key.
    fn name<'a>(&'a self, key: &'a Key) -> &'a str {
        key.present.or(key.unquoted.as_deref()).unwrap_or(&self.text[key.range.clone()])
    }

    /// Returns whether the key with this number is in quotes.
    pub(crate) fn is_quoted(&self, number: usize) -> bool {
        self.keys[number].unquoted.is_some()
    }

    /// Returns the old names in the path: range in its text, old name and present name.
    pub(crate) fn old_names(&self) -> impl Iterator<Item = (Range<usize>, &str, &'static str)> {
        let old = |key: &Key| Some((key.range.clone(), &self.text[key.range.clone()], key.present?));
        self.keys.iter().filter_map(old)
    }

    /// Returns the value of a JSON document at this path, if there is one.
    pub fn in_json<'a>(&self, root: &'a Json) -> Option<&'a Json> {
        self.get(root)
    }

    /// The path with the present names of its keys.
    pub fn present(&self) -> String {
        self.keys().map(quoted).collect::<Vec<_>>().join(".")
    }

    /// Whether one of two different paths is the beginning of the other.
    pub(crate) fn overlaps(&self, other: &Self) -> bool {
        self.keys().zip(other.keys()).all(|(a, b)| a == b) && self.keys().len() != other.keys().len()
    }

    /// The path as it was written.
    pub(crate) fn text(&self) -> &str {
        &self.text
    }

    /// The first key: a table at the top level.
    pub(crate) fn first(&self) -> &str {
        self.keys().next().unwrap_or_default()
    }

    /// Splits off the last key. The path above it is `None` for a single key.
    pub(crate) fn split_last(&self) -> (Option<Self>, &str) {
        let Some((last, above)) = self.keys.split_last() else { return (None, "") };
        let parent = above
            .last()
            .map(|end| Self { text: self.text[..end.range.end].to_owned(), keys: above.to_vec() });
        (parent, self.name(last))
    }

    /// Returns the paths of the first key, of the first two keys, and so on, up to the whole path.
    pub(crate) fn prefixes(&self) -> impl Iterator<Item = Self> {
        let prefix = |count: usize| Self {
            text: self.text[..self.keys[count - 1].range.end].to_owned(),
            keys: self.keys[..count].to_vec(),
        };
        (1..=self.keys.len()).map(prefix)
    }

    /// Returns the node at the path, if it exists.
    pub(crate) fn get<'a, T: Tree>(&self, root: &'a T) -> Option<&'a T> {
        self.keys().try_fold(root, |node, key| node.child(step(node.shape(), key).ok()?))
    }

    /// Checks that no key is empty, and that the path is not too long.
    pub(crate) fn check(&self) -> Result<(), PathError> {
        let at = |key: &Key, wrong: Diagnostic| {
            Err(PathError { range: key.range.clone(), wrong: Box::new(wrong.hint(EXAMPLE_PATH)) })
        };
        if let Some(key) = self.keys.iter().find(|key| self.name(key).is_empty()) {
            return at(key, Diagnostic::new("the path has an empty key").expected("a key"));
        }
        match self.keys.get(MOST_KEYS) {
            Some(key) => {
                let wrong = Diagnostic::new(format!("the path has more than {MOST_KEYS} keys"));
                at(key, wrong.expected(format!("at most {MOST_KEYS} keys")))
            }
            None => Ok(()),
        }
    }

    /// Returns the node at the path. `grow` creates missing nodes; with `array`, the last one is an array.
    pub(crate) fn put<'a, G: Grow>(
        &self,
        root: &'a mut G::Tree,
        array: bool,
        grow: &mut G,
    ) -> Result<&'a mut G::Tree, PathError> {
        self.check()?;
        let mut node = root;
        for (number, (key, Key { range, .. })) in self.keys().zip(&self.keys).enumerate() {
            let array = self.keys().nth(number + 1).map_or(array, |next| index(next).is_some());
            let at = |wrong| PathError { range: range.clone(), wrong: Box::new(wrong) };
            let step = step(node.shape(), key).map_err(at)?;
            let position = Position { path: self, number, step, array };
            node = grow.child(node, position).map_err(|message| at(Diagnostic::new(message)))?;
        }
        Ok(node)
    }
}

impl PartialEq for KeyPath {
    fn eq(&self, other: &Self) -> bool {
        self.keys().eq(other.keys())
    }
}

impl Eq for KeyPath {}

impl fmt::Display for KeyPath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl serde::Serialize for KeyPath {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&self.text)
    }
}

impl Position<'_> {
    /// Returns the path up to this key.
    pub(crate) fn path(&self) -> KeyPath {
        let keys = &self.path.keys[..=self.number];
        KeyPath { text: self.path.text[..keys[self.number].range.end].to_owned(), keys: keys.to_vec() }
    }

    /// True at the last key of the path.
    pub(crate) fn is_last(&self) -> bool {
        self.number + 1 == self.path.keys.len()
    }

    /// Range of the key in the text of the path, in bytes.
    pub(crate) fn range(&self) -> Range<usize> {
        self.path.keys[self.number].range.clone()
    }
}

/// Appends a path to a path, which may be empty.
pub(crate) fn joined(above: &str, below: &str) -> String {
    if above.is_empty() { below.to_owned() } else { format!("{above}.{below}") }
}

/// Appends the name of a key to a path, which may be empty: in quotes, if it needs them.
pub(crate) fn with_key(above: &str, name: &str) -> String {
    joined(above, &quoted(name))
}

/// Appends the key of a table to the path of the tables above it. One without a table above it is a path itself:
/// `"a.b" = 1` means the same as `a.b = 1`.
pub(crate) fn below(above: &str, key: &str) -> String {
    if above.is_empty() { key.to_owned() } else { with_key(above, key) }
}

/// Splits `PATH=VALUE` at the first equals sign that is not in quotes.
pub(crate) fn split_assignment(text: &str) -> Option<(&str, &str)> {
    let mut start = 0;
    loop {
        let end = start + end_of_key(&text[start..]);
        let quotes = closing_quote(&text[start..end]).map_or(start, |close| start + close + 1);
        if let Some(at) = text[quotes..end].find('=') {
            return Some((&text[..quotes + at], &text[quotes + at + 1..]));
        }
        if end == text.len() {
            // Quotes about the whole text.
            return text.split_once('=');
        }
        start = end + 1;
    }
}

/// Length of the first key of a path, up to the point behind it or to the end.
fn end_of_key(text: &str) -> usize {
    let quotes = closing_quote(text).map_or(0, |close| close + 1);
    text[quotes..].find('.').map_or(text.len(), |point| quotes + point)
}

/// Place of the quote that ends the quoted key at the beginning of a text, if it begins with one.
fn closing_quote(text: &str) -> Option<usize> {
    let begin = text.len() - text.trim_start().len();
    let quote = text[begin..].chars().next().filter(|c| matches!(c, '"' | '\''))?;
    let mut is_escaped = false;
    let close = text[begin + 1..].char_indices().find(|(_, c)| {
        let is_end = *c == quote && !is_escaped;
        is_escaped = *c == '\\' && !is_escaped && quote == '"';
        is_end
    })?;
    Some(begin + 1 + close.0)
}

/// The name of a key that is written in quotes, as in TOML.
fn unquoted(key: &str) -> Option<String> {
    let is_quoted = closing_quote(key).is_some_and(|close| close + 1 == key.len());
    is_quoted.then(|| key.parse::<toml_edit::Key>().ok().map(|key| key.get().to_owned()))?
}

/// A name as a key of a path: in quotes, if it could be read as something else without them.
pub(crate) fn quoted(name: &str) -> Cow<'_, str> {
    let is_plain = !name.is_empty()
        && name.trim() == name
        && !name.starts_with(['"', '\''])
        && !name.contains(|c: char| matches!(c, '.' | '=') || c.is_control());
    if is_plain {
        return Cow::Borrowed(name);
    }
    let escaped = name.chars().map(|c| match c {
        '"' | '\\' => format!("\\{c}"),
        c if c.is_control() => format!("\\u{:04X}", u32::from(c)),
        c => c.to_string(),
    });
    Cow::Owned(format!("\"{}\"", escaped.collect::<String>()))
}

/// Returns the index that a key represents, if it is one.
pub(crate) fn index(key: &str) -> Option<usize> {
    key.parse().ok()
}

/// Returns the step that a key means at a node of this shape.
pub(crate) fn step(shape: Shape, key: &str) -> Result<Step<'_>, Diagnostic> {
    let count = match shape {
        Shape::Table => return Ok(Step::Key(key)),
        Shape::Array(count) => count,
        Shape::Value(kind) => {
            let wrong = Diagnostic::new(format!("the value above this key is {kind}, which has no keys"));
            return Err(wrong.expected("the end of the path").hint("remove this key and those below it"));
        }
    };
    let message = match (index(key), count.checked_sub(1)) {
        (Some(at), _) if at <= count => return Ok(Step::Index(at)),
        (Some(_), None) => "this array is empty or missing: its first index is 0".to_owned(),
        (Some(_), Some(last)) => format!("this array has the indices 0 to {last}"),
        (None, Some(last)) if key.parse::<i64>().is_ok() => {
            format!("indices start at 0: this array has 0 to {last}")
        }
        (None, _) => "this is an array: an index is needed here".to_owned(),
    };
    let wrong = Diagnostic::new(message);
    Err(match count {
        0 => wrong.expected("the index 0, which begins the array"),
        _ => wrong.expected(format!("an index from 0 to {count}; {count} appends an item")),
    }
    .hint(EXAMPLE_PATH))
}

/// Hint for a path that cannot be followed.
const EXAMPLE_PATH: &str =
    "points separate the keys, and indices count from 0, as in display.pixel.film.1.thickness_nm";

impl Tree for Json {
    fn shape(&self) -> Shape {
        match self {
            Json::Null => Shape::Value("null"),
            Json::Bool(_) => Shape::Value("true or false"),
            Json::Number(_) => Shape::Value("a number"),
            Json::String(_) => Shape::Value("a string"),
            Json::Array(items) => Shape::Array(items.len()),
            Json::Object(_) => Shape::Table,
        }
    }

    fn child(&self, step: Step<'_>) -> Option<&Self> {
        match step {
            Step::Key(key) => self.get(key),
            Step::Index(index) => self.get(index),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn path_has_keys_with_ranges_and_prefixes() {
        let path = KeyPath::new(" a . b.0");
        assert_eq!(path.keys().collect::<Vec<_>>(), ["a", "b", "0"]);
        assert_eq!(path.keys.iter().map(|key| key.range.clone()).collect::<Vec<_>>(), [1..2, 5..6, 7..8]);
        let (above, last) = path.split_last();
        assert_eq!((above.as_ref().map(KeyPath::text), last), (Some(" a . b"), "0"));
        assert_eq!(path.prefixes().map(|path| path.text).collect::<Vec<_>>(), [" a", " a . b", " a . b.0"]);
        assert_eq!(KeyPath::new("a").split_last(), (None, "a"));
        assert_eq!(KeyPath::new("").keys().collect::<Vec<_>>(), [""]);
    }

    #[test]
    fn quoted_key_of_path_keeps_its_points() {
        for (text, keys) in [
            ("states.\"a.b\".file", &["states", "a.b", "file"][..]),
            (" states . 'a.b' .0", &["states", "a.b", "0"]),
            (r#""a\"b.c\\".d"#, &[r#"a"b.c\"#, "d"]),
            (r"'a\'.b", &[r"a\", "b"]),
            ("states.pure red.file", &["states", "pure red", "file"]),
            ("states.it's.file", &["states", "it's", "file"]),
            // A quote without its other one, or with something behind that, is a part of the name.
            ("states.\"a.b", &["states", "\"a", "b"]),
            ("\"a.b\"c.d", &["\"a.b\"c", "d"]),
        ] {
            let path = KeyPath::new(text);
            assert_eq!(path.keys().collect::<Vec<_>>(), keys, "{text}");
            assert_eq!(KeyPath::new(&path.present()), path, "{text}: {}", path.present());
        }
        let path = KeyPath::new("states.\"a.b\".file");
        assert_eq!(path.split_last().0.as_ref().map(KeyPath::text), Some("states.\"a.b\""));
        assert_eq!(path.prefixes().nth(1).map(|path| path.text), Some("states.\"a.b\"".to_owned()));
        assert_ne!(path, KeyPath::new("states.a.b.file"));
        let scenario = serde_json::json!({ "states": { "a.b": { "file": 1 }, "a": { "b": { "file": 2 } } } });
        assert_eq!(path.in_json(&scenario), Some(&Json::from(1)));
        assert!(KeyPath::new("states.\"\".file").check().is_err());
    }

    #[test]
    fn names_become_keys_that_paths_read_as_these_names() {
        for name in
            ["a", "a.b", "pure red", " a", "", "\"a\"", "'a", "a=b", "a\\b.c", "a\tb", "\u{e4}.\u{20ac}"]
        {
            let path = with_key("states", name);
            assert_eq!(KeyPath::new(&path).keys().collect::<Vec<_>>(), ["states", name], "{path}");
            let (left, right) = (format!("{path}.n"), "1=2.3");
            assert_eq!(split_assignment(&format!("{left}={right}")), Some((&*left, right)), "{path}");
        }
        assert_eq!(with_key("a.b", "c"), "a.b.c");
        assert_eq!(split_assignment("a.b"), None);
        assert_eq!(split_assignment("\"a.b=0\""), Some(("\"a.b", "0\"")));
    }

    #[test]
    fn old_names_of_keys_are_read_as_present_names() {
        let path = KeyPath::new("display.diffuser.straight_through");
        assert_eq!(path, KeyPath::new("display.diffuser.regular_fraction"));
        assert_eq!(path.old_names().collect::<Vec<_>>(), [(17..33, "straight_through", "regular_fraction")]);
        assert_eq!(path.split_last().1, "regular_fraction");
        assert_eq!(path.written_keys().last(), Some("straight_through"));
        assert_eq!(KeyPath::new("solver.straight_through").old_names().count(), 0);
    }

    #[test]
    fn step_needs_index_in_array_and_key_in_table() {
        assert_eq!(step(Shape::Table, "0"), Ok(Step::Key("0")));
        assert_eq!(step(Shape::Array(2), "2"), Ok(Step::Index(2)));
        for (shape, key, message) in [
            (Shape::Array(2), "3", "has the indices 0 to 1"),
            (Shape::Array(2), "-1", "indices start at 0"),
            (Shape::Array(0), "1", "its first index is 0"),
            (Shape::Array(2), "first", "an index is needed here"),
            (Shape::Value("a number"), "n", "is a number, which has no keys"),
        ] {
            let wrong = step(shape, key).unwrap_err();
            assert!(wrong.message.contains(message), "{key}");
            assert!(wrong.expected.is_some() && wrong.hint.is_some(), "{key}");
        }
    }
}
