//! What a reader sees of a picture, row by row: little memory, and all of it near the processor.
//!
//! Each row is filtered along itself once, and stays as long as the kernels reach it from below.

use std::ops::Range;

use super::eye::{Eye, Source};
use super::flip_rows::{FlipLines, FlipRow};
use super::planes::{Contrast, mapped, times, to_lab};
use super::rows::{Ring, across, along, mirrored, stride};
use super::stripes::BATCH;

/// Rows of a picture that are seen, and those that are needed for the next ones.
pub(super) struct View {
    /// Opponent colours of a row, between margins.
    padded: [Vec<f32>; 3],
    /// Rows after each narrow kernel along them, by opponent colours.
    lines: [Vec<Ring<f32>>; 3],
    /// The row that comes next, and the first after the eye's blur that is not known yet.
    next: [usize; 2],
    flip: FlipLines,
    places: Vec<usize>,
    /// Blocks between which each column lies, and its part of the way between them.
    between: Vec<(usize, f32)>,
    coarse: Vec<f32>,
    contrast: Contrast,
    /// CIELAB after the eye's blur.
    blurred: [Ring<f32>; 3],
    /// CIELAB of the pixels.
    plain: [Ring<f32>; 3],
    colours: [Ring<f32>; 3],
    features: [Ring<f32>; 2],
}

