//! Spread of light in general layers: what a view sees of the pixel plane at chosen spatial frequencies.
//!
//! # Method
//! The value of light at the pixel for a view is followed backwards, from the view down. A pattern of
//! frequency f multiplies light by `exp(-2 pi i f.D(beta))` in each medium. Scatterers are diagonal in
//! azimuthal orders, phases in the azimuth: neither is formed as a matrix between all directions. A problem
//! of N nodes and M orders takes N^2 M for each scattering, for all frequencies at once, instead of (N M)^3.
//!
//! With the light E that falls on the pixel (uniform), its reflectance rho and the return A of the layers,
//!
//! `L(f) = V(f) (1 - rho A(f))^-1 rho E`
//!
//! is the response of all orders to a small change of the reflectance, relative to it. A Lambertian pixel
//! sends the same light in all directions: A(f) is a number, and E needs no directions; light that spreads
//! inside it has the factor P on rho A, and (1 + P)/2 on all. A mirror-like pixel below layers that return
//! nothing to it has A = 0; E is the value of its light for the sources, without phases. Light that layers
//! return to it is followed from meeting to meeting ([`returned`]). Without scatterers its light keeps its
//! direction, and A is a number there.
//!
//! - [`chain`]: flat elements between scatterers; [`kernels`]: scatterers by order; [`orders`]: light by
//!   order; [`rings`]: directions that resolve phases; [`crossing`]: light that crosses flat elements;
//!   [`waves`]: values of light between scatterers; [`pixels`]: the light of each kind of pixel.
//!
//! # Limits
//! Interfaces that scatter, and clear or absorbing media. Media that scatter, faces by waves and pixels with
//! kernels of their own are left to Monte Carlo.

mod chain;
mod crossing;
mod kernels;
mod orders;
mod pixels;
mod returned;
mod rings;
mod waves;

use std::f64::consts::{PI, TAU};
use std::rc::Rc;
use std::sync::atomic::AtomicBool;

use num_complex::Complex64;

use super::directions::{Directions, Ray};
use super::grid::{Grid, Interpolation};
use super::precision::{Precision, density_between};
use super::prepare::optics;
use super::splits::smooth_splits;
use crate::light::images::{ImagePoints, Mirror, image_points};
use crate::{Cone, PixelSpread, Reflector, Source, Stack};
use crossing::Needed;
use kernels::{Kernels, Light};
pub use pixels::PaperLight;
use returned::Returned;
use rings::Resolution;
use waves::{Beam, Between, Leaving, Start, Wave};

/// Most sets of wavelengths with different layers that are computed one by one.
const MOST_SETS: usize = 3;

/// Wavelengths that represent all others at the coarser and the finer levels.
const REPRESENTATIVES: [usize; 2] = [3, 5];

/// Largest phases at level 0, radians, and the factor of a level.
const PHASE: f64 = 80.0;
const MORE_PHASE: f64 = 1.7;

/// Most directions of views and sources.
const MOST_BEAMS: usize = 256;

/// Light that returns to a mirror-like pixel and is neglected.
const RETURNED: f64 = 1e-6;

/// Reason why the spread of light in layers is not computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NotCovered {
    /// A medium scatters.
    Slab,
    /// A face scatters each wavelength by lobes of its own, too many for all frequencies of a pattern.
    Waves,
    /// The pixel scatters by kernels.
    Pixel,
    /// There are too many directions and orders.
    TooMany,
    /// Light is scattered to and fro too often.
    Rounds,
    /// Light meets the pixel too often.
    Meetings,
    /// The computation was stopped.
    Stopped,
}

impl std::fmt::Display for NotCovered {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if *self == Self::Rounds {
            return write!(
                f,
                "layers between which light is scattered to and fro more than {} times",
                waves::MOST_ROUNDS
            );
        }
        f.write_str(match self {
            Self::Rounds => "",
            Self::Stopped => "a computation that was stopped",
            Self::Meetings => {
                "mirror-like pixels that light meets more than a hundred times below general layers"
            }
            Self::Slab => "layers that scatter in their volume",
            Self::Waves => "faces by waves, whose lobes depend on the wavelength",
            Self::Pixel => "pixels that scatter by a measured kernel",
            Self::TooMany => {
                "scatterers this narrow, or lights of so many directions, between general layers"
            }
        })
    }
}

