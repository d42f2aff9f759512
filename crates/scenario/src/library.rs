//! Files of a scenario: in a folder, or in memory.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use papilio_diagnostics::{Diagnostic, Place, suggestion};
use papilio_formats::{DataFile, FormatError, open_input};
use sha2::{Digest, Sha256};

use crate::here::{path_from_here, relative_path};
use crate::memo::ResolveCache;

/// The files that a scenario may name.
#[derive(Debug, Clone)]
pub enum Library {
    /// Files on disk; names are paths relative to this folder.
    Folder(PathBuf),
    /// Files in memory, by the names that scenarios use. Nothing is read from the disk, whatever a scenario
    /// contains.
    Memory {
        /// Files by their names.
        files: Arc<BTreeMap<String, MemoryFile>>,
        /// Cache of values that were computed from them.
        memo: Arc<ResolveCache>,
    },
    /// Files in memory, by the names that scenarios use, and files on disk for all other names.
    Both {
        /// Files by their names.
        files: Arc<BTreeMap<String, MemoryFile>>,
        /// Folder of all other files.
        folder: PathBuf,
    },
}

/// A file in memory; clones share it.
#[derive(Debug, Clone)]
pub struct MemoryFile(Arc<(DataFile, String)>);

impl MemoryFile {
    /// Holds a file; errors in it state its name.
    pub fn new(file: DataFile) -> Self {
        let sha256 = sha256(&file.bytes);
        Self(Arc::new((file, sha256)))
    }

    /// Name and bytes of the file.
    pub fn file(&self) -> &DataFile {
        &self.0.0
    }

    /// SHA-256 of the bytes, in hexadecimal digits.
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
    /// Reads a file of at most `limit` bytes.
    pub(crate) fn open(&self, name: &str, limit: u64) -> Result<MemoryFile, Missing> {
        // With the folder, it would be the name of the folder.
        if name.trim().is_empty() {
            let wrong = Diagnostic::new("the name of the file is empty").expected("the path of a file");
            return Err(Missing::Unknown(wrong.hint("remove the key, or give it the name of a file")));
        }
        match self {
            Self::Both { files, .. } if files.contains_key(name) => kept_within(&files[name], name, limit),
            Self::Folder(folder) | Self::Both { folder, .. } => {
                let path = folder.join(name);
                open_input(&path, &path_from_here(&path), limit).map(MemoryFile::new).map_err(Missing::Unread)
            }
            Self::Memory { files, .. } => match files.get(name) {
                Some(kept) => kept_within(kept, name, limit),
                None => {
                    let hint = suggestion(name, files.keys().map(String::as_str), "files");
                    let wrong = Diagnostic::new(format!("there is no file `{name}` here"));
                    Err(Missing::Unknown(wrong.hint(hint)))
                }
            },
        }
    }

    /// Returns the library of a file that names files relative to its own folder.
    pub(crate) fn beside(&self, name: &str) -> Self {
        let parent = Path::new(name).parent().unwrap_or(Path::new(""));
        match self {
            Self::Folder(folder) => Self::Folder(folder.join(parent)),
            Self::Both { files, folder } => {
                Self::Both { files: Arc::clone(files), folder: folder.join(parent) }
            }
            Self::Memory { .. } => self.clone(),
        }
    }

    /// Returns a hint for a file that cannot be read: the paths that were tried. `in_set`: the name is in a
    /// `--set`.
    pub(crate) fn tried(&self, name: &str, in_set: bool) -> Option<String> {
        let Self::Folder(folder) = self else { return None };
        let tried = folder.join(name);
        let here = Path::new(name);
        Some(if in_set && tried != here {
            format!(
                "paths in --set are relative to the current folder, or else to the folder of the scenario: tried {} and {}",
                here.display(),
                tried.display()
            )
        } else if tried != here && here.is_file() {
            let from_folder = relative_path(folder, Path::new("")).unwrap_or_default().join(here);
            format!(
                "paths in a scenario are relative to its folder: tried {}; for the file in the current folder, write {}",
                tried.display(),
                from_folder.display()
            )
        } else {
            format!("paths in a scenario are relative to its folder: tried {}", tried.display())
        })
    }

    /// True if there is a file with this name.
    pub(crate) fn has(&self, name: &str) -> bool {
        match self {
            Self::Folder(folder) => folder.join(name).is_file(),
            Self::Memory { files, .. } => files.contains_key(name),
            Self::Both { files, folder } => files.contains_key(name) || folder.join(name).is_file(),
        }
    }
}

/// Returns a file in memory, unless it has more than `limit` bytes.
fn kept_within(kept: &MemoryFile, name: &str, limit: u64) -> Result<MemoryFile, Missing> {
    let bytes = kept.file().bytes.len() as u64;
    let too_large = papilio_formats::Problem::TooLarge { bytes, limit };
    let error = || FormatError { place: Place::whole(name), problem: too_large };
    if bytes <= limit { Ok(kept.clone()) } else { Err(Missing::Unread(error())) }
}

/// Why a file is not available.
pub(crate) enum Missing {
    /// The file cannot be read.
    Unread(FormatError),
    /// There is no file with this name.
    Unknown(Diagnostic),
}

/// Computes the SHA-256 of bytes, in hexadecimal digits.
pub(crate) fn sha256(bytes: &[u8]) -> String {
    hex(&Sha256::digest(bytes))
}

/// Formats bytes as hexadecimal digits.
pub(crate) fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
