//! The kernel of a surface: from each band of directions to each other one, on both sides, by azimuth.
//!
//! **Laws.** Light of a band fills its directions uniformly, so that the light M that goes from band a to
//! band b, per étendue, is that which goes from b to a (reciprocity, at each difference of azimuths), and
//! uniform light stays uniform (conservation of energy). Rays know neither law: how well they obey is the
//! test of the tracer. Then the mean of both ways, weighted by their variances, makes the kernel reciprocal,
//! and a factor for each band balances the light ([`crate::balance`]).

use crate::balance::balance;
use crate::bands::{AZIMUTHS, Bands};
use crate::goniometer::{Measured, Replicate};
use crate::{MicrogeometryError, REPLICATES};

/// Light that one ray of each part of the directions, of these étendues, adds to the mean over all
/// replicates; each part has `rays` in a replicate.
///
/// The spread of few rays says little about rare ones that none of the replicates has: a sum of light is not
/// known better than to one ray, as a count of k events is known to the root of k + 1.
pub(crate) fn one_ray(area: &[f64], rays: f64) -> Vec<f64> {
    area.iter().map(|area| area / (rays * REPLICATES as f64)).collect()
}

/// Root mean square of z-scores beyond which a kernel is refused.
const MOST_Z: f64 = 3.0;

/// Relative error of light up to which it is compared with that of the reverse way.
pub(crate) const KNOWN: f64 = 0.3;

/// Share of the light whose patches count for the error of the kernel.
const MOST_OF_LIGHT: f64 = 0.99;

/// The kernel of a surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Kernel {
    /// Bands of |beta| on both sides.
    pub bands: Bands,
    /// Fraction of the light of a band that goes to each other one, by the difference of the azimuths of
    /// propagation, 0 to 180 deg in equal steps: `[from][to][azimuth]`. Regular light is not contained.
    pub scattered: Vec<f64>,
    /// Standard errors of `scattered`, before the laws are imposed.
    pub errors: Vec<f64>,
    /// Fraction of the light of each band that is reflected as by a flat face.
    pub regular_reflected: Vec<f64>,
    /// Fraction of the light of each band that is transmitted as by a flat face.
    pub regular_transmitted: Vec<f64>,
    /// Fraction of the light of each band that facets absorb.
    pub absorbed: Vec<f64>,
    /// How well the rays obey the laws.
    pub audit: Audit,
}

/// How well rays obey the laws, and how much imposing them changes.
#[derive(Debug, Clone, PartialEq)]
pub struct Audit {
    /// Of uniform light that should leave each band unchanged: differences over their standard errors.
    pub energy_z: Vec<f64>,
    /// Root mean square of the differences of both ways over their standard errors; about 1.
    pub reciprocity_z_rms: f64,
    /// The largest of these.
    pub reciprocity_z_largest: f64,
    /// Their number.
    pub reciprocity_tests: usize,
    /// Fraction of the light that is moved by making the kernel reciprocal.
    pub moved_by_symmetry: f64,
    /// Fraction of the light that is moved by balancing.
    pub moved_by_balance: f64,
    /// Mean relative standard error of the patches with 99 % of the light.
    pub relative_error: f64,
    /// Rays that were lost.
    pub dropped_rays: f64,
    /// Rays that were followed.
    pub rays: u64,
}

impl Audit {
    /// The audit of replicates before their kernel is known.
    pub(crate) fn of_rays(replicates: &[Replicate]) -> Self {
        Self {
            energy_z: Vec::new(),
            reciprocity_z_rms: 0.0,
            reciprocity_z_largest: 0.0,
            reciprocity_tests: 0,
            moved_by_symmetry: 0.0,
            moved_by_balance: 0.0,
            relative_error: 0.0,
            dropped_rays: replicates.iter().map(|one| one.lost).sum(),
            rays: replicates.iter().map(|one| one.rays).sum(),
        }
    }

    /// Root mean square of `energy_z`.
    pub fn energy_z_rms(&self) -> f64 {
        (self.energy_z.iter().map(|z| z * z).sum::<f64>() / self.energy_z.len().max(1) as f64).sqrt()
    }

