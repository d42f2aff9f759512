//! Scenarios: from a text to a described scenario, and on to a resolved one.

mod located;

use std::path::Path;
use std::sync::Arc;

use papilio_diagnostics::Diagnostic;
use papilio_display::image::SourceImage;
use papilio_display::note_of_places;
use papilio_display::palette::warn_of_room;
use papilio_display::scene::Scene;
use papilio_display::spatial::{Antiglare, Patterns};
use papilio_formats::{DataFile, FormatError, LARGEST_PICTURE_FILE, Problem, picture_format};
use serde_json::{Map, Value, json};

pub use self::located::text_of;
use crate::browse::illuminant_sheet;
use crate::describe::File;
use crate::describe::image::DecidedFor;
use crate::error::{EXAMPLE_SCENARIO, Errors, ScenarioError, ScenarioErrors};
use crate::library::{Library, sha256};
use crate::mistake;
use crate::origin::Origin;
use crate::path::KeyPath;
use crate::preset::UsedPreset;
use crate::read::{Read, Spanned};
use crate::resolve::{self, Found, ImageRequest, LayerSurface, PictureChoice, VirtualMeasurement};
use crate::set::Change;
use crate::source::Sources;
use crate::tree::Node;
use crate::varied::STUDY_TABLES;
use crate::{preset, renamed, set};

/// Longest text of a scenario, bytes. Scenarios are written by hand; a longer text is a mistake.
const LONGEST_TEXT: usize = 1 << 20;

/// A described scenario: all keys are known, of the right type and in range. Its files are not read yet.
#[derive(Debug, Clone)]
pub struct Scenario {
    file: File,
    library: Library,
    written: Arc<ScenarioTree>,
    /// Warnings from the reading.
    warnings: Vec<String>,
    /// Notes from the reading.
    pub(crate) notes: Vec<String>,
}

/// The tree of the scenario, and its texts.
#[derive(Debug)]
struct ScenarioTree {
    root: Node,
    sources: Sources,
}

/// A scenario that can be computed.
#[derive(Debug, Clone)]
pub struct Resolved {
    /// The scene: all numbers of the computation.
    pub scene: Scene,
    /// Patterns and text of `[pattern]`, for `papilio mtf`.
    pub patterns: Patterns,
    /// The antiglare face of [`papilio_display::spatial::sparkle`], if it is described.
    pub sparkle: Option<Antiglare>,
    /// The picture of `[image]`, after [`Scenario::resolve_with_picture`].
    pub image: Option<ImageRequest>,
    /// Surfaces that are layers of the display.
    pub surfaces: Vec<LayerSurface>,
    /// Title of the scenario.
    pub title: Option<String>,
    /// Warnings: what may be wrong with the scenario.
    pub warnings: Vec<String>,
    /// Notes: consequences of the scenario that are worth knowing, and not wrong.
    pub notes: Vec<String>,
    /// The scenario with every default filled in and sorted keys, and under
    /// `inputs` the SHA-256 of each file that it names.
    pub canonical: Value,
    /// SHA-256 of `canonical` as compact JSON, in hexadecimal digits.
    pub hash: String,
    library: Library,
    written: Arc<ScenarioTree>,
}

impl Scenario {
    /// Reads a scenario file. `overrides` are texts `PATH=VALUE`, as in `--set`; paths of files in them are
    /// relative to the current folder, or else to the folder of the scenario.
    ///
    /// # Errors
    /// All mistakes in its bytes, its TOML, its keys and their types and ranges, each with its place.
    pub fn load(path: &Path, overrides: &[String]) -> Result<Self, ScenarioErrors> {
        let name = path.display().to_string();
        let unread = |error| ScenarioError::unread(path, error, EXAMPLE_SCENARIO);
        let file = DataFile::open(path, &name).map_err(unread)?;
        let text = file.text().map_err(ScenarioError::from)?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let sources = parse(text, &name, overrides)?.in_folder(folder);
        let assembled = assemble(&sources, &[])?;
        Self::read(assembled, folder.into(), sources)
    }

