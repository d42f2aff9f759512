//! Pictures whose states are decided: the panel holds them while lamps, films and eye move.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use papilio_display::image::{HeldPicture, KnownLights};

/// Maximum number of pictures; the least recently used are removed first. A picture has a byte for each
/// pixel.
const MOST: usize = 32;

/// Pictures by their keys, in the order of their last use.
#[derive(Debug, Default)]
pub(crate) struct HeldPictures {
    pictures: Mutex<VecDeque<(String, Arc<HeldPicture>)>>,
    /// What is seen of the picture that was used last.
    known: Mutex<KnownLights>,
}

impl HeldPictures {
    /// Returns the picture with a key.
    pub(crate) fn get(&self, key: &str) -> Option<Arc<HeldPicture>> {
        let mut pictures = self.pictures();
        let index = pictures.iter().position(|(known, _)| known == key)?;
        let found = pictures.remove(index)?;
        let picture = found.1.clone();
        pictures.push_back(found);
        Some(picture)
    }

    /// Stores a picture.
    pub(crate) fn insert(&self, key: String, picture: Arc<HeldPicture>) {
        let mut pictures = self.pictures();
        pictures.retain(|(known, _)| *known != key);
        pictures.push_back((key, picture));
        if pictures.len() > MOST {
            pictures.pop_front();
        }
    }

    /// Takes what is known of the picture that was used last; nothing while another request uses it.
    pub(crate) fn known(&self) -> KnownLights {
        std::mem::take(&mut *self.known.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Stores what is known now.
    pub(crate) fn set_known(&self, known: KnownLights) {
        *self.known.lock().unwrap_or_else(PoisonError::into_inner) = known;
    }

    fn pictures(&self) -> MutexGuard<'_, VecDeque<(String, Arc<HeldPicture>)>> {
        self.pictures.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
