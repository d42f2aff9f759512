//! Pieces of work on several threads, and what is kept of each as it comes.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc;

use crate::progress::Progress;
use crate::{Failure, interrupt};

/// Does pieces of work side by side until all are done or the program is interrupted.
///
/// Every thread has a worker of its own, made by `worker` of the threads that it may use in turn; it gives `None` where
/// it was interrupted. `keep` gets what was found, in any order, and says whether it was computed now or known before.
///
/// # Errors
/// The first failure of a worker or of `keep`, after which nothing is begun.
pub(crate) fn side_by_side<T: Send, W: FnMut(usize) -> Result<Option<T>, Failure>>(
    work: &[usize],
    unit: &'static str,
    threads: Option<u16>,
    worker: impl Fn(usize) -> W + Sync,
    mut keep: impl FnMut(T) -> Result<bool, Failure>,
) -> Result<(), Failure> {
    interrupt::heed();
    let threads =
        threads.map_or_else(|| std::thread::available_parallelism().map_or(1, usize::from), usize::from);
    let workers = threads.min(work.len()).max(1);
    let (next, stop) = (AtomicUsize::new(0), AtomicBool::new(false));
    let mut progress = Progress::new(work.len(), unit);
    // As many as wait to be kept: a slow disk must not fill the memory.
    let (sender, receiver) = mpsc::sync_channel::<Result<T, Failure>>(64 * workers);
    let mut failure = None;
    std::thread::scope(|scope| {
        for _ in 0..workers {
            let (sender, next, stop, worker) = (sender.clone(), &next, &stop, &worker);
            scope.spawn(move || {
                let mut worker = worker(threads / workers);
                while !stop.load(Ordering::Relaxed) && !interrupt::STOP.load(Ordering::Relaxed) {
                    let Some(&piece) = work.get(next.fetch_add(1, Ordering::Relaxed)) else { break };
                    match worker(piece).transpose() {
                        None => break,
                        Some(found) => drop(sender.send(found)),
                    }
                }
            });
        }
        drop(sender);
        for found in receiver {
            match found.and_then(&mut keep) {
                Ok(computed) => progress.done(computed),
                Err(error) => {
                    stop.store(true, Ordering::Relaxed);
                    failure.get_or_insert(error);
                }
            }
        }
    });
    failure.map_or(Ok(()), Err)
}
