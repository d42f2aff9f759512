//! Resolved values that are cached in the library.

use std::sync::Arc;

use papilio_formats::LARGEST_BSDF_FILE;
use papilio_spectra::Tabulated;

use super::Resolver;
use super::maps::MapLight;
use crate::library::Library;
use crate::memo::Entry;

/// A resolved value with its warnings and notes.
struct CachedValue<T> {
    value: T,
    warnings: Vec<String>,
    notes: Vec<String>,
    maps: Vec<MapLight>,
    tables: Vec<(String, Tabulated)>,
    is_tabulated: bool,
}

impl Resolver<'_> {
    /// Returns the value of `make` with its warnings and notes, from the cache if it is there. `key` must
    /// contain everything that determines the value, except the wavelengths and the contents of files. Errors
    /// are not cached.
    pub(super) fn cached<T: Clone + Send + Sync + 'static>(
        &mut self,
        key: impl FnOnce() -> String,
        make: impl FnOnce(&mut Self) -> Option<T>,
    ) -> Option<T> {
        let library = self.library;
        let Library::Memory { memo, .. } = library else { return make(self) };
        let key = format!("{:?} {}", self.grid, key());
        let is_same = |name: &str, sha256: &str| {
            library.open(name, LARGEST_BSDF_FILE).is_ok_and(|kept| kept.sha256() == sha256)
        };
        if let Some(entry) = memo.find(&key, is_same)
            && let Some(made) = entry.value.downcast_ref::<CachedValue<T>>()
        {
            self.warnings.extend_from_slice(&made.warnings);
            self.notes.extend_from_slice(&made.notes);
            self.maps.extend_from_slice(&made.maps);
            self.tables.extend_from_slice(&made.tables);
            self.is_tabulated |= made.is_tabulated;
            self.inputs.extend(entry.inputs);
            return Some(made.value.clone());
        }
        // The inputs and notes of `make` are separated from the earlier ones.
        let inputs = std::mem::take(&mut self.inputs);
        let (warnings, notes) = (self.warnings.len(), self.notes.len());
        let (maps, tables) = (self.maps.len(), self.tables.len());
        let before = std::mem::take(&mut self.is_tabulated);
        let value = make(self);
        let read = std::mem::replace(&mut self.inputs, inputs);
        if let Some(value) = value.as_ref().filter(|_| self.errors.is_empty()) {
            let made = CachedValue {
                value: value.clone(),
                warnings: self.warnings[warnings..].to_vec(),
                notes: self.notes[notes..].to_vec(),
                maps: self.maps[maps..].to_vec(),
                tables: self.tables[tables..].to_vec(),
                is_tabulated: self.is_tabulated,
            };
            let is_map = !made.maps.is_empty();
            memo.insert(Entry {
                key,
                value: Arc::new(made),
                inputs: read.clone().into_iter().collect(),
                is_map,
            });
        }
        self.inputs.extend(read);
        self.is_tabulated |= before;
        value
    }
}