impl std::error::Error for NotCovered {}

/// What a view sees of a source's light via the pixel, without regard to places.
#[derive(Debug, Clone, Copy)]
pub struct Seen<'a> {
    /// Number of the source.
    pub source: usize,
    /// Weight of each wavelength.
    pub weights: &'a [f64],
    /// Reflectance factor, `[state][wavelength]`.
    pub via_pixel: &'a [f64],
}

/// Spread of light in general layers, for one view.
#[derive(Debug)]
pub struct LayeredSpread<'a> {
    stack: &'a Stack,
    stop: &'a AtomicBool,
    precision: Precision,
    level: u32,
    view: Vec<Beam>,
    /// `|beta|`, azimuth and weight of the directions of the view.
    directions: Vec<[f64; 3]>,
    /// By source.
    sources: Vec<Room>,
    images: Vec<ImagePoints>,
    sets: Vec<Set>,
    /// The sets that represent each wavelength, and their factors.
    of_bins: Vec<Vec<(usize, f64)>>,
    /// Spread of light inside a Lambertian pixel.
    inside: Option<PixelSpread>,
}

/// Light of a source in the air.
#[derive(Debug)]
enum Room {
    Everywhere,
    Beams(Vec<Beam>),
}

impl Room {
    fn start(&self) -> Start<'_> {
        match self {
            Self::Everywhere => Start::Air,
            Self::Beams(beams) => Start::Beams(beams),
        }
    }

    fn beams(&self) -> &[Beam] {
        match self {
            Self::Everywhere => &[],
            Self::Beams(beams) => beams,
        }
    }

    /// Reflectance factor of a perfect white over the value of its light.
    fn unit(&self) -> f64 {
        match self {
            Self::Everywhere => 1.0,
            Self::Beams(_) => PI,
        }
    }
}

/// Wavelengths at which the layers are the same, or their representative.
#[derive(Debug)]
struct Set {
    bin: usize,
    index: f64,
    grid: Grid,
    interpolation: Interpolation,
    kernels: Kernels,
    tolerance: f64,
    /// Values of light that arrives at the scatterers for each source, without phases.
    lit: Vec<Light>,
    /// Light that the layers return to a mirror-like pixel.
    returned: Option<Returned>,
}

impl<'a> LayeredSpread<'a> {
    /// Prepares a level. Nothing is computed any more once `stop` is set.
    ///
    /// # Errors
    /// If its layers, its pixel or its number of directions are not covered, or `stop` was set.
    pub fn new(
        stack: &'a Stack,
        view: Cone,
        sources: &[Source],
        level: u32,
        stop: &'a AtomicBool,
    ) -> Result<Self, NotCovered> {
        if let Reflector::Scattering(_) = stack.base().reflector {
            return Err(NotCovered::Pixel);
        }
        let precision = Precision::new(f64::from(level));
        // Only the directions of light on a mirror-like pixel matter.
        let sources = if stack.base().is_specular() { sources } else { &[] };
        let directions = Directions::new(stack, &[view], sources, &precision);
        if directions.beta.len() > MOST_BEAMS {
            return Err(NotCovered::TooMany);
        }
        let beams = |rays: &[Ray]| rays.iter().map(Beam::from).collect::<Vec<_>>();
        let rooms = sources.iter().zip(&directions.sources).map(|(source, rays)| match source {
            Source::Diffuse => Room::Everywhere,
            Source::Beam(_) | Source::Disc(_) | Source::Field(_) => Room::Beams(beams(rays)),
        });
        let of_view = |ray: &Ray| [directions.beta[ray.extra], ray.turn, ray.weight];
        let images = image_points(&view, sources, precision.digits, Mirror::Across(0.0));
        let mut spread = Self {
            stack,
            stop,
            precision,
            level,
            view: beams(&directions.views[0]),
            directions: directions.views[0].iter().map(of_view).collect(),
            sources: rooms.collect(),
            images,
            sets: Vec::new(),
            of_bins: Vec::new(),
            inside: None,
        };
        let (bins, of_bins) = representatives(stack, REPRESENTATIVES[usize::from(level > 1)]);
        spread.of_bins = of_bins;
        for bin in bins {
            let set = spread.set(bin, &directions.beta)?;
            spread.sets.push(set);
        }
        Ok(spread)
    }

