//! What a view sees of cells of Lambertian pixels through a diffuser.

use std::ops::Range;

use num_complex::Complex64;
use papilio_fourier::Plane;
use papilio_transport::Source;
use papilio_transport::spatial::Cells;

use super::super::Response;
use super::super::lobe::{self, LobeResponse};
use super::super::response::Lit;
use super::places::NEIGHBOURS;
use crate::DisplayError;

/// Fraction of the light at either end of an axis that is taken for light from far away.
const FAINT: f64 = 1e-6;
/// Most bins whose light is computed at once: it takes memory.
const MOST_AT_ONCE: usize = 4096;

/// A lobe over a figure.
pub(super) struct ThroughLobe {
    once: LobeResponse,
    state: usize,
    /// Light of this state.
    all: f64,
}

impl ThroughLobe {
    /// Prepares what is seen of figures.
    ///
    /// # Errors
    /// If the panel is not covered.
    pub(super) fn new(lit: Lit<'_>) -> Result<Self, DisplayError> {
        let once = lobe::response(lit, &Source::Diffuse, &vec![1.0; lit.panel.base.bins()])?;
        let light = once.transfer(0, 0.0);
        let brightest = light.iter().enumerate().max_by(|a, b| a.1.re.total_cmp(&b.1.re));
        let (state, all) = brightest.map_or((0, 0.0), |(state, light)| (state, light.re));
        Ok(Self { once, state, all })
    }

    /// How much the light of each cell of a figure counts in the mean of its light that the view sees at some cells, and that of each
    /// other cell in the mean of all other light. How much of all is the figure's own does not come from cells.
    pub(super) fn weights(
        &self,
        pitch_mm: f64,
        cells: Cells,
        is_figure: &[bool],
        seen: &[usize],
    ) -> [Vec<f64>; 2] {
        let mut mean = vec![Complex64::ZERO; cells.len()];
        seen.iter().for_each(|cell| mean[*cell] = (1.0 / seen.len() as f64).into());
        let plane = Plane::new(cells.count);
        let kernel = self.kernel(pitch_mm, cells).into_iter().map(Complex64::from).collect();
        let each = 1.0 / cells.len() as f64;
        // From the place that is seen back to where light comes from.
        let pairs = plane.forward(mean).into_iter().zip(plane.forward(kernel));
        let spectrum = pairs.map(|(seen, kernel)| each * seen * kernel.conj()).collect();
        let weights: Vec<f64> = plane.inverse(spectrum).into_iter().map(|weight| weight.re).collect();
        [true, false].map(|of| {
            let pairs = || weights.iter().zip(is_figure).map(|(weight, figure)| (weight, *figure == of));
            let sum: f64 = pairs().filter(|(_, is_of)| *is_of).map(|(weight, _)| weight).sum();
            pairs().map(|(weight, is_of)| if is_of && sum > 0.0 { weight / sum } else { 0.0 }).collect()
        })
    }

    /// The bins between these edges that have all light but a faint part at either end.
    fn window(&self, axis: usize, edges: &[f64]) -> Range<usize> {
        let strips = self.once.strips(axis, edges).swap_remove(self.state);
        let inside = &strips[1..strips.len() - 1];
        let faint = |lights: &mut dyn Iterator<Item = &f64>| {
            let sums = lights.scan(0.0, |sum, light| {
                *sum += light;
                Some(*sum)
            });
            sums.take_while(|sum| *sum <= FAINT * self.all).count()
        };
        let (before, after) = (faint(&mut inside.iter()), faint(&mut inside.iter().rev()));
        before..(inside.len() - after).max(before)
    }

    /// Light between a cell and the one from which it comes, by the cells between them; the sum is 1. Light is a mean over both cells:
    /// each half of a cell has the parts of the next two.
    fn kernel(&self, pitch_mm: f64, cells: Cells) -> Vec<f64> {
        let Cells { count: [columns, rows], period_mm } = cells;
        // Along a line, light comes from several periods.
        let periods = match rows {
            1 => (2.0 * NEIGHBOURS as f64 * pitch_mm / period_mm[0]).ceil() as usize | 1,
            _ => 1,
        };
        let halves = [2 * periods * columns, 2 * rows];
        let edges = [0, 1].map(|axis| -> Vec<f64> {
            let half_mm = 0.5 * period_mm[axis] / cells.count[axis] as f64;
            (0..=halves[axis]).map(|k| (k as f64 - 0.5 * halves[axis] as f64) * half_mm).collect()
        });
        // Each half of a cell, by the cells that share it.
        let parts = |axis: usize, half: usize| {
            let place = 0.5 * (half as f64 + 0.5 - 0.5 * halves[axis] as f64);
            let (first, second) = (place.floor(), place - place.floor());
            let cell = |step: f64| (first + step).rem_euclid(cells.count[axis] as f64) as usize;
            [(cell(0.0), 1.0 - second), (cell(1.0), second)]
        };
        let mut kernel = vec![0.0; cells.len()];
        if rows == 1 {
            let strips = self.once.strips(0, &edges[0]).swap_remove(self.state);
            for (half, light) in strips[1..strips.len() - 1].iter().enumerate() {
                parts(0, half).iter().for_each(|(cell, part)| kernel[*cell] += part * light);
            }
        } else {
            let [across, along] = [0, 1].map(|axis| self.window(axis, &edges[axis]));
            let edges_x = &edges[0][across.start..=across.end];
            let step = (MOST_AT_ONCE / across.len().max(1)).max(1);
            for first in along.clone().step_by(step) {
                let edges_y = &edges[1][first..=(first + step).min(along.end)];
                let lights = self.once.cells(edges_x, edges_y).swap_remove(self.state);
                for (number, light) in lights.iter().enumerate() {
                    let x = parts(0, across.start + number % across.len());
                    let y = parts(1, first + number / across.len());
                    for (row, of_row) in y {
                        x.iter().for_each(|(column, part)| {
                            kernel[row * columns + column] += of_row * part * light
                        });
                    }
                }
            }
        }
        if self.all > 0.0 {
            kernel.iter_mut().for_each(|light| *light /= self.all);
        }
        // Light from farther away is that of the mean.
        let rest = (1.0 - kernel.iter().sum::<f64>()) / kernel.len() as f64;
        kernel.iter_mut().for_each(|light| *light += rest);
        kernel
    }
}
