//! What general layers make of a picture: the kernels of [`Blur`] by Monte Carlo.
//!
//! **What.** Light that meets the pixels once has its place by the [walk](super::walk), in X, Y and Z of each
//! state; all other light is that of `blur.rs`.
//!
//! **Views.** Paths are traced in one view; kernels in others are those of this view, scaled to the colours
//! of pages.
//!
//! **Error.** The largest standard error of what is seen of some random pictures, from independent
//! replicates.

use papilio_optics::Beta;
use papilio_sampling::{SampleStream, Sampler};
use papilio_transport::Source;
use papilio_transport::spatial::{PixelSquare, Shapes};
use papilio_transport::walk::places::{CellGrid, Estimate, KernelTally};

use super::Blur;
use super::walk::{Placed, States};
use crate::DisplayError;
use crate::lamp_images;
use crate::run::Control;
use crate::scene::Stop;
use crate::setup::Setup;

/// Distance from the pixel that is seen, in thicknesses of all layers, beyond which light comes from the mean
/// of the picture.
const REACH: f64 = 4.0;

/// The same in pixels: at least, and at most.
const PIXELS: [i64; 2] = [2, 48];

/// Paths, unless the scene has a number of its own.
const PATHS: u64 = 1 << 17;

/// Light of a kernel, relative to a perfect white, that its shapes may miss.
const MISSED: f64 = 1e-6;

/// Random pictures whose errors are computed.
const PICTURES: u64 = 16;

impl Blur {
    /// Computes the kernels in the view of the scene in the middle, and the largest standard error of X, Y
    /// and Z of a pixel. `pages` has X, Y, Z of a page of each state for each scene. The images of round
    /// lamps in mirror-like pixels can be left out. `None` if nothing spreads light, or its places are not
    /// known.
    pub(crate) fn by_paths(
        setups: &[&Setup],
        pages: &[Vec<[f64; 3]>],
        without_lamps: bool,
        control: &Control<'_>,
    ) -> Result<Option<(Self, f64)>, DisplayError> {
        let middle = setups.len() / 2;
        let Some(setup) = setups.get(middle) else { return Ok(None) };
        let Some(matrix) = setup.scene.display.matrix.as_ref() else { return Ok(None) };
        // Flat faces over mirror-like pixels show each at its own place.
        if setup.stack.panel().is_some_and(|panel| panel.base.is_specular()) {
            return Ok(None);
        }
        let placed = match Placed::new(setup) {
            Ok(placed) => placed,
            Err(
                DisplayError::NoPlaces { .. }
                | DisplayError::NoRefraction
                | DisplayError::MissingLength { .. },
            ) => return Ok(None),
            Err(other) => return Err(other),
        };
        let (Some(view), pitch) = (setup.views.first(), matrix.pitch_mm) else { return Ok(None) };
        let reach = reach(&placed, view.field.axis_towards(), pitch);
        let side = 2 * reach + 1;
        let cells = CellGrid {
            count: [side as usize; 2],
            corner_mm: pitch.map(|pitch| -(reach as f64 + 0.5) * pitch),
            cell_mm: pitch,
        };
        let tally = KernelTally {
            cells: Some(cells),
            channels: placed.lights.iter().map(|light| light.weights.to_vec()).collect(),
            ..KernelTally::default()
        };
        let paths = if let Stop::Paths(paths) = setup.scene.solver.stop { paths } else { PATHS };
        let estimates = placed.trace_states(view, States::Kernel(tally), paths, control)?;
        let states = setup.states.len();
        let replicates: Vec<Vec<Vec<f64>>> =
            estimates.iter().map(|one| kernels(one, 3 * states, cells.len())).collect();
        let mut means = vec![vec![0.0; cells.len()]; 3 * states];
        for replicate in &replicates {
            for (mean, kernel) in means.iter_mut().zip(replicate) {
                mean.iter_mut().zip(kernel).for_each(|(mean, one)| *mean += one / replicates.len() as f64);
            }
        }
        for image in lamp_images::in_view(setup).iter().filter(|_| without_lamps) {
            for (kernel, mean) in means.iter_mut().enumerate() {
                mean[cells.len() / 2] -= image.pixel[kernel % states][kernel / states];
            }
        }
        let error = standard_error(&replicates, states);
        let Shapes { shapes, mixtures, missed } = Shapes::of(&means, MISSED);
        let mut all = Vec::with_capacity(setups.len() * mixtures.len());
        for there in pages {
            for (kernel, mixture) in mixtures.iter().enumerate() {
                let (quantity, state) = (kernel / states, kernel % states);
                let [here, there] = [&pages[middle], there].map(|pages| pages[state][quantity]);
                let scale = if here > 0.0 { there / here } else { 0.0 };
                all.push(mixture.iter().map(|weight| scale * weight).collect());
            }
        }
        let gains = gains(&placed, &estimates, cells.len()).repeat(setups.len());
        let first = |cell: i64| [cell % side - reach, cell / side - reach];
        let squares = (0..side * side).map(|cell| PixelSquare { first: first(cell), side: 1 });
        let shapes = Shapes { shapes, mixtures: all, missed };
        Ok(Some((
            Self { squares: squares.collect(), shapes, states, gains, wholes: (0..states).collect() },
            error,
        )))
    }
}

