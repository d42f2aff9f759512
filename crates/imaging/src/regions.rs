//! Drawings in a picture: flat areas with hard borders, and the text and lines between them.
//!
//! **What.** Pixels of exactly one colour that touch are an area. It is *flat* if it has [`LEAST_INNER`] pixels whose
//! eight neighbours have its colour, and most of its border is hard: steps of more than [`SOFT`] of 255 in a
//! component. The flat tones of a photograph, such as an overexposed sky, and the bands of a gradient end softly.
//! Flat areas are a drawing, and so is what lies between them within [`REACH`] pixels (a morphological closing): text, lines.
//! Holes of less than [`LEAST_AREA`] pixels are filled, and drawings of less are left to the photograph.
//!
//! Colours are encoded bytes, so that rounding of resized pictures does not matter. Nothing depends on threads.

use std::cell::OnceCell;

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
    /// The first pixel of the area of each pixel, when it is needed.
    first: OnceCell<Vec<u32>>,
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
        Ok(Self { colours, columns, first: OnceCell::new(), inner: inner(colours, columns) })
    }

    fn first(&self) -> &[u32] {
        self.first.get_or_init(|| {
            joined(self.colours.len(), self.columns, |one, other| self.colours[one] == self.colours[other])
        })
    }

    /// Whether each pixel belongs to an area that is wider than a line: with an inner pixel.
    pub fn solid(&self) -> Vec<bool> {
        let first = self.first();
        let mut is_solid = vec![false; first.len()];
        for (first, inner) in first.iter().zip(&self.inner) {
            is_solid[*first as usize] |= inner;
        }
        first.iter().map(|first| is_solid[*first as usize]).collect()
    }

    /// Whether the area of each pixel has at least this number of pixels.
    pub fn with_pixels(&self, least: usize) -> Vec<bool> {
        large(self.first(), least)
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
        // Areas that are large enough have numbers from 1 on, all others 0.
        let areas = self.large_areas();
        let count = areas.iter().fold(0, |most, area| most.max(*area));
        if count == 0 {
            return vec![false; areas.len()];
        }
        // Soft and hard steps at their borders.
        let mut steps = vec![[0_u32; 2]; count as usize + 1];
        for_each_pair(areas.len(), self.columns, |at, next| {
            let [one, other] = [at, next].map(|at| areas[at]);
            if one != other {
                let [here, there] = [at, next].map(|at| self.colours[at]);
                let largest = here.iter().zip(there).fold(0, |most, (a, b)| most.max(a.abs_diff(b)));
                [one, other].iter().for_each(|area| steps[*area as usize][usize::from(largest > SOFT)] += 1);
            }
        });
        let is_flat = |area: &u32| {
            let [soft, hard] = steps[*area as usize].map(f64::from);
            *area > 0 && soft <= SOFT_PART * (soft + hard)
        };
        areas.iter().map(is_flat).collect()
    }

    /// Number of the area of each pixel among those with enough inner pixels, from 1 on; 0 for all others. Only areas with an inner pixel
    /// are walked through: a photograph has few.
    fn large_areas(&self) -> Vec<u32> {
        const UNKNOWN: u32 = u32::MAX;
        let mut areas = vec![UNKNOWN; self.colours.len()];
        let (mut count, mut inside, mut next) = (0, Vec::new(), Vec::new());
        for start in (0..areas.len()).filter(|at| self.inner[*at]) {
            if areas[start] != UNKNOWN {
                continue;
            }
            inside.clear();
            next.push(start);
            areas[start] = 0;
            let mut inner = 0;
            while let Some(at) = next.pop() {
                inside.push(at);
                inner += u32::from(self.inner[at]);
                let x = at % self.columns;
                let mut visit = |other: usize| {
                    if areas[other] == UNKNOWN && self.colours[other] == self.colours[at] {
                        areas[other] = 0;
                        next.push(other);
                    }
                };
                if x > 0 {
                    visit(at - 1);
                }
                if x + 1 < self.columns {
                    visit(at + 1);
                }
                if at >= self.columns {
                    visit(at - self.columns);
                }
                if at + self.columns < self.colours.len() {
                    visit(at + self.columns);
                }
            }
            if inner >= LEAST_INNER {
                count += 1;
                inside.iter().for_each(|at| areas[*at] = count);
            }
        }
        areas.iter_mut().filter(|area| **area == UNKNOWN).for_each(|area| *area = 0);
        areas
    }
}

