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
//! Exit codes: 0 success; 1 internal error, or a full disk; 2 invalid input; 3 a search without a feasible design; 130 interrupted, with
//! finished work saved. Results are printed on standard output, all messages on standard error.

mod arguments;
mod brdf;
mod catalogue;
mod compare;
mod completions;
mod crosstalk;
mod diffuser;
mod folder;
mod gonio;
mod image;
mod input;
mod interrupt;
mod journal;
mod man;
mod migrate;
mod mtf;
mod new;
mod optimize;
mod output;
mod palette;
mod parallel;
mod pixel;
mod progress;
mod report;
mod run;
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

use clap::Parser;

use arguments::{Arguments, Command, Study, SweepCommand};
use papilio_formats::report::numbers;
use papilio_formats::words::visible;
use terminal::{print_message, print_notes};

/// Why a command failed.
#[derive(Debug, thiserror::Error)]
enum Failure {
    /// The scenario is invalid.
    #[error(transparent)]
    Scenario(#[from] papilio_scenario::ScenarioErrors),
    /// Another input is invalid: an argument, a file or a combination of them.
    #[error("error: {0}")]
    Input(String),
    /// A data file is invalid.
    #[error(transparent)]
    Data(papilio_formats::FormatError),
    /// A file could not be written.
    #[error(transparent)]
    Write(papilio_formats::FormatError),
    /// A figure could not be converted to PNG.
    #[error("error: {0}")]
    Png(#[from] papilio_figures::PngError),
    /// The scene could not be computed.
    #[error("error: {0}")]
    Display(#[from] papilio_display::DisplayError),
    /// A design could not be evaluated.
    #[error("error: {0}")]
    Design(papilio_design::DesignError),
    /// The reproduction report could not be computed.
    #[error("error: {0}")]
    Report(#[from] papilio_reproduction::ReproductionError),
    /// The web app could not be served.
    #[error("error: {0}")]
    Serve(#[from] papilio_web::ServeError),
    /// Standard output could not be written.
    #[error("error: standard output cannot be written: {0}")]
    Io(#[from] std::io::Error),
    /// A search ended without a design that satisfies all constraints.
    #[error("error: {0}")]
    Infeasible(&'static str),
    /// The user pressed Ctrl-C; finished work is saved.
    #[error("interrupted: {0}")]
    Interrupted(&'static str),
}

impl Failure {
    /// Failure of a computation, with its place in the scenario if a key caused it.
    fn from_display(resolved: &papilio_scenario::Resolved, error: papilio_display::DisplayError) -> Self {
        resolved.located(&error).map_or(Self::Display(error), Self::Scenario)
    }

    /// Failure of one of many designs or points, which `note` identifies.
    fn of_one(error: impl Into<papilio_design::DesignError>, note: &str) -> Self {
        match error.into() {
            papilio_design::DesignError::Scenario(errors) => Self::Scenario(errors.with_note(note)),
            other => Self::Input(format!("{other}\n  = note: {note}")),
        }
    }

    fn exit_code(&self) -> u8 {
        match self {
            Self::Scenario(_)
            | Self::Input(_)
            | Self::Data(_)
            | Self::Display(_)
            | Self::Design(_)
            | Self::Serve(_) => 2,
            Self::Write(_) | Self::Png(_) | Self::Io(_) | Self::Report(_) => 1,
            Self::Infeasible(_) => 3,
            Self::Interrupted(_) => 130,
        }
    }
}

impl From<papilio_design::DesignError> for Failure {
    /// An invalid scenario is reported as such, with its place.
    fn from(error: papilio_design::DesignError) -> Self {
        match error {
            papilio_design::DesignError::Scenario(errors) => Self::Scenario(errors),
            other => Self::Design(other),
        }
    }
}

impl From<papilio_formats::FormatError> for Failure {
    /// A file that cannot be written is an internal error; any other problem of a file is invalid input.
    fn from(error: papilio_formats::FormatError) -> Self {
        match error.problem {
            papilio_formats::Problem::Unwritable { .. } => Self::Write(error),
            _ => Self::Data(error),
        }
    }
}

/// Prints the error of the arguments, and returns the exit code.
///
/// Clap quotes arguments unchanged. An argument with control characters, which a terminal would execute, is therefore
/// reported as the error itself.
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
fn missing_feature(command: &Command) -> Option<String> {
    let (png, parquet) = match command {
        Command::Run(run) => (run.png, false),
        Command::Optimize(optimize) => (optimize.png, false),
        Command::Tolerance(tolerance) => (tolerance.png, false),
        Command::Mtf(of_place) | Command::Crosstalk(of_place) => (of_place.spatial.png, false),
        Command::Sparkle(of_place) => (of_place.png, false),
        Command::Gonio(gonio) => (gonio.png, false),
        Command::Compare(compare) => (compare.png, false),
        Command::Sweep(sweep) => {
            let merge = sweep.command.as_ref().map(|SweepCommand::Merge(merge)| &merge.outputs);
            let outputs = merge.unwrap_or(&sweep.outputs);
            (outputs.png, outputs.parquet)
        }
        _ => (false, false),
    };
    match (png, parquet) {
        (true, _) if !papilio_figures::HAS_PNG => Some(papilio_figures::PngError::NotBuilt.to_string()),
        (_, true) if !papilio_formats::HAS_PARQUET => Some(papilio_formats::NO_PARQUET.to_owned()),
        _ => None,
    }
}

/// Returns the definition of the command line: all commands with their arguments, options, defaults and help. The tests make
/// docs/cli.md from it.
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
    let arguments = match Arguments::try_parse_from(arguments) {
        Ok(arguments) => arguments,
        Err(error) => return report_invalid_arguments(arguments, &error),
    };
    if arguments.quiet {
        terminal::be_quiet();
    }
    if let Some(message) = missing_feature(&arguments.command) {
        print_message(&format!("error: {message}"));
        return 2;
    }
    let result = match arguments.command {
        Command::Run(arguments) => run::run(&arguments),
        Command::Brdf(arguments) => brdf::brdf(&arguments),
        Command::Compare(arguments) => compare::run(&arguments),
        Command::Crosstalk(arguments) => crosstalk::crosstalk(&arguments),
        Command::Diffuser(command) => diffuser::diffuser(&command),
        Command::Illuminants(arguments) => catalogue::list_illuminants(&arguments),
        Command::Materials(arguments) => catalogue::list_materials(&arguments),
        Command::Completions(arguments) => completions::run(&arguments),
        Command::Man(arguments) => man::run(&arguments),
        Command::New(arguments) => new::run(&arguments),
        Command::Migrate(arguments) => migrate::run(&arguments),
        Command::Gonio(arguments) => gonio::gonio(&arguments),
        Command::Mtf(arguments) => mtf::mtf(&arguments),
        Command::Optimize(arguments) => optimize::run(&arguments),
        Command::Pixel(arguments) => pixel::pixel(&arguments),
        Command::Serve(arguments) => serve::run(&arguments),
        Command::Validate(arguments) => validate::validate(&arguments),
        Command::Sparkle(arguments) => sparkle::sparkle(&arguments),
        Command::Image(arguments) => image::command(&arguments),
        Command::Palette(arguments) => palette::palette(&arguments),
        Command::Sweep(command) => sweep::sweep(&command),
        Command::Tolerance(arguments) => tolerance::run(&arguments),
        Command::Study(Study::Sampling(arguments)) => study::sampling(&arguments),
        Command::Schema(of) => output::schema(&of),
    };
    match result {
        Ok(()) => 0,
        // The reader closed the pipe (`papilio run ... | head`): this is not an error.
        Err(Failure::Io(error)) if error.kind() == std::io::ErrorKind::BrokenPipe => 0,
        Err(failure) => {
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
