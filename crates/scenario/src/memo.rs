//! Cache of values that are expensive to resolve: measured scattering, and maps of light.
//!
//! The key of an entry is a text with everything that determines the value, together with the contents of the
//! files that were read. The resolver defines the type of the value.

use std::any::Any;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Largest number of entries.
const MOST_ENTRIES: usize = 12;

/// Largest number of entries with maps of light. Over a tilted display, each channel of a map has a million cells (34 MB); all other
/// entries have a few MB at most.
const MOST_MAPS: usize = 1;

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
    /// Whether the value is a map of light.
    pub(crate) is_map: bool,
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
        let mut left = entries.iter().filter(|entry| entry.is_map).count();
        entries.retain(|entry| {
            let is_surplus = entry.is_map && left > MOST_MAPS;
            left -= usize::from(is_surplus);
            !is_surplus
        });
    }

    /// Removes all entries, which are resolved again when they are needed.
    pub fn clear(&self) {
        self.entries().clear();
    }

    fn entries(&self) -> MutexGuard<'_, Vec<Entry>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_last_map_is_stored_and_clear_removes_all() {
        let cache = ResolveCache::default();
        let entry =
            |key: &str, is_map| Entry { key: key.into(), value: Arc::new(()), inputs: Vec::new(), is_map };
        for (key, is_map) in
            [("map 1", true), ("film", false), ("map 2", true), ("foil", false), ("map 3", true)]
        {
            cache.insert(entry(key, is_map));
        }
        let has = |key: &str| cache.find(key, |_, _| true).is_some();
        assert!(!has("map 1") && !has("map 2"));
        assert!(has("map 3") && has("film") && has("foil"));
        cache.clear();
        assert!(!has("film") && !has("map 3"));
    }
}
