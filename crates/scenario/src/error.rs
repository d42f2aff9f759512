//! Errors with their places: collected, sorted and printed.

use std::fmt;
use std::path::{Path, PathBuf};

use papilio_diagnostics::{Diagnostic, Interface, Place, Remedy, nearest};
use papilio_formats::{FormatError, Problem};

use crate::mistake::{Mistake, MistakeKind};
use crate::origin::Origin;
use crate::path::{KeyPath, index, joined};
use crate::source::Sources;
use crate::tree::{Node, Value};

/// All errors of a scenario, at least one.
#[derive(Debug, Clone, PartialEq)]
pub struct ScenarioErrors {
    errors: Vec<ScenarioError>,
    /// Number of further errors.
    more: usize,
}

/// One error. It is printed as by compilers, with the line and a caret below it.
#[derive(Debug, Clone, PartialEq)]
pub struct ScenarioError {
    /// The file (or `--set`), line and column.
    pub place: Place,
    /// What is wrong, what was expected, and a hint.
    pub diagnostic: Diagnostic,
    /// Kind of the error, for programs.
    pub kind: MistakeKind,
    /// Place in the scenario that names the file of `place`.
    pub asked_for_at: Option<Place>,
    /// A further note, for example which of many scenarios the error is in.
    pub note: Option<String>,
    /// Path of the key that it concerns, as in `--set`: `display.pixel.film.1.thickness_nm`.
    pub path: Option<String>,
}

impl ScenarioErrors {
    /// Returns the number of errors beyond those of [`iter`](Self::iter).
    pub fn more(&self) -> usize {
        self.more
    }

    /// Sets `asked_for_at` of all errors that are not on the line of this place.
    pub(crate) fn asked_for_at(mut self, place: &Place) -> Self {
        let line = |place: &Place| place.line_column().map(|(line, _)| line);
        for error in &mut self.errors {
            if error.place.name != place.name || line(&error.place) != line(place) {
                error.asked_for_at.get_or_insert_with(|| place.clone());
            }
        }
        self
    }

    /// Makes errors in the file that this text of `--set` names errors in an argument of the command: they do
    /// not mention the text.
    #[must_use]
    pub fn in_argument(mut self, set: &str) -> Self {
        let is_set = |place: &Place| place.spot.as_ref().is_some_and(|spot| spot.text == set);
        for error in self.errors.iter_mut().filter(|error| error.asked_for_at.as_ref().is_some_and(is_set)) {
            error.asked_for_at = None;
            if error.kind == MistakeKind::Unreadable {
                error.diagnostic.hint = Some("give the path of the file".to_owned());
            }
        }
        self
    }

    /// Sets the note of each error.
    pub(crate) fn noted(mut self, note: impl Fn(&ScenarioError) -> Option<String>) -> Self {
        self.errors.iter_mut().for_each(|error| error.note = note(error));
        self
    }

    /// Adds a note to each error, for example which of many scenarios this is.
    #[must_use]
    pub fn with_note(mut self, note: &str) -> Self {
        for error in &mut self.errors {
            error.diagnostic = error.diagnostic.clone().note(note);
        }
        self
    }

    /// Returns the errors as they are printed, in the words of an interface.
    pub fn text(&self, interface: Interface) -> String {
        let mut all: Vec<String> = self.errors.iter().map(|error| error.text(interface)).collect();
        all.extend((self.more > 0).then(|| format!("error: there are {} more errors, not shown", self.more)));
        all.join("\n\n")
    }

    /// Returns the first 50 errors, in the order of the text.
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
    /// Creates an error at a place.
    pub(crate) fn new(place: Place, mistake: impl Into<Mistake>) -> Self {
        let Mistake { kind, diagnostic } = mistake.into();
        Self { place, diagnostic, kind, asked_for_at: None, note: None, path: None }
    }

    /// Creates an error about a file as a whole.
    pub(crate) fn about_file(name: &str, mistake: impl Into<Mistake>) -> Self {
        Self::new(Place::whole(name), mistake)
    }

    /// Returns a hint in the words of an interface, if there is one.
    pub fn help(&self, interface: Interface) -> Option<String> {
        let help = self.diagnostic.help(interface);
        match (&self.kind, &self.asked_for_at, &self.note) {
            (MistakeKind::Unreadable, Some(_), _) => {
                help.or_else(|| Some("paths in a scenario are relative to its folder".to_owned()))
            }
            // The user did not write this number: it was drawn, or is the rest of a sum.
            (MistakeKind::OutOfRange, _, Some(_)) => None,
            _ => help,
        }
    }

