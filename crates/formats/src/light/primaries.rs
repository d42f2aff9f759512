//! Primaries of a light map: conversion of its colours to linear sRGB.
//!
//! The conversion is that of XYZ, without adaptation to another white: the luminance and the chromaticity of
//! a pixel are those that the file states. A colour outside the gamut of sRGB is moved towards grey of the
//! same luminance until no component is negative.

use papilio_diagnostics::Diagnostic;

use super::map::{LightMap, MapColour};

/// Chromaticities x, y of red, green, blue and white.
pub(crate) type Primaries = [[f64; 2]; 4];

/// Those of sRGB (IEC 61966-2-1).
const SRGB: Primaries = [[0.64, 0.33], [0.3, 0.6], [0.15, 0.06], [0.3127, 0.329]];

/// Primaries whose colours are X, Y and Z.
pub(crate) const XYZ: Primaries = [[1.0, 0.0], [0.0, 1.0], [0.0, 0.0], [1.0 / 3.0, 1.0 / 3.0]];

/// Luminous efficacy of pictures, lm/W: the convention of Radiance.
pub(super) const PICTURE_LM_PER_W: f64 = 179.0;

type Matrix = [[f64; 3]; 3];

/// Converts the pixels of a map whose colours have these primaries.
///
/// # Errors
/// If the primaries span no colours.
pub(super) fn to_srgb(map: &mut LightMap, primaries: Primaries) -> Result<(), Diagnostic> {
    let differs = primaries.iter().flatten().zip(SRGB.iter().flatten()).any(|(a, b)| (a - b).abs() > 2e-4);
    let colours: Vec<MapColour> = map.channels.iter().map(|channel| channel.colour).collect();
    if !differs || colours != [MapColour::Red, MapColour::Green, MapColour::Blue] {
        return Ok(());
    }
    let wrong = || {
        Diagnostic::new(format!("the primaries {primaries:?} do not span a range of colours"))
            .expected("x and y of red, green, blue and white")
    };
    let xyz = xyz(primaries).ok_or_else(wrong)?;
    let back = xyz_of_srgb().and_then(inverse).ok_or_else(wrong)?;
    let luminance = xyz[1];
    let mut outside = 0_usize;
    for pixel in 0..map.width * map.height {
        let from: [f64; 3] = std::array::from_fn(|k| f64::from(map.channels[k].radiance[pixel]));
        let mut to = times(back, times(xyz, from));
        let y: f64 = (0..3).map(|k| luminance[k] * from[k]).sum::<f64>().max(0.0);
        let least = to.iter().copied().fold(f64::INFINITY, f64::min);
        if least < 0.0 {
            // Rounding of greys is not counted.
            outside += usize::from(least < -1e-6 * y);
            let keep = y / (y - least);
            to = to.map(|value| (y + keep * (value - y)).max(0.0));
        }
        (0..3).for_each(|k| map.channels[k].radiance[pixel] = to[k] as f32);
    }
    map.notes.push(format!(
        "{} to sRGB{}",
        if primaries == XYZ {
            "its X, Y and Z are converted"
        } else {
            "its colours are converted from the primaries that the file states"
        },
        match outside {
            0 => String::new(),
            _ => format!(
                "; {outside} of {} pixels are outside the gamut of sRGB and are moved towards grey of the same luminance",
                map.width * map.height
            ),
        }
    ));
    Ok(())
}

fn xyz_of_srgb() -> Option<Matrix> {
    xyz(SRGB)
}

/// Returns the luminances of red, green and blue of these primaries (sRGB: `None`), 1 for white.
pub(super) fn luminances(primaries: Option<Primaries>) -> Option<[f64; 3]> {
    Some(xyz(primaries.unwrap_or(SRGB))?[1])
}

/// Returns the matrix from RGB to XYZ, Y = 1 for white.
fn xyz([red, green, blue, white]: Primaries) -> Option<Matrix> {
    // Primaries need no luminance: X and Z have none.
    let columns = [red, green, blue].map(|[x, y]| [x, y, 1.0 - x - y]);
    let plain: Matrix = std::array::from_fn(|row| std::array::from_fn(|k| columns[k][row]));
    let [x, y] = white;
    let white = (y.abs() > 1e-9).then(|| [x / y, 1.0, (1.0 - x - y) / y])?;
    let scale = times(inverse(plain)?, white);
    Some(plain.map(|row| std::array::from_fn(|k| row[k] * scale[k])))
}

