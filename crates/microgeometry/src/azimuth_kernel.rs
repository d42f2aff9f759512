//! The kernel of a surface by azimuth: from each patch of directions to each other one, on both sides.
//!
//! **Laws.** As for bands ([`crate::kernel`]): as much light M goes from patch a to patch b, per étendue, as
//! from the reverse of b to the reverse of a, and uniform light stays uniform. Patches have fewer rays than
//! bands. The mean of both ways is weighted by the étendues of the patches at which the light ends, because
//! as many rays come from a large patch as from a small one; weights by the variances that were found would
//! favour whichever way has less light by chance.

use crate::balance::{factors, scale};
use crate::by_azimuth::{AzimuthMeans, AzimuthSums};
use crate::goniometer::Measured;
use crate::kernel::{Audit, KNOWN, relative_error};
use crate::patches::Patches;
use crate::{MicrogeometryError, REPLICATES};

/// The kernel of a surface by azimuth.
#[derive(Debug, Clone, PartialEq)]
pub struct AzimuthKernel {
    /// Patches of directions on both sides.
    pub patches: Patches,
    /// Fraction of the light of a patch, which fills its directions uniformly, that goes to each other one:
    /// `[from][to]`, by azimuths of propagation. Regular light is not contained.
    pub scattered: Vec<f32>,
    /// Standard errors of `scattered`, before the laws are imposed.
    pub errors: Vec<f32>,
    /// Fraction of the light of each patch that is reflected as by a flat face.
    pub regular_reflected: Vec<f64>,
    /// Fraction of the light of each patch that is transmitted as by a flat face.
    pub regular_transmitted: Vec<f64>,
    /// Fraction of the light of each patch that facets absorb.
    pub absorbed: Vec<f64>,
    /// How well the rays obey the laws.
    pub audit: Audit,
}

impl AzimuthKernel {
    /// Makes the kernel of the sums of all replicates.
    ///
    /// # Errors
    /// Sums that contradict a law by more than three standard errors, or cannot be balanced.
    pub(crate) fn new(sums: AzimuthSums, of_rays: Audit) -> Result<Self, MicrogeometryError> {
        let AzimuthMeans { patches, mut light, errors, regular, absorbed, arriving, one_ray } =
            sums.into_means();
        debug_assert_eq!(arriving.len() as u64, REPLICATES);
        let area: Vec<f64> = (0..patches.count()).map(|patch| patches.area(patch)).collect();
        let [regular_reflected, regular_transmitted] = both_ways(&patches, regular);
        let mut audit = Audit {
            energy_z: energy_z(&arriving, &area, &one_ray),
            relative_error: relative_error(&light, &errors),
            ..of_rays
        };
        symmetrise(&mut light, &errors, (&area, &one_ray), &mut audit);
        audit.check(["reciprocity by azimuth", "the conservation of energy by azimuth"])?;
        let kept = absorbed.iter().zip(&regular_reflected).zip(&regular_transmitted);
        let wanted: Vec<f64> =
            kept.zip(&area).map(|(((a, r), t), area)| area * (1.0 - a - r - t).max(0.0)).collect();
        balanced(&mut light, &wanted, &mut audit)?;
        let fractions = |light: &[f64]| fractions(&patches, light, &area);
        let mut kernel = Self {
            scattered: fractions(&light),
            errors: fractions(&errors),
            regular_reflected,
            regular_transmitted,
            absorbed,
            audit,
            patches,
        };
        kernel.close_dark_patches();
        Ok(kernel)
    }

    /// Where nothing is scattered, the mean of both ways of regular transmission leaves the rest to the
    /// reflection.
    fn close_dark_patches(&mut self) {
        for (patch, row) in self.scattered.chunks_exact(self.patches.count()).enumerate() {
            if row.iter().all(|light| *light == 0.0) {
                self.regular_reflected[patch] = 1.0 - self.absorbed[patch] - self.regular_transmitted[patch];
            }
        }
    }
}

