//! The commands and their options.

mod diffuser;
mod plans;

use std::net::IpAddr;
use std::path::{Path, PathBuf};

use clap::{Args, Parser, Subcommand, ValueEnum};

pub(crate) use self::diffuser::{
    Calibrate, Convert, Diffuser, FitArguments, Format, Inspect, LobeModel, Measure, Steps,
};
pub(crate) use self::plans::{Optimize, Sweep, SweepCommand, SweepMerge, SweepRun, SweepWanted, Tolerance};

/// Papilio simulates what a reader sees of a reflective display: the room's light, the
/// front of screen, the diffuser, the glass and the pixel, described in one scenario file.
#[derive(Debug, Parser)]
#[command(name = "papilio", version, about, max_term_width = 100, arg_required_else_help = true)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Compute a scenario: colours, gamut, contrast, reflectance, with errors and figures
    #[command(after_help = "Example: papilio run scenarios/indoor.toml --set viewer.theta_deg=20")]
    Run(Run),
    /// Scan a scenario's pixel alone from 0 to 90 deg into pixel.csv and a figure
    #[command(after_help = "Example: papilio pixel scenarios/indoor.toml --angles glass --out out/pixel\n\n\
                      A pixel table for a panel with a diffuser needs angles in glass: light reaches it at all of them.")]
    Pixel(Pixel),
    /// Write the finished display's own spectral BSDF, of each state, for other tools
    #[command(after_help = "Example: papilio brdf scenarios/indoor.toml --out out/brdf\n\n\
                      The file, display-bsdf.npz, is described in docs/brdf.md; NumPy reads it.")]
    Brdf(Brdf),
    /// Hold a measured panel to a simulated one: differences of spectra and colours, with figures
    #[command(
        after_help = "Example: papilio run scenarios/overcast.toml && papilio compare out/overcast scenarios/data/synthetic-panel.csv\n\n\
                      MEASURED has the columns state, theta_deg (and phi_deg), and either wavelength_nm and\n\
                      reflectance_factor or X, Y, Z; docs/compare.md describes them."
    )]
    Compare(Compare),
    /// Write a commented scenario to begin with, in the light of a preset: a room, daylight, a standard's geometry
    #[command(after_help = "Example: papilio new office office.toml && papilio run office.toml\n\n\
                      An unknown preset lists all that there are; docs/light.md describes them.")]
    New(New),
    /// Bring a scenario file to the present names of keys and values
    #[command(after_help = "Example: papilio migrate old.toml\n\n\
                      Old names are read by every command; this command replaces them in the file. Comments, order and\n\
                      layout stay as they are.")]
    Migrate(Migrate),
    /// Files of measured scattering: look into them, convert them
    #[command(subcommand)]
    Diffuser(Diffuser),
    /// Compute a scenario at every point of its `[sweep]`, resumably: sweep.csv and figures
    #[command(after_help = "Example: papilio sweep scenarios/sweep.toml\n\n\
                      What is done is kept: the same command goes on after a kill, and computes only what is new in a\n\
                      sweep that was changed.")]
    Sweep(Sweep),
    /// Search for better designs as `[optimize]` says, resumably: best.toml or a front, optimize.csv, figures
    #[command(after_help = "Example: papilio optimize scenarios/optimize.toml\n\n\
                      What is done is kept: the same command goes on after a kill, and ends in the same files.")]
    Optimize(Optimize),
    /// Scatter a scenario's keys as its `[tolerance]` says: percentiles, yield, sensitivities, resumably
    #[command(after_help = "Example: papilio tolerance scenarios/tolerance.toml\n\n\
                      What is done is kept: the same command goes on after a kill, and more samples begin with those that\n\
                      are known.")]
    Tolerance(Tolerance),
    /// Studies of the methods on a scenario of your own
    #[command(subcommand)]
    Study(Study),
    /// Run the dissertation that Papilio follows again: its tables and figures beside ours, as one page of HTML
    #[command(
        after_help = "Example: papilio validate --out out/validate, then open out/validate/report.html"
    )]
    Validate(Validate),
    /// Serve the web app: a display laboratory in the browser, on this machine only
    #[command(after_help = "Example: papilio serve scenarios/indoor.toml --open\n\n\
                      A program that was built by cargo alone has no page in it: `cargo xtask serve` builds both.")]
    Serve(Serve),
    /// Print the JSON Schema of a scenario
    Schema {
        /// That of result.json instead
        #[arg(long)]
        result: bool,
    },
}

#[derive(Debug, Args)]
pub(crate) struct Serve {
    /// The scenario that the page opens; without one, an example
    pub(crate) file: Option<PathBuf>,
    /// The port; 0 for any that is free [default: 7417]
    #[arg(long)]
    pub(crate) port: Option<u16>,
    /// Listen to this address instead of this machine alone; every request then needs a token
    #[arg(long, value_name = "ADDRESS")]
    pub(crate) listen: Option<IpAddr>,
    /// Open the page in the browser
    #[arg(long)]
    pub(crate) open: bool,
}

#[derive(Debug, Args)]
pub(crate) struct Run {
    #[command(flatten)]
    pub(crate) scenario: ScenarioArguments,
    /// Print the result as JSON on standard output, and write files only where --out says so
    #[arg(long)]
    pub(crate) json: bool,
    /// Which solver, as solver.method
    #[arg(long, value_enum)]
    pub(crate) solver: Option<Solver>,
    /// Also map what is seen from all directions: cone.csv, cone.npy, cone.json, cone.svg, cone.png
    #[arg(long)]
    pub(crate) cone: bool,
    /// With --cone: write rows whose relative error is up to this, in a column `error` [default: the scenario's target]
    #[arg(long, value_name = "X", requires = "cone", allow_negative_numbers = true, value_parser = error)]
    pub(crate) allow_error: Option<f64>,
    /// Write each figure as PNG, too
    #[arg(long)]
    pub(crate) png: bool,
    /// Seed of the walk, as solver.seed
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    #[arg(value_parser = clap::value_parser!(u64).range(..=i64::MAX as u64))]
    pub(crate) seed: Option<u64>,
    #[command(flatten)]
    pub(crate) workers: Workers,
}

