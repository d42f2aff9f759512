//! Light of sources that the views see: kernels between inclinations, summed over the azimuths of both.
//!
//! Views at one inclination share the kernels, and so do the rays of a source at one inclination. Of an
//! azimuthal order m a source contributes `sum w cos m psi` and `sum w sin m psi` at each of its
//! inclinations; the products of these with the kernels, summed over inclinations, are shared by all views at
//! one inclination, whose azimuth phi is only a factor cos m phi or sin m phi.

use std::f64::consts::{PI, TAU};
use std::sync::atomic::{AtomicBool, Ordering};

use super::directions::{Directions, Ray};
use super::first_bounce::FirstBounce;
use super::matrix::Matrix;
use super::once::ScatterMode;
use crate::ReflectanceFactor;

/// Kernels between extra nodes of views and of lights.
pub(super) struct Kernels {
    /// Via the base, `[column of all groups, pair]`.
    pub(super) base: Matrix,
    /// Of light that has not reached the base, `[bin of all groups, pair]`.
    pub(super) front: Matrix,
}

/// Where the light of kernels is added.
pub(super) struct Gathering<'a> {
    pub(super) directions: &'a Directions,
    /// Extra nodes of the views and of the lights, ascending; a pair is `view * lights + light`.
    pub(super) views: &'a [usize],
    pub(super) lights: &'a [usize],
    /// State and wavelength of each column of all groups, and wavelength of each bin.
    pub(super) places: Vec<usize>,
    pub(super) bins: Vec<usize>,
    /// Reflectance factors, by view and source.
    pub(super) beams: &'a mut [Vec<ReflectanceFactor>],
}

/// Rays of a source at one inclination.
struct Circle<'a> {
    /// Index among the lights.
    light: usize,
    rays: &'a [Ray],
}

/// Views at one extra node from which light of a circle is computed by azimuthal orders: for fewer, directly.
const FEW_VIEWS: usize = 4;

