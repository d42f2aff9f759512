//! Journals in a folder: what is done already.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use papilio_diagnostics::Place;
use serde::de::DeserializeOwned;

use super::{Journal, LARGEST_JOURNAL, Lines, read_journal};
use crate::error::{FormatError, Problem};
use crate::file::DataFile;

/// The name of a journal: that of the whole, or of part K of N.
pub fn journal_name(stem: &str, part: Option<(usize, usize)>) -> String {
    part.map_or(format!("{stem}.jsonl"), |(k, n)| format!("{stem}.{k}-of-{n}.jsonl"))
}

/// Journals, and where they are.
pub type Journals<H, L> = Vec<(PathBuf, Journal<H, L>)>;

/// All journals of this stem in a folder, in the order of their names, and where they are; without lines where the
/// head is not `wanted`.
///
/// # Errors
/// If the folder or one of them cannot be read, or is none.
pub fn read_journals<H: DeserializeOwned, L: DeserializeOwned>(
    folder: &Path,
    stem: &str,
    wanted: impl Fn(&H) -> bool,
) -> Result<Journals<H, L>, FormatError> {
    let paths = journal_paths(folder, stem)?.into_iter();
    paths.map(|path| open_journal(&path, &wanted).map(|journal| (path, journal))).collect()
}

/// Where the journals of this stem are in a folder, in the order of their names.
///
/// # Errors
/// If the folder cannot be read.
pub fn journal_paths(folder: &Path, stem: &str) -> Result<Vec<PathBuf>, FormatError> {
    let unreadable = |error: io::Error| {
        let problem = Problem::Unreadable { reason: error.to_string() };
        FormatError { place: Place::whole(&folder.display().to_string()), problem }
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

/// A journal of this path; without lines where the head is not `wanted`.
///
/// # Errors
/// As [`read_journal`], and if there is none.
pub fn open_journal<H: DeserializeOwned, L: DeserializeOwned>(
    path: &Path,
    wanted: impl Fn(&H) -> bool,
) -> Result<Journal<H, L>, FormatError> {
    DataFile::open_within(path, &path.display().to_string(), LARGEST_JOURNAL)
        .and_then(|file| read_journal(&file, wanted))
}

/// Takes away what a program that was killed had begun to write in the place of its journal, table and figures (names
/// that begin with one of these): the lock says that it does so no more.
pub fn tidy_journals(folder: &Path, beginnings: &[&str]) {
    let begun = |file: &str| {
        let of = file.strip_prefix('.').filter(|_| file.ends_with(".tmp"));
        of.is_some_and(|of| beginnings.iter().any(|beginning| of.starts_with(beginning)))
    };
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    for entry in entries.filter(|entry| entry.file_name().to_str().is_some_and(begun)) {
        // What cannot be taken away does no harm.
        let _ = fs::remove_file(entry.path());
    }
}

/// A journal that is of something else.
pub fn foreign(path: &Path) -> FormatError {
    FormatError { place: Place::whole(&path.display().to_string()), problem: Problem::ForeignJournal }
}

/// Hands the lines of a journal to `take` if it has this head; the bytes of its whole lines, its head included, or 0.
///
/// # Errors
/// If it cannot be read; a line that is not as it was written, or that `take` refuses.
pub fn trusted_lines<H: PartialEq + DeserializeOwned>(
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
                return Err(line.broken("it is no record of what was done".to_owned()));
            }
        }
        whole += line.bytes.len();
    }
    Ok(whole)
}

/// Whether a journal has this head.
///
/// # Errors
/// If it cannot be read.
pub(super) fn has_head<H: PartialEq + DeserializeOwned>(path: &Path, head: &H) -> Result<bool, FormatError> {
    let read = DataFile::open_within(path, &path.display().to_string(), LARGEST_JOURNAL)?;
    Lines::of(&read).next().map_or(Ok(false), |line| Ok(line.read::<H>()? == *head))
}
