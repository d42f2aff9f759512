//! Files that a command has read: its results are not written over them.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use papilio_diagnostics::{Diagnostic, Remedy};

use crate::error::FormatError;
use crate::file::DataFile;

/// The inputs of the command of this process; `None` in programs that run many.
static INPUTS: Mutex<Option<BTreeSet<PathBuf>>> = Mutex::new(None);

/// Protects what is read from now on by [`open_input`]: for programs that run one command.
pub fn protect_inputs() {
    *INPUTS.lock().unwrap_or_else(PoisonError::into_inner) = Some(BTreeSet::new());
}

/// Reads a file of the user's data, as [`DataFile::open_within`].
///
/// # Errors
/// Those of [`DataFile::open_within`].
pub fn open_input(path: &Path, name: &str, limit: u64) -> Result<DataFile, FormatError> {
    let file = DataFile::open_within(path, name, limit)?;
    let mut inputs = INPUTS.lock().unwrap_or_else(PoisonError::into_inner);
    if let (Some(inputs), Ok(path)) = (&mut *inputs, path.canonicalize()) {
        inputs.insert(path);
    }
    Ok(file)
}

/// Returns whether a path is an input of this command, by whatever name.
pub fn is_input(path: &Path) -> bool {
    let inputs = INPUTS.lock().unwrap_or_else(PoisonError::into_inner);
    let (Some(inputs), Ok(path)) = (&*inputs, path.canonicalize()) else { return false };
    inputs.contains(&path)
}

/// Fails if a result would be written over an input.
pub(crate) fn check_output(path: &Path) -> Result<(), FormatError> {
    if !is_input(path) {
        return Ok(());
    }
    let wrong = Diagnostic::new("this file is an input of the command, and no result is written over it");
    let hint = "give the input another name, or choose another folder for results";
    let remedy = Remedy::OnCommandLine("--out FOLDER".to_owned());
    Err(FormatError::whole(&path.display().to_string(), wrong.hint(hint).remedy(remedy)))
}
