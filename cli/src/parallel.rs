//! Parallel computation of work items, whose results are stored as they arrive.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc;

use crate::progress::Progress;
use crate::{Failure, interrupt};

/// Computes work items in parallel until all are done or the program is interrupted.
///
/// Each thread has its own worker. `worker` creates it for the number of threads that it may use itself; a
/// worker returns `None` if it was interrupted. `store` receives the results in any order, and returns
/// whether the result was computed now (true) or was known before (false).
///
/// # Errors
/// The first failure of a worker or of `store`. After a failure no item is started.
pub(crate) fn compute_parallel<T: Send, W: FnMut(usize) -> Result<Option<T>, Failure>>(
    work: &[usize],
    unit: &'static str,
    threads: Option<u16>,
    worker: impl Fn(usize) -> W + Sync,
    mut store: impl FnMut(T) -> Result<bool, Failure>,
) -> Result<(), Failure> {
    interrupt::catch_ctrl_c();
    let threads =
        threads.map_or_else(|| std::thread::available_parallelism().map_or(1, usize::from), usize::from);
    let workers = threads.min(work.len()).max(1);
    let (next, stop) = (AtomicUsize::new(0), AtomicBool::new(false));
    let mut progress = Progress::new(work.len(), unit);
    // Bounds the number of results that wait to be stored: a slow disk must not fill the memory.
    let (sender, receiver) = mpsc::sync_channel::<Result<T, Failure>>(64 * workers);
    let mut failure = None;
    std::thread::scope(|scope| {
        for _ in 0..workers {
            let (sender, next, stop, worker) = (sender.clone(), &next, &stop, &worker);
            scope.spawn(move || {
                let mut worker = worker(threads / workers);
                while !stop.load(Ordering::Relaxed) && !interrupt::STOP.load(Ordering::Relaxed) {
                    let Some(&item) = work.get(next.fetch_add(1, Ordering::Relaxed)) else { break };
                    match worker(item).transpose() {
                        None => break,
                        Some(result) => drop(sender.send(result)),
                    }
                }
            });
        }
        drop(sender);
        for result in receiver {
            match result.and_then(&mut store) {
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
