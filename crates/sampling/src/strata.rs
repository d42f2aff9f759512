//! Point sets for octaves of paths: paths 2^k to 2^(k+1) - 1 form one set.
//!
//! A run need not know its length in advance: each doubling adds a complete set, in an order of its
//! own. Two pairs of coordinates are two independently ordered sets (padding).
//!
//! - [`stratified`]: jittered points in 2^ceil(k/2) x 2^floor(k/2) cells (Feng 2012, ch. 4).
//! - [`best_candidate`]: well-separated sets of at most [`LARGEST_SET`] points
//!   (Mitchell, SIGGRAPH 1991), shifted at random on the torus (Cranley & Patterson 1976).

use std::sync::OnceLock;

use crate::candidates::{self, LARGEST_SET};

/// Position of a path: its set, its point of the set, and the binary logarithm of the size of the set.
#[derive(Debug, Clone, Copy)]
struct SetPosition {
    set: u64,
    point: u32,
    bits: u32,
}

impl SetPosition {
    /// Returns the position of a path if sets have at most `2^most` points; the first path has a set of its
    /// own.
    #[inline]
    fn new(path: u64, most: u32) -> Self {
        let octave = path.max(1).ilog2();
        let first = if path == 0 { 0 } else { 1 << octave };
        let bits = octave.min(most);
        let point = path - first;
        // Octave numbers and the counts within them do not collide: both are below 2^58.
        let set = (u64::from(octave) << 58) ^ (point >> bits) ^ (u64::from(path == 0) << 57);
        Self { set, point: (point & ((1 << bits) - 1)) as u32, bits }
    }
}

/// A pair of coordinates in the unit square for this path. `random` hashes a set's number,
/// the same for all paths of the set; `jitter` is this path's own.
#[inline]
pub(crate) fn stratified(path: u64, random: impl Fn(u64) -> u64, jitter: [f64; 2]) -> [f64; 2] {
    let place = SetPosition::new(path, 32);
    let cell = permuted(place.point, place.bits, random(place.set));
    let columns = place.bits.div_ceil(2);
    let (x, y) = (cell & ((1 << columns) - 1), cell.checked_shr(columns).unwrap_or(0));
    let rows = place.bits - columns;
    [
        (f64::from(x) + jitter[0]) / f64::from(columns).exp2(),
        (f64::from(y) + jitter[1]) / f64::from(rows).exp2(),
    ]
}

/// A pair of coordinates like [`stratified`], from a set of best candidates.
#[inline]
pub(crate) fn best_candidate(path: u64, random: impl Fn(u64) -> u64) -> [f64; 2] {
    static SET: OnceLock<Vec<[f64; 2]>> = OnceLock::new();
    let place = SetPosition::new(path, LARGEST_SET.ilog2());
    let own = random(place.set);
    let shift = [own >> 32, own & 0xffff_ffff].map(|half| (half as f64 + 0.5) * (-32.0_f64).exp2());
    let chosen = permuted(place.point, place.bits, own ^ (own >> 29));
    let point = SET.get_or_init(candidates::best_candidate_points)[chosen as usize];
    // The interval is open: a sum may round to 1.
    let wrapped = |k: usize| {
        let sum = point[k] + shift[k];
        (sum - sum.floor()).clamp(f64::EPSILON, 1.0 - f64::EPSILON)
    };
    [wrapped(0), wrapped(1)]
}

/// Permutes the integers of `bits` bits in invertible rounds (after A. Kensler,
/// *Correlated Multi-Jittered Sampling*, Pixar 13-01, 2013).
#[inline]
fn permuted(point: u32, bits: u32, key: u64) -> u32 {
    if bits == 0 {
        return 0;
    }
    let mask = u32::MAX >> (32 - bits);
    let half = bits.div_ceil(2);
    let mut x = point;
    for round in 0..4 {
        let part = (key >> (16 * round)) as u32;
        x = x.wrapping_add(part.wrapping_mul(0x9e37_79b9)) & mask;
        x = x.wrapping_mul(0x846c_a68b ^ (part << 1)) & mask;
        x ^= x >> half;
        x = x.wrapping_mul(0x7feb_352d ^ (part >> 4 << 1)) & mask;
        x ^= x >> half;
    }
    x & mask
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn permutation_is_a_bijection() {
        for bits in 0..12 {
            for key in [0, 1, 0xdead_beef_1234_5678] {
                let mut met = vec![false; 1 << bits];
                (0..1 << bits).for_each(|point| met[permuted(point, bits, key) as usize] = true);
                assert!(met.into_iter().all(|met| met), "{bits} bits, key {key}");
            }
        }
    }

    /// Over the keys, each of 16 points is permuted to each position with the same probability.
    /// Chi-square at 1e-4 for each of 16 points (Sidak 1.6e-3).
    #[test]
    fn permuted_position_is_uniform_over_keys() {
        for point in 0..16 {
            let mut met = [0.0_f64; 16];
            for key in 0..4096_u64 {
                let key = crate::numbers::mix64(key);
                met[permuted(point, 4, key) as usize] += 1.0;
            }
            let found = papilio_testing::ChiSquare::uniform(&met);
            assert!(found.is_likely(), "{point}: {found:?}");
        }
    }

    #[test]
    fn every_octave_fills_all_its_cells() {
        for octave in [4_u32, 5, 10] {
            let mut met = vec![false; 1 << octave];
            let columns = 1_usize << octave.div_ceil(2);
            for path in 1_u64 << octave..1 << (octave + 1) {
                let [x, y] = stratified(path, |set| set.wrapping_mul(0x9e37_79b9_7f4a_7c15), [0.5, 0.5]);
                let rows = met.len() / columns;
                met[(y * rows as f64) as usize * columns + (x * columns as f64) as usize] = true;
            }
            assert!(met.into_iter().all(|met| met), "octave {octave}");
        }
    }
}
