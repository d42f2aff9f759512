//! What a walk with places records.
//!
//! Light that has met the pixel once is added to the nodes of the pixel's angular table; spectra are formed from the sums at the
//! end, once for all paths.

use rustfft::num_complex::Complex64;

use papilio_optics::with_widest_simd;
use papilio_sampling::warp;

use super::light::{FirstMeeting, Recorded, Shown};
use super::path::{Path, Trace};
use crate::angular::Stencil;
use crate::walk::add_scaled;
use crate::{Base, ReflectanceFactor, Reflector};

/// Record of the events of paths.
pub(super) trait Record {
    /// The path has met the pixel at its place.
    fn meets(&self, _: &mut Path) {}

    /// Light of a source reaches the path, with this weight.
    fn receives(&mut self, _source: usize, _: &Path, _weight: f64) {}

    /// The path leaves into the air, or arrives at the pixel from above.
    fn leaves(&mut self, _: &mut Path, _below: bool) {}
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

/// What is recorded: the pixel, and the sums over wavelengths of a kernel.
pub(super) struct Plan<'a> {
    base: &'a Base,
    images: usize,
    /// Number of nodes of the angular table, with room for a look-up that begins at the last one.
    nodes: usize,
    pub(super) tally: Option<KernelTally>,
    /// The channels of the reflectance at the nodes; `[source][channel][state][node]`.
    at_nodes: Vec<Vec<f64>>,
}

impl<'a> Plan<'a> {
    pub(super) fn new(base: &'a Base, images: usize, tally: Option<KernelTally>) -> Self {
        let nodes = match &base.reflector {
            Reflector::Specular(table) => table.nodes.count(),
            Reflector::Lambertian(_) | Reflector::Scattering(_) => 1,
        };
        let mut plan = Self { base, images, nodes: nodes + Stencil::LEN, tally, at_nodes: Vec::new() };
        let channels = plan.tally.iter().flat_map(|tally| &tally.channels);
        plan.at_nodes = channels.map(|channels| plan.channels_at_nodes(nodes, channels)).collect();
        plan
    }

    /// The channels of the reflectance of each state at each node; `[channel][state][node]`.
    fn channels_at_nodes(&self, nodes: usize, channels: &[Vec<f64>]) -> Vec<f64> {
        let (states, bins) = (self.base.states(), self.base.bins());
        let mut values = vec![0.0; channels.len() * states * self.nodes];
        let mut one = vec![0.0; nodes];
        for node in 0..nodes {
            one[node] = 1.0;
            let spectra = self.spectra(&[&one]);
            one[node] = 0.0;
            for (channel, weights) in channels.iter().enumerate() {
                for (state, spectrum) in spectra.chunks_exact(bins).enumerate() {
                    values[(channel * states + state) * self.nodes + node] = dot(spectrum, weights);
                }
            }
        }
        values
    }

    /// Spectra of sums over nodes; `[sum][state][wavelength]`.
    fn spectra(&self, sums: &[&[f64]]) -> Vec<f64> {
        match &self.base.reflector {
            Reflector::Specular(table) => table.weighted_sums(sums),
            Reflector::Lambertian(reflectance) => {
                sums.iter().flat_map(|sum| reflectance.iter().map(|value| sum[0] * value)).collect()
            }
            // Has no look-ups.
            Reflector::Scattering(_) => vec![0.0; sums.len() * self.base.states() * self.base.bins()],
        }
    }
}

/// Sums of light of one source.
#[derive(Debug, Clone)]
struct Received {
    /// Light that has not met the pixel, with and without spectra.
    front: Vec<f64>,
    front_number: f64,
    via_pixel: Vec<f64>,
    /// Light that met the pixel once: `[node]` if each image shows its state, else `[image][state][node]`.
    look_ups: Vec<f64>,
    each_state: bool,
    /// Sums of the kernels of one meeting, and of several.
    kernels: [KernelSums; 2],
}

/// Sums of a kernel.
#[derive(Debug, Clone, Default)]
struct KernelSums {
    /// Real and imaginary part; `[channel][state][frequency]`.
    transfer: [Vec<f64>; 2],
    cells: Vec<f64>,
}

/// Sums of a replicate.
pub(super) struct Sums<'p> {
    plan: &'p Plan<'p>,
    /// By source.
    received: Vec<Received>,
}

