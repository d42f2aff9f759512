//! Commands and options of the command line.

mod brdf;
mod diffuser;
mod spatial;
mod studies;

use std::net::IpAddr;
use std::path::{Path, PathBuf};

use clap::{Args, Parser, Subcommand, ValueEnum};

pub(crate) use self::brdf::{ALL_STATES, Brdf, BrdfFormat};
pub(crate) use self::diffuser::{
    Calibrate, Convert, Diffuser, FitArguments, Format, Inspect, LobeModel, Measure, PartName, Steps,
};
pub(crate) use self::spatial::{
    Gonio, ImageCommand, PaletteCommand, RelativeTo, SolvedSpatially, Space, SpatialCommand,
};
pub(crate) use self::studies::{
    Optimize, Sweep, SweepCommand, SweepMerge, SweepOutputs, SweepRun, Tolerance,
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
                  Exit codes: 0 success; 1 internal error, or a full disk; 2 invalid input; 3 a search without a feasible design; 130 interrupted, with \
                  finished work saved. If the environment variable NO_COLOR is set, nothing is printed in colours."
)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
    /// Print warnings and errors only: no report, notes or progress (JSON is printed)
    #[arg(long, short, global = true)]
    pub(crate) quiet: bool,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Compute colours, gamut, contrast and reflectance of a scenario, with errors and figures
    #[command(after_help = "Example: papilio run scenarios/indoor.toml --set viewer.theta_deg=20")]
    Run(Run),
    /// Compute the reflectance of the pixel alone from 0 to 90 deg: pixel.csv and a figure
    #[command(
        after_help = "Example: papilio pixel scenarios/indoor.toml --angles glass --absorption --out out/pixel\n\n\
                      For a table of a pixel under a diffuser, use --angles glass: the diffuser sends light to the pixel at \
                      all angles in the glass."
    )]
    Pixel(Pixel),
    /// Export the spectral BRDF of the whole display, for each state
    #[command(after_help = "Examples:\n  papilio brdf scenarios/indoor.toml --out out/brdf\n  \
                      papilio brdf scenarios/indoor.toml --format rgl --states white,black --out out/mitsuba\n\n\
                      docs/brdf.md describes the files: display-bsdf.npz for NumPy; CSV; RGL tensor files and a scene for the \
                      renderer Mitsuba.")]
    Brdf(Brdf),
    /// Compute the sparkle of an antiglare face over the pixels: random brightness of equal pixels
    #[command(
        after_help = "Example: papilio sparkle scenarios/antiglare.toml --set sparkle.correlation_um=[5,10,20,40]\n\n\
                      The scenario needs [display.matrix] and [sparkle]. docs/sparkle.md describes them."
    )]
    Sparkle(SpatialCommand),
    /// Compute how sharp the display is: modulation transfer, point, line and edge spread, contrast of fine lines
    #[command(after_help = "Examples:\n  \
                      papilio mtf scenarios/matrix.toml\n  \
                      papilio mtf scenarios/matrix.toml --solver monte-carlo\n\n\
                      It needs the thickness of the layers above the pixels. docs/mtf.md describes the results.")]
    Mtf(SolvedSpatially),
    /// Compute which sub-pixel lights which, and the gamut and contrast of stripes, lines and text
    #[command(after_help = "Examples:\n  \
                      papilio crosstalk scenarios/matrix.toml\n  \
                      papilio crosstalk scenarios/matrix.toml --solver monte-carlo\n\n\
                      The scenario needs [display.matrix] and the thickness of the layers above the pixels. docs/crosstalk.md describes \
                      the results.")]
    Crosstalk(SolvedSpatially),
    /// Show a picture on the display: what the reader sees in this light, and what to send to the panel
    #[command(after_help = "Examples:\n  \
                      papilio image scenarios/six-ink.toml photograph.jpg\n  \
                      papilio image scenarios/six-ink.toml photograph.jpg --set lighting.spectrum=D65 --set image.kernel=stucki\n  \
                      papilio image scenarios/page.toml --rooms FL11,D65\n\n\
                      It writes seen.png and seen.exr, what the reader sees; states.png, the state of each pixel; and image.json. \
                      docs/image.md describes them.")]
    Image(ImageCommand),
    /// Compute the palette of a display: the colours of all states in this light and in other rooms, for other programs too
    #[command(after_help = "Examples:\n  \
                      papilio palette scenarios/six-ink.toml\n  \
                      papilio palette scenarios/six-ink.toml --rooms D65,FL11 --relative-to display\n\n\
                      It writes palette.json, and the colours as .gpl, .css, .ase, .act and for dithering tools. docs/palette.md \
                      describes them.")]
    Palette(PaletteCommand),
    /// Measure a surface with a virtual goniometer: where its bumps, roughness or profile send the light; can be resumed
    #[command(after_help = "Examples:\n  \
                      papilio gonio surfaces/hemispheres.toml\n  \
                      papilio gonio surfaces/etched.toml --preview --set microgeometry.rms_nm=400\n\n\
                      It writes totals.csv, audit.json and the kernel of both sides, face.npz. docs/gonio.md describes them. \
                      Each finished part is saved: to resume an interrupted measurement, run the same command again.")]
    Gonio(Gonio),
    /// Compare a simulated display with a measured panel: spectra, colours and gamut, with figures
    #[command(after_help = "Example:\n  \
                      papilio run scenarios/overcast.toml\n  \
                      papilio compare out/overcast scenarios/data/synthetic-panel.csv\n\n\
                      MEASURED needs the columns state, optionally theta_deg and phi_deg, and either wavelength_nm \
                      and reflectance_factor, or X, Y and Z, or L, a and b; files of instruments are read too. \
                      docs/compare.md describes them.")]
    Compare(Compare),
    /// Write a commented scenario to start from: a display in the light of a preset
    #[command(
        override_usage = "papilio new PRESET [FILE]\n       papilio new --display KIND --light PRESET [FILE]"
    )]
    #[command(after_help = "Examples:\n  \
                      papilio new office office.toml && papilio run office.toml\n  \
                      papilio new --display epaper --light living-room reader.toml\n\n\
                      Presets are rooms, daylight, and measuring geometries of standards. docs/light.md describes them.\n\
                      The error for an unknown preset lists all names.")]
    New(New),
    /// List the named materials, or show one: source, n and k, a figure
    #[command(
        after_help = "Examples: papilio materials\n          papilio materials TiO2\n          papilio materials oxide\n\n\
                      Any other n and k can be given as a number, { n, k } or a file. docs/films.md describes them."
    )]
    Materials(Catalogue),
    /// List the CIE illuminants, or show one: colour, colour temperature, Ra, spectrum, a figure
    #[command(after_help = "Examples: papilio illuminants\n          papilio illuminants FL11\n\n\
                      Daylight and black bodies of any temperature, LEDs and files are spectra, too. docs/light.md describes \
                      them.")]
    Illuminants(Catalogue),
    /// Replace old names of keys and values in a scenario file
    #[command(after_help = "Example: papilio migrate old.toml\n\n\
                      Every command accepts old names; this command replaces them in the file. Comments, order and layout \
                      do not change.")]
    Migrate(Migrate),
    /// Inspect, convert and fit files of measured scattering (BSDF)
    #[command(subcommand)]
    Diffuser(Diffuser),
    /// Compute a scenario over a grid of values (`[sweep]`): sweep.csv and figures; can be resumed
    #[command(after_help = "Examples: papilio sweep scenarios/sweep.toml\n          \
                      papilio sweep scenarios/indoor.toml --axis display.diffuser.haze=0.3:0.8:0.1 --axis viewer.theta_deg=0,30\n\n\
                      Each finished point is saved. To resume an interrupted sweep, run the same command again. If the \
                      sweep has changed, only new points are computed.")]
    Sweep(Sweep),
    /// Search for better designs (`[optimize]`): best.toml or a Pareto front; can be resumed
    #[command(after_help = "Example: papilio optimize scenarios/optimize.toml\n\n\
                      Finished work is saved. To resume an interrupted search, run the same command again: the final files \
                      are the same as without the interruption.")]
    Optimize(Optimize),
    /// Run a tolerance analysis (`[tolerance]`): percentiles, yield, sensitivities; can be resumed
    #[command(after_help = "Example: papilio tolerance scenarios/tolerance.toml\n\n\
                      Each finished sample is saved. To resume an interrupted analysis, run the same command again. If the \
                      number of samples is increased, only the additional ones are computed.")]
    Tolerance(Tolerance),
    /// Study the numerical methods on a scenario
    #[command(subcommand)]
    Study(Study),
    /// Reproduce the tables and figures of Feng (2012), and write them next to Papilio's results as HTML
    #[command(after_help = "Example: papilio validate --out out/validate\n\n\
                      Then open out/validate/report.html in a browser. Feng (2012) is the dissertation that Papilio follows.")]
    Validate(Validate),
    /// Start the web app: edit a display and see its result in the browser (local access only)
    #[command(after_help = "Example: papilio serve scenarios/indoor.toml --open\n\n\
                      A program built with cargo alone does not contain the page; `cargo xtask serve` builds both.")]
    Serve(Serve),
    /// Print a completion script for a shell
    #[command(after_help = "Examples:\n  \
                      papilio completions bash > ~/.local/share/bash-completion/completions/papilio\n  \
                      papilio completions zsh > \"${fpath[1]}/_papilio\"\n  \
                      papilio completions fish > ~/.config/fish/completions/papilio.fish\n  \
                      papilio completions powershell >> $PROFILE")]
    Completions(Completions),
    /// Write manual pages into a folder: papilio.1, and one for each command
    #[command(after_help = "Example: papilio man --out ~/.local/share/man/man1\n\n\
                      Then, for example, `man papilio-run` shows the page of `papilio run`.")]
    Man(Man),
    /// Print the JSON Schema of a scenario, for editors
    Schema(Schema),
}

