//! Tables of several kinds, selected by one key (`model`, `kind`).

use papilio_diagnostics::{Diagnostic, quoted};

use crate::error::Errors;
use crate::mistake;
use crate::origin::Origin;
use crate::read::unknown_word;
use crate::tree::{Entry, Node, Value};

/// The possible kinds of a table, and the key that selects one.
pub(crate) struct Kinds {
    pub(crate) tag: &'static str,
    pub(crate) known: Vec<Kind>,
    pub(crate) later: &'static [&'static str],
}

/// One kind of table.
pub(crate) struct Kind {
    /// Value of the tag.
    pub(crate) word: &'static str,
    /// Tag and value as they are written.
    pub(crate) named: &'static str,
    /// The keys besides the tag.
    pub(crate) keys: Vec<&'static str>,
}

impl Kinds {
    /// Returns the kind of a table, the place of its tag, and the table with the remaining keys.
    /// Keys that only other kinds have are reported as errors.
    pub(crate) fn split(&self, node: &Node, errors: &mut Errors) -> Option<(&'static str, Origin, Node)> {
        let words: Vec<&str> = self.known.iter().map(|kind| kind.word).collect();
        let in_words = || quoted(words.iter().copied());
        let Some(tag) = node.get(self.tag) else {
            errors.push(node.origin, mistake::missing_key(self.tag, in_words()));
            return None;
        };
        let Value::Text(word) = &tag.value else { return tag.wrong_type(in_words(), errors) };
        let Some(kind) = self.known.iter().find(|kind| kind.word == word) else {
            return unknown_word(tag, word, &words, self.later, errors);
        };
        let mut rest = node.clone();
        // A missing key of a kind is reported at the tag, if `--set` has set it.
        rest.origin = node.origin.or_override([tag.origin]);
        if let Value::Table(entries) = &mut rest.value {
            entries.retain(|entry| entry.key != self.tag && !self.is_alien(entry, kind, tag.origin, errors));
        }
        Some((kind.word, tag.origin, rest))
    }

    /// Reports a key that other kinds have and this one does not.
    fn is_alien(&self, entry: &Entry, kind: &Kind, tag: Origin, errors: &mut Errors) -> bool {
        if kind.keys.contains(&entry.key.as_str()) {
            return false;
        }
        let others = self.known.iter().filter(|other| other.keys.contains(&entry.key.as_str()));
        let of: Vec<&str> = others.map(|other| other.named).collect();
        let alien = !of.is_empty();
        if alien {
            let (key, named, of) = (&entry.key, kind.named, of.join(" and "));
            // The same quantity in the unit of this kind.
            let quantity = |key: &str| papilio_display::split_unit(key).0.to_owned();
            let same = kind.keys.iter().find(|own| quantity(own) == quantity(key));
            let hint = match same {
                Some(own) => format!("write `{own}`, in this unit: `{key}` is a key of {of}"),
                None => format!("remove it: `{key}` is a key of {of}"),
            };
            let wrong = Diagnostic::new(format!("`{key}` cannot be combined with {named}")).hint(hint);
            errors.push(entry.node.origin.or_override([tag]), mistake::of_path(wrong));
        }
        alien
    }
}
