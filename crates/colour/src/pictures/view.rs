//! What a reader sees of a picture, row by row: little memory, and all of it near the processor.
//!
//! Each row of pixels stays as long as the kernels reach it from below. Rows with samples are filtered down the columns first, then along
//! themselves, and after that they have the samples alone.

use std::ops::Range;

use super::eye::{Eye, Source};
use super::flip_rows::{FlipLines, FlipRow};
use super::planes::{Contrast, mapped, times, to_lab};
use super::rows::{Padded, Ring, across, along, stride};
use super::stripes::BATCH;

/// Rows of a picture that are seen, and those that are needed for the next ones. Rows with samples have numbers of their own.
pub(super) struct View {
    /// Rows in opponent colours.
    opponents: [Ring<f32>; 3],
    padded: Padded,
    /// The row of pixels that comes next, and the first one after the eye's blur that is not known yet, by its number.
    next: [usize; 2],
    flip: FlipLines,
    places: Vec<usize>,
    /// By the first column with a sample: blocks between which each sample lies, and its part of the way between them.
    between: Vec<Vec<(usize, f32)>>,
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
        let (columns, step) = (eye.columns, eye.reader.step);
        let blocks = columns.div_ceil(eye.block);
        let contrast = Contrast::new(eye.across, eye.reader.window, step);
        let ring = |count: usize| Ring::new(stride(eye.across), count);
        let line = |_: i32| Ring::new(stride(columns), 2 * eye.reach + 1);
        let between = |first: usize| {
            (0..eye.across).map(|at| place(first + at * step, eye.block, blocks)).collect::<Vec<_>>()
        };
        Self {
            opponents: [0; 3].map(line),
            padded: Padded::new(columns, eye.reach, step),
            next: [0; 2],
            flip: eye.flip.lines(columns, step),
            places: Vec::new(),
            between: (0..step).map(between).collect(),
            coarse: vec![0.0; blocks + 1],
            blurred: [0; 3].map(|_| ring(BATCH + contrast.reach())),
            contrast,
            plain: [0; 3].map(|_| ring(BATCH)),
            colours: [0; 3].map(|_| ring(BATCH)),
            features: [0; 2].map(|_| ring(BATCH)),
        }
    }

    /// Begins with a row.
    pub(super) fn begin(&mut self, eye: &Eye, first: usize) {
        let blurred = first.saturating_sub(self.contrast.reach());
        let row = |number: usize| eye.sample(number).0;
        self.next = [row(blurred).saturating_sub(eye.reach), blurred];
        self.flip.next = row(first).saturating_sub(eye.flip.reach);
    }

    /// Computes what is seen of the next rows, [`BATCH`] at most, and adds up their local contrasts.
    #[inline(always)]
    pub(super) fn see(
        &mut self,
        eye: &Eye,
        picture: &Source<'_>,
        numbers: Range<usize>,
        contrasts: &mut f64,
    ) {
        let pixels = |row: usize| &picture.pixels[row * eye.columns..][..eye.columns];
        for number in numbers {
            let (row, first) = eye.sample(number);
            let [one, two, three] = self.plain.each_mut().map(|plane| plane.row_mut(number));
            for (pixel, ((one, two), three)) in pixels(row)[first..]
                .iter()
                .step_by(eye.reader.step)
                .zip(one.iter_mut().zip(&mut *two).zip(&mut *three))
            {
                [*one, *two, *three] = mapped(&picture.relative, *pixel);
            }
            to_lab([one, two, three]);
            while self.next[1] < (number + self.contrast.reach() + 1).min(eye.down) {
                self.blur(eye, picture);
            }
            self.contrast.of_row(number, eye.down, contrasts);
            while self.flip.next < (row + eye.flip.reach + 1).min(eye.rows) {
                let line = pixels(self.flip.next);
                self.flip.push(|at| mapped(&picture.screen, line[at]), eye.columns);
            }
            self.flip.see(
                &eye.flip,
                (row, eye.rows, first),
                self.colours.each_mut().map(|plane| plane.row_mut(number)),
                self.features.each_mut().map(|plane| plane.row_mut(number)),
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
        let number = self.next[1];
        let (row, first) = eye.sample(number);
        while self.next[0] < (row + eye.reach + 1).min(eye.rows) {
            self.push(eye, picture);
        }
        for (k, kernels) in eye.narrow.iter().enumerate() {
            self.interpolate(eye, picture.coarse[k], (row, first), self.next[1], k);
            let into = self.blurred[k].row_mut(number);
            let ring = &self.opponents[k];
            for kernel in kernels {
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
                self.padded.inner().fill(0.0);
                across(kernel, ring.values(), &self.places, self.padded.inner());
                self.padded.mirror();
                along(kernel, &self.padded, first, into);
            }
        }
        let [one, two, three] = self.blurred.each_mut().map(|plane| plane.row_mut(number));
        for ((one, two), three) in one.iter_mut().zip(&mut *two).zip(&mut *three) {
            [*one, *two, *three] = times(&eye.back, [*one, *two, *three]);
        }
        to_lab([&mut *one, two, three]);
        self.contrast.push(number, &one[..eye.across]);
        self.next[1] += 1;
    }

    /// Takes the next row of pixels.
    #[inline(always)]
    fn push(&mut self, eye: &Eye, picture: &Source<'_>) {
        let row = self.next[0];
        let pixels = &picture.pixels[row * eye.columns..][..eye.columns];
        let [one, two, three] = self.opponents.each_mut().map(|ring| &mut ring.row_mut(row)[..eye.columns]);
        for (pixel, ((one, two), three)) in pixels.iter().zip(one.iter_mut().zip(two).zip(three)) {
            [*one, *two, *three] = mapped(&picture.opponent, *pixel);
        }
        self.next[0] += 1;
    }

    /// Writes a row of values between the middles of blocks.
    #[inline(always)]
    fn interpolate(
        &mut self,
        eye: &Eye,
        coarse: &[f32],
        (row, column): (usize, usize),
        number: usize,
        k: usize,
    ) {
        let across = eye.columns.div_ceil(eye.block);
        let down = coarse.len() / across;
        let (first, part) = place(row, eye.block, down);
        let next = (first + 1).min(down - 1);
        let both = coarse[first * across..][..across].iter().zip(&coarse[next * across..][..across]);
        self.coarse.iter_mut().zip(both).for_each(|(to, (one, other))| *to = one + part * (other - one));
        self.coarse[across] = self.coarse[across - 1];
        let into = self.blurred[k].row_mut(number);
        for (to, (first, part)) in into.iter_mut().zip(&self.between[column]) {
            let (one, other) = (self.coarse[*first], self.coarse[*first + 1]);
            *to = one + part * (other - one);
        }
    }
}
