//! Owen-scrambled Sobol points in sixteen dimensions, as four blocks of four.
//!
//! Direction numbers of S. Joe and F. Kuo (SIAM J. Sci. Comput. 30, 2635 (2008)), scrambled by hashing (B.
//! Burley, *Practical Hash-based Owen Scrambling*, JCGT 9:4, 2020; the hash is N. Vegdahl's).
//!
//! Range: 2^32 points of 32 bits.

/// Number of blocks of four dimensions.
pub(crate) const BLOCKS: usize = 4;

const DIMENSIONS: usize = 4 * BLOCKS;

/// The inner coefficients of the primitive polynomials and the initial numbers, from the second dimension on.
const INITIAL: [(u32, &[u32]); DIMENSIONS - 1] = [
    (0, &[1]),
    (1, &[1, 3]),
    (1, &[1, 3, 1]),
    (2, &[1, 1, 5]),
    (13, &[1, 1, 7, 9, 31]),
    (4, &[1, 1, 3, 7]),
    (19, &[1, 3, 1, 11, 25, 41]),
    (1, &[1, 1, 5, 5]),
    (19, &[1, 1, 1, 11, 3, 27, 121]),
    (13, &[1, 1, 7, 9, 15, 1]),
    (31, &[1, 1, 5, 13, 31, 9, 23]),
    (11, &[1, 3, 3, 13, 5]),
    (2, &[1, 3, 3, 5, 17]),
    (22, &[1, 3, 1, 5, 15, 51]),
    (16, &[1, 3, 7, 1, 19, 63]),
];

/// Computes reversed direction numbers from the initial ones and the inner coefficients of the
/// primitive polynomial.
const fn directions(initial: &[u32], coefficients: u32) -> [u32; 32] {
    let degree = initial.len();
    let mut v = [0_u32; 32];
    let mut k = 0;
    while k < 32 {
        if k < degree {
            v[k] = initial[k] << (31 - k);
        } else {
            v[k] = v[k - degree] ^ (v[k - degree] >> degree);
            let mut j = 1;
            while j < degree {
                if (coefficients >> (degree - 1 - j)) & 1 == 1 {
                    v[k] ^= v[k - j];
                }
                j += 1;
            }
        }
        k += 1;
    }
    let mut k = 0;
    while k < 32 {
        v[k] = v[k].reverse_bits();
        k += 1;
    }
    v
}

/// Exclusive or of the direction numbers that a byte of the index selects, for each block of dimensions.
static BY_BYTE: [[[[u32; 4]; 256]; 4]; BLOCKS] = by_byte();

const fn by_byte() -> [[[[u32; 4]; 256]; 4]; BLOCKS] {
    let mut table = [[[[0_u32; 4]; 256]; 4]; BLOCKS];
    let mut dimension = 0;
    while dimension < DIMENSIONS {
        let (block, place) = (dimension / 4, dimension % 4);
        let directions = if dimension == 0 {
            // The first dimension is the bit-reversed index; reversed again, the index itself.
            let mut identity = [0_u32; 32];
            let mut bit = 0;
            while bit < 32 {
                identity[bit] = 1 << bit;
                bit += 1;
            }
            identity
        } else {
            let (coefficients, initial) = INITIAL[dimension - 1];
            directions(initial, coefficients)
        };
        let mut byte = 0;
        while byte < 4 {
            let mut value = 1_usize;
            while value < 256 {
                let bit = 8 * byte + value.trailing_zeros() as usize;
                table[block][byte][value][place] =
                    table[block][byte][value & (value - 1)][place] ^ directions[bit];
                value += 1;
            }
            byte += 1;
        }
        dimension += 1;
    }
    table
}

/// Four dimensions of point `index`, scrambled.
#[inline]
pub(crate) fn point(index: u32, block: usize, scramble: u32) -> [u32; 4] {
    let reversed = reversed(index, block);
    std::array::from_fn(|k| permute(reversed[k], dimension_seed(scramble, k)).reverse_bits())
}

/// Number of consecutive points whose indices differ only in the lowest bits.
pub(crate) const CONSECUTIVE: usize = 64;

/// Contribution of the lowest bits, for each dimension of each block.
static LOW_BITS: [[[u32; CONSECUTIVE]; 4]; BLOCKS] = {
    let mut table = [[[0; CONSECUTIVE]; 4]; BLOCKS];
    let mut index = 0;
    while index < BLOCKS * 4 * CONSECUTIVE {
        let (block, dimension, k) = (index / (4 * CONSECUTIVE), index / CONSECUTIVE % 4, index % CONSECUTIVE);
        table[block][dimension][k] = BY_BYTE[block][0][k][dimension];
        index += 1;
    }
    table
};

