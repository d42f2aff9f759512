//! Folders that one program writes at a time, for results without `--out`.
//!
//! The claim is a locked file in the folder, which is deleted at the end. The system releases the lock if the program is
//! killed, and the next program in the folder locks the file that is left.

use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};

use papilio_formats::{LockedJournal, Problem};

use crate::{Failure, output};

/// Name of the locked file. It is not that of a temporary file, which other programs lock for a moment to delete it.
const FILE: &str = ".papilio.lock";

/// How often a claim is tried: programs that end without a result may remove the folder while it is checked and created.
const TRIES: usize = 20;

/// A claimed folder.
#[derive(Debug)]
pub(crate) struct Claim {
    /// `None` on a file system without locks.
    file: Option<LockedJournal>,
    /// The folder, and those above it that did not exist, the innermost first: they are removed at the end if they are empty.
    folders: Vec<PathBuf>,
}

impl Claim {
    /// Claims a folder, which is created, after checking that results can be written to it; `None` if another program has claimed
    /// it.
    pub(crate) fn of(folder: &Path) -> Result<Option<Self>, Failure> {
        let missing = folder.ancestors().skip(1).take_while(|path| !path.exists());
        let folders: Vec<PathBuf> = std::iter::once(folder).chain(missing).map(Path::to_owned).collect();
        let mut tries = 0;
        loop {
            tries += 1;
            let made = output::check(folder).and_then(|()| output::make_folder(folder));
            match made.and_then(|()| locked(&folder.join(FILE))) {
                Ok(Locked::Ours(file)) => return Ok(Some(Self { file, folders })),
                Ok(Locked::OfAnother) => return Ok(None),
                Err(_) if tries < TRIES => {}
                Err(failure) => return Err(failure),
            }
        }
    }
}

impl Drop for Claim {
    fn drop(&mut self) {
        // The file is deleted while it is locked: later, it may be that of another program. Who locks a deleted file sees that it
        // has lost its name.
        if let Some(file) = self.file.take() {
            let _ = fs::remove_file(file.path());
        }
        // A folder with files stays.
        let _ = self.folders.iter().try_for_each(fs::remove_dir);
    }
}

/// Who has locked a file.
enum Locked {
    /// This program; without a lock on a file system that has none.
    Ours(Option<LockedJournal>),
    OfAnother,
}

/// Locks a file, which is created.
fn locked(path: &Path) -> Result<Locked, Failure> {
    match LockedJournal::hold(path.to_owned()) {
        Ok(file) => Ok(Locked::Ours(Some(file))),
        Err(error) if matches!(error.problem, Problem::Busy) => Ok(Locked::OfAnother),
        Err(_) if has_no_locks(path) => {
            let _ = fs::remove_file(path);
            Ok(Locked::Ours(None))
        }
        Err(error) => Err(error.into()),
    }
}

/// Whether files like this one cannot be locked.
fn has_no_locks(path: &Path) -> bool {
    let Ok(file) = File::options().append(true).open(path) else { return false };
    matches!(file.try_lock(), Err(TryLockError::Error(error)) if is_unsupported(&error))
}

fn is_unsupported(error: &io::Error) -> bool {
    // Network file systems without a server of locks.
    #[cfg(unix)]
    let has_no_server = error.raw_os_error() == Some(nix::errno::Errno::ENOLCK as i32);
    #[cfg(not(unix))]
    let has_no_server = false;
    error.kind() == io::ErrorKind::Unsupported || has_no_server
}
