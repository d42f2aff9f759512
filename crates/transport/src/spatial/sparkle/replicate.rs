//! Rays through one random face.

use papilio_sampling::{SampleStream, Sampler};

use super::deflection::applied;
use super::grid::Grid;
use super::room::Light;
use super::{Moments, Plan};

impl Plan {
    /// Sums over the pixels below one face: of the light of the room through the windows, of uniform light through the
    /// windows, of the light of the room from a uniform pixel plane.
    ///
    /// Each cell of the face is seen at a cell of the same size on the pixel plane, whose overlap with the windows is
    /// exact: the mean over many faces is exact for cells of any size.
    pub fn replicate(&self, replicate: u64) -> [Moments; 3] {
        Self::moments(&self.light_of_pixels(replicate))
    }

    /// Sums over the pixels of one face.
    pub fn moments(light_of_pixels: &[[f64; 3]]) -> [Moments; 3] {
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

    /// Light of each pixel below one face, from the lower left: of the room through the windows, of uniform light through the
    /// windows, of the room from a uniform pixel plane.
    pub fn light_of_pixels(&self, replicate: u64) -> Vec<[f64; 3]> {
        let numbers = SampleStream::new(Sampler::Random, self.effort.seed, replicate);
        let slopes = Grid::new(self.cells, self.slopes(&numbers));
        let light = Light::new(&self.panel.room, self.panel.pixel, &self.view, &slopes, &self.entering);
        let windows = self.panel.matrix.over(self.cells.size());
        let per_slope = self.view.per_slope_mm();
        let pixels = self.columns_and_rows();
        let mut sums = vec![[0.0; 3]; pixels[0] * pixels[1]];
        for (cell, slope) in slopes.values.iter().enumerate() {
            let [column, row] = [cell % self.cells.count[0], cell / self.cells.count[0]];
            let [right, up] = [column / self.of_pixel[0], row / self.of_pixel[1]];
            if right >= pixels[0] || up >= pixels[1] {
                continue;
            }
            let pixel = up * pixels[0] + right;
            let [x, y] = self.cells.middle(cell);
            let [u, v] = applied(per_slope, [slope.re, slope.im]);
            for (beta, shift) in &self.pupil {
                let place = [x + u + shift[0], y + v + shift[1]];
                let (lit, light) = (windows.at(place), light.at(cell, place, *beta));
                let sum = &mut sums[pixel];
                sum[0] += lit * light;
                sum[1] += lit;
                sum[2] += light;
            }
        }
        let scale = 1.0 / (self.of_pixel[0] * self.of_pixel[1] * self.pupil.len()) as f64;
        sums.iter_mut().flatten().for_each(|sum| *sum *= scale);
        sums
    }
}
