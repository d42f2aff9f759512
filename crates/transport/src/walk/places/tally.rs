//! What a walk with places records.
//!
//! Light that has met the pixel once is added to the nodes of the pixel's angular table; spectra are formed
//! from the sums at the end, once for all paths.

use std::ops::Range;

use num_complex::Complex64;
use papilio_spectra::StateSpectra;

use super::bins::{Bins, CellGrid};
use super::light::{FirstMeeting, Recorded, Shown};
use super::path::{Path, Trace};
use super::waves::{WaveSums, Waves};
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
/// The place r of a meeting is where it is seen, relative to the place on which the view's own ray meets the
/// pixel: the pixel at `-r` of that place.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct KernelTally {
    /// Frequencies at which `exp(-2 pi i f.r)` is tallied, cycles per mm.
    pub frequencies_per_mm: Vec<[f64; 2]>,
    /// Cells in which light is tallied; `None`: no cells.
    pub cells: Option<CellGrid>,
    /// Ascending borders along x and along y between which light is tallied, mm; the first and last strip
    /// have no outer border.
    pub strips_mm: [Vec<f64>; 2],
    /// Ascending radii between which light is tallied, mm; the last ring has no outer border.
    pub rings_mm: Vec<f64>,
    /// Sums over wavelengths that are tallied, as weights: `[channel][wavelength]` for each source.
    pub channels: Vec<Vec<Vec<f64>>>,
}

/// Spread of light by the number of its meetings with the pixel.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Spreads {
    /// Light that meets the pixel once: the kernel of the first order.
    pub once: Kernel,
    /// Response of all orders to a small change of the pixel's reflectance at a place, relative to its
    /// reflectance.
    pub response: Kernel,
}

/// Tallied spread of one source's light.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Kernel {
    /// Mean of `w exp(-2 pi i f.r)`; shape `[channel][state][frequency]`.
    pub transfer: Vec<Complex64>,
    /// Mean of w in each cell, and at last that beyond all cells; shape `[channel][state][cell]`. Empty
    /// without cells.
    pub cells: Vec<f64>,
    /// Mean of w in each strip along x and along y; `[channel][state][strip]`.
    pub strips: [Vec<f64>; 2],
    /// Mean of w in each ring; `[channel][state][ring]`.
    pub rings: Vec<f64>,
}

/// What is recorded: the pixel, and the sums over wavelengths of a kernel.
pub(super) struct Plan<'a> {
    base: &'a Base,
    images: usize,
    /// Number of nodes of the angular table, with room for a look-up that begins at the last one.
    nodes: usize,
    tally: Option<KernelTally>,
    waves: Waves,
    bins: Bins,
    /// The channels of the reflectance at the nodes; `[source][channel][state][node]`.
    at_nodes: Vec<Vec<f64>>,
}

