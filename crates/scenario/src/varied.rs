//! A scenario whose keys vary: the text is parsed once, and read anew with every set of values.

use std::path::Path;

use papilio_diagnostics::Place;
use papilio_formats::DataFile;
use serde_json::Value as Json;

use crate::error::{ScenarioError, ScenarioErrors};
use crate::library::Library;
use crate::mistake::{self, Mistake, MistakeKind};
use crate::origin::Origin;
use crate::path::KeyPath;
use crate::scenario::{Assembled, Scenario, assemble, parse};
use crate::set::Change;
use crate::source::Sources;
use crate::tree::{Entry, Node, Value};

/// Tables that say what else might be computed of a scenario; they have no part in the scenario itself.
pub(crate) const ABOUT: [&str; 3] = ["sweep", "optimize", "tolerance"];

/// The text of a scenario, parsed, and its files.
#[derive(Debug, Clone)]
pub(crate) struct Base {
    library: Library,
    pub(crate) sources: Sources,
}

impl Base {
    pub(crate) fn load(path: &Path, overrides: &[String]) -> Result<Self, ScenarioErrors> {
        let name = path.display().to_string();
        let file = DataFile::open(path, &name).map_err(ScenarioError::from)?;
        let text = file.text().map_err(ScenarioError::from)?;
        Self::from_text(text, &name, path.parent().unwrap_or(Path::new("")), overrides)
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

    /// The whole tree as it stands, what is about the scenario included.
    pub(crate) fn assembled(&self) -> Result<Node, ScenarioErrors> {
        Ok(assemble(&self.sources, &[])?.root)
    }

    /// What is wrong with a path that no scenario has, if that is so.
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
        // The first of its keys that is wrong: what follows has no meaning then.
        KeyPath::new(path).prefixes().find_map(wrong)
    }

    /// The scenario with changes, those of the preset first.
    pub(crate) fn scenario(&self, changes: &[Change]) -> Result<Scenario, ScenarioErrors> {
        let Assembled { mut root, warnings } = assemble(&self.sources, changes)?;
        ABOUT.iter().for_each(|table| root.remove(table));
        Scenario::read(Assembled { root, warnings }, self.library.clone(), self.sources.clone())
    }
}

/// Declares how a type is read that a scenario says besides itself: of a file and of a text.
macro_rules! read_of_scenarios {
    ($name:ident: $what:literal, $read:expr) => {
        impl $name {
            #[doc = concat!("Reads a scenario file with ", $what, "; `overrides` are texts `PATH=VALUE`, as of `--set`.")]
            ///
            /// # Errors
            /// What is wrong with its bytes, its TOML and what is read, each with its place.
            pub fn load(
                path: &std::path::Path,
                overrides: &[String],
            ) -> Result<Self, $crate::error::ScenarioErrors> {
                $crate::varied::Base::load(path, overrides).and_then($read)
            }

            /// The same of a text; errors call it `name`, and its files are in `library` (of a path: relative to this
            /// folder).
            ///
            /// # Errors
            /// As [`load`](Self::load).
            pub fn from_text(
                text: &str,
                name: &str,
                library: impl Into<$crate::library::Library>,
                overrides: &[String],
            ) -> Result<Self, $crate::error::ScenarioErrors> {
                $crate::varied::Base::from_text(text, name, library, overrides).and_then($read)
            }
        }
    };
}
pub(crate) use read_of_scenarios;

/// A scenario some of whose keys vary: what a search, a tolerance analysis and a batch of designs hold.
///
/// ```
/// use papilio_scenario::{Varied, new_scenario};
/// use std::path::Path;
///
/// let text = new_scenario("indoor").unwrap();
/// let keys = ["display.pixel.film.1.thickness_nm".to_owned(), "viewer.theta_deg".to_owned()];
/// let varied = Varied::from_text(&text, "indoor.toml", Path::new(""), &[], &keys)?;
/// let scene = varied.scenario(&[14.0.into(), 20.0.into()])?.resolve()?.scene;
/// assert_eq!(scene.viewer.theta_deg, [20.0]);
/// # Ok::<(), papilio_scenario::ScenarioErrors>(())
/// ```
#[derive(Debug, Clone)]
pub struct Varied {
    base: Base,
    /// What holds whatever varies.
    fixed: Vec<Change>,
    keys: Vec<VariedKey>,
}

/// A key that varies.
#[derive(Debug, Clone)]
pub(crate) struct VariedKey {
    pub(crate) path: KeyPath,
    /// Where the path stands.
    pub(crate) origin: Origin,
    /// Where it is said what values it has.
    pub(crate) values: Origin,
}

impl Varied {
    /// Reads a scenario file, of which the keys at `paths` (as of `--set`) will vary.
    ///
    /// # Errors
    /// What is wrong with its bytes and its TOML. What is wrong with keys and values shows in [`scenario`](Self::scenario).
    pub fn load(path: &Path, overrides: &[String], paths: &[String]) -> Result<Self, ScenarioErrors> {
        Base::load(path, overrides).map(|base| Self::of_paths(base, paths))
    }

    /// The same of a text; errors call it `name`, and its files are in `library` (of a path: relative to this folder).
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
        Base::from_text(text, name, library, overrides).map(|base| Self::of_paths(base, paths))
    }

    fn of_paths(mut base: Base, paths: &[String]) -> Self {
        let key = |path: &String| VariedKey::at(path, base.sources.add("key", path));
        let keys = paths.iter().map(key).collect();
        Self::new(base, Vec::new(), keys)
    }

    pub(crate) fn new(base: Base, fixed: Vec<Change>, keys: Vec<VariedKey>) -> Self {
        Self { base, fixed, keys }
    }

    /// The paths of the keys.
    pub fn paths(&self) -> impl Iterator<Item = &str> {
        self.keys.iter().map(|key| key.path.text())
    }

    /// Where it is said what values each key has.
    pub(crate) fn places(&self) -> impl Iterator<Item = Place> {
        self.keys.iter().map(|key| self.base.sources.place(key.values))
    }

    /// The scenario with these values, one for each key; a null leaves the key as it stands.
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

    /// The scenario with these changes.
    pub(crate) fn with(&self, changes: impl Iterator<Item = Change>) -> Result<Scenario, ScenarioErrors> {
        let changes: Vec<Change> = self.fixed.iter().cloned().chain(changes).collect();
        self.base.scenario(&changes)
    }
}

impl VariedKey {
    /// Its values have no place of their own.
    pub(crate) fn at(path: &str, origin: Origin) -> Self {
        Self { path: KeyPath::new(path), origin, values: origin }
    }
}

impl Node {
    /// The value, all of it at one place; a null is an empty text.
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
