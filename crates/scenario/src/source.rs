//! The texts that a scenario comes from, and where in them a value stands.

use papilio_formats::Place;

use crate::error::Errors;
use crate::tree::Node;

/// A stretch of one of the [`Sources`], in bytes; an empty one means all of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Origin {
    pub(crate) source: usize,
    pub(crate) start: usize,
    pub(crate) end: usize,
}

impl Origin {
    /// The scenario file as a whole.
    pub(crate) const FILE: Self = Self { source: 0, start: 0, end: 0 };

    /// This place, or that of the last `--set` among the other values that have a part in
    /// an error: a file that was right before is not what is wrong.
    pub(crate) fn or_set(self, others: impl IntoIterator<Item = Self>) -> Self {
        others.into_iter().fold(self, |at, other| if other.source > at.source { other } else { at })
    }
}

/// The scenario file, then each `--set` in turn.
#[derive(Debug, Clone)]
pub(crate) struct Sources(Vec<(String, String)>);

impl Sources {
    pub(crate) fn new(file_name: &str, file_text: &str, overrides: &[String]) -> Self {
        let mut sources = vec![(file_name.to_owned(), file_text.to_owned())];
        let sets = overrides.iter().enumerate();
        sources.extend(sets.map(|(i, text)| (format!("--set #{}", i + 1), text.clone())));
        Self(sources)
    }

    pub(crate) fn text(&self, source: usize) -> &str {
        self.0.get(source).map_or("", |(_, text)| text)
    }

    /// How many `--set` there are.
    pub(crate) fn overrides(&self) -> usize {
        self.0.len() - 1
    }

    /// The path of the key or value at a place, as of `--set`; empty for the scenario as a whole.
    pub(crate) fn path(&self, origin: Origin) -> Option<String> {
        let text = self.text(origin.source);
        if origin.source > 0 {
            return text.split_once('=').map(|(path, _)| path.trim().to_owned());
        }
        if origin == Origin::FILE {
            return Some(String::new());
        }
        Node::parse_document(text, &mut Errors::default()).path_to(origin)
    }

    pub(crate) fn place(&self, origin: Origin) -> Place {
        let (name, text) = self.0.get(origin.source).map_or(("", ""), |(name, text)| (name, text));
        if origin.start == origin.end && origin.source == 0 {
            return Place::whole(name);
        }
        Place::in_text(name, text, origin.start..origin.end)
    }
}
