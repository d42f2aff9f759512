//! What a walk with places records.

use std::f64::consts::PI;

use num_complex::Complex64;

use super::path::Path;
use crate::ReflectanceFactor;
use crate::walk::add_scaled;

/// Record of the events of paths.
pub(super) trait Record {
    /// The path has met the pixel at its place.
    fn meets(&self, _: &mut Path) {}

    /// Light of a source reaches the path, with this weight.
    fn receives(&mut self, _source: usize, _: &Path, _weight: f64) {}

    /// The path leaves into the air, or arrives at the pixel from above.
    fn leaves(&mut self, _: &Path, _below: bool) {}
}

/// What is tallied of the spread of uniform states.
///
/// The place r of a meeting is where it is seen, relative to the place on which the view's own ray meets the pixel: the pixel at
/// `-r` of that place.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct KernelTally {
    /// Frequencies at which `exp(-2 pi i f.r)` is tallied, cycles per mm.
    pub frequencies_per_mm: Vec<[f64; 2]>,
    /// Cells in which light is tallied; `None`: no cells.
    pub cells: Option<CellGrid>,
    /// Sums over wavelengths that are tallied, as weights: `[channel][wavelength]` for each source.
    pub channels: Vec<Vec<Vec<f64>>>,
}

/// Equal cells of a rectangle, for a spread. A cell holds all light that falls on it: its area is exact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CellGrid {
    /// Number of columns and rows; columns from the left, rows from the bottom.
    pub count: [usize; 2],
    /// Lower left corner, mm.
    pub corner_mm: [f64; 2],
    /// Width and height of a cell, mm.
    pub cell_mm: [f64; 2],
}

impl CellGrid {
    /// Number of cells.
    pub fn len(&self) -> usize {
        self.count[0] * self.count[1]
    }

    /// True if there is no cell.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The cell of a place; one more than the last for all places beyond.
    fn cell(&self, place_mm: [f64; 2]) -> usize {
        let along = |k: usize| (place_mm[k] - self.corner_mm[k]) / self.cell_mm[k];
        let (column, row) = (along(0), along(1));
        let holds = |at: f64, count: usize| at >= 0.0 && at < count as f64;
        if holds(column, self.count[0]) && holds(row, self.count[1]) {
            row as usize * self.count[0] + column as usize
        } else {
            self.len()
        }
    }
}

/// Spread of light by the number of its meetings with the pixel.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Spreads {
    /// Light that meets the pixel once: the kernel of the first order.
    pub once: Kernel,
    /// Response of all orders to a small change of the pixel's reflectance at a place, relative to its reflectance.
    pub response: Kernel,
}

/// Tallied spread of one source's light.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Kernel {
    /// Mean of `w exp(-2 pi i f.r)`; shape `[channel][state][frequency]`.
    pub transfer: Vec<Complex64>,
    /// Mean of w in each cell, and at last that beyond all cells; shape `[channel][state][cell]`. Empty without cells.
    pub cells: Vec<f64>,
}

impl Kernel {
    fn zeros(rows: usize, frequencies: usize, cells: usize) -> Self {
        Self { transfer: vec![Complex64::ZERO; rows * frequencies], cells: vec![0.0; rows * cells] }
    }

    fn scaled(&self, scale: f64) -> Self {
        Self {
            transfer: self.transfer.iter().map(|value| value * scale).collect(),
            cells: self.cells.iter().map(|value| value * scale).collect(),
        }
    }
}

/// Sums of a replicate.
#[derive(Debug, Clone)]
pub(super) struct Sums<'t> {
    /// By source.
    received: Vec<ReflectanceFactor>,
    tally: Option<&'t KernelTally>,
    spreads: Vec<Spreads>,
}

