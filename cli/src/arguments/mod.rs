//! Commands and options of the command line.

mod brdf;
mod diffuser;
mod frame;
mod spatial;
mod studies;

use std::net::IpAddr;
use std::path::{Path, PathBuf};

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, Parser, Subcommand, ValueEnum};
use papilio_scenario::ExampleDisplay;

pub(crate) use self::brdf::{ALL_STATES, Brdf, BrdfFormat};
pub(crate) use self::diffuser::{Calibrate, Convert, Diffuser, FitArguments, Inspect, Measure, Steps};
pub(crate) use self::frame::{FrameArguments, FrameForm, Packed};
pub(crate) use self::spatial::{Gonio, ImageCommand, PaletteCommand, SolvedSpatially, SpatialCommand};
pub(crate) use self::studies::{
    FitCommand, Optimize, Sweep, SweepCommand, SweepMerge, SweepOutputs, SweepRun, Tolerance,
};

/// Papilio simulates the appearance of reflective displays
#[derive(Debug, Parser)]
#[command(
    name = "papilio",
    version,
    max_term_width = 100,
    arg_required_else_help = true,
    after_help = "A scenario file (TOML) describes the display, the light and the viewer. To start:\n  \
                  papilio new office office.toml\n  \
                  papilio run office.toml\n\n\
                  Results are written to out/ unless --out specifies another folder. docs/README.md lists the documentation.\n\n\
                  Exit codes: 0 success; 1 internal error, or a full disk; 2 invalid input; 3 a search without a feasible design, or a fit without a minimum; 130 interrupted, with \
                  finished work saved. If the environment variable NO_COLOR is set, nothing is printed in colours."
)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: crate::Command,
    /// Print warnings and errors only: no report, notes or progress (JSON is printed)
    #[arg(long, short, global = true)]
    pub(crate) quiet: bool,
    /// Compute also what takes more than 12 h; it is refused otherwise, as soon as its time is known
    #[arg(long, global = true)]
    pub(crate) allow_long: bool,
}

#[derive(Debug, Args)]
pub(crate) struct Serve {
    /// Scenario to open in the page [default: an example]
    pub(crate) file: Option<PathBuf>,
    /// Port; 0 selects a free one [default: 7417]
    #[arg(long, allow_negative_numbers = true, value_parser = port)]
    pub(crate) port: Option<u16>,
    /// Address to listen on, for access from other machines; every request then needs a token [default:
    /// 127.0.0.1]
    #[arg(long, value_name = "ADDRESS", value_parser = address)]
    pub(crate) listen: Option<IpAddr>,
    /// Folder for the jobs of the page, in one for each port [default: papilio/jobs in the user's folder of states]
    #[arg(long, value_name = "DIR")]
    pub(crate) jobs: Option<PathBuf>,
    /// Open the page in the browser
    #[arg(long)]
    pub(crate) open: bool,
}

#[derive(Debug, Args)]
pub(crate) struct Run {
    #[command(flatten)]
    pub(crate) scenario: ScenarioArguments,
    /// Print the result as JSON on standard output; write files only if --out is given
    #[arg(long)]
    pub(crate) json: bool,
    /// Solver; sets solver.method
    #[arg(long, value_enum)]
    pub(crate) solver: Option<Solver>,
    /// Also compute maps over all viewing directions: cone.csv, cone.npy, cone.json, cone.svg,
    /// cone_differences.svg
    #[arg(long)]
    pub(crate) cone: bool,
    /// With --cone: direction with which the colours of the others are compared, in degrees [default: 0,0,
    /// the normal]
    #[arg(long, value_name = "THETA[,PHI]", requires = "cone", allow_negative_numbers = true, value_parser = direction)]
    pub(crate) cone_reference: Option<[f64; 2]>,
    /// With --cone: accept relative errors up to X, and write them in a column `error` [default: the
    /// scenario's target]
    #[arg(long, value_name = "X", requires = "cone", allow_negative_numbers = true, value_parser = relative_error)]
    pub(crate) allow_error: Option<f64>,
    /// Write each figure as PNG too
    #[arg(long)]
    pub(crate) png: bool,
    /// Write a page about the run too, report.html: figures, tables, scenario; it can be printed
    #[arg(long)]
    pub(crate) report: bool,
    /// Seed of the Monte Carlo solver; sets solver.seed
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = seed)]
    pub(crate) seed: Option<u64>,
    #[command(flatten)]
    pub(crate) workers: Workers,
}

