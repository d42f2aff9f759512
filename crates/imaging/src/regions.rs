//! Drawings in a picture: flat areas with hard borders, and the text and lines between them.
//!
//! **What.** Pixels of exactly one colour that touch are an area. It is *flat* if it has [`LEAST_INNER`] pixels whose
//! eight neighbours have its colour, and most of its border is hard: steps of more than [`SOFT`] of 255 in a
//! component. The flat tones of a photograph, such as an overexposed sky, and the bands of a gradient end softly.
//! Flat areas are a drawing, and so is what lies between them within [`REACH`] pixels (a morphological closing): text, lines.
//! Holes of less than [`LEAST_AREA`] pixels are filled, and drawings of less are left to the photograph.
//!
//! Colours are encoded bytes, so that rounding of resized pictures does not matter. Nothing depends on threads.

use std::ops::Range;

use crate::ImagingError;
use crate::halftone::check_rows;

/// Inner pixels of a flat area at least.
const LEAST_INNER: usize = 16;
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
        Ok(Self { colours, columns, inner: inner(colours, columns) })
    }

    /// Whether each pixel belongs to an area that is wider than a line, with an inner pixel, and whether to one of at least `least` pixels:
    /// of all areas with a pixel that is wanted.
    pub fn solid_and_large(&self, wanted: &[bool], least: usize) -> [Vec<bool>; 2] {
        let [mut solid, mut large, mut seen] = [0; 3].map(|_| vec![false; self.colours.len()]);
        let mut area = Vec::new();
        for start in wanted.iter().enumerate().filter(|(_, is_wanted)| **is_wanted).map(|(at, _)| at) {
            if seen[start] {
                continue;
            }
            self.walk(start, &mut seen, &mut area, |_, _| {});
            let is_solid = area.iter().any(|at| self.inner[*at as usize]);
            for at in &area {
                (solid[*at as usize], large[*at as usize]) = (is_solid, area.len() >= least);
            }
        }
        [solid, large]
    }

    /// Whether each pixel belongs to a drawing.
    pub fn drawing(&self) -> Vec<bool> {
        let mut drawing = self.flat();
        if drawing.contains(&true) {
            closed(&mut drawing, self.columns);
            // First the holes of drawings, then drawings in photographs.
            for small in [false, true] {
                change_small(&mut drawing, self.columns, small);
            }
        }
        drawing
    }

    /// Whether each pixel belongs to a flat area. Only areas with an inner pixel are walked through: a photograph has few.
    fn flat(&self) -> Vec<bool> {
        let [mut flat, mut seen] = [0; 2].map(|_| vec![false; self.colours.len()]);
        let mut area = Vec::new();
        for start in self.inner.iter().enumerate().filter(|(_, is_inner)| **is_inner).map(|(at, _)| at) {
            if seen[start] {
                continue;
            }
            // Soft and hard steps at its border.
            let mut steps = [0_u32; 2];
            self.walk(start, &mut seen, &mut area, |here, there| {
                let largest = here.iter().zip(there).fold(0, |most, (a, b)| most.max(a.abs_diff(b)));
                steps[usize::from(largest > SOFT)] += 1;
            });
            let inner = area.iter().filter(|at| self.inner[**at as usize]).take(LEAST_INNER).count();
            let [soft, hard] = steps.map(f64::from);
            if inner >= LEAST_INNER && soft <= SOFT_PART * (soft + hard) {
                area.iter().for_each(|at| flat[*at as usize] = true);
            }
        }
        flat
    }

    /// Finds the pixels of the area of one, and marks them; calls a function with the colours on both sides of each step at its border.
    fn walk(
        &self,
        start: usize,
        seen: &mut [bool],
        area: &mut Vec<u32>,
        mut step: impl FnMut([u8; 3], [u8; 3]),
    ) {
        area.clear();
        area.push(start as u32);
        seen[start] = true;
        let colour = self.colours[start];
        let mut next = 0;
        while let Some(at) = area.get(next).map(|at| *at as usize) {
            next += 1;
            let x = at % self.columns;
            let mut visit = |other: usize| {
                if self.colours[other] != colour {
                    step(colour, self.colours[other]);
                } else if !std::mem::replace(&mut seen[other], true) {
                    area.push(other as u32);
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
    }
}

/// Changes areas of a value that have less than [`LEAST_AREA`] pixels, and less than the picture.
fn change_small(mask: &mut [bool], columns: usize, value: bool) {
    let runs = runs(mask, columns, value);
    let mut first: Vec<u32> = (0..runs.len() as u32).collect();
    let root = |first: &mut [u32], mut at: u32| {
        while first[at as usize] != at {
            first[at as usize] = first[first[at as usize] as usize];
            at = first[at as usize];
        }
        at
    };
    // The first run that may touch the present one from above.
    let mut above = 0;
    for (at, run) in runs.iter().enumerate() {
        let [start, end] = [run.start, run.end].map(|one| one.checked_sub(columns));
        let Some((start, end)) = start.zip(end) else { continue };
        while runs[above].end <= start {
            above += 1;
        }
        for other in (above..at).take_while(|other| runs[*other].start < end) {
            let [one, other] = [at, other].map(|at| root(&mut first, at as u32));
            first[one.max(other) as usize] = one.min(other);
        }
    }
    let mut counts = vec![0; runs.len()];
    for (at, run) in runs.iter().enumerate() {
        // Each run comes after the first one of its area.
        first[at] = first[first[at] as usize];
        counts[first[at] as usize] += run.len();
    }
    let least = LEAST_AREA.min(mask.len());
    for (run, _) in runs.into_iter().zip(first).filter(|(_, first)| counts[*first as usize] < least) {
        mask[run].fill(!value);
    }
}

/// The pixels of rows with a value that follow each other.
fn runs(mask: &[bool], columns: usize, value: bool) -> Vec<Range<usize>> {
    let mut runs = Vec::new();
    for (row, line) in mask.chunks_exact(columns).enumerate() {
        let mut from = 0;
        for same in line.chunk_by(|one, other| one == other) {
            if same[0] == value {
                runs.push(row * columns + from..row * columns + from + same.len());
            }
            from += same.len();
        }
    }
    runs
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
    let set = |to: &mut [bool], from: &[bool]| {
        for (to, from) in to.iter_mut().zip(from) {
            *to = if value { *to | from } else { *to & from };
        }
    };
    let before = mask.to_vec();
    for (row, line) in mask.chunks_exact_mut(columns).zip(before.chunks_exact(columns)) {
        for distance in 1..=REACH.min(columns - 1) {
            set(&mut row[distance..], line);
            set(row, &line[distance..]);
        }
    }
    let before = mask.to_vec();
    for distance in (1..=REACH).map(|rows| (rows * columns).min(before.len())) {
        set(&mut mask[distance..], &before);
        set(mask, &before[distance..]);
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

    /// The first pixel of the area of each pixel, by the definition: neighbours that are the same are in the same area.
    fn joined<T: PartialEq>(values: &[T], columns: usize) -> Vec<usize> {
        let mut first: Vec<usize> = (0..values.len()).collect();
        loop {
            let before = first.clone();
            for at in 0..values.len() {
                let beside = (at % columns > 0).then(|| at - 1);
                for other in [beside, at.checked_sub(columns)].into_iter().flatten() {
                    if values[at] == values[other] {
                        let least = first[at].min(first[other]);
                        (first[at], first[other]) = (least, least);
                    }
                }
            }
            if first == before {
                return first;
            }
        }
    }

    /// Areas, inner pixels and small areas are those of their definitions.
    #[test]
    fn areas_are_those_of_joined_pixels() {
        let mut dice = Dice::new(6, 0);
        for (columns, blocks) in [(40, 4), (37, 3), (1, 1), (90, 9), (60, 1)] {
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
            let first = joined(&colours, columns);
            let [mut counts, mut inner] = [0; 2].map(|_| vec![0; first.len()]);
            for (first, is_inner) in first.iter().zip(&areas.inner) {
                counts[*first] += 1;
                inner[*first] += usize::from(*is_inner);
            }
            let wanted: Vec<bool> = (0..colours.len()).map(|at| at % 7 == 0).collect();
            let [solid, large] = areas.solid_and_large(&wanted, 20);
            for at in (0..colours.len()).filter(|at| wanted[*at]) {
                let (is_solid, is_large) = (inner[first[at]] > 0, counts[first[at]] >= 20);
                assert_eq!((solid[at], large[at]), (is_solid, is_large), "{columns} {at}");
            }
            for value in [false, true] {
                let mut mask: Vec<bool> = colours.iter().map(|colour| colour[0] == 0).collect();
                let first = joined(&mask, columns);
                let mut counts = vec![0; first.len()];
                first.iter().for_each(|first| counts[*first] += 1);
                let least = LEAST_AREA.min(mask.len());
                let is_changed = |at: usize| mask[at] == value && counts[first[at]] < least;
                let expected: Vec<bool> = (0..mask.len()).map(|at| mask[at] != is_changed(at)).collect();
                change_small(&mut mask, columns, value);
                assert_eq!(mask, expected, "{columns}");
            }
        }
    }

    #[test]
    fn closing_is_that_of_its_definition() {
        let mut dice = Dice::new(7, 0);
        for (columns, rows) in [(30, 20), (4, 9), (1, 1), (17, 3)] {
            let mask: Vec<bool> = (0..columns * rows).map(|_| dice.throw() < 0.02).collect();
            for value in [true, false] {
                let near = |at: usize| {
                    let (x, y) = (at % columns, at / columns);
                    let down = y.saturating_sub(REACH)..(y + REACH + 1).min(rows);
                    let across = x.saturating_sub(REACH)..(x + REACH + 1).min(columns);
                    down.flat_map(move |y| across.clone().map(move |x| y * columns + x))
                };
                let expected: Vec<bool> = (0..mask.len())
                    .map(|at| if near(at).any(|other| mask[other] == value) { value } else { !value })
                    .collect();
                let mut found = mask.clone();
                spread(&mut found, columns, value);
                assert_eq!(found, expected, "{columns} {value}");
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
        assert_eq!(Areas::new(&[[0; 3]; 5], 5).unwrap().solid_and_large(&[true; 5], 6)[0], [true; 5]);
    }
}
