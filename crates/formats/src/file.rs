//! Input files, read whole up to a size limit, and output files, written completely or not at all.

use std::fs::{self, File};
use std::io::{self, BufWriter, Read, Write};
use std::path::Path;

use papilio_diagnostics::{Diagnostic, Place};

use crate::error::{FormatError, Problem};
use crate::inputs::check_output;
use crate::picture::picture_for_text;
use crate::table::is_utf_16;
use crate::temporary::{Temporary, remove_abandoned_once};

/// Largest size of an input file, bytes; files of measured scattering have a limit of their own.
pub const LARGEST_FILE: u64 = 64 << 20;

/// An input file in memory.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DataFile {
    /// Name as the user wrote it.
    pub name: String,
    /// Content.
    pub bytes: Vec<u8>,
}

impl DataFile {
    /// Reads the file at `path`; errors refer to it as `name`.
    ///
    /// # Errors
    /// If the file cannot be read or is larger than [`LARGEST_FILE`].
    pub fn open(path: &Path, name: &str) -> Result<Self, FormatError> {
        Self::open_within(path, name, LARGEST_FILE)
    }

    /// Reads a file as [`DataFile::open`], with a limit of `limit` bytes.
    ///
    /// # Errors
    /// If the file cannot be read or is larger than `limit`.
    pub fn open_within(path: &Path, name: &str, limit: u64) -> Result<Self, FormatError> {
        let error = |problem| FormatError::whole(name, problem);
        if path.as_os_str().is_empty() {
            let reason = "its name is empty".to_owned();
            return Err(FormatError::whole("\"\"", Problem::Unreadable { reason }));
        }
        let unreadable = |e: io::Error| error(Problem::Unreadable { reason: io_message(&e) });
        // The type is checked before the file is opened, because opening a pipe waits for its other end.
        let kind = fs::metadata(path).map_err(unreadable)?;
        if !kind.is_file() {
            let reason = if kind.is_dir() { "it is a folder" } else { "it is not a regular file" };
            return Err(error(Problem::Unreadable { reason: reason.to_owned() }));
        }
        let file = File::open(path).map_err(unreadable)?;
        let mut bytes = Vec::new();
        file.take(limit.saturating_add(1)).read_to_end(&mut bytes).map_err(unreadable)?;
        if bytes.len() as u64 > limit {
            return Err(error(Problem::TooLarge { bytes: kind.len(), limit }));
        }
        Ok(Self { name: name.to_owned(), bytes })
    }

    /// Returns the content as text, without a byte order mark.
    ///
    /// # Errors
    /// If the content is not UTF-8; the error of a text has the place of the first invalid byte.
    pub fn text(&self) -> Result<&str, FormatError> {
        let bytes = self.bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(&self.bytes);
        if is_utf_16(bytes) {
            return Err(FormatError::whole(&self.name, Problem::Utf16));
        }
        std::str::from_utf8(bytes).map_err(|e| {
            if let Some(format) = picture_for_text(bytes) {
                return FormatError::whole(&self.name, Problem::Picture { format });
            }
            if is_binary(bytes) {
                return FormatError::whole(&self.name, Problem::NotUtf8);
            }
            let text = String::from_utf8_lossy(bytes);
            // Up to the first invalid byte, `text` and the file are equal.
            let at = e.valid_up_to();
            FormatError { place: Place::in_text(&self.name, &text, at..at + 1), problem: Problem::NotUtf8 }
        })
    }
}

/// Bytes at the beginning of a file that show whether it is a text.
const HEAD: usize = 4096;

/// Whether a file has control characters that no text has: a line of it would not help.
fn is_binary(bytes: &[u8]) -> bool {
    let is_of_text = |byte: &u8| *byte >= b' ' || byte.is_ascii_whitespace() || *byte == b'\x1b';
    !bytes.iter().take(HEAD).all(is_of_text)
}

