//! Why a command failed, and the exit code.
//!
//! A file or folder that cannot be written is a mistake of the user if another place would do (2), and otherwise a failure of the
//! system, as with a full disk (1): [`is_of_place`] decides, for files ([`Failure::from`]) and folders ([`Failure::of_folder`]).

use std::path::Path;

use papilio_formats::{FormatError, Problem, is_of_place, unwritable};
use papilio_reproduction::ReproductionError;
use papilio_scenario::near_file;

/// Why a command failed.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Failure {
    /// The scenario is invalid.
    #[error(transparent)]
    Scenario(#[from] papilio_scenario::ScenarioErrors),
    /// Another input is invalid: an argument, a file or a combination of them.
    #[error("error: {0}")]
    Input(String),
    /// A data file is invalid, or a file is to be written where none can be.
    #[error("{}", with_hint(.0))]
    Data(FormatError),
    /// The system could not write a file.
    #[error(transparent)]
    Write(FormatError),
    /// A figure could not be converted to PNG.
    #[error("error: {0}")]
    Png(#[from] papilio_figures::PngError),
    /// The scene could not be computed.
    #[error("error: {}", papilio_scenario::text_of(.0, papilio_scenario::Interface::CommandLine))]
    Display(#[from] papilio_display::DisplayError),
    /// A design could not be evaluated.
    #[error("error: {0}")]
    Design(papilio_design::DesignError),
    /// The reproduction report could not be computed.
    #[error("error: {0}")]
    Report(ReproductionError),
    /// The system lacks what a command needs.
    #[error("error: {0}")]
    System(String),
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

/// The message of a data file; that of one that cannot be read says which was probably meant.
fn with_hint(error: &FormatError) -> String {
    let mut wrong = error.problem.diagnostic();
    if let (Problem::Unreadable { .. }, None) = (&error.problem, &wrong.hint) {
        let hint = match near_file(Path::new(&error.place.name), "") {
            Some(near) => format!("did you mean `{}`?", near.display()),
            None => "give the path of the file, from the current folder or from the root".to_owned(),
        };
        wrong = wrong.expected("a file that exists").hint(hint);
    }
    wrong.at(&error.place).to_string()
}

impl Failure {
    /// Failure of a computation, with its place in the scenario if a key caused it.
    pub(crate) fn from_display(
        resolved: &papilio_scenario::Resolved,
        error: papilio_display::DisplayError,
    ) -> Self {
        resolved.located(&error).map_or(Self::Display(error), Self::Scenario)
    }

    /// Failure of one of many designs or points, which `note` identifies.
    pub(crate) fn of_one(error: impl Into<papilio_design::DesignError>, note: &str) -> Self {
        match error.into() {
            papilio_design::DesignError::Scenario(errors) => Self::Scenario(errors.with_note(note)),
            other => Self::Input(format!("{other}\n  = note: {note}")),
        }
    }

    /// Failure to write into a folder; `what` says what cannot be done, with its path.
    pub(crate) fn of_folder(folder: &Path, what: &str, error: &std::io::Error) -> Self {
        match is_of_place(error) {
            true => Self::Input(format!("{what}: {error}\n  = help: choose another folder with --out DIR")),
            false => unwritable(folder, error).into(),
        }
    }

    /// Whether the system fails, so that the same command fails for any input.
    pub(crate) fn is_of_system(&self) -> bool {
        matches!(self, Self::Write(_) | Self::Io(_) | Self::System(_))
    }

    pub(crate) fn exit_code(&self) -> u8 {
        match self {
            Self::Scenario(_)
            | Self::Input(_)
            | Self::Data(_)
            | Self::Display(_)
            | Self::Design(_)
            | Self::Serve(_) => 2,
            Self::Write(_) | Self::Png(_) | Self::Io(_) | Self::Report(_) | Self::System(_) => 1,
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

impl From<FormatError> for Failure {
    /// A file that the system cannot write anywhere is its failure; any other problem of a file is invalid input.
    fn from(error: FormatError) -> Self {
        match error.problem {
            Problem::Unwritable { is_of_place: false, .. } => Self::Write(error),
            _ => Self::Data(error),
        }
    }
}

impl From<ReproductionError> for Failure {
    /// Files and folders fail as those of all commands.
    fn from(error: ReproductionError) -> Self {
        match error {
            ReproductionError::File(error) => error.into(),
            ReproductionError::Folder(folder, error) => Self::of_folder(
                &folder,
                &format!("the folder {} cannot be created", folder.display()),
                &error,
            ),
            other => Self::Report(other),
        }
    }
}
