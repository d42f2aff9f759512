//! Light by azimuth: what replicates of rays show between patches of directions, and their sums.
//!
//! The rays are those of the bands, sorted also by the azimuths at which they come and go. A replicate has
//! most of its patches dark, and up to millions of them: it is packed, added to the sums, and forgotten.

use crate::goniometer::QUANTITIES;
use crate::kernel::one_ray;
use crate::patches::Patches;
use crate::{REPLICATES, Side};

/// Part of a ray to which packed light is rounded: numbers without decimals are short where they are saved.
const GRAIN: f64 = 1e-5;

/// Light of a replicate by azimuth.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct LightByAzimuth {
    /// Of each side, inclination and azimuth: the quantities of [`crate::Total`] in their order.
    pub(crate) rows: Vec<[f64; QUANTITIES]>,
    /// Rays of each patch.
    rays: Vec<f64>,
    /// Light of each patch that is reflected and transmitted as by a flat face, in rays.
    regular: Vec<[f64; 2]>,
    /// Light of each patch that is absorbed, in rays.
    absorbed: Vec<f64>,
    /// Scattered light `[from][to]` in grains. A negative number stands for as many cells without light.
    packed: Vec<f64>,
}

/// Light of a band while its rays are followed.
#[derive(Debug)]
pub(crate) struct BandByAzimuth<'a> {
    patches: &'a Patches,
    band: usize,
    /// Azimuth of the ray that is followed, as the number of its patch in the band.
    at: usize,
    rays: Vec<f64>,
    /// In rays, `[from][to]`.
    scattered: Vec<f64>,
    regular: Vec<[f64; 2]>,
    absorbed: Vec<f64>,
}

impl<'a> BandByAzimuth<'a> {
    pub(crate) fn new(patches: &'a Patches, band: usize) -> Self {
        let azimuths = patches.azimuths();
        Self {
            patches,
            band,
            at: 0,
            rays: vec![0.0; azimuths],
            scattered: vec![0.0; azimuths * patches.count()],
            regular: vec![[0.0; 2]; azimuths],
            absorbed: vec![0.0; azimuths],
        }
    }

    /// Begins a ray with a direction, given by its parts along x and y.
    pub(crate) fn begin(&mut self, along: [f64; 2]) {
        self.at = self.patches.number(0, along);
        self.rays[self.at] += 1.0;
    }

    /// Adds light of the ray that leaves for a band.
    pub(crate) fn scatter(&mut self, to: usize, along: [f64; 2], weight: f64) {
        self.scattered[self.at * self.patches.count() + self.patches.number(to, along)] += weight;
    }

    /// Adds light that leaves as from a flat face.
    pub(crate) fn regular(&mut self, is_transmitted: bool, weight: f64) {
        self.regular[self.at][usize::from(is_transmitted)] += weight;
    }

    /// Adds absorbed light.
    pub(crate) fn absorb(&mut self, weight: f64) {
        self.absorbed[self.at] += weight;
    }
}

impl LightByAzimuth {
    /// Adds a band; bands come in the order of their numbers.
    pub(crate) fn add(&mut self, band: &BandByAzimuth<'_>) {
        debug_assert_eq!(self.absorbed.len(), band.band * band.patches.azimuths());
        self.rays.extend(&band.rays);
        self.regular.extend(&band.regular);
        self.absorbed.extend(&band.absorbed);
        for light in &band.scattered {
            let grains = (light / GRAIN).round();
            match self.packed.last_mut() {
                Some(dark) if grains == 0.0 && *dark < 0.0 => *dark -= 1.0,
                _ => self.packed.push(if grains == 0.0 { -1.0 } else { grains }),
            }
        }
    }

    /// All of it as numbers, for [`of`](Self::of).
    pub(crate) fn numbers(&self) -> Vec<f64> {
        [self.rows.as_flattened(), &self.rays, self.regular.as_flattened(), &self.absorbed, &self.packed]
            .concat()
    }

    /// The light with these [`numbers`](Self::numbers); `None` if they do not belong to these patches and
    /// rows.
    pub(crate) fn of(patches: &Patches, rows: usize, numbers: &[f64]) -> Option<Self> {
        let count = patches.count();
        let (rows, rest) = numbers.split_at_checked(rows * QUANTITIES)?;
        let (rays, rest) = rest.split_at_checked(count)?;
        let (regular, rest) = rest.split_at_checked(2 * count)?;
        let (absorbed, packed) = rest.split_at_checked(count)?;
        let cells: f64 = packed.iter().map(|number| if *number < 0.0 { -number } else { 1.0 }).sum();
        (cells == (count * count) as f64 && packed.iter().all(|number| number.fract() == 0.0)).then(|| Self {
            rows: rows.as_chunks().0.to_vec(),
            rays: rays.to_vec(),
            regular: regular.as_chunks().0.to_vec(),
            absorbed: absorbed.to_vec(),
            packed: packed.to_vec(),
        })
    }
}

