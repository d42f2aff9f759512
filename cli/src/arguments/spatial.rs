//! Commands that depend on the places of pixels: sharpness, crosstalk, sparkle, pictures and palettes.

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use papilio_display::image::{ScreenSpace, ScreenWhite};
use papilio_scenario::{ExampleDisplay, preset_names};

use super::{FrameArguments, ScenarioArguments, Solver, Workers, one_of, seed};

/// A command that depends on the places of pixels.
#[derive(Debug, Clone, Args)]
pub(crate) struct SpatialCommand {
    #[command(flatten)]
    pub(crate) scenario: ScenarioArguments,
    /// Print the result as JSON on standard output; write files only if --out is given
    #[arg(long)]
    pub(crate) json: bool,
    /// Write each figure as PNG too
    #[arg(long)]
    pub(crate) png: bool,
    /// Seed of random numbers; sets solver.seed
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = seed)]
    pub(crate) seed: Option<u64>,
    #[command(flatten)]
    pub(crate) workers: Workers,
}

/// A surface.
#[derive(Debug, Args)]
pub(crate) struct Gonio {
    #[command(flatten)]
    pub(crate) scenario: ScenarioArguments,
    /// Follow a ninth of the rays: three times the error
    #[arg(long)]
    pub(crate) preview: bool,
    /// Print the result as JSON on standard output; write files only if --out is given
    #[arg(long)]
    pub(crate) json: bool,
    /// Write each figure as PNG too
    #[arg(long)]
    pub(crate) png: bool,
    /// Seed of random numbers; sets microgeometry.seed
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = seed)]
    pub(crate) seed: Option<u64>,
    #[command(flatten)]
    pub(crate) workers: Workers,
}

/// A picture on a display.
#[derive(Debug, Args)]
pub(crate) struct ImageCommand {
    #[command(flatten)]
    pub(crate) command: SpatialCommand,
    /// The picture: PNG, JPEG, SVG, OpenEXR or Radiance; sets image.file. Or a folder of pictures, each of which gets a folder of
    /// results
    #[arg(value_name = "PICTURE")]
    pub(crate) picture: Option<String>,
    /// Show the picture, which is then the only argument, on a usual panel in a living room, without a scenario file
    #[arg(long, value_name = "DISPLAY", value_parser = panels())]
    pub(crate) on: Option<ExampleDisplay>,
    /// With --on: preset of the light and the viewer [default: living-room]
    #[arg(long, value_name = "PRESET", requires = "on", value_parser = PossibleValuesParser::new(preset_names()))]
    pub(crate) light: Option<String>,
    /// What is white in seen.png [default: white; with --on: display]
    #[arg(long, value_enum, value_name = "WHITE")]
    pub(crate) relative_to: Option<RelativeTo>,
    /// Colour space of seen.png, which states it
    #[arg(long, value_parser = one_of(SPACES), value_name = "SPACE", default_value = "srgb")]
    pub(crate) space: ScreenSpace,
    /// Also show what the panel holds in the light of these presets, or with the spectra of these CIE
    /// illuminants
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    pub(crate) rooms: Vec<String>,
    /// Give states.png and frame.bmp the usual codes of states: #000000 for black, #ff0000 for red
    #[arg(long)]
    pub(crate) device_colours: bool,
    #[command(flatten)]
    pub(crate) frame: FrameArguments,
}

fn panels() -> impl TypedValueParser<Value = ExampleDisplay> {
    let panels = ExampleDisplay::with_panels().into_iter();
    one_of(panels.map(|display| (display.name, display.about, display)).collect::<Vec<_>>())
}

/// The palette of a display.
#[derive(Debug, Args)]
pub(crate) struct PaletteCommand {
    #[command(flatten)]
    pub(crate) command: SpatialCommand,
    /// Also compute the colours in the light of these presets, or with the spectra of these CIE illuminants
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    pub(crate) rooms: Vec<String>,
    /// What is white in the files for other programs
    #[arg(long, value_enum, value_name = "WHITE", default_value = "white")]
    pub(crate) relative_to: RelativeTo,
}

/// What is white in sRGB.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum RelativeTo {
    /// A perfect white in the same light
    White,
    /// The white of the display
    Display,
}

impl From<RelativeTo> for ScreenWhite {
    fn from(white: RelativeTo) -> Self {
        match white {
            RelativeTo::White => Self::Perfect,
            RelativeTo::Display => Self::Display,
        }
    }
}

/// Colour spaces of a picture for a screen.
const SPACES: [(&str, &str, ScreenSpace); 2] = [
    ("srgb", "sRGB", ScreenSpace::Srgb),
    ("display-p3", "Display P3, for screens with a wide gamut", ScreenSpace::DisplayP3),
];

/// A command that depends on the places of pixels, with two solvers.
#[derive(Debug, Args)]
pub(crate) struct SolvedSpatially {
    #[command(flatten)]
    pub(crate) spatial: SpatialCommand,
    /// Solver; sets solver.method
    #[arg(long, value_enum)]
    pub(crate) solver: Option<Solver>,
}
