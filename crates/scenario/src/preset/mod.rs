//! Presets of lighting and viewer: rooms, daylight, and the measuring geometries of standards.
//!
//! Each is a commented file in this folder, with its source. `lighting.preset` fills in its keys;
//! [`new_scenario`] writes a scenario with it.

use std::sync::LazyLock;

use serde_json::Value as Json;

use crate::error::Errors;
use crate::mistake;
use crate::set::PRESET_PATH;
use crate::tree::{Node, Value};

/// Declares the presets by the names of their files.
macro_rules! presets {
    ($($name:literal),* $(,)?) => {
        /// Names and contents of the presets.
        const PRESETS: &[(&str, &str)] = &[$(($name, include_str!(concat!($name, ".toml")))),*];
    };
}

presets!(
    "indoor",
    "sunny",
    "overcast",
    "living-room",
    "office",
    "daylight",
    "full-sun",
    "daylight-readability",
    "iec-directional",
    "iec-ring",
    "iec-hemispherical",
    "d8-included",
    "d8-excluded",
    "45-0",
    "30-0",
);

/// A display of new scenarios, to start from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ExampleDisplay {
    /// Name on the command line.
    pub name: &'static str,
    /// What it is.
    pub about: &'static str,
    /// Keys of the display as TOML, with comments.
    text: &'static str,
    /// Names and contents of the files that the scenario names; they belong into its folder.
    pub files: &'static [(&'static str, &'static str)],
    /// A usual panel of this kind, for pictures.
    panel: Option<ExamplePanel>,
}

/// Size of a panel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct ExamplePanel {
    /// Pixels along the longer and the shorter side.
    pixels: [usize; 2],
    ppi: u32,
}

impl ExampleDisplay {
    /// An interferometric panel under a diffuser, the display of [`new_scenario`].
    pub const IMOD: Self = Self {
        name: "imod",
        about: "Interferometric pixels under a diffuser",
        text: include_str!("imod.toml"),
        files: &[],
        panel: None,
    };

    /// All displays.
    pub const ALL: [Self; 10] = [
        Self::IMOD,
        Self {
            name: "epaper",
            about: "Electronic paper below a bare glass surface",
            text: include_str!("epaper.toml"),
            files: &[],
            panel: None,
        },
        Self {
            name: "table",
            about: "A pixel tabulated by another tool, under a diffuser; with an example of the table",
            text: include_str!("table.toml"),
            files: &[("example-pixel.csv", include_str!("example-pixel.csv"))],
            panel: None,
        },
        Self {
            name: "bwry",
            about: "Electronic paper with black, white, red and yellow inks (synthetic)",
            text: include_str!("bwry.toml"),
            files: &[("four-inks.csv", include_str!("four-inks.csv"))],
            panel: Some(ExamplePanel { pixels: [800, 480], ppi: 127 }),
        },
        Self {
            name: "six-ink",
            about: "Electronic paper with six inks (synthetic)",
            text: include_str!("six-ink.toml"),
            files: &[("six-inks.csv", include_str!("six-inks.csv"))],
            panel: Some(ExamplePanel { pixels: [800, 480], ppi: 127 }),
        },
        Self {
            name: "seven-ink",
            about: "Electronic paper with seven inks (synthetic)",
            text: include_str!("seven-ink.toml"),
            files: &[("seven-inks.csv", include_str!("seven-inks.csv"))],
            panel: Some(ExamplePanel { pixels: [600, 448], ppi: 132 }),
        },
        Self {
            name: "four-grey",
            about: "Electronic paper with four greys (synthetic)",
            text: include_str!("four-grey.toml"),
            files: &[("four-greys.csv", include_str!("four-greys.csv"))],
            panel: Some(ExamplePanel { pixels: [800, 480], ppi: 124 }),
        },
        Self {
            name: "printed-filter",
            about: "Electronic paper below a printed colour filter (synthetic)",
            text: include_str!("printed-filter.toml"),
            files: &[
                ("filter-red.csv", include_str!("filter-red.csv")),
                ("filter-green.csv", include_str!("filter-green.csv")),
                ("filter-blue.csv", include_str!("filter-blue.csv")),
            ],
            panel: None,
        },
        Self {
            name: "mip-lcd",
            about: "A reflective liquid-crystal cell below a circular polariser, driven by a voltage",
            text: include_str!("mip-lcd.toml"),
            files: &[],
            panel: None,
        },
        Self {
            name: "cholesteric",
            about: "Electronic paper of three cholesteric layers over black paint",
            text: include_str!("cholesteric.toml"),
            files: &[],
            panel: None,
        },
    ];

    /// The displays with a panel for pictures: [`picture_scenario`] shows one on them.
    pub fn with_panels() -> Vec<Self> {
        Self::ALL.into_iter().filter(|display| display.panel.is_some()).collect()
    }