    /// Fails for a kernel that contradicts a law: reciprocity or the conservation of energy, by these names.
    pub(crate) fn check(&self, [reciprocity, energy]: [&'static str; 2]) -> Result<(), MicrogeometryError> {
        let tests = [
            (reciprocity, self.reciprocity_z_rms, self.reciprocity_tests),
            (energy, self.energy_z_rms(), self.energy_z.len()),
        ];
        match tests.into_iter().find(|(_, z_rms, _)| *z_rms > MOST_Z) {
            Some((law, z_rms, count)) => Err(MicrogeometryError::Law { law, z_rms, count, most: MOST_Z }),
            None => Ok(()),
        }
    }
}

impl Kernel {
    /// Combines replicates, in which each band has this number of `rays`.
    pub(crate) fn new(
        bands: &Bands,
        replicates: &[Replicate],
        rays: u64,
    ) -> Result<Self, MicrogeometryError> {
        let count = bands.count();
        let area: Vec<f64> = (0..count).map(|band| bands.area(band)).collect();
        let cells = count * count * AZIMUTHS;
        let (mut light, mut errors) = (vec![0.0; cells], vec![0.0; cells]);
        for cell in 0..cells {
            let values = replicates.iter().map(|one| one.scattered[cell]);
            if values.clone().any(|value| value > 0.0) {
                let Measured { value, error } = Measured::of(values);
                let weight = area[cell / (count * AZIMUTHS)];
                (light[cell], errors[cell]) = (weight * value, weight * error);
            }
        }
        let one_ray = one_ray(&area, rays as f64);
        let audit = Audit {
            energy_z: energy_z(bands, replicates, &area, &one_ray),
            relative_error: relative_error(&light, &errors),
            ..Audit::of_rays(replicates)
        };
        let regular = |way: usize| -> Vec<f64> {
            (0..count)
                .map(|band| Measured::of(replicates.iter().map(|one| one.regular[band][way])).value)
                .collect()
        };
        let mut kernel = Self {
            bands: bands.clone(),
            scattered: light,
            errors,
            regular_reflected: regular(0),
            regular_transmitted: regular(1),
            absorbed: (0..count)
                .map(|band| Measured::of(replicates.iter().map(|one| one.absorbed[band])).value)
                .collect(),
            audit,
        };
        kernel.symmetrise(&area, &one_ray);
        kernel.balance(&area);
        let rows = kernel.scattered.chunks_exact_mut(count * AZIMUTHS).zip(&area);
        rows.for_each(|(row, area)| row.iter_mut().for_each(|light| *light /= area));
        let rows = kernel.errors.chunks_exact_mut(count * AZIMUTHS).zip(&area);
        rows.for_each(|(row, area)| row.iter_mut().for_each(|error| *error /= area));
        kernel.audit.check(["reciprocity", "the conservation of energy"])?;
        Ok(kernel)
    }

    /// Compares both ways, and takes their mean.
    fn symmetrise(&mut self, area: &[f64], one_ray: &[f64]) {
        let count = area.len();
        let at = |from: usize, to: usize, azimuth: usize| (from * count + to) * AZIMUTHS + azimuth;
        let (mut squares, mut moved, mut all) = (0.0, 0.0, 0.0);
        for from in 0..count {
            for to in 0..from {
                for azimuth in 0..AZIMUTHS {
                    let ways = [at(from, to, azimuth), at(to, from, azimuth)];
                    let light = ways.map(|way| self.scattered[way]);
                    let errors = ways.map(|way| self.errors[way]);
                    if light == [0.0; 2] {
                        continue;
                    }
                    let variance = errors.map(|error| error * error);
                    let is_known = (0..2).all(|way| errors[way] > 0.0 && errors[way] < KNOWN * light[way]);
                    if is_known {
                        let of_rays = one_ray[from].powi(2) + one_ray[to].powi(2);
                        let z = (light[0] - light[1]) / (variance[0] + variance[1] + of_rays).sqrt();
                        squares += z * z;
                        self.audit.reciprocity_tests += 1;
                        self.audit.reciprocity_z_largest = self.audit.reciprocity_z_largest.max(z.abs());
                    }
                    let mean = match is_known {
                        true => {
                            (light[0] * variance[1] + light[1] * variance[0]) / (variance[0] + variance[1])
                        }
                        false => 0.5 * (light[0] + light[1]),
                    };
                    moved += light.iter().map(|light| (mean - light).abs()).sum::<f64>();
                    ways.iter().for_each(|way| self.scattered[*way] = mean);
                }
            }
        }
        all += self.scattered.iter().sum::<f64>();
        if self.audit.reciprocity_tests > 0 {
            self.audit.reciprocity_z_rms = (squares / self.audit.reciprocity_tests as f64).sqrt();
        }
        self.audit.moved_by_symmetry = if all > 0.0 { 0.5 * moved / all } else { 0.0 };
        // Regular transmission is the same in both directions, too.
        let [above, below] = crate::Side::ALL.map(|side| self.bands.of(side));
        for (above, below) in above.zip(below) {
            if self.bands.band(above).1 == self.bands.band(below).1 {
                let mean = 0.5 * (self.regular_transmitted[above] + self.regular_transmitted[below]);
                self.regular_transmitted[above] = mean;
                self.regular_transmitted[below] = mean;
            }
        }
    }