/// Computes one dimension of `N` consecutive points. `first` is a multiple of [`CONSECUTIVE`]. Compilers
/// vectorise the loop.
#[inline(always)]
pub(crate) fn consecutive_points<const N: usize>(
    first: u32,
    block: usize,
    scramble: u32,
    dimension: usize,
) -> [u32; N] {
    const { assert!(N <= CONSECUTIVE) };
    let common = reversed(first, block)[dimension];
    let seed = dimension_seed(scramble, dimension);
    let mut points = [0; N];
    for (point, lowest) in points.iter_mut().zip(&LOW_BITS[block][dimension]) {
        *point = permute(common ^ lowest, seed).reverse_bits();
    }
    points
}

/// Four dimensions of point `index`, bit-reversed.
#[inline(always)]
fn reversed(index: u32, block: usize) -> [u32; 4] {
    let mut reversed = [0_u32; 4];
    for (byte, table) in index.to_le_bytes().into_iter().zip(&BY_BYTE[block]) {
        for (value, direction) in reversed.iter_mut().zip(table[usize::from(byte)]) {
            *value ^= direction;
        }
    }
    reversed
}

/// Scrambling seed of one dimension of a block.
#[inline(always)]
fn dimension_seed(scramble: u32, dimension: usize) -> u32 {
    mix(scramble ^ (dimension as u32).wrapping_mul(0x9e37_79b9))
}

/// Permutes the values so that each bit depends on the lower bits alone.
#[inline(always)]
fn permute(mut x: u32, seed: u32) -> u32 {
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul((seed >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^ x.wrapping_mul(0x53a2_2864)
}

#[inline(always)]
fn mix(mut x: u32) -> u32 {
    x ^= x >> 16;
    x = x.wrapping_mul(0x7feb_352d);
    x ^= x >> 15;
    x = x.wrapping_mul(0x846c_a68b);
    x ^ (x >> 16)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Row `row` of a dimension's generator matrix, one bit for each of the 16 lowest bits of the index.
    fn row(dimension: usize, row: usize) -> u32 {
        (0..16).fold(0, |bits, bit: usize| {
            let direction = BY_BYTE[dimension / 4][bit / 8][1 << (bit % 8)][dimension % 4];
            bits | ((direction >> row) & 1) << bit
        })
    }

    /// Adds a row to a set of independent rows, ordered by their highest bit. Returns false if it depends on
    /// them.
    fn extend(independent: &mut [u32; 16], mut row: u32) -> bool {
        while let Some(highest) = row.checked_ilog2() {
            let pivot = &mut independent[highest as usize];
            if *pivot == 0 {
                *pivot = row;
                return true;
            }
            row ^= *pivot;
        }
        false
    }

    /// The quality t of the first 2^m points in two dimensions: every rectangle of area 2^(t-m) that is
    /// a product of binary intervals contains exactly 2^t points (H. Niederreiter, SIAM, 1992, theorem 4.28).
    fn quality(a: usize, b: usize, m: usize) -> usize {
        let cut = |rows: [u32; 16]| rows.map(|row| row & ((1 << m) - 1) as u32);
        let [a, b] = [a, b].map(|dimension| cut(std::array::from_fn(|k| row(dimension, k))));
        // Number of independent rows if `of_first` of them come from the first dimension.
        let independent_rows = |of_first: usize| {
            let mut independent = [0; 16];
            let first = a[..of_first].iter().take_while(|row| extend(&mut independent, **row)).count();
            if first < of_first {
                return first;
            }
            of_first + b[..m - of_first].iter().take_while(|row| extend(&mut independent, **row)).count()
        };
        m - (0..=m).map(independent_rows).min().unwrap()
    }

    /// Owen's scrambling preserves the quality. A pair of low quality causes an error that does not
    /// fall for several octaves: with t = 5 at 2^10 points, only 32 rectangles divide the square.
    #[test]
    fn every_pair_has_low_t_at_every_power_of_two() {
        for b in 0..DIMENSIONS {
            for a in 0..b {
                let together = a / 4 == b / 4 || a < 2;
                for m in 1..=16 {
                    let most = if b < 4 {
                        2
                    } else if together {
                        4
                    } else {
                        5
                    };
                    let found = quality(a, b, m);
                    assert!(found <= most, "dimensions {a} and {b}, 2^{m} points: t = {found}");
                }
            }
        }
    }

    /// Checks `quality` itself: the first two dimensions are a (0, 2)-sequence, and dependent rows
    /// are detected.
    #[test]
    fn first_pair_is_a_0_2_sequence() {
        assert!((1..=16).all(|m| quality(0, 1, m) == 0));
        assert_eq!(quality(0, 0, 8), 7);
    }
}
