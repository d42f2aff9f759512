//! The journal of a table over directions (`brdf`, `run --cone`): an interrupted one is resumed.
//!
//! A row is saved if that takes little time in comparison with its computation; other rows are computed again.

use std::path::Path;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use papilio_display::SavedRows;
use papilio_formats::{FormatError, JournalRows, TableHead, journal_name};

use crate::journal::open_rows;
use crate::{Failure, output, print_message};

/// Fraction of the time that saving may take.
const MOST_TIME: f64 = 0.05;

/// Time to write a number, about, s.
const SECONDS_FOR_NUMBER: f64 = 0.15e-6;

/// Largest number of numbers in a journal, which take 20 bytes each there, and 8 in memory.
const MOST_NUMBERS: usize = 20_000_000;

/// An open journal.
pub(crate) struct SavedTable<'a> {
    folder: &'a Path,
    stem: &'static str,
    state: Mutex<State>,
    started: Instant,
}

struct State {
    /// None after an error.
    journal: Option<JournalRows<TableHead>>,
    /// Numbers in the journal.
    numbers: usize,
    /// Rows in the journal.
    rows: usize,
    /// Time that saving took, s.
    seconds: f64,
}

impl<'a> SavedTable<'a> {
    /// Opens the journal of a table in a folder, which is created; `directions` are the options that determine its
    /// rows.
    pub(crate) fn open(
        folder: &'a Path,
        stem: &'static str,
        hash: &str,
        directions: String,
    ) -> Result<Self, Failure> {
        output::make_folder(folder)?;
        let papilio = env!("CARGO_PKG_VERSION").to_owned();
        let journal =
            open_rows(folder, stem, None, TableHead { papilio, hash: hash.to_owned(), directions }, &[])?;
        let (rows, numbers) = journal.count();
        if rows > 0 {
            print_message(&format!("{rows} rows are known from the interrupted computation"));
        }
        let state = State { journal: Some(journal), numbers, rows, seconds: 0.0 };
        Ok(Self { folder, stem, state: Mutex::new(state), started: Instant::now() })
    }

    /// Rows of part number `part` of `parts`.
    pub(crate) fn part(&self, part: usize, parts: usize) -> impl SavedRows + '_ {
        Part { table: self, part, parts }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Removes the journal, from which nothing is to be resumed, and its folder, if it is empty.
    pub(crate) fn discard(self) -> Result<(), Failure> {
        let Self { folder, stem, state, .. } = self;
        drop(state);
        output::remove(folder, |name| name == journal_name(stem, None))?;
        // A folder with other files stays.
        let _ = std::fs::remove_dir(folder);
        Ok(())
    }

    /// The end of an interrupted computation: what there is to resume from. Without any row, the journal is removed.
    pub(crate) fn interrupted(self, nothing: &'static str, resume: &'static str) -> Failure {
        let rows = self.state().rows;
        if rows > 0 {
            return Failure::Interrupted(resume);
        }
        self.discard().err().unwrap_or(Failure::Interrupted(nothing))
    }
}

impl State {
    /// Saves a row, if there is time for it.
    fn save(&mut self, row: usize, numbers: &[f64], elapsed: Duration) -> Result<(), FormatError> {
        let seconds = self.seconds + SECONDS_FOR_NUMBER * numbers.len() as f64;
        let is_quick = seconds <= MOST_TIME * elapsed.as_secs_f64();
        let Some(journal) = &mut self.journal else { return Ok(()) };
        if is_quick && self.numbers + numbers.len() <= MOST_NUMBERS {
            let begin = Instant::now();
            journal.save(row, numbers)?;
            self.seconds += begin.elapsed().as_secs_f64();
            self.numbers += numbers.len();
            self.rows += 1;
        }
        Ok(())
    }
}

/// Rows of a part of a table.
struct Part<'a> {
    table: &'a SavedTable<'a>,
    part: usize,
    parts: usize,
}

impl SavedRows for Part<'_> {
    fn find(&self, row: usize) -> Option<Vec<f64>> {
        self.table.state().journal.as_mut()?.take(row * self.parts + self.part)
    }

    fn save(&self, row: usize, numbers: &[f64]) {
        let mut state = self.table.state();
        let saved = state.save(row * self.parts + self.part, numbers, self.table.started.elapsed());
        if let Err(error) = saved {
            // The table itself may still be written, to this folder or not.
            state.journal = None;
            drop(state);
            print_message(&format!("warning: rows are not saved any more: {error}"));
        }
    }
}