impl<'p> Sums<'p> {
    pub(super) fn new(plan: &'p Plan<'p>, sources: usize) -> Self {
        let (images, bins) = (plan.images, plan.base.bins());
        let each_state = plan.tally.is_some();
        let pairs = if each_state { 1 } else { images * plan.base.states() };
        let kernels = |source: usize| {
            let Some(tally) = &plan.tally else { return KernelSums::default() };
            let rows = tally.channels[source].len() * images;
            let frequencies = vec![0.0; rows * tally.frequencies_per_mm.len()];
            let cells = tally.cells.map_or(0, |cells| cells.len() + 1);
            KernelSums { transfer: [frequencies.clone(), frequencies], cells: vec![0.0; rows * cells] }
        };
        let received = |source: usize| Received {
            front: vec![0.0; bins],
            front_number: 0.0,
            via_pixel: vec![0.0; images * bins],
            look_ups: vec![0.0; pairs * plan.nodes],
            each_state,
            kernels: [kernels(source), kernels(source)],
        };
        Self { plan, received: (0..sources).map(received).collect() }
    }

    pub(super) fn means(&self, scale: f64) -> super::Estimate {
        let spreads = |received: &Received| {
            let [once, later] = &received.kernels;
            let all = once.plus(later);
            Spreads { once: once.scaled(scale), response: all.scaled(scale) }
        };
        super::Estimate {
            rho: self.received.iter().map(|received| received.mean(self.plan, scale)).collect(),
            spreads: if self.plan.tally.is_some() {
                self.received.iter().map(spreads).collect()
            } else {
                Vec::new()
            },
        }
    }
}

impl Received {
    fn mean(&self, plan: &Plan<'_>, scale: f64) -> ReflectanceFactor {
        let (states, bins) = (plan.base.states(), plan.base.bins());
        let mut via_pixel = self.via_pixel.clone();
        // Only what was seen at all.
        let seen: Vec<(usize, &[f64])> = self
            .look_ups
            .chunks_exact(plan.nodes)
            .map(|sum| &sum[..plan.nodes - Stencil::LEN])
            .enumerate()
            .filter(|(_, sum)| sum.iter().any(|weight| *weight != 0.0))
            .collect();
        let sums: Vec<&[f64]> = seen.iter().map(|(_, sum)| *sum).collect();
        let spectra = if sums.is_empty() { Vec::new() } else { plan.spectra(&sums) };
        for ((pair, _), spectra) in seen.iter().zip(spectra.chunks_exact((states * bins).max(1))) {
            if self.each_state {
                add_scaled(&mut via_pixel, spectra, 1.0);
            } else {
                let (image, state) = (pair / states, pair % states);
                let image = &mut via_pixel[image * bins..][..bins];
                add_scaled(image, &spectra[state * bins..][..bins], 1.0);
            }
        }
        via_pixel.iter_mut().for_each(|value| *value *= scale);
        let front = self.front.iter().map(|value| scale * (value + self.front_number)).collect();
        ReflectanceFactor { via_pixel, front }
    }

    /// Adds light that met the pixel once.
    fn add_look_up(&mut self, plan: &Plan<'_>, first: &FirstMeeting, light: f64) {
        match &first.shown {
            Shown::EachState => add_to_nodes(&mut self.look_ups, &first.look_up, light),
            Shown::Covered(covered) => {
                for (pair, coverage) in covered {
                    let sums = &mut self.look_ups[pair * plan.nodes..][..plan.nodes];
                    add_to_nodes(sums, &first.look_up, light * coverage);
                }
            }
        }
    }
}

