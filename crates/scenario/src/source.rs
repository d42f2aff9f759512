//! The texts that a scenario comes from, and where in them a value stands.

use std::sync::Arc;

use papilio_diagnostics::Place;

use crate::origin::Origin;
use crate::tree::Node;

/// The scenario file, then each `--set` in turn, then what else may change it.
#[derive(Debug, Clone)]
pub(crate) struct Sources {
    texts: Vec<(String, String)>,
    /// The scenario file, parsed: each of its nodes knows where it stands.
    document: Arc<Node>,
    /// How many `--set` there are.
    overrides: usize,
}

impl Sources {
    /// `document`: the file's text, parsed.
    pub(crate) fn new(file_name: &str, file_text: &str, document: Node, overrides: &[String]) -> Self {
        let mut texts = vec![(file_name.to_owned(), file_text.to_owned())];
        let sets = overrides.iter().enumerate();
        texts.extend(sets.map(|(i, text)| (format!("--set #{}", i + 1), text.clone())));
        Self { texts, document: Arc::new(document), overrides: overrides.len() }
    }

    /// One more text, which errors call `name`, and all of it as a place.
    pub(crate) fn add(&mut self, name: &str, text: &str) -> Origin {
        self.texts.push((name.to_owned(), text.to_owned()));
        Origin { source: self.texts.len() - 1, start: 0, end: text.len() }
    }

    pub(crate) fn text(&self, source: usize) -> &str {
        self.texts.get(source).map_or("", |(_, text)| text)
    }

    /// The scenario file as it stands.
    pub(crate) fn document(&self) -> &Node {
        &self.document
    }

    /// How many `--set` there are.
    pub(crate) fn overrides(&self) -> usize {
        self.overrides
    }

    /// The path of the key or value at a place, as of `--set`; empty for the scenario as a whole.
    pub(crate) fn path(&self, origin: Origin) -> Option<String> {
        let text = self.text(origin.source);
        if origin.source > 0 {
            return Some(text.split_once('=').map_or(text, |(path, _)| path).trim().to_owned());
        }
        if origin == Origin::FILE {
            return Some(String::new());
        }
        self.document.path_to(origin)
    }

    pub(crate) fn place(&self, origin: Origin) -> Place {
        let (name, text) = self.texts.get(origin.source).map_or(("", ""), |(name, text)| (name, text));
        if origin.start == origin.end && origin.source == 0 {
            return Place::whole(name);
        }
        Place::in_text(name, text, origin.start..origin.end)
    }
}
