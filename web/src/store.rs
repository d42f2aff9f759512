//! Files that were dropped onto the page: in memory, known by their SHA-256, the least recently used forgotten first.

use std::collections::BTreeMap;
use std::sync::{Mutex, MutexGuard, PoisonError};

use papilio_formats::DataFile;
use papilio_scenario::KeptFile;

/// All files together, in bytes.
const MOST_BYTES: usize = 256 << 20;

/// Files by their ids.
#[derive(Debug, Default)]
pub(crate) struct Store(Mutex<Shelf>);

#[derive(Debug, Default)]
struct Shelf {
    files: BTreeMap<String, Stored>,
    /// Counts uses.
    now: u64,
}

#[derive(Debug)]
struct Stored {
    file: KeptFile,
    used: u64,
}

impl Store {
    /// Keeps a file, and returns its id. What was not used for longest makes room.
    pub(crate) fn keep(&self, file: DataFile) -> String {
        let file = KeptFile::new(file);
        let id = file.sha256().to_owned();
        let mut shelf = self.shelf();
        shelf.now += 1;
        let used = shelf.now;
        shelf.files.insert(id.clone(), Stored { file, used });
        shelf.make_room();
        id
    }

    /// The file of an id.
    pub(crate) fn get(&self, id: &str) -> Option<KeptFile> {
        let mut shelf = self.shelf();
        shelf.now += 1;
        let now = shelf.now;
        let stored = shelf.files.get_mut(id)?;
        stored.used = now;
        Some(stored.file.clone())
    }

    /// Nothing is left half done by a thread that failed.
    fn shelf(&self) -> MutexGuard<'_, Shelf> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Shelf {
    fn make_room(&mut self) {
        let bytes = |files: &BTreeMap<String, Stored>| -> usize {
            files.values().map(|stored| stored.file.file().bytes.len()).sum()
        };
        while bytes(&self.files) > MOST_BYTES && self.files.len() > 1 {
            let oldest = self.files.iter().min_by_key(|(_, stored)| stored.used);
            let Some(id) = oldest.map(|(id, _)| id.clone()) else { break };
            self.files.remove(&id);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_not_used_for_longest_makes_room() {
        let store = Store::default();
        let file = |byte: u8| DataFile { name: "a".to_owned(), bytes: vec![byte; MOST_BYTES / 3] };
        let ids = [1, 2, 3].map(|byte| store.keep(file(byte)));
        assert!(store.get(&ids[0]).is_some());
        let last = store.keep(file(4));
        let known = |id: &str| store.get(id).is_some();
        assert!(known(&ids[0]) && !known(&ids[1]) && known(&ids[2]) && known(&last));
        assert_eq!(store.keep(file(4)), last);
    }
}
