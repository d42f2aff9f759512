//! The program as a job of the web app. Its standard input is a pipe from the server: when it ends, so does the job, as after Ctrl-C.

use std::fs::File;
use std::io::{Read, stdin};
use std::time::Duration;

use crate::interrupt;

/// Time for which finished work is saved before the program ends.
const GRACE: Duration = Duration::from_secs(8);

/// If this is a job, waits until an earlier process has left the folder, and follows the server from then on.
pub(crate) fn follow_server() {
    let Some(lock) = std::env::var_os(papilio_web::LOCK_VARIABLE) else { return };
    if let Ok(file) = File::open(lock)
        && file.lock().is_ok()
    {
        // The lock is held until the process ends.
        std::mem::forget(file);
    }
    std::thread::spawn(|| {
        let mut byte = [0; 64];
        while stdin().read(&mut byte).is_ok_and(|count| count > 0) {}
        interrupt::end(GRACE);
    });
}
