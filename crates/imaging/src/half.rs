//! Numbers of 16 bits (IEEE 754, binary16), which graphics processors read as they are.

/// The largest number of 16 bits.
const LARGEST: u16 = 0x7bff;

/// Converts a number to the nearest one of 16 bits, of two equally near ones to the even one. Larger numbers
/// become the largest one, and what is no number becomes 0.
///
/// ```
/// assert_eq!(papilio_imaging::half_bits(1.0), 0x3c00);
/// ```
pub fn half_bits(value: f32) -> u16 {
    let bits = value.to_bits();
    let (sign, size) = ((bits >> 16) as u16 & 0x8000, bits & 0x7fff_ffff);
    let half = if size < SUBNORMAL {
        (f32::from_bits(size) * 16_777_216.0).round_ties_even() as u16
    } else if size > INFINITE {
        return 0;
    } else {
        // Above the largest number, the exponent is cut.
        let rounded = (size + 0xfff + ((size >> 13) & 1) - 0x3800_0000) >> 13;
        rounded.min(u32::from(LARGEST)) as u16
    };
    sign | half
}

/// Bits of 2^-14, below which the exponent is that of the smallest numbers.
const SUBNORMAL: u32 = 0x3880_0000;

/// Bits of infinity.
const INFINITE: u32 = 0x7f80_0000;

/// Appends numbers as numbers of 16 bits with the lowest byte first.
pub fn push_halves(out: &mut Vec<u8>, values: &[f32]) {
    let start = out.len();
    out.resize(start + 2 * values.len(), 0);
    for (two, value) in out[start..].as_chunks_mut().0.iter_mut().zip(values) {
        *two = half_bits(*value).to_le_bytes();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The value of a number of 16 bits, by its definition.
    fn value(half: u16) -> f64 {
        let (exponent, fraction) = (i32::from(half >> 10 & 31), f64::from(half & 0x3ff) / 1024.0);
        let size = if exponent == 0 {
            fraction * 2.0_f64.powi(-14)
        } else {
            (1.0 + fraction) * 2.0_f64.powi(exponent - 15)
        };
        if half >> 15 == 1 { -size } else { size }
    }

    #[test]
    fn number_of_16_bits_is_the_nearest_one() {
        for half in (0..=LARGEST).step_by(7) {
            let (exact, next) = (value(half), value((half + 1).min(LARGEST)));
            assert_eq!(half_bits(exact as f32), half);
            assert_eq!(half_bits(-exact as f32), half | 0x8000);
            let above = exact + 0.499 * (next - exact);
            assert_eq!(half_bits(above as f32), half, "{above}");
            let even = half + (half & 1);
            assert_eq!(half_bits(f32::midpoint(exact as f32, next as f32)), even.min(LARGEST));
        }
        assert_eq!([1e6, f32::INFINITY].map(half_bits), [LARGEST; 2]);
        assert_eq!(half_bits(f32::NAN), 0);
        let mut out = vec![7];
        push_halves(&mut out, &[0.5, -1.5]);
        assert_eq!(out, [7, 0x00, 0x38, 0x00, 0xbe]);
    }
}
