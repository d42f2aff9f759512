//! Scenarios: from a text to a described scenario, and on to a resolved one.

use std::path::Path;
use std::sync::Arc;

use papilio_colour::ColourError;
use papilio_diagnostics::Diagnostic;
use papilio_display::image::SourceImage;
use papilio_display::scene::Scene;
use papilio_display::spatial::{Antiglare, Patterns};
use papilio_display::{DisplayError, note_of_places};
use papilio_formats::{DataFile, FormatError, LARGEST_PICTURE_FILE, Problem, picture_format};
use serde_json::{Map, Value, json};

use crate::browse::illuminant_sheet;
use crate::describe::File;
use crate::describe::image::DecidedFor;
use crate::error::{EXAMPLE_SCENARIO, Errors, ScenarioError, ScenarioErrors};
use crate::library::{Library, sha256};
use crate::mistake::{self, Mistake};
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
        if lights.iter().all(|light| light.value == THIS) && !lights.is_empty() {
            return Ok(image);
        }
        let mut errors = Errors::default();
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
            image.settings.prepared_for.push(match changed {
                None => scene.clone(),
                Some((path, value)) => {
                    let value = Node::from_json(&value, origin);
                    let change = Change { path: KeyPath::new(path), origin, value };
                    let sources = &self.written.sources;
                    let there =
                        Self::read(assemble(sources, &[change])?, self.library.clone(), sources.clone())?;
                    Scene { lighting: there.resolve()?.scene.lighting, ..scene.clone() }
                }
            });
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

    /// The notes, with that on results that depend on places.
    pub fn notes_of_places(&self) -> Vec<String> {
        self.notes.iter().cloned().chain(note_of_places(&self.scene)).collect()
    }

    /// Converts an error of the scene to one of the scenario, with its place in the text; `None` if no key
    /// causes it.
    pub fn located(&self, error: &DisplayError) -> Option<ScenarioErrors> {
        let source;
        let (key, wrong): (&str, Mistake) = match error {
            DisplayError::NoMatrix { command } => {
                let expected = "the places of the sub-pixels, [display.matrix]";
                let mut wrong = mistake::missing_path("display.matrix", "matrix", expected);
                let hint = format!(
                    "`papilio {command}` needs them: add [display.matrix] with ppi or the pitch_um of the pixels, or try --set \
                     display.matrix.ppi=300"
                );
                wrong.diagnostic = wrong.diagnostic.hint(hint);
                let mut errors = Errors::default();
                errors.push(self.written.root.place_of("display"), wrong);
                // The command needs the lengths, too.
                if let Err(DisplayError::MissingLength { key, others }) = self.scene.display.lengths_mm() {
                    self.push_missing_lengths(std::iter::once(&key).chain(&others), &mut errors);
                }
                return errors.check(&self.written.sources).err();
            }
            DisplayError::ApertureInDirectedLight => {
                let wrong = Diagnostic::new("a numerical aperture needs diffuse light alone")
                    .expected("no lamps and no environment in `[lighting]`: the light that an objective sends and receives")
                    .hint("set lighting.diffuse = 1 without lamps; or field_deg instead, which is uniform in solid angle");
                ("viewer.numerical_aperture", wrong.into())
            }
            DisplayError::Polarised { key, needs } => {
                let what = match key.as_str() {
                    "viewer.polariser" => "a polariser",
                    key if key.ends_with(".depolarisation") => "a scatterer that keeps polarisation",
                    _ => "polarised light",
                };
                let wrong = Diagnostic::new(format!("{what} is not possible here"))
                    .expected(*needs)
                    .hint(format!("remove {key}"));
                (key, wrong.into())
            }
            DisplayError::Particles { needs } => {
                let layers = (0..self.scene.display.layers.len())
                    .map(|number| format!("display.layers.{number}.particles"));
                let mut keys = std::iter::once("display.diffuser.particles".to_owned()).chain(layers);
                source = keys.find(|key| self.written.root.at(key).is_some()).unwrap_or_default();
                let wrong = Diagnostic::new("the polarised light of particles is not possible here")
                    .expected(*needs)
                    .hint("use `anisotropy` instead of `particles`: what it scatters counts as unpolarised");
                (&source, wrong.into())
            }
            DisplayError::SparkleOfPoint { number } => {
                source = format!("lighting.directed.{number}");
                let mut wrong = mistake::missing_key("radius_deg", "the angular radius of the lamp, degrees");
                let note = "the sparkle of a lamp depends on its size, which is not guessed";
                let hint = "radius_deg = 0.27 is that of the sun, 2 that of a lamp of 10 cm at 1.4 m";
                wrong.diagnostic = wrong.diagnostic.note(note).hint(hint);
                (&source, wrong)
            }
            DisplayError::Fringes { key, thickness_nm, fringes, nm, most_mm } => {
                let wrong = Diagnostic::new(format!(
                    "this layer of {thickness_nm} nm makes {fringes} interference fringes over angle at {nm} nm, more \
                     than are tabulated"
                ))
                .expected(format!("films with a total thickness of at most about {most_mm} mm"))
                .hint(
                    "so thick a layer does not interfere in room light: describe it as a layer of the display, \
                     { kind = \"medium\", index = 1.5 }, with the thin films below it as the pixel's film or a coating",
                );
                (key, wrong.into())
            }
            DisplayError::Surface { key, error } => {
                (key, Diagnostic::new(format!("the surface cannot be measured: {error}")).into())
            }
            DisplayError::MissingLength { key, others } => {
                let mut errors = Errors::default();
                self.push_missing_lengths(std::iter::once(key).chain(others), &mut errors);
                return errors.check(&self.written.sources).err();
            }
            DisplayError::PlacesNotComputed { what, key } => {
                let wrong = Diagnostic::new(format!("the places of light are not computed yet for {what}"));
                let wrong = if key.ends_with("approximation") {
                    wrong
                        .expected("approximation = \"none\"")
                        .hint("remove it: the filter is solved through all orders")
                } else if key.ends_with("spread_um") {
                    wrong.expected("0 um").hint(
                        "remove `spread_um`: `papilio mtf` and `papilio crosstalk` compute it below flat faces, and by Monte Carlo below any \
                         layers (`papilio crosstalk` without colour filter); `papilio image` below a flat face",
                    )
                } else if key.ends_with("samples_per_pixel") {
                    wrong
                        .expected("1")
                        .hint("remove `samples_per_pixel`: each pixel has its mean colour then")
                } else {
                    wrong
                        .expected("mirror-like or Lambertian pixels below a diffuser or a flat face")
                        .hint("`papilio mtf` and `papilio crosstalk` compute any layers with `--solver monte-carlo`")
                };
                (key, wrong.into())
            }
            DisplayError::TooThick { thickness_mm, pitch_mm, most } => {
                let wrong = Diagnostic::new(format!(
                    "the layers above the pixels are {:.0} times as thick as a pixel is wide ({thickness_mm} mm and {:.1} um)",
                    thickness_mm / pitch_mm,
                    1e3 * pitch_mm
                ))
                .expected(format!("at most {most} times, over which crosstalk and pictures are computed"))
                .hint("`pitch_um` is in um, `thickness_mm` in mm; `papilio crosstalk --solver monte-carlo` computes any thickness");
                ("display.matrix", wrong.into())
            }
            DisplayError::PlacesByPaths { what, key } => {
                let wrong =
                    Diagnostic::new(format!("the adding solver does not compute the places of light for {what}"))
                        .hint(
                            "set `method = \"monte-carlo\"` in `[solver]`, or use `--solver monte-carlo`, which computes any layers",
                        );
                (key, wrong.into())
            }
            DisplayError::NoPlaces { what, key } => {
                let wrong =
                    Diagnostic::new(format!("the Monte Carlo solver with places does not compute {what}"))
                        .hint("remove it, or use the solver \"adding\"");
                (*key, wrong.into())
            }
            DisplayError::NoRefraction => {
                let wrong = Diagnostic::new("light that is not refracted has no places in the layers")
                    .expected("refraction: approximation = \"none\", and angle_medium = \"air\" or \"glass\"")
                    .hint("remove \"unrefracted\" from [solver]; `papilio run` without a colour filter computes it");
                let is_here =
                    |key: &&str| self.written.root.at(key).is_some_and(|node| node.is_text("unrefracted"));
                let keys = ["solver.approximation", "solver.angle_medium"];
                (keys.into_iter().find(is_here).unwrap_or("solver"), wrong.into())
            }
            DisplayError::OneView { what, views } => {
                let wrong =
                    Diagnostic::new(format!("{what} is computed for one view, and these are {views}"))
                        .expected("one angle in `theta_deg`, and one in `phi_deg`")
                        .hint("choose one: --set viewer.theta_deg=0 --set viewer.phi_deg=0");
                ("viewer.theta_deg", wrong.into())
            }
            DisplayError::NoNeutral { state } => {
                let wrong = Diagnostic::new(format!(
                    "neutral colours cannot be shown by black and white only: the darkest or lightest state, `{state}`, is coloured"
                ))
                .expected("a black and a white with a CIELAB chroma below 8 in this light")
                .hint("name such states in image.states, or set image.neutrals = \"all\"");
                ("image.neutrals", wrong.into())
            }
            DisplayError::Colour(ColourError::States { states }) => {
                let wrong = match states {
                    0 | 1 => Diagnostic::new("a picture cannot be shown by a single state")
                        .hint("add another state to the pixel, for example `black`"),
                    _ => Diagnostic::new(format!(
                        "a picture cannot be shown by these {states} states: they are too many, or some have no finite colour"
                    ))
                    .hint("name those for pictures in image.states"),
                };
                ("display.pixel", wrong.expected("2 to 64 states with finite X, Y and Z").into())
            }
            DisplayError::Colour(ColourError::WhiteAndBlack { white, black }) => {
                let wrong = Diagnostic::new(format!(
                    "no picture is seen in this light and view: white (Y = {white:.4}) and black (Y = {black:.4}) have no contrast"
                ))
                .expected("a white that is brighter than black in X, Y and Z, both of them mixtures of the states")
                .hint("`papilio palette` shows the colours of all states in this light and view");
                ("display.pixel", wrong.into())
            }
            DisplayError::Colour(ColourError::Dependent) => {
                let wrong =
                    Diagnostic::new("red, green, blue and black of this pixel are mixtures of each other")
                        .expected("sub-pixels of three colours: the coverage of each is not unique otherwise")
                        .hint("`papilio palette` shows the colours of all states in this light and view");
                ("display.pixel", wrong.into())
            }
            DisplayError::TooClose { distance_mm, theta_deg } => {
                let wrong = Diagnostic::new(format!(
                    "from {distance_mm} mm the reader sees a part of the picture at {theta_deg:.4} deg, along the panel"
                ))
                .expected("a larger distance")
                .hint("or set image.perspective = false, which shows all of it in one direction");
                ("viewer.distance_mm", wrong.into())
            }
            DisplayError::TooManySamples { per_pixel, samples, most } => {
                let wrong = Diagnostic::new(format!(
                    "{per_pixel} x {per_pixel} samples of each pixel are {samples} in all"
                ))
                .expected(format!("at most {most} samples of a picture"))
                .hint("use fewer samples for each pixel, or fewer pixels in display.matrix.pixels");
                ("image.samples_per_pixel", wrong.into())
            }
            DisplayError::TooManyCells { per_pixel, cells, most } => {
                let wrong = Diagnostic::new(format!(
                    "{per_pixel} x {per_pixel} samples divide the pixels of all states into {cells} different cells"
                ))
                .expected(format!("at most {most} cells"))
                .hint("use fewer samples for each pixel, or fewer states in image.states");
                ("image.samples_per_pixel", wrong.into())
            }
            DisplayError::ScanOfScattering => {
                let wrong = Diagnostic::new("a pixel given by its BRDF scatters light into all directions: it has no table of reflectance by angle")
                    .expected("a pixel whose reflectance is a function of angle and wavelength")
                    .hint("`papilio diffuser inspect` shows its file, and `papilio brdf` computes the BRDF of the whole display");
                ("display.pixel.model", wrong.into())
            }
            DisplayError::AbsorptionWithoutFilm => {
                let wrong = Diagnostic::new(
                    "this pixel has no film whose layers absorb: its reflectance is given, not computed",
                )
                .expected("model = \"film\"")
                .hint("leave out the absorptance of its layers");
                ("display.pixel.model", wrong.into())
            }
            DisplayError::Azimuth { what, key, hint } => {
                let wrong = format!(
                    "the reflectance of this pixel depends on azimuth, which {what} does not compute yet"
                );
                (*key, Diagnostic::new(wrong).hint(*hint).into())
            }
            DisplayError::FilterWithoutPlace => {
                let wrong = Diagnostic::new(
                    "the colours of a display with a colour filter above its pixels depend on where light enters and \
                     leaves, which this command does not compute yet",
                );
                let hint = "remove the filter, or describe it as a layer without pattern, with `internal_transmittance`";
                ("display.matrix.filter", wrong.hint(hint).into())
            }
            DisplayError::TooThin { length_mm, least_mm } => {
                source = self.key_of_length(*length_mm);
                let wrong = Diagnostic::new(format!(
                    "a length of {length_mm:e} mm above the pixels is too small for the places of light"
                ));
                (&source, wrong.expected(format!("0 or at least {least_mm:e} mm")).into())
            }
            DisplayError::CrystalFringes => {
                let wrong = Diagnostic::new(
                    "the layers of this pixel have more interference fringes over inclination or azimuth than can be tabulated",
                )
                .expected("birefringent coherent layers of at most about 0.02 mm, others of at most about 0.05 mm")
                .hint(
                    "describe a thick pane as kind = \"slab\"; by adding, diffuse light and lamps are computed without a table, in views with \
                     a field of at most 4 deg",
                );
                ("display.pixel", wrong.into())
            }
            DisplayError::NoWhite { what } => {
                let wrong = Diagnostic::new(format!("the light has no white: {what} is not defined"))
                    .expected("light with X, Y and Z above 0");
                ("lighting", wrong.into())
            }
            DisplayError::TooNarrow { what, number, nodes, most } => {
                let wrong = Diagnostic::new(format!(
                    "{what} (scatterer {number} from the top) is too narrow for adding within these layers: it needs {nodes} directions"
                ))
                .expected(format!("at most {most} directions: the work of adding grows faster than their cube"))
                .hint(MONTE_CARLO);
                let keys = ["display.diffuser", "display.layers"];
                let written = keys.into_iter().find(|key| self.written.root.at(key).is_some());
                (written.unwrap_or("display"), wrong.into())
            }
            DisplayError::TooNarrowInField { width, least, light } => {
                let wrong = Diagnostic::new(format!(
                    "the diffuser of width {width:.1e} is too narrow for adding in light that {light}: it would take hours"
                ))
                .expected(format!("a width of at least {least} (`width` or `haze`)"))
                .hint(MONTE_CARLO);
                let keys = ["display.diffuser.width", "display.diffuser.haze"];
                let written = keys.into_iter().find(|key| self.written.root.at(key).is_some());
                (written.unwrap_or("display.diffuser"), wrong.into())
            }
            DisplayError::BelowHorizon { what, theta_deg, index } => {
                let wrong = Diagnostic::new(format!(
                    "a {what} at {theta_deg} deg in a medium of index {index} is below the display's horizon in air"
                ))
                .expected("all of its cone above the horizon");
                let key = match *what {
                    "view" => "viewer.theta_deg",
                    "light" => "lighting",
                    // A meter, which is not in the scenario.
                    _ => return None,
                };
                (key, wrong.into())
            }
            // Their messages say all.
            error => (located_key(error)?, Diagnostic::new(error.to_string()).into()),
        };
        let mut errors = Errors::default();
        errors.push(self.written.root.place_of(key), wrong);
        errors.check(&self.written.sources).err()
    }

    /// The path of a thickness above the pixels that has this value; `display` if none is written so.
    fn key_of_length(&self, mm: f64) -> String {
        let display = self.canonical.get("display").unwrap_or(&Value::Null);
        thickness_path(display, mm).map_or_else(|| "display".to_owned(), |path| format!("display{path}"))
    }
}

