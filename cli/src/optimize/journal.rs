//! The journal of a search, `optimize.jsonl`: what it is, then every record as it comes.

use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};

use papilio_design::search::{Found, Kept, Record};
use papilio_formats::{DataFile, LARGEST_JOURNAL, write_file, write_journal_line};
use serde::{Deserialize, Serialize};

use crate::Failure;
use crate::journal::{locked, unwritable};

/// Its first line: a search that is another one begins anew.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Head {
    /// Version of the program.
    pub(super) papilio: String,
    /// SHA-256 of the search, its scenarios and their files.
    pub(super) search: String,
}

/// Held by one program at a time.
#[derive(Debug)]
pub(super) struct Journal {
    path: PathBuf,
    file: File,
}

impl Journal {
    /// Opens the journal in a folder, or begins it; what it had told of this search.
    pub(super) fn open(folder: &Path, head: &Head) -> Result<(Self, Kept), Failure> {
        let path = folder.join("optimize.jsonl");
        let mut file = locked(&path)?;
        let read = DataFile::open_within(&path, &path.display().to_string(), LARGEST_JOURNAL)
            .map_err(Failure::Data)?;
        let mut kept = Kept::default();
        let mut whole = 0;
        let mut known = false;
        for line in read.bytes.split_inclusive(|byte| *byte == b'\n').take_while(|line| line.ends_with(b"\n"))
        {
            let text = String::from_utf8_lossy(line);
            if whole == 0 {
                known = serde_json::from_str::<Head>(&text).is_ok_and(|own| own == *head);
                if !known {
                    break;
                }
            } else {
                // What is no record ends what can be trusted.
                let Ok(record) = Record::parse(&text) else { break };
                kept.add(record);
            }
            whole += line.len();
        }
        let why = |error: std::io::Error| unwritable(&path, &error);
        file.set_len(whole as u64).map_err(why)?;
        if !known {
            write_journal_line(&mut file, head).map_err(why)?;
        }
        Ok((Self { path, file }, kept))
    }

    /// Keeps a record: on the disk before this returns.
    pub(super) fn add(&mut self, record: &Record) -> Result<(), Failure> {
        write_journal_line(&mut self.file, record)
            .and_then(|()| self.file.flush())
            .map_err(|error| unwritable(&self.path, &error))
    }
}

/// Puts the journal in order: what each task found, by its number.
pub(super) fn finish(folder: &Path, head: &Head, found: &[Found]) -> Result<(), Failure> {
    write_file(&folder.join("optimize.jsonl"), |mut out| {
        write_journal_line(&mut out, head)?;
        found.iter().try_for_each(|one| write_journal_line(&mut out, one))
    })?;
    Ok(())
}
