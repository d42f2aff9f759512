//! Prepared displays: the last few that were computed, each ready for the next small change, as long as there is memory.

use std::sync::{Mutex, MutexGuard, PoisonError};

use papilio_display::result::RunResult;
use papilio_display::scene::{Layers, Scene};
use papilio_display::{Control, DisplayError, Prepared};

/// Two designs side by side, and some more.
const MOST: usize = 6;

/// Those through any layers hold matrices, up to 256 MB for each of two levels.
const MOST_LARGE: usize = 2;

/// With more memory than this in use by the whole process, in bytes, only the display that was used last is kept. A
/// fresh server has about 50 MB; a display through any layers may hold 256 MB at each of two levels.
const MOST_MEMORY: usize = 384 << 20;

/// Scenes with more views than this leave nothing behind: each view has kernels of its own.
const MOST_VIEWS: usize = 200;

/// Prepared displays that nobody uses at the moment; the last one used is the last here.
#[derive(Debug, Default)]
pub(crate) struct Kept(Mutex<Vec<Ready>>);

#[derive(Debug)]
struct Ready {
    scene: Scene,
    prepared: Prepared,
}

impl Kept {
    /// Runs a scene through the display that is most like it; to the last bit what [`papilio_display::run`] gives.
    pub(crate) fn run(&self, scene: &Scene, control: &Control<'_>) -> Result<RunResult, DisplayError> {
        let mut prepared = match self.take(scene) {
            Some(ready) => ready.prepared,
            None => Prepared::new(scene)?,
        };
        let result = prepared.run(scene, control);
        // Stopped, it is as good as before.
        let is_sound = matches!(result, Ok(_) | Err(DisplayError::Interrupted));
        if is_sound && views(scene) <= MOST_VIEWS {
            let mut shelf = self.shelf();
            shelf.push(Ready { scene: scene.clone(), prepared });
            make_room(&mut shelf, memory_in_use());
        }
        result
    }

    /// The display that has most in common with a scene, if it has anything; of those alike, the last one used.
    fn take(&self, scene: &Scene) -> Option<Ready> {
        let mut shelf = self.shelf();
        let best = (0..shelf.len()).max_by_key(|at| in_common(&shelf[*at].scene, scene))?;
        (in_common(&shelf[best].scene, scene) > 0).then(|| shelf.remove(best))
    }

    fn shelf(&self) -> MutexGuard<'_, Vec<Ready>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Resident memory of this process in bytes; 0 where the system does not tell.
fn memory_in_use() -> usize {
    memory_stats::memory_stats().map_or(0, |stats| stats.physical_mem)
}

/// Forgets what was used longest ago.
fn make_room(shelf: &mut Vec<Ready>, memory_in_use: usize) {
    if memory_in_use > MOST_MEMORY {
        shelf.drain(..shelf.len().saturating_sub(1));
    }
    let is_large = |ready: &Ready| matches!(ready.scene.display.layers, Layers::General(_));
    while shelf.iter().filter(|ready| is_large(ready)).count() > MOST_LARGE {
        if let Some(first) = shelf.iter().position(is_large) {
            shelf.remove(first);
        }
    }
    shelf.drain(..shelf.len().saturating_sub(MOST));
}

/// How much of one display serves for another; 0: nothing.
fn in_common(kept: &Scene, wanted: &Scene) -> u32 {
    let other = kept.grid != wanted.grid || kept.metrics.observer != wanted.metrics.observer;
    // A scan of angles does not take away what a single view needs.
    if other || views(kept) != views(wanted) {
        return 0;
    }
    // Operators of any layers cost most, a film's reflectances next.
    let layers = match (kept.display.layers == wanted.display.layers, &wanted.display.layers) {
        (true, Layers::General(_)) => 16,
        (true, Layers::Panel(_)) => 4,
        (false, _) => 0,
    };
    let pixel = if kept.display.pixel == wanted.display.pixel { 8 } else { 0 };
    let light = if kept.lighting == wanted.lighting { 2 } else { 0 };
    let viewer = if kept.viewer == wanted.viewer { 1 } else { 0 };
    layers + pixel + light + viewer
}

fn views(scene: &Scene) -> usize {
    scene.viewer.theta_deg.len() * scene.viewer.phi_deg.len()
}
