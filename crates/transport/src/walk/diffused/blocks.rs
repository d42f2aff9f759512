//! Selection of the paths that continue after a first pass.
//!
//! Only one of many paths continues after its first pass. This is Russian roulette, but stratified: each
//! path that continues represents a *block* of `every` consecutive paths. If a block were longer than a
//! first round, few replicates or none would contain light of later passes, and their spread would not show
//! it. Blocks therefore begin short, with [`FIRST`] paths for the first, and grow to `every`: each replicate
//! contains such light from its first round on.
//!
//! The path of a block that continues is selected at random. After any number of paths, the blocks whose
//! path has come represent that number on average.

use std::ops::Range;

use papilio_sampling::SampleStream;

/// Paths of the first block, if `every` is not smaller.
const FIRST: u64 = 64;

/// Upper bound of the number of paths of a run.
const MOST: u64 = 1 << 40;

/// Factor by which blocks grow.
const GROWTH: u64 = 4;

/// Blocks of paths, one path of each of which continues.
#[derive(Debug, Clone, Copy)]
pub(super) struct Blocks {
    /// Final number of paths of a block; 0: no path continues.
    every: u64,
    /// Number of shorter blocks, and the start of the first block of final length.
    growing: u64,
    grown: u64,
}

impl Blocks {
    pub(super) fn new(every: u64) -> Self {
        let every = every.min(MOST);
        let (mut growing, mut grown) = (0, 0_u64);
        while Self::end_of_growing(growing) - grown < every {
            grown = Self::end_of_growing(growing);
            growing += 1;
        }
        Self { every, growing, grown }
    }

    /// Returns the fraction of paths that continue in the first round of a replicate; 1 if none continues.
    pub(super) fn rarest(&self) -> f64 {
        if self.every == 0 { 1.0 } else { 1.0 / self.every.min(FIRST) as f64 }
    }

    /// Returns the end of a growing block: the first is `FIRST` long, and each multiplies the total by
    /// `GROWTH`.
    fn end_of_growing(number: u64) -> u64 {
        FIRST.saturating_mul(GROWTH.saturating_pow(number.min(64) as u32))
    }

    /// Returns the numbers of the blocks whose selected path is among these paths, and the number of paths
    /// that each represents.
    pub(super) fn continuing_among(
        self,
        numbers: &SampleStream,
        paths: Range<u64>,
    ) -> impl Iterator<Item = (u64, f64)> {
        let growing = (0..self.growing).filter_map({
            let paths = paths.clone();
            move |number| {
                let start = if number == 0 { 0 } else { Self::end_of_growing(number - 1) };
                let length = Self::end_of_growing(number) - start;
                // A random number that nothing else uses.
                let [at, ..] = numbers.block(number, u32::MAX);
                let turn = start + ((at * length as f64) as u64).min(length - 1);
                paths.contains(&turn).then_some((number, length as f64))
            }
        });
        let Self { every, growing: before, grown } = self;
        let (first, grown_paths) =
            (numbers.uniform_int(every.max(1)), paths.start.max(grown)..paths.end.max(grown));
        // Selected paths are at `grown + first`, and every `every` paths from there.
        let among = move |path: u64| (path - grown + every - 1 - first) / every.max(1);
        let grown = if every == 0 { 0..0 } else { among(grown_paths.start)..among(grown_paths.end) };
        growing.chain(grown.map(move |k| (before + k, every as f64)))
    }
}

#[cfg(test)]
mod tests {
    use papilio_sampling::Sampler;

    use super::*;

    fn continuing(every: u64, stream: u64, paths: Range<u64>) -> Vec<(u64, f64)> {
        let numbers = SampleStream::new(Sampler::Sobol, 7, stream).independent();
        Blocks::new(every).continuing_among(&numbers, paths).collect()
    }

    /// After any number of paths, the blocks represent this number on average over replicates.
    #[test]
    fn blocks_represent_all_paths_on_average() {
        for (every, paths) in [(1, 10), (3, 64), (20, 64), (64, 64), (100, 100), (300, 700), (5000, 200)] {
            let streams = 4000;
            let sums: Vec<f64> = (0..streams)
                .map(|s| continuing(every, s, 0..paths).iter().map(|turn| turn.1).sum())
                .collect();
            let mean = sums.iter().sum::<f64>() / streams as f64;
            let variance = sums.iter().map(|sum| (sum - mean).powi(2)).sum::<f64>() / (streams - 1) as f64;
            let error = (variance / streams as f64).sqrt();
            assert!((mean - paths as f64).abs() <= 4.5 * error, "{every} {paths}: {mean} {error}");
        }
    }

    #[test]
    fn every_replicate_continues_a_path_in_its_first_round() {
        for every in [1, 5, 64, 65, 220, 10_000, u64::MAX] {
            for stream in 0..200 {
                assert!(!continuing(every, stream, 0..64).is_empty(), "{every} {stream}");
                // Four times as many paths contain at least one more.
                assert!(continuing(every, stream, 0..256).len() >= 2, "{every} {stream}");
            }
        }
        assert!(continuing(0, 0, 0..1000).is_empty());
    }

    #[test]
    fn selected_paths_do_not_depend_on_split() {
        for every in [1, 7, 64, 220, 3000] {
            let whole = continuing(every, 3, 0..5000);
            let cut: Vec<(u64, f64)> = [0..1, 1..63, 63..64, 64..300, 300..1024, 1024..1024, 1024..5000]
                .into_iter()
                .flat_map(|paths| continuing(every, 3, paths))
                .collect();
            assert_eq!(cut, whole, "{every}");
            assert!(whole.iter().enumerate().all(|(k, turn)| turn.0 == k as u64), "{every}");
        }
    }
}
