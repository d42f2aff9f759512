//! Scenarios whose keys vary: the text is parsed once, and read again with every set of values.

use std::path::Path;

use papilio_diagnostics::{Diagnostic, Place};
use papilio_formats::DataFile;
use serde_json::Value as Json;

use crate::error::{EXAMPLE_SCENARIO, ScenarioError, ScenarioErrors};
use crate::library::Library;
use crate::mistake::{self, Mistake, MistakeKind};
use crate::origin::Origin;
use crate::path::KeyPath;
use crate::renamed;
use crate::scenario::{CompleteTree, Scenario, assemble, parse};
use crate::set::Change;
use crate::source::Sources;
use crate::tree::{Entry, Node, Value};

/// Tables of studies, which are not part of the scenario itself.
pub(crate) const STUDY_TABLES: [&str; 4] = ["sweep", "optimize", "tolerance", "fit"];

/// Tables of how a scenario is computed, and of the virtual instrument: no quantities of what is shown.
const SETTINGS: [&str; 3] = ["measure", "solver", "spectrum"];

/// The mistake in a path that a study other than a sweep cannot vary; `expected` is what it can vary. A search or a fit would follow the
/// errors of the computation, and production does not change its settings.
pub(crate) fn no_quantity(path: &str, expected: &str) -> Option<Diagnostic> {
    let path = KeyPath::new(path);
    if STUDY_TABLES.contains(&path.first()) {
        let wrong = "keys of `[sweep]`, `[optimize]`, `[tolerance]` and `[fit]` cannot be variables";
        return Some(Diagnostic::new(wrong).expected(expected));
    }
    let is_setting = SETTINGS.contains(&path.first()) || path.split_last().1 == "seed";
    is_setting.then(|| {
        let wrong = format!(
            "`{}` is a setting, and no quantity of the display, the light or the viewer",
            path.text()
        );
        Diagnostic::new(wrong).expected(expected).hint("a sweep varies any key")
    })
}

/// What [`no_quantity`] expects of a search or of a tolerance analysis.
pub(crate) const QUANTITY: &str =
    "a key of what is shown, such as those of [display], [lighting] and [viewer]";

/// A parsed scenario, and the library of its files.
#[derive(Debug, Clone)]
pub(crate) struct ParsedScenario {
    library: Library,
    pub(crate) sources: Sources,
}

impl ParsedScenario {
    pub(crate) fn load(path: &Path, overrides: &[String]) -> Result<Self, ScenarioErrors> {
        let name = path.display().to_string();
        let unread = |error| ScenarioError::unread(path, error, EXAMPLE_SCENARIO);
        let file = DataFile::open(path, &name).map_err(unread)?;
        let text = file.text().map_err(ScenarioError::from)?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let parsed = Self::from_text(text, &name, folder, overrides)?;
        Ok(Self { sources: parsed.sources.in_folder(folder), ..parsed })
    }

    pub(crate) fn from_text(
        text: &str,
        name: &str,
        library: impl Into<Library>,
        overrides: &[String],
    ) -> Result<Self, ScenarioErrors> {
        Ok(Self { library: library.into(), sources: parse(text, name, overrides)? })
    }

    pub(crate) fn library(&self) -> &Library {
        &self.library
    }

    /// Builds the whole tree, including the tables of studies.
    pub(crate) fn assembled(&self) -> Result<Node, ScenarioErrors> {
        Ok(assemble(&self.sources, &[])?.root)
    }

    /// Returns one note for each old name, those in the tables of studies included.
    pub(crate) fn notes(&self) -> Result<Vec<String>, ScenarioErrors> {
        let CompleteTree { root, mut notes, .. } = assemble(&self.sources, &[])?;
        let of_studies = renamed::notes(&renamed::in_studies(&root));
        notes.extend(of_studies.into_iter().filter(|note| !notes.contains(note)).collect::<Vec<_>>());
        Ok(notes)
    }