impl Gathering<'_> {
    /// Adds the light of an azimuthal order.
    pub(super) fn add_order(&mut self, order: usize, kernels: &Kernels) {
        let by_inclination = self.views_by_inclination();
        let both_ways = if order == 0 { 1.0 } else { 2.0 };
        for (source, rays) in self.directions.sources.iter().enumerate() {
            let lit: Vec<(usize, [f64; 2])> = circles(rays, self.lights)
                .map(|circle| (circle.light, circle.harmonic(order)))
                .filter(|(_, harmonic)| *harmonic != [0.0; 2])
                .collect();
            if lit.is_empty() {
                continue;
            }
            for (view, rays) in by_inclination.iter().enumerate() {
                // The sums of the part that is even in azimuth, and of the odd one, if there is any.
                let sums = [0, 1].map(|part| {
                    let lit = lit.iter().filter(|(_, harmonic)| harmonic[part] != 0.0);
                    self.sums(kernels, view, lit.map(|(light, harmonic)| (*light, harmonic[part])))
                });
                for (number, ray) in rays {
                    let (sin, cos) = (order as f64 * ray.turn).sin_cos();
                    for (sums, factor) in sums.iter().zip([cos, sin]) {
                        let Some([base, front]) = sums else { continue };
                        self.add(*number, source, [base, front], PI * ray.weight * both_ways * factor);
                    }
                }
            }
        }
    }

    /// Adds the light that one scatterer scatters once: `kernels` contain the factors for all pairs of
    /// directions.
    pub(super) fn add_once(&mut self, kernels: &Kernels, way: &ScatterMode, stop: &AtomicBool) {
        let by_inclination = self.views_by_inclination();
        let (directions, lights) = (self.directions, self.lights);
        let beta = |extra: usize| (extra, directions.beta[extra]);
        for (source, rays) in directions.sources.iter().enumerate() {
            for circle in circles(rays, lights) {
                let by_orders = |views: &Vec<(usize, Ray)>| views.len() >= FEW_VIEWS && circle.is_uniform();
                let orders = by_inclination.iter().any(by_orders).then(|| circle.harmonics());
                for (view, rays) in by_inclination.iter().enumerate() {
                    if stop.load(Ordering::Relaxed) {
                        return;
                    }
                    let pair = view * lights.len() + circle.light;
                    let seen = [kernels.base.column(pair), kernels.front.column(pair)];
                    if seen.iter().all(|factors| factors.iter().all(|factor| *factor == 0.0)) {
                        continue;
                    }
                    let [from, to] = [beta(self.views[view]), beta(lights[circle.light])];
                    let density = |turn: Option<f64>| way.density(from, to, turn);
                    let orders = orders.as_ref().filter(|_| rays.len() >= FEW_VIEWS);
                    let by_orders =
                        orders.map(|orders| (orders, cosines(circle.rays.len(), |turn| density(Some(turn)))));
                    for (number, ray) in rays {
                        let sent = match &by_orders {
                            Some((orders, response)) => at_azimuth(response, orders, ray.turn),
                            None => circle.direct(ray.turn, density),
                        };
                        self.add(*number, source, seen, PI * ray.weight * sent);
                    }
                }
            }
        }
    }

    /// Adds the light that the layers below a rough surface reflect once: `kernels` by pair of directions.
    pub(super) fn add_first(&mut self, kernels: &Kernels, first: &FirstBounce, stop: &AtomicBool) {
        let directions = self.directions;
        for (view, rays) in directions.views.iter().enumerate() {
            for (source, lights) in directions.sources.iter().enumerate() {
                for ray in rays.iter().take_while(|_| !stop.load(Ordering::Relaxed)) {
                    for light in lights {
                        let pair = first.number(ray, light);
                        let seen = [kernels.base.column(pair), kernels.front.column(pair)];
                        self.add(view, source, seen, PI * ray.weight * light.weight);
                    }
                }
            }
        }
    }

    /// Returns the rays of the views at each of their extra nodes, each with the number of its view.
    fn views_by_inclination(&self) -> Vec<Vec<(usize, Ray)>> {
        let mut all = vec![Vec::new(); self.views.len()];
        for (number, rays) in self.directions.views.iter().enumerate() {
            for ray in rays {
                all[self.views.binary_search(&ray.extra).unwrap_or_default()].push((number, *ray));
            }
        }
        all
    }

    /// Returns the kernels between a view's extra node and some lights, weighted: `[base, front]`; `None`
    /// without light.
    fn sums(
        &self,
        kernels: &Kernels,
        view: usize,
        lit: impl Iterator<Item = (usize, f64)>,
    ) -> Option<[Vec<f64>; 2]> {
        let mut sums = None;
        for (light, weight) in lit {
            let sums =
                sums.get_or_insert_with(|| [&self.places, &self.bins].map(|places| vec![0.0; places.len()]));
            let pair = view * self.lights.len() + light;
            for (sums, kernels) in sums.iter_mut().zip([&kernels.base, &kernels.front]) {
                sums.iter_mut().zip(kernels.column(pair)).for_each(|(sum, k)| *sum += weight * k);
            }
        }
        sums
    }

    /// Adds values by column and by bin, times a factor, to what a view sees of a source.
    fn add(&mut self, view: usize, source: usize, [base, front]: [&[f64]; 2], factor: f64) {
        let rho = &mut self.beams[view][source];
        let add = |sums: &mut [f64], places: &[usize], values: &[f64]| {
            places.iter().zip(values).for_each(|(at, value)| sums[*at] += factor * value);
        };
        add(&mut rho.via_pixel, &self.places, base);
        add(&mut rho.front, &self.bins, front);
    }
}

/// Returns the rays of a source, inclination by inclination: rays of one extra node are consecutive.
fn circles<'a>(source: &'a [Ray], lights: &'a [usize]) -> impl Iterator<Item = Circle<'a>> {
    source
        .chunk_by(|one, next| one.extra == next.extra)
        .map(|rays| Circle { light: lights.binary_search(&rays[0].extra).unwrap_or_default(), rays })
}

