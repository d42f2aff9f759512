//! Pictures by several threads, with the same result for any number of them.

use std::ops::Range;

use papilio_imaging::in_turn;

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
    in_turn(threads, values.chunks_mut(CHUNK), |number, chunk| of(number * CHUNK, chunk))
}

/// Changes each row of `columns` pixels by its number.
pub(super) fn in_rows(
    threads: usize,
    pixels: &mut [[f32; 3]],
    columns: usize,
    of: impl Fn(usize, &mut [[f32; 3]]) + Sync,
) {
    let rows = CHUNK.div_ceil(columns);
    in_turn(threads, pixels.chunks_mut(rows * columns), |number, chunk| {
        chunk.chunks_exact_mut(columns).enumerate().for_each(|(row, line)| of(number * rows + row, line));
    });
}

/// Mean of the X, Y, Z of pixels.
pub(super) fn mean(threads: usize, pixels: &[[f32; 3]]) -> [f64; 3] {
    let sums = in_turn(threads, pixels.chunks(CHUNK), |_, chunk| {
        let mut sums = [0.0; 3];
        for pixel in chunk {
            sums.iter_mut().zip(pixel).for_each(|(sum, value)| *sum += f64::from(*value));
        }
        sums
    });
    [0, 1, 2].map(|k| sums.iter().map(|sum| sum[k]).sum::<f64>() / pixels.len() as f64)
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