/// Sums over replicates, which are added in the order of their numbers.
///
/// Light goes from a patch to the reverse of another one, so that reciprocity is a symmetry: as much goes
/// from a to the reverse of b as from b to the reverse of a, per étendue.
#[derive(Debug, Clone)]
pub(crate) struct AzimuthSums {
    pub(crate) patches: Patches,
    /// Rays of each band in a replicate.
    rays_of_band: u64,
    /// Of each replicate, the rows of its light.
    pub(crate) rows: Vec<Vec<[f64; QUANTITIES]>>,
    /// Rays of each patch; light, as [`LightByAzimuth`] has it.
    rays: Vec<f64>,
    regular: Vec<[f64; 2]>,
    absorbed: Vec<f64>,
    /// Scattered light in rays, `[from][reverse of to]`, and the sum of its squares in the replicates.
    light: Vec<f64>,
    squares: Vec<f64>,
    /// Of each replicate: what uniform light sends to the reverse of each patch, absorbed light included. It
    /// should be the étendue of the patch.
    arriving: Vec<Vec<f64>>,
}

/// Means over replicates.
#[derive(Debug, Clone)]
pub(crate) struct AzimuthMeans {
    pub(crate) patches: Patches,
    /// Scattered light `[from][reverse of to]`: the fraction of the light of `from`, times its étendue. And
    /// its standard error.
    pub(crate) light: Vec<f64>,
    pub(crate) errors: Vec<f64>,
    /// Fractions of the light of each patch that are reflected and transmitted as by a flat face.
    pub(crate) regular: [Vec<f64>; 2],
    /// Fraction of the light of each patch that is absorbed.
    pub(crate) absorbed: Vec<f64>,
    /// Of each replicate, as in [`AzimuthSums`].
    pub(crate) arriving: Vec<Vec<f64>>,
    /// Light of one ray of each patch in the means ([`crate::kernel::one_ray`]).
    pub(crate) one_ray: Vec<f64>,
}

impl AzimuthSums {
    pub(crate) fn new(patches: Patches, rays_of_band: u64) -> Self {
        let count = patches.count();
        Self {
            patches,
            rays_of_band,
            rows: Vec::new(),
            rays: vec![0.0; count],
            regular: vec![[0.0; 2]; count],
            absorbed: vec![0.0; count],
            light: vec![0.0; count * count],
            squares: vec![0.0; count * count],
            arriving: Vec::new(),
        }
    }

    /// Adds a replicate.
    pub(crate) fn add(&mut self, one: LightByAzimuth) {
        let patches = &self.patches;
        let count = patches.count();
        let reversed: Vec<usize> = (0..count).map(|patch| patches.reversed(patch)).collect();
        // Each ray of a band has this étendue.
        let rays = self.rays_of_band as f64 / patches.azimuths() as f64;
        let per_ray: Vec<f64> = (0..count).map(|patch| patches.area(patch) / rays).collect();
        let mut arriving = vec![0.0; count];
        let mut at = 0;
        for number in &one.packed {
            if *number < 0.0 {
                at += -number as usize;
                continue;
            }
            let (from, to) = (at / count, reversed[at % count]);
            let light = GRAIN * number;
            self.light[from * count + to] += light;
            self.squares[from * count + to] += light * light;
            arriving[to] += per_ray[from] * light;
            at += 1;
        }
        for from in 0..count {
            let [reflected, transmitted] = one.regular[from];
            arriving[reversed[from]] += per_ray[from] * reflected;
            if let Some(there) = patches.across(from) {
                arriving[reversed[there]] += per_ray[from] * transmitted;
            }
            // By reciprocity, what a patch absorbs is missing in the light that arrives at its reverse.
            arriving[from] += per_ray[from] * one.absorbed[from];
            self.rays[from] += one.rays[from];
            self.regular[from][0] += reflected;
            self.regular[from][1] += transmitted;
            self.absorbed[from] += one.absorbed[from];
        }
        self.arriving.push(arriving);
        self.rows.push(one.rows);
    }

    /// The means over all replicates, as fractions of the rays that each patch has.
    pub(crate) fn into_means(self) -> AzimuthMeans {
        let Self { patches, rays_of_band, rays, regular, absorbed, mut light, mut squares, arriving, .. } =
            self;
        let area: Vec<f64> = (0..patches.count()).map(|patch| patches.area(patch)).collect();
        let one_ray = one_ray(&area, rays_of_band as f64 / patches.azimuths() as f64);
        let count = REPLICATES as f64;
        let fraction = |light: f64, patch: usize| if rays[patch] > 0.0 { light / rays[patch] } else { 0.0 };
        let rows = light.chunks_exact_mut(patches.count()).zip(squares.chunks_exact_mut(patches.count()));
        for (patch, (light, squares)) in rows.enumerate() {
            let scale = patches.area(patch) * fraction(1.0, patch);
            for (light, square) in light.iter_mut().zip(squares) {
                let variance = (*square - *light * *light / count).max(0.0) * count / (count - 1.0);
                *light *= scale;
                *square = scale * variance.sqrt();
            }
        }
        let of =
            |way: usize| regular.iter().enumerate().map(|(patch, ways)| fraction(ways[way], patch)).collect();
        AzimuthMeans {
            regular: [of(0), of(1)],
            absorbed: absorbed.iter().enumerate().map(|(patch, light)| fraction(*light, patch)).collect(),
            patches,
            light,
            errors: squares,
            arriving,
            one_ray,
        }
    }
}

/// Directions of the rows by azimuth: side, inclination and azimuth of the light in degrees.
pub(crate) fn directions<'a>(
    incidence_deg: &'a [f64],
    patches: &'a Patches,
) -> impl Iterator<Item = (Side, f64, f64)> + 'a {
    Side::ALL.into_iter().flat_map(move |side| {
        incidence_deg
            .iter()
            .flat_map(move |theta| patches.phi_deg().into_iter().map(move |phi| (side, *theta, phi)))
    })
}
