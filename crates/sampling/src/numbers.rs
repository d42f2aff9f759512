//! Uniform numbers indexed by (seed, stream, path, block).
//!
//! Random numbers are SplitMix64 outputs at a hashed counter (Steele, Lea & Flood,
//! OOPSLA 2014). Sobol points come from `sobol`: path `p` is point `p mod 2^32` of
//! independent scramble `p / 2^32`, and its 32 bits select the centre of one of 2^32 cells.
//! The other two samplers provide pairs of coordinates: `strata`.

use std::ops::Range;

use crate::{sobol, strata};

/// Kind of the uniform numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sampler {
    /// Independent random numbers.
    Random,
    /// Jittered points on pairs of coordinates.
    Stratified,
    /// Owen-scrambled Sobol points, with another scramble for each replicate.
    Sobol,
    /// Best-candidate points (Mitchell) on pairs of coordinates.
    BestCandidate,
}

impl Sampler {
    /// All samplers.
    pub const ALL: [Self; 4] = [Self::Random, Self::Stratified, Self::Sobol, Self::BestCandidate];

    /// Name in scenario files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Random => "random",
            Self::Stratified => "stratified",
            Self::Sobol => "sobol",
            Self::BestCandidate => "best-candidate",
        }
    }

    /// The first two numbers of each path, for a figure of the set.
    pub fn first_pairs(self, paths: Range<u64>) -> Vec<[f64; 2]> {
        let numbers = SampleStream::new(self, 0, 0);
        let pair = |path| {
            let [u, v, ..] = numbers.block(path, 0);
            [u, v]
        };
        paths.map(pair).collect()
    }
}

/// Number of blocks of four numbers at the start of a path that are points of the sampler's sets.
pub const PLANNED_BLOCKS: u32 = sobol::BLOCKS as u32;

/// Sample stream of one replicate.
#[derive(Debug, Clone, Copy)]
pub struct SampleStream {
    sampler: Sampler,
    key: u64,
}

impl SampleStream {
    /// Returns the numbers of replicate `stream` of a computation with this seed.
    pub fn new(sampler: Sampler, seed: u64, stream: u64) -> Self {
        Self { sampler, key: mix64(mix64(seed ^ 0x5061_7069_6c69_6f00) ^ stream) }
    }

    /// Returns numbers for the same replicate that are independent of these.
    pub fn independent(&self) -> Self {
        Self { key: mix64(self.key ^ 0x6170_6172_7400), ..*self }
    }

    /// Returns numbers for the same replicate that are independent of these, and of those of any other
    /// `part`.
    #[must_use]
    pub fn part(&self, part: u64) -> Self {
        Self { key: mix64(self.key ^ mix64(part ^ 0x7061_7274_0000_0000)), ..*self }
    }

    /// Returns an integer in `0..end`, uniformly distributed over replicates and the same for all paths of
    /// one.
    pub fn uniform_int(&self, end: u64) -> u64 {
        ((u128::from(mix64(self.key)) * u128::from(end)) >> 64) as u64
    }

    /// Four numbers in (0, 1) for a path; blocks are independent of each other.
    #[inline]
    pub fn block(&self, path: u64, block: u32) -> [f64; 4] {
        match self.sampler {
            Sampler::Random => self.random_block(path, block),
            _ if block >= PLANNED_BLOCKS => self.random_block(path, block),
            Sampler::Sobol => self.sobol_block(path, block),
            Sampler::Stratified => {
                let [a, b, c, d] = self.random_block(path, block);
                let [x, y] = strata::stratified(path, self.pair_hash(2 * block), [a, b]);
                let [z, w] = strata::stratified(path, self.pair_hash(2 * block + 1), [c, d]);
                [x, y, z, w]
            }
            Sampler::BestCandidate => {
                let [x, y] = strata::best_candidate(path, self.pair_hash(2 * block));
                let [z, w] = strata::best_candidate(path, self.pair_hash(2 * block + 1));
                [x, y, z, w]
            }
        }
    }

    #[inline]
    fn random_block(&self, path: u64, block: u32) -> [f64; 4] {
        let base = mix64(self.key ^ mix64((path << 8) ^ u64::from(block).wrapping_mul(GOLDEN)));
        let uniform = |i: u64| open_unit(mix64(base.wrapping_add(i.wrapping_mul(GOLDEN))));
        [uniform(1), uniform(2), uniform(3), uniform(4)]
    }

    /// Returns the random bits of each set of a pair of coordinates.
    #[inline]
    fn pair_hash(&self, pair: u32) -> impl Fn(u64) -> u64 {
        let key = mix64(self.key ^ u64::from(pair + 1).wrapping_mul(GOLDEN));
        move |set| mix64(key ^ mix64(set))
    }

    #[inline]
    fn sobol_block(&self, path: u64, block: u32) -> [f64; 4] {
        let scramble = self.scramble(path, block);
        let point = sobol::point(path as u32, block as usize, scramble as u32);
        point.map(cell_centre)
    }

    /// Returns one number of a block for `N` consecutive paths; the values equal those of [`Self::block`].
    ///
    /// Computes one of the four numbers at a time: with all four, compilers mix paths and numbers in SIMD
    /// registers.
    #[inline(always)]
    pub fn batch<const N: usize>(&self, first: u64, block: u32, number: usize) -> [f64; N] {
        let consecutive = self.sampler == Sampler::Sobol && block < PLANNED_BLOCKS;
        if !consecutive || !first.is_multiple_of(sobol::CONSECUTIVE as u64) {
            return std::array::from_fn(|k| self.block(first + k as u64, block)[number]);
        }
        let scramble = self.scramble(first, block) as u32;
        let points = sobol::consecutive_points::<N>(first as u32, block as usize, scramble, number);
        let mut numbers = [0.0; N];
        numbers.iter_mut().zip(points).for_each(|(number, point)| *number = cell_centre(point));
        numbers
    }

