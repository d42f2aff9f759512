//! Bytes of a response with a head in JSON and 16-bit floating point numbers, which a browser gives to its graphics processor as they are.

use papilio_display::image::Factors;
use serde::Serialize;

use crate::fault::Fault;

/// The length of the head and of each block is a multiple of this.
const BLOCK: usize = 4;

/// The largest number of 16 bits.
const LARGEST: u16 = 0x7bff;

/// Begins a response: the length of the head, and the head, filled up with spaces.
pub(super) fn with_head(head: &impl Serialize) -> Result<Vec<u8>, Fault> {
    let mut json =
        serde_json::to_vec(head).map_err(|_| Fault::internal("the response cannot be serialised"))?;
    json.resize(json.len().next_multiple_of(BLOCK), b' ');
    let length = u32::try_from(json.len()).map_err(|_| Fault::internal("the response is too long"))?;
    Ok([length.to_le_bytes().as_slice(), &json].concat())
}

/// Appends bytes, filled up with zeros.
pub(super) fn push_bytes(out: &mut Vec<u8>, bytes: &[u8]) {
    out.extend_from_slice(bytes);
    out.resize(out.len().next_multiple_of(BLOCK), 0);
}

/// Appends the X, Y, Z of each pixel in each light.
pub(super) fn push_factors(out: &mut Vec<u8>, factors: &Factors) {
    factors.lights.iter().for_each(|light| push_pixels(out, &light.pixels));
}

/// Appends the X, Y, Z of each pixel, filled up with zeros.
pub(super) fn push_pixels(out: &mut Vec<u8>, pixels: &[[f32; 3]]) {
    out.extend(pixels.as_flattened().iter().flat_map(|value| half_bits(*value).to_le_bytes()));
    out.resize(out.len().next_multiple_of(BLOCK), 0);
}

/// Converts a number to the nearest one of 16 bits (IEEE 754, binary16), of two equally near ones to the even one. Larger numbers become the
/// largest one, and what is no number becomes 0.
fn half_bits(value: f32) -> u16 {
    if value.is_nan() {
        return 0;
    }
    let bits = value.to_bits();
    let (sign, size) = ((bits >> 16) as u16 & 0x8000, bits & 0x7fff_ffff);
    let half = if value.abs() < 2.0_f32.powi(-14) {
        (value.abs() * 2.0_f32.powi(24)).round_ties_even() as u16
    } else {
        let rounded = u64::from(size) + 0xfff + u64::from((size >> 13) & 1);
        u16::try_from((rounded - 0x3800_0000) >> 13).map_or(LARGEST, |half| half.min(LARGEST))
    };
    sign | half
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
    }
}
