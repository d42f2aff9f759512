//! Errors with their places: how they are gathered, ordered and shown.

use std::fmt;

use papilio_diagnostics::{Diagnostic, Place};
use papilio_formats::FormatError;

use crate::mistake::{Mistake, MistakeKind};
use crate::origin::Origin;
use crate::path::joined;
use crate::source::Sources;

/// Everything that is wrong with a scenario; never empty.
#[derive(Debug, Clone, PartialEq)]
pub struct ScenarioErrors {
    errors: Vec<ScenarioError>,
    /// How many more there are.
    more: usize,
}

/// One thing that is wrong. Prints as compilers do, with the line and a caret below it.
#[derive(Debug, Clone, PartialEq)]
pub struct ScenarioError {
    /// The file (or `--set`), line and column.
    pub place: Place,
    /// What is wrong there, what was expected, and what to do.
    pub diagnostic: Diagnostic,
    /// What code has to know of it.
    pub kind: MistakeKind,
    /// Where the scenario asks for the file that `place` is in.
    pub asked_for_at: Option<Place>,
    /// What else there is to know: which of many scenarios this is of.
    pub note: Option<String>,
    /// The key that it concerns, as of `--set`: `display.pixel.film.1.thickness_nm`.
    pub path: Option<String>,
}

impl ScenarioErrors {
    /// How many more there are than [`iter`](Self::iter) gives.
    pub fn more(&self) -> usize {
        self.more
    }

    /// The same, asked for at this place where they are not of it.
    pub(crate) fn asked_for_at(mut self, place: &Place) -> Self {
        let line = |place: &Place| place.line_column().map(|(line, _)| line);
        for error in &mut self.errors {
            if error.place.name != place.name || line(&error.place) != line(place) {
                error.asked_for_at.get_or_insert_with(|| place.clone());
            }
        }
        self
    }

    /// The same, with something else to know about each.
    pub(crate) fn noted(mut self, note: impl Fn(&ScenarioError) -> Option<String>) -> Self {
        self.errors.iter_mut().for_each(|error| error.note = note(error));
        self
    }

    /// The same, each with a note: which of many scenarios this is.
    #[must_use]
    pub fn with_note(mut self, note: &str) -> Self {
        for error in &mut self.errors {
            error.diagnostic = error.diagnostic.clone().note(note);
        }
        self
    }

    /// The errors, in the order of the text; the first 50 that were found.
    pub fn iter(&self) -> impl Iterator<Item = &ScenarioError> {
        self.errors.iter()
    }
}

impl From<ScenarioError> for ScenarioErrors {
    fn from(error: ScenarioError) -> Self {
        Self { errors: vec![error], more: 0 }
    }
}

impl ScenarioError {
    /// An error at a place.
    pub(crate) fn new(place: Place, mistake: impl Into<Mistake>) -> Self {
        let Mistake { kind, diagnostic } = mistake.into();
        Self { place, diagnostic, kind, asked_for_at: None, note: None, path: None }
    }

    /// An error about a file as a whole.
    pub(crate) fn about_file(name: &str, mistake: impl Into<Mistake>) -> Self {
        Self::new(Place::whole(name), mistake)
    }

    /// What to do about it.
    pub fn hint(&self) -> Option<&str> {
        match (&self.kind, &self.asked_for_at, &self.note) {
            (MistakeKind::Unreadable, Some(_), _) => Some("paths in a scenario are relative to its folder"),
            (MistakeKind::Unreadable, None, _) => {
                Some("give the path of a scenario, for example scenarios/indoor.toml")
            }
            // Nobody wrote this number: it was drawn, or is what a sum leaves.
            (MistakeKind::OutOfRange, _, Some(_)) => None,
            _ => self.diagnostic.hint.as_deref(),
        }
    }
}

impl From<FormatError> for ScenarioError {
    fn from(error: FormatError) -> Self {
        Self::new(error.place, error.problem)
    }
}

impl fmt::Display for ScenarioErrors {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, error) in self.errors.iter().enumerate() {
            if i > 0 {
                f.write_str("\n\n")?;
            }
            error.fmt(f)?;
        }
        match self.more {
            0 => Ok(()),
            more => write!(f, "\n\nerror: there are {more} more errors, not shown"),
        }
    }
}

impl fmt::Display for ScenarioError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let asked = self.asked_for_at.as_ref().map(|place| {
            let text = place.spot.as_ref().map_or("", |spot| spot.text.trim());
            let text: String = text.chars().take(LONGEST_NOTE).collect();
            format!("it is asked for at {place}: {text}")
        });
        let notes = asked.iter().chain(&self.note);
        let shown = notes.fold(self.diagnostic.clone(), Diagnostic::note).hint_if(self.hint());
        shown.at(&self.place).fmt(f)
    }
}

impl std::error::Error for ScenarioErrors {}
impl std::error::Error for ScenarioError {}

/// A longer line is quoted in part.
const LONGEST_NOTE: usize = 120;

/// Nobody reads more errors than this at once.
const MOST_ERRORS: usize = 50;

/// Errors as they are found.
#[derive(Debug, Default)]
pub(crate) struct Errors {
    found: Vec<(Origin, Mistake, Option<Place>)>,
    more: usize,
}

impl Errors {
    /// An error at a place of the scenario.
    pub(crate) fn push(&mut self, origin: Origin, mistake: impl Into<Mistake>) {
        self.add(origin, mistake.into(), None);
    }

    /// An error inside a file that the scenario asks for at `origin`.
    pub(crate) fn push_data(&mut self, origin: Origin, error: FormatError) {
        self.add(origin, error.problem.into(), Some(error.place));
    }

    fn add(&mut self, origin: Origin, mistake: Mistake, file: Option<Place>) {
        if self.found.len() < MOST_ERRORS {
            self.found.push((origin, mistake, file));
        } else {
            self.more += 1;
        }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.found.is_empty()
    }

    /// `value`, or all errors in the order of the text.
    pub(crate) fn finish<T>(mut self, value: Option<T>, sources: &Sources) -> Result<T, ScenarioErrors> {
        match value {
            Some(value) if self.found.is_empty() => return Ok(value),
            _ => {}
        }
        self.found.sort_by_key(|(origin, ..)| *origin);
        let error = |(origin, mistake, file): (Origin, Mistake, Option<Place>)| {
            let place = sources.place(origin);
            let path = sources.path(origin).map(|path| match &mistake.kind {
                MistakeKind::MissingKey(key) => joined(&path, key),
                _ => path,
            });
            let (place, asked_for_at) = match file {
                Some(file) => (file, Some(place)),
                None => (place, None),
            };
            let path = path.filter(|path| !path.is_empty());
            ScenarioError { asked_for_at, path, ..ScenarioError::new(place, mistake) }
        };
        Err(ScenarioErrors { errors: self.found.into_iter().map(error).collect(), more: self.more })
    }

    /// Fails with what has been found so far, if anything.
    pub(crate) fn check(&mut self, sources: &Sources) -> Result<(), ScenarioErrors> {
        std::mem::take(self).finish(Some(()), sources)
    }
}