    #[inline(always)]
    fn scramble(&self, path: u64, block: u32) -> u64 {
        mix64(self.key ^ mix64((path >> 32) ^ u64::from(block + 1).wrapping_mul(GOLDEN)))
    }
}

/// The centre of a point's cell.
#[inline(always)]
fn cell_centre(point: u32) -> f64 {
    (f64::from(point) + 0.5) * (-32.0_f64).exp2()
}

const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// SplitMix64's output function at a counter: a bijection that passes BigCrush as a stream.
#[inline(always)]
pub(crate) fn mix64(counter: u64) -> u64 {
    let mut z = counter.wrapping_add(GOLDEN);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// Converts the top 52 bits to the centre of one of 2^52 cells of (0, 1).
#[inline]
pub(crate) fn open_unit(bits: u64) -> f64 {
    ((bits >> 12) as f64 + 0.5) * (-52.0_f64).exp2()
}

#[cfg(test)]
mod tests {
    use super::*;
    use papilio_testing::ChiSquare;

    fn all(sampler: Sampler) -> impl Iterator<Item = [f64; 4]> {
        (0..64).flat_map(move |stream| {
            let numbers = SampleStream::new(sampler, 42, stream);
            (0..1024).map(move |path| numbers.block(path, 1))
        })
    }

    #[test]
    fn all_samplers_stay_in_the_open_interval() {
        for sampler in Sampler::ALL {
            assert!(all(sampler).flatten().all(|u| u > 0.0 && u < 1.0));
        }
    }

    /// Chi-square on 16 x 16 cells of each pair of coordinates, as a one-sided
    /// test at 1e-4 for each of 12 pairs (Sidak: 1.2e-3 in total).
    #[test]
    fn pairs_of_coordinates_are_uniform_on_the_square() {
        for sampler in Sampler::ALL {
            for (a, b) in [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)] {
                let mut cells = [0.0_f64; 256];
                for point in all(sampler) {
                    cells[(point[a] * 16.0) as usize * 16 + (point[b] * 16.0) as usize] += 1.0;
                }
                let found = ChiSquare::uniform(&cells);
                assert!(found.is_likely(), "{sampler:?} {a},{b}: {found:?}");
            }
        }
    }

    #[test]
    fn sobol_error_is_a_tenth_of_the_random_error_for_a_smooth_function() {
        let error = |sampler| {
            let errors = (0..32).map(|stream| {
                let numbers = SampleStream::new(sampler, 1, stream);
                let sum: f64 = (0..1024).map(|p| numbers.block(p, 0).iter().product::<f64>()).sum();
                (sum / 1024.0 - 1.0 / 16.0).powi(2)
            });
            (errors.sum::<f64>() / 32.0).sqrt()
        };
        assert!(error(Sampler::Sobol) < 0.1 * error(Sampler::Random));
    }

    #[test]
    fn paths_beyond_one_sobol_set_use_new_scrambles() {
        let numbers = SampleStream::new(Sampler::Sobol, 3, 0);
        assert_ne!(numbers.block(5, 0), numbers.block(5 + (1 << 16), 0));
        let mean = (0..(1_u64 << 17)).map(|p| numbers.block(p, 0)[2]).sum::<f64>() / f64::from(1 << 17);
        assert!((mean - 0.5).abs() < 1e-5);
    }

    #[test]
    fn side_by_side_equals_single_blocks() {
        for sampler in Sampler::ALL {
            let numbers = SampleStream::new(sampler, 9, 2);
            for first in [0, 48, 64, 8128, (1 << 32) - 64, (1 << 32) - 5, (1 << 32) + 128] {
                for block in [0, 3, 4] {
                    let found = [0, 1, 2, 3].map(|number| numbers.batch::<64>(first, block, number));
                    for k in 0..64 {
                        let one = numbers.block(first + k as u64, block);
                        assert_eq!(found.map(|number| number[k]), one);
                    }
                }
            }
        }
    }

    #[test]
    fn whole_is_uniform_and_apart_is_independent() {
        let mut cells = [0.0_f64; 16];
        for stream in 0..16_000 {
            let numbers = SampleStream::new(Sampler::Sobol, 5, stream).independent();
            cells[numbers.uniform_int(16) as usize] += 1.0;
            assert_eq!(numbers.uniform_int(1), 0);
        }
        let found = ChiSquare::uniform(&cells);
        assert!(found.is_likely(), "{found:?}");
        for sampler in Sampler::ALL {
            let numbers = SampleStream::new(sampler, 5, 0);
            assert_ne!(numbers.block(3, 1), numbers.independent().block(3, 1));
        }
    }

    #[test]
    fn numbers_differ_by_seed_stream_path_and_block() {
        for sampler in Sampler::ALL {
            let base = SampleStream::new(sampler, 0, 0).block(0, 0);
            assert_ne!(base, SampleStream::new(sampler, 1, 0).block(0, 0));
            assert_ne!(base, SampleStream::new(sampler, 0, 1).block(0, 0));
            assert_ne!(base, SampleStream::new(sampler, 0, 0).block(1, 0));
            assert_ne!(base, SampleStream::new(sampler, 0, 0).block(0, 1));
            assert_eq!(base, SampleStream::new(sampler, 0, 0).block(0, 0));
        }
    }
}
