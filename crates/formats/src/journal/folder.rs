//! Journals in a folder: what is done already, each held by one program at a time.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, BufRead, BufReader};
use std::path::{Path, PathBuf};

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::{Journal, LARGEST_JOURNAL, read_journal, write_journal_line};
use crate::error::{FormatError, Problem};
use crate::file::{DataFile, write_file};
use crate::place::Place;

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

fn write_journal<L: Serialize>(
    path: &Path,
    head: &impl Serialize,
    mut lines: impl Iterator<Item = L>,
) -> Result<(), FormatError> {
    write_file(path, |mut out| {
        write_journal_line(&mut out, head)?;
        lines.try_for_each(|line| write_journal_line(&mut out, &line))
    })
}

fn lock(path: &Path) -> Result<File, FormatError> {
    let file =
        OpenOptions::new().create(true).append(true).open(path).map_err(|error| unwritable(path, &error))?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => {
            Err(FormatError { place: Place::whole(&path.display().to_string()), problem: Problem::Busy })
        }
        Err(TryLockError::Error(error)) => Err(unwritable(path, &error)),
    }
}

/// A journal that is of something else.
pub fn foreign(path: &Path) -> FormatError {
    FormatError { place: Place::whole(&path.display().to_string()), problem: Problem::ForeignJournal }
}

fn unwritable(path: &Path, error: &io::Error) -> FormatError {
    let problem = Problem::Unwritable { reason: error.to_string() };
    FormatError { place: Place::whole(&path.display().to_string()), problem }
}

/// A journal that no other program can add to until it is closed.
#[derive(Debug)]
pub struct HeldJournal {
    path: PathBuf,
    file: File,
    set_aside: Option<PathBuf>,
}

impl HeldJournal {
    /// Holds a journal, or an empty file if there is none.
    ///
    /// # Errors
    /// [`Problem::Busy`] if another program has it; those of the system.
    pub fn hold(path: PathBuf) -> Result<Self, FormatError> {
        Ok(Self { file: lock(&path)?, path, set_aside: None })
    }

    /// Holds a journal that goes on, or begins anew if it has another head; one that has is set aside ([`set_aside`](Self::set_aside)). `take` gets every whole line after the head; the
    /// first one that it refuses ends what can be trusted, and is cut off.
    ///
    /// # Errors
    /// As [`hold`](Self::hold), and if it cannot be read.
    pub fn open<H: PartialEq + Serialize + DeserializeOwned>(
        path: PathBuf,
        head: &H,
        take: impl FnMut(&str) -> bool,
    ) -> Result<Self, FormatError> {
        let mut held = Self::hold(path)?;
        held.make_way(|path| Ok(trusted_lines(path, head, |_| false)? > 0))?;
        let whole = trusted_lines(&held.path, head, take)?;
        held.cut(whole)?;
        if whole == 0 {
            held.add(head)?;
        }
        Ok(held)
    }

    /// Makes way for a journal that `is_ours`. One of something else is set aside if anything is done in it: it changes its name, from
    /// `NAME` to `NAME.before`, where one is kept. That one comes back if it is ours: a change that is taken back costs nothing.
    pub(super) fn make_way(
        &mut self,
        is_ours: impl Fn(&Path) -> Result<bool, FormatError>,
    ) -> Result<(), FormatError> {
        let failed = |error: io::Error| unwritable(&self.path, &error);
        let lines = BufReader::new(File::open(&self.path).map_err(failed)?).split(b'\n').take(2).count();
        if lines == 0 || is_ours(&self.path)? {
            return Ok(());
        }
        let [before, back] = [".before", ".back"].map(|end| {
            let mut name = self.path.clone().into_os_string();
            name.push(end);
            PathBuf::from(name)
        });
        // What cannot be read there is not ours.
        let comes_back = before.is_file() && is_ours(&before).unwrap_or(false);
        if comes_back {
            fs::rename(&before, &back).map_err(failed)?;
        }
        if lines > 1 {
            fs::rename(&self.path, &before).map_err(failed)?;
        }
        if comes_back {
            fs::rename(&back, &self.path).map_err(failed)?;
        }
        if comes_back || lines > 1 {
            self.file = lock(&self.path)?;
        }
        self.set_aside = (lines > 1).then_some(before);
        Ok(())
    }

    /// Where the journal of something else is now that was here.
    pub fn set_aside(&self) -> Option<&Path> {
        self.set_aside.as_deref()
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Cuts off what comes after so many bytes.
    ///
    /// # Errors
    /// Those of the system.
    pub fn cut(&mut self, bytes: usize) -> Result<(), FormatError> {
        self.file.set_len(bytes as u64).map_err(|error| unwritable(&self.path, &error))
    }

    /// Keeps a line: with the system before this returns.
    ///
    /// # Errors
    /// Those of the system.
    pub fn add(&mut self, line: &impl Serialize) -> Result<(), FormatError> {
        write_journal_line(&mut self.file, line).map_err(|error| unwritable(&self.path, &error))
    }

    /// Begins it anew, with these lines, to go on from there.
    ///
    /// # Errors
    /// Those of the system; the old one stays then.
    pub fn begin<L: Serialize>(
        &mut self,
        head: &impl Serialize,
        lines: impl Iterator<Item = L>,
    ) -> Result<(), FormatError> {
        write_journal(&self.path, head, lines)?;
        self.file = lock(&self.path)?;
        Ok(())
    }

    /// Puts it in order at the end: these lines, and nothing else.
    ///
    /// # Errors
    /// Those of the system; the old one stays then.
    pub fn finish<L: Serialize>(
        &self,
        head: &impl Serialize,
        lines: impl Iterator<Item = L>,
    ) -> Result<(), FormatError> {
        write_journal(&self.path, head, lines)
    }
}

/// Hands the lines of a journal to `take` if it has this head, until one is refused; the bytes up to there, its head included.
///
/// # Errors
/// If it cannot be read.
pub fn trusted_lines<H: PartialEq + DeserializeOwned>(
    path: &Path,
    head: &H,
    mut take: impl FnMut(&str) -> bool,
) -> Result<usize, FormatError> {
    let read = DataFile::open_within(path, &path.display().to_string(), LARGEST_JOURNAL)?;
    let mut whole = 0;
    for line in read.bytes.split_inclusive(|byte| *byte == b'\n').take_while(|line| line.ends_with(b"\n")) {
        let text = String::from_utf8_lossy(line);
        let is_good = match whole {
            0 => serde_json::from_str::<H>(&text).is_ok_and(|own| own == *head),
            _ => take(&text),
        };
        if !is_good {
            break;
        }
        whole += line.len();
    }
    Ok(whole)
}