/// A row that is seen.
#[derive(Clone, Copy)]
pub(super) struct SeenRow<'a> {
    pub(super) plain: [&'a [f32]; 3],
    pub(super) blurred: [&'a [f32]; 3],
    pub(super) flip: FlipRow<'a>,
}

/// The block below a place and the part of the way to the next one.
#[inline(always)]
fn place(at: usize, block: usize, count: usize) -> (usize, f32) {
    let at = (((at as f32 + 0.5) / block as f32) - 0.5).clamp(0.0, count as f32 - 1.0);
    let first = (at as usize).min(count.saturating_sub(2));
    (first, at - first as f32)
}

impl View {
    pub(super) fn new(eye: &Eye) -> Self {
        let (columns, window) = (eye.columns, eye.reader.window);
        let stride = stride(columns);
        let across = columns.div_ceil(eye.block);
        let batch = |_: i32| Ring::new(stride, BATCH);
        Self {
            padded: [0; 3].map(|_| vec![0.0; stride + 2 * eye.reach]),
            lines: eye.narrow.each_ref().map(|kernels| {
                kernels.iter().map(|kernel| Ring::new(stride, kernel.len() + eye.reach)).collect()
            }),
            next: [0; 2],
            flip: eye.flip.lines(columns),
            places: Vec::new(),
            between: (0..columns).map(|x| place(x, eye.block, across)).collect(),
            coarse: vec![0.0; across + 1],
            contrast: Contrast::new(columns, window),
            blurred: [0; 3].map(|_| Ring::new(stride, BATCH + window)),
            plain: [0; 3].map(batch),
            colours: [0; 3].map(batch),
            features: [0; 2].map(batch),
        }
    }

    /// Begins with a row.
    pub(super) fn begin(&mut self, eye: &Eye, first: usize) {
        let blurred = first.saturating_sub(eye.reader.window);
        self.next = [blurred.saturating_sub(eye.reach), blurred];
        self.flip.next = first.saturating_sub(eye.flip.reach);
    }

    /// Computes what is seen of the next rows, [`BATCH`] at most, and adds up their local contrasts.
    #[inline(always)]
    pub(super) fn see(&mut self, eye: &Eye, picture: &Source<'_>, rows: Range<usize>, contrasts: &mut f64) {
        let pixels = |row: usize| &picture.pixels[row * eye.columns..][..eye.columns];
        for row in rows {
            let [one, two, three] = self.plain.each_mut().map(|plane| plane.row_mut(row));
            for (pixel, ((one, two), three)) in
                pixels(row).iter().zip(one.iter_mut().zip(&mut *two).zip(&mut *three))
            {
                [*one, *two, *three] = mapped(&picture.relative, *pixel);
            }
            to_lab([one, two, three]);
            while self.next[1] < (row + eye.reader.window + 1).min(eye.rows) {
                self.blur(eye, picture);
            }
            self.contrast.of_row(row, eye.rows, contrasts);
            while self.flip.next < (row + eye.flip.reach + 1).min(eye.rows) {
                let line = pixels(self.flip.next);
                self.flip.push(&eye.flip, eye.columns, |at| mapped(&picture.screen, line[at]));
            }
            self.flip.see(
                &eye.flip,
                (row, eye.rows),
                self.colours.each_mut().map(|plane| plane.row_mut(row)),
                self.features.each_mut().map(|plane| plane.row_mut(row)),
            );
        }
    }

    /// A row of those that were seen last.
    #[inline(always)]
    pub(super) fn row(&self, row: usize) -> SeenRow<'_> {
        let [plain, blurred, colours] = [&self.plain, &self.blurred, &self.colours]
            .map(|rings| rings.each_ref().map(|ring| ring.row(row)));
        let features = self.features.each_ref().map(|ring| ring.row(row));
        SeenRow { plain, blurred, flip: FlipRow { colours, features } }
    }

    /// The next row after the eye's blur, in CIELAB.
    #[inline(always)]
    fn blur(&mut self, eye: &Eye, picture: &Source<'_>) {
        let row = self.next[1];
        while self.next[0] < (row + eye.reach + 1).min(eye.rows) {
            self.filter_along(eye, picture);
        }
        for (k, kernels) in eye.narrow.iter().enumerate() {
            self.interpolate(eye, picture.coarse[k], row, k);
            let into = self.blurred[k].row_mut(row);
            for (kernel, ring) in kernels.iter().zip(&self.lines[k]) {
                let reach = kernel.len() as isize - 1;
                // Beyond the borders, the picture continues as its mirror image.
                let line = |at: isize| {
                    let all = eye.rows as isize;
                    let at = if at < 0 { -1 - at } else { at };
                    let at = if at >= all { 2 * all - 1 - at } else { at };
                    ring.place(at.clamp(0, all - 1) as usize)
                };
                self.places.clear();
                self.places.extend((-reach..=reach).map(|distance| line(row as isize + distance)));
                across(kernel, ring.values(), &self.places, into);
            }
        }
        let [one, two, three] = self.blurred.each_mut().map(|plane| plane.row_mut(row));
        for ((one, two), three) in one.iter_mut().zip(&mut *two).zip(&mut *three) {
            [*one, *two, *three] = times(&eye.back, [*one, *two, *three]);
        }
        to_lab([&mut *one, two, three]);
        self.contrast.push(row, &one[..eye.columns]);
        self.next[1] += 1;
    }

    /// Filters the next row of pixels along itself.
    #[inline(always)]
    fn filter_along(&mut self, eye: &Eye, picture: &Source<'_>) {
        let row = self.next[0];
        let pixels = &picture.pixels[row * eye.columns..][..eye.columns];
        let [one, two, three] = &mut self.padded;
        let inner = eye.reach..eye.reach + eye.columns;
        let planes = one[inner.clone()].iter_mut().zip(&mut two[inner.clone()]).zip(&mut three[inner]);
        for (pixel, ((one, two), three)) in pixels.iter().zip(planes) {
            [*one, *two, *three] = mapped(&picture.opponent, *pixel);
        }
        for ((padded, kernels), rings) in self.padded.iter_mut().zip(&eye.narrow).zip(&mut self.lines) {
            mirrored(padded, eye.reach, eye.columns);
            for (kernel, ring) in kernels.iter().zip(rings) {
                along(kernel, padded, eye.reach, ring.row_mut(row));
            }
        }
        self.next[0] += 1;
    }

    /// Writes a row of values between the middles of blocks.
    #[inline(always)]
    fn interpolate(&mut self, eye: &Eye, coarse: &[f32], row: usize, k: usize) {
        let across = eye.columns.div_ceil(eye.block);
        let down = coarse.len() / across;
        let (first, part) = place(row, eye.block, down);
        let next = (first + 1).min(down - 1);
        let both = coarse[first * across..][..across].iter().zip(&coarse[next * across..][..across]);
        self.coarse.iter_mut().zip(both).for_each(|(to, (one, other))| *to = one + part * (other - one));
        self.coarse[across] = self.coarse[across - 1];
        let into = self.blurred[k].row_mut(row);
        for (to, (first, part)) in into.iter_mut().zip(&self.between) {
            let (one, other) = (self.coarse[*first], self.coarse[*first + 1]);
            *to = one + part * (other - one);
        }
    }
}
