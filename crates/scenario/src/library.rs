//! Where the files of a scenario are: in a folder, or in memory.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use papilio_diagnostics::{Diagnostic, Place, suggestion};
use papilio_formats::{DataFile, FormatError};
use sha2::{Digest, Sha256};

use crate::memo::Memo;

/// Where the files are that a scenario names.
#[derive(Debug, Clone)]
pub enum Library {
    /// On disk: names are paths relative to this folder.
    Folder(PathBuf),
    /// In memory, under the names that scenarios give them. Whatever a scenario says, nothing is read from the disk.
    Memory {
        /// The files.
        files: Arc<BTreeMap<String, KeptFile>>,
        /// What was made of them before.
        memo: Arc<Memo>,
    },
}

/// A file in memory; clones share it.
#[derive(Debug, Clone)]
pub struct KeptFile(Arc<(DataFile, String)>);

impl KeptFile {
    /// Keeps a file; errors in it call it by its name.
    pub fn new(file: DataFile) -> Self {
        let sha256 = sha256(&file.bytes);
        Self(Arc::new((file, sha256)))
    }

    /// Its name and bytes.
    pub fn file(&self) -> &DataFile {
        &self.0.0
    }

    /// SHA-256 of its bytes, in hexadecimal digits.
    pub fn sha256(&self) -> &str {
        &self.0.1
    }
}

impl From<&Path> for Library {
    fn from(folder: &Path) -> Self {
        Self::Folder(folder.to_owned())
    }
}

impl From<&PathBuf> for Library {
    fn from(folder: &PathBuf) -> Self {
        Self::Folder(folder.clone())
    }
}

impl Library {
    /// Reads a file of `limit` bytes at most.
    pub(crate) fn open(&self, name: &str, limit: u64) -> Result<KeptFile, Missing> {
        match self {
            Self::Folder(folder) => DataFile::open_within(&folder.join(name), name, limit)
                .map(KeptFile::new)
                .map_err(Missing::Unread),
            Self::Memory { files, .. } => match files.get(name) {
                Some(kept) => {
                    let bytes = kept.file().bytes.len() as u64;
                    let too_large = papilio_formats::Problem::TooLarge { bytes, limit };
                    let error = || FormatError { place: Place::whole(name), problem: too_large };
                    if bytes <= limit { Ok(kept.clone()) } else { Err(Missing::Unread(error())) }
                }
                None => {
                    let hint = suggestion(name, files.keys().map(String::as_str), "files");
                    let wrong = Diagnostic::new(format!("there is no file `{name}` here"));
                    Err(Missing::Unknown(wrong.hint(hint)))
                }
            },
        }
    }

    /// True if there is a file of this name.
    pub(crate) fn has(&self, name: &str) -> bool {
        match self {
            Self::Folder(folder) => folder.join(name).is_file(),
            Self::Memory { files, .. } => files.contains_key(name),
        }
    }
}

/// Why there is no file.
pub(crate) enum Missing {
    /// It cannot be read.
    Unread(FormatError),
    /// Nothing goes by its name.
    Unknown(Diagnostic),
}

/// SHA-256 of bytes, in hexadecimal digits.
pub(crate) fn sha256(bytes: &[u8]) -> String {
    hex(&Sha256::digest(bytes))
}

/// Bytes as hexadecimal digits.
pub(crate) fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