/// Whether the area of each pixel has at least this number of pixels.
fn large(first: &[u32], least: usize) -> Vec<bool> {
    let mut counts = vec![0_usize; first.len()];
    first.iter().for_each(|first| counts[*first as usize] += 1);
    first.iter().map(|first| counts[*first as usize] >= least).collect()
}

/// Calls a function with each pixel and its right neighbour, and with its lower one.
fn for_each_pair(pixels: usize, columns: usize, mut of: impl FnMut(usize, usize)) {
    for first in (0..pixels).step_by(columns) {
        for at in first..first + columns {
            if at + 1 < first + columns {
                of(at, at + 1);
            }
            if at + columns < pixels {
                of(at, at + columns);
            }
        }
    }
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
    for_each_pair(pixels, columns, |at, next| {
        if is_same(at, next) {
            let [one, other] = [at, next].map(|at| root(&mut first, at as u32));
            first[one.max(other) as usize] = one.min(other);
        }
    });
    // Each pixel comes after the first one of its area.
    (0..pixels).for_each(|at| first[at] = first[first[at] as usize]);
    first
}

/// Whether the neighbours of each pixel have its colour; beyond the borders all have.
fn inner(colours: &[[u8; 3]], columns: usize) -> Vec<bool> {
    let mut inner = vec![true; colours.len()];
    // A colour as one number, so that vectors compare them.
    let numbers = |row: &[[u8; 3]], into: &mut Vec<u32>| {
        into.clear();
        into.extend(row.iter().map(|[red, green, blue]| u32::from_be_bytes([0, *red, *green, *blue])));
    };
    let (mut above, mut row) = (Vec::new(), Vec::new());
    for (y, line) in colours.chunks_exact(columns).enumerate() {
        numbers(line, &mut row);
        let (before, here) = inner.split_at_mut(y * columns);
        let here = &mut here[..columns];
        equal(&row[..columns - 1], &row[1..], |at, is_equal| {
            here[at] &= is_equal;
            here[at + 1] &= is_equal;
        });
        if y > 0 {
            let before = &mut before[(y - 1) * columns..];
            let mut pair = |[upper, lower]: [usize; 2], count: usize| {
                equal(&above[upper..][..count], &row[lower..][..count], |at, is_equal| {
                    before[upper + at] &= is_equal;
                    here[lower + at] &= is_equal;
                });
            };
            pair([0, 0], columns);
            pair([0, 1], columns - 1);
            pair([1, 0], columns - 1);
        }
        std::mem::swap(&mut above, &mut row);
    }
    inner
}

/// Calls a function with each place, and whether both numbers there are equal.
#[inline(always)]
fn equal(one: &[u32], other: &[u32], mut found: impl FnMut(usize, bool)) {
    one.iter().zip(other).enumerate().for_each(|(at, (one, other))| found(at, one == other));
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

    /// Large areas and inner pixels are those of their definitions.
    #[test]
    fn large_areas_are_those_of_joined_pixels() {
        let mut dice = Dice::new(6, 0);
        for (columns, blocks) in [(40, 4), (37, 3), (1, 1), (90, 9)] {
            let tones: Vec<u8> = (0..900).map(|_| dice.below(3) as u8).collect();
            let colours: Vec<[u8; 3]> = (0..columns * 30)
                .map(|at| [tones[(at % columns / blocks + at / columns / blocks * 30) % 900], 7, 9])
                .collect();
            let areas = Areas::new(&colours, columns).unwrap();
            let rows = colours.len() / columns;
            for (at, inner) in areas.inner.iter().enumerate() {
                let (x, y) = (at % columns, at / columns);
                let near = (y.saturating_sub(1)..(y + 2).min(rows))
                    .flat_map(|y| (x.saturating_sub(1)..(x + 2).min(columns)).map(move |x| y * columns + x));
                assert_eq!(*inner, near.clone().all(|other| colours[other] == colours[at]), "{columns} {at}");
            }
            let first = areas.first();
            let mut counts = vec![0; first.len()];
            first
                .iter()
                .zip(&areas.inner)
                .for_each(|(first, inner)| counts[*first as usize] += u32::from(*inner));
            let found = areas.large_areas();
            for (at, area) in found.iter().enumerate() {
                assert_eq!(*area > 0, counts[first[at] as usize] >= LEAST_INNER, "{columns} {at}");
                assert_eq!(*area, found[first[at] as usize]);
            }
        }
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
