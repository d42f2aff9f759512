//! The program `papilio`: a thin layer over `scenario`, `display`, `formats` and `figures`.
//!
//! `bin/papilio.rs` starts it, and so does the command `papilio` of the Python package.
//!
//! ```sh
//! papilio new office office.toml                     # writes a commented scenario: a display, the light and the viewer
//! papilio run office.toml                            # colours, gamut, contrast; files and figures in out/office
//! papilio run office.toml --set viewer.theta_deg=30  # any key can be changed
//! papilio --help                                     # the other commands: searches, tolerances, pictures, the web app
//! ```
//!
//! Exit codes: 0 success; 1 internal error, or a full disk; 2 invalid input; 3 a search without a feasible
//! design; 130 interrupted, with finished work saved. Results are printed on standard output, all messages on
//! standard error.

mod arguments;
mod brdf;
mod catalogue;
mod claim;
mod compare;
mod completions;
mod costs;
mod crosstalk;
mod diffuser;
mod failure;
mod fit;
mod folder;
mod frame;
mod gloss;
mod gonio;
mod image;
mod input;
mod interrupt;
mod job;
mod journal;
mod long_work;
mod man;
mod migrate;
mod mtf;
mod new;
mod optimize;
mod output;
mod palette;
mod parallel;
mod pictures;
mod pixel;
mod progress;
mod report;
mod run;
mod saved;
mod schema;
mod serve;
mod sparkle;
mod spatial;
mod study;
mod sweep;
mod terminal;
mod tolerance;
mod validate;

use std::borrow::Cow;
use std::ffi::OsString;

use clap::FromArgMatches;
use clap::error::{ContextKind, ContextValue};

use arguments::Arguments;
use failure::Failure;
use papilio_diagnostics::nearest;
use papilio_formats::report::numbers;
use papilio_formats::words::visible;
use terminal::{print_message, print_notes, print_warnings};