#[derive(Debug, Args)]
pub(crate) struct Validate {
    /// Predict samples that others measured instead: all, one by its name, or those of a list of one's own (.toml), or one of them
    #[arg(long, value_name = "NAME", num_args = 0..=2)]
    pub(crate) measured: Option<Vec<String>>,
    /// Print the result as JSON on standard output; write files only if --out is given
    #[arg(long, requires = "measured")]
    pub(crate) json: bool,
    /// Folder for the report and its scenarios [default: out/validate, with --measured out/measured]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) workers: Workers,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Study {
    /// Monte Carlo standard errors against paths and CPU time, for each sampler and strategy (Feng 2012, ch.
    /// 4)
    #[command(after_help = "Example: papilio study sampling scenarios/sampling.toml --out out/study")]
    Sampling(StudySampling),
}

#[derive(Debug, Args)]
pub(crate) struct StudySampling {
    #[command(flatten)]
    pub(crate) scenario: ScenarioArguments,
    /// Largest number of paths, rounded down to 512 times a power of four
    #[arg(long, value_name = "N", default_value_t = 131_072, allow_negative_numbers = true, value_parser = paths)]
    pub(crate) paths: u64,
    /// Write each figure as PNG too
    #[arg(long)]
    pub(crate) png: bool,
}

#[derive(Debug, Args)]
pub(crate) struct Catalogue {
    /// One name, with its numbers and a figure; or a word, to list all whose descriptions contain it
    /// [default: list all]
    pub(crate) name: Option<String>,
    /// Print JSON on standard output; write files only if --out is given
    #[arg(long)]
    pub(crate) json: bool,
    /// Folder for the table (CSV) and the figure (SVG) [default: in out/, for one NAME; none for lists]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct Migrate {
    /// Scenario file (TOML)
    pub(crate) file: PathBuf,
    /// Write the new text to this file instead of FILE
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
    /// List the changes without writing a file
    #[arg(long)]
    pub(crate) dry_run: bool,
    /// Print the changes as JSON on standard output
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct New {
    /// Preset of the light: office, sunny, iec-directional, ... (with --light: FILE)
    #[arg(value_name = "PRESET")]
    pub(crate) preset: Option<String>,
    /// File to write; it must not exist; - is standard output [default: standard output]
    #[arg(value_name = "FILE")]
    pub(crate) file: Option<PathBuf>,
    /// Display of the scenario [default: imod]
    #[arg(long, value_name = "KIND", value_parser = example_display())]
    pub(crate) display: Option<ExampleDisplay>,
    /// Preset of the light
    #[arg(long, value_name = "PRESET")]
    pub(crate) light: Option<String>,
}

fn example_display() -> impl TypedValueParser<Value = ExampleDisplay> {
    one_of(ExampleDisplay::ALL.map(|display| (display.name, display.about, display)))
}

/// A parser of values by their names; the help lists them with what they are.
fn one_of<T: Copy + Send + Sync + 'static>(
    values: impl Into<Vec<(&'static str, &'static str, T)>>,
) -> impl TypedValueParser<Value = T> {
    let values = values.into();
    let name = |(name, about, _): &(&'static str, &'static str, T)| match *about {
        "" => PossibleValue::new(name),
        about => PossibleValue::new(name).help(about),
    };
    PossibleValuesParser::new(values.iter().map(name)).try_map(move |name| {
        let found = values.iter().find(|(known, ..)| *known == name);
        found.map(|(.., value)| *value).ok_or("this name is unknown")
    })
}

#[derive(Debug, Args)]
pub(crate) struct Completions {
    /// Shell: bash, zsh, fish, powershell or elvish
    pub(crate) shell: clap_complete::Shell,
}

