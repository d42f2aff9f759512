//! Uploaded files, in memory, identified by their SHA-256; the least recently used are removed first.

use std::collections::BTreeMap;
use std::sync::{Mutex, MutexGuard, PoisonError};

use papilio_formats::DataFile;
use papilio_scenario::MemoryFile;

/// Maximum size of all files together, in bytes.
const MOST_BYTES: usize = 256 << 20;

/// Files by their ids.
#[derive(Debug, Default)]
pub(crate) struct Store(Mutex<Contents>);

#[derive(Debug, Default)]
struct Contents {
    files: BTreeMap<String, Stored>,
    /// Number of uses so far.
    uses: u64,
}

#[derive(Debug)]
struct Stored {
    file: MemoryFile,
    /// The use count at the last use.
    last_use: u64,
}

impl Store {
    /// Stores a file and returns its id. The least recently used files are removed if there are too many.
    pub(crate) fn insert(&self, file: DataFile) -> String {
        let file = MemoryFile::new(file);
        let id = file.sha256().to_owned();
        let mut contents = self.contents();
        contents.uses += 1;
        let last_use = contents.uses;
        contents.files.insert(id.clone(), Stored { file, last_use });
        contents.remove_oldest();
        id
    }

    /// Returns the file with an id.
    pub(crate) fn get(&self, id: &str) -> Option<MemoryFile> {
        let mut contents = self.contents();
        contents.uses += 1;
        let last_use = contents.uses;
        let stored = contents.files.get_mut(id)?;
        stored.last_use = last_use;
        Some(stored.file.clone())
    }

    /// Locks the contents. A poisoned lock is accepted: no panic leaves the contents inconsistent.
    fn contents(&self) -> MutexGuard<'_, Contents> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Contents {
    fn remove_oldest(&mut self) {
        let bytes = |files: &BTreeMap<String, Stored>| -> usize {
            files.values().map(|stored| stored.file.file().bytes.len()).sum()
        };
        while bytes(&self.files) > MOST_BYTES && self.files.len() > 1 {
            let oldest = self.files.iter().min_by_key(|(_, stored)| stored.last_use);
            let Some(id) = oldest.map(|(id, _)| id.clone()) else { break };
            self.files.remove(&id);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn least_recently_used_file_is_removed_when_the_store_is_full() {
        let store = Store::default();
        let file = |byte: u8| DataFile { name: "a".to_owned(), bytes: vec![byte; MOST_BYTES / 3] };
        let ids = [1, 2, 3].map(|byte| store.insert(file(byte)));
        assert!(store.get(&ids[0]).is_some());
        let last = store.insert(file(4));
        let known = |id: &str| store.get(id).is_some();
        assert!(known(&ids[0]) && !known(&ids[1]) && known(&ids[2]) && known(&last));
        assert_eq!(store.insert(file(4)), last);
    }
}