/// Declares the commands: what `papilio --help` says of each, its arguments and the function that runs it.
macro_rules! commands {
    ($( $(#[$about:meta])* $name:ident($arguments:ty) => $run:path ),* $(,)?) => {
        #[derive(Debug, clap::Subcommand)]
        enum Command { $( $(#[$about])* $name($arguments), )* }

        impl Command {
            fn run(&self) -> Result<(), Failure> {
                match self { $( Self::$name(arguments) => $run(arguments), )* }
            }
        }
    };
}

commands! {
    /// Compute colours, gamut, contrast and reflectance of a scenario, with errors and figures
    #[command(after_help = "Example: papilio run scenarios/indoor.toml --set viewer.theta_deg=20")]
    Run(arguments::Run) => run::run,
    /// Compute the reflectance of the pixel alone from 0 to 90 deg: pixel.csv and a figure
    #[command(
        after_help = "Example: papilio pixel scenarios/indoor.toml --angles glass --absorption --out out/pixel\n\n\
                      For a table of a pixel under a diffuser, use --angles glass."
    )]
    Pixel(arguments::Pixel) => pixel::pixel,
    /// Export the spectral BRDF of the whole display, for each state
    #[command(after_help = "Examples:\n  papilio brdf scenarios/indoor.toml --out out/brdf\n  \
                      papilio brdf scenarios/indoor.toml --format rgl --states white,black --out out/mitsuba\n\n\
                      docs/brdf.md describes the files. The same command resumes an interrupted computation.")]
    Brdf(arguments::Brdf) => brdf::brdf,
    /// Compute the sparkle of an antiglare face over the pixels
    #[command(
        after_help = "Example: papilio sparkle scenarios/antiglare.toml --set sparkle.correlation_um=[5,10,20,40]\n\n\
                      The scenario needs [display.matrix] and [sparkle]. docs/sparkle.md describes them."
    )]
    Sparkle(arguments::SpatialCommand) => sparkle::sparkle,
    /// Compute the gloss (ISO 2813) and the distinctness of image of each state
    #[command(after_help = "Example: papilio gloss scenarios/etched-face.toml\n\n\
                      docs/gloss.md describes the results.")]
    Gloss(arguments::SolvedSpatially) => gloss::gloss,
    /// Compute how sharp the display is: modulation transfer, spreads, contrast of fine lines
    #[command(after_help = "Example: papilio mtf scenarios/matrix.toml\n\n\
                      It needs the thickness of the layers above the pixels. docs/mtf.md describes the results.")]
    Mtf(arguments::SolvedSpatially) => mtf::mtf,
    /// Compute which sub-pixel lights which, and the gamut and contrast of stripes, lines and text
    #[command(after_help = "Example: papilio crosstalk scenarios/matrix.toml --solver monte-carlo\n\n\
                      The scenario needs [display.matrix] and the thickness of the layers above the pixels. docs/crosstalk.md describes \
                      the results.")]
    Crosstalk(arguments::SolvedSpatially) => crosstalk::crosstalk,
    /// Show a picture on the display: what the reader sees in this light, and what to send to the panel
    #[command(after_help = "Examples:\n  \
                      papilio image photograph.jpg --on six-ink --rooms office,LED-B1\n  \
                      papilio image scenarios/six-ink.toml photograph.jpg --set lighting.spectrum=D65 --set image.kernel=stucki\n  \
                      papilio image scenarios/page.toml --rooms FL11,D65\n  \
                      papilio image scenarios/six-ink.toml photograph.jpg --packed 4 --rotate 90\n\n\
                      docs/image.md describes the files, docs/panel.md those for a panel.")]
    Image(arguments::ImageCommand) => pictures::command,
    /// Compute the palette of a display: the colours of all states in this light and in other rooms
    #[command(after_help = "Example:\n  \
                      papilio palette scenarios/six-ink.toml --rooms D65,FL11 --relative-to display\n\n\
                      docs/palette.md describes the files.")]
    Palette(arguments::PaletteCommand) => palette::palette,
    /// Measure a surface with a virtual goniometer: where its bumps, roughness or profile send the light
    #[command(after_help = "Examples:\n  \
                      papilio gonio surfaces/hemispheres.toml\n  \
                      papilio gonio surfaces/etched.toml --preview --set microgeometry.rms_nm=400\n\n\
                      docs/gonio.md describes the files. The same command resumes an interrupted measurement.")]
    Gonio(arguments::Gonio) => gonio::gonio,
    /// Compare a simulated display with a measured panel: spectra, colours and gamut, with figures
    #[command(after_help = "Example:\n  \
                      papilio run scenarios/overcast.toml\n  \
                      papilio compare out/overcast scenarios/data/synthetic-panel.csv\n\n\
                      MEASURED has the columns state, theta_deg, wavelength_nm and reflectance_factor, or others. docs/compare.md \
                      describes it.")]
    Compare(arguments::Compare) => compare::run,
    /// Write a commented scenario to start from: a display in the light of a preset
    #[command(
        override_usage = "papilio new PRESET [FILE]\n       papilio new --display KIND --light PRESET [FILE]"
    )]
    #[command(after_help = "Examples:\n  \
                      papilio new office office.toml && papilio run office.toml\n  \
                      papilio new --display epaper --light living-room reader.toml\n\n\
                      docs/light.md describes the presets.")]
    New(arguments::New) => new::run,
    /// List materials and liquid crystals, or show one: source, n and k, a figure
    #[command(
        after_help = "Examples: papilio materials TiO2\n          papilio materials oxide\n\n\
                      docs/films.md describes other materials."
    )]
    Materials(arguments::Catalogue) => catalogue::list_materials,
    /// List the CIE illuminants, or show one: colour, colour temperature, Ra, spectrum, a figure
    #[command(after_help = "Example: papilio illuminants FL11\n\n\
                      docs/light.md describes other spectra.")]
    Illuminants(arguments::Catalogue) => catalogue::list_illuminants,
    /// Replace old names of keys and values in a scenario file
    #[command(after_help = "Example: papilio migrate old.toml\n\n\
                      Every command accepts old names, too. Comments, order and layout do not change.")]
    Migrate(arguments::Migrate) => migrate::run,
    /// Inspect, convert and fit files of measured scattering (BSDF)
    #[command(subcommand)]
    Diffuser(arguments::Diffuser) => diffuser::diffuser,
    /// Compute a scenario over a grid of values (`[sweep]`): sweep.csv and figures; can be resumed
    #[command(after_help = "Examples: papilio sweep scenarios/sweep.toml\n          \
                      papilio sweep scenarios/indoor.toml --axis display.diffuser.haze=0.3:0.8:0.1 --axis viewer.theta_deg=0,30\n\n\
                      The same command resumes an interrupted sweep.")]
    Sweep(arguments::Sweep) => sweep::sweep,
    /// Search for better designs (`[optimize]`): best.toml or a Pareto front; can be resumed
    #[command(after_help = "Example: papilio optimize scenarios/optimize.toml\n\n\
                      The same command resumes an interrupted search.")]
    Optimize(arguments::Optimize) => optimize::run,
    /// Run a tolerance analysis (`[tolerance]`): percentiles, yield, sensitivities; can be resumed
    #[command(after_help = "Example: papilio tolerance scenarios/tolerance.toml\n\n\
                      The same command resumes an interrupted analysis.")]
    Tolerance(arguments::Tolerance) => tolerance::run,
    /// Fit keys of a scenario (`[fit]`) to measured data: values with intervals, and the fitted scenario
    #[command(after_help = "Example: papilio fit scenarios/fit.toml scenarios/data/synthetic-film.csv\n\n\
                      MEASURED is as for `papilio compare`. docs/fit.md describes the results.")]
    Fit(arguments::FitCommand) => fit::run,
    /// Study the numerical methods on a scenario
    #[command(subcommand)]
    Study(arguments::Study) => study::sampling,
    /// Reproduce the tables and figures of Feng (2012), or predict samples that others measured
    #[command(after_help = "Examples:\n  \
                      papilio validate --out out/validate\n  \
                      papilio validate --measured clear-glass\n\n\
                      It writes report.html. docs/measured-samples.md describes the samples.")]
    Validate(arguments::Validate) => validate::validate,
    /// Start the web app: edit a display and see its result in the browser (local access only)
    #[command(after_help = "Example: papilio serve scenarios/indoor.toml --open\n\n\
                      A program built with cargo alone does not contain the page; `cargo xtask serve` builds both.")]
    Serve(arguments::Serve) => serve::run,
    /// Print a completion script for a shell
    #[command(after_help = "Examples:\n  \
                      papilio completions bash > ~/.local/share/bash-completion/completions/papilio\n  \
                      papilio completions zsh > \"${fpath[1]}/_papilio\"\n  \
                      papilio completions fish > ~/.config/fish/completions/papilio.fish\n  \
                      papilio completions powershell >> $PROFILE")]
    Completions(arguments::Completions) => completions::run,
    /// Write manual pages into a folder: papilio.1, and one for each command
    #[command(after_help = "Example: papilio man --out ~/.local/share/man/man1\n\n\
                      `man papilio-run` then shows the page of `papilio run`.")]
    Man(arguments::Man) => man::run,
    /// Print the JSON Schema of a scenario, for editors
    Schema(schema::Schema) => schema::schema,
}

