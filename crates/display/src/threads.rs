//! The same work for several items, on a few threads.

/// Calls `work` with each item; neighbouring items share a thread. The results are in the order of the items,
/// and do not depend on the threads.
pub(crate) fn each<T: Sync, R: Send>(items: &[T], threads: usize, work: impl Fn(&T) -> R + Sync) -> Vec<R> {
    if threads < 2 || items.len() < 2 {
        return items.iter().map(work).collect();
    }
    std::thread::scope(|scope| {
        let work = &work;
        let shares = items.chunks(items.len().div_ceil(threads));
        let workers: Vec<_> =
            shares.map(|share| scope.spawn(move || share.iter().map(work).collect::<Vec<R>>())).collect();
        let found = workers
            .into_iter()
            .map(|worker| worker.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)));
        found.flatten().collect()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_are_in_the_order_of_the_items() {
        let items: Vec<usize> = (0..7).collect();
        for threads in [0, 1, 2, 3, 7, 9] {
            assert_eq!(each(&items, threads, |item| 3 * item), [0, 3, 6, 9, 12, 15, 18], "{threads}");
        }
        assert_eq!(each(&[] as &[usize], 2, |item| *item), [] as [usize; 0]);
    }
}
