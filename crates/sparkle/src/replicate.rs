//! Rays through one random face.

use num_complex::Complex64;
use papilio_optics::Beta;
use papilio_sampling::{SampleStream, Sampler};

use crate::deflection::{applied, direction};
use crate::grid::Grid;
use crate::room::Light;
use crate::{Moments, Plan};

/// Part of the random numbers of a replicate from which faces beyond the first are drawn.
const OTHER_FACES: u64 = 0x0066_6163_6573_0000;

/// Part of the random numbers of a replicate for the places and directions of rays.
const RAYS: u64 = 0x7261_7973;

/// Light of a pixel below a face, twice: the errors of both, that of rays at random places, are independent.
pub type PixelLight = [f64; 2];

impl Plan {
    /// Sums over the pixels below one face: of the light of the room through the windows, of uniform light
    /// through the windows, of the light of the room from a uniform pixel plane.
    pub fn replicate(&self, replicate: u64) -> [Moments; 3] {
        Self::moments(&self.light_of_pixels(replicate))
    }

    /// Sums over the pixels of one face.
    pub fn moments(light_of_pixels: &[[PixelLight; 3]]) -> [Moments; 3] {
        let mut moments = [Moments::default(); 3];
        for light in light_of_pixels {
            moments.iter_mut().zip(light).for_each(|(moments, light)| moments.add(*light));
        }
        moments
    }

    /// Number of columns and rows of the pixels of one replicate.
    pub fn columns_and_rows(&self) -> [usize; 2] {
        [0, 1].map(|axis| self.cells.count[axis] / self.of_pixel[axis])
    }

    /// Light of each pixel below one face, from the lower left: of the room through the windows, of uniform
    /// light through the windows, of the room from a uniform pixel plane.
    pub fn light_of_pixels(&self, replicate: u64) -> Vec<[PixelLight; 3]> {
        let numbers = SampleStream::new(Sampler::Random, self.effort.seed, replicate);
        let faces = self.faces(&numbers);
        let mut sums = if self.images_sources() {
            let mut sums = self.by_cells(&faces[0], &Light::Uniform(0.0));
            self.add_images(&faces, &numbers.part(RAYS), &mut sums);
            sums
        } else {
            self.by_cells(&faces[0], &Light::of(self, &faces))
        };
        let scale = 1.0 / (self.of_pixel[0] * self.of_pixel[1]) as f64;
        sums.iter_mut().flatten().flatten().for_each(|sum| *sum *= scale);
        sums
    }

    /// Slopes of the faces of a replicate: of that above the pixels, and of those which light enters far from
    /// there.
    fn faces(&self, numbers: &SampleStream) -> Vec<Grid<Complex64>> {
        let of = |face: usize| match face {
            0 => self.slopes(numbers),
            _ => self.slopes(&numbers.part(OTHER_FACES + face as u64)),
        };
        (0..self.meetings.count()).map(|face| Grid::new(self.cells, of(face))).collect()
    }

    /// Number of the pixel of a cell; `None` at the border of a face that is no whole number of pixels.
    fn pixel(&self, cell: usize) -> Option<usize> {
        let pixels = self.columns_and_rows();
        let at =
            [cell % self.cells.count[0] / self.of_pixel[0], cell / self.cells.count[0] / self.of_pixel[1]];
        (at[0] < pixels[0] && at[1] < pixels[1]).then(|| at[1] * pixels[0] + at[0])
    }

    /// Sums over the cells of each pixel, for light that depends on the place of the pixel plane alone.
    ///
    /// Each cell of the face is seen at a cell of the same size on the pixel plane, whose overlap with the
    /// windows is exact: the mean over many faces is exact for cells of any size.
    fn by_cells(&self, face: &Grid<Complex64>, light: &Light) -> Vec<[PixelLight; 3]> {
        let windows = self.panel.matrix.over(self.cells.size());
        let per_slope = self.view.per_slope_mm();
        let part = 1.0 / self.pupil.len() as f64;
        let mut sums = vec![[PixelLight::default(); 3]; self.pixels()];
        for (cell, slope) in face.values.iter().enumerate() {
            let Some(pixel) = self.pixel(cell) else { continue };
            let [x, y] = self.cells.middle(cell);
            let [u, v] = applied(per_slope, [slope.re, slope.im]);
            for shift in &self.pupil {
                let place = [x + u + shift[0], y + v + shift[1]];
                let (lit, light) = (part * windows.at(place), light.at(place));
                for (sum, light) in sums[pixel].iter_mut().zip([lit * light, lit, part * light]) {
                    sum.iter_mut().for_each(|sum| *sum += light);
                }
            }
        }
        sums
    }

    /// Adds the light of the room in mirror-like pixels: in each cell two rays at random places, to random
    /// places of the pupil.
    ///
    /// Neighbouring rays enter far from each other where the face spreads them widely. No average over a cell
    /// would be right there; the product of two independent estimates has the expectation of the square of
    /// the light.
    fn add_images(&self, faces: &[Grid<Complex64>], numbers: &SampleStream, sums: &mut [[PixelLight; 3]]) {
        let (leaves, enters) = (&faces[0], &faces[self.meetings.entered(0)]);
        let windows = self.panel.matrix.over(self.cells.size());
        let (size, per_slope) = (self.cells.size(), self.view.per_slope_mm());
        let radius = self.panel.pupil.radius();
        let back = self.view.displacement_mm.map(|d| 2.0 * d);
        for cell in 0..self.cells.len() {
            let Some(pixel) = self.pixel(cell) else { continue };
            let middle = self.cells.middle(cell);
            for half in [0, 1] {
                let [u, v, s, t] = numbers.block(cell as u64, half as u32);
                let place = [middle[0] + (u - 0.5) * size[0], middle[1] + (v - 0.5) * size[1]];
                let beta =
                    if radius > 0.0 { direction(self.panel.view, radius, [s, t]) } else { Beta::default() };
                let slope = leaves.smooth_at(place);
                let (moved, shift) = (applied(per_slope, [slope.re, slope.im]), self.view.shift(beta));
                let on_plane = [0, 1].map(|k| place[k] + moved[k] - shift[k]);
                let entered = [0, 1].map(|k| place[k] - back[k] + 2.0 * (moved[k] - shift[k]));
                let bent = (slope + enters.smooth_at(entered)) * self.view.bend;
                let light = self.panel.room.light(self.panel.view + beta - Beta { x: bent.re, y: bent.im });
                let [through_window, _, of_plane] = &mut sums[pixel];
                through_window[half] += windows.at(on_plane) * light;
                of_plane[half] += light;
            }
        }
    }
}
