//! The journal of a search, `optimize.jsonl`: a head that identifies the search, then its records in order of
//! arrival.

use std::path::{Path, PathBuf};

use papilio_design::search::{Record, SearchRecords};
use papilio_formats::{
    LockedJournal, SearchHead, foreign_journal_error, journal_name, journal_paths, read_verified_lines,
};

use crate::Failure;
use crate::journal::{check_folder, report_moved};

/// Names of journals begin with this.
const STEM: &str = "optimize";

/// Opens or creates the journal of a search (or of shard K of N) in a folder.
///
/// Also returns the records of this search: those in the journal, in other journals of the folder, and in the
/// folders `others`.
pub(super) fn open(
    folder: &Path,
    shard: Option<(usize, usize)>,
    head: &SearchHead,
    others: &[PathBuf],
) -> Result<(LockedJournal, SearchRecords), Failure> {
    let mut records = SearchRecords::default();
    let own = folder.join(journal_name(STEM, shard));
    for (index, folder) in [folder].into_iter().chain(others.iter().map(PathBuf::as_path)).enumerate() {
        check_folder(folder, STEM)?;
        let paths = journal_paths(folder, STEM)?;
        let mut matching = 0;
        for path in paths.iter().filter(|path| **path != own) {
            let mut read = SearchRecords::default();
            matching += read_verified_lines(path, head, |line| add_record(&mut read, line))?;
            records.join(read);
        }
        match paths.first() {
            Some(path) if index > 0 && matching == 0 => return Err(foreign_journal_error(path).into()),
            _ => {}
        }
    }
    // Last, because this moves a journal that belongs to another search.
    let held = LockedJournal::open(own, head, |line| add_record(&mut records, line))?;
    report_moved(held.set_aside());
    Ok((held, records))
}

/// Adds the record in a line; false if the line is not a record.
fn add_record(records: &mut SearchRecords, line: &str) -> bool {
    Record::parse(line).map(|record| records.add(record)).is_ok()
}
