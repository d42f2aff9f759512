//! Directions near the horizon, where a lobe has no bound.
//!
//! Ward's lobe in Duer's normalisation scatters `K/c` of the light that arrives at a cosine c to the normal.
//! A path that comes there in a direction sampled with a density without such a peak has a weight of this
//! size, and its variance, an integral of `c dc (K/c)²`, is infinite. In a stack with such a lobe every
//! scatterer therefore sends a part q of its directions uniformly in solid angle: over direction cosines the
//! density of all is at least `q/(2 pi c)`, the weight of a direction at most `2 pi c/q` times the value v of
//! the scatterer, and that behind the lobe at most `2 pi K v/q`. It is bounded by construction.
//!
//! # What is finite
//! - Light of the view and of beams: the cosine is fixed. A field of view ends before the horizon.
//! - Light that the lobe itself sends towards the horizon: its value and its density over direction cosines
//!   both contain `1/c`; their ratio is bounded.
//! - Connections to beams: `1/c` of the light that arrives, as above. To discs and fields that reach the
//!   horizon: the balance heuristic bounds the weight by value over density of the lobe.
//! - Light that an interface relays from a source: the same, by the balance of relay and path.
//! - Light that a pixel, another lobe, a rough face or a medium sends to the lobe: by this module.
//!
//! # What is not
//! Light that such lobes send and meet again without being scattered in between (over a mirror, below a front
//! that reflects, between two such lobes): its *mean* is an integral of `c dc (K/c)²`, and diverges like the
//! logarithm of the smallest cosine. No sampling can help.
//!
//! The reference tracer ([`Plain`](super::Plain)) samples nothing but its kernels, so that the variance of such
//! light is infinite there.

use std::f64::consts::TAU;
use std::ops::Deref;

use papilio_optics::Beta;
use papilio_sampling::warp;

use super::{base_density, base_direction};
use crate::layers::{Arrival, Departure, Scattered, ScatteringInterface, Sides};
use crate::skeleton::Propagation::{Down, Up};
use crate::{Medium, Stack};

/// Part of the directions of a pixel.
const OF_PIXEL: f64 = 0.5;

/// Part of the directions of all other scatterers, many of which are narrow.
const OF_OTHERS: f64 = 0.1;

/// Smallest cosine: light nearer to the horizon is treated as having this one, as lobes do.
const LEAST_COSINE: f64 = 1e-9;

/// Largest number of different discs: the air, and media in which a lobe of this kind reflects.
const MOST: usize = 4;

/// The discs of direction cosines towards whose rims lobes have no bound; at least one.
#[derive(Debug, Clone, Copy)]
pub(super) struct Horizons {
    radii: [f64; MOST],
    count: usize,
}

impl Horizons {
    /// Returns the discs of a stack; `None` if all its lobes are bounded.
    pub(super) fn of(stack: &Stack) -> Option<Self> {
        let all = stack.elements().flat_map(|(kind, media)| {
            let index = |side: usize| media[side].map_or(1.0, Medium::largest_index);
            kind.horizons([index(0), index(1)])
        });
        Self::new(all)
    }

    fn new(all: impl Iterator<Item = f64>) -> Option<Self> {
        let mut horizons = Self { radii: [0.0; MOST], count: 0 };
        for radius in all {
            let is_new = !horizons.radii().contains(&radius);
            if is_new && horizons.count < MOST {
                horizons.radii[horizons.count] = radius;
                horizons.count += 1;
            }
        }
        (horizons.count > 0).then_some(horizons)
    }

    fn radii(&self) -> &[f64] {
        &self.radii[..self.count]
    }

    /// Samples a direction, uniform in solid angle in one of the discs.
    fn draw(&self, [u, v]: [f64; 2]) -> Beta {
        let place = u * self.count as f64;
        let disc = (place as usize).min(self.count - 1);
        let cosine = place - disc as f64;
        let (x, y) = warp::polar(self.radii[disc] * ((1.0 - cosine) * (1.0 + cosine)).max(0.0).sqrt(), v);
        Beta { x, y }
    }

    /// Returns the density of [`Self::draw`] over direction cosines.
    fn density(&self, to: Beta) -> f64 {
        let of_disc = |radius: &f64| {
            let squared = radius * radius;
            let cosine = (1.0 - to.squared() / squared).max(LEAST_COSINE * LEAST_COSINE).sqrt();
            if to.squared() <= squared { 1.0 / (TAU * squared * cosine) } else { 0.0 }
        };
        self.radii().iter().map(of_disc).sum::<f64>() / self.count as f64
    }

    /// Samples a direction for a part of the numbers; otherwise the first one becomes uniform again.
    fn choose<const N: usize>(&self, part: f64, u: &mut [f64; N]) -> Option<Beta> {
        if u[0] < part {
            return Some(self.draw([u[0] / part, u[1]]));
        }
        u[0] = (u[0] - part) / (1.0 - part);
        None
    }

    fn mixed(&self, part: f64, own: f64, of_horizon: f64) -> f64 {
        (1.0 - part) * own + part * of_horizon
    }

    /// Samples the direction of a pixel whose own sampling gives no direction for these numbers (`None`).
    pub(super) fn of_pixel(&self, u: &mut [f64; 3]) -> Option<Beta> {
        self.choose(OF_PIXEL, u)
    }

    /// Returns the density of the directions of a pixel, given that of its own sampling.
    pub(super) fn pixel_density(&self, own: f64, to: Beta) -> f64 {
        self.mixed(OF_PIXEL, own, self.density(to))
    }

    /// Returns the discs that a medium of this index has; `None` if there are none.
    pub(super) fn within(&self, index: f64) -> Option<Self> {
        Self::new(self.radii().iter().copied().filter(|radius| *radius <= index))
    }

