//! What costs much to resolve, kept for the next scenario that asks for the same: measured scattering, light maps.
//!
//! An entry is known by a text that names all it was made of, and by the contents of the files that were read on the way.
//! What an entry holds is the resolver's business.

use std::any::Any;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Entries that are kept; each is some MB at most.
const MOST: usize = 12;

/// What was resolved before; for scenarios that are resolved again and again with small changes.
#[derive(Debug, Default)]
pub struct Memo(Mutex<Vec<Entry>>);

/// One thing that was made.
#[derive(Debug, Clone)]
pub(crate) struct Entry {
    pub(crate) key: String,
    /// What it is, with all that was said while it was made.
    pub(crate) value: Arc<dyn Any + Send + Sync>,
    /// Files that were read, with their SHA-256.
    pub(crate) inputs: Vec<(String, String)>,
}

impl Memo {
    /// An entry, which is the last one used then; `is_same`: whether a file still has this SHA-256.
    pub(crate) fn find(&self, key: &str, is_same: impl Fn(&str, &str) -> bool) -> Option<Entry> {
        let mut entries = self.entries();
        let holds = |entry: &Entry| entry.inputs.iter().all(|(name, sha256)| is_same(name, sha256));
        let found = entries.iter().position(|entry| entry.key == key && holds(entry))?;
        let entry = entries.remove(found);
        entries.push(entry.clone());
        Some(entry)
    }

    pub(crate) fn keep(&self, entry: Entry) {
        let mut entries = self.entries();
        entries.push(entry);
        let surplus = entries.len().saturating_sub(MOST);
        entries.drain(..surplus);
    }

    fn entries(&self) -> MutexGuard<'_, Vec<Entry>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
