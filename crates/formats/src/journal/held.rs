//! A journal that one program holds at a time.
//!
//! A lock belongs to a file, not to its name. So a file that takes a journal's place is locked *before* it gets the name, and who has
//! locked a file looks whether it still has the name: of several programs that begin at once, one has the journal, and the others
//! are told.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, BufRead, BufReader, BufWriter, Write};
use std::path::{Path, PathBuf};

use papilio_diagnostics::Place;
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::folder::has_head;
use super::{trusted_lines, write_journal_line};
use crate::error::{FormatError, Problem};

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

    /// Holds a journal that goes on, or begins anew if it has another head; one that has is set aside
    /// ([`set_aside`](Self::set_aside)). `take` gets every whole line after the head.
    ///
    /// # Errors
    /// As [`hold`](Self::hold), and if it cannot be read; a line that is not as it was written, or that `take` refuses.
    pub fn open<H: PartialEq + Serialize + DeserializeOwned>(
        path: PathBuf,
        head: &H,
        take: impl FnMut(&str) -> bool,
    ) -> Result<Self, FormatError> {
        let mut held = Self::hold(path)?;
        held.make_way(|path| has_head(path, head))?;
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
        let [before, aside] = ["before", "aside"].map(|end| with_end(&self.path, end));
        // A program was killed below, between two names.
        if aside.is_file() && !before.exists() {
            fs::rename(&aside, &before).map_err(|error| unwritable(&aside, &error))?;
        }
        let failed = |error: io::Error| unwritable(&self.path, &error);
        let lines = BufReader::new(File::open(&self.path).map_err(failed)?).split(b'\n').take(2).count();
        if lines == 0 || is_ours(&self.path)? {
            return Ok(());
        }
        // What cannot be read there is not ours.
        let comes_back = before.is_file() && is_ours(&before).unwrap_or(false);
        if lines > 1 {
            // A second name: the first one is never without a file, which another program would make and lock.
            let _ = fs::remove_file(&aside);
            fs::hard_link(&self.path, &aside)
                .or_else(|_| fs::copy(&self.path, &aside).map(drop))
                .map_err(failed)?;
        }
        if comes_back {
            let file = locked(&before, OpenOptions::new().append(true))?;
            fs::rename(&before, &self.path).map_err(failed)?;
            self.file = file;
        }
        if lines > 1 {
            fs::rename(&aside, &before).map_err(failed)?;
            self.set_aside = Some(before);
        }
        if !comes_back {
            // A file of its own: the old one has the other name.
            self.replace(|_| Ok(()))?;
        }
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

    /// Puts these lines in the place of all that is there: to go on from, or in order at the end.
    ///
    /// # Errors
    /// Those of the system; the old ones stay then.
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

    /// Puts a new file in the place of the old one, locked before it is there.
    fn replace(&mut self, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), FormatError> {
        let name = self.path.file_name().unwrap_or_default().to_string_lossy();
        let new = self.path.with_file_name(format!(".{name}.{}.tmp", std::process::id()));
        // One that a killed program left; what cannot be removed is found below.
        let _ = fs::remove_file(&new);
        let file = locked(&new, OpenOptions::new().create_new(true).append(true))?;
        let mut out = BufWriter::new(&file);
        let written = write(&mut out).and_then(|()| out.flush()).and_then(|()| fs::rename(&new, &self.path));
        drop(out);
        if let Err(error) = written {
            let _ = fs::remove_file(&new);
            return Err(unwritable(&self.path, &error));
        }
        self.file = file;
        Ok(())
    }
}

/// How often a file may change under its name while it is locked.
const MOST_CHANGES: usize = 1000;

/// The file of this name, locked; made if there is none.
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

/// Whether a file is still the one of this name: another program may have put a new one there before it was locked.
#[cfg(unix)]
fn has_name(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let one = |of: fs::Metadata| (of.dev(), of.ino());
    file.metadata()
        .ok()
        .map(one)
        .zip(fs::metadata(path).ok().map(one))
        .is_some_and(|(own, named)| own == named)
}

/// There, a file that is open is not replaced.
#[cfg(not(unix))]
fn has_name(_: &File, _: &Path) -> bool {
    true
}

fn with_end(path: &Path, end: &str) -> PathBuf {
    let mut name = path.to_owned().into_os_string();
    name.push(".");
    name.push(end);
    PathBuf::from(name)
}

fn busy(path: &Path) -> FormatError {
    FormatError { place: Place::whole(&path.display().to_string()), problem: Problem::Busy }
}

fn unwritable(path: &Path, error: &io::Error) -> FormatError {
    let problem = Problem::Unwritable { reason: error.to_string() };
    FormatError { place: Place::whole(&path.display().to_string()), problem }
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

    /// Many at once, with two heads that set each other aside: one has the journal at a time, all others are told so, and no line is lost.
    #[test]
    fn one_of_many_has_the_journal_and_no_line_is_lost() {
        const AT_ONCE: usize = 4;
        const ROUNDS: usize = 150;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sweep.jsonl");
        let (held, kept) = (AtomicBool::new(false), [const { AtomicUsize::new(0) }; 2]);
        std::thread::scope(|scope| {
            for thread in 0..AT_ONCE {
                let (path, held, kept) = (&path, &held, &kept);
                scope.spawn(move || {
                    for round in 0..ROUNDS {
                        let of = (thread + round / 2) % 2;
                        let head = Head { of };
                        let mut lines = vec![];
                        let opened = HeldJournal::open(path.clone(), &head, |line| {
                            lines.push(line.trim_end().to_owned());
                            true
                        });
                        match opened {
                            Ok(mut journal) => {
                                assert!(!held.swap(true, Ordering::SeqCst), "two have it");
                                let number = kept[of].fetch_add(1, Ordering::SeqCst);
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
        assert!(kept.iter().all(|kept| kept.load(Ordering::SeqCst) > 10), "{kept:?}");
        let names: Vec<_> =
            fs::read_dir(folder.path()).unwrap().map(|one| one.unwrap().file_name()).collect();
        assert_eq!(names.len(), 2, "{names:?}");
    }
}
