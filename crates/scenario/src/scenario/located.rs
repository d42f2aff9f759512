//! Errors of a scene as errors of its scenario: with the place in the text, what was expected and a hint.

use papilio_colour::ColourError;
use papilio_diagnostics::{Diagnostic, Interface, Remedy};
use papilio_display::DisplayError;
use serde_json::Value;

use super::Resolved;
use crate::error::{Errors, ScenarioErrors};
use crate::mistake::{self, Mistake};

impl Resolved {
    /// Converts an error of the scene to one of the scenario, with its place in the text; `None` if no key
    /// causes it.
    pub fn located(&self, error: &DisplayError) -> Option<ScenarioErrors> {
        let source;
        let (key, wrong): (&str, Mistake) = match error {
            DisplayError::NoMatrix { command } => {
                let expected = "the places of the sub-pixels, [display.matrix]";
                let mut wrong = mistake::missing_path("display.matrix", "matrix", expected);
                let hint = format!(
                    "`papilio {command}` needs them: add [display.matrix] with ppi or the pitch_um of the pixels, or try 300 ppi"
                );
                wrong.diagnostic =
                    wrong.diagnostic.hint(hint).remedy(Remedy::key("display.matrix.ppi", "300"));
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
            DisplayError::Fringes { key, thickness_nm, fringes, nm, most_panels } => {
                let wrong = Diagnostic::new(format!(
                    "this layer of {thickness_nm} nm makes {fringes} interference fringes over angle at {nm} nm, and the \
                     table of the film over direction would need more than {most_panels} panels"
                ))
                .expected("fewer or wider fringes: a thinner layer, or mirrors around it that reflect less")
                .hint(
                    "a layer of more than about 0.01 mm does not interfere in room light: describe it as a layer of the display, \
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
                        .hint("`papilio mtf` and `papilio crosstalk` compute any layers by the Monte Carlo solver")
                        .remedy(monte_carlo())
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
                .hint("`pitch_um` is in um, `thickness_mm` in mm; `papilio crosstalk` computes any thickness by the Monte Carlo solver")
                .remedy(monte_carlo());
                ("display.matrix", wrong.into())
            }
            DisplayError::PlacesByPaths { what, key } => {
                let wrong = Diagnostic::new(format!(
                    "the adding solver does not compute the places of light for {what}"
                ))
                .hint("use the Monte Carlo solver, which computes any layers")
                .remedy(monte_carlo());
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
                        .hint("choose one")
                        .remedy(Remedy::key("viewer.theta_deg", "0"))
                        .remedy(Remedy::key("viewer.phi_deg", "0"));
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
                let wrong = Diagnostic::new(wrong).hint(*hint);
                let wrong = if *key == "solver.method" { wrong.remedy(monte_carlo()) } else { wrong };
                (*key, wrong.into())
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
                    "the layers of this pixel have so many interference fringes over inclination or azimuth that their table would need more \
                     than 1 GB",
                )
                .expected("birefringent coherent layers of at most about 0.02 mm, others of at most about 0.05 mm, or fewer wavelengths and states")
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
                .hint(MONTE_CARLO)
                .remedy(monte_carlo());
                let keys = ["display.diffuser", "display.layers"];
                let written = keys.into_iter().find(|key| self.written.root.at(key).is_some());
                (written.unwrap_or("display"), wrong.into())
            }
            DisplayError::TooNarrowInField { width, least, light } => {
                let wrong = Diagnostic::new(format!(
                    "the diffuser of width {width:.1e} is too narrow for adding in light that {light}: it would take hours"
                ))
                .expected(format!("a width of at least {least} (`width` or `haze`)"))
                .hint(MONTE_CARLO)
                .remedy(monte_carlo());
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

    fn push_missing_lengths<'k>(&self, keys: impl Iterator<Item = &'k String>, errors: &mut Errors) {
        for key in keys {
            // The table of the key may be missing, too.
            let known = self.written.root.depth_of(key);
            let missing = key.splitn(known + 1, '.').last().unwrap_or(key);
            errors.push(self.written.root.place_of(key), mistake::missing_length(key, missing));
        }
    }
}

/// The hint where adding refuses a narrow scatterer, and its remedy.
const MONTE_CARLO: &str = "use the Monte Carlo solver";

fn monte_carlo() -> Remedy {
    Remedy::key("solver.method", "\"monte-carlo\"")
}

/// The remedy of an error that no key causes, but an option of the call.
fn option_of(error: &DisplayError) -> Option<Remedy> {
    match error {
        DisplayError::RowsTooUncertain { enough, .. } => {
            Some(Remedy::Option { name: "allow-error", value: enough.to_string() })
        }
        _ => None,
    }
}

/// The text of an error of a computation that is not [`located`](Resolved::located), in the words of an interface.
pub fn text_of(error: &DisplayError, interface: Interface) -> String {
    match option_of(error).and_then(|option| Remedy::words(&[option], interface)) {
        Some(words) => format!("{error}\n  = help: to allow it: {words}"),
        None => error.to_string(),
    }
}

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
