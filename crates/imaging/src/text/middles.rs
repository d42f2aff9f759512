//! Middles of strokes and gaps.
//!
//! **What.** The middle of a stroke is a black pixel whose distance to the nearest white one is not smaller
//! than that of any of its eight neighbours; of two middle columns of an even stroke, both are middles. The
//! middle of a gap is the same among white pixels with black ones on both sides, along the row or along the
//! column, within half an em: the inside of letters and the spaces between them, not the spaces between words
//! and lines.

use super::Bitmap;

/// Pixels in the middles of strokes and gaps, as indices of [`Bitmap::black`] in ascending order.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Middles {
    /// Middles of black strokes.
    pub strokes: Vec<usize>,
    /// Middles of the white gaps between strokes.
    pub gaps: Vec<usize>,
}

impl Middles {
    pub(super) fn of(bitmap: &Bitmap) -> Self {
        let inverse: Vec<bool> = bitmap.black.iter().map(|black| !black).collect();
        let reach = bitmap.em.map(|em| em.div_ceil(2));
        let gap =
            |pixel: &usize| bitmap.enclosed(*pixel, 0, reach[0]) || bitmap.enclosed(*pixel, 1, reach[1]);
        Self {
            strokes: ridge(bitmap.count, &bitmap.black),
            gaps: ridge(bitmap.count, &inverse).into_iter().filter(gap).collect(),
        }
    }
}

impl Bitmap {
    /// Returns true if there are black pixels on both sides of a pixel along an axis, within `reach` pixels
    /// in all.
    fn enclosed(&self, pixel: usize, axis: usize, reach: usize) -> bool {
        let [columns, _] = self.count;
        let (place, step) = if axis == 0 { (pixel % columns, 1) } else { (pixel / columns, columns) };
        let before = (1..=place.min(reach)).find(|k| self.black[pixel - k * step]);
        let after = (1..=(self.count[axis] - 1 - place).min(reach)).find(|k| self.black[pixel + k * step]);
        before.zip(after).is_some_and(|(before, after)| before + after <= reach)
    }
}

/// Pixels of a set at the greatest distance from its border among their neighbours.
fn ridge([columns, rows]: [usize; 2], inside: &[bool]) -> Vec<usize> {
    let distances = distances([columns, rows], inside);
    let highest = |pixel: &usize| {
        let (column, row) = (pixel % columns, pixel / columns);
        let mut neighbours = (row.saturating_sub(1)..=(row + 1).min(rows - 1)).flat_map(|row| {
            (column.saturating_sub(1)..=(column + 1).min(columns - 1))
                .map(move |column| row * columns + column)
        });
        inside[*pixel] && neighbours.all(|other| distances[other] <= distances[*pixel])
    };
    (0..inside.len()).filter(highest).collect()
}

/// Square of the distance of each pixel of a set to the nearest pixel outside, 0 outside.
fn distances([columns, rows]: [usize; 2], inside: &[bool]) -> Vec<usize> {
    // Along the columns first; a set without border has the size of the array.
    let far = columns + rows;
    let mut along = vec![0; inside.len()];
    for column in 0..columns {
        let at = |row: usize| row * columns + column;
        let mut distance = far;
        for row in 0..rows {
            distance = if inside[at(row)] { (distance + 1).min(far) } else { 0 };
            along[at(row)] = distance;
        }
        distance = far;
        for row in (0..rows).rev() {
            distance = if inside[at(row)] { (distance + 1).min(far) } else { 0 };
            along[at(row)] = along[at(row)].min(distance);
        }
    }
    let nearest = |pixel: usize| {
        let (column, row) = (pixel % columns, pixel / columns);
        let mut best = along[pixel] * along[pixel];
        for step in 1..columns {
            if step * step >= best {
                break;
            }
            let sides = [column.checked_sub(step), Some(column + step).filter(|other| *other < columns)];
            for other in sides.into_iter().flatten() {
                let down = along[row * columns + other];
                best = best.min(step * step + down * down);
            }
        }
        best
    };
    (0..inside.len()).map(nearest).collect()
}

#[cfg(test)]
mod tests {
    use super::super::{Font, Setting};
    use super::*;

    fn bitmap(rows: &[&str]) -> Bitmap {
        // The first row of a drawing is the top.
        let black = rows.iter().rev().flat_map(|row| row.chars().map(|c| c == '#')).collect();
        Bitmap { count: [rows[0].len(), rows.len()], black, em: [10, 10] }
    }

    #[test]
    fn stems_have_their_middles_in_the_middle_column() {
        let drawn = bitmap(&[
            "...........",
            "..###..##..",
            "..###..##..",
            "..###..##..",
            "..###..##..",
            "...........",
        ]);
        let middles = drawn.middles();
        let columns: Vec<usize> = middles.strokes.iter().map(|pixel| pixel % 11).collect();
        assert!(columns.iter().all(|column| [3, 7, 8].contains(column)), "{columns:?}");
        assert!([3, 7, 8].iter().all(|column| columns.contains(column)));
        let gaps: Vec<usize> = middles.gaps.iter().map(|pixel| pixel % 11).collect();
        assert!(!gaps.is_empty() && gaps.iter().all(|column| [5, 6].contains(column)), "{gaps:?}");
    }

    #[test]
    fn distances_equal_those_of_all_pairs() {
        let setting = Setting { size_pt: 6.0, per_inch: [300.0, 200.0], margin: 3 };
        let drawn = Font::bundled().bitmap("ag&", setting).unwrap();
        let [columns, _] = drawn.count;
        let found = distances(drawn.count, &drawn.black);
        for (pixel, found) in found.iter().enumerate() {
            let outside = (0..drawn.black.len()).filter(|other| !drawn.black[*other]);
            let square = |other: usize| {
                (other % columns).abs_diff(pixel % columns).pow(2)
                    + (other / columns).abs_diff(pixel / columns).pow(2)
            };
            assert_eq!(Some(*found), outside.map(square).min(), "{pixel}");
        }
    }

    /// The counter of an o has a middle; spaces between words and the margin have none.
    #[test]
    fn gaps_are_inside_and_between_letters() {
        let setting = Setting { size_pt: 12.0, per_inch: [300.0; 2], margin: 10 };
        let drawn = Font::bundled().bitmap("o", setting).unwrap();
        let [columns, rows] = drawn.count;
        let middles = drawn.middles();
        assert!(!middles.strokes.is_empty() && !middles.gaps.is_empty());
        let ink: Vec<usize> = (0..drawn.black.len()).filter(|pixel| drawn.black[*pixel]).collect();
        let (low, high) = (ink[0] / columns, ink[ink.len() - 1] / columns);
        for pixel in &middles.gaps {
            assert!((low..=high).contains(&(pixel / columns)), "{pixel} of {rows} rows");
        }
        let words = Font::bundled().bitmap("l    l", setting).unwrap();
        assert!(words.middles().gaps.is_empty());
        assert!(!Font::bundled().bitmap("ll", setting).unwrap().middles().gaps.is_empty());
        let white = Font::bundled().bitmap(" ", setting).unwrap().middles();
        assert!(white.strokes.is_empty() && white.gaps.is_empty());
    }
}
