//! What costs much to resolve, kept for the next scenario that asks for the same: measured scattering, light maps.
//!
//! An entry is known by a text that names all it was made of, and by the contents of the files that were read on the way.

use std::any::Any;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use papilio_formats::LARGEST_BSDF_FILE;

use super::Resolver;
use super::maps::MapLight;
use crate::library::Library;

/// Entries that are kept; each is some MB at most.
const MOST: usize = 12;

/// What was resolved before; for scenarios that are resolved again and again with small changes.
#[derive(Debug, Default)]
pub struct Memo(Mutex<Vec<Entry>>);

#[derive(Debug, Clone)]
struct Entry {
    key: String,
    value: Arc<dyn Any + Send + Sync>,
    /// What was said while it was made.
    warnings: Vec<String>,
    notes: Vec<String>,
    maps: Vec<MapLight>,
    /// Files that were read, with their SHA-256.
    inputs: Vec<(String, String)>,
}

impl Memo {
    /// An entry, which is the last one used then.
    fn find(&self, key: &str, library: &Library) -> Option<Entry> {
        let mut entries = self.entries();
        let is_same = |(name, sha256): &(String, String)| {
            library.open(name, LARGEST_BSDF_FILE).is_ok_and(|kept| kept.sha256() == sha256)
        };
        let at = entries.iter().position(|entry| entry.key == key && entry.inputs.iter().all(is_same))?;
        let entry = entries.remove(at);
        entries.push(entry.clone());
        Some(entry)
    }

    fn keep(&self, entry: Entry) {
        let mut entries = self.entries();
        entries.push(entry);
        let surplus = entries.len().saturating_sub(MOST);
        entries.drain(..surplus);
    }

    fn entries(&self) -> MutexGuard<'_, Vec<Entry>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Resolver<'_> {
    /// What `make` gives and says, from the memo if there is one that has it. `key` is to name all that it depends on,
    /// but for wavelengths and what is in files. Errors are never kept.
    pub(super) fn once<T: Clone + Send + Sync + 'static>(
        &mut self,
        key: impl FnOnce() -> String,
        make: impl FnOnce(&mut Self) -> Option<T>,
    ) -> Option<T> {
        let library = self.library;
        let Library::Memory { memo, .. } = library else { return make(self) };
        let key = format!("{:?} {}", self.grid, key());
        if let Some(entry) = memo.find(&key, library)
            && let Some(value) = entry.value.downcast_ref::<T>()
        {
            self.warnings.extend(entry.warnings);
            self.notes.extend(entry.notes);
            self.maps.extend(entry.maps);
            self.inputs.extend(entry.inputs);
            return Some(value.clone());
        }
        // What `make` reads and says is told from what was read and said before.
        let inputs = std::mem::take(&mut self.inputs);
        let (warnings, notes, maps) = (self.warnings.len(), self.notes.len(), self.maps.len());
        let value = make(self);
        let read = std::mem::replace(&mut self.inputs, inputs);
        if let Some(value) = value.as_ref().filter(|_| self.errors.is_empty()) {
            memo.keep(Entry {
                key,
                value: Arc::new(value.clone()),
                warnings: self.warnings[warnings..].to_vec(),
                notes: self.notes[notes..].to_vec(),
                maps: self.maps[maps..].to_vec(),
                inputs: read.clone().into_iter().collect(),
            });
        }
        self.inputs.extend(read);
        value
    }
}