/// The JSON files of results, which contain the hash of their scenario.
const RESULTS: [ResultFile; 9] = [
    ResultFile { name: "result.json", of: "", schema: Some(papilio_formats::result_schema) },
    ResultFile { name: "mtf.json", of: "", schema: Some(papilio_formats::mtf_schema) },
    ResultFile { name: "crosstalk.json", of: "", schema: Some(papilio_formats::crosstalk_schema) },
    ResultFile { name: "sparkle.json", of: "", schema: Some(papilio_formats::sparkle_schema) },
    ResultFile { name: "gloss.json", of: "", schema: Some(papilio_formats::gloss_schema) },
    ResultFile { name: "palette.json", of: "", schema: Some(papilio_formats::palette_schema) },
    ResultFile { name: "image.json", of: "", schema: Some(papilio_formats::image_schema) },
    ResultFile {
        name: "audit.json",
        of: " of a surface",
        schema: Some(papilio_formats::surface_audit_schema),
    },
    ResultFile { name: "cone.json", of: "", schema: None },
];

/// A JSON file of a result.
struct ResultFile {
    name: &'static str,
    /// What it is of, for the help of `papilio schema`.
    of: &'static str,
    schema: Option<fn() -> serde_json::Value>,
}

/// Adds what was probably meant to the error of an unknown command: commands with similar names, and the option of this name.
fn with_suggestions(arguments: &[OsString], mut error: clap::Error) -> clap::Error {
    let Some(ContextValue::String(wrong)) = error.get(ContextKind::InvalidSubcommand) else { return error };
    let wrong = wrong.clone();
    let program = command();
    let (mut parent, mut names) = (&program, "papilio".to_owned());
    for argument in arguments.iter().skip(1).filter_map(|argument| argument.to_str()) {
        let Some(found) = parent.find_subcommand(argument) else { continue };
        names.push_str(&format!(" {argument}"));
        parent = found;
    }
    if error.get(ContextKind::SuggestedSubcommand).is_none()
        && let Some(near) = nearest(&wrong, parent.get_subcommands().map(clap::Command::get_name))
    {
        error.insert(ContextKind::SuggestedSubcommand, ContextValue::Strings(vec![near.to_owned()]));
    }
    let has_option =
        |command: &&clap::Command| command.get_arguments().any(|one| one.get_long() == Some(wrong.as_str()));
    let with_option: Vec<String> = parent
        .get_subcommands()
        .filter(has_option)
        .map(|command| format!("`{names} {} ... --{wrong}`", command.get_name()))
        .collect();
    // An option of many commands, such as --json, was not meant.
    if (1..=MOST_WITH_OPTION).contains(&with_option.len()) {
        let tip = format!("this is an option: {}", with_option.join(" or "));
        error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
    }
    error
}