    /// Returns the mistake in a path that no scenario can have; `None` if the path is possible.
    pub(crate) fn wrong_path(&self, path: &str, origin: Origin) -> Option<Mistake> {
        let place = self.sources.place(origin);
        let wrong = |path: KeyPath| {
            let value = Node { origin, value: Value::Float(0.0) };
            let change = Change { path, origin, value };
            let errors = self.scenario(&[change]).and_then(|scenario| scenario.resolve()).err()?;
            let mut here = errors.iter().filter(|error| error.place == place);
            let wrong = here.find(|error| error.kind == MistakeKind::Path)?;
            Some(mistake::of_path(wrong.diagnostic.clone()))
        };
        // Only the first wrong key counts: the keys below it have no meaning.
        KeyPath::new(path).prefixes().find_map(wrong)
    }

    /// Reads the scenario with changes; a change of the preset is made first.
    pub(crate) fn scenario(&self, changes: &[Change]) -> Result<Scenario, ScenarioErrors> {
        let CompleteTree { mut root, warnings, notes } = assemble(&self.sources, changes)?;
        STUDY_TABLES.iter().for_each(|table| root.remove(table));
        Scenario::read(CompleteTree { root, warnings, notes }, self.library.clone(), self.sources.clone())
    }
}

/// Declares `load` and `from_text` for a study, which is read from a scenario.
macro_rules! read_of_scenarios {
    ($name:ident: $what:literal, $read:expr) => {
        impl $name {
            #[doc = concat!("Reads a scenario file with ", $what, ". `overrides` are texts `PATH=VALUE`, as in `--set`.")]
            ///
            /// # Errors
            /// All mistakes in its bytes, its TOML and the study, each with its place.
            pub fn load(
                path: &std::path::Path,
                overrides: &[String],
            ) -> Result<Self, $crate::error::ScenarioErrors> {
                $crate::varied::ParsedScenario::load(path, overrides).and_then($read)
            }

            /// Reads the same from a text. Errors call it `name`. Its files are in `library`; a path is the
            /// folder of the files.
            ///
            /// # Errors
            /// As [`load`](Self::load).
            pub fn from_text(
                text: &str,
                name: &str,
                library: impl Into<$crate::library::Library>,
                overrides: &[String],
            ) -> Result<Self, $crate::error::ScenarioErrors> {
                $crate::varied::ParsedScenario::from_text(text, name, library, overrides).and_then($read)
            }
        }
    };
}
pub(crate) use read_of_scenarios;

/// A scenario some of whose keys vary, for searches, tolerance analyses and batches of designs.
///
/// ```
/// use papilio_scenario::{ParameterisedScenario, new_scenario};
/// use std::path::Path;
///
/// let text = new_scenario("indoor").unwrap();
/// let keys = ["display.pixel.film.1.thickness_nm".to_owned(), "viewer.theta_deg".to_owned()];
/// let varied = ParameterisedScenario::from_text(&text, "indoor.toml", Path::new(""), &[], &keys)?;
/// let scene = varied.scenario(&[14.0.into(), 20.0.into()])?.resolve()?.scene;
/// assert_eq!(scene.viewer.theta_deg, [20.0]);
/// # Ok::<(), papilio_scenario::ScenarioErrors>(())
/// ```
#[derive(Debug, Clone)]
pub struct ParameterisedScenario {
    base: ParsedScenario,
    /// Changes that are the same for all values.
    fixed: Vec<Change>,
    keys: Vec<VariedKey>,
}

/// A key that varies.
#[derive(Debug, Clone)]
pub(crate) struct VariedKey {
    pub(crate) path: KeyPath,
    /// Place of the path in the text.
    pub(crate) origin: Origin,
    /// Place of the values in the text.
    pub(crate) values: Origin,
}

impl ParameterisedScenario {
    /// Reads a scenario file whose keys at `paths` (as in `--set`) will vary.
    ///
    /// # Errors
    /// Mistakes in its bytes and its TOML. Mistakes in keys and values are reported by
    /// [`scenario`](Self::scenario).
    pub fn load(path: &Path, overrides: &[String], paths: &[String]) -> Result<Self, ScenarioErrors> {
        ParsedScenario::load(path, overrides).map(|base| Self::of_paths(base, paths))
    }