impl<'a> Plan<'a> {
    /// `extent_mm` is the distance from the view's own ray within which most light meets the pixel.
    pub(super) fn new(base: &'a Base, images: usize, tally: Option<KernelTally>, extent_mm: f64) -> Self {
        let nodes = match &base.reflector {
            Reflector::Specular(table) => table.nodes.count(),
            Reflector::Lambertian(_) | Reflector::Scattering(_) => 1,
        };
        let (mut waves, mut bins) = (Waves::default(), Bins::default());
        if let Some(tally) = &tally {
            waves = Waves::new(&tally.frequencies_per_mm, extent_mm);
            bins = Bins::new(tally);
        }
        let nodes_and_room = nodes + Stencil::LEN;
        let mut plan = Self { base, images, nodes: nodes_and_room, tally, waves, bins, at_nodes: Vec::new() };
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
    via_pixel: StateSpectra,
    /// Light that met the pixel once: `[node]` if each image shows its state, else `[image][state][node]`.
    look_ups: Vec<f64>,
    each_state: bool,
    /// Sums of the kernels of one meeting, and of several.
    kernels: [KernelSums; 2],
}

/// Sums of a kernel, by row: `[channel][state]`.
#[derive(Debug, Clone, Default)]
struct KernelSums {
    waves: Vec<WaveSums>,
    /// `[row][bin]`.
    bins: Vec<f64>,
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
            let waves = vec![plan.waves.sums(); rows];
            KernelSums { waves, bins: vec![0.0; rows * plan.bins.count] }
        };
        let received = |source: usize| Received {
            front: vec![0.0; bins],
            front_number: 0.0,
            via_pixel: StateSpectra::zeros(images, bins),
            look_ups: vec![0.0; pairs * plan.nodes],
            each_state,
            kernels: [kernels(source), kernels(source)],
        };
        Self { plan, received: (0..sources).map(received).collect() }
    }

    pub(super) fn means(&self, scale: f64) -> super::Estimate {
        let spreads = |received: &Received| {
            let [once, later] = received.kernels.each_ref().map(|sums| sums.means(self.plan, scale));
            let response = once.plus(&later);
            Spreads { once, response }
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
                add_scaled(via_pixel.state_mut(image), &spectra[state * bins..][..bins], 1.0);
            }
        }
        via_pixel.iter_mut().for_each(|value| *value *= scale);
        let front = self.front.iter().map(|value| scale * (value + self.front_number)).collect();
        ReflectanceFactor { via_pixel, front }
    }

    /// Adds light that met the pixel once.
    #[inline(always)]
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

impl Sums<'_> {
    /// Adds light of several sources that meets the pixel once, at this place.
    #[inline(always)]
    pub(super) fn add_meeting(
        &mut self,
        place_mm: [f64; 2],
        first: &FirstMeeting,
        trace: &mut Trace,
        lights: impl Iterator<Item = (usize, f64)>,
    ) {
        let plan = self.plan;
        if plan.tally.is_some() {
            trace.clear();
            plan.locate(place_mm, trace);
        }
        for (source, light) in lights {
            let received = &mut self.received[source];
            received.add_look_up(plan, first, light);
            if plan.tally.is_some() {
                plan.add_look_up(source, &mut received.kernels[0], &first.look_up, trace, light);
            }
        }
    }
}

impl Record for Sums<'_> {
    fn meets(&self, path: &mut Path) {
        if self.plan.tally.is_some() {
            let [x, y] = path.own_mm;
            for place in &path.place_mm {
                self.plan.locate([place[0] - x, place[1] - y], &mut path.trace);
            }
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
                plan.add_look_up(source, sum, &first.look_up, &path.trace, weight * scale);
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
                                let places = [place, path.place_mm.len()];
                                plan.add(sum, channel * states + state, &path.trace, places, light);
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
                let sum = if met { &mut *self.via_pixel } else { &mut self.front };
                add_scaled(sum, spectra, weight * scale);
            }
        }
    }
}

impl Plan<'_> {
    /// Adds the spots and bins of a meeting.
    fn locate(&self, [x, y]: [f64; 2], trace: &mut Trace) {
        // The place r is minus that on the pixel.
        self.waves.locate([-x, -y], &mut trace.spots);
        self.bins.locate([-x, -y], &mut trace.bins);
    }

    /// Adds light to a row at the places, or at one of several, at which it met the pixel.
    #[inline(always)]
    fn add(&self, sum: &mut KernelSums, row: usize, trace: &Trace, [place, places]: [usize; 2], light: f64) {
        let meetings = |len: usize| (place * len, places * len);
        let (first, step) = meetings(self.waves.lines());
        let mut spots = trace.spots.get(first..).unwrap_or_default();
        while !spots.is_empty() {
            self.waves.add(&mut sum.waves[row], &spots[..self.waves.lines()], light);
            spots = spots.get(step..).unwrap_or_default();
        }
        let sums = &mut sum.bins[row * self.bins.count..][..self.bins.count];
        let (first, step) = meetings(self.bins.parts);
        let mut bins = trace.bins.get(first..).unwrap_or_default();
        while !bins.is_empty() {
            bins[..self.bins.parts].iter().for_each(|bin| sums[*bin] += light);
            bins = bins.get(step..).unwrap_or_default();
        }
    }

    /// Adds light that met the pixel once to all rows.
    #[inline(always)]
    fn add_look_up(&self, source: usize, sum: &mut KernelSums, look_up: &Stencil, trace: &Trace, light: f64) {
        for (row, at_nodes) in self.at_nodes[source].chunks_exact(self.nodes).enumerate() {
            self.add(sum, row, trace, [0, 1], light * looked_up(look_up, at_nodes));
        }
    }
}

