//! Pictures by several threads, with the same result for any number of them.

use std::ops::Range;
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

/// Changes each row of `columns` pixels by its number.
pub(super) fn in_rows(
    threads: usize,
    pixels: &mut [[f32; 3]],
    columns: usize,
    of: impl Fn(usize, &mut [[f32; 3]]) + Sync,
) {
    let rows = CHUNK.div_ceil(columns);
    let chunks: Vec<_> = pixels.chunks_mut(rows * columns).enumerate().map(Mutex::new).collect();
    each(&chunks, threads, |chunk| {
        let (number, chunk) = &mut *chunk.lock().unwrap_or_else(PoisonError::into_inner);
        chunk.chunks_exact_mut(columns).enumerate().for_each(|(row, line)| of(*number * rows + row, line));
    });
}

/// What is returned for the numbers of each of a few parts of the pixels, in their order.
pub(super) fn in_parts<R: Send>(
    threads: usize,
    pixels: usize,
    of: impl Fn(Range<usize>) -> R + Sync,
) -> Vec<R> {
    let part = pixels.div_ceil(threads.max(1)).max(1);
    let parts: Vec<_> = (0..pixels).step_by(part).map(|first| first..(first + part).min(pixels)).collect();
    each(&parts, threads, |part| of(part.clone()))
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
        for threads in [0, 1, 3] {
            assert_eq!(in_parts(threads, 7, |part| part.collect::<Vec<_>>()).concat(), [0, 1, 2, 3, 4, 5, 6]);
            assert!(in_parts(threads, 0, |_| ()).is_empty());
        }
    }
}