    /// Returns the display of this name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|display| display.name == name)
    }
}

/// Returns the names of the presets.
pub fn preset_names() -> impl Iterator<Item = &'static str> {
    PRESETS.iter().map(|(name, _)| *name)
}

/// Returns a complete, commented scenario of an interferometric display with the light and viewer of a
/// preset; `None` if there is no such preset.
pub fn new_scenario(name: &str) -> Option<String> {
    let light = text(name)?;
    let (about, keys) = light.split_once("\n\n")?;
    Some(format!("{about}\n\ntitle = \"{name}\"\n\n{keys}\n{}", ExampleDisplay::IMOD.text))
}

/// Returns a complete, commented scenario of a display with the light and viewer of a preset; `None` if there
/// is no such preset. The scenario may name [files](ExampleDisplay::files).
///
/// ```
/// use papilio_scenario::{ExampleDisplay, new_scenario_of};
/// let epaper = ExampleDisplay::named("epaper").unwrap();
/// assert!(new_scenario_of(epaper, "office").unwrap().contains("lambertian"));
/// ```
pub fn new_scenario_of(display: ExampleDisplay, light: &str) -> Option<String> {
    if display == ExampleDisplay::IMOD {
        return new_scenario(light);
    }
    let (about, keys) = text(light)?.split_once("\n\n")?;
    Some(format!("{about}\n\ntitle = \"{}, {light}\"\n\n{keys}\n{}", display.name, display.text))
}

/// The light in which a usual panel shows a picture, unless another is requested.
pub const PICTURE_LIGHT: &str = "living-room";

/// Returns a complete scenario of a picture on a usual panel of this kind, upright or lying, in the light of a preset; `None` if the display
/// has no panel. The picture is cut to its size about the middle. The scenario may name [files](ExampleDisplay::files).
///
/// ```
/// use papilio_scenario::{ExampleDisplay, PICTURE_LIGHT, picture_scenario};
/// let inks = ExampleDisplay::named("six-ink").unwrap();
/// assert!(picture_scenario(inks, PICTURE_LIGHT, true).unwrap().contains("pixels = [480, 800]"));
/// ```
pub fn picture_scenario(display: ExampleDisplay, light: &str, is_upright: bool) -> Option<String> {
    let ExamplePanel { pixels: [longer, shorter], ppi } = display.panel?;
    let [columns, rows] = if is_upright { [shorter, longer] } else { [longer, shorter] };
    let scenario = new_scenario_of(display, light)?;
    Some(format!(
        "{scenario}\n[display.matrix]\nppi = {ppi}\npixels = [{columns}, {rows}]\n\n[image]\nfit = \"cover\"\n"
    ))
}

/// Returns the keys of a preset as TOML.
pub(crate) fn text(name: &str) -> Option<&'static str> {
    PRESETS.iter().find(|(known, _)| *known == name).map(|(_, text)| *text)
}

/// Fills in the keys of the scenario's preset that the scenario does not set. Returns true if there was one.
pub(crate) fn expand(root: &mut Node, errors: &mut Errors) -> bool {
    let Some(Node { origin, value: Value::Text(name) }) = root.at(PRESET_PATH) else { return false };
    match PRESETS.iter().find(|(known, _)| known == name) {
        Some((_, text)) => {
            let preset = Node::parse_document(text).0.moved_to(*origin);
            root.fill_from(preset)
        }
        None => {
            let choices: Vec<&str> = preset_names().collect();
            errors.push(*origin, mistake::unknown_choice(name, &choices));
            false
        }
    }
}

/// Returns the name of the scenario's preset, if it has one.
pub(crate) fn named(root: &Node) -> Option<&str> {
    match &root.at(PRESET_PATH)?.value {
        Value::Text(name) => Some(name),
        _ => None,
    }
}

/// The preset of a scenario.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UsedPreset {
    /// Its name.
    pub name: &'static str,
    /// Whether the scenario changes its light or its viewer.
    pub is_changed: bool,
}

/// Returns the preset that a scenario names, or else the first one whose light and viewer it has; `filled` is
/// the scenario with all defaults.
pub(crate) fn used(root: &Node, filled: &Json) -> Option<UsedPreset> {
    static ALL: LazyLock<Vec<(&str, Json)>> = LazyLock::new(|| {
        PRESETS.iter().map(|(name, text)| (*name, Node::parse_document(text).0.to_json())).collect()
    });
    let is_like = |(_, preset): &&(&'static str, Json)| {
        let lights = |all: &Json, key: &str| all["lighting"][key].as_array().map_or(0, Vec::len);
        agrees(preset, filled)
            && ["directed", "environment"].iter().all(|key| lights(preset, key) == lights(filled, key))
    };
    let unchanged = |one| UsedPreset { name: one, is_changed: false };
    match named(root) {
        Some(wanted) => ALL
            .iter()
            .find(|(name, _)| *name == wanted)
            .map(|one| UsedPreset { is_changed: !is_like(&one), ..unchanged(one.0) }),
        None => ALL.iter().find(is_like).map(|one| unchanged(one.0)),
    }
}

