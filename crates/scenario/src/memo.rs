//! Cache of values that are expensive to resolve: measured scattering, and maps of light.
//!
//! The key of an entry is a text with everything that determines the value, together with the contents of the
//! files that were read. The resolver defines the type of the value.

use std::any::Any;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Largest number of entries; each has a few MB at most.
const MOST_ENTRIES: usize = 12;

/// Cache of resolved values, for scenarios that are resolved many times with small changes.
#[derive(Debug, Default)]
pub struct ResolveCache(Mutex<Vec<Entry>>);

/// A cached value.
#[derive(Debug, Clone)]
pub(crate) struct Entry {
    pub(crate) key: String,
    /// The value, with its warnings and notes.
    pub(crate) value: Arc<dyn Any + Send + Sync>,
    /// Names of the files that were read, with their SHA-256.
    pub(crate) inputs: Vec<(String, String)>,
}

impl ResolveCache {
    /// Finds an entry and marks it as used last. `is_same` tests whether a file still has this SHA-256.
    pub(crate) fn find(&self, key: &str, is_same: impl Fn(&str, &str) -> bool) -> Option<Entry> {
        let mut entries = self.entries();
        let holds = |entry: &Entry| entry.inputs.iter().all(|(name, sha256)| is_same(name, sha256));
        let found = entries.iter().position(|entry| entry.key == key && holds(entry))?;
        let entry = entries.remove(found);
        entries.push(entry.clone());
        Some(entry)
    }

    pub(crate) fn insert(&self, entry: Entry) {
        let mut entries = self.entries();
        entries.push(entry);
        let surplus = entries.len().saturating_sub(MOST_ENTRIES);
        entries.drain(..surplus);
    }

    fn entries(&self) -> MutexGuard<'_, Vec<Entry>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