#[derive(Debug, Args)]
pub(crate) struct Schema {
    /// Print the JSON Schema of result.json instead
    #[arg(long, group = "of")]
    pub(crate) result: bool,
    /// Print the JSON Schema of mtf.json instead
    #[arg(long, group = "of")]
    pub(crate) mtf: bool,
    /// Print the JSON Schema of crosstalk.json instead
    #[arg(long, group = "of")]
    pub(crate) crosstalk: bool,
    /// Print the JSON Schema of sparkle.json instead
    #[arg(long, group = "of")]
    pub(crate) sparkle: bool,
    /// Print the JSON Schema of palette.json instead
    #[arg(long, group = "of")]
    pub(crate) palette: bool,
    /// Print the JSON Schema of image.json instead
    #[arg(long, group = "of")]
    pub(crate) image: bool,
    /// Print the JSON Schema of audit.json of a surface instead
    #[arg(long, group = "of")]
    pub(crate) audit: bool,
}

#[derive(Debug, Args)]
pub(crate) struct Serve {
    /// Scenario to open in the page [default: an example]
    pub(crate) file: Option<PathBuf>,
    /// Port; 0 selects a free one [default: 7417]
    #[arg(long)]
    pub(crate) port: Option<u16>,
    /// Address to listen on, for access from other machines; every request then needs a token [default: 127.0.0.1]
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
    /// Print the result as JSON on standard output; write files only if --out is given
    #[arg(long)]
    pub(crate) json: bool,
    /// Solver; sets solver.method
    #[arg(long, value_enum)]
    pub(crate) solver: Option<Solver>,
    /// Also compute maps over all viewing directions: cone.csv, cone.npy, cone.json, cone.svg, cone_differences.svg
    #[arg(long)]
    pub(crate) cone: bool,
    /// With --cone: direction with which the colours of the others are compared, in degrees [default: 0,0, the normal]
    #[arg(long, value_name = "THETA[,PHI]", requires = "cone", allow_negative_numbers = true, value_parser = direction)]
    pub(crate) cone_reference: Option<[f64; 2]>,
    /// With --cone: accept relative errors up to X, and write them in a column `error` [default: the scenario's target]
    #[arg(long, value_name = "X", requires = "cone", allow_negative_numbers = true, value_parser = relative_error)]
    pub(crate) allow_error: Option<f64>,
    /// Write each figure as PNG too
    #[arg(long)]
    pub(crate) png: bool,
    /// Write a page about the run too, report.html: figures, tables, scenario; it can be printed
    #[arg(long)]
    pub(crate) report: bool,
    /// Seed of the Monte Carlo solver; sets solver.seed
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
    /// Monte Carlo standard errors against paths and CPU time, for each sampler and strategy (Feng 2012, ch. 4)
    #[command(after_help = "Example: papilio study sampling scenarios/sampling.toml --out out/study")]
    Sampling(StudySampling),
}