    /// Reads a scenario from a text. Errors call it `name`. Its files are in `library`; a path is the folder
    /// of the files.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn from_text(
        text: &str,
        name: &str,
        library: impl Into<Library>,
        overrides: &[String],
    ) -> Result<Self, ScenarioErrors> {
        let sources = parse(text, name, overrides)?;
        let assembled = assemble(&sources, &[])?;
        Self::read(assembled, library.into(), sources)
    }

    /// Reads a scenario from its complete tree.
    pub(crate) fn read(
        assembled: CompleteTree,
        library: Library,
        sources: Sources,
    ) -> Result<Self, ScenarioErrors> {
        let mut errors = Errors::default();
        let has = |key: &str| assembled.root.get(key).is_some();
        if has("microgeometry") && !has("display") {
            let wrong = Diagnostic::new("this is a surface, not the scenario of a display")
                .expected("a file with the table [display]")
                .hint("`papilio gonio` measures surfaces; scenarios/ has examples of displays");
            errors.push(Origin::FILE, wrong);
            errors.check(&sources)?;
        }
        let file = File::read(&assembled.root, &mut errors);
        let mut file = errors.finish(file, &sources)?;
        file.complete();
        let CompleteTree { root, warnings, notes } = assembled;
        Ok(Self { file, library, written: Arc::new(ScenarioTree { root, sources }), warnings, notes })
    }

    /// Returns the scenario with every default filled in, in the order of the grammar and the text.
    pub fn filled(&self) -> impl serde::Serialize + '_ {
        &self.file
    }

    /// Returns one table of [`filled`](Self::filled) by its key; null if there is none.
    pub fn filled_at(&self, key: &str) -> Value {
        let mut all = serde_json::to_value(&self.file).unwrap_or_default();
        all.get_mut(key).map(Value::take).unwrap_or_default()
    }

    /// Returns the preset of lighting and viewer that the scenario names, or else one whose light and viewer
    /// it has.
    pub fn preset(&self) -> Option<UsedPreset> {
        preset::used(&self.written.root, &serde_json::to_value(&self.file).unwrap_or_default())
    }

    /// Resolves the display's diffuser and `[measure]`, for [`papilio diffuser measure`](VirtualMeasurement).
    ///
    /// # Errors
    /// As [`resolve`](Self::resolve), and if the display has no diffuser given by its BTDF.
    pub fn measurement(&self) -> Result<VirtualMeasurement, ScenarioErrors> {
        let mut found = resolve::measurement(&self.file, &self.library, &self.written.sources)?;
        found.notes = [self.notes.clone(), found.notes].concat();
        Ok(found)
    }

    /// True if the scenario has a `[tolerance]`.
    pub fn has_tolerance(&self) -> bool {
        self.file.tolerance.is_some()
    }

    /// Evaluates materials, lights and files on the wavelength grid, and checks the whole scenario.
    ///
    /// # Errors
    /// All keys that do not fit together, each with its place, and mistakes in data files, with line and
    /// column of the file.
    pub fn resolve(&self) -> Result<Resolved, ScenarioErrors> {
        self.resolved(PictureChoice::No, true)
    }

    /// As [`resolve`](Self::resolve) for what does not depend on the light: where spectra of lights do not
    /// cover the wavelengths, they are replaced by one of equal energy, with a note.
    ///
    /// # Errors
    /// As [`resolve`](Self::resolve), except for lights that do not cover the wavelengths.
    pub fn resolve_without_light(&self) -> Result<Resolved, ScenarioErrors> {
        self.resolved(PictureChoice::No, false)
    }

    /// As [`resolve`](Self::resolve), and reads the picture of `[image]`, for `papilio image`.
    ///
    /// # Errors
    /// As [`resolve`](Self::resolve), and if there is no picture, or it cannot be read.
    pub fn resolve_with_picture(&self) -> Result<Resolved, ScenarioErrors> {
        self.resolved(PictureChoice::Described, true)
    }

    /// As [`resolve_with_picture`](Self::resolve_with_picture), with a picture in memory of any size instead
    /// of `image.file`.
    ///
    /// # Errors
    /// As [`resolve`](Self::resolve), and if `[image]` has a test pattern.
    pub fn resolve_with(&self, picture: &SourceImage) -> Result<Resolved, ScenarioErrors> {
        self.resolved(PictureChoice::Given(picture), true)
    }

    fn resolved(&self, pictured: PictureChoice<'_>, needs_light: bool) -> Result<Resolved, ScenarioErrors> {
        let Found { scene, patterns, sparkle, image, surfaces, warnings, notes, inputs } =
            resolve::resolve(&self.file, &self.library, &self.written.sources, (pictured, needs_light))?;
        let image = image.map(|image| self.prepared(image, &scene)).transpose()?;
        let mut canonical = serde_json::to_value(&self.file).unwrap_or_default();
        if let Value::Object(keys) = &mut canonical {
            STUDY_TABLES.iter().for_each(|table| drop(keys.remove(*table)));
            keys.insert("inputs".to_owned(), json!(inputs));
        }
        let canonical = sorted(canonical);
        let hash = hash_of(&canonical);
        Ok(Resolved {
            scene,
            patterns,
            sparkle,
            image,
            surfaces,
            title: self
                .file
                .title
                .as_ref()
                .map(|title| title.0.clone())
                .filter(|title| !title.trim().is_empty()),
            warnings: [self.warnings.clone(), warnings].concat(),
            notes: [self.notes.clone(), notes].concat(),
            canonical,
            hash,
            library: self.library.clone(),
            written: Arc::clone(&self.written),
        })
    }
}