impl Record for Sums<'_> {
    fn meets(&self, path: &mut Path) {
        let Some(tally) = &self.plan.tally else { return };
        let frequencies = &tally.frequencies_per_mm;
        let count = frequencies.len();
        let is_first = path.light.meetings() == 1;
        let Path { trace: Trace { phases: [re, im], cells }, place_mm, .. } = path;
        for phases in [&mut *re, &mut *im] {
            phases.resize(place_mm.len() * count, 0.0);
        }
        for (k, [x, y]) in place_mm.iter().enumerate() {
            let (re, im) = (&mut re[k * count..][..count], &mut im[k * count..][..count]);
            add_phases(frequencies, [*x, *y], if is_first { 0.0 } else { 1.0 }, re, im);
            cells.extend(tally.cells.map(|cells| cells.cell([-x, -y])));
        }
    }

    fn receives(&mut self, source: usize, path: &Path, weight: f64) {
        let received = &mut self.received[source];
        let plan = self.plan;
        let Some(tally) = &plan.tally else { return received.add(plan, path, weight) };
        received.add(plan, path, weight);
        let meetings = path.light.meetings();
        if meetings == 0 {
            return;
        }
        let sum = &mut received.kernels[usize::from(meetings > 1)];
        match path.light.recorded() {
            Recorded::Number(_) => {}
            Recorded::LookUp(scale, first) => {
                let look_up = &first.look_up;
                for (row, at_nodes) in plan.at_nodes[source].chunks_exact(plan.nodes).enumerate() {
                    let nodes = &at_nodes[look_up.first..][..Stencil::LEN];
                    let light = weight * scale * dot(&look_up.weights, nodes);
                    tally.add(sum, row, path, 0, light);
                }
            }
            Recorded::Spectra(scale, spectra) => {
                let bins = path.light.bins();
                let states = spectra.len() / bins;
                for place in 0..path.place_mm.len() {
                    let at = path.bins_at(place);
                    for (channel, weights) in tally.channels[source].iter().enumerate() {
                        for (state, light) in spectra.chunks_exact(bins).enumerate() {
                            let light = weight * scale * dot(&light[at.clone()], &weights[at.clone()]);
                            if light != 0.0 {
                                tally.add(sum, channel * states + state, path, place, light);
                            }
                        }
                    }
                }
            }
        }
    }
}

impl Received {
    fn add(&mut self, plan: &Plan<'_>, path: &Path, weight: f64) {
        match path.light.recorded() {
            Recorded::Number(number) => self.front_number += weight * number,
            Recorded::LookUp(scale, first) => self.add_look_up(plan, first, weight * scale),
            Recorded::Spectra(scale, spectra) => {
                let met = path.light.meetings() > 0;
                let sum = if met { &mut self.via_pixel } else { &mut self.front };
                add_scaled(sum, spectra, weight * scale);
            }
        }
    }
}

impl KernelTally {
    /// Adds light at the places at which a path met the pixel.
    fn add(&self, sum: &mut KernelSums, row: usize, path: &Path, place: usize, light: f64) {
        let count = self.frequencies_per_mm.len();
        for (sum, phases) in sum.transfer.iter_mut().zip(&path.trace.phases) {
            add_scaled(&mut sum[row * count..][..count], &phases[place * count..][..count], light);
        }
        if let Some(cells) = self.cells {
            let sums = &mut sum.cells[row * (cells.len() + 1)..][..=cells.len()];
            let met = path.trace.cells.iter().skip(place).step_by(path.place_mm.len());
            met.for_each(|cell| sums[*cell] += light);
        }
    }
}

impl KernelSums {
    fn plus(&self, other: &Self) -> Self {
        let plus = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a + b).collect();
        Self {
            transfer: [0, 1].map(|part| plus(&self.transfer[part], &other.transfer[part])),
            cells: plus(&self.cells, &other.cells),
        }
    }

    fn scaled(&self, scale: f64) -> Kernel {
        let [re, im] = &self.transfer;
        let transfer = re.iter().zip(im).map(|(re, im)| Complex64::new(scale * re, scale * im));
        Kernel { transfer: transfer.collect(), cells: self.cells.iter().map(|value| value * scale).collect() }
    }
}

/// `phases = kept * phases + exp(2 pi i f.x)`: the place r is minus that on the pixel, x.
fn add_phases(frequencies: &[[f64; 2]], [x, y]: [f64; 2], kept: f64, re: &mut [f64], im: &mut [f64]) {
    with_widest_simd(
        #[inline(always)]
        || {
            for ((re, im), [fx, fy]) in re.iter_mut().zip(im.iter_mut()).zip(frequencies) {
                let (cos, sin) = warp::polar(1.0, fx * x + fy * y);
                *re = kept * *re + cos;
                *im = kept * *im + sin;
            }
        },
    );
}

/// Adds a look-up to sums over nodes.
fn add_to_nodes(sums: &mut [f64], look_up: &Stencil, light: f64) {
    let sums = &mut sums[look_up.first..][..Stencil::LEN];
    sums.iter_mut().zip(look_up.weights).for_each(|(sum, weight)| *sum += light * weight);
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
