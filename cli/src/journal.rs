//! Journals in a folder: what is done already, kept line by line, each held by one program at a time.

use std::collections::BTreeMap;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use papilio_formats::{
    DataFile, FormatError, Journal, JournalNumber, JournalRow, LARGEST_JOURNAL, Place, Problem,
    ToleranceHead, read_journal, write_file, write_journal_line,
};
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::Failure;

/// The name of a journal: that of the whole, or of a part of it.
pub(crate) fn name(stem: &str, shard: Option<(usize, usize)>) -> String {
    shard.map_or(format!("{stem}.jsonl"), |(k, n)| format!("{stem}.{k}-of-{n}.jsonl"))
}

/// Journals, and where they are.
pub(crate) type Found<H, L> = Vec<(PathBuf, Journal<H, L>)>;

/// All journals of this stem in a folder, in the order of their names, and where they are; without lines where the
/// head is not `wanted`.
pub(crate) fn read_all<H: DeserializeOwned, L: DeserializeOwned>(
    folder: &Path,
    stem: &str,
    wanted: impl Fn(&H) -> bool,
) -> Result<Found<H, L>, Failure> {
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
    let mut paths = Vec::new();
    for entry in fs::read_dir(folder).map_err(unreadable)? {
        let path = entry.map_err(unreadable)?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        if name.starts_with(&format!("{stem}.")) && name.ends_with(".jsonl") {
            paths.push(path);
        }
    }
    paths.sort();
    paths.into_iter().map(|path| read(&path, &wanted).map(|journal| (path, journal))).collect()
}

/// A journal; without lines where the head is not `wanted`.
pub(crate) fn read<H: DeserializeOwned, L: DeserializeOwned>(
    path: &Path,
    wanted: impl Fn(&H) -> bool,
) -> Result<Journal<H, L>, Failure> {
    let file = DataFile::open_within(path, &path.display().to_string(), LARGEST_JOURNAL);
    file.and_then(|file| read_journal(&file, wanted)).map_err(Failure::Data)
}

/// Takes away what a program that was killed had begun to write in the place of its journal, table and figures (names
/// that begin with one of these): the lock says that it does so no more.
pub(crate) fn tidy(folder: &Path, beginnings: &[&str]) {
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

/// Opens a journal to add to it; no other program can until it is closed.
pub(crate) fn locked(path: &Path) -> Result<File, Failure> {
    let opened = OpenOptions::new().create(true).append(true).open(path);
    let file = opened.map_err(|error| unwritable(path, &error))?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => Err(Failure::Input(format!(
            "another program is writing {}\n  = help: wait for it, or choose another folder with --out DIR",
            path.display()
        ))),
        Err(TryLockError::Error(error)) => Err(unwritable(path, &error)),
    }
}

/// Writes a whole journal in the place of the one that is there.
pub(crate) fn write_lines<L: Serialize>(
    path: &Path,
    head: &impl Serialize,
    mut lines: impl Iterator<Item = L>,
) -> Result<(), Failure> {
    write_file(path, |mut out| {
        write_journal_line(&mut out, head)?;
        lines.try_for_each(|line| write_journal_line(&mut out, &line))
    })?;
    Ok(())
}

pub(crate) fn unwritable(path: &Path, error: &std::io::Error) -> Failure {
    let problem = Problem::Unwritable { reason: error.to_string() };
    FormatError { place: Place::whole(&path.display().to_string()), problem }.into()
}

/// A light journal: rows of numbers by their number, all of one head; a journal of another head begins anew.
#[derive(Debug)]
pub(crate) struct Rows<H> {
    path: PathBuf,
    file: File,
    head: H,
    known: BTreeMap<usize, Vec<f64>>,
}

/// What the rows of a light journal are of.
pub(crate) trait RowsHead: PartialEq + Serialize + DeserializeOwned {
    /// Whether rows of one are rows of the other.
    fn is_of(&self, other: &Self) -> bool;
}

impl RowsHead for ToleranceHead {
    fn is_of(&self, other: &Self) -> bool {
        self == other
    }
}

impl<H: RowsHead> Rows<H> {
    /// Opens or begins it. Rows of other journals of the same head are known, too: of those in its folder, and in these.
    pub(crate) fn open(
        folder: &Path,
        stem: &str,
        shard: Option<(usize, usize)>,
        head: H,
        others: &[PathBuf],
    ) -> Result<Self, Failure> {
        let path = folder.join(name(stem, shard));
        let mut file = locked(&path)?;
        tidy(folder, &[&name(stem, shard), &format!("{stem}.csv."), &format!("{stem}_")]);
        let mut known = BTreeMap::new();
        for folder in [folder].into_iter().chain(others.iter().map(PathBuf::as_path)) {
            for (_, journal) in read_all::<H, JournalRow>(folder, stem, |other| head.is_of(other))? {
                known.extend(journal.lines.into_iter().map(plain));
            }
        }
        let mine: Journal<H, JournalRow> = read(&path, |other| head.is_of(other))?;
        if mine.head.as_ref().is_some_and(|own| head.is_of(own)) {
            file.set_len(mine.whole as u64).map_err(|error| unwritable(&path, &error))?;
        } else {
            write_lines(&path, &head, std::iter::empty::<JournalRow>())?;
            file = locked(&path)?;
        }
        Ok(Self { path, file, head, known })
    }

    /// The numbers of a row, if they are known.
    pub(crate) fn get(&self, row: usize) -> Option<&[f64]> {
        self.known.get(&row).map(Vec::as_slice)
    }

    /// Keeps a row: on the disk before this returns.
    pub(crate) fn add(&mut self, row: usize, values: Vec<f64>) -> Result<(), Failure> {
        let line = line(row, &values);
        write_journal_line(&mut self.file, &line).map_err(|error| unwritable(&self.path, &error))?;
        self.known.insert(row, values);
        Ok(())
    }

    /// Puts the journal in order: these rows, and nothing else.
    pub(crate) fn finish(&self, rows: impl Iterator<Item = usize>) -> Result<(), Failure> {
        let lines = rows.filter_map(|row| self.get(row).map(|values| line(row, values)));
        write_lines(&self.path, &self.head, lines)
    }
}

/// A line as it was kept.
pub(crate) fn plain(line: JournalRow) -> (usize, Vec<f64>) {
    (line.row, line.values.into_iter().map(|one| one.0).collect())
}

fn line(row: usize, values: &[f64]) -> JournalRow {
    JournalRow { row, values: values.iter().copied().map(JournalNumber).collect() }
}