impl Circle<'_> {
    /// Returns the light of an azimuthal order, `sum w cos m psi` and `sum w sin m psi`.
    fn harmonic(&self, order: usize) -> [f64; 2] {
        let mut sums = [0.0; 2];
        for ray in self.rays {
            if ray.is_ring {
                sums[0] += if order == 0 { ray.weight } else { 0.0 };
                continue;
            }
            let (sin, cos) = (order as f64 * ray.turn).sin_cos();
            sums[0] += ray.weight * cos;
            sums[1] += ray.weight * sin;
        }
        sums
    }

    /// Returns the light of all orders that its rays represent.
    fn harmonics(&self) -> Vec<[f64; 2]> {
        (0..=self.rays.len() / 2).map(|order| self.harmonic(order)).collect()
    }

    /// Returns whether its rays are uniformly spaced in azimuth, as those that represent light up to an order
    /// are.
    fn is_uniform(&self) -> bool {
        const LEAST: usize = 5;
        let step = TAU / self.rays.len() as f64;
        let is_at = |(k, ray): (usize, &Ray)| {
            let off = ray.turn - self.rays[0].turn - k as f64 * step;
            (off - TAU * (off / TAU).round()).abs() < 1e-9
        };
        self.rays.len() >= LEAST && self.rays.iter().enumerate().all(is_at)
    }

    /// Returns the light of a kernel of the difference in azimuth, or of its mean over azimuth.
    fn direct(&self, turn: f64, density: impl Fn(Option<f64>) -> f64) -> f64 {
        let one = |ray: &Ray| ray.weight * density((!ray.is_ring).then_some(turn - ray.turn));
        self.rays.iter().map(one).sum()
    }
}

/// Returns the factors of cos m t, m = 0 and on, of an even function of the azimuth t, from as many uniform
/// samples: exact for functions of at most half as many orders.
fn cosines(count: usize, function: impl Fn(f64) -> f64) -> Vec<f64> {
    let steps: Vec<f64> = (0..count).map(|k| (TAU * k as f64 / count as f64).cos()).collect();
    let samples: Vec<f64> = (0..=count / 2).map(|k| function(TAU * k as f64 / count as f64)).collect();
    let factor = |order: usize| {
        let term = |(k, sample): (usize, &f64)| {
            let both = if k == 0 || 2 * k == count { 1.0 } else { 2.0 };
            both * sample * steps[order * k % count]
        };
        let both = if order == 0 || 2 * order == count { 1.0 } else { 2.0 };
        both * samples.iter().enumerate().map(term).sum::<f64>() / count as f64
    };
    (0..=count / 2).map(factor).collect()
}

/// Returns the sum over the orders of a response and of light, at an azimuth.
fn at_azimuth(response: &[f64], light: &[[f64; 2]], turn: f64) -> f64 {
    let (sin, cos) = turn.sin_cos();
    let [mut c, mut s] = [1.0, 0.0];
    let mut sum = 0.0;
    for (response, [even, odd]) in response.iter().zip(light) {
        sum += response * (even * c + odd * s);
        [c, s] = [c * cos - s * sin, s * cos + c * sin];
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_by_orders_is_that_of_its_rays() {
        let rays: Vec<Ray> = (0..21)
            .map(|k| Ray {
                extra: 0,
                turn: PI + TAU * f64::from(k) / 21.0,
                weight: 0.3 + f64::from(k * k % 7),
                is_ring: false,
            })
            .collect();
        let circle = Circle { light: 0, rays: &rays };
        // Its orders decrease by a factor of 0.2.
        let lobe = |turn: f64| 1.0 / (1.04 - 0.4 * turn.cos());
        let response = cosines(21, lobe);
        for turn in [0.0, 0.4, -2.0, 3.0] {
            let direct = circle.direct(turn, |turn| lobe(turn.unwrap()));
            let sum = at_azimuth(&response, &circle.harmonics(), turn);
            assert!((sum / direct - 1.0).abs() < 1e-6, "{turn}: {sum} {direct}");
        }
    }
}
