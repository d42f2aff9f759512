//! How much the light of large blocks of a picture differs from that of another: what a halftone does to tones, without
//! its pattern.
//!
//! **What.** Both pictures are divided into blocks of at least 64 x 64 pixels, as equal as they can be, and the colours of
//! each block are averaged in linear light. The means are compared, and the root mean square of their differences over all
//! blocks is the tone shift: of Y, relative to the root mean square of the other picture's Y, and by CIEDE2000.

use std::ops::Range;

use papilio_colour::pictures::{AffineMap, MappedPicture};
use papilio_colour::{ColourError, Xyz};

use crate::threads::each;

/// Columns and rows of a block at least; smaller pictures have one block.
const BLOCK: usize = 64;

/// Mean X, Y, Z of the blocks of a picture.
pub(super) struct BlockMeans(Vec<[f64; 3]>);

/// Root mean squares of the differences of blocks.
pub(super) struct ToneShift {
    /// Of Y, per cent of the root mean square of the other picture's Y; 0 for two black pictures.
    pub(super) percent: f64,
    /// CIEDE2000.
    pub(super) delta_e_2000: f64,
}

/// The columns or rows of each block.
fn blocks(count: usize) -> Vec<Range<usize>> {
    let blocks = (count / BLOCK).max(1);
    (0..blocks).map(|k| k * count / blocks..(k + 1) * count / blocks).collect()
}

impl BlockMeans {
    /// Means of pixels, in rows of `columns`.
    pub(super) fn of(pixels: &[[f32; 3]], columns: usize, threads: usize) -> Self {
        let across = blocks(columns);
        let mean = |rows: &Range<usize>, along: &Range<usize>| {
            let mut sums = [0.0; 3];
            for row in pixels[rows.start * columns..rows.end * columns].chunks_exact(columns) {
                for pixel in &row[along.clone()] {
                    sums.iter_mut().zip(pixel).for_each(|(sum, value)| *sum += f64::from(*value));
                }
            }
            sums.map(|sum| sum / (rows.len() * along.len()) as f64)
        };
        let of_rows = |rows: &Range<usize>| across.iter().map(|along| mean(rows, along)).collect::<Vec<_>>();
        Self(each(&blocks(pixels.len() / columns), threads, of_rows).concat())
    }

    /// The difference from another picture of as many pixels, which an affine map is applied to, by CIEDE2000 relative to
    /// a white.
    pub(super) fn shift_from(
        &self,
        other: &Self,
        map: AffineMap,
        white: Xyz,
    ) -> Result<ToneShift, ColourError> {
        let [mut shifts, mut squares, mut differences] = [0.0; 3];
        for (own, other) in self.0.iter().zip(&other.0) {
            // An affine map of a mean is the mean after the map.
            let [own, other] = [xyz(*own), map.apply(xyz(*other))];
            shifts += (own.y - other.y).powi(2);
            squares += other.y.powi(2);
            let lab = |colour: Xyz| colour.lab(white).ok_or(ColourError::NoWhite);
            differences += lab(own)?.delta_e_2000(lab(other)?).powi(2);
        }
        let percent = if squares > 0.0 { 100.0 * (shifts / squares).sqrt() } else { 0.0 };
        Ok(ToneShift { percent, delta_e_2000: (differences / self.0.len() as f64).sqrt() })
    }
}

fn xyz([x, y, z]: [f64; 3]) -> Xyz {
    Xyz { x, y, z }
}

/// The tone shifts of what is seen, with rows of `columns`, from other pictures.
pub(super) fn tone_shifts<const N: usize>(
    seen: &[[f32; 3]],
    others: [MappedPicture<'_>; N],
    columns: usize,
    white: Xyz,
    threads: usize,
) -> Result<Vec<ToneShift>, ColourError> {
    let own = BlockMeans::of(seen, columns, threads);
    let shift = |MappedPicture { pixels, map }: MappedPicture<'_>| {
        own.shift_from(&BlockMeans::of(pixels, columns, threads), map, white)
    };
    others.into_iter().map(shift).collect()
}

#[cfg(test)]
mod tests {
    use papilio_colour::D65_WHITE;

    use super::*;

    /// A pattern of a grey has its tone, however strong it is; one that is lighter by 2 % in half of the blocks is off by
    /// 2 % over the root of 2. The difference of lightness of CIEDE2000 is that of its definition.
    #[test]
    fn tone_shift_is_that_of_the_means_of_blocks() {
        let (columns, rows) = (135, 128);
        assert_eq!(blocks(columns), [0..67, 67..135]);
        assert_eq!((blocks(63).as_slice(), blocks(191).len()), (std::slice::from_ref(&(0..63)), 2));
        let white = D65_WHITE;
        let grey = |y: f32| [white.x, white.y, white.z].map(|one| one as f32 * y);
        let wanted = vec![grey(0.25); columns * rows];
        let seen = |lighter: f32| {
            let tone = |at: usize| {
                let (x, y) = (at % columns, at / columns);
                // Rows in pairs: their mean is exact in any columns.
                let pattern = if y % 2 == 0 { 0.15 } else { -0.15 };
                grey(0.5 * if x < 67 { 1.0 + lighter } else { 1.0 } + pattern)
            };
            (0..columns * rows).map(tone).collect::<Vec<_>>()
        };
        let twice = MappedPicture { pixels: &wanted, map: AffineMap::of(|colour| colour * 2.0) };
        for threads in [1, 3] {
            let of =
                |lighter| tone_shifts(&seen(lighter), [twice], columns, white, threads).unwrap().remove(0);
            let none = of(0.0);
            assert!(
                none.percent < 1e-4 && none.delta_e_2000 < 1e-4,
                "{} {}",
                none.percent,
                none.delta_e_2000
            );
            let ToneShift { percent, delta_e_2000 } = of(0.02);
            assert!((percent - 2.0 / 2_f64.sqrt()).abs() < 1e-4, "{percent}");
            let lightness = |y: f64| 116.0 * y.cbrt() - 16.0;
            let (darker, lighter) = (lightness(0.5), lightness(0.51));
            let square = (0.5 * (darker + lighter) - 50.0).powi(2);
            let expected =
                (lighter - darker) / (1.0 + 0.015 * square / (20.0 + square).sqrt()) / 2_f64.sqrt();
            assert!((delta_e_2000 - expected).abs() < 1e-4, "{delta_e_2000} {expected}");
        }
        let black = [[0.0; 3]; 4];
        let [dark] = &tone_shifts(&black, [black[..].into()], 2, white, 1).unwrap()[..] else { panic!() };
        assert_eq!((dark.percent, dark.delta_e_2000), (0.0, 0.0));
    }
}
