//! Dotted paths of keys: `display.pixel.film.1.thickness_nm`.
//!
//! `--set`, edits of the text, `[sweep]`, `[optimize]`, `[tolerance]`, batches of designs and the reports of errors all
//! name a key by such a path. [`KeyPath`] is the only place in Rust that reads one: it splits the text at its points,
//! takes an array's index from 0, and lets the index after the last one append. What it leads through is a [`Tree`]: the
//! scenario's own tree with its places, JSON, or the TOML document of an editor.
//!
//! Two more readers of the same paths are not in Rust, since their trees are not: the page's `model/json.ts` and the
//! Python package's `Scenario.__getitem__`.

use std::fmt;
use std::ops::Range;

use serde_json::Value as Json;

/// More keys than this are no path of a scenario.
const MOST_KEYS: usize = 16;

/// A dotted path of keys, as `--set` takes it. Two paths are equal if their keys are, whatever the blanks about them.
///
/// ```
/// use papilio_scenario::KeyPath;
/// let path = KeyPath::new("display.pixel.film.1.thickness_nm");
/// assert_eq!(path.keys().nth(3), Some("1"));
/// assert_eq!(path, KeyPath::new("display . pixel.film.1.thickness_nm"));
/// let scenario = serde_json::json!({ "display": { "pixel": { "film": [{}, { "thickness_nm": 9.5 }] } } });
/// assert_eq!(path.in_json(&scenario).and_then(|value| value.as_f64()), Some(9.5));
/// ```
#[derive(Debug, Clone)]
pub struct KeyPath {
    text: String,
    /// Where each key stands in the text, without blanks.
    keys: Vec<Range<usize>>,
}

/// Why a path leads nowhere.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct PathError {
    /// Which part of the path's text is wrong, in bytes.
    pub(crate) range: Range<usize>,
    /// What is wrong with it.
    pub(crate) message: String,
}

/// What a path leads through.
pub(crate) trait Tree: Sized {
    /// What a node holds.
    fn shape(&self) -> Shape;
    /// A node below this one, if it is there.
    fn child(&self, step: Step<'_>) -> Option<&Self>;
}

/// What a node of a [`Tree`] holds.
pub(crate) enum Shape {
    Table,
    /// So many items.
    Array(usize),
    /// A value of this kind, in words: it has no keys.
    Value(&'static str),
}

/// From a node to one below it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Step<'a> {
    Key(&'a str),
    /// At most the number of items: the one after the last is new.
    Index(usize),
}

/// Makes the nodes of a [`Tree`] that a path leads through.
pub(crate) trait Grow {
    type Tree: Tree;
    /// The node below `node`, which is made if it is not there.
    fn child<'a>(&mut self, node: &'a mut Self::Tree, at: At<'_>) -> Result<&'a mut Self::Tree, String>;
}

/// A place on the path that is followed.
pub(crate) struct At<'a> {
    pub(crate) path: &'a KeyPath,
    /// Which of the path's keys.
    pub(crate) number: usize,
    pub(crate) step: Step<'a>,
    /// Whether a new node is to be an array, not a table.
    pub(crate) array: bool,
}

impl KeyPath {
    /// A path; whether it leads anywhere is found out when it is followed.
    pub fn new(text: &str) -> Self {
        let mut start = 0;
        let key = |part: &str| {
            let lead = part.len() - part.trim_start().len();
            let begin = start + lead;
            start += part.len() + 1;
            begin..begin + part.trim().len()
        };
        Self { text: text.to_owned(), keys: text.split('.').map(key).collect() }
    }

    /// Its keys, without blanks; an array's index is one of them.
    pub fn keys(&self) -> impl ExactSizeIterator<Item = &str> {
        self.keys.iter().map(|key| &self.text[key.clone()])
    }