#[derive(Debug, Args)]
pub(crate) struct Validate {
    /// Folder for the report and its scenarios [default: out/validate]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) workers: Workers,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Study {
    /// The walk's standard error against paths and CPU time, for every sampler and strategy (Feng 2012, ch. 4)
    #[command(after_help = "Example: papilio study sampling scenarios/sampling.toml --out out/study")]
    Sampling(StudySampling),
}

#[derive(Debug, Args)]
pub(crate) struct StudySampling {
    #[command(flatten)]
    pub(crate) scenario: ScenarioArguments,
    /// The most paths, rounded down to 512 times a power of four
    #[arg(long, value_name = "N", default_value_t = 131_072, allow_negative_numbers = true)]
    #[arg(value_parser = clap::value_parser!(u64).range(512..=1 << 30))]
    pub(crate) paths: u64,
}

#[derive(Debug, Args)]
pub(crate) struct Brdf {
    #[command(flatten)]
    pub(crate) scenario: ScenarioArguments,
    /// Step of all directions, degrees
    #[arg(long, value_name = "DEG", default_value_t = 5.0, allow_negative_numbers = true, value_parser = step)]
    pub(crate) step: f64,
    /// Write rows whose relative error is up to this, with an array `error` [default: the scenario's target]
    #[arg(long, value_name = "X", allow_negative_numbers = true, value_parser = error)]
    pub(crate) allow_error: Option<f64>,
    #[command(flatten)]
    pub(crate) workers: Workers,
}

#[derive(Debug, Args)]
pub(crate) struct Migrate {
    /// Scenario file
    pub(crate) file: PathBuf,
    /// Write the new text to this file, and leave FILE as it is
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
    /// List the changes, and write nothing
    #[arg(long)]
    pub(crate) dry_run: bool,
    /// Print the changes as JSON on standard output
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct New {
    /// The light: office, sunny, iec-directional, ...
    #[arg(value_name = "PRESET")]
    pub(crate) preset: String,
    /// The file to write, which must not be there yet [default: standard output]
    #[arg(value_name = "FILE")]
    pub(crate) file: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct Compare {
    /// A result.json, or the folder of a run
    #[arg(value_name = "RESULT")]
    pub(crate) result: PathBuf,
    /// What was measured (CSV)
    #[arg(value_name = "MEASURED")]
    pub(crate) measured: PathBuf,
    /// Folder for the tables and figures [default: out/compare]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Print the comparison as JSON on standard output, and write files only where --out says so
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct Pixel {
    #[command(flatten)]
    pub(crate) scenario: ScenarioArguments,
    /// The medium of the angles [default: as solver.angle_medium]
    #[arg(long, value_enum)]
    pub(crate) angles: Option<Angles>,
    /// Step of the scan, degrees
    #[arg(long, value_name = "DEG", default_value_t = 1.0, allow_negative_numbers = true, value_parser = step)]
    pub(crate) step: f64,
}

/// A step that divides 90 deg.
fn error(text: &str) -> Result<f64, String> {
    let error: f64 = text.parse().map_err(|_| "expected a number".to_owned())?;
    if error > 0.0 { Ok(error) } else { Err("expected a relative error above 0".to_owned()) }
}

fn step(text: &str) -> Result<f64, String> {
    let step: f64 = text.parse().map_err(|_| "expected a number".to_owned())?;
    let steps = 90.0 / step;
    if (1.0..=9000.0).contains(&steps) && (steps - steps.round()).abs() < 1e-9 {
        Ok(step)
    } else {
        Err("expected a step from 0.01 to 90 that divides 90".to_owned())
    }
}

#[derive(Debug, Clone, Copy, ValueEnum)]
pub(crate) enum Angles {
    /// In air, before Snell
    Air,
    /// In the glass above the pixel
    Glass,
}

#[derive(Debug, Args)]
pub(crate) struct Workers {
    /// Worker threads [default: one for each processor]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    #[arg(value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,
}

#[derive(Debug, Args)]
pub(crate) struct ScenarioArguments {
    /// The scenario (TOML)
    #[arg(value_name = "FILE")]
    pub(crate) file: PathBuf,
    /// Folder for the results [default: out/ and the name of FILE]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Set a key of the scenario, e.g. display.pixel.film.1.thickness_nm=12; may be repeated
    #[arg(long, value_name = "PATH=VALUE")]
    pub(crate) set: Vec<String>,
}

impl ScenarioArguments {
    /// Where results go when the user does not say.
    pub(crate) fn default_out(&self) -> PathBuf {
        default_out(&self.file)
    }
}

/// `out/` and the name of a scenario.
pub(crate) fn default_out(file: &Path) -> PathBuf {
    PathBuf::from("out").join(file.file_stem().unwrap_or_default())
}

#[derive(Debug, Clone, Copy, ValueEnum)]
pub(crate) enum Solver {
    /// Deterministic, without noise
    Adding,
    /// Unbiased Monte Carlo path tracing, with standard errors
    MonteCarlo,
    /// The old name of `monte-carlo`
    #[value(hide = true)]
    Walk,
}
