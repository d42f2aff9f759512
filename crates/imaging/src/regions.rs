//! Drawings in a picture: flat areas with hard borders, and the text and lines between them.
//!
//! **What.** Pixels of exactly one colour that touch are an area. It is *flat* if it has [`LEAST_INNER`] pixels whose
//! eight neighbours have its colour, and most of its border is hard: steps of more than [`SOFT`] of 255 in a
//! component. The flat tones of a photograph, such as an overexposed sky, and the bands of a gradient end softly.
//! Flat areas are a drawing, and so is what lies between them within [`REACH`] pixels (a morphological closing): text, lines.
//! Holes of less than [`LEAST_AREA`] pixels are filled, and drawings of less are left to the photograph.
//!
//! Colours are encoded bytes, so that rounding of resized pictures does not matter. Nothing depends on threads.

use crate::ImagingError;
use crate::halftone::check_rows;

/// Inner pixels of a flat area at least.
const LEAST_INNER: u32 = 16;
/// Largest step of a component at a soft border.
const SOFT: u8 = 8;
/// Part of the border of a flat area that may be soft.
const SOFT_PART: f64 = 0.25;
/// Half of the width of what counts as a line between flat areas, pixels.
const REACH: usize = 5;
/// Pixels of a drawing, and of a photograph in it, at least.
const LEAST_AREA: usize = 256;

/// Areas of one colour.
pub struct Areas<'a> {
    colours: &'a [[u8; 3]],
    columns: usize,
    /// The first pixel of the area of each pixel.
    first: Vec<u32>,
    /// Whether all neighbours of a pixel have its colour.
    inner: Vec<bool>,
}

impl<'a> Areas<'a> {
    /// Finds the areas of a picture, of encoded bytes by rows.
    ///
    /// # Errors
    /// If the number of pixels is not a multiple of `columns`.
    pub fn new(colours: &'a [[u8; 3]], columns: usize) -> Result<Self, ImagingError> {
        check_rows(colours.len(), columns)?;
        let first = joined(colours.len(), columns, |one, other| colours[one] == colours[other]);
        let inner = inner(colours, columns);
        Ok(Self { colours, columns, first, inner })
    }

    /// Whether each pixel belongs to an area that is wider than a line: with an inner pixel.
    pub fn solid(&self) -> Vec<bool> {
        let mut is_solid = vec![false; self.first.len()];
        for (first, inner) in self.first.iter().zip(&self.inner) {
            is_solid[*first as usize] |= inner;
        }
        self.first.iter().map(|first| is_solid[*first as usize]).collect()
    }

    /// Whether the area of each pixel has at least this number of pixels.
    pub fn with_pixels(&self, least: usize) -> Vec<bool> {
        large(&self.first, least)
    }

    /// Whether each pixel belongs to a drawing.
    pub fn drawing(&self) -> Vec<bool> {
        let mut drawing = self.flat();
        if drawing.contains(&true) {
            closed(&mut drawing, self.columns);
            // First the holes of drawings, then drawings in photographs.
            for small in [false, true] {
                let first = joined(drawing.len(), self.columns, |one, other| drawing[one] == drawing[other]);
                let large = large(&first, LEAST_AREA.min(drawing.len()));
                for (drawing, _) in drawing.iter_mut().zip(large).filter(|(_, is_large)| !is_large) {
                    if *drawing == small {
                        *drawing = !small;
                    }
                }
            }
        }
        drawing
    }

    /// Whether each pixel belongs to a flat area.
    fn flat(&self) -> Vec<bool> {
        let mut areas = vec![0_u32; self.first.len()];
        for (first, _) in self.first.iter().zip(&self.inner).filter(|(_, inner)| **inner) {
            areas[*first as usize] += 1;
        }
        // Areas that are large enough are few: they have numbers from 1 on, and the others 0.
        let mut count = 0;
        for area in &mut areas {
            let is_large = *area >= LEAST_INNER;
            count += u32::from(is_large);
            *area = if is_large { count } else { 0 };
        }
        if count == 0 {
            return vec![false; self.first.len()];
        }
        // Soft and hard steps at their borders.
        let mut steps = vec![[0_u32; 2]; count as usize + 1];
        for (at, step) in pairs(self.first.len(), self.columns) {
            let [one, other] = [at, at + step].map(|at| self.first[at]);
            if one != other {
                let [one, other] = [one, other].map(|first| areas[first as usize]);
                if one.max(other) > 0 {
                    let [here, there] = [at, at + step].map(|at| self.colours[at]);
                    let largest = here.iter().zip(there).fold(0, |most, (a, b)| most.max(a.abs_diff(b)));
                    [one, other]
                        .iter()
                        .for_each(|area| steps[*area as usize][usize::from(largest > SOFT)] += 1);
                }
            }
        }
        let is_flat = |first: &u32| {
            let area = areas[*first as usize] as usize;
            let [soft, hard] = steps[area].map(f64::from);
            area > 0 && soft <= SOFT_PART * (soft + hard)
        };
        self.first.iter().map(is_flat).collect()
    }
}

/// Whether the area of each pixel has at least this number of pixels.
fn large(first: &[u32], least: usize) -> Vec<bool> {
    let mut counts = vec![0_usize; first.len()];
    first.iter().for_each(|first| counts[*first as usize] += 1);
    first.iter().map(|first| counts[*first as usize] >= least).collect()
}

/// Pixels and the step to their right or lower neighbour.
fn pairs(pixels: usize, columns: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..pixels / columns).flat_map(move |row| {
        (row * columns..(row + 1) * columns).flat_map(move |at| {
            let right = (at + 1 < (row + 1) * columns).then_some((at, 1));
            let down = (at + columns < pixels).then_some((at, columns));
            right.into_iter().chain(down)
        })
    })
}

