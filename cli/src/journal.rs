//! Journals as commands use them: what is wrong with one is the user's, and a folder without any is asked for by its name.

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use papilio_formats::{JournalRows, Journals, RowsHead, read_journals};
use serde::de::DeserializeOwned;

use crate::{Failure, say};

/// All journals of this stem in a folder; without lines where the head is not `wanted`.
pub(crate) fn read_all<H: DeserializeOwned, L: DeserializeOwned>(
    folder: &Path,
    stem: &str,
    wanted: impl Fn(&H) -> bool,
) -> Result<Journals<H, L>, Failure> {
    check_folder(folder, stem)?;
    Ok(read_journals(folder, stem, wanted)?)
}

/// Whether a folder can have journals of this stem.
pub(crate) fn check_folder(folder: &Path, stem: &str) -> Result<(), Failure> {
    let command = stem.split('-').next().unwrap_or(stem);
    let unreadable = |error: std::io::Error| {
        let why = match error.kind() {
            ErrorKind::NotFound => "is not there".to_owned(),
            ErrorKind::NotADirectory => "is not a folder".to_owned(),
            _ => format!("cannot be read: {error}"),
        };
        Failure::Input(format!(
            "{} {why}\n  = help: expected a folder that `papilio {command} FILE --out DIR` wrote a journal into",
            folder.display()
        ))
    };
    fs::read_dir(folder).map(drop).map_err(unreadable)
}

/// A light journal in a folder; what is in these other folders is known, too.
pub(crate) fn open_rows<H: RowsHead>(
    folder: &Path,
    stem: &str,
    part: Option<(usize, usize)>,
    head: H,
    others: &[PathBuf],
) -> Result<JournalRows<H>, Failure> {
    others.iter().try_for_each(|other| check_folder(other, stem))?;
    let rows = JournalRows::open(folder, stem, part, head, others)?;
    tell_of(rows.set_aside());
    Ok(rows)
}

/// Says where the journal of something else is that was in the way.
pub(crate) fn tell_of(set_aside: Option<&Path>) {
    if let Some(path) = set_aside {
        say(&format!(
            "what was done here before this scenario was changed is kept as {}: the scenario as it was goes on from there",
            path.display()
        ));
    }
}