    /// Returns the error as it is printed, in the words of an interface.
    fn text(&self, interface: Interface) -> String {
        let asked = self.asked_for_at.as_ref().map(|place| {
            let text = place.spot.as_ref().map_or("", |spot| spot.text.trim());
            let text: String = text.chars().take(LONGEST_NOTE).collect();
            format!("requested at {place}: {text}")
        });
        let notes = asked.iter().chain(&self.note);
        let shown = notes.fold(self.diagnostic.clone(), Diagnostic::note).hint_if(self.help(interface));
        Diagnostic { remedies: Vec::new(), ..shown }.at(&self.place).to_string()
    }
}

impl ScenarioError {
    /// The error of a scenario, or of a surface, that cannot be read; `example` is the path of one.
    pub(crate) fn unread(path: &Path, error: FormatError, example: &str) -> Self {
        let mut unread = Self::from(error);
        if unread.kind == MistakeKind::Unreadable {
            let hint = match near_file(path, ".toml") {
                Some(near) => format!("did you mean `{}`?", near.display()),
                None => format!("give the path of a {example}"),
            };
            unread.diagnostic.hint.get_or_insert(hint);
        }
        unread
    }
}

/// What is said of a missing scenario, and of a missing surface.
pub(crate) const EXAMPLE_SCENARIO: &str = "scenario, for example scenarios/indoor.toml";
pub(crate) const EXAMPLE_SURFACE: &str = "surface, for example surfaces/hemispheres.toml";

/// Largest number of names of a folder that are compared.
const MOST_NAMES: usize = 10_000;

/// Returns the file in the folder of a missing file whose name is nearest to that of the file, of those with this ending, such as
/// `.toml`; all files if it is empty.
pub fn near_file(path: &Path, ending: &str) -> Option<PathBuf> {
    if path.exists() {
        return None;
    }
    let folder = path.parent()?;
    let here = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let entries = std::fs::read_dir(here).ok()?.take(MOST_NAMES).flatten();
    let files = entries.filter(|entry| entry.path().is_file());
    let names = files.filter_map(|entry| entry.file_name().into_string().ok());
    let mut names: Vec<String> = names.filter(|name| name.ends_with(ending)).collect();
    names.sort();
    // Without the ending, which all have.
    let bare = |name: &'_ str| name.strip_suffix(ending).unwrap_or(name).to_owned();
    let wrong = bare(path.file_name()?.to_str()?);
    let known: Vec<String> = names.iter().map(|name| bare(name)).collect();
    let near = match known.contains(&wrong) {
        true => wrong,
        false => nearest(&wrong, known.iter().map(String::as_str))?.to_owned(),
    };
    Some(folder.join(format!("{near}{ending}")))
}

impl From<FormatError> for ScenarioError {
    fn from(error: FormatError) -> Self {
        let shown = match &error.problem {
            Problem::Picture { .. } => Some(Remedy::OnCommandLine(format!(
                "a scenario (TOML) comes first, as in `papilio image SCENARIO PICTURE`; `papilio image {} --on six-ink` needs none",
                error.place.name
            ))),
            _ => None,
        };
        let mut new = Self::new(error.place, error.problem);
        new.diagnostic.remedies.extend(shown);
        new
    }
}

impl fmt::Display for ScenarioErrors {
    /// Writes all errors in the words of the command line.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text(Interface::CommandLine))
    }
}

impl fmt::Display for ScenarioError {
    /// Writes the error in the words of the command line.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text(Interface::CommandLine))
    }
}

impl std::error::Error for ScenarioErrors {}
impl std::error::Error for ScenarioError {}

/// Longest quotation of a line, in characters.
const LONGEST_NOTE: usize = 120;

/// Largest number of errors that are listed.
const MOST_ERRORS: usize = 50;

/// Errors found so far.
#[derive(Debug, Default)]
pub(crate) struct Errors {
    found: Vec<(Origin, Mistake, Option<Place>)>,
    more: usize,
}

/// Returns a hint about an element of an array that a path created: `text` is the index, as in `--set`, or the path, as in
/// `[[sweep.axes]]`. The path of an element that the file has lacks no key.
fn appended(text: Option<&str>) -> Option<String> {
    let text = text?.trim();
    // In quotes as a key of TOML, and without them as a path.
    let whole = text.parse::<toml_edit::Key>().ok().map(|key| key.get().to_owned());
    let path = KeyPath::new(whole.as_deref().unwrap_or(text));
    let is_key = |(number, key): (usize, &str)| {
        path.is_quoted(number) || key.chars().all(|c| c.is_alphanumeric() || matches!(c, '_' | '-'))
    };
    let is_path = path.keys().enumerate().all(is_key);
    let index: usize = path.keys().filter_map(index).last().filter(|_| is_path)?;
    Some(match index.checked_sub(1) {
        None => "there is no such list yet: index 0 begins one, and its element needs this key".to_owned(),
        Some(last) => format!(
            "the list has the indices 0 to {last}: index {index} appends an element, which needs this key"
        ),
    })
}

