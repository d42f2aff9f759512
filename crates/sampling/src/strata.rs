//! Points that come in octaves: 2^k paths from path 2^k on are one set.
//!
//! A run need not know how long it will be: each doubling adds a whole set, in an order of its
//! own. Two pairs of coordinates are two such sets side by side (padding), independently ordered.
//!
//! - [`stratified`]: jittered points in 2^ceil(k/2) x 2^floor(k/2) cells (Feng 2012, ch. 4).
//! - [`best_candidate`]: sets of at most [`LARGEST_SET`] points that keep away from each other
//!   (Mitchell, SIGGRAPH 1991), shifted at random around the torus (Cranley & Patterson 1976).

use std::sync::OnceLock;

use crate::candidates::{self, LARGEST_SET};

/// Where a path stands: in which set, which of its points, and of how many (a power of two).
#[derive(Debug, Clone, Copy)]
struct Place {
    set: u64,
    point: u32,
    bits: u32,
}

impl Place {
    /// A path's place where sets have at most `2^most` points; the first path has one for itself.
    #[inline]
    fn of(path: u64, most: u32) -> Self {
        let octave = path.max(1).ilog2();
        let first = if path == 0 { 0 } else { 1 << octave };
        let bits = octave.min(most);
        let point = path - first;
        // Octave numbers and the counts within them never meet: both below 2^58.
        let set = (u64::from(octave) << 58) ^ (point >> bits) ^ (u64::from(path == 0) << 57);
        Self { set, point: (point & ((1 << bits) - 1)) as u32, bits }
    }
}

/// A pair of coordinates in the unit square for this path; `random` makes numbers from a count,
/// the same for all paths of a set, `jitter` is this path's own.
#[inline]
pub(crate) fn stratified(path: u64, random: impl Fn(u64) -> u64, jitter: [f64; 2]) -> [f64; 2] {
    let place = Place::of(path, 32);
    let cell = permuted(place.point, place.bits, random(place.set));
    let columns = place.bits.div_ceil(2);
    let (x, y) = (cell & ((1 << columns) - 1), cell.checked_shr(columns).unwrap_or(0));
    let rows = place.bits - columns;
    [
        (f64::from(x) + jitter[0]) / f64::from(columns).exp2(),
        (f64::from(y) + jitter[1]) / f64::from(rows).exp2(),
    ]
}

/// As [`stratified`], of a set of best candidates.
#[inline]
pub(crate) fn best_candidate(path: u64, random: impl Fn(u64) -> u64) -> [f64; 2] {
    static SET: OnceLock<Vec<[f64; 2]>> = OnceLock::new();
    let place = Place::of(path, LARGEST_SET.ilog2());
    let own = random(place.set);
    let shift = [own >> 32, own & 0xffff_ffff].map(|half| (half as f64 + 0.5) * (-32.0_f64).exp2());
    let chosen = permuted(place.point, place.bits, own ^ (own >> 29));
    let point = SET.get_or_init(candidates::set)[chosen as usize];
    // A sum that rounds to 1 is no number below 1.
    let wrapped = |k: usize| {
        let sum = point[k] + shift[k];
        (sum - sum.floor()).clamp(f64::EPSILON, 1.0 - f64::EPSILON)
    };
    [wrapped(0), wrapped(1)]
}

/// A permutation of the numbers of this many bits: each round can be undone (A. Kensler,
/// *Correlated Multi-Jittered Sampling*, Pixar 13-01, 2013, has the idea).
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
    fn a_permutation_meets_every_number_once() {
        for bits in 0..12 {
            for key in [0, 1, 0xdead_beef_1234_5678] {
                let mut met = vec![false; 1 << bits];
                (0..1 << bits).for_each(|point| met[permuted(point, bits, key) as usize] = true);
                assert!(met.into_iter().all(|met| met), "{bits} bits, key {key}");
            }
        }
    }

    /// Where a point goes depends on the key alone: each of 16 points meets each place alike.
    /// Chi-square at 1e-4 for each of 16 points (Sidak 1.6e-3).
    #[test]
    fn a_permutation_has_no_favourites() {
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
    fn every_octave_fills_its_cells() {
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
