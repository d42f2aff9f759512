//! The journal in a folder: what is done already, kept line by line, and held by one program at a time.

use std::collections::HashMap;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use papilio_formats::{
    DataFile, FormatError, LARGEST_JOURNAL, Place, Problem, SweepHead, SweepJournal, SweepPoint, read_sweep,
    write_file, write_sweep_line,
};

use crate::Failure;

/// Points by the hash of their scenario, and where new ones go.
#[derive(Debug)]
pub(super) struct Journal {
    path: PathBuf,
    file: File,
    head: SweepHead,
    known: HashMap<String, SweepPoint>,
}

/// The name of a journal: that of the whole sweep, or of a part of it.
pub(super) fn name(shard: Option<(usize, usize)>) -> String {
    shard.map_or("sweep.jsonl".to_owned(), |(k, n)| format!("sweep.{k}-of-{n}.jsonl"))
}

/// All journals in a folder, in the order of their names, and where they are.
pub(super) fn read_all(folder: &Path) -> Result<Vec<(PathBuf, SweepJournal)>, Failure> {
    let unreadable = |error: std::io::Error| {
        let why = match error.kind() {
            ErrorKind::NotFound => "is not there".to_owned(),
            ErrorKind::NotADirectory => "is not a folder".to_owned(),
            _ => format!("cannot be read: {error}"),
        };
        Failure::Input(format!(
            "{} {why}\n  = help: expected a folder that `papilio sweep FILE --out DIR` wrote a journal into",
            folder.display()
        ))
    };
    let mut paths = Vec::new();
    for entry in fs::read_dir(folder).map_err(unreadable)? {
        let path = entry.map_err(unreadable)?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        if name.starts_with("sweep.") && name.ends_with(".jsonl") {
            paths.push(path);
        }
    }
    paths.sort();
    paths.into_iter().map(|path| read(&path).map(|journal| (path, journal))).collect()
}

fn read(path: &Path) -> Result<SweepJournal, Failure> {
    let file = DataFile::open_within(path, &path.display().to_string(), LARGEST_JOURNAL);
    file.and_then(|file| read_sweep(&file)).map_err(Failure::Data)
}

impl Journal {
    /// Opens a sweep's journal in a folder, or begins one. Points of other journals there, and of other forms of
    /// the sweep, are known, too.
    pub(super) fn open(folder: &Path, name: &str, head: SweepHead) -> Result<Self, Failure> {
        let path = folder.join(name);
        let mut file = locked(&path)?;
        tidy(folder, name);
        let mut known = HashMap::new();
        for (_, journal) in read_all(folder)? {
            let own = journal.points.into_iter().filter(|point| point.papilio == head.papilio);
            known.extend(own.map(|point| (point.hash.clone(), point)));
        }
        let mine = read(&path)?;
        if mine.head.as_ref() == Some(&head) {
            file.set_len(mine.whole as u64).map_err(|error| unwritable(&path, &error))?;
        } else {
            // An earlier form of the sweep, or nothing yet. Points stay, but their numbers mean nothing now.
            let kept = mine.points.into_iter().map(|point| SweepPoint { point: None, ..point });
            write_lines(&path, &head, kept)?;
            file = locked(&path)?;
        }
        Ok(Self { path, file, head, known })
    }

    /// What is known of a scenario.
    pub(super) fn find(&self, hash: &str) -> Option<&SweepPoint> {
        self.known.get(hash)
    }

    /// Hashes of all that is known.
    pub(super) fn hashes(&self) -> std::collections::HashSet<String> {
        self.known.keys().cloned().collect()
    }

    /// Keeps a point: on the disk before this returns.
    pub(super) fn add(&mut self, point: SweepPoint) -> Result<(), Failure> {
        write_sweep_line(&mut self.file, &point).map_err(|error| unwritable(&self.path, &error))?;
        self.known.insert(point.hash.clone(), point);
        Ok(())
    }

    /// Puts the journal in order: the points of the sweep first, by their numbers; then what else is known from it.
    pub(super) fn finish(self, points: &[(usize, String)]) -> Result<(), Failure> {
        let in_order = points.iter().filter_map(|(number, hash)| {
            self.known.get(hash).map(|point| SweepPoint { point: Some(*number), ..point.clone() })
        });
        let mut others = read(&self.path)?.points;
        others.retain(|other| points.iter().all(|(_, hash)| *hash != other.hash));
        others.sort_by(|a, b| a.hash.cmp(&b.hash));
        others.dedup_by(|a, b| a.hash == b.hash);
        let others = others.into_iter().map(|point| SweepPoint { point: None, ..point });
        write_lines(&self.path, &self.head, in_order.chain(others))
    }
}

/// Takes away what a program that was killed had begun to write in the place of its journal, table and figures:
/// the lock says that it does so no more.
fn tidy(folder: &Path, name: &str) {
    let begun = |file: &str| {
        let of = file.strip_prefix('.').filter(|_| file.ends_with(".tmp"));
        of.is_some_and(|of| of.starts_with(name) || of.starts_with("sweep.csv.") || of.starts_with("sweep_"))
    };
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    for entry in entries.filter(|entry| entry.file_name().to_str().is_some_and(begun)) {
        // What cannot be taken away does no harm.
        let _ = fs::remove_file(entry.path());
    }
}

/// Opens a journal to add to it; no other program can until it is closed.
fn locked(path: &Path) -> Result<File, Failure> {
    let opened = OpenOptions::new().create(true).append(true).open(path);
    let file = opened.map_err(|error| unwritable(path, &error))?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => Err(Failure::Input(format!(
            "another sweep is writing {}\n  = help: wait for it, or choose another folder with --out DIR",
            path.display()
        ))),
        Err(TryLockError::Error(error)) => Err(unwritable(path, &error)),
    }
}

/// Writes a whole journal in the place of the one that is there.
fn write_lines(
    path: &Path,
    head: &SweepHead,
    mut points: impl Iterator<Item = SweepPoint>,
) -> Result<(), Failure> {
    write_file(path, |mut out| {
        write_sweep_line(&mut out, head)?;
        points.try_for_each(|point| write_sweep_line(&mut out, &point))
    })?;
    Ok(())
}

fn unwritable(path: &Path, error: &std::io::Error) -> Failure {
    let problem = Problem::Unwritable { reason: error.to_string() };
    FormatError { place: Place::whole(&path.display().to_string()), problem }.into()
}