impl Errors {
    /// Adds an error at a place of the scenario.
    pub(crate) fn push(&mut self, origin: Origin, mistake: impl Into<Mistake>) {
        self.add(origin, mistake.into(), None);
    }

    /// Adds an error inside a file that the scenario names at `origin`.
    pub(crate) fn push_data(&mut self, origin: Origin, error: FormatError) {
        self.add(origin, error.problem.into(), Some(error.place));
    }

    /// Adds an error at a place of a data file, if there is one.
    pub(crate) fn push_in_file(&mut self, origin: Origin, mistake: impl Into<Mistake>, file: Option<Place>) {
        self.add(origin, mistake.into(), file);
    }

    /// Adds an error of a file that cannot be opened or read; `tried` is a hint with the paths that were
    /// tried.
    pub(crate) fn push_unread(&mut self, origin: Origin, error: FormatError, tried: Option<String>) {
        let mut mistake: Mistake = error.problem.into();
        if mistake.kind == MistakeKind::Unreadable {
            mistake.diagnostic = mistake.diagnostic.hint_if(tried);
        }
        self.add(origin, mistake, Some(error.place));
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

    pub(crate) fn count(&self) -> usize {
        self.found.len()
    }

    /// States what a value may be in all its forms, in the errors at its place after the first `before`.
    pub(crate) fn expected_at(&mut self, before: usize, origin: Origin, words: &str) {
        let own = self.found.iter_mut().skip(before).filter(|(at, ..)| *at == origin);
        for (_, mistake, _) in own {
            mistake.diagnostic = mistake.diagnostic.clone().expected(words);
            if let MistakeKind::MissingKeys(keys) = &mut mistake.kind {
                keys.iter_mut().for_each(|key| words.clone_into(&mut key.expected));
            }
        }
    }

    /// If every item of a list has the same wrong type, replaces their errors, all after the first `before`, by
    /// one of the list.
    pub(crate) fn of_whole_list(&mut self, before: usize, list: &Node) {
        let Value::Array(items) = &list.value else { return };
        let (Some(own), true) = (self.found.get(before..), items.len() > 1) else { return };
        let Some((_, Mistake { diagnostic: first, .. }, None)) = own.first() else { return };
        let Some(found) = first.message.strip_prefix("this is ") else { return };
        let all_alike = own.len() == items.len()
            && own
                .iter()
                .zip(items)
                .all(|((origin, mistake, _), item)| *origin == item.origin && mistake.diagnostic == *first);
        if all_alike {
            let wrong = Diagnostic { message: format!("each item of this list is {found}"), ..first.clone() };
            self.found.truncate(before);
            self.push(list.origin, wrong);
        }
    }

    /// Returns `value`, or all errors in the order of the text.
    pub(crate) fn finish<T>(mut self, value: Option<T>, sources: &Sources) -> Result<T, ScenarioErrors> {
        match value {
            Some(value) if self.found.is_empty() => return Ok(value),
            _ => {}
        }
        self.found.sort_by_key(|(origin, ..)| *origin);
        self.found.dedup_by(|next, one| {
            one.2.is_none() && next.2.is_none() && one.0 == next.0 && one.1.takes(&next.1)
        });
        let error = |(origin, mut mistake, file): (Origin, Mistake, Option<Place>)| {
            if matches!(mistake.kind, MistakeKind::MissingKeys(_))
                && mistake.diagnostic.hint.is_none()
                && let Some(hint) = appended(sources.text(origin.source).get(origin.start..origin.end))
            {
                mistake.diagnostic = mistake.diagnostic.hint(hint);
            }
            let place = sources.place(origin);
            let path = sources.path(origin).map(|path| match &mistake.kind {
                MistakeKind::MissingKeys(keys) => {
                    keys.first().map_or(path.clone(), |key| joined(&path, &key.below))
                }
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

    /// Fails if any error has been found so far.
    pub(crate) fn check(&mut self, sources: &Sources) -> Result<(), ScenarioErrors> {
        std::mem::take(self).finish(Some(()), sources)
    }
}