/// Number of pixels from the one that is seen to the border of a kernel.
fn reach(placed: &Placed<'_>, own: Beta, pitch_mm: [f64; 2]) -> i64 {
    let from = placed.displacement(own);
    let beams = placed.sources.iter().filter_map(Source::direction);
    let distance = |beta: Beta| {
        let [x, y] = placed.displacement(beta);
        (x - from[0]).hypot(y - from[1])
    };
    let farthest = beams.map(distance).fold(0.0, f64::max);
    let thickness = placed.stack.thickness_mm();
    let pixels = (REACH * thickness + farthest) / pitch_mm[0].min(pitch_mm[1]);
    (pixels.ceil() as i64).clamp(PIXELS[0], PIXELS[1])
}

/// Kernels of a replicate in all light, `[X, Y, Z and state][cell]`.
fn kernels(estimate: &Estimate, count: usize, cells: usize) -> Vec<Vec<f64>> {
    let mut sums = vec![vec![0.0; cells]; count];
    for spreads in &estimate.spreads {
        // The last cell has all light beyond the others.
        for (sum, kernel) in sums.iter_mut().zip(spreads.once.cells.chunks_exact(cells + 1)) {
            sum.iter_mut().zip(kernel).for_each(|(sum, light)| *sum += light);
        }
    }
    sums
}

/// Light via the pixel over that which meets it once, `[X, Y, Z][state]`.
fn gains(placed: &Placed<'_>, estimates: &[Estimate], cells: usize) -> Vec<f64> {
    let states = placed.setup.states.len();
    let (mut once, mut all) = (vec![0.0; 3 * states], vec![0.0; 3 * states]);
    for estimate in estimates {
        for spreads in &estimate.spreads {
            let kernels = spreads.once.cells.chunks_exact(cells + 1);
            once.iter_mut().zip(kernels).for_each(|(sum, kernel)| *sum += kernel.iter().sum::<f64>());
        }
        for (light, state) in
            (0..placed.lights.len()).flat_map(|light| (0..states).map(move |state| (light, state)))
        {
            let colour = placed.colour(estimate, light, state);
            (0..3).for_each(|k| all[k * states + state] += colour[k]);
        }
    }
    once.iter().zip(all).map(|(once, all)| if *once > 0.0 { all / once } else { 1.0 }).collect()
}

/// Largest standard error of X, Y and Z in the middle of some random pictures. Each kernel of a replicate is
/// relative to its light, because uniform pictures have the colours of pages.
fn standard_error(replicates: &[Vec<Vec<f64>>], states: usize) -> f64 {
    let mut largest = 0.0_f64;
    let numbers = SampleStream::new(Sampler::Random, 0, 0);
    for picture in 0..PICTURES {
        for quantity in 0..3 {
            let seen = |kernels: &Vec<Vec<f64>>| {
                let kernels = &kernels[quantity * states..][..states];
                let mut sum = 0.0;
                for (state, kernel) in kernels.iter().enumerate() {
                    let shown = |cell: usize| {
                        let number = numbers.block(picture, cell as u32)[0];
                        (number * states as f64) as usize == state
                    };
                    let light: f64 = kernel.iter().sum();
                    let own: f64 = kernel
                        .iter()
                        .enumerate()
                        .filter(|(cell, _)| shown(*cell))
                        .map(|(_, light)| light)
                        .sum();
                    sum += own - light / states as f64;
                }
                sum
            };
            let values: Vec<f64> = replicates.iter().map(seen).collect();
            let mean = super::walk::mean(values.into_iter());
            largest = largest.max(mean.standard_error);
        }
    }
    largest
}
