//! Light journals: rows of numbers by index, with a common head.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::folder::{foreign_journal_error, journal_name, open_journal, read_journals};
use super::{Journal, JournalNumber, JournalRow, LockedJournal};
use crate::error::FormatError;
use crate::gonio::GonioHead;
use crate::sweep::SweepHead;
use crate::temporary::remove_abandoned;
use crate::tolerance::ToleranceHead;

/// A light journal: rows of numbers by index, with a common head. A journal with a different head is set
/// aside.
#[derive(Debug)]
pub struct JournalRows<H> {
    journal: LockedJournal,
    head: H,
    known: BTreeMap<usize, Vec<f64>>,
}

/// Head of a light journal: identifies the computation to which its rows belong.
pub trait RowsHead: PartialEq + Serialize + DeserializeOwned {
    /// Returns whether rows of one head are valid for the other.
    fn is_of(&self, other: &Self) -> bool;
}

impl RowsHead for ToleranceHead {
    fn is_of(&self, other: &Self) -> bool {
        self == other
    }
}

impl RowsHead for GonioHead {
    fn is_of(&self, other: &Self) -> bool {
        self == other
    }
}

/// First line of the journal of a table over directions: identifies the table to which the rows belong.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TableHead {
    /// Version of the program.
    pub papilio: String,
    /// SHA-256 of the scenario and its files.
    pub hash: String,
    /// The options that determine the directions.
    pub directions: String,
}

impl RowsHead for TableHead {
    fn is_of(&self, other: &Self) -> bool {
        self == other
    }
}

impl RowsHead for SweepHead {
    fn is_of(&self, other: &Self) -> bool {
        self.papilio == other.papilio && self.light == other.light
    }
}

impl<H: RowsHead> JournalRows<H> {
    /// Opens or creates the journal of the whole computation, or of shard K of N. The rows of other journals
    /// with the same head, in the same folder and in the folders `others`, are also loaded.
    ///
    /// # Errors
    /// If a journal cannot be read or written, or another program has locked it; if one of `others` has
    /// journals, but none with this head.
    pub fn open(
        folder: &Path,
        stem: &str,
        shard: Option<(usize, usize)>,
        head: H,
        others: &[PathBuf],
    ) -> Result<Self, FormatError> {
        let name = journal_name(stem, shard);
        let mut journal = LockedJournal::hold(folder.join(&name))?;
        remove_abandoned(folder);
        journal.make_way(|path| {
            let found: Journal<H, JournalRow> = open_journal(path, |_| false)?;
            Ok(found.head.is_some_and(|own| head.is_of(&own)))
        })?;
        let mut known = BTreeMap::new();
        for (other, folder) in [folder].into_iter().chain(others.iter().map(PathBuf::as_path)).enumerate() {
            let journals = read_journals::<H, JournalRow>(folder, stem, |other| head.is_of(other))?;
            let is_ours =
                |journal: &Journal<H, JournalRow>| journal.head.as_ref().is_some_and(|own| head.is_of(own));
            match journals.first() {
                Some((path, _)) if other > 0 && !journals.iter().any(|(_, journal)| is_ours(journal)) => {
                    return Err(foreign_journal_error(path));
                }
                _ => {}
            }
            for (_, journal) in journals {
                known.extend(journal.lines.into_iter().map(JournalRow::into_numbers));
            }
        }
        let mine: Journal<H, JournalRow> = open_journal(journal.path(), |other| head.is_of(other))?;
        if mine.head.as_ref().is_some_and(|own| head.is_of(own)) {
            journal.cut(mine.whole)?;
        } else {
            journal.put(&head, std::iter::empty::<JournalRow>())?;
        }
        Ok(Self { journal, head, known })
    }

    /// Returns the path to which a journal of a different computation was moved, if there was one.
    pub fn set_aside(&self) -> Option<&Path> {
        self.journal.set_aside()
    }

    /// Returns the number of known rows, and of their numbers.
    pub fn count(&self) -> (usize, usize) {
        (self.known.len(), self.known.values().map(Vec::len).sum())
    }

    /// Returns the numbers of a row, if they are known.
    pub fn get(&self, row: usize) -> Option<&[f64]> {
        self.known.get(&row).map(Vec::as_slice)
    }

    /// Returns the numbers of a row, if they are known, and forgets them.
    pub fn take(&mut self, row: usize) -> Option<Vec<f64>> {
        self.known.remove(&row)
    }

    /// Saves a row. The operating system has it before this function returns.
    ///
    /// # Errors
    /// Those of the system.
    pub fn add(&mut self, row: usize, values: Vec<f64>) -> Result<(), FormatError> {
        self.journal.add(&line(row, &values))?;
        self.known.insert(row, values);
        Ok(())
    }

    /// Saves a row as [`add`](Self::add), but does not keep it in memory.
    ///
    /// # Errors
    /// Those of the system.
    pub fn save(&mut self, row: usize, values: &[f64]) -> Result<(), FormatError> {
        self.journal.add_row(row, values)
    }

    /// Rewrites the journal with these rows, in this order, and no others.
    ///
    /// # Errors
    /// Those of the system; the previous journal remains.
    pub fn finish(&mut self, rows: impl Iterator<Item = usize>) -> Result<(), FormatError> {
        let known = &self.known;
        let lines = rows.filter_map(|row| known.get(&row).map(|values| line(row, values)));
        self.journal.put(&self.head, lines)
    }
}

fn line(row: usize, values: &[f64]) -> JournalRow {
    JournalRow { row, values: values.iter().copied().map(JournalNumber).collect() }
}