/// The hint where adding refuses a narrow scatterer.
const MONTE_CARLO: &str =
    "use the Monte Carlo solver: method = \"monte-carlo\" in [solver], or --solver monte-carlo";

/// The path of a `thickness_mm` with this value, from `.` on.
fn thickness_path(value: &Value, mm: f64) -> Option<String> {
    let inside = |(key, value): (&str, &Value)| {
        if key == "thickness_mm" && value.as_f64() == Some(mm) {
            return Some(format!(".{key}"));
        }
        thickness_path(value, mm).map(|path| format!(".{key}{path}"))
    };
    match value {
        Value::Object(keys) => keys.iter().map(|(key, value)| (key.as_str(), value)).find_map(inside),
        Value::Array(items) => {
            items.iter().enumerate().find_map(|(number, item)| inside((&number.to_string(), item)))
        }
        _ => None,
    }
}

/// The key that causes an error without a message of its own in a scenario; `None`: no key does. Not `_`: each new error is decided on.
fn located_key(error: &DisplayError) -> Option<&'static str> {
    use DisplayError as E;
    Some(match error {
        E::DispersiveGlassAngles => "solver.angle_medium",
        E::ApproximatesNoPanel => "solver.approximation",
        E::NoPaths => "solver.paths",
        E::NotByAdding => "solver.method",
        E::NotAFilm => "display.pixel.model",
        E::NoDarkGap { .. } => "display.pixel.gap_nm",
        E::SparkleAboveScatterer { .. } => "display.layers",
        E::Sparkle(_) => "sparkle",
        E::Film(_) | E::Places(_) => "display",
        E::Colour(_) => "lighting",
        E::Imaging(_) => "image",
        E::NoPixelPitch | E::NoHalftone => "image.halftone",
        // Of a command's own options and tables, of a caller of the library, or of the machine.
        E::UnknownReference { .. }
        | E::RowsTooUncertain { .. }
        | E::Threads { .. }
        | E::Interrupted
        | E::OtherStates
        | E::NoSuchQuantity { .. }
        | E::NoSuchParameter { .. }
        | E::PictureSize { .. }
        | E::GivenStates { .. }
        | E::Regions { .. }
        // Any value may be too small or too large.
        | E::NotFinite => return None,
        // Those that `located` describes.
        E::ApertureInDirectedLight
        | E::Polarised { .. }
        | E::Particles { .. }
        | E::TooClose { .. }
        | E::Fringes { .. }
        | E::Surface { .. }
        | E::FilterWithoutPlace
        | E::Azimuth { .. }
        | E::CrystalFringes
        | E::NoPlaces { .. }
        | E::NoRefraction
        | E::TooManySamples { .. }
        | E::TooManyCells { .. }
        | E::PlacesNotComputed { .. }
        | E::TooThin { .. }
        | E::TooThick { .. }
        | E::PlacesByPaths { .. }
        | E::MissingLength { .. }
        | E::NoMatrix { .. }
        | E::SparkleOfPoint { .. }
        | E::ScanOfScattering
        | E::AbsorptionWithoutFilm
        | E::TooNarrow { .. }
        | E::TooNarrowInField { .. }
        | E::OneView { .. }
        | E::NoWhite { .. }
        | E::NoNeutral { .. }
        | E::BelowHorizon { .. } => return None,
    })
}

impl Resolved {
    fn push_missing_lengths<'k>(&self, keys: impl Iterator<Item = &'k String>, errors: &mut Errors) {
        for key in keys {
            // The table of the key may be missing, too.
            let known = self.written.root.depth_of(key);
            let missing = key.splitn(known + 1, '.').last().unwrap_or(key);
            errors.push(self.written.root.place_of(key), mistake::missing_length(key, missing));
        }
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
             --set 'lighting={{ preset = \"{name}\" }}' replaces all of them"
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
