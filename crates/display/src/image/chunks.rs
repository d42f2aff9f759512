//! Pictures by several threads, with the same result for any number of them.

use std::sync::{Mutex, PoisonError};

/// Pixels that a thread takes at once.
const CHUNK: usize = 1 << 14;

/// Changes the values of all pixels, each chunk with the number of its first pixel. Returns what is returned for
/// each chunk, in their order.
pub(super) fn in_chunks<T: Send, R: Send>(
    threads: usize,
    values: &mut [T],
    of: impl Fn(usize, &mut [T]) -> R + Sync,
) -> Vec<R> {
    let count = values.len().div_ceil(CHUNK);
    let chunks = Mutex::new(values.chunks_mut(CHUNK).enumerate());
    let work = || {
        let mut done = Vec::new();
        loop {
            let next = chunks.lock().unwrap_or_else(PoisonError::into_inner).next();
            let Some((number, chunk)) = next else { return done };
            done.push((number, of(number * CHUNK, chunk)));
        }
    };
    let threads = threads.clamp(1, count.max(1));
    let mut results = match threads {
        1 => work(),
        _ => std::thread::scope(|scope| {
            let running: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
            let join = |one: std::thread::ScopedJoinHandle<'_, _>| {
                one.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
            };
            running.into_iter().flat_map(join).collect()
        }),
    };
    results.sort_by_key(|(number, _)| *number);
    results.into_iter().map(|(_, result)| result).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chunks_are_in_their_order_with_any_number_of_threads() {
        for threads in [1, 3] {
            let mut values = vec![0_usize; 2 * CHUNK + 5];
            let sizes = in_chunks(threads, &mut values, |first, chunk| {
                chunk.iter_mut().enumerate().for_each(|(k, value)| *value = first + k);
                chunk.len()
            });
            assert_eq!(sizes, [CHUNK, CHUNK, 5]);
            assert!(values.iter().enumerate().all(|(k, value)| k == *value));
        }
        assert!(in_chunks(2, &mut [0; 0], |_, _| ()).is_empty());
    }
}
