//! Rays of a run, started side by side.
//!
//! **Tiles.** Rays of all directions begin in one part of the period before those of the next one, so that
//! the heights that they meet stay in the cache. Each tile has the same weight: the places are stratified,
//! and the estimate stays unbiased.
//!
//! **Batches.** The first numbers of several paths are computed together, and what their rays will probably
//! meet first is read together: the processor waits once for all of them. Rays are then followed one by one,
//! in the order of their paths.

use std::hint::black_box;

use papilio_sampling::SampleStream;

use crate::MicrogeometryError;
use crate::ray::{Face, Ray};

/// Rays side by side.
const BATCH: usize = 64;

/// Rays between two looks at whether the measurement is to be stopped; a multiple of [`BATCH`].
const STOP_EVERY: u64 = 4096;

/// Fewest rays in a tile.
const FEWEST: u64 = BATCH as u64;

/// A part of the period of a face, in which rays of all directions begin before those of the next one: what
/// they read stays in the cache. Tiles are squares of equal area, and each has its own numbers and, but for
/// one, the same number of rays.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tile {
    number: u64,
    per_side: u64,
    /// Rays of all tiles, for each direction.
    rays: u64,
}

impl Tile {
    /// All tiles of a face; one if there are few rays.
    pub(crate) fn all(face: &dyn Face, rays: u64) -> impl Iterator<Item = Self> + use<> {
        let most = (rays / FEWEST).isqrt().max(1);
        let per_side = face.tiles_per_side().min(most);
        (0..per_side * per_side).map(move |number| Self { number, per_side, rays })
    }

    /// The whole face as one tile.
    pub(crate) fn whole(rays: u64) -> Self {
        Self { number: 0, per_side: 1, rays }
    }

    fn count(&self) -> u64 {
        self.per_side * self.per_side
    }

    /// The first of its rays among all of a direction.
    fn first(&self, number: u64) -> u64 {
        (u128::from(self.rays) * u128::from(number) / u128::from(self.count())) as u64
    }

    /// Number of its rays.
    pub(crate) fn rays(&self) -> u64 {
        self.first(self.number + 1) - self.first(self.number)
    }

    /// Number of rays of which each would have the weight of one of these: tiles have equal weights.
    pub(crate) fn equivalent_rays(&self) -> f64 {
        (self.count() * self.rays()) as f64
    }

    /// The place in the period, 0 to 1, for a place in the tile.
    fn place(&self, at: [f64; 2]) -> [f64; 2] {
        let tile = [self.number % self.per_side, self.number / self.per_side];
        [0, 1].map(|k| (tile[k] as f64 + at[k]) / self.per_side as f64)
    }
}

/// Starts the rays of a tile by four numbers, the first two of which are the place in the period, and calls
/// `each` with each path and ray.
///
/// # Errors
/// [`MicrogeometryError::Interrupted`].
pub(crate) fn each_ray(
    face: &dyn Face,
    tile: Tile,
    numbers: &SampleStream,
    stop: &dyn Fn() -> bool,
    begin: impl Fn([f64; 4]) -> Ray,
    each: &mut dyn FnMut(u64, &Ray),
) -> Result<(), MicrogeometryError> {
    let own = if tile.count() == 1 { *numbers } else { numbers.part(tile.number | 1 << 32) };
    for first in (0..tile.rays()).step_by(BATCH) {
        if first % STOP_EVERY == 0 && stop() {
            return Err(MicrogeometryError::Interrupted);
        }
        let [x, y, azimuth, u] = [0, 1, 2, 3].map(|number| own.batch::<BATCH>(first, 0, number));
        let rays: [Ray; BATCH] = std::array::from_fn(|k| {
            let [x, y] = tile.place([x[k], y[k]]);
            begin([x, y, azimuth[k], u[k]])
        });
        let rays = &rays[..((tile.rays() - first) as usize).min(BATCH)];
        black_box(rays.iter().map(|ray| face.expect(ray)).sum::<f64>());
        for (path, ray) in (tile.first(tile.number) + first..).zip(rays) {
            each(path, ray);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use papilio_sampling::Sampler;

    use super::*;
    use crate::heights::Triangles;
    use crate::{Coating, Goniometer, HeightMap, RandomHeights, Spectrum, Surface};

    /// 512 x 512 heights have four tiles. Each ray belongs to one of them and begins there, and the weights
    /// of all rays add up to 1.
    #[test]
    fn tiles_divide_the_rays_and_the_period() {
        let map = HeightMap::new(512, [1.0; 2], vec![0.0; 512 * 512]).unwrap();
        let face = Triangles::new(&map);
        let numbers = SampleStream::new(Sampler::Sobol, 3, 0);
        for (rays, tiles) in [(1000, 4), (257, 4), (255, 1), (1, 1)] {
            let (mut paths, mut weight) = (Vec::new(), 0.0);
            let all: Vec<Tile> = Tile::all(&face, rays).collect();
            assert_eq!(all.len(), tiles, "{rays}");
            for tile in all {
                let begin = |[x, y, ..]: [f64; 4]| Ray { at: [x, y, 0.0], along: [0.0, 0.0, -1.0] };
                each_ray(&face, tile, &numbers, &|| false, begin, &mut |path, ray| {
                    paths.push(path);
                    weight += 1.0 / tile.equivalent_rays();
                    let at = [0, 1].map(|k| (ray.at[k] * tile.per_side as f64) as u64);
                    assert_eq!(at[1] * tile.per_side + at[0], tile.number);
                })
                .unwrap();
            }
            assert_eq!(paths, (0..rays).collect::<Vec<_>>());
            assert!((weight - 1.0).abs() < 1e-12, "{rays}: {weight}");
        }
    }

    /// The same heights once, and twice along both sides, as four tiles: equal light within the errors of
    /// both.
    #[test]
    fn tiles_do_not_change_the_light() {
        let face = RandomHeights::new(Spectrum::Gaussian { rms_um: 2.5, correlation_um: 10.0 }, 4).unwrap();
        let one = face.realisation(0).unwrap();
        let twice = |at: usize| one.heights_um()[at / 512 % 256 * 256 + at % 512 % 256];
        let four = HeightMap::new(512, one.pitch_um(), (0..512 * 512).map(twice).collect()).unwrap();
        let goniometer = Goniometer {
            index_above: 1.0,
            index_below: 1.5,
            coating: Coating::None,
            incidence_deg: vec![20.0, 70.0],
            azimuths: None,
            rays: 260,
            seed: 6,
        };
        let [one, four] = [one, four].map(|map| goniometer.totals_alone(&Surface::Heights(map)));
        for (a, b) in one.iter().zip(&four) {
            for (a, b) in [(a.reflected, b.reflected), (a.transmitted_beyond, b.transmitted_beyond)] {
                assert!((a.value - b.value).abs() <= 4.5 * a.error.hypot(b.error), "{a:?} {b:?}");
                assert!(b.error < 0.01 && b.error < 2.0 * a.error + 1e-6, "{a:?} {b:?}");
            }
        }
    }
}
