//! Items on several threads, each with a worker.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use crate::DesignError;

/// Computes items on threads, each with its own worker; returns them in order. The first error ends all.
pub(crate) fn in_parallel<W: Send, T: Send>(
    threads: usize,
    count: usize,
    done: impl Fn(usize) + Sync,
    worker: impl Fn() -> W + Sync,
    compute: impl Fn(&mut W, usize) -> Result<T, DesignError> + Sync,
) -> Result<Vec<T>, DesignError> {
    let results: Mutex<Vec<Option<Result<T, DesignError>>>> = Mutex::new((0..count).map(|_| None).collect());
    let (next, finished, failed) = (AtomicUsize::new(0), AtomicUsize::new(0), AtomicBool::new(false));
    done(0);
    std::thread::scope(|scope| {
        for _ in 0..threads.clamp(1, count.max(1)) {
            scope.spawn(|| {
                let mut worker = worker();
                while !failed.load(Ordering::Relaxed) {
                    let item = next.fetch_add(1, Ordering::Relaxed);
                    if item >= count {
                        break;
                    }
                    let result = compute(&mut worker, item);
                    if result.is_err() {
                        failed.store(true, Ordering::Relaxed);
                    }
                    results.lock().unwrap_or_else(PoisonError::into_inner)[item] = Some(result);
                    done(finished.fetch_add(1, Ordering::Relaxed) + 1);
                }
            });
        }
    });
    let results = results.into_inner().unwrap_or_else(PoisonError::into_inner);
    if let Some(error) = results.iter().flatten().find_map(|one| one.as_ref().err()) {
        return Err(error.clone());
    }
    results.into_iter().flatten().collect()
}