    /// A value of a JSON document, if there is one at this path.
    pub fn in_json<'a>(&self, root: &'a Json) -> Option<&'a Json> {
        self.get(root)
    }

    /// The path as it was written.
    pub(crate) fn text(&self) -> &str {
        &self.text
    }

    /// The table at the top that it leads into.
    pub(crate) fn first(&self) -> &str {
        self.keys().next().unwrap_or_default()
    }

    /// The path to what holds its last key, and that key; no such path if it has one key alone.
    pub(crate) fn split_last(&self) -> (Option<Self>, &str) {
        let Some((last, above)) = self.keys.split_last() else { return (None, "") };
        let parent =
            above.last().map(|end| Self { text: self.text[..end.end].to_owned(), keys: above.to_vec() });
        (parent, &self.text[last.clone()])
    }

    /// The paths to its first key, to its second, and so on, itself included.
    pub(crate) fn prefixes(&self) -> impl Iterator<Item = Self> {
        let prefix = |count: usize| Self {
            text: self.text[..self.keys[count - 1].end].to_owned(),
            keys: self.keys[..count].to_vec(),
        };
        (1..=self.keys.len()).map(prefix)
    }

    /// What is at the path, if it is there.
    pub(crate) fn get<'a, T: Tree>(&self, root: &'a T) -> Option<&'a T> {
        self.keys().try_fold(root, |node, key| node.child(step(node.shape(), key).ok()?))
    }

    /// Nothing, if this can be a path of a scenario: no key of it is empty, and it is not too long.
    pub(crate) fn check(&self) -> Result<(), PathError> {
        let wrong = |range: &Range<usize>, message: String| Err(PathError { range: range.clone(), message });
        if let Some(range) = self.keys.iter().find(|range| range.is_empty()) {
            return wrong(range, "the path has an empty key".to_owned());
        }
        match self.keys.get(MOST_KEYS) {
            Some(range) => wrong(range, format!("the path has more than {MOST_KEYS} keys")),
            None => Ok(()),
        }
    }

    /// What is at the path; what is not there is made by `grow`, an array at its end where `array`.
    pub(crate) fn put<'a, G: Grow>(
        &self,
        root: &'a mut G::Tree,
        array: bool,
        grow: &mut G,
    ) -> Result<&'a mut G::Tree, PathError> {
        self.check()?;
        let mut node = root;
        for (number, (key, range)) in self.keys().zip(&self.keys).enumerate() {
            let array = self.keys().nth(number + 1).map_or(array, |next| index(next).is_some());
            let wrong = |message| PathError { range: range.clone(), message };
            let step = step(node.shape(), key).map_err(wrong)?;
            node = grow.child(node, At { path: self, number, step, array }).map_err(wrong)?;
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

impl At<'_> {
    /// The path that ends here.
    pub(crate) fn path(&self) -> KeyPath {
        let keys = &self.path.keys[..=self.number];
        KeyPath { text: self.path.text[..keys[self.number].end].to_owned(), keys: keys.to_vec() }
    }

    /// True at the end of the path.
    pub(crate) fn is_last(&self) -> bool {
        self.number + 1 == self.path.keys.len()
    }

    /// Where the key stands in the path's text, in bytes.
    pub(crate) fn range(&self) -> Range<usize> {
        self.path.keys[self.number].clone()
    }
}

/// The path of a key below another path, which may be empty.
pub(crate) fn joined(above: &str, key: &str) -> String {
    if above.is_empty() { key.to_owned() } else { format!("{above}.{key}") }
}

/// The index that a key is, if it is one.
pub(crate) fn index(key: &str) -> Option<usize> {
    key.parse().ok()
}

/// What a key means at a node of this shape.
pub(crate) fn step(shape: Shape, key: &str) -> Result<Step<'_>, String> {
    match shape {
        Shape::Table => Ok(Step::Key(key)),
        Shape::Array(count) => match index(key) {
            Some(at) if at <= count => Ok(Step::Index(at)),
            Some(_) if count == 0 => Err("this array is empty or missing: its first index is 0".to_owned()),
            Some(_) => Err(format!("this array has the indices 0 to {}", count - 1)),
            None if key.parse::<i64>().is_ok() && count > 0 => {
                Err(format!("indices start at 0: this array has 0 to {}", count - 1))
            }
            None => Err("this is an array: an index is needed here".to_owned()),
        },
        Shape::Value(kind) => Err(format!("the value above this key is {kind}, it has no keys")),
    }
}

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
    fn a_path_knows_its_keys_and_where_they_stand() {
        let path = KeyPath::new(" a . b.0");
        assert_eq!(path.keys().collect::<Vec<_>>(), ["a", "b", "0"]);
        assert_eq!(path.keys, [1..2, 5..6, 7..8]);
        let (above, last) = path.split_last();
        assert_eq!((above.as_ref().map(KeyPath::text), last), (Some(" a . b"), "0"));
        assert_eq!(path.prefixes().map(|path| path.text).collect::<Vec<_>>(), [" a", " a . b", " a . b.0"]);
        assert_eq!(KeyPath::new("a").split_last(), (None, "a"));
        assert_eq!(KeyPath::new("").keys().collect::<Vec<_>>(), [""]);
    }

    #[test]
    fn a_step_takes_an_index_of_an_array_and_a_key_of_a_table() {
        assert_eq!(step(Shape::Table, "0"), Ok(Step::Key("0")));
        assert_eq!(step(Shape::Array(2), "2"), Ok(Step::Index(2)));
        for (shape, key, message) in [
            (Shape::Array(2), "3", "has the indices 0 to 1"),
            (Shape::Array(2), "-1", "indices start at 0"),
            (Shape::Array(0), "1", "its first index is 0"),
            (Shape::Array(2), "first", "an index is needed here"),
            (Shape::Value("a number"), "n", "is a number, it has no keys"),
        ] {
            assert!(step(shape, key).unwrap_err().contains(message), "{key}");
        }
    }
}