/// Writes a file completely or not at all: first under a temporary name in the same folder, which is then
/// renamed. Temporary files that a killed program has left in the folder are deleted.
///
/// # Errors
/// If the system or `write` reports an error, or the file is an input of the command. No partial file remains, and a previous file of this name is
/// not changed.
pub fn write_file(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), FormatError> {
    check_output(path)?;
    write_and_rename(path, write).map_err(|error| unwritable(path, &error))
}

/// The error of a file, or of a folder, that the system cannot write.
pub fn unwritable(path: &Path, error: &io::Error) -> FormatError {
    let is_of_place = is_of_place(error);
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty() && !folder.exists());
    if let (io::ErrorKind::NotFound, Some(folder)) = (error.kind(), folder) {
        let wrong = Diagnostic::new(format!("the folder {} does not exist", folder.display()));
        return FormatError::whole(
            &path.display().to_string(),
            wrong.hint("create it, or choose another folder"),
        );
    }
    let problem = Problem::Unwritable { reason: io_message(error), is_of_place };
    FormatError::whole(&path.display().to_string(), problem)
}

/// Whether the system refuses to write at this place, and would write at another one: the place is read-only, a file is in its way, or it is
/// gone. All other errors are of the system, such as a full disk.
pub fn is_of_place(error: &io::Error) -> bool {
    use io::ErrorKind as Kind;
    matches!(
        error.kind(),
        Kind::AlreadyExists
            | Kind::DirectoryNotEmpty
            | Kind::InvalidFilename
            | Kind::IsADirectory
            | Kind::NotADirectory
            | Kind::NotFound
            | Kind::PermissionDenied
            | Kind::ReadOnlyFilesystem
    )
}

fn write_and_rename(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    remove_abandoned_once(path.parent().unwrap_or(Path::new("")));
    let temporary = Temporary::of(path)?;
    let mut out = System { file: BufWriter::new(&temporary.file), error: None };
    let written = write(&mut out).and_then(|()| out.flush());
    // The error of the system says more than what a library makes of it, and cannot be overlooked by one.
    let written = out.error.take().map_or(written, Err);
    drop(out);
    match written {
        Ok(()) => temporary.rename(path).map(drop),
        Err(error) => {
            temporary.delete();
            Err(error)
        }
    }
}

/// A file that remembers its first error. What follows is accepted and lost, so that libraries end without
/// messages of their own.
struct System<'a> {
    file: BufWriter<&'a File>,
    error: Option<io::Error>,
}

impl System<'_> {
    fn remember<T>(&mut self, result: io::Result<T>) -> io::Result<T> {
        result.map_err(|error| {
            let same = io::Error::from(error.kind());
            if error.kind() != io::ErrorKind::Interrupted {
                self.error.get_or_insert(error);
            }
            same
        })
    }
}

impl Write for System<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.error.is_some() {
            return Ok(bytes.len());
        }
        let written = self.file.write(bytes);
        self.remember(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        if self.error.is_some() {
            return Ok(());
        }
        let flushed = self.file.flush();
        self.remember(flushed)
    }
}