impl Scenario {
    /// Adds the lights for which the states of a picture are decided, if they are not this one; the view is the
    /// same.
    fn prepared(&self, mut image: ImageRequest, scene: &Scene) -> Result<ImageRequest, ScenarioErrors> {
        let Some(Spanned { value: stated, origin }) =
            self.file.image.value.as_ref().map(|image| &image.prepared_for)
        else {
            return Ok(image);
        };
        let one;
        let lights: &[Spanned<String>] = match stated {
            DecidedFor::One(name) => {
                one = [Spanned { value: name.clone(), origin: *origin }];
                &one
            }
            DecidedFor::List(lights) => lights,
        };
        if let [light] = lights
            && light.value == THIS
        {
            return Ok(image);
        }
        let (mut errors, mut names) = (Errors::default(), Vec::new());
        if lights.is_empty() {
            errors.push(*origin, Diagnostic::new("the list is empty").expected(LIGHTS));
        }
        for (number, &Spanned { value: ref name, origin }) in lights.iter().enumerate() {
            if lights[..number].iter().any(|other| other.value == *name) {
                errors.push(origin, mistake::listed_twice(&format!("`{name}`")));
                continue;
            }
            let changed = match (&**name, preset::text(name), illuminant_sheet(name)) {
                (THIS, ..) => None,
                (_, Some(_), _) => Some(("lighting", json!({ "preset": name }))),
                (_, None, Ok(_)) => Some(("lighting.spectrum", json!(name))),
                (_, None, Err(_)) => {
                    let presets = preset::preset_names().collect::<Vec<_>>().join(", ");
                    let wrong =
                        Diagnostic::new(format!("there is no preset and no illuminant named `{name}`"))
                            .expected(LIGHTS)
                            .hint(format!("the presets are {presets}"));
                    errors.push(origin, wrong);
                    continue;
                }
            };
            let there = match changed {
                None => scene.clone(),
                Some((path, value)) => {
                    let value = Node::from_json(&value, origin);
                    let change = Change { path: KeyPath::new(path), origin, value };
                    let sources = &self.written.sources;
                    let there =
                        Self::read(assemble(sources, &[change])?, self.library.clone(), sources.clone())?;
                    Scene { lighting: there.resolve()?.scene.lighting, ..scene.clone() }
                }
            };
            let known = names.iter().zip(&image.settings.prepared_for);
            if let Some((other, _)) = known.into_iter().find(|(_, other)| other.lighting == there.lighting) {
                let same = Diagnostic::new(format!("`{name}` is the same light as `{other}`"));
                errors.push(origin, same.expected("different lights").hint("remove one of them"));
            }
            names.push(name);
            image.settings.prepared_for.push(there);
        }
        errors.finish(Some(image), &self.written.sources)
    }
}

/// SHA-256 of a scenario with every default filled in and sorted keys.
fn hash_of(canonical: &Value) -> String {
    sha256(canonical.to_string().as_bytes())
}

impl Resolved {
    /// The hash of the same scenario in commands that read the files of `[image]`, if this one was resolved without them, or in
    /// all others; `None` if there are no such files, or they cannot be read.
    pub fn hash_of_other_commands(&self) -> Option<String> {
        let image = self.canonical.get("image")?;
        let named = ["file", "regions"].into_iter().filter_map(|key| image.get(key)?.as_str());
        let files = named.filter(|name| self.library.has(name));
        let mut canonical = self.canonical.clone();
        let inputs = canonical.get_mut("inputs")?.as_object_mut()?;
        for name in files {
            if self.image.is_some() {
                inputs.remove(name);
            } else {
                let file = self.library.open(name, LARGEST_PICTURE_FILE).ok()?;
                inputs.insert(name.to_owned(), json!(file.sha256()));
            }
        }
        Some(hash_of(&sorted(canonical))).filter(|other| *other != self.hash)
    }
}

/// The light of the scenario itself, and what may be stated in its place.
const THIS: &str = "this";
const LIGHTS: &str = "\"this\", a preset, or an illuminant of `papilio illuminants`";

