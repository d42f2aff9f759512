//! Ctrl-C: the first one ends the computation with the finished work, a second one ends the program.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Set by the first Ctrl-C.
pub(crate) static STOP: AtomicBool = AtomicBool::new(false);

/// True while files are written: the program does not end before they are complete.
static WRITING: AtomicBool = AtomicBool::new(false);

/// Installs the handler of Ctrl-C.
pub(crate) fn catch_ctrl_c() {
    // If this fails, Ctrl-C ends the program without saving the current result.
    let _ = ctrlc::set_handler(|| {
        if STOP.swap(true, Ordering::Relaxed) && !WRITING.load(Ordering::Relaxed) {
            std::process::exit(130);
        }
    });
}

/// Ends the computation with the finished work, and the program after `grace`.
pub(crate) fn end(grace: Duration) {
    STOP.store(true, Ordering::Relaxed);
    std::thread::sleep(grace);
    while WRITING.load(Ordering::Relaxed) {
        std::thread::sleep(grace / 100);
    }
    std::process::exit(130);
}

/// Runs `write` to its end, even if the user presses Ctrl-C twice.
pub(crate) fn uninterrupted<T>(write: impl FnOnce() -> T) -> T {
    WRITING.store(true, Ordering::Relaxed);
    let result = write();
    WRITING.store(false, Ordering::Relaxed);
    result
}
