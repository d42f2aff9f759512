//! Owen-scrambled Sobol points in four dimensions.
//!
//! The first four dimensions of the Sobol sequence (direction numbers of Joe & Kuo, SIAM
//! J. Sci. Comput. 30, 2635 (2008)), scrambled and shuffled by hashing (B. Burley, *Practical
//! Hash-based Owen Scrambling*, JCGT 9:4, 2020; the hash is N. Vegdahl's). A shuffle puts the
//! points of each aligned block of 2^k indices in another order and place of the sequence, so
//! that differently shuffled blocks may stand beside each other in one path.
//!
//! Range: 2^32 points with 32 bits each.

/// Direction numbers of the dimensions after the first, most significant bit first, each
/// bit-reversed: the scramble works from the low end.
const DIRECTIONS: [[u32; 32]; 3] = [directions(&[1], 0), directions(&[1, 3], 1), directions(&[1, 3, 1], 1)];

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

/// The exclusive or of the directions that a byte of the index chooses.
static BY_BYTE: [[[u32; 3]; 256]; 4] = by_byte();

const fn by_byte() -> [[[u32; 3]; 256]; 4] {
    let mut table = [[[0_u32; 3]; 256]; 4];
    let mut at = 0;
    while at < 4 * 256 * 3 {
        let (byte, value, dimension) = (at / 768, at / 3 % 256, at % 3);
        let mut bit = 0;
        while bit < 8 {
            if (value >> bit) & 1 == 1 {
                table[byte][value][dimension] ^= DIRECTIONS[dimension][8 * byte + bit];
            }
            bit += 1;
        }
        at += 1;
    }
    table
}

/// Point `index` of the sequence that `scramble` shuffles and scrambles.
#[inline]
pub(crate) fn point(index: u32, scramble: u64) -> [u32; 4] {
    let (shuffle, seed) = ((scramble >> 32) as u32, scramble as u32);
    let index = permute(index.reverse_bits(), shuffle).reverse_bits();
    // The first dimension is the reversed index: reversed, the index itself.
    let mut reversed = [index, 0, 0, 0];
    for (byte, table) in index.to_le_bytes().into_iter().zip(&BY_BYTE) {
        for (value, direction) in reversed[1..].iter_mut().zip(table[usize::from(byte)]) {
            *value ^= direction;
        }
    }
    std::array::from_fn(|k| {
        permute(reversed[k], mix(seed ^ (k as u32).wrapping_mul(0x9e37_79b9))).reverse_bits()
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
