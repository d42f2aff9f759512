//! Papilio on the command line: a thin face over `scenario`, `display`, `formats` and `figures`.
//!
//! Exit codes: 0 done; 2 the user's input is wrong; 1 an internal fault; 3 a search without a feasible design; 130
//! interrupted, what is done is saved. Results go to standard output, all else to standard error.

mod arguments;
mod brdf;
mod compare;
mod diffuser;
mod folder;
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
mod terminal;
mod tolerance;
mod validate;

use std::borrow::Cow;
use std::process::ExitCode;

use clap::Parser;

use arguments::{Arguments, Command, Study};
use papilio_formats::words::visible;
use terminal::say;

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
    Write(papilio_formats::FormatError),
    /// A figure could not be made a picture.
    #[error("error: {0}")]
    Png(#[from] papilio_figures::PngError),
    /// The scene could not be computed.
    #[error("error: {0}")]
    Display(#[from] papilio_display::DisplayError),
    /// A design could not be evaluated.
    #[error("error: {0}")]
    Design(papilio_design::DesignError),
    /// The report could not be made.
    #[error("error: {0}")]
    Report(#[from] papilio_reproduction::ReproductionError),
    /// The web app could not be served.
    #[error("error: {0}")]
    Serve(#[from] papilio_web::ServeError),
    /// Standard output went away, or the like.
    #[error("error: standard output cannot be written: {0}")]
    Io(#[from] std::io::Error),
    /// A search ended, and found nothing that meets all limits.
    #[error("no feasible design: {0}")]
    Infeasible(&'static str),
    /// Ctrl-C; what is done is saved.
    #[error("interrupted: {0}")]
    Interrupted(&'static str),
}

impl Failure {
    /// Why one of many designs or points failed; `note`: which one.
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
    /// What is wrong with a scenario stays that.
    fn from(error: papilio_design::DesignError) -> Self {
        match error {
            papilio_design::DesignError::Scenario(errors) => Self::Scenario(errors),
            other => Self::Design(other),
        }
    }
}

impl From<papilio_formats::FormatError> for Failure {
    /// A file that cannot be written is the system's fault, any other the user's.
    fn from(error: papilio_formats::FormatError) -> Self {
        match error.problem {
            papilio_formats::Problem::Unwritable { .. } => Self::Write(error),
            _ => Self::Data(error),
        }
    }
}

/// Says what is wrong with the arguments, as clap does it: which quotes them as they are. So one that a terminal would obey is
/// itself what is wrong.
fn refused(error: &clap::Error) -> ExitCode {
    let mut arguments = std::env::args_os().map(|one| one.to_string_lossy().into_owned());
    let obeyed = arguments.find(|one| matches!(visible(one), Cow::Owned(_)));
    match obeyed.filter(|_| error.use_stderr()) {
        Some(one) => {
            say(&format!(
                "error: the argument `{one}` holds control characters, and the command cannot be understood"
            ));
            ExitCode::from(2)
        }
        None => error.exit(),
    }
}

fn main() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => return refused(&error),
    };
    let done = match arguments.command {
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
