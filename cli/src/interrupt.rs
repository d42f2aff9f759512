//! Ctrl-C: the first ends the computation with what is there, a second one the program.

use std::sync::atomic::{AtomicBool, Ordering};

/// Set by the first Ctrl-C.
pub(crate) static STOP: AtomicBool = AtomicBool::new(false);

/// Files are being written: they are finished first.
static WRITING: AtomicBool = AtomicBool::new(false);

/// Heeds Ctrl-C from now on.
pub(crate) fn heed() {
    // Without a handler Ctrl-C still ends the program, only less politely.
    let _ = ctrlc::set_handler(|| {
        if STOP.swap(true, Ordering::Relaxed) && !WRITING.load(Ordering::Relaxed) {
            std::process::exit(130);
        }
    });
}

/// Does something that Ctrl-C must not cut in two.
pub(crate) fn whole<T>(write: impl FnOnce() -> T) -> T {
    WRITING.store(true, Ordering::Relaxed);
    let result = write();
    WRITING.store(false, Ordering::Relaxed);
    result
}
