//! Access to the journals of a folder. Errors of journals are reported as invalid input.

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use papilio_formats::{JournalRows, Journals, RowsHead, read_journals};
use serde::de::DeserializeOwned;

use crate::{Failure, print_message};

/// Reads all journals in a folder whose names begin with `stem`. Journals whose head is not `wanted` have no
/// lines.
pub(crate) fn read_all<H: DeserializeOwned, L: DeserializeOwned>(
    folder: &Path,
    stem: &str,
    wanted: impl Fn(&H) -> bool,
) -> Result<Journals<H, L>, Failure> {
    check_folder(folder, stem)?;
    Ok(read_journals(folder, stem, wanted)?)
}

/// Fails if a folder of journals cannot be read.
pub(crate) fn check_folder(folder: &Path, stem: &str) -> Result<(), Failure> {
    let command = stem.split('-').next().unwrap_or(stem);
    let unreadable = |error: std::io::Error| {
        let reason = match error.kind() {
            ErrorKind::NotFound => "does not exist".to_owned(),
            ErrorKind::NotADirectory => "is not a folder".to_owned(),
            _ => format!("cannot be read: {error}"),
        };
        Failure::Input(format!(
            "{} {reason}\n  = help: expected a folder with a journal of `papilio {command} FILE --out DIR`",
            folder.display()
        ))
    };
    fs::read_dir(folder).map(drop).map_err(unreadable)
}

/// Opens a journal of rows in a folder, and reads those in other folders.
pub(crate) fn open_rows<H: RowsHead>(
    folder: &Path,
    stem: &str,
    part: Option<(usize, usize)>,
    head: H,
    others: &[PathBuf],
) -> Result<JournalRows<H>, Failure> {
    others.iter().try_for_each(|other| check_folder(other, stem))?;
    let rows = JournalRows::open(folder, stem, part, head, others)?;
    report_moved(rows.set_aside());
    Ok(rows)
}

/// Prints the new name of a previous journal that belongs to another form of the scenario.
pub(crate) fn report_moved(set_aside: Option<&Path>) {
    if let Some(path) = set_aside {
        print_message(&format!(
            "note: the scenario has changed; the previous journal was moved to {} and is used again if the change is undone",
            path.display()
        ));
    }
}
