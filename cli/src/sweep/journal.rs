//! The journal of a sweep, which identifies points by the hash of their scenario.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use papilio_formats::{LockedJournal, SweepHead, SweepJournal, SweepPoint, open_journal, remove_abandoned};

use crate::Failure;
use crate::journal;

/// An open journal, and all known points by the hash of their scenario.
#[derive(Debug)]
pub(super) struct Journal {
    journal: LockedJournal,
    head: SweepHead,
    known: HashMap<String, SweepPoint>,
}

/// Names of journals begin with this.
pub(super) const STEM: &str = "sweep";

/// Paths and contents of all journals in a folder, in the order of their names.
pub(super) fn read_all(folder: &Path) -> Result<Vec<(PathBuf, SweepJournal)>, Failure> {
    journal::read_all(folder, STEM, |_: &SweepHead| true)
}

fn read(path: &Path) -> Result<SweepJournal, Failure> {
    Ok(open_journal(path, |_: &SweepHead| true)?)
}

impl Journal {
    /// Opens or creates the journal of a sweep in a folder. The points of other journals there, and of
    /// earlier forms of the sweep, are known too.
    pub(super) fn open(folder: &Path, name: &str, head: SweepHead) -> Result<Self, Failure> {
        let mut journal = LockedJournal::hold(folder.join(name))?;
        remove_abandoned(folder);
        let mut known = HashMap::new();
        for (_, other) in read_all(folder)? {
            let own = other.lines.into_iter().filter(|point| point.papilio == head.papilio);
            known.extend(own.map(|point| (point.hash.clone(), point)));
        }
        let mine = read(journal.path())?;
        if mine.head.as_ref() == Some(&head) {
            journal.cut(mine.whole)?;
        } else {
            // An earlier form of the sweep, or a new journal. Points stay, but their numbers are no longer
            // valid.
            let points = mine.lines.into_iter().map(|point| SweepPoint { point: None, ..point });
            journal.put(&head, points)?;
        }
        Ok(Self { journal, head, known })
    }

    /// The known result of a scenario.
    pub(super) fn find(&self, hash: &str) -> Option<&SweepPoint> {
        self.known.get(hash)
    }

    /// Hashes of all known points.
    pub(super) fn hashes(&self) -> std::collections::HashSet<String> {
        self.known.keys().cloned().collect()
    }

    /// Saves a point; it is on the disk when this returns.
    pub(super) fn add(&mut self, point: SweepPoint) -> Result<(), Failure> {
        self.journal.add(&point)?;
        self.known.insert(point.hash.clone(), point);
        Ok(())
    }

    /// Sorts the journal: first the points of the sweep by number, then its other points.
    pub(super) fn finish(mut self, points: &[(usize, String)]) -> Result<(), Failure> {
        let in_order = points.iter().filter_map(|(number, hash)| {
            self.known.get(hash).map(|point| SweepPoint { point: Some(*number), ..point.clone() })
        });
        let mut others = read(self.journal.path())?.lines;
        others.retain(|other| points.iter().all(|(_, hash)| *hash != other.hash));
        others.sort_by(|a, b| a.hash.cmp(&b.hash));
        others.dedup_by(|a, b| a.hash == b.hash);
        let others = others.into_iter().map(|point| SweepPoint { point: None, ..point });
        Ok(self.journal.put(&self.head, in_order.chain(others))?)
    }
}