    /// Scales the light of each band, from it and to it, until only what facets absorb is missing.
    fn balance(&mut self, area: &[f64]) {
        let count = area.len();
        let before = self.scattered.clone();
        let wanted: Vec<f64> = (0..count)
            .map(|band| {
                let kept = 1.0 - self.absorbed[band];
                area[band] * (kept - self.regular_reflected[band] - self.regular_transmitted[band]).max(0.0)
            })
            .collect();
        balance(&mut self.scattered, &wanted);
        // Where nothing is scattered, the mean of both ways of regular transmission leaves the rest to the
        // reflection.
        for (band, row) in self.scattered.chunks_exact(count * AZIMUTHS).enumerate() {
            if row.iter().all(|light| *light == 0.0) {
                self.regular_reflected[band] = 1.0 - self.absorbed[band] - self.regular_transmitted[band];
            }
        }
        let moved: f64 = before.iter().zip(&self.scattered).map(|(a, b)| (a - b).abs()).sum();
        let all: f64 = before.iter().sum();
        self.audit.moved_by_balance = if all > 0.0 { moved / all } else { 0.0 };
    }

    /// The |beta| within which half of the light along the normal from above is transmitted, of all that goes
    /// to |beta| up to 1.
    pub fn median_beta(&self) -> f64 {
        let above = &self.scattered[..self.bands.count() * AZIMUTHS];
        let share = |band: usize| above[band * AZIMUTHS..][..AZIMUTHS].iter().sum::<f64>();
        let bands = self.bands.of(crate::Side::Below).map(|band| (self.bands.band(band).1, share(band)));
        let seen: Vec<([f64; 2], f64)> = bands.filter(|([_, to], _)| *to < 1.0 + 1e-9).collect();
        let half = 0.5 * (self.regular_transmitted[0] + seen.iter().map(|(_, share)| share).sum::<f64>());
        let mut before = self.regular_transmitted[0];
        for ([from, to], share) in seen {
            if share > 0.0 && before + share >= half {
                let inside = ((half - before) / share).max(0.0);
                return (from * from + inside * (to * to - from * from)).sqrt();
            }
            before += share;
        }
        0.0
    }

    /// Number of azimuths between 0 and 180 deg.
    pub fn azimuths(&self) -> usize {
        AZIMUTHS
    }
}

/// Uniform light on all bands of both sides leaves each band as it came, but for what is absorbed:
/// differences over standard errors.
fn energy_z(bands: &Bands, replicates: &[Replicate], area: &[f64], one_ray: &[f64]) -> Vec<f64> {
    let count = area.len();
    let one_ray = one_ray.iter().copied().fold(0.0, f64::max);
    let arriving = |one: &Replicate| {
        let mut sums = vec![0.0; count];
        for (from, row) in one.scattered.chunks_exact(count * AZIMUTHS).enumerate() {
            let cells = row.chunks_exact(AZIMUTHS);
            sums.iter_mut()
                .zip(cells)
                .for_each(|(sum, cells)| *sum += area[from] * cells.iter().sum::<f64>());
        }
        for from in 0..count {
            let (side, edges) = bands.band(from);
            let [reflected, transmitted] = one.regular[from];
            sums[from] += area[from] * reflected;
            // Regular light stays in its |beta|, and the bands of both sides are the same where it is
            // transmitted.
            let there = bands.number(side.other(), 0.5 * (edges[0] + edges[1]));
            sums[there] += area[from] * transmitted;
            // By reciprocity, what a band absorbs is missing in the light that arrives there from all others.
            sums[from] += area[from] * one.absorbed[from];
        }
        sums
    };
    let all: Vec<Vec<f64>> = replicates.iter().map(arriving).collect();
    let z = |band: usize| {
        let Measured { value, error } = Measured::of(all.iter().map(|sums| sums[band]));
        // Without scattering there is no noise, and rounding alone remains.
        let is_known = error < 1e-12 * area[band] && (value - area[band]).abs() < 1e-9 * area[band];
        if is_known { 0.0 } else { (value - area[band]) / error.hypot(one_ray) }
    };
    debug_assert_eq!(replicates.len() as u64, REPLICATES);
    (0..count).map(z).collect()
}

/// Mean relative error of the patches with most of the light.
pub(crate) fn relative_error(light: &[f64], errors: &[f64]) -> f64 {
    let mut patches: Vec<(f64, f64)> =
        light.iter().copied().zip(errors.iter().copied()).filter(|(light, _)| *light > 0.0).collect();
    patches.sort_by(|a, b| b.0.total_cmp(&a.0));
    let all: f64 = patches.iter().map(|(light, _)| light).sum();
    let (mut seen, mut sum, mut count) = (0.0, 0.0, 0.0);
    for (light, error) in patches {
        if seen > MOST_OF_LIGHT * all {
            break;
        }
        seen += light;
        sum += error / light;
        count += 1.0;
    }
    if count > 0.0 { sum / count } else { 0.0 }
}
