//! Stores the prepared displays of the last few computations, so that small changes are fast.

use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use papilio_display::result::RunResult;
use papilio_display::scene::Scene;
use papilio_display::{Control, DisplayError, Prepared};
use schemars::JsonSchema;
use serde::Deserialize;

use crate::site::Site;

/// Maximum number of prepared displays: two designs that are compared, and some more.
const MAX_DISPLAYS: usize = 6;

/// Maximum number of displays with general layers, whose matrices take up to 256 MB at each of two levels: two designs, with
/// one view and with all.
const MAX_LARGE: usize = 4;

/// If the whole process uses more memory than this, in bytes, only the display that was used last is stored, and none while another
/// one is prepared. A new server takes about 50 MB; to prepare a display with general layers takes up to 350 MB.
const MAX_MEMORY: usize = 288 << 20;

/// While nobody uses the server, prepared displays but the last one and resolved values are released if the process uses more memory
/// than this, in bytes.
const REST_MEMORY: usize = 192 << 20;

/// The last one, too, above this.
const MAX_REST_MEMORY: usize = 320 << 20;

/// Time without a computation after which that is checked, and time between two checks.
const REST: Duration = Duration::from_secs(20);
const BETWEEN_CHECKS: Duration = Duration::from_secs(5);

/// Scenes with more views than this are not stored, because each view has its own kernels.
const MAX_VIEWS: usize = 200;

/// Accuracy of an answer.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Accuracy {
    /// The target of the scenario.
    #[default]
    Exact,
    /// As soon as possible, with its error.
    First,
}

/// Prepared displays that are not in use, in the order of their last use.
#[derive(Debug, Default)]
pub(crate) struct PreparedDisplays {
    entries: Mutex<Vec<Entry>>,
    /// When one was used last.
    last_use: Mutex<Option<Instant>>,
}

#[derive(Debug)]
struct Entry {
    scene: Scene,
    prepared: Prepared,
}

impl PreparedDisplays {
    /// Computes a scene with the prepared display that is most similar to it. The result equals that of
    /// [`papilio_display::run`] to the last bit.
    pub(crate) fn run(&self, scene: &Scene, control: &Control<'_>) -> Result<RunResult, DisplayError> {
        self.answer(scene, Accuracy::Exact, control)
    }

    /// Computes an answer of this accuracy in the same way.
    pub(crate) fn answer(
        &self,
        scene: &Scene,
        accuracy: Accuracy,
        control: &Control<'_>,
    ) -> Result<RunResult, DisplayError> {
        self.with(scene, control, |prepared| match accuracy {
            Accuracy::Exact => prepared.run(scene, control),
            Accuracy::First => prepared.first(scene, control),
        })
    }

    /// Computes something with the prepared display that is most similar to a scene.
    pub(crate) fn with<T>(
        &self,
        scene: &Scene,
        control: &Control<'_>,
        compute: impl FnOnce(&mut Prepared) -> Result<T, DisplayError>,
    ) -> Result<T, DisplayError> {
        self.used();
        let mut prepared = match self.take(scene) {
            Some(entry) => entry.prepared,
            None => {
                if memory_in_use() > MAX_MEMORY {
                    self.entries().clear();
                }
                Prepared::new(scene, control)?
            }
        };
        let result = compute(&mut prepared);
        // An interrupted computation leaves the prepared display usable.
        let is_usable = matches!(result, Ok(_) | Err(DisplayError::Interrupted));
        if is_usable && views(scene) <= MAX_VIEWS {
            let mut entries = self.entries();
            entries.push(Entry { scene: scene.clone(), prepared });
            remove_oldest(&mut entries, memory_in_use());
        }
        self.used();
        result
    }

    fn used(&self) {
        *self.last_use.lock().unwrap_or_else(PoisonError::into_inner) = Some(Instant::now());
    }

    /// Releases all displays but the one that was used last, if nobody has used any for a while and the process uses much memory; and
    /// this one, too, if that is not enough. Returns true if memory is to be released.
    fn rest(&self) -> bool {
        let last = *self.last_use.lock().unwrap_or_else(PoisonError::into_inner);
        let memory = memory_in_use();
        let is_due = last.is_some_and(|last| last.elapsed() > REST) && memory > REST_MEMORY;
        if is_due {
            let mut entries = self.entries();
            let surplus = entries.len().saturating_sub(1);
            if surplus == 0 && memory > MAX_REST_MEMORY {
                entries.clear();
            }
            entries.drain(..surplus);
        }
        is_due
    }

    /// Takes out the display that has most in common with a scene, if it has anything in common; of several
    /// equal ones, the one that was used last.
    fn take(&self, scene: &Scene) -> Option<Entry> {
        let mut entries = self.entries();
        let best = (0..entries.len()).max_by_key(|index| similarity(&entries[*index].scene, scene))?;
        (similarity(&entries[best].scene, scene) > 0).then(|| entries.remove(best))
    }

    fn entries(&self) -> MutexGuard<'_, Vec<Entry>> {
        self.entries.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Releases displays and resolved values while nobody uses the server, without end.
pub(crate) async fn release_at_rest(site: Site) {
    loop {
        tokio::time::sleep(BETWEEN_CHECKS).await;
        let site = site.clone();
        // To free a large display takes time.
        let _ = tokio::task::spawn_blocking(move || {
            if site.prepared().rest() {
                site.memo().clear();
                wake_allocator();
            }
        })
        .await;
    }
}

/// Allocates and releases a large block. The allocator returns memory that was freed to the system only when a large block is
/// released at least a second later, which at rest would not happen.
fn wake_allocator() {
    drop(std::hint::black_box(Vec::<u8>::with_capacity(8 << 20)));
}

/// Resident memory of this process in bytes; 0 if the system does not report it.
fn memory_in_use() -> usize {
    memory_stats::memory_stats().map_or(0, |stats| stats.physical_mem)
}

/// Removes the displays that were used least recently, until all limits are satisfied.
fn remove_oldest(entries: &mut Vec<Entry>, memory_in_use: usize) {
    if memory_in_use > MAX_MEMORY {
        entries.drain(..entries.len().saturating_sub(1));
    }
    let is_large = |entry: &Entry| entry.scene.display.panel().is_none();
    while entries.iter().filter(|entry| is_large(entry)).count() > MAX_LARGE {
        if let Some(first) = entries.iter().position(is_large) {
            entries.remove(first);
        }
    }
    entries.drain(..entries.len().saturating_sub(MAX_DISPLAYS));
}

/// Measures how much of a prepared display can be used for a scene; 0: nothing.
fn similarity(prepared: &Scene, wanted: &Scene) -> u32 {
    let differs = prepared.grid != wanted.grid || prepared.metrics.observer != wanted.metrics.observer;
    // Different numbers of views: a scan of angles must not replace the display that a single view uses.
    if differs || views(prepared) != views(wanted) {
        return 0;
    }
    // The operators of general layers take most time to compute, the reflectances of a film come next.
    let layers = match (prepared.display.has_layers_of(&wanted.display), wanted.display.panel()) {
        (true, None) => 16,
        (true, Some(_)) => 4,
        (false, _) => 0,
    };
    let pixel = if prepared.display.pixel == wanted.display.pixel { 8 } else { 0 };
    let light = if prepared.lighting == wanted.lighting { 2 } else { 0 };
    let viewer = if prepared.viewer == wanted.viewer { 1 } else { 0 };
    layers + pixel + light + viewer
}

fn views(scene: &Scene) -> usize {
    scene.viewer.theta_deg.len() * scene.viewer.phi_deg.len()
}
