//! Texts of a scenario, and places in them.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use papilio_diagnostics::Place;

use crate::origin::Origin;
use crate::tree::Node;

/// Begins an override that is an axis of a sweep, `--axis KEY=VALUES`, instead of a `--set`. Overrides of other options
/// begin with their names, too.
pub(crate) const AXIS: &str = "--axis ";

/// The scenario file, then each `--set` in order, then other texts that change it.
#[derive(Debug, Clone)]
pub(crate) struct Sources {
    texts: Vec<(String, String)>,
    /// The parsed scenario file; each node has its place.
    document: Arc<Node>,
    /// Of each `--set`, whether it is an axis of a sweep.
    is_axis: Vec<bool>,
    /// Folder of the scenario file, if paths in `--set` are relative to the current folder.
    folder: Option<PathBuf>,
}

impl Sources {
    /// `document` is the parsed text of the file.
    pub(crate) fn new(file_name: &str, file_text: &str, document: Node, overrides: &[String]) -> Self {
        let mut texts = vec![(file_name.to_owned(), file_text.to_owned())];
        let mut axes = 0..0;
        for text in overrides {
            let (name, text) = match text.split_once(' ').filter(|(option, _)| option.starts_with("--")) {
                Some((option, text)) if AXIS.starts_with(option) => {
                    axes.end += 1;
                    (format!("{option} #{}", axes.end), text)
                }
                Some((option, text)) => (option.to_owned(), text),
                None => (format!("--set #{}", texts.len() - axes.end), &**text),
            };
            texts.push((name, text.to_owned()));
        }
        let is_axis = overrides.iter().map(|text| text.starts_with(AXIS)).collect();
        Self { texts, document: Arc::new(document), is_axis, folder: None }
    }

    /// Returns whether an override, by the number of its source, is an axis of a sweep.
    pub(crate) fn is_axis(&self, source: usize) -> bool {
        source > 0 && self.is_axis.get(source - 1).copied().unwrap_or(false)
    }

    /// Makes the paths in `--set` relative to the current folder; the scenario is in `folder`.
    pub(crate) fn in_folder(self, folder: &Path) -> Self {
        Self { folder: Some(folder.to_owned()), ..self }
    }

    /// Folder of the scenario file, if paths in `--set` are relative to the current folder.
    pub(crate) fn folder(&self) -> Option<&Path> {
        self.folder.as_deref()
    }

    /// Adds a text, which errors call `name`, and returns the place of the whole text.
    pub(crate) fn add(&mut self, name: &str, text: &str) -> Origin {
        self.texts.push((name.to_owned(), text.to_owned()));
        Origin { source: self.texts.len() - 1, start: 0, end: text.len() }
    }

    pub(crate) fn text(&self, source: usize) -> &str {
        self.texts.get(source).map_or("", |(_, text)| text)
    }

    /// The parsed scenario file, without changes.
    pub(crate) fn document(&self) -> &Node {
        &self.document
    }

    /// Number of `--set`.
    pub(crate) fn overrides(&self) -> usize {
        self.is_axis.len()
    }

    /// Returns the path of the key or value at a place, as in `--set`; empty for the whole scenario.
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
