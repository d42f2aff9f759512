//! Pictures by several threads, with the same result for any number of them.

use std::sync::{Mutex, PoisonError};

use crate::threads::each;

/// Pixels that a thread takes at once.
const CHUNK: usize = 1 << 14;

/// Changes the values of all pixels, each chunk with the number of its first pixel. Returns what is returned for
/// each chunk, in their order.
pub(super) fn in_chunks<T: Send, R: Send>(
    threads: usize,
    values: &mut [T],
    of: impl Fn(usize, &mut [T]) -> R + Sync,
) -> Vec<R> {
    // Each chunk belongs to one thread, which is what the locks tell the compiler.
    let chunks: Vec<_> = values.chunks_mut(CHUNK).enumerate().map(Mutex::new).collect();
    each(&chunks, threads, |chunk| {
        let (number, chunk) = &mut *chunk.lock().unwrap_or_else(PoisonError::into_inner);
        of(*number * CHUNK, chunk)
    })
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