    /// Reads the same from a text. Errors call it `name`. Its files are in `library`; a path is the folder of
    /// the files.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn from_text(
        text: &str,
        name: &str,
        library: impl Into<Library>,
        overrides: &[String],
        paths: &[String],
    ) -> Result<Self, ScenarioErrors> {
        ParsedScenario::from_text(text, name, library, overrides).map(|base| Self::of_paths(base, paths))
    }

    fn of_paths(mut base: ParsedScenario, paths: &[String]) -> Self {
        let key = |path: &String| VariedKey::at(path, base.sources.add("key", path));
        let keys = paths.iter().map(key).collect();
        Self::new(base, Vec::new(), keys)
    }

    pub(crate) fn new(base: ParsedScenario, fixed: Vec<Change>, keys: Vec<VariedKey>) -> Self {
        Self { base, fixed, keys }
    }

    /// Returns the paths of the keys.
    pub fn paths(&self) -> impl Iterator<Item = &str> {
        self.keys.iter().map(|key| key.path.text())
    }

    /// Returns the place of the values of each key.
    pub(crate) fn places(&self) -> impl Iterator<Item = Place> {
        self.keys.iter().map(|key| self.base.sources.place(key.values))
    }

    /// Reads the scenario with these values, one for each key. A null does not change its key.
    ///
    /// # Errors
    /// As [`Scenario::load`]; a value's place is that of its key.
    pub fn scenario(&self, values: &[Json]) -> Result<Scenario, ScenarioErrors> {
        let given = self.keys.iter().zip(values).filter(|(_, value)| !value.is_null());
        let varied = given.map(|(key, value)| Change {
            path: key.path.clone(),
            origin: key.origin,
            value: Node::from_json(value, key.values),
        });
        self.with(varied)
    }

    /// The same scenario with other values of some keys, each a path with its value. Whether they are possible shows when it is
    /// resolved.
    pub fn with_values(&self, values: &[(&str, Json)]) -> Self {
        let origin = Origin::FILE;
        let change = |(path, value): &(&str, Json)| {
            let (path, value) = (KeyPath::new(path), Node::from_json(value, origin));
            Change { path, origin, value }
        };
        let mut other = self.clone();
        other.fixed.extend(values.iter().map(change));
        other
    }

    /// Reads the scenario with these changes.
    pub(crate) fn with(&self, changes: impl Iterator<Item = Change>) -> Result<Scenario, ScenarioErrors> {
        let changes: Vec<Change> = self.fixed.iter().cloned().chain(changes).collect();
        self.base.scenario(&changes)
    }
}

impl VariedKey {
    /// A key whose values have no place of their own.
    pub(crate) fn at(path: &str, origin: Origin) -> Self {
        Self { path: KeyPath::new(path), origin, values: origin }
    }
}

impl Node {
    /// Converts a JSON value; all of it gets one place, and a null becomes an empty text.
    pub(crate) fn from_json(value: &Json, origin: Origin) -> Self {
        let node = |value: &Json| Self::from_json(value, origin);
        let value = match value {
            Json::Null => Value::Text(String::new()),
            Json::Bool(value) => Value::Bool(*value),
            Json::Number(number) => {
                let float = || Value::Float(number.as_f64().unwrap_or(f64::NAN));
                number.as_i64().map_or_else(float, Value::Integer)
            }
            Json::String(text) => Value::Text(text.clone()),
            Json::Array(items) => Value::Array(items.iter().map(node).collect()),
            Json::Object(entries) => {
                let entry = |(key, value): (&String, &Json)| Entry {
                    key: key.clone(),
                    key_origin: origin,
                    node: node(value),
                };
                Value::Table(entries.iter().map(entry).collect())
            }
        };
        Self { origin, value }
    }
}