#[derive(Debug, Args)]
pub(crate) struct Man {
    /// Folder for the pages
    #[arg(long, value_name = "DIR", default_value = "out/man")]
    pub(crate) out: PathBuf,
}

#[derive(Debug, Args)]
pub(crate) struct Compare {
    /// A result.json, or the folder that contains it; or a scenario file (TOML), which is computed, with the
    /// spread by its `[tolerance]`
    #[arg(value_name = "RESULT")]
    pub(crate) result: PathBuf,
    /// Measured spectra, colours or metrics (CSV, CGATS, CxF), in one or more files
    #[arg(value_name = "MEASURED", required = true)]
    pub(crate) measured: Vec<PathBuf>,
    /// Folder for tables and figures [default: out/compare]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Change a key of the scenario, if RESULT is one; can be repeated
    #[arg(long, value_name = "PATH=VALUE")]
    pub(crate) set: Vec<String>,
    /// Print the result as JSON on standard output; write files only if --out is given
    #[arg(long)]
    pub(crate) json: bool,
    /// Write each figure as PNG too
    #[arg(long)]
    pub(crate) png: bool,
    #[command(flatten)]
    pub(crate) workers: Workers,
}

#[derive(Debug, Args)]
pub(crate) struct Pixel {
    #[command(flatten)]
    pub(crate) scenario: ScenarioArguments,
    /// Medium of the angles [default: solver.angle_medium]
    #[arg(long, value_enum)]
    pub(crate) angles: Option<Angles>,
    /// Step of the angles in degrees, a divisor of 90 [default: 1, and 15 for --absorption]
    #[arg(long, value_name = "DEG", allow_negative_numbers = true, value_parser = angle_step)]
    pub(crate) step: Option<f64>,
    /// Azimuths from which the pixel is seen, degrees, separated by commas; they matter for liquid crystals and
    /// tables with azimuths [default: 0]
    #[arg(long, value_name = "DEG,...", value_delimiter = ',', allow_hyphen_values = true, value_parser = azimuth)]
    pub(crate) phi: Vec<f64>,
    /// Azimuths from 0 to below 180 in steps of this, a divisor of 180: pixel.csv is then a whole table for
    /// `model = "table"`
    #[arg(long, value_name = "DEG", allow_negative_numbers = true, value_parser = azimuth_step, conflicts_with = "phi")]
    pub(crate) phi_step: Option<f64>,
    /// Also compute the absorptance of each layer of the film: absorption.csv, sub-pixels.csv and a figure
    #[arg(long)]
    pub(crate) absorption: bool,
    /// Print the result as JSON on standard output; write files only if --out is given
    #[arg(long)]
    pub(crate) json: bool,
    /// Write each figure as PNG too
    #[arg(long)]
    pub(crate) png: bool,
}

/// Parses an inclination from 0 to below 90 degrees, and optionally an azimuth.
fn direction(text: &str) -> Result<[f64; 2], String> {
    let expected =
        "expected an inclination from 0 to below 90 deg, optionally with an azimuth, such as 8 or 30,90";
    let (theta, phi) = text.split_once(',').unwrap_or((text, "0"));
    let number = |text: &str| text.trim().parse::<f64>().map_err(|_| expected.to_owned());
    let direction = [number(theta)?, number(phi)?];
    let is_valid = (0.0..90.0).contains(&direction[0]) && direction[1].abs() <= 360.0;
    if is_valid { Ok(direction) } else { Err(expected.to_owned()) }
}

/// Parses a whole number from `least` to `most`.
fn whole_number(text: &str, least: u64, most: u64) -> Result<u64, String> {
    let number = text.parse().ok().filter(|number| (least..=most).contains(number));
    number.ok_or_else(|| format!("expected a whole number from {least} to {most}"))
}

/// Parses a seed, which TOML can represent.
fn seed(text: &str) -> Result<u64, String> {
    whole_number(text, 0, i64::MAX as u64)
}

/// Parses the number of a port.
fn port(text: &str) -> Result<u16, String> {
    whole_number(text, 0, u16::MAX.into()).map(|number| number as u16)
}

