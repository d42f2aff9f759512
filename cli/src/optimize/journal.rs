//! The journal of a search, `optimize.jsonl`: what it is, then every record as it comes.

use std::path::{Path, PathBuf};

use papilio_design::search::{Kept, Record};
use papilio_formats::{HeldJournal, SearchHead, foreign, journal_name, journal_paths, trusted_lines};

use crate::Failure;
use crate::journal::{check_folder, tell_of};

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
    let own = folder.join(journal_name(STEM, part));
    for (other, folder) in [folder].into_iter().chain(others.iter().map(PathBuf::as_path)).enumerate() {
        check_folder(folder, STEM)?;
        let paths = journal_paths(folder, STEM)?;
        let mut ours = 0;
        for path in paths.iter().filter(|path| **path != own) {
            let mut told = Kept::default();
            ours += trusted_lines(path, head, |line| keep(&mut told, line))?;
            kept.join(told);
        }
        match paths.first() {
            Some(path) if other > 0 && ours == 0 => return Err(foreign(path).into()),
            _ => {}
        }
    }
    // Last: a journal of another search is set aside.
    let held = HeldJournal::open(own, head, |line| keep(&mut kept, line))?;
    tell_of(held.set_aside());
    Ok((held, kept))
}

/// Takes a line; false if it is no record.
fn keep(kept: &mut Kept, line: &str) -> bool {
    Record::parse(line).map(|record| kept.add(record)).is_ok()
}