    /// The same over a Lambertian pixel inside which light spreads.
    #[must_use]
    pub fn with_spread(self, inside: Option<PixelSpread>) -> Self {
        Self { inside, ..self }
    }

    fn set(&self, bin: usize, extras: &[f64]) -> Result<Set, NotCovered> {
        let density = density_between(self.stack, bin, &self.precision);
        let grid = Grid::new(&smooth_splits(self.stack, bin), density, extras);
        if grid.len() > crate::adding::MOST_NODES_OF_FURTHER {
            return Err(NotCovered::TooMany);
        }
        let kernels = Kernels::new(self.stack, bin, &grid, &self.precision, self.stop)?;
        let index = self.stack.layers.last().map_or(1.0, |layer| layer.medium.index()[bin]);
        let interpolation = grid.interpolation();
        let tolerance = 0.02 * (-self.precision.digits).exp();
        let mut set =
            Set { bin, index, grid, interpolation, kernels, tolerance, lit: Vec::new(), returned: None };
        if self.stack.base().is_specular() && !set.kernels.elements.is_empty() {
            let wave = self.wave(&set, [0.0; 2]);
            let between = self.between(&set);
            let light = between.solve(&wave, &[Start::Pixel])?;
            let leaving = between.leaving((&wave, Start::Pixel), &light[0], Needed::Mean);
            let returns = set.mean(&wave, &leaving).re / (PI * index * index) > RETURNED;
            let starts: Vec<_> = self.sources.iter().map(Room::start).collect();
            set.lit = between.solve(&wave, &starts)?;
            set.returned = returns.then(|| self.returned(&set, &wave)).transpose()?;
        }
        Ok(set)
    }

    fn wave(&self, set: &Set, [x, y]: [f64; 2]) -> Wave {
        let resolution = Resolution {
            stack: self.stack,
            bin: set.bin,
            grid: &set.grid,
            interpolation: &set.interpolation,
            most: PHASE * MORE_PHASE.powi(self.level as i32),
        };
        let per_mm = TAU * x.hypot(y);
        Wave { per_mm, turn: y.atan2(x), rings: Rc::new(resolution.rings(per_mm)) }
    }

    fn between<'s>(&'s self, set: &'s Set) -> Between<'s> {
        let elements = 2 * self.stack.layers.len();
        Between::new(&set.kernels, (elements, set.grid.regular), set.tolerance, self.stop)
    }