impl KernelSums {
    fn means(&self, plan: &Plan<'_>, scale: f64) -> Kernel {
        let [re, im] = plan.waves.transform(&self.waves);
        let transfer = re.iter().zip(im).map(|(re, im)| Complex64::new(scale * re, scale * im));
        let part = |at: &Range<usize>| {
            let rows = self.bins.chunks_exact(plan.bins.count.max(1));
            rows.flat_map(|row| row[at.clone()].iter().map(|value| scale * value)).collect()
        };
        let Bins { cells, strips, rings, .. } = &plan.bins;
        Kernel {
            transfer: transfer.collect(),
            cells: part(cells),
            strips: strips.each_ref().map(part),
            rings: part(rings),
        }
    }
}

impl Kernel {
    fn plus(&self, other: &Self) -> Self {
        let plus = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a + b).collect();
        Self {
            transfer: self.transfer.iter().zip(&other.transfer).map(|(a, b)| a + b).collect(),
            cells: plus(&self.cells, &other.cells),
            strips: [0, 1].map(|axis| plus(&self.strips[axis], &other.strips[axis])),
            rings: plus(&self.rings, &other.rings),
        }
    }

    fn times(&self, factor: f64) -> Self {
        let times = |values: &Vec<f64>| values.iter().map(|value| factor * value).collect();
        Self {
            transfer: self.transfer.iter().map(|value| factor * value).collect(),
            cells: times(&self.cells),
            strips: self.strips.each_ref().map(times),
            rings: times(&self.rings),
        }
    }
}

impl Spreads {
    fn plus(&self, other: &Self) -> Self {
        Self { once: self.once.plus(&other.once), response: self.response.plus(&other.response) }
    }

    fn times(&self, factor: f64) -> Self {
        Self { once: self.once.times(factor), response: self.response.times(factor) }
    }
}

impl super::Estimate {
    /// Returns the sum with another one.
    pub(super) fn plus(mut self, other: &Self) -> Self {
        self.rho.iter_mut().zip(&other.rho).for_each(|(sum, more)| sum.add(more, 1.0));
        self.spreads.iter_mut().zip(&other.spreads).for_each(|(sum, more)| *sum = sum.plus(more));
        self
    }

    /// Returns the same, times a factor for each source.
    pub(super) fn times(mut self, factors: &[f64]) -> Self {
        for (rho, factor) in self.rho.iter_mut().zip(factors) {
            rho.via_pixel.iter_mut().chain(&mut rho.front).for_each(|value| *value *= factor);
        }
        self.spreads.iter_mut().zip(factors).for_each(|(one, factor)| *one = one.times(*factor));
        self
    }
}

/// Adds a look-up to sums over nodes.
#[inline(always)]
fn add_to_nodes(sums: &mut [f64], look_up: &Stencil, light: f64) {
    let sums = &mut sums[look_up.first..][..Stencil::LEN];
    sums.iter_mut().zip(look_up.weights).for_each(|(sum, weight)| *sum += light * weight);
}

/// Value of a look-up among values at nodes; half of the terms at a time.
#[inline(always)]
fn looked_up(look_up: &Stencil, at_nodes: &[f64]) -> f64 {
    const HALF: usize = Stencil::LEN / 2;
    let nodes = &at_nodes[look_up.first..][..Stencil::LEN];
    let mut sums = [0.0; HALF];
    for (k, sum) in sums.iter_mut().enumerate() {
        *sum = look_up.weights[k] * nodes[k] + look_up.weights[k + HALF] * nodes[k + HALF];
    }
    (sums[0] + sums[4]) + (sums[1] + sums[5]) + ((sums[2] + sums[6]) + (sums[3] + sums[7]))
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