impl Resolved {
    /// Inserts the warnings of the scenario before those of its result: a result that is written has all of them.
    pub fn warn_before(&self, of_result: &mut Vec<String>) {
        of_result.splice(0..0, self.warnings.iter().cloned());
    }

    /// Adds the warnings of the scenario in the light of rooms, by their names, that it does not have in its own light.
    pub fn warn_of_rooms<'a>(
        &self,
        rooms: impl IntoIterator<Item = (&'a str, &'a Self)>,
        of_result: &mut Vec<String>,
    ) {
        for (name, room) in rooms {
            let new: Vec<_> =
                room.warnings.iter().filter(|one| !self.warnings.contains(one)).cloned().collect();
            warn_of_room(of_result, name, &new);
        }
    }

    /// The notes, with that on results that depend on places.
    pub fn notes_of_places(&self) -> Vec<String> {
        self.notes.iter().cloned().chain(note_of_places(&self.scene)).collect()
    }
}

/// Parses a text, and returns it together with the texts of `--set`.
pub(crate) fn parse(text: &str, name: &str, overrides: &[String]) -> Result<Sources, ScenarioErrors> {
    if text.len() > LONGEST_TEXT {
        let problem = Problem::TooLarge { bytes: text.len() as u64, limit: LONGEST_TEXT as u64 };
        return Err(ScenarioError::about_file(name, problem).into());
    }
    if let Some(format) = picture_format(text.as_bytes()).filter(|format| *format == "SVG") {
        return Err(ScenarioError::from(FormatError::whole(name, Problem::Picture { format })).into());
    }
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let (document, wrong) = Node::parse_document(text);
    let sources = Sources::new(name, text, document, overrides);
    let mut errors = Errors::default();
    wrong.into_iter().for_each(|(origin, wrong)| errors.push(origin, wrong));
    errors.check(&sources)?;
    Ok(sources)
}

/// A complete tree: with preset, `--set` and other changes.
pub(crate) struct CompleteTree {
    pub(crate) root: Node,
    /// Warnings, for example of a preset without effect.
    pub(crate) warnings: Vec<String>,
    /// Notes, for example of old names.
    pub(crate) notes: Vec<String>,
}

/// Builds the tree with its preset, each `--set`, and other changes.
pub(crate) fn assemble(sources: &Sources, changes: &[Change]) -> Result<CompleteTree, ScenarioErrors> {
    let mut root = sources.document().clone();
    let mut errors = Errors::default();
    let mut old = Vec::new();
    renamed::rename(&mut root, &[], &mut old, &mut errors);
    // The preset comes first, so that other keys can change its values. It is expanded again for a whole
    // table that was set and names a preset.
    set::apply(&mut root, sources, changes, true, &mut old, &mut errors);
    let at_first = preset::expand(&mut root, &mut errors);
    errors.check(sources)?;
    set::apply(&mut root, sources, changes, false, &mut old, &mut errors);
    let at_last = preset::expand(&mut root, &mut errors);
    errors.check(sources)?;
    let idle = preset::named(&root).filter(|_| !at_first && !at_last);
    let warnings = idle.map(|name| {
        format!(
            "the preset \"{name}\" has no effect: the scenario sets all of its keys itself, and they take precedence; \
             lighting = {{ preset = \"{name}\" }} replaces all of them"
        )
    });
    let warnings = warnings.into_iter().collect();
    let mut notes = renamed::notes(&old);
    notes.extend(replaced_rectangles(sources.document(), &root));
    Ok(CompleteTree { root, warnings, notes })
}

/// Note that a layout of `--set` replaces the rectangles of the file, which are described by no other key.
fn replaced_rectangles(file: &Node, set: &Node) -> Option<String> {
    let matrix = |root: &Node, key: &str| root.get("display")?.get("matrix")?.get(key).map(|_| ());
    matrix(set, "layout")?;
    let replaced = ["subpixel", "subpixel_file"];
    let key = replaced.into_iter().find(|key| matrix(file, key).is_some() && matrix(set, key).is_none())?;
    Some(format!(
        "display.matrix.layout replaces display.matrix.{key} of the file: the rectangles described there are not used"
    ))
}

/// Sorts the keys of all objects in a value.
pub(crate) fn sorted(value: Value) -> Value {
    match value {
        Value::Object(keys) => {
            let mut keys: Vec<_> = keys.into_iter().map(|(key, value)| (key, sorted(value))).collect();
            keys.sort_by(|a, b| a.0.cmp(&b.0));
            Value::Object(Map::from_iter(keys))
        }
        Value::Array(items) => Value::Array(items.into_iter().map(sorted).collect()),
        other => other,
    }
}
