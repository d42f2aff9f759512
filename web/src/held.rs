//! Pictures whose states are decided: the panel holds them while lamps, films and eye move.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use papilio_display::image::{HeldPicture, ImageNumbers, KnownLights};
use papilio_display::palette::Palette;

/// Maximum number of pictures; the least recently used are removed first. A picture has a byte for each
/// pixel.
const MOST: usize = 32;

/// Maximum number of pictures in full size whose files are written: with a halftone, and without one for its palette.
const MOST_WRITTEN: usize = 2;

/// Pictures by their keys, in the order of their last use.
#[derive(Debug, Default)]
pub(crate) struct HeldPictures {
    /// Pictures in full size whose files were written last.
    written: Mutex<VecDeque<(String, Arc<WrittenPicture>)>>,
    pictures: Mutex<VecDeque<(String, Arc<HeldPicture>)>>,
    /// What is seen of the picture that was used last.
    known: Mutex<KnownLights>,
}

/// What the files of a picture contain.
#[derive(Debug)]
pub(crate) struct WrittenPicture {
    pub(crate) size: [usize; 2],
    pub(crate) states: Vec<u8>,
    pub(crate) on_screen: Vec<[u8; 3]>,
    pub(crate) numbers: ImageNumbers,
    pub(crate) palette: Palette,
}

impl HeldPictures {
    /// Returns the picture in full size with a key.
    pub(crate) fn written(&self, key: &str) -> Option<Arc<WrittenPicture>> {
        let written = self.written.lock().unwrap_or_else(PoisonError::into_inner);
        written.iter().find(|(known, _)| known == key).map(|(_, picture)| picture.clone())
    }

    /// Stores a picture in full size.
    pub(crate) fn insert_written(&self, key: String, picture: Arc<WrittenPicture>) {
        let mut written = self.written.lock().unwrap_or_else(PoisonError::into_inner);
        written.push_back((key, picture));
        if written.len() > MOST_WRITTEN {
            written.pop_front();
        }
    }

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