fn times(matrix: Matrix, by: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| row.iter().zip(by).map(|(a, b)| a * b).sum())
}

fn inverse(m: Matrix) -> Option<Matrix> {
    let minor = |r: usize, c: usize| {
        let at = |i: usize, j: usize| m[(r + i) % 3][(c + j) % 3];
        at(1, 1) * at(2, 2) - at(1, 2) * at(2, 1)
    };
    let determinant: f64 = (0..3).map(|c| m[0][c] * minor(0, c)).sum();
    (determinant.is_finite() && determinant.abs() > 1e-9)
        .then(|| std::array::from_fn(|r| std::array::from_fn(|c| minor(c, r) / determinant)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::map::MapChannel;

    fn map(rgb: [f32; 3]) -> LightMap {
        let colours = [MapColour::Red, MapColour::Green, MapColour::Blue];
        let channels = colours.into_iter().zip(rgb);
        let channels = channels.map(|(colour, value)| MapChannel { colour, radiance: vec![value] }).collect();
        LightMap { width: 1, height: 1, channels, notes: Vec::new() }
    }

    fn converted(rgb: [f32; 3], primaries: Primaries) -> ([f64; 3], LightMap) {
        let mut map = map(rgb);
        to_srgb(&mut map, primaries).unwrap();
        (std::array::from_fn(|k| f64::from(map.channels[k].radiance[0])), map)
    }

    const REC_2020: Primaries = [[0.708, 0.292], [0.17, 0.797], [0.131, 0.046], [0.3127, 0.329]];
    const RADIANCE: Primaries = [[0.64, 0.33], [0.29, 0.6], [0.15, 0.06], [1.0 / 3.0, 1.0 / 3.0]];

    /// ITU-R BT.2087: the matrix from BT.2020 to BT.709.
    #[test]
    fn rec_2020_is_converted_as_published() {
        let (found, _) = converted([1.0, 1.0, 1.0], REC_2020);
        assert!(found.iter().all(|value| (value - 1.0).abs() < 1e-5), "{found:?}");
        let (found, map) = converted([0.5, 0.6, 0.7], REC_2020);
        let wanted = [
            0.5 * 1.6605 - 0.6 * 0.5876 - 0.7 * 0.0728,
            -0.5 * 0.1246 + 0.6 * 1.1329 - 0.7 * 0.0083,
            -0.5 * 0.0182 - 0.6 * 0.1006 + 0.7 * 1.1187,
        ];
        for (found, wanted) in found.into_iter().zip(wanted) {
            assert!((found - wanted).abs() < 2e-4, "{found} {wanted}");
        }
        assert_eq!(map.notes.len(), 1);
    }

    /// Radiance's manual: luminance = 0.265 R + 0.670 G + 0.065 B.
    #[test]
    fn luminance_has_the_weights_of_radiance() {
        for (rgb, wanted) in [([1.0, 0.0, 0.0], 0.265), ([0.0, 1.0, 0.0], 0.670), ([0.0, 0.0, 1.0], 0.065)] {
            let (found, _) = converted(rgb, RADIANCE);
            let y = 0.2126 * found[0] + 0.7152 * found[1] + 0.0722 * found[2];
            assert!((y - wanted).abs() < 5e-4 && found.iter().all(|value| *value >= 0.0), "{y} {wanted}");
        }
    }

    #[test]
    fn srgb_changes_no_bit_and_degenerate_primaries_are_refused() {
        let (found, map) = converted([0.1, 0.2, 0.3], SRGB);
        assert_eq!(found, [0.1_f32, 0.2, 0.3].map(f64::from));
        assert!(map.notes.is_empty());
        assert!(to_srgb(&mut self::map([1.0; 3]), [[0.3, 0.3]; 4]).is_err());
    }
}
