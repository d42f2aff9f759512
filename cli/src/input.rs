//! Scenarios from a file, or from standard input if the file is `-`.
//!
//! A scenario from standard input has the current folder: its files are relative to it.

use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use papilio_formats::{DataFile, LARGEST_FILE};
use papilio_scenario::{Fit, Optimisation, Scenario, ScenarioErrors, SurfaceScenario, Sweep, Tolerance};

use crate::Failure;

/// Name of standard input on the command line.
const STDIN: &str = "-";

/// Name of standard input in messages and titles.
pub(crate) const STDIN_NAME: &str = "standard input";

/// Returns whether the scenario comes from standard input.
pub(crate) fn is_stdin(file: &Path) -> bool {
    file == Path::new(STDIN)
}

/// Returns the folder of a scenario file.
pub(crate) fn folder(file: &Path) -> PathBuf {
    file.parent().unwrap_or(Path::new("")).to_owned()
}

/// Returns a path as an argument that a user can paste into a shell: in quotes if it contains a character
/// with a meaning there.
pub(crate) fn as_argument(path: &Path) -> String {
    let text = path.display().to_string();
    let is_plain = |c: char| c.is_alphanumeric() || "/\\._-+:@%,=".contains(c);
    if !text.is_empty() && text.chars().all(is_plain) {
        text
    } else if cfg!(windows) {
        // A name of a file contains no double quote there.
        format!("\"{text}\"")
    } else {
        format!("'{}'", text.replace('\'', r"'\''"))
    }
}

/// Returns the file of a scenario. Standard input is read once, and then returned again.
pub(crate) fn file(path: &Path) -> Result<DataFile, Failure> {
    if !is_stdin(path) {
        return DataFile::open(path, &path.display().to_string()).map_err(Failure::Data);
    }
    static TEXT: OnceLock<Result<Vec<u8>, String>> = OnceLock::new();
    let read = || {
        let mut bytes = Vec::new();
        let taken = std::io::stdin().lock().take(LARGEST_FILE).read_to_end(&mut bytes);
        taken.map(|_| bytes).map_err(|error| error.to_string())
    };
    match TEXT.get_or_init(read) {
        Ok(bytes) if bytes.trim_ascii().is_empty() => {
            Err(Failure::Input("standard input is empty\n  = help: expected a scenario (TOML)".to_owned()))
        }
        Ok(bytes) => Ok(DataFile { name: STDIN_NAME.to_owned(), bytes: bytes.clone() }),
        Err(error) => Err(Failure::Input(format!("standard input cannot be read: {error}"))),
    }
}

/// What is read from a scenario file: the scenario itself, or a study.
pub(crate) trait FromScenario: Sized {
    fn load(path: &Path, set: &[String]) -> Result<Self, ScenarioErrors>;
    fn from_text(text: &str, name: &str, folder: &Path, set: &[String]) -> Result<Self, ScenarioErrors>;
}

macro_rules! from_scenario {
    ($($name:ident),*) => {
        $(impl FromScenario for $name {
            fn load(path: &Path, set: &[String]) -> Result<Self, ScenarioErrors> {
                $name::load(path, set)
            }
            fn from_text(text: &str, name: &str, folder: &Path, set: &[String]) -> Result<Self, ScenarioErrors> {
                $name::from_text(text, name, folder, set)
            }
        })*
    };
}
from_scenario!(Scenario, Sweep, Optimisation, Tolerance, Fit, SurfaceScenario);

/// Reads a scenario, or a study, from a file or from standard input.
pub(crate) fn scenario<T: FromScenario>(path: &Path, set: &[String]) -> Result<T, Failure> {
    if !is_stdin(path) {
        return Ok(T::load(path, set)?);
    }
    let file = file(path)?;
    let text = file.text().map_err(Failure::Data)?;
    Ok(T::from_text(text, STDIN_NAME, Path::new(""), set)?)
}
