//! Files that are being written, under temporary names.
//!
//! A writer holds the lock of its temporary file until it has the final name, or is deleted. A program that
//! was killed holds no locks: the next one that writes in the folder locks, and deletes, what was left. On a
//! file system without locks, nothing is deleted.

use std::collections::BTreeSet;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

/// End of the names, which no other program gives.
const END: &str = ".papilio.tmp";

/// How often other programs may take a name or delete its file before it is locked.
const MOST_TRIES: usize = 1000;

/// A locked file under a temporary name.
#[derive(Debug)]
pub(crate) struct Temporary {
    pub(crate) file: File,
    path: PathBuf,
}

impl Temporary {
    /// Creates a file that will get the name of `path`.
    pub(crate) fn of(path: &Path) -> io::Result<Self> {
        static NUMBER: AtomicU64 = AtomicU64::new(0);
        let name = path.file_name().ok_or_else(|| io::Error::from(io::ErrorKind::InvalidFilename))?;
        for _ in 0..MOST_TRIES {
            let number = NUMBER.fetch_add(1, Ordering::Relaxed);
            let own = format!(".{}.{}-{number}{END}", name.to_string_lossy(), std::process::id());
            let own = path.with_file_name(own);
            match OpenOptions::new().append(true).create_new(true).open(&own) {
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
                Err(error) => return Err(error),
                // Another program may have locked and deleted it since.
                Ok(file) if is_lockable(&file) && has_name(&file, &own) => {
                    return Ok(Self { file, path: own });
                }
                Ok(_) => {}
            }
        }
        Err(io::Error::from(io::ErrorKind::AlreadyExists))
    }

    /// Gives the file its final name. It stays locked until it is closed.
    pub(crate) fn rename(self, path: &Path) -> io::Result<File> {
        match fs::rename(&self.path, path) {
            Ok(()) => Ok(self.file),
            Err(error) => {
                self.delete();
                Err(error)
            }
        }
    }

    /// Deletes the file; it may not exist any more.
    pub(crate) fn delete(self) {
        let _ = fs::remove_file(&self.path);
    }
}

/// Locks a file, unless the file system has no locks; false if another program has locked it.
fn is_lockable(file: &File) -> bool {
    !matches!(file.try_lock(), Err(TryLockError::WouldBlock))
}

/// Deletes what killed programs have left in a folder under temporary names.
pub fn remove_abandoned(folder: &Path) {
    let is_temporary = |name: &str| name.starts_with('.') && name.ends_with(END);
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    for entry in entries.filter(|entry| entry.file_name().to_str().is_some_and(is_temporary)) {
        let path = entry.path();
        let is_file = entry.file_type().is_ok_and(|kind| kind.is_file());
        let Ok(file) = OpenOptions::new().append(true).open(&path) else { continue };
        // The lock is held while the file is deleted: its writer, if it has just begun, sees that, and takes
        // another name.
        if is_file && file.try_lock().is_ok() && has_name(&file, &path) {
            // A file that cannot be deleted does no harm.
            let _ = fs::remove_file(&path);
        }
    }
}

/// As [`remove_abandoned`], once for each folder.
pub(crate) fn remove_abandoned_once(folder: &Path) {
    static DONE: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());
    if DONE.lock().unwrap_or_else(PoisonError::into_inner).insert(folder.to_owned()) {
        remove_abandoned(if folder.as_os_str().is_empty() { Path::new(".") } else { folder });
    }
}

/// Returns whether a file is still the one with this name: another program may have replaced it before it was
/// locked.
#[cfg(unix)]
pub(crate) fn has_name(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let identity = |metadata: fs::Metadata| (metadata.dev(), metadata.ino());
    file.metadata()
        .ok()
        .map(identity)
        .zip(fs::metadata(path).ok().map(identity))
        .is_some_and(|(own, named)| own == named)
}

/// Always true: on these systems, an open file cannot be replaced.
#[cfg(not(unix))]
pub(crate) fn has_name(_: &File, _: &Path) -> bool {
    true
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<String> = fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn abandoned_files_are_deleted_and_those_being_written_are_not() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        // A killed program has no lock; a file of another program has another name.
        for left in
            [".a.csv.99999-0.papilio.tmp", ".b.json.1-7.papilio.tmp", ".a.csv.5.tmp", "notes.papilio.tmp"]
        {
            fs::write(folder.path().join(left), "left").unwrap();
        }
        let mut writing = Temporary::of(&path).unwrap();
        writing.file.write_all(b"new").unwrap();
        remove_abandoned(folder.path());
        assert_eq!(names(folder.path()).len(), 3, "{:?}", names(folder.path()));
        drop(writing.rename(&path).unwrap());
        assert_eq!(names(folder.path()), [".a.csv.5.tmp", "a.csv", "notes.papilio.tmp"]);
        assert_eq!(fs::read(&path).unwrap(), b"new");
    }

    /// Programs that write the same file while others delete what was left: each file is written whole.
    #[test]
    fn writers_and_cleaners_at_the_same_time_lose_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        std::thread::scope(|scope| {
            for number in 0..4_u8 {
                let path = &path;
                scope.spawn(move || {
                    for _ in 0..50 {
                        let mut file = Temporary::of(path).unwrap();
                        file.file.write_all(&[number; 100]).unwrap();
                        file.rename(path).unwrap();
                    }
                });
                scope.spawn(|| (0..100).for_each(|_| remove_abandoned(folder.path())));
            }
        });
        let content = fs::read(&path).unwrap();
        assert!(content.len() == 100 && content.iter().all(|byte| *byte == content[0]));
        assert_eq!(names(folder.path()), ["a.csv"]);
    }
}
