//! Papilio on the command line: a thin face over `scenario`, `display`, `formats` and `figures`.
//!
//! Exit codes: 0 done; 2 the user's input is wrong; 1 an internal fault; 130 interrupted,
//! what is done is saved. Results go to standard output, all else to standard error.

mod arguments;
mod brdf;
mod compare;
mod diffuser;
mod interrupt;
mod journal;
mod new;
mod optimize;
mod output;
mod pixel;
mod progress;
mod report;
mod run;
mod serve;
mod side_by_side;
mod study;
mod sweep;
mod tolerance;
mod validate;

use std::io::Write;
use std::process::ExitCode;

use clap::Parser;

use arguments::{Arguments, Command, Study};

/// Small vectors come and go in every evaluation of a prepared display, which takes 5 to 8 % longer with the
/// system's allocator.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

/// Why a command did not end well.
#[derive(Debug, thiserror::Error)]
enum Failure {
    /// The user's input is wrong.
    #[error(transparent)]
    Scenario(#[from] papilio_scenario::ScenarioErrors),
    /// The user's input is wrong, beyond what the scenario can know.
    #[error("error: {0}")]
    Input(String),
    /// A data file of the user's is wrong.
    #[error(transparent)]
    Data(papilio_formats::FormatError),
    /// A file could not be written.
    #[error(transparent)]
    Write(#[from] papilio_formats::FormatError),
    /// A figure could not be made a picture.
    #[error("error: {0}")]
    Png(#[from] papilio_figures::PngError),
    /// The scene could not be computed.
    #[error("error: {0}")]
    Display(#[from] papilio_display::DisplayError),
    /// A design could not be evaluated.
    #[error("{}", led(.0))]
    Design(#[from] papilio_design::DesignError),
    /// The report could not be made.
    #[error("error: {0}")]
    Report(#[from] papilio_reproduction::ReproductionError),
    /// The web app could not be served.
    #[error("error: {0}")]
    Serve(#[from] papilio_web::ServeError),
    /// Standard output went away, or the like.
    #[error("error: standard output cannot be written: {0}")]
    Io(#[from] std::io::Error),
    /// Ctrl-C; what is done is saved.
    #[error("interrupted: {0}")]
    Interrupted(&'static str),
}

/// The text of an error; one of a scenario says that it is one by itself.
fn led(error: &papilio_design::DesignError) -> String {
    match error {
        papilio_design::DesignError::Scenario(errors) => errors.to_string(),
        other => format!("error: {other}"),
    }
}

impl Failure {
    fn exit_code(&self) -> u8 {
        match self {
            Self::Scenario(_)
            | Self::Input(_)
            | Self::Data(_)
            | Self::Display(_)
            | Self::Design(_)
            | Self::Serve(_) => 2,
            Self::Write(_) | Self::Png(_) | Self::Io(_) | Self::Report(_) => 1,
            Self::Interrupted(_) => 130,
        }
    }
}

fn main() -> ExitCode {
    let done = match Arguments::parse().command {
        Command::Run(arguments) => run::run(&arguments),
        Command::Brdf(arguments) => brdf::brdf(&arguments),
        Command::Compare(arguments) => compare::run(&arguments),
        Command::Diffuser(command) => diffuser::diffuser(&command),
        Command::New(arguments) => new::run(&arguments),
        Command::Optimize(arguments) => optimize::run(&arguments),
        Command::Pixel(arguments) => pixel::pixel(&arguments),
        Command::Serve(arguments) => serve::run(&arguments),
        Command::Validate(arguments) => validate::validate(&arguments),
        Command::Sweep(command) => sweep::sweep(&command),
        Command::Tolerance(arguments) => tolerance::run(&arguments),
        Command::Study(Study::Sampling(arguments)) => study::sampling(&arguments),
        Command::Schema { result } => output::schema(result),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        // A reader that has seen enough (`papilio run ... | head`) is no fault.
        Err(Failure::Io(error)) if error.kind() == std::io::ErrorKind::BrokenPipe => ExitCode::SUCCESS,
        Err(failure) => {
            say(&failure);
            ExitCode::from(failure.exit_code())
        }
    }
}

/// Prints on standard error, where nobody may listen.
fn say(text: &dyn std::fmt::Display) {
    let _ = writeln!(anstream::stderr(), "{text}");
}
