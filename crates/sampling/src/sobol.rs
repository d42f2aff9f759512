//! Owen-scrambled Sobol points in sixteen dimensions, four blocks of four.
//!
//! Direction numbers of S. Joe and F. Kuo (SIAM J. Sci. Comput. 30, 2635 (2008)), scrambled by hashing (B.
//! Burley, *Practical Hash-based Owen Scrambling*, JCGT 9:4, 2020; the hash is N. Vegdahl's).
//!
//! Range: 2^32 points with 32 bits each.

/// Blocks of four dimensions.
pub(crate) const BLOCKS: usize = 4;

const DIMENSIONS: usize = 4 * BLOCKS;

/// The inner coefficients of the primitive polynomials and the initial numbers, from the second dimension on.
const INITIAL: [(u32, &[u32]); DIMENSIONS - 1] = [
    (0, &[1]),
    (1, &[1, 3]),
    (1, &[1, 3, 1]),
    (2, &[1, 1, 1]),
    (1, &[1, 1, 3, 3]),
    (4, &[1, 3, 5, 13]),
    (2, &[1, 1, 5, 5, 17]),
    (4, &[1, 1, 5, 5, 5]),
    (7, &[1, 1, 7, 11, 19]),
    (11, &[1, 1, 5, 1, 1]),
    (13, &[1, 1, 1, 3, 11]),
    (14, &[1, 3, 5, 5, 31]),
    (1, &[1, 3, 3, 9, 7, 49]),
    (13, &[1, 1, 1, 15, 21, 21]),
    (16, &[1, 3, 1, 13, 27, 49]),
];

/// Reversed direction numbers from the initial ones and the inner coefficients of the
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

/// The exclusive or of the directions that a byte of the index chooses, for each block of dimensions.
static BY_BYTE: [[[[u32; 4]; 256]; 4]; BLOCKS] = by_byte();

const fn by_byte() -> [[[[u32; 4]; 256]; 4]; BLOCKS] {
    let mut table = [[[[0_u32; 4]; 256]; 4]; BLOCKS];
    let mut dimension = 0;
    while dimension < DIMENSIONS {
        let (block, place) = (dimension / 4, dimension % 4);
        let directions = if dimension == 0 {
            // The first dimension is the reversed index: reversed, the index itself.
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
    let mut reversed = [0_u32; 4];
    for (byte, table) in index.to_le_bytes().into_iter().zip(&BY_BYTE[block]) {
        for (value, direction) in reversed.iter_mut().zip(table[usize::from(byte)]) {
            *value ^= direction;
        }
    }
    std::array::from_fn(|k| {
        permute(reversed[k], mix(scramble ^ (k as u32).wrapping_mul(0x9e37_79b9))).reverse_bits()
    })
}

/// A permutation in which each bit depends on the lower ones alone.
#[inline]
fn permute(mut x: u32, seed: u32) -> u32 {
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul((seed >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^ x.wrapping_mul(0x53a2_2864)
}

#[inline]
fn mix(mut x: u32) -> u32 {
    x ^= x >> 16;
    x = x.wrapping_mul(0x7feb_352d);
    x ^= x >> 15;
    x = x.wrapping_mul(0x846c_a68b);
    x ^ (x >> 16)
}