/// True if all keys of a preset have its values in a scenario.
fn agrees(preset: &Json, filled: &Json) -> bool {
    match (preset, filled) {
        (Json::Object(keys), _) => keys.iter().all(|(key, value)| agrees(value, &filled[key])),
        (Json::Array(ours), Json::Array(theirs)) => {
            ours.len() == theirs.len() && ours.iter().zip(theirs).all(|(a, b)| agrees(a, b))
        }
        (Json::Number(a), Json::Number(b)) => a.as_f64() == b.as_f64(),
        _ => preset == filled,
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::Scenario;

    #[test]
    fn new_scenario_equals_the_same_display_with_the_preset() {
        for name in preset_names() {
            let written = new_scenario(name).unwrap();
            let display = ExampleDisplay::IMOD.text;
            let preset = format!("title = \"{name}\"\nlighting.preset = \"{name}\"\n{display}");
            let [written, preset] = [written, preset]
                .map(|text| Scenario::from_text(&text, name, Path::new(""), &[]).unwrap().resolve().unwrap());
            assert_eq!(written.canonical, preset.canonical, "{name}");
            assert_eq!(written.scene, preset.scene, "{name}");
            assert!(written.warnings.is_empty(), "{name}: {:?}", written.warnings);
        }
        assert_eq!(new_scenario("nowhere"), None);
    }

    /// Each display in each light resolves with the files that belong to it, without a warning.
    #[test]
    fn every_pair_of_display_and_light_is_a_scenario() {
        for display in ExampleDisplay::ALL {
            let folder = tempfile::tempdir().unwrap();
            for (name, content) in display.files {
                std::fs::write(folder.path().join(name), content).unwrap();
            }
            for light in preset_names() {
                let text = new_scenario_of(display, light).unwrap();
                let scenario = Scenario::from_text(&text, light, folder.path(), &[]).unwrap();
                let resolved = scenario.resolve().unwrap_or_else(|e| panic!("{} {light}: {e}", display.name));
                assert!(resolved.warnings.is_empty(), "{} {light}: {:?}", display.name, resolved.warnings);
            }
            assert_eq!(new_scenario_of(display, "nowhere"), None);
        }
    }

    /// The files of scenarios/ are those of the presets.
    #[test]
    fn files_of_the_examples_are_the_same() {
        let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/data");
        let same = |display: &str, name: &str, example: &str| {
            let display = ExampleDisplay::named(display).unwrap();
            let (_, content) = display.files.iter().find(|(known, _)| *known == name).unwrap();
            assert_eq!(std::fs::read_to_string(data.join(example)).unwrap(), *content, "{name}");
        };
        same("six-ink", "six-inks.csv", "synthetic-inks-6.csv");
        for colour in ["red", "green", "blue"] {
            let (name, example) = (format!("filter-{colour}.csv"), format!("synthetic-filter-{colour}.csv"));
            same("printed-filter", &name, &example);
        }
    }

    #[test]
    fn preset_of_a_scenario_is_found_and_its_changes_are_noticed() {
        let display = ExampleDisplay::IMOD.text;
        let used = |text: &str| Scenario::from_text(text, "x", Path::new(""), &[]).unwrap().preset();
        for name in preset_names() {
            let text = format!("lighting.preset = \"{name}\"\n{display}");
            assert_eq!(used(&text), Some(UsedPreset { name, is_changed: false }), "{name}");
            let written = new_scenario(name).unwrap();
            assert!(!used(&written).unwrap().is_changed, "{name}");
        }
        let sunny = new_scenario("sunny").unwrap();
        assert_eq!(used(&sunny.replace("theta_deg = -35", "theta_deg = -36")), None);
        let moved = "lighting.preset = \"sunny\"\nlighting.directed = [{ theta_deg = -36, share = 0.8 }]\n";
        let changed = UsedPreset { name: "sunny", is_changed: true };
        assert_eq!(used(&format!("{moved}{display}")), Some(changed));
        let ring =
            "lighting.environment = [{ model = \"ring\", theta_deg = 35, width_deg = 10, share = 0.1 }]\n";
        let added = format!("lighting.preset = \"sunny\"\nlighting.diffuse = 0.1\n{ring}{display}");
        assert!(used(&added).unwrap().is_changed);
    }
}