/// Regular reflectance and transmittance, the same for both ways of light.
fn both_ways(patches: &Patches, [reflected, transmitted]: [Vec<f64>; 2]) -> [Vec<f64>; 2] {
    let mean = |values: &[f64], one: usize, other: usize| 0.5 * (values[one] + values[other]);
    let all = 0..patches.count();
    let there = |patch| patches.across(patch).map_or(patch, |there| patches.reversed(there));
    [
        all.clone().map(|patch| mean(&reflected, patch, patches.reversed(patch))).collect(),
        all.map(|patch| mean(&transmitted, patch, there(patch))).collect(),
    ]
}

/// Uniform light leaves each patch as it came: differences over standard errors, where these are small enough
/// to tell. `one_ray` is the light of a ray of each patch ([`crate::kernel::one_ray`]).
fn energy_z(arriving: &[Vec<f64>], area: &[f64], one_ray: &[f64]) -> Vec<f64> {
    let one_ray = one_ray.iter().copied().fold(0.0, f64::max);
    let z = |(patch, area): (usize, &f64)| {
        let Measured { value, error } = Measured::of(arriving.iter().map(|one| one[patch]));
        if error < 1e-12 * area && (value - area).abs() < 1e-9 * area {
            return Some(0.0);
        }
        let error = error.hypot(one_ray);
        (error < KNOWN * area).then(|| (value - area) / error)
    };
    area.iter().enumerate().filter_map(z).collect()
}

/// Compares both ways of light, and takes their mean.
fn symmetrise(light: &mut [f64], errors: &[f64], (area, one_ray): (&[f64], &[f64]), audit: &mut Audit) {
    let count = area.len();
    let (mut squares, mut moved, mut all) = (0.0, 0.0, 0.0);
    for from in 0..count {
        for to in 0..from {
            let ways = [from * count + to, to * count + from];
            let [there, back] = ways.map(|way| light[way]);
            if there == 0.0 && back == 0.0 {
                continue;
            }
            let is_known = ways.iter().all(|way| errors[*way] > 0.0 && errors[*way] < KNOWN * light[*way]);
            if is_known {
                let error = errors[ways[0]].hypot(errors[ways[1]]);
                let z = (there - back) / error.hypot(one_ray[from].hypot(one_ray[to]));
                squares += z * z;
                audit.reciprocity_tests += 1;
                audit.reciprocity_z_largest = audit.reciprocity_z_largest.max(z.abs());
            }
            let mean = (area[to] * there + area[from] * back) / (area[from] + area[to]);
            moved += (mean - there).abs() + (mean - back).abs();
            all += 2.0 * mean;
            ways.iter().for_each(|way| light[*way] = mean);
        }
        all += light[from * count + from];
    }
    if audit.reciprocity_tests > 0 {
        audit.reciprocity_z_rms = (squares / audit.reciprocity_tests as f64).sqrt();
    }
    audit.moved_by_symmetry = if all > 0.0 { 0.5 * moved / all } else { 0.0 };
}

/// Scales the light of each patch, from it and to its reverse, until it is what is wanted.
fn balanced(light: &mut [f64], wanted: &[f64], audit: &mut Audit) -> Result<(), MicrogeometryError> {
    let factors = factors(light, wanted).map_err(|missing| MicrogeometryError::Unbalanced { missing })?;
    let all: f64 = light.iter().sum();
    let change = |(from, row): (usize, &[f64])| -> f64 {
        row.iter().zip(&factors).map(|(light, to)| light * (factors[from] * to - 1.0).abs()).sum()
    };
    let moved: f64 = light.chunks_exact(wanted.len()).enumerate().map(change).sum();
    audit.moved_by_balance = if all > 0.0 { moved / all } else { 0.0 };
    scale(light, &factors, 1);
    Ok(())
}

/// Light `[from][reverse of to]` as fractions of that of each patch, `[from][to]`.
fn fractions(patches: &Patches, light: &[f64], area: &[f64]) -> Vec<f32> {
    let rows = light.chunks_exact(area.len()).zip(area);
    rows.flat_map(|(row, area)| (0..row.len()).map(move |to| (row[patches.reversed(to)] / area) as f32))
        .collect()
}