/// Largest number of commands with an option that are proposed.
const MOST_WITH_OPTION: usize = 2;

/// Prints the error of the arguments, and returns the exit code.
///
/// Clap quotes arguments unchanged. An argument with control characters, which a terminal would execute, is
/// therefore reported as the error itself.
fn report_invalid_arguments(arguments: &[OsString], error: &clap::Error) -> u8 {
    let mut arguments = arguments.iter().map(|argument| argument.to_string_lossy().into_owned());
    let unsafe_argument = arguments.find(|argument| matches!(visible(argument), Cow::Owned(_)));
    match unsafe_argument.filter(|_| error.use_stderr()) {
        Some(argument) => {
            print_message(&format!(
                "error: the arguments are invalid: `{argument}` contains control characters\n  = help: papilio --help lists \
                 the commands and their options"
            ));
            2
        }
        None => error.exit(),
    }
}

/// Error message if the options request a format that this program was built without.
fn missing_format(arguments: &clap::ArgMatches) -> Option<String> {
    let is_set = |flag| arguments.try_get_one::<bool>(flag).is_ok_and(|value| value == Some(&true));
    if is_set("png") && !papilio_figures::HAS_PNG {
        return Some(papilio_figures::PngError::NotBuilt.to_string());
    }
    if is_set("parquet") && !papilio_formats::HAS_PARQUET {
        return Some(papilio_formats::NO_PARQUET.to_owned());
    }
    arguments.subcommand().and_then(|(_, arguments)| missing_format(arguments))
}

/// Returns the definition of the command line: all commands with their arguments, options, defaults and help.
/// The tests make docs/cli.md from it.
pub fn command() -> clap::Command {
    <Arguments as clap::CommandFactory>::command()
}

/// Runs the program with its arguments, the first of which is its own name; returns the exit code.
///
/// A panic is an internal error: exit code 1, with a message that says what to report.
pub fn main(arguments: &[OsString]) -> u8 {
    caught(|| run_command(arguments))
}

/// The exit code of a command, also if it panics.
fn caught(command: impl FnOnce() -> u8 + std::panic::UnwindSafe) -> u8 {
    std::panic::catch_unwind(command).unwrap_or_else(|_| {
        print_message(&concat!(
            "error: internal error of papilio; the lines above state where\n",
            "  = help: this is a fault of the program, not of your files: please report the command, its files and these lines"
        ));
        1
    })
}

fn run_command(arguments: &[OsString]) -> u8 {
    let matches = match command().try_get_matches_from(arguments) {
        Ok(matches) => matches,
        Err(error) => return report_invalid_arguments(arguments, &with_suggestions(arguments, error)),
    };
    let parsed = match Arguments::from_arg_matches(&matches) {
        Ok(parsed) => parsed,
        Err(error) => return report_invalid_arguments(arguments, &error.format(&mut command())),
    };
    if parsed.quiet {
        terminal::be_quiet();
    }
    if parsed.allow_long {
        long_work::allow();
    }
    if let Some(message) = missing_format(&matches) {
        print_message(&format!("error: {message}"));
        return 2;
    }
    // The others read what they have written before.
    if !matches!(parsed.command, Command::Validate(_) | Command::Serve(_)) {
        papilio_formats::protect_inputs();
    }
    job::follow_server();
    match parsed.command.run() {
        Ok(()) => 0,
        // The reader closed the pipe (`papilio run ... | head`): this is not an error.
        Err(Failure::Io(error)) if error.kind() == std::io::ErrorKind::BrokenPipe => 0,
        Err(failure) => {
            if let Failure::Interrupted(left) = &failure
                && let Some(refusal) = long_work::refusal(left)
            {
                print_message(&refusal);
                return 2;
            }
            print_message(&failure);
            failure.exit_code()
        }
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn panic_is_an_internal_error() {
        let none: Vec<u8> = Vec::new();
        assert_eq!([super::caught(move || none[std::hint::black_box(0)]), super::caught(|| 2)], [1, 2]);
    }
}