/// An error of the system in words.
pub(crate) fn io_message(error: &io::Error) -> String {
    match error.kind() {
        io::ErrorKind::NotFound => "there is no such file".to_owned(),
        io::ErrorKind::PermissionDenied => "permission denied".to_owned(),
        io::ErrorKind::IsADirectory => "this is a folder, not a file".to_owned(),
        io::ErrorKind::NotADirectory => "a part of its path is a file, not a folder".to_owned(),
        io::ErrorKind::InvalidFilename => "its name is too long, or not permitted".to_owned(),
        io::ErrorKind::StorageFull => "the disk is full".to_owned(),
        io::ErrorKind::QuotaExceeded => "the quota of the disk is used up".to_owned(),
        io::ErrorKind::ReadOnlyFilesystem => "the file system is read-only".to_owned(),
        io::ErrorKind::FileTooLarge => "the file is larger than the system permits".to_owned(),
        _ => error.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn failed_write_keeps_the_old_file_and_removes_the_temporary_one() {
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

    /// A device without space, as a disk that becomes full: the system's error is reported, whatever a
    /// library makes of it, also if it is overlooked, and the archive library has no message of its own.
    #[cfg(target_os = "linux")]
    #[test]
    fn full_disk_is_reported_in_words() {
        let full = File::options().write(true).open("/dev/full").unwrap();
        let message = |write: &dyn Fn(&mut dyn Write) -> io::Result<()>| {
            let mut out = System { file: BufWriter::new(&full), error: None };
            let written = write(&mut out).and_then(|()| out.flush());
            io_message(&out.error.take().map_or(written, Err).unwrap_err())
        };
        let large = vec![0; 100_000];
        assert_eq!(message(&|out| out.write_all(&large)), "the disk is full");
        assert_eq!(message(&|out| out.write_all(b"short")), "the disk is full");
        assert_eq!(
            message(&|out| {
                // As a library that drops the error.
                drop(out.write_all(&large));
                Ok(())
            }),
            "the disk is full"
        );
        let archive = |out: &mut dyn Write| {
            let mut archive = zip::ZipWriter::new_stream(out);
            archive.start_file("a.npy", crate::npy::stored())?;
            archive.write_all(&large)?;
            archive.finish().map(drop).map_err(|error| io::Error::other(error.to_string()))
        };
        assert_eq!(message(&archive), "the disk is full");
    }

    #[test]
    fn missing_file_or_folder_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let missing = DataFile::open(&folder.path().join("none"), "none").unwrap_err();
        assert_eq!(missing.problem, Problem::Unreadable { reason: "there is no such file".to_owned() });
        let opened = DataFile::open(folder.path(), "folder").unwrap_err();
        assert_eq!(opened.problem, Problem::Unreadable { reason: "it is a folder".to_owned() });
        let written = write_file(&folder.path().join("none/a.csv"), |_| Ok(())).unwrap_err().to_string();
        assert!(written.contains("none does not exist") && written.contains("create it"), "{written}");
    }

    #[cfg(unix)]
    #[test]
    fn pipe_is_refused_without_waiting() {
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("pipe");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        let refused = DataFile::open(&pipe, "pipe").unwrap_err().problem;
        assert_eq!(refused, Problem::Unreadable { reason: "it is not a regular file".to_owned() });
    }

    #[test]
    fn invalid_utf_8_is_an_error_with_its_place() {
        let file = DataFile { name: "x".to_owned(), bytes: b"ab\ncd\xFF".to_vec() };
        let error = file.text().unwrap_err();
        assert_eq!((error.place.line_column(), error.problem), (Some((2, 3)), Problem::NotUtf8));
        let marked = DataFile { name: "x".to_owned(), bytes: b"\xEF\xBB\xBF1".to_vec() };
        assert_eq!(marked.text().unwrap(), "1");
    }

    #[test]
    fn bytes_that_are_no_text_are_an_error_without_a_line() {
        let error = |bytes: &[u8]| {
            let file = DataFile { name: "x".to_owned(), bytes: bytes.to_vec() };
            file.text().unwrap_err()
        };
        for (bytes, format) in [
            (&b"\x89PNG\r\n\x1a\n\0\0"[..], "PNG"),
            (b"\xff\xd8\xff\xe0", "JPEG"),
            (b"\x76\x2f\x31\x01\xff", "OpenEXR"),
            (b"#?RADIANCE\n\xff", "Radiance"),
        ] {
            assert_eq!(error(bytes), FormatError::whole("x", Problem::Picture { format }));
        }
        for bytes in [&b"%PDF-1.7\n\x00\xff"[..], b"\x1f\x8b\x08\x00\xff"] {
            assert_eq!(error(bytes), FormatError::whole("x", Problem::NotUtf8));
        }
        // With and without a byte order mark.
        for bytes in [&b"\xff\xfe[\0d\0"[..], b"\xfe\xff\0[\0d", b"[\0d\0]\0", b"\0[\0d\0]"] {
            let found = error(bytes);
            assert_eq!(found, FormatError::whole("x", Problem::Utf16));
            assert!(found.to_string().contains("it looks like UTF-16"), "{found}");
        }
    }
}