impl<'t> Sums<'t> {
    pub(super) fn new(
        sources: usize,
        (images, bins): (usize, usize),
        tally: Option<&'t KernelTally>,
    ) -> Self {
        let nothing = ReflectanceFactor { via_pixel: vec![0.0; images * bins], front: vec![0.0; bins] };
        let spread = |tally: &KernelTally, source: usize| {
            let rows = tally.channels[source].len() * images;
            let cells = tally.cells.map_or(0, |cells| cells.len() + 1);
            let zeros = Kernel::zeros(rows, tally.frequencies_per_mm.len(), cells);
            Spreads { once: zeros.clone(), response: zeros }
        };
        let spreads = tally.iter().flat_map(|tally| (0..sources).map(|source| spread(tally, source)));
        Self { received: vec![nothing; sources], tally, spreads: spreads.collect() }
    }

    pub(super) fn means(&self, scale: f64) -> super::Estimate {
        let mean = |sum: &ReflectanceFactor| ReflectanceFactor {
            via_pixel: sum.via_pixel.iter().map(|value| value * scale).collect(),
            front: sum.front.iter().map(|value| value * scale).collect(),
        };
        let spread =
            |sum: &Spreads| Spreads { once: sum.once.scaled(scale), response: sum.response.scaled(scale) };
        super::Estimate {
            rho: self.received.iter().map(mean).collect(),
            spreads: self.spreads.iter().map(spread).collect(),
        }
    }
}

impl Record for Sums<'_> {
    fn meets(&self, path: &mut Path) {
        let Some(tally) = self.tally else { return };
        let frequencies = &tally.frequencies_per_mm;
        let Path { trace, place_mm, .. } = path;
        trace.phases.resize(place_mm.len() * frequencies.len(), Complex64::ZERO);
        for (k, [x, y]) in place_mm.iter().enumerate() {
            let phases = &mut trace.phases[k * frequencies.len()..][..frequencies.len()];
            // The place r is minus that on the pixel.
            for (phase, [fx, fy]) in phases.iter_mut().zip(frequencies) {
                let (sin, cos) = (2.0 * PI * (fx * x + fy * y)).sin_cos();
                *phase += Complex64::new(cos, sin);
            }
            trace.cells.extend(tally.cells.map(|cells| cells.cell([-x, -y])));
        }
    }

    fn receives(&mut self, source: usize, path: &Path, weight: f64) {
        let sum = &mut self.received[source];
        if path.meetings == 0 {
            return add_scaled(&mut sum.front, path.light(), weight);
        }
        add_scaled(&mut sum.via_pixel, path.light(), weight);
        let Some(tally) = self.tally else { return };
        let once = path.meetings == 1;
        let Spreads { once: first, response } = &mut self.spreads[source];
        for place in 0..path.place_mm.len() {
            for (channel, weights) in tally.channels[source].iter().enumerate() {
                for (state, light) in path.light().chunks_exact(path.bins()).enumerate() {
                    let bins = path.bins_at(place);
                    let light = weight * dot(&light[bins.clone()], &weights[bins]);
                    if light == 0.0 {
                        continue;
                    }
                    let row = channel * (path.light().len() / path.bins()) + state;
                    tally.add(response, row, path, place, light);
                    if once {
                        tally.add(first, row, path, place, light);
                    }
                }
            }
        }
    }
}

impl KernelTally {
    /// Adds light at the places at which a path met the pixel.
    fn add(&self, sum: &mut Kernel, row: usize, path: &Path, place: usize, light: f64) {
        let count = self.frequencies_per_mm.len();
        let phases = path.trace.phases[place * count..][..count].iter();
        sum.transfer[row * count..][..count]
            .iter_mut()
            .zip(phases)
            .for_each(|(sum, phase)| *sum += light * phase);
        if let Some(cells) = self.cells {
            let sums = &mut sum.cells[row * (cells.len() + 1)..][..=cells.len()];
            let met = path.trace.cells.iter().skip(place).step_by(path.place_mm.len());
            met.for_each(|cell| sums[*cell] += light);
        }
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