#[derive(Debug, Args)]
pub(crate) struct StudySampling {
    #[command(flatten)]
    pub(crate) scenario: ScenarioArguments,
    /// Largest number of paths, rounded down to 512 times a power of four
    #[arg(long, value_name = "N", default_value_t = 131_072, allow_negative_numbers = true)]
    #[arg(value_parser = clap::value_parser!(u64).range(512..=1 << 30))]
    pub(crate) paths: u64,
}

#[derive(Debug, Args)]
pub(crate) struct Catalogue {
    /// One name, with its numbers and a figure; or a word, to list all whose descriptions contain it [default: list all]
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
    /// File to write; it must not exist [default: standard output]
    #[arg(value_name = "FILE")]
    pub(crate) file: Option<PathBuf>,
    /// Display of the scenario [default: imod]
    #[arg(long, value_enum, value_name = "KIND")]
    pub(crate) display: Option<NewDisplay>,
    /// Preset of the light
    #[arg(long, value_name = "PRESET")]
    pub(crate) light: Option<String>,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
pub(crate) enum NewDisplay {
    /// Interferometric pixels under a diffuser
    Imod,
    /// Electronic paper below a bare glass surface
    Epaper,
    /// A pixel tabulated by another tool, under a diffuser; also writes an example of the table
    Table,
    /// Electronic paper with black, white, red and yellow inks; also writes synthetic spectra
    Bwry,
    /// Electronic paper with six inks; also writes synthetic spectra
    SixInk,
    /// Electronic paper with seven inks; also writes synthetic spectra
    SevenInk,
    /// Electronic paper below a printed colour filter; also writes synthetic transmittances
    PrintedFilter,
}

impl NewDisplay {
    pub(crate) fn example(self) -> papilio_scenario::ExampleDisplay {
        match self {
            Self::Imod => papilio_scenario::ExampleDisplay::Imod,
            Self::Epaper => papilio_scenario::ExampleDisplay::Epaper,
            Self::Table => papilio_scenario::ExampleDisplay::Table,
            Self::Bwry => papilio_scenario::ExampleDisplay::Bwry,
            Self::SixInk => papilio_scenario::ExampleDisplay::SixInk,
            Self::SevenInk => papilio_scenario::ExampleDisplay::SevenInk,
            Self::PrintedFilter => papilio_scenario::ExampleDisplay::PrintedFilter,
        }
    }
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
    /// A result.json, or the folder that contains it
    #[arg(value_name = "RESULT")]
    pub(crate) result: PathBuf,
    /// Measured spectra or colours (CSV, CGATS, CxF)
    #[arg(value_name = "MEASURED")]
    pub(crate) measured: PathBuf,
    /// Folder for tables and figures [default: out/compare]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Print the comparison as JSON on standard output; write files only if --out is given
    #[arg(long)]
    pub(crate) json: bool,
    /// Write each figure as PNG too
    #[arg(long)]
    pub(crate) png: bool,
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
    /// Also compute the absorptance of each layer of the film: absorption.csv, sub-pixels.csv and a figure
    #[arg(long)]
    pub(crate) absorption: bool,
    /// Print the scan as JSON on standard output; write files only if --out is given
    #[arg(long)]
    pub(crate) json: bool,
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

/// Parses a relative error above 0.
fn relative_error(text: &str) -> Result<f64, String> {
    let error: f64 = text.parse().map_err(|_| "expected a number".to_owned())?;
    if error > 0.0 { Ok(error) } else { Err("expected a relative error above 0".to_owned()) }
}

/// Parses a step in degrees that divides 90.
fn angle_step(text: &str) -> Result<f64, String> {
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
    /// Angles in air, before refraction
    Air,
    /// Angles in the glass above the pixel
    Glass,
}

#[derive(Debug, Args)]
pub(crate) struct Workers {
    /// Number of threads [default: one per processor]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    #[arg(value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,
}

#[derive(Debug, Args)]
pub(crate) struct ScenarioArguments {
    /// Scenario file (TOML); - reads standard input
    #[arg(value_name = "FILE")]
    pub(crate) file: PathBuf,
    /// Folder for the results [default: out/NAME for NAME.toml]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Change a key of the scenario, for example display.pixel.film.1.thickness_nm=12; can be repeated; paths of files are
    /// relative to the current folder
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
