//! The journal of a search, `optimize.jsonl`: what it is, then every record as it comes.

use std::path::{Path, PathBuf};

use papilio_design::search::{Kept, Record};
use papilio_formats::{HeldJournal, SearchHead, journal_name, journal_paths, trusted_lines};

use crate::Failure;
use crate::journal::{check_folder, failed};

/// Journals are called so.
const STEM: &str = "optimize";

/// Opens the journal in a folder, or begins it: that of the whole, or of part K of N. What it had told of this search, and what
/// others had: those in its folder, and in these.
pub(super) fn open(
    folder: &Path,
    part: Option<(usize, usize)>,
    head: &SearchHead,
    others: &[PathBuf],
) -> Result<(HeldJournal, Kept), Failure> {
    let mut kept = Kept::default();
    let path = folder.join(journal_name(STEM, part));
    let held = HeldJournal::open(path, head, |line| keep(&mut kept, line)).map_err(failed)?;
    for folder in [folder].into_iter().chain(others.iter().map(PathBuf::as_path)) {
        check_folder(folder, STEM)?;
        for path in journal_paths(folder, STEM).map_err(failed)? {
            if path != held.path() {
                let mut other = Kept::default();
                trusted_lines(&path, head, |line| keep(&mut other, line)).map_err(failed)?;
                kept.join(other);
            }
        }
    }
    Ok((held, kept))
}

/// Takes a line; false if it is no record.
fn keep(kept: &mut Kept, line: &str) -> bool {
    Record::parse(line).map(|record| kept.add(record)).is_ok()
}
