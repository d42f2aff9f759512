//! Work on a few threads. Results do not depend on their number.

use std::ops::Range;

/// Calls `work` with each item, on a thread of its own if there are several. The results are in the order of
/// the items.
pub(crate) fn each<T: Send, R: Send>(items: Vec<T>, work: impl Fn(T) -> R + Sync) -> Vec<R> {
    if items.len() <= 1 {
        return items.into_iter().map(work).collect();
    }
    std::thread::scope(|scope| {
        let work = &work;
        let workers: Vec<_> = items.into_iter().map(|item| scope.spawn(move || work(item))).collect();
        workers
            .into_iter()
            .map(|worker| worker.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
            .collect()
    })
}

/// Divides the numbers from 0 to below `count` into at most `parts` ranges, each of whole steps except for
/// the last.
pub(crate) fn ranges(count: usize, step: usize, parts: usize) -> Vec<Range<usize>> {
    let length = step * count.div_ceil(step).div_ceil(parts.max(1));
    (0..count).step_by(length.max(1)).map(|first| first..(first + length).min(count)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_cover_each_number_once() {
        for (count, step, parts) in [(0, 2, 3), (1, 2, 3), (7, 2, 1), (7, 2, 3), (64, 32, 5), (65, 32, 2)] {
            let found = ranges(count, step, parts);
            assert!(found.len() <= parts, "{found:?}");
            assert!(found.iter().all(|range| range.start % step == 0));
            assert_eq!(found.into_iter().flatten().collect::<Vec<_>>(), (0..count).collect::<Vec<_>>());
        }
    }
}
