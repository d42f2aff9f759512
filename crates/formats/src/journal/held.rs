//! Journals that a single program writes at a time.
//!
//! A lock belongs to a file, not to its name. A file that replaces a journal is therefore locked *before* it
//! gets the name, and a program that has locked a file checks whether the file still has the name. Of several
//! programs that start at the same time, one gets the journal, and the others get [`Problem::Busy`].

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, BufRead, BufReader, BufWriter, Write};
use std::path::{Path, PathBuf};

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::folder::has_head;
use super::{read_verified_lines, write_journal_line, write_row};
use crate::error::{FormatError, Problem};
use crate::file::unwritable;
use crate::temporary::{Temporary, has_name};

/// A locked journal: no other program can write it until it is closed.
#[derive(Debug)]
pub struct LockedJournal {
    path: PathBuf,
    file: File,
    set_aside: Option<PathBuf>,
}

impl LockedJournal {
    /// Locks a journal; creates an empty file if there is none.
    ///
    /// # Errors
    /// [`Problem::Busy`] if another program has locked it; errors of the system.
    pub fn hold(path: PathBuf) -> Result<Self, FormatError> {
        Ok(Self { file: lock(&path)?, path, set_aside: None })
    }

    /// Locks a journal to resume it. A journal with a different head is set aside
    /// ([`set_aside`](Self::set_aside)), and a new one is created. `take` gets every complete line after the
    /// head.
    ///
    /// # Errors
    /// As [`hold`](Self::hold), and if the journal cannot be read, a line is damaged, or `take` returns
    /// `false`.
    pub fn open<H: PartialEq + Serialize + DeserializeOwned>(
        path: PathBuf,
        head: &H,
        take: impl FnMut(&str) -> bool,
    ) -> Result<Self, FormatError> {
        let mut held = Self::hold(path)?;
        held.make_way(|path| has_head(path, head))?;
        let whole = read_verified_lines(&held.path, head, take)?;
        held.cut(whole)?;
        if whole == 0 {
            held.add(head)?;
        }
        Ok(held)
    }

    /// Makes room for a journal that `is_ours`. A journal of a different computation is set aside if it has
    /// results: it is renamed from `NAME` to `NAME.before`, of which there is at most one. If the previous
    /// `NAME.before` is ours, it becomes `NAME` again: undoing a change of the scenario loses no results.
    pub(super) fn make_way(
        &mut self,
        is_ours: impl Fn(&Path) -> Result<bool, FormatError>,
    ) -> Result<(), FormatError> {
        let [before, aside] = ["before", "aside"].map(|suffix| with_suffix(&self.path, suffix));
        // A program was killed between the two renamings below.
        if aside.is_file() && !before.exists() {
            fs::rename(&aside, &before).map_err(|error| unwritable(&aside, &error))?;
        }
        let failed = |error: io::Error| unwritable(&self.path, &error);
        let lines = BufReader::new(File::open(&self.path).map_err(failed)?).split(b'\n').take(2).count();
        if lines == 0 || is_ours(&self.path)? {
            return Ok(());
        }
        // A journal that cannot be read is not ours.
        let is_restored = before.is_file() && is_ours(&before).unwrap_or(false);
        if lines > 1 {
            // A second name for the same file: the first name always has a file. Otherwise another program
            // could create and lock one.
            let _ = fs::remove_file(&aside);
            fs::hard_link(&self.path, &aside)
                .or_else(|_| fs::copy(&self.path, &aside).map(drop))
                .map_err(failed)?;
        }
        if is_restored {
            let file = locked(&before, OpenOptions::new().append(true))?;
            fs::rename(&before, &self.path).map_err(failed)?;
            self.file = file;
        }
        if lines > 1 {
            fs::rename(&aside, &before).map_err(failed)?;
            self.set_aside = Some(before);
        }
        if !is_restored {
            // A new file: the old one has the other name.
            self.replace(|_| Ok(()))?;
        }
        Ok(())
    }

    /// Returns the path to which a journal of a different computation was moved, if there was one.
    pub fn set_aside(&self) -> Option<&Path> {
        self.set_aside.as_deref()
    }

    /// Returns the path of the journal.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Truncates the journal to a number of bytes.
    ///
    /// # Errors
    /// Those of the system.
    pub fn cut(&mut self, bytes: usize) -> Result<(), FormatError> {
        self.file.set_len(bytes as u64).map_err(|error| unwritable(&self.path, &error))
    }

    /// Appends a line. The operating system has it before this function returns.
    ///
    /// # Errors
    /// Those of the system.
    pub fn add(&mut self, line: &impl Serialize) -> Result<(), FormatError> {
        write_journal_line(&mut self.file, line).map_err(|error| unwritable(&self.path, &error))
    }

