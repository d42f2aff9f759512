//! The journals in a folder.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use papilio_diagnostics::Diagnostic;
use serde::de::DeserializeOwned;

use super::{Journal, LARGEST_JOURNAL, Lines, read_journal};
use crate::error::{FormatError, Problem};
use crate::file::DataFile;

/// Returns the file name of a journal: of the whole computation, or of shard K of N.
pub fn journal_name(stem: &str, shard: Option<(usize, usize)>) -> String {
    shard.map_or(format!("{stem}.jsonl"), |(k, n)| format!("{stem}.{k}-of-{n}.jsonl"))
}

/// Journals with their paths.
pub type Journals<H, L> = Vec<(PathBuf, Journal<H, L>)>;

/// Reads all journals with a given stem in a folder, in the order of their names. The lines of a journal
/// whose head is not `wanted` are not read.
///
/// # Errors
/// If the folder or a journal cannot be read, or a file is not a journal.
pub fn read_journals<H: DeserializeOwned, L: DeserializeOwned>(
    folder: &Path,
    stem: &str,
    wanted: impl Fn(&H) -> bool,
) -> Result<Journals<H, L>, FormatError> {
    let paths = journal_paths(folder, stem)?.into_iter();
    paths.map(|path| open_journal(&path, &wanted).map(|journal| (path, journal))).collect()
}

/// Returns the paths of the journals with a given stem in a folder, in the order of their names.
///
/// # Errors
/// If the folder cannot be read.
pub fn journal_paths(folder: &Path, stem: &str) -> Result<Vec<PathBuf>, FormatError> {
    let unreadable = |error: io::Error| {
        let problem = Problem::Unreadable { reason: error.to_string() };
        FormatError::whole(&folder.display().to_string(), problem)
    };
    let mut paths = Vec::new();
    for entry in fs::read_dir(folder).map_err(unreadable)? {
        let path = entry.map_err(unreadable)?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        if name.starts_with(&format!("{stem}.")) && name.ends_with(".jsonl") {
            paths.push(path);
        }
    }
    paths.sort();
    Ok(paths)
}

/// Reads the journal at a path. Its lines are not read if its head is not `wanted`.
///
/// # Errors
/// As [`read_journal`], and if there is no such file.
pub fn open_journal<H: DeserializeOwned, L: DeserializeOwned>(
    path: &Path,
    wanted: impl Fn(&H) -> bool,
) -> Result<Journal<H, L>, FormatError> {
    DataFile::open_within(path, &path.display().to_string(), LARGEST_JOURNAL)
        .and_then(|file| read_journal(&file, wanted))
}

/// Returns the error for a journal of a different computation.
pub fn foreign_journal_error(path: &Path) -> FormatError {
    let wrong = Diagnostic::new(
        "this journal belongs to a different scenario, different input files or a different version of Papilio",
    );
    let hint = "compute all shards from the same scenario file with the same values of keys";
    FormatError::whole(&path.display().to_string(), wrong.hint(hint))
}

/// Passes each line of a journal to `take` if the journal has this head. Returns the bytes of its complete
/// lines, head included, or 0 if the head differs.
///
/// # Errors
/// If the journal cannot be read, a line is damaged, or `take` returns `false`.
pub fn read_verified_lines<H: PartialEq + DeserializeOwned>(
    path: &Path,
    head: &H,
    mut take: impl FnMut(&str) -> bool,
) -> Result<usize, FormatError> {
    let read = DataFile::open_within(path, &path.display().to_string(), LARGEST_JOURNAL)?;
    let mut whole = 0;
    for line in Lines::of(&read) {
        if whole == 0 {
            if line.read::<H>()? != *head {
                break;
            }
        } else {
            line.check()?;
            if !take(&String::from_utf8_lossy(line.bytes)) {
                return Err(line.damaged("it is not a record of a finished result".to_owned()));
            }
        }
        whole += line.bytes.len();
    }
    Ok(whole)
}

/// Returns whether a journal has this head.
///
/// # Errors
/// If the journal cannot be read.
pub(super) fn has_head<H: PartialEq + DeserializeOwned>(path: &Path, head: &H) -> Result<bool, FormatError> {
    let read = DataFile::open_within(path, &path.display().to_string(), LARGEST_JOURNAL)?;
    Lines::of(&read).next().map_or(Ok(false), |line| Ok(line.read::<H>()? == *head))
}
