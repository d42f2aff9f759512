//! Files in and out: read whole and bounded, written whole or not at all.

use std::fs::{self, File};
use std::io::{self, BufWriter, Read, Write};
use std::path::Path;

use papilio_diagnostics::Place;

use crate::error::{FormatError, Problem};

/// No input file may be larger, in bytes, save for those of measured scattering.
pub const LARGEST_FILE: u64 = 64 << 20;

/// A file of the user's, read into memory.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DataFile {
    /// Its name as the user wrote it.
    pub name: String,
    /// Its bytes.
    pub bytes: Vec<u8>,
}

impl DataFile {
    /// Reads `path`; errors call it `name`.
    ///
    /// # Errors
    /// If it cannot be read or holds more than [`LARGEST_FILE`] bytes.
    pub fn open(path: &Path, name: &str) -> Result<Self, FormatError> {
        Self::open_within(path, name, LARGEST_FILE)
    }

    /// As [`DataFile::open`], for a file of `limit` bytes at most.
    ///
    /// # Errors
    /// If it cannot be read or is larger.
    pub fn open_within(path: &Path, name: &str, limit: u64) -> Result<Self, FormatError> {
        let error = |problem| FormatError { place: Place::whole(name), problem };
        let unreadable = |e: io::Error| error(Problem::Unreadable { reason: in_words(&e) });
        // Looked at before it is opened: opening a pipe waits for its other end.
        let kind = fs::metadata(path).map_err(unreadable)?;
        if !kind.is_file() {
            return Err(error(Problem::Unreadable { reason: "it is not a regular file".to_owned() }));
        }
        let file = File::open(path).map_err(unreadable)?;
        let mut bytes = Vec::new();
        file.take(limit.saturating_add(1)).read_to_end(&mut bytes).map_err(unreadable)?;
        if bytes.len() as u64 > limit {
            return Err(error(Problem::TooLarge { bytes: kind.len(), limit }));
        }
        Ok(Self { name: name.to_owned(), bytes })
    }

    /// Its text, without a byte order mark.
    ///
    /// # Errors
    /// If it is not UTF-8; the error names the first bad byte's place.
    pub fn text(&self) -> Result<&str, FormatError> {
        let bytes = self.bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(&self.bytes);
        std::str::from_utf8(bytes).map_err(|e| {
            let text = String::from_utf8_lossy(bytes);
            // Everything before the first bad byte is as long in `text` as in the file.
            let at = e.valid_up_to();
            FormatError { place: Place::in_text(&self.name, &text, at..at + 1), problem: Problem::NotUtf8 }
        })
    }
}

/// Writes a file whole or not at all: under a temporary name beside it first.
///
/// # Errors
/// Those of the system and of `write`; nothing is left behind then.
pub fn write_file(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), FormatError> {
    write_and_rename(path, write).map_err(|e| FormatError {
        place: Place::whole(&path.display().to_string()),
        problem: Problem::Unwritable { reason: in_words(&e) },
    })
}

fn write_and_rename(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let name = path.file_name().ok_or_else(|| io::Error::from(io::ErrorKind::InvalidFilename))?;
    let temporary = path.with_file_name(format!(".{}.{}.tmp", name.to_string_lossy(), std::process::id()));
    let written = File::create(&temporary).and_then(|file| {
        let mut buffered = BufWriter::new(file);
        write(&mut buffered)?;
        buffered.flush()
    });
    let done = written.and_then(|()| fs::rename(&temporary, path));
    if done.is_err() {
        // The first error is the one to report; the leftover may not even exist.
        let _ = fs::remove_file(&temporary);
    }
    done
}

fn in_words(error: &io::Error) -> String {
    match error.kind() {
        io::ErrorKind::NotFound => "there is no such file".to_owned(),
        io::ErrorKind::PermissionDenied => "permission denied".to_owned(),
        io::ErrorKind::IsADirectory => "it is a folder".to_owned(),
        _ => error.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_write_leaves_nothing_and_keeps_the_old_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        write_file(&path, |w| w.write_all(b"old")).unwrap();
        let failed = write_file(&path, |w| {
            w.write_all(b"new, in part")?;
            Err(io::Error::other("the disk is full"))
        });
        assert!(matches!(failed.unwrap_err().problem, Problem::Unwritable { .. }));
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn what_cannot_be_read_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let missing = DataFile::open(&folder.path().join("none"), "none").unwrap_err();
        assert_eq!(missing.problem, Problem::Unreadable { reason: "there is no such file".to_owned() });
        assert!(DataFile::open(folder.path(), "folder").is_err());
    }

    #[cfg(unix)]
    #[test]
    fn a_pipe_is_refused_and_not_waited_for() {
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("pipe");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        let refused = DataFile::open(&pipe, "pipe").unwrap_err().problem;
        assert_eq!(refused, Problem::Unreadable { reason: "it is not a regular file".to_owned() });
    }

    #[test]
    fn bytes_that_are_not_text_have_a_place() {
        let file = DataFile { name: "x".to_owned(), bytes: b"ab\ncd\xFF".to_vec() };
        let error = file.text().unwrap_err();
        assert_eq!((error.place.line_column(), error.problem), (Some((2, 3)), Problem::NotUtf8));
        let marked = DataFile { name: "x".to_owned(), bytes: b"\xEF\xBB\xBF1".to_vec() };
        assert_eq!(marked.text().unwrap(), "1");
    }
}