    /// Appends a row of numbers, as [`add`](Self::add).
    pub(super) fn add_row(&mut self, row: usize, values: &[f64]) -> Result<(), FormatError> {
        write_row(&mut self.file, row, values).map_err(|error| unwritable(&self.path, &error))
    }

    /// Replaces the content of the journal by a head and lines, to continue from them, or to sort the journal
    /// at the end.
    ///
    /// # Errors
    /// Those of the system; the previous content remains.
    pub fn put<L: Serialize>(
        &mut self,
        head: &impl Serialize,
        mut lines: impl Iterator<Item = L>,
    ) -> Result<(), FormatError> {
        self.replace(|mut out| {
            write_journal_line(&mut out, head)?;
            lines.try_for_each(|line| write_journal_line(&mut out, &line))
        })
    }

    /// Replaces the file by a new one, which is locked before it gets the name.
    fn replace(&mut self, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), FormatError> {
        let failed = |error: io::Error| unwritable(&self.path, &error);
        let new = Temporary::of(&self.path).map_err(failed)?;
        let mut out = BufWriter::new(&new.file);
        let written = write(&mut out).and_then(|()| out.flush());
        drop(out);
        if let Err(error) = written {
            new.delete();
            return Err(failed(error));
        }
        let file = new.rename(&self.path).map_err(failed)?;
        self.file = file;
        Ok(())
    }
}

/// How often other programs may replace the file while it is being locked.
const MOST_CHANGES: usize = 1000;

/// Opens and locks the file of a name; creates it if there is none.
fn lock(path: &Path) -> Result<File, FormatError> {
    for _ in 0..MOST_CHANGES {
        let file = locked(path, OpenOptions::new().create(true).append(true))?;
        if has_name(&file, path) {
            return Ok(file);
        }
    }
    Err(busy(path))
}

fn locked(path: &Path, options: &OpenOptions) -> Result<File, FormatError> {
    let file = options.open(path).map_err(|error| unwritable(path, &error))?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => Err(busy(path)),
        Err(TryLockError::Error(error)) => Err(unwritable(path, &error)),
    }
}

fn with_suffix(path: &Path, suffix: &str) -> PathBuf {
    let mut name = path.to_owned().into_os_string();
    name.push(".");
    name.push(suffix);
    PathBuf::from(name)
}

fn busy(path: &Path) -> FormatError {
    FormatError::whole(&path.display().to_string(), Problem::Busy)
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

    use serde::Deserialize;

    use super::*;

    #[derive(Debug, PartialEq, Serialize, Deserialize)]
    struct Head {
        of: usize,
    }

    #[derive(Serialize)]
    struct Line {
        line: usize,
    }

    /// Several threads with two heads set each other's journal aside: one holds the journal at a time, all
    /// others get an error, and no line is lost.
    #[test]
    fn journal_used_by_several_threads_has_one_holder_and_loses_no_line() {
        const THREADS: usize = 4;
        const FEWEST_ROUNDS: usize = 150;
        const MOST_ROUNDS: usize = 100_000;
        const FEWEST_LINES: usize = 10;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sweep.jsonl");
        let (held, counts) = (AtomicBool::new(false), [const { AtomicUsize::new(0) }; 2]);
        // On a busy machine, threads rarely find the journal free in a small number of rounds.
        let is_enough = || counts.iter().all(|count| count.load(Ordering::SeqCst) > FEWEST_LINES);
        std::thread::scope(|scope| {
            for thread in 0..THREADS {
                let (path, held, counts, is_enough) = (&path, &held, &counts, &is_enough);
                scope.spawn(move || {
                    for round in 0..MOST_ROUNDS {
                        if round >= FEWEST_ROUNDS && is_enough() {
                            break;
                        }
                        let of = (thread + round / 2) % 2;
                        let head = Head { of };
                        let mut lines = vec![];
                        let opened = LockedJournal::open(path.clone(), &head, |line| {
                            lines.push(line.trim_end().to_owned());
                            true
                        });
                        match opened {
                            Ok(mut journal) => {
                                assert!(!held.swap(true, Ordering::SeqCst), "two threads hold the journal");
                                let number = counts[of].fetch_add(1, Ordering::SeqCst);
                                assert_eq!(lines.len(), number, "lines were lost");
                                journal.add(&Line { line: number }).unwrap();
                                if number % 3 == 0 {
                                    journal.put(&head, (0..=number).map(|line| Line { line })).unwrap();
                                }
                                held.store(false, Ordering::SeqCst);
                            }
                            Err(error) => assert_eq!(error.problem, Problem::Busy, "{error}"),
                        }
                    }
                });
            }
        });
        assert!(is_enough(), "{counts:?}");
        let names: Vec<_> =
            fs::read_dir(folder.path()).unwrap().map(|one| one.unwrap().file_name()).collect();
        assert_eq!(names.len(), 2, "{names:?}");
    }
}
