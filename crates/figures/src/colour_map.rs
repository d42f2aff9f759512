//! The colour map viridis.
//!
//! Perceptually uniform, readable in grey and with all common deficiencies of colour vision
//! (S. van der Walt, N. Smith and E. Firing, matplotlib 1.5, 2015; released as CC0). The
//! table has every sixteenth entry of the original; linear interpolation between them is within 6 of 255 of
//! it.

use crate::svg::hex;

const VIRIDIS: [[f64; 3]; 17] = [
    [68.0, 1.0, 84.0],
    [72.0, 24.0, 106.0],
    [71.0, 45.0, 123.0],
    [66.0, 64.0, 134.0],
    [59.0, 82.0, 139.0],
    [51.0, 99.0, 141.0],
    [44.0, 114.0, 142.0],
    [38.0, 130.0, 142.0],
    [33.0, 145.0, 140.0],
    [31.0, 159.0, 136.0],
    [39.0, 173.0, 129.0],
    [61.0, 188.0, 116.0],
    [92.0, 200.0, 99.0],
    [129.0, 211.0, 77.0],
    [170.0, 220.0, 50.0],
    [213.0, 226.0, 26.0],
    [253.0, 231.0, 37.0],
];

/// Returns the colour at a position from 0 (dark violet) to 1 (yellow).
pub(crate) fn viridis(value: f64) -> String {
    let position = value.clamp(0.0, 1.0) * (VIRIDIS.len() - 1) as f64;
    let left = (position as usize).min(VIRIDIS.len() - 2);
    let right = position - left as f64;
    hex([0, 1, 2].map(|i| (VIRIDIS[left][i] * (1.0 - right) + VIRIDIS[left + 1][i] * right).round() as u8))
}