    /// Returns the light that the view sees via the pixel at spatial frequencies, cycles per mm: the response
    /// of all orders to a small change of the pixel's reflectance, relative to it, in the unit of
    /// `via_pixel`; `[source][state][frequency]`.
    ///
    /// # Errors
    /// If scatterers return too much light to each other, or `stop` was set.
    pub fn light(
        &self,
        seen: &[Seen<'_>],
        frequencies_per_mm: &[[f64; 2]],
    ) -> Result<Vec<Vec<Vec<Complex64>>>, NotCovered> {
        let (states, bins) = (self.stack.base().states(), self.stack.base().bins());
        let mut light = vec![vec![vec![Complex64::ZERO; frequencies_per_mm.len()]; states]; seen.len()];
        // Light without regard to places is the first one.
        let mut all = vec![[0.0; 2]];
        let mut number = |f: &[f64; 2]| {
            all[1..].iter().position(|known| known == f).unwrap_or_else(|| {
                all.push(*f);
                all.len() - 2
            })
        };
        let numbers: Vec<usize> = frequencies_per_mm.iter().map(&mut number).collect();
        for (number, set) in self.sets.iter().enumerate() {
            let mut members = vec![0.0; bins];
            for (bin, sets) in self.of_bins.iter().enumerate() {
                members[bin] = sets.iter().filter(|(set, _)| *set == number).map(|(_, factor)| factor).sum();
            }
            let mut waves: Vec<Wave> = Vec::with_capacity(all.len());
            for [x, y] in &all {
                // Rings serve all azimuths.
                let known = waves.iter().find(|wave| wave.per_mm == TAU * x.hypot(*y));
                let known =
                    known.map(|wave| Wave { turn: y.atan2(*x), rings: Rc::clone(&wave.rings), ..*wave });
                waves.push(known.unwrap_or_else(|| self.wave(set, [*x, *y])));
            }
            let relative = match &self.stack.base().reflector {
                Reflector::Specular(_) if set.kernels.elements.is_empty() => {
                    self.ghosts(set, &waves, &members)
                }
                Reflector::Specular(_) => self.mirrored(set, &waves, seen, &members)?,
                Reflector::Lambertian(reflectance) => self.lambertian(set, &waves, reflectance, &members)?,
                Reflector::Scattering(_) => Vec::new(),
            };
            for (light, seen) in light.iter_mut().zip(seen) {
                let of_source = relative.get(seen.source).or(relative.first());
                for (state, light) in light.iter_mut().enumerate() {
                    for (bin, member) in members.iter().enumerate().filter(|(_, member)| **member != 0.0) {
                        let at = state * bins + bin;
                        let weight = member * seen.weights[bin] * seen.via_pixel[at];
                        let Some(values) = of_source.map(|values| &values[at]) else { continue };
                        light.iter_mut().zip(&numbers).for_each(|(sum, k)| *sum += weight * values[*k]);
                    }
                }
            }
        }
        Ok(light)
    }
}

impl Set {
    /// Sum over the directions of light that leaves the pixel, within the disc of its medium.
    fn mean(&self, wave: &Wave, leaving: &Leaving) -> Complex64 {
        let rings = wave.rings.iter().enumerate().filter(|(_, ring)| ring.beta < self.index);
        rings.map(|(number, ring)| ring.weight * leaving.rings.mean(number)).sum()
    }
}

impl From<&Ray> for Beam {
    fn from(ray: &Ray) -> Self {
        Self { extra: ray.extra, turn: ray.turn, weight: ray.weight, is_ring: ray.is_ring }
    }
}

/// Returns wavelengths that represent all, and those that represent each, with factors.
fn representatives(stack: &Stack, most: usize) -> (Vec<usize>, Vec<Vec<(usize, f64)>>) {
    let bins = stack.base().bins();
    let mut sets: Vec<(Vec<u64>, usize)> = Vec::new();
    let mut of_bins = Vec::with_capacity(bins);
    for bin in 0..bins {
        let key = (optics(stack, bin), super::prepare::indices(stack, bin));
        let key: Vec<u64> = key.0.into_iter().chain(key.1.into_iter().map(f64::to_bits)).collect();
        let number = sets.iter().position(|(known, _)| *known == key).unwrap_or_else(|| {
            sets.push((key, bin));
            sets.len() - 1
        });
        of_bins.push(vec![(number, 1.0)]);
    }
    if sets.len() <= MOST_SETS.min(most) {
        return (sets.into_iter().map(|(_, bin)| bin).collect(), of_bins);
    }
    // Chebyshev's points of the second kind.
    let place = |k: usize| 0.5 * (bins - 1) as f64 * (1.0 - (PI * k as f64 / (most - 1) as f64).cos());
    let mut some: Vec<usize> = (0..most).map(|k| place(k).round() as usize).collect();
    some.dedup();
    let factors = |bin: usize| {
        let factor = |k: usize| {
            let others = some.iter().enumerate().filter(|(j, _)| *j != k).map(|(_, other)| *other as f64);
            others.map(|other| (bin as f64 - other) / (some[k] as f64 - other)).product()
        };
        (0..some.len()).map(|k| (k, factor(k))).collect()
    };
    let of_bins = (0..bins).map(factors).collect();
    (some, of_bins)
}