/// Parses the address of a network interface.
fn address(text: &str) -> Result<IpAddr, String> {
    text.parse().map_err(|_| "expected an IP address: 127.0.0.1, or 0.0.0.0 for all interfaces".to_owned())
}

/// Parses a number of threads.
fn threads(text: &str) -> Result<u16, String> {
    whole_number(text, 1, 1024).map(|number| number as u16)
}

/// Parses a number of paths of the study.
fn paths(text: &str) -> Result<u64, String> {
    whole_number(text, 512, 1 << 30)
}

/// Parses a relative error above 0.
fn relative_error(text: &str) -> Result<f64, String> {
    let error = text.parse().ok().filter(|error: &f64| *error > 0.0);
    error.ok_or_else(|| "expected a relative error above 0, for example 0.01".to_owned())
}

/// Parses an azimuth from -360 to 360 degrees.
fn azimuth(text: &str) -> Result<f64, String> {
    let angle = text.parse().ok().filter(|angle: &f64| angle.abs() <= 360.0);
    angle.ok_or_else(|| "expected an azimuth from -360 to 360 degrees".to_owned())
}

/// Parses a step in degrees that divides 90.
fn angle_step(text: &str) -> Result<f64, String> {
    let divides = |steps: f64| (1.0..=9000.0).contains(&steps) && (steps - steps.round()).abs() < 1e-9;
    let step = text.parse().ok().filter(|step: &f64| divides(90.0 / step));
    step.ok_or_else(|| "expected a step from 0.01 to 90 deg that divides 90, for example 5".to_owned())
}

/// Parses a step in degrees that divides 180.
fn azimuth_step(text: &str) -> Result<f64, String> {
    let divides = |steps: f64| (2.0..=360.0).contains(&steps) && (steps - steps.round()).abs() < 1e-9;
    let step = text.parse().ok().filter(|step: &f64| divides(180.0 / step));
    step.ok_or_else(|| "expected a step from 0.5 to 90 deg that divides 180, for example 15".to_owned())
}

#[derive(Debug, Clone, Copy, ValueEnum)]
pub(crate) enum Angles {
    /// Angles in air, before refraction
    Air,
    /// Angles in the glass above the pixel
    Glass,
}

#[derive(Debug, Clone, Args)]
pub(crate) struct Workers {
    /// Number of threads [default: one per processor]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = threads)]
    pub(crate) threads: Option<u16>,
}

#[derive(Debug, Clone, Args)]
pub(crate) struct ScenarioArguments {
    /// Scenario file (TOML); - reads standard input
    #[arg(value_name = "FILE")]
    pub(crate) file: PathBuf,
    /// Folder for the results [default: out/NAME for NAME.toml]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Change a key of the scenario, for example display.pixel.film.1.thickness_nm=12; can be repeated; paths
    /// of files are relative to the current folder
    #[arg(long, value_name = "PATH=VALUE")]
    pub(crate) set: Vec<String>,
}

impl ScenarioArguments {
    /// Folder for the results if `--out` is not given.
    pub(crate) fn default_out(&self) -> PathBuf {
        default_out(&self.file)
    }
}

/// `out/NAME` for a scenario file `NAME.toml`.
pub(crate) fn default_out(file: &Path) -> PathBuf {
    if crate::input::is_stdin(file) {
        return PathBuf::from("out").join("stdin");
    }
    PathBuf::from("out").join(file.file_stem().unwrap_or_default())
}

#[derive(Debug, Clone, Copy, ValueEnum)]
pub(crate) enum Solver {
    /// Deterministic, free of noise, with a discretisation error
    Adding,
    /// Stochastic (path tracing), unbiased, with standard errors
    MonteCarlo,
    /// The one of the two that meets the target with less work
    Auto,
    /// The old name of `monte-carlo`
    #[value(hide = true)]
    Walk,
}

impl Solver {
    /// The override of the scenario.
    pub(crate) fn as_override(self) -> String {
        let method = match self {
            Self::Adding => "adding",
            Self::MonteCarlo => "monte-carlo",
            Self::Auto => "auto",
            Self::Walk => "walk",
        };
        format!("solver.method={method}")
    }
}