    /// Samples the direction cosines and the sense (up, if true) of light that a medium deflects; `None`: by
    /// its phase function, for which `angle` is uniform again.
    pub(super) fn of_medium(&self, angle: &mut f64, turn: f64) -> Option<(Beta, bool)> {
        let mut u = [*angle, turn];
        let place = 2.0 * *angle / OF_OTHERS;
        let chosen = self.choose(OF_OTHERS, &mut u).map(|_| self.draw([place.fract(), turn]));
        *angle = u[0];
        chosen.map(|beta| (beta, place < 1.0))
    }

    /// Returns the density per steradian of directions in a medium of this index, given that of the phase
    /// function.
    pub(super) fn medium_density(&self, own: f64, index: f64, [x, y, z]: [f64; 3]) -> f64 {
        let of_horizon = 0.5 * index * index * z.abs() * self.density(Beta { x: index * x, y: index * y });
        self.mixed(OF_OTHERS, own, of_horizon)
    }
}

/// Samples a direction into which a Lambertian base in a medium of this index sends light.
pub(super) fn emitted(horizons: Option<&Horizons>, index: f64, u: [f64; 2]) -> Beta {
    let mut u = u;
    let towards = horizons.and_then(|horizons| horizons.choose(OF_PIXEL, &mut u));
    towards.unwrap_or_else(|| base_direction(index, u))
}

/// Returns the density of [`emitted`] over direction cosines.
pub(super) fn emitted_density(horizons: Option<&Horizons>, index: f64, to: Beta) -> f64 {
    let own = base_density(index, to);
    horizons.map_or(own, |horizons| horizons.pixel_density(own, to))
}

/// An interface that scatters, with the directions towards the horizons among its own.
#[derive(Debug, Clone, Copy)]
pub(super) struct SampledInterface<'a> {
    interface: &'a dyn ScatteringInterface,
    horizons: Option<Horizons>,
}

impl<'a> Deref for SampledInterface<'a> {
    type Target = dyn ScatteringInterface + 'a;

    fn deref(&self) -> &Self::Target {
        self.interface
    }
}

impl<'a> SampledInterface<'a> {
    pub(super) fn new(interface: &'a dyn ScatteringInterface, horizons: Option<Horizons>) -> Self {
        Self { interface, horizons }
    }

    /// As [`ScatteringInterface::scatter`].
    pub(super) fn scatter(&self, from: Arrival, to: Departure) -> Scattered {
        let mut scattered = self.interface.scatter(from, to);
        if let Some(horizons) = &self.horizons {
            let sides = from.channel.leaves(from.going).len() as f64;
            let mixed = |own, beta| horizons.mixed(OF_OTHERS, own, horizons.density(beta) / sides);
            scattered.density = mixed(scattered.density, to.beta);
            scattered.reverse = mixed(scattered.reverse, from.beta);
        }
        scattered
    }

    /// As [`ScatteringInterface::sample`].
    pub(super) fn sample(&self, from: Arrival, mut u: [f64; 4]) -> Option<(Departure, Scattered)> {
        let Some(horizons) = &self.horizons else { return self.interface.sample(from, u) };
        let leaves = from.channel.leaves(from.going);
        let to = match horizons.choose(OF_OTHERS, &mut u) {
            None => self.interface.sample(from, u)?.0,
            Some(beta) => {
                let side = (u[2] * leaves.len() as f64) as usize;
                Departure { beta, going: leaves[side.min(leaves.len() - 1)] }
            }
        };
        let scattered = self.scatter(from, to);
        (scattered.value > 0.0).then_some((to, scattered))
    }

    /// As [`ScatteringInterface::sample_sides`].
    pub(super) fn sample_sides(&self, from: Arrival, mut u: [f64; 4]) -> Option<Sides> {
        let Some(horizons) = &self.horizons else { return self.interface.sample_sides(from, u) };
        let towards = horizons.choose(OF_OTHERS, &mut u);
        let mut sides = self.interface.sample_sides(from, u)?;
        if let Some(beta) = towards {
            sides = [Up, Down].map(|going| (Some(Departure { beta, going }), 1.0));
        }
        for (to, probability) in &mut sides {
            *probability *= match to {
                Some(to) => {
                    let own = self.interface.scatter(from, *to).density;
                    own / horizons.mixed(OF_OTHERS, own, horizons.density(to.beta))
                }
                None => 1.0 / (1.0 - OF_OTHERS),
            };
        }
        Some(sides)
    }
}

#[cfg(test)]
mod tests {
    use papilio_sampling::{SampleStream, Sampler};

    use super::*;

    /// Means of powers of the cosine over all samples, weighted by `1/density`, are areas of the disc: of 1 by
    /// the whole disc, of `c^2` by half of it.
    #[test]
    fn directions_follow_their_density() {
        let horizons = Horizons::new([1.0, 1.5, 1.0].into_iter()).unwrap();
        assert_eq!(horizons.count, 2);
        let numbers = SampleStream::new(Sampler::Sobol, 3, 0);
        let count = 1 << 14;
        let mut sums = [0.0; 2];
        for path in 0..count {
            let [u, v, ..] = numbers.block(path, 0);
            let to = emitted(Some(&horizons), 1.7, [u, v]);
            let weight = 1.0 / emitted_density(Some(&horizons), 1.7, to) / count as f64;
            sums[0] += weight;
            if to.squared() < 1.0 {
                sums[1] += weight * (1.0 - to.squared());
            }
        }
        let pi = std::f64::consts::PI;
        assert!((sums[0] / (pi * 1.7 * 1.7) - 1.0).abs() < 2e-3, "{sums:?}");
        assert!((sums[1] / (0.5 * pi) - 1.0).abs() < 2e-3, "{sums:?}");
    }
}