/// The first pixel of the area of each pixel; neighbours are in the same area if `is_same` says so.
fn joined(pixels: usize, columns: usize, is_same: impl Fn(usize, usize) -> bool) -> Vec<u32> {
    let mut first: Vec<u32> = (0..pixels as u32).collect();
    let root = |first: &mut [u32], mut at: u32| {
        while first[at as usize] != at {
            first[at as usize] = first[first[at as usize] as usize];
            at = first[at as usize];
        }
        at
    };
    for (at, step) in pairs(pixels, columns).filter(|(at, step)| is_same(*at, at + step)) {
        let [one, other] = [at, at + step].map(|at| root(&mut first, at as u32));
        first[one.max(other) as usize] = one.min(other);
    }
    // Each pixel comes after the first one of its area.
    (0..pixels).for_each(|at| first[at] = first[first[at] as usize]);
    first
}

/// Whether the neighbours of each pixel have its colour; beyond the borders all have.
fn inner(colours: &[[u8; 3]], columns: usize) -> Vec<bool> {
    let mut differs = vec![false; colours.len()];
    let rows = colours.len() / columns;
    for y in 0..rows {
        for x in 0..columns {
            let at = y * columns + x;
            // Right, below, and both diagonals below.
            for (right, down) in [(1, 0), (0, 1), (1, 1), (-1, 1)] {
                let (x, y) = (x.wrapping_add_signed(right), y + down);
                if x < columns && y < rows && colours[y * columns + x] != colours[at] {
                    differs[at] = true;
                    differs[y * columns + x] = true;
                }
            }
        }
    }
    differs.into_iter().map(|differs| !differs).collect()
}

/// Morphological closing by a square: gaps of up to twice the reach are filled. Beyond the borders all continues.
fn closed(mask: &mut [bool], columns: usize) {
    spread(mask, columns, true);
    spread(mask, columns, false);
}

/// Sets each pixel with the value within the reach.
fn spread(mask: &mut [bool], columns: usize, value: bool) {
    let rows = mask.len() / columns;
    let mut line = Vec::new();
    for y in 0..rows {
        spread_line(mask, y * columns, 1, columns, value, &mut line);
    }
    for x in 0..columns {
        spread_line(mask, x, columns, rows, value, &mut line);
    }
}

fn spread_line(mask: &mut [bool], from: usize, step: usize, count: usize, value: bool, line: &mut Vec<bool>) {
    line.clear();
    line.extend((0..count).map(|k| mask[from + k * step]));
    let mut free = 0;
    for (k, one) in line.iter().enumerate() {
        if *one == value {
            for k in free.max(k.saturating_sub(REACH))..(k + REACH + 1).min(count) {
                mask[from + k * step] = value;
            }
            free = (k + REACH + 1).min(count);
        }
    }
}

#[cfg(test)]
mod tests {
    use papilio_testing::Dice;

    use super::*;

    const COLUMNS: usize = 160;

    fn drawing(colour: impl Fn(usize, usize) -> u8) -> Vec<bool> {
        let colours: Vec<[u8; 3]> =
            (0..COLUMNS * 100).map(|at| [colour(at % COLUMNS, at / COLUMNS); 3]).collect();
        Areas::new(&colours, COLUMNS).unwrap().drawing()
    }

    fn count(mask: &[bool]) -> usize {
        mask.iter().filter(|one| **one).count()
    }

    /// Noise, a gradient and an overexposed sky are photographs; stripes and a chart are drawings.
    #[test]
    fn drawings_have_hard_borders() {
        let mut dice = Dice::new(4, 0);
        let noise: Vec<f64> = (0..COLUMNS * 100).map(|_| dice.between(0.0, 30.0)).collect();
        assert_eq!(count(&drawing(|x, y| (100.0 + noise[y * COLUMNS + x]) as u8)), 0);
        assert_eq!(count(&drawing(|x, _| (x / 5) as u8)), 0);
        assert_eq!(count(&drawing(|_, y| (2 * y + 120).min(255) as u8)), 0);
        let all = COLUMNS * 100;
        assert_eq!(count(&drawing(|_, _| 90)), all);
        assert_eq!(count(&drawing(|x, y| if (x / 20 + y / 25) % 2 == 0 { 30 } else { 90 })), all);
        // Lines of one pixel in many tones on a flat ground, as antialiased text has.
        assert_eq!(count(&drawing(|x, y| if x % 9 == 3 { (40 + y) as u8 } else { 255 })), all);
    }

    /// A photograph in a drawing has its own borders, and none of its pixels are of the drawing.
    #[test]
    fn regions_end_where_the_photograph_ends() {
        let mut dice = Dice::new(5, 0);
        let noise: Vec<f64> = (0..COLUMNS * 100).map(|_| dice.between(60.0, 140.0)).collect();
        let is_photograph = |x: usize, y: usize| (40..120).contains(&x) && (30..80).contains(&y);
        let found = drawing(|x, y| if is_photograph(x, y) { noise[y * COLUMNS + x] as u8 } else { 255 });
        for (at, found) in found.into_iter().enumerate() {
            assert_eq!(found, !is_photograph(at % COLUMNS, at / COLUMNS), "{at}");
        }
    }

    #[test]
    fn areas_of_nothing_are_refused() {
        assert!(Areas::new(&[], 0).is_err() && Areas::new(&[[0; 3]; 5], 2).is_err());
        assert_eq!(Areas::new(&[[0; 3]; 5], 5).unwrap().solid(), [true; 5]);
    }
}
