//! The virtual goniometer: where a surface sends the light of an inclination, from either side.
//!
//! **Estimate.** Rays start uniformly over a period of the surface, with all azimuths: the result is that of
//! the surface turned about its normal, as for a lamp or a scan of all azimuths. Starts are Owen-scrambled
//! Sobol points.
//!
//! **Errors.** All numbers are means over [`REPLICATES`] independent replicates, and their standard errors
//! follow from the differences of these. A random surface has another realisation in each replicate, so that
//! its own variation is a part of the error.
//!
//! **Threads.** Replicates are independent: [`Goniometer::replicate`] may be called in any order on any
//! thread, and [`Goniometer::totals`] combines them. [`Measurement`](crate::Measurement) does so.

use std::f64::consts::PI;

use papilio_sampling::{SampleStream, Sampler};

use crate::bands::{AZIMUTHS, Bands};
use crate::by_azimuth::{BandByAzimuth, LightByAzimuth, directions};
use crate::measurement::on_threads;
use crate::patches::Patches;
use crate::path::{Facets, Leaves, follow};
use crate::ray::{Face, Ray, Side};
use crate::starts::{Tile, each_ray};
use crate::{Coating, Kernel, MicrogeometryError, Surface};

/// Number of replicates.
pub const REPLICATES: u64 = 32;

/// Light that may be lost by rounding, as a fraction of all: more is refused.
const MOST_LOST: f64 = 1e-6;

/// A virtual goniometer.
#[derive(Debug, Clone, PartialEq)]
pub struct Goniometer {
    /// Index of the medium above, 1 for air.
    pub index_above: f64,
    /// Index of the medium below.
    pub index_below: f64,
    /// What lies on every facet.
    pub coating: Coating,
    /// Inclinations of the light in its own medium, degrees, 0 to below 90.
    pub incidence_deg: Vec<f64>,
    /// Number of azimuths in a turn, even, by which light is measured as well; `None`: the surface is turned
    /// about its normal.
    pub azimuths: Option<usize>,
    /// Rays of each replicate for each inclination and side, and for each band of the kernel.
    pub rays: u64,
    /// Seed.
    pub seed: u64,
}

/// Where the light of an inclination goes.
#[derive(Debug, Clone, PartialEq)]
pub struct Total {
    /// Side from which the light comes.
    pub from: Side,
    /// Inclination of the light in its medium, degrees.
    pub theta_deg: f64,
    /// Azimuth of its propagation, degrees from x towards y; `None`: it has all azimuths.
    pub phi_deg: Option<f64>,
    /// Fraction that is reflected.
    pub reflected: Measured,
    /// Fraction that is reflected with |beta| above 1: towards directions that do not exist in air.
    pub reflected_beyond: Measured,
    /// Fraction that is transmitted.
    pub transmitted: Measured,
    /// Fraction that is transmitted with |beta| above 1.
    pub transmitted_beyond: Measured,
    /// Fraction that is reflected exactly as by a flat face; a part of `reflected`.
    pub regular_reflected: Measured,
    /// Fraction that is transmitted exactly as by a flat face; a part of `transmitted`.
    pub regular_transmitted: Measured,
    /// Fraction that is absorbed by facets.
    pub absorbed: Measured,
    /// Mean number of facets that light meets.
    pub mean_facets: Measured,
    /// Fraction that is transmitted within |beta| sin 2.5 deg of the normal; a part of `transmitted`.
    pub transmitted_near: Measured,
    /// Haze in air: of the transmitted light with |beta| up to 1, the fraction that is not
    /// `transmitted_near`.
    pub haze: Measured,
    /// Fraction that is transmitted within |beta| sin 2.5 deg of the direction behind a flat face, with
    /// |beta| up to 1; a part of `transmitted`.
    pub straight_near: Measured,
    /// Fraction that is reflected within |beta| sin 2.5 deg of the direction as from a flat face; a part of
    /// `reflected`.
    pub mirror_near: Measured,
    /// Of the transmitted light with |beta| up to 1, the fraction that is not `straight_near`.
    pub straight_haze: Measured,
    /// Of the reflected light, the fraction that is not `mirror_near`.
    pub mirror_haze: Measured,
}

impl Total {
    /// The means of a row of replicates: light of a side, an inclination and an azimuth.
    pub(crate) fn of(
        replicates: &[&[[f64; QUANTITIES]]],
        row: usize,
        (from, theta_deg, phi_deg): (Side, f64, Option<f64>),
    ) -> Self {
        let of = |quantity: usize| Measured::of(replicates.iter().map(move |rows| rows[row][quantity]));
        let haze = |near: usize, all: fn(&[f64; QUANTITIES]) -> f64| {
            Measured::of(replicates.iter().map(move |rows| {
                let (row, all) = (&rows[row], all(&rows[row]));
                if all > 0.0 { 1.0 - row[near] / all } else { 0.0 }
            }))
        };
        Self {
            from,
            theta_deg,
            phi_deg,
            reflected: of(0),
            reflected_beyond: of(1),
            transmitted: of(2),
            transmitted_beyond: of(3),
            regular_reflected: of(4),
            regular_transmitted: of(5),
            absorbed: of(8),
            mean_facets: of(6),
            transmitted_near: of(7),
            haze: haze(7, |[_, _, transmitted, beyond, ..]| transmitted - beyond),
            straight_near: of(9),
            mirror_near: of(10),
            straight_haze: haze(9, |[_, _, transmitted, beyond, ..]| transmitted - beyond),
            mirror_haze: haze(10, |[reflected, ..]| *reflected),
        }
    }
}

/// |beta| from the normal beyond which transmitted light is haze: that of 2.5 deg in air (ASTM D1003).
pub(crate) fn haze_beta() -> f64 {
    2.5_f64.to_radians().sin()
}

/// A mean over replicates.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Measured {
    /// The mean.
    pub value: f64,
    /// Its standard error.
    pub error: f64,
}

impl Measured {
    /// The mean of the values of replicates, and its standard error.
    pub fn of(values: impl Iterator<Item = f64> + Clone) -> Self {
        let count = values.clone().count() as f64;
        let mean = values.clone().sum::<f64>() / count;
        let squares: f64 = values.map(|value| (value - mean).powi(2)).sum();
        Self { value: mean, error: (squares / (count * (count - 1.0))).sqrt() }
    }
}

/// Sums of a replicate.
#[derive(Debug, Clone, PartialEq)]
pub struct Replicate {
    /// Of each side and inclination: the quantities of [`Total`] in their order.
    rows: Vec<[f64; QUANTITIES]>,
    /// Light of bands that is scattered to others, `[from][to][azimuth]`.
    pub(crate) scattered: Vec<f64>,
    /// Light of bands that is reflected and transmitted as by a flat face.
    pub(crate) regular: Vec<[f64; 2]>,
    /// Light of bands that is absorbed.
    pub(crate) absorbed: Vec<f64>,
    /// Light that was lost, and rays.
    pub(crate) lost: f64,
    pub(crate) rays: u64,
    /// Light by azimuth, if it is measured.
    pub(crate) by_azimuth: Option<LightByAzimuth>,
}

/// Number of quantities of a row.
pub(crate) const QUANTITIES: usize = 11;

impl Replicate {
    /// Rays that were followed.
    pub fn rays(&self) -> u64 {
        self.rays
    }

    /// All of it as numbers, for [`Goniometer::replicate_of`].
    pub(crate) fn numbers(&self) -> Vec<f64> {
        let Self { rows, scattered, regular, absorbed, lost, rays, by_azimuth } = self;
        let parts = [rows.as_flattened(), scattered, regular.as_flattened(), absorbed];
        let by_azimuth = by_azimuth.as_ref().map(LightByAzimuth::numbers).unwrap_or_default();
        [&parts.concat()[..], &[*lost, *rays as f64], &by_azimuth].concat()
    }
}

impl Goniometer {
    /// Follows the rays of a replicate, `number` from 0 to [`REPLICATES`]. `stop` is called often; true
    /// interrupts.
    ///
    /// # Errors
    /// Surfaces that cannot be made; [`MicrogeometryError::Interrupted`].
    pub fn replicate(
        &self,
        surface: &Surface,
        number: u64,
        stop: &dyn Fn() -> bool,
    ) -> Result<Replicate, MicrogeometryError> {
        for (what, value) in [("index above", self.index_above), ("index below", self.index_below)] {
            if !(value.is_finite() && value > 0.0) {
                return Err(MicrogeometryError::NotANumber {
                    of: "a surface",
                    what,
                    value,
                    wanted: "positive",
                });
            }
        }
        self.coating.check()?;
        let patches = self.patches()?;
        surface.with_face(number, |face| {
            let bands = self.bands();
            let mut found = self.nothing();
            found.by_azimuth = patches
                .as_ref()
                .map(|patches| self.rows_by_azimuth(face, patches, (&mut found, number), stop))
                .transpose()?;
            let numbers = SampleStream::new(Sampler::Sobol, self.seed, number).independent();
            // By azimuth, each ray has the same weight, and a band is packed before the next one.
            let tiles: Vec<Tile> = match &patches {
                Some(_) => vec![Tile::whole(self.rays)],
                None => Tile::all(face, self.rays).collect(),
            };
            for tile in tiles {
                self.rows((face, tile), number, &mut found, stop)?;
                for band in 0..bands.count() {
                    let mut by_azimuth = patches.as_ref().map(|patches| BandByAzimuth::new(patches, band));
                    let numbers = numbers.part(band as u64);
                    self.scatter(
                        (face, tile),
                        (&bands, band),
                        &numbers,
                        (&mut found, by_azimuth.as_mut()),
                        stop,
                    )?;
                    if let (Some(all), Some(one)) = (&mut found.by_azimuth, &by_azimuth) {
                        all.add(one);
                    }
                }
            }
            Ok(found)
        })?
    }

    /// A replicate without rays.
    fn nothing(&self) -> Replicate {
        let count = self.bands().count();
        Replicate {
            rows: vec![[0.0; QUANTITIES]; 2 * self.incidence_deg.len()],
            scattered: vec![0.0; count * count * AZIMUTHS],
            regular: vec![[0.0; 2]; count],
            absorbed: vec![0.0; count],
            lost: 0.0,
            rays: 0,
            by_azimuth: None,
        }
    }

    /// Rays of the inclinations from a tile, without the light of bands.
    fn rows(
        &self,
        (face, tile): (&dyn Face, Tile),
        number: u64,
        found: &mut Replicate,
        stop: &dyn Fn() -> bool,
    ) -> Result<(), MicrogeometryError> {
        let numbers = SampleStream::new(Sampler::Sobol, self.seed, number);
        let directions =
            Side::ALL.into_iter().flat_map(|side| self.incidence_deg.iter().map(move |deg| (side, *deg)));
        for (at, (side, theta_deg)) in directions.enumerate() {
            let (sums, lost) =
                self.row((face, tile), (side, theta_deg, None), &numbers.part(at as u64), stop)?;
            found.lost += lost;
            found.rays += tile.rays();
            found.rows[at].iter_mut().zip(sums).for_each(|(all, sum)| *all += sum);
        }
        Ok(())
    }

    /// The inclinations by azimuth, which have their share of the rays of an inclination each.
    fn rows_by_azimuth(
        &self,
        face: &dyn Face,
        patches: &Patches,
        (found, number): (&mut Replicate, u64),
        stop: &dyn Fn() -> bool,
    ) -> Result<LightByAzimuth, MicrogeometryError> {
        let tile = Tile::whole(self.rays.div_ceil(patches.azimuths() as u64));
        let numbers = SampleStream::new(Sampler::Sobol, self.seed, number).part(ROWS_BY_AZIMUTH);
        let mut all = LightByAzimuth::default();
        for (side, theta_deg, phi_deg) in directions(&self.incidence_deg, patches) {
            let numbers = numbers.part(all.rows.len() as u64);
            let (row, lost) = self.row((face, tile), (side, theta_deg, Some(phi_deg)), &numbers, stop)?;
            found.lost += lost;
            found.rays += tile.rays();
            all.rows.push(row);
        }
        Ok(all)
    }

    /// The totals of a surface, without its kernel.
    #[cfg(test)]
    pub(crate) fn totals_alone(&self, surface: &Surface) -> Vec<Total> {
        let replicate = |number| {
            let rows = |face: &dyn Face| {
                let mut found = self.nothing();
                Tile::all(face, self.rays)
                    .for_each(|tile| self.rows((face, tile), number, &mut found, &|| false).unwrap());
                found
            };
            surface.with_face(number, rows).unwrap()
        };
        let found: Vec<Replicate> = (0..REPLICATES).map(replicate).collect();
        self.totals(&found).unwrap()
    }

    /// Follows the rays of all replicates on all processors. `stop` as in [`replicate`](Self::replicate);
    /// `finished` is called after each replicate.
    ///
    /// # Errors
    /// As [`replicate`](Self::replicate).
    pub fn replicates(
        &self,
        surface: &Surface,
        stop: &(dyn Fn() -> bool + Sync),
        finished: &(dyn Fn() + Sync),
    ) -> Result<Vec<Replicate>, MicrogeometryError> {
        on_threads(REPLICATES as usize, None, &|number| {
            let replicate = self.replicate(surface, number as u64, &stop)?;
            finished();
            Ok(replicate)
        })
    }

    /// The replicate with these [`numbers`](Replicate::numbers); `None` if their count is wrong.
    pub(crate) fn replicate_of(&self, numbers: &[f64]) -> Option<Replicate> {
        let count = self.bands().count();
        let (rows, rest) = numbers.split_at_checked(2 * self.incidence_deg.len() * QUANTITIES)?;
        let (scattered, rest) = rest.split_at_checked(count * count * AZIMUTHS)?;
        let (regular, rest) = rest.split_at_checked(2 * count)?;
        let (absorbed, rest) = rest.split_at_checked(count)?;
        let (&[lost, rays], rest) = rest.split_first_chunk()?;
        let by_azimuth = match self.patches().ok()? {
            Some(patches) => {
                Some(LightByAzimuth::of(&patches, 2 * self.incidence_deg.len() * patches.azimuths(), rest)?)
            }
            None if rest.is_empty() => None,
            None => return None,
        };
        Some(Replicate {
            rows: rows.as_chunks().0.to_vec(),
            scattered: scattered.to_vec(),
            regular: regular.as_chunks().0.to_vec(),
            absorbed: absorbed.to_vec(),
            lost,
            rays: rays as u64,
            by_azimuth,
        })
    }

    /// Follows light that fills the directions of a band uniformly.
    fn scatter(
        &self,
        (face, tile): (&dyn Face, Tile),
        (bands, from): (&Bands, usize),
        numbers: &SampleStream,
        (found, mut by_azimuth): (&mut Replicate, Option<&mut BandByAzimuth<'_>>),
        stop: &dyn Fn() -> bool,
    ) -> Result<(), MicrogeometryError> {
        let (side, [least, most]) = bands.band(from);
        let index = self.index_of(side);
        let weight_of_ray = 1.0 / tile.equivalent_rays();
        let Replicate { scattered, regular, absorbed, lost, rays, .. } = found;
        let row = &mut scattered[from * bands.count() * AZIMUTHS..][..bands.count() * AZIMUTHS];
        let begin = |[x, y, azimuth, u]: [f64; 4]| {
            let sine = (least * least + u * (most * most - least * least)).sqrt() / index;
            let cosine = ((1.0 - sine) * (1.0 + sine)).sqrt();
            start(face, side, [sine, cosine], [x, y], azimuth)
        };
        each_ray(face, tile, numbers, stop, begin, &mut |path, ray| {
            let came = [ray.along[0], ray.along[1]];
            if let Some(by_azimuth) = &mut by_azimuth {
                by_azimuth.begin(came);
            }
            let stays = follow(face, self.facets(), ray, side, (numbers, path), &mut |leaves| {
                let Leaves { side: to, along, weight, regular: is_regular, .. } = leaves;
                if is_regular {
                    regular[from][usize::from(to != side)] += weight * weight_of_ray;
                    if let Some(by_azimuth) = &mut by_azimuth {
                        by_azimuth.regular(to != side, weight);
                    }
                    return;
                }
                let length = (along[0] * along[0] + along[1] * along[1]).sqrt();
                let turned = (came[0] * along[1] - came[1] * along[0]).abs();
                let turn = turned.atan2(came[0] * along[0] + came[1] * along[1]) / PI;
                let azimuth = ((turn * AZIMUTHS as f64) as usize).min(AZIMUTHS - 1);
                let band = bands.number(to, self.index_of(to) * length);
                row[band * AZIMUTHS + azimuth] += weight * weight_of_ray;
                if let Some(by_azimuth) = &mut by_azimuth {
                    by_azimuth.scatter(band, [along[0], along[1]], weight);
                }
            });
            *lost += stays.lost;
            if let Some(by_azimuth) = &mut by_azimuth {
                by_azimuth.absorb(stays.absorbed);
            }
            absorbed[from] += stays.absorbed * weight_of_ray;
        })?;
        *rays += tile.rays();
        Ok(())
    }

    /// Bands of the kernel.
    fn bands(&self) -> Bands {
        Bands::new(self.index())
    }

    /// Patches of the kernel by azimuth, if it is asked for.
    ///
    /// # Errors
    /// Azimuths that cannot be measured.
    pub fn patches(&self) -> Result<Option<Patches>, MicrogeometryError> {
        self.azimuths.map(|azimuths| Patches::new(self.bands(), azimuths)).transpose()
    }

    /// The kernel of the surface: light from all directions to all directions, on both sides.
    ///
    /// # Errors
    /// If rays were lost, or contradict reciprocity or the conservation of energy by more than three standard
    /// errors.
    pub fn kernel(&self, replicates: &[Replicate]) -> Result<Kernel, MicrogeometryError> {
        Kernel::new(&self.bands(), replicates, self.rays)
    }

    /// The quantities of an inclination, and the light that was lost, in rays.
    fn row(
        &self,
        (face, tile): (&dyn Face, Tile),
        (side, theta_deg, phi_deg): (Side, f64, Option<f64>),
        numbers: &SampleStream,
        stop: &dyn Fn() -> bool,
    ) -> Result<([f64; QUANTITIES], f64), MicrogeometryError> {
        let (sine, cosine) = theta_deg.to_radians().sin_cos();
        let mut sums = [0.0; QUANTITIES];
        let mut lost = 0.0;
        let near = haze_beta();
        let begin = |[x, y, azimuth, _]: [f64; 4]| {
            start(face, side, [sine, cosine], [x, y], phi_deg.map_or(azimuth, |deg| deg / 360.0))
        };
        each_ray(face, tile, numbers, stop, begin, &mut |path, ray| {
            let stays = follow(face, self.facets(), ray, side, (numbers, path), &mut |leaves| {
                let Leaves { side: to, along, weight, regular, facets } = leaves;
                let beta = self.index_of(to) * (along[0] * along[0] + along[1] * along[1]).sqrt();
                let first = if to == side { 0 } else { 2 };
                sums[first] += weight;
                sums[first + 1] += if beta > 1.0 { weight } else { 0.0 };
                sums[4 + first / 2] += if regular { weight } else { 0.0 };
                sums[6] += weight * f64::from(facets);
                sums[7] += if to != side && beta <= near { weight } else { 0.0 };
                let from_regular =
                    [0, 1].map(|k| self.index_of(to) * along[k] - self.index_of(side) * ray.along[k]);
                let is_near =
                    from_regular[0] * from_regular[0] + from_regular[1] * from_regular[1] <= near * near;
                sums[9] += if to != side && is_near && beta <= 1.0 { weight } else { 0.0 };
                sums[10] += if to == side && is_near { weight } else { 0.0 };
            });
            lost += stays.lost;
            sums[6] += stays.absorbed_facets;
            sums[8] += stays.absorbed;
        })?;
        Ok((sums.map(|sum| sum / tile.equivalent_rays()), lost))
    }

    /// Combines replicates.
    ///
    /// # Errors
    /// If rays were lost.
    pub fn totals(&self, replicates: &[Replicate]) -> Result<Vec<Total>, MicrogeometryError> {
        let lost: f64 = replicates.iter().map(|one| one.lost).sum();
        let rays: u64 = replicates.iter().map(|one| one.rays).sum();
        if lost > MOST_LOST * rays as f64 {
            return Err(MicrogeometryError::LostRays { lost: lost.ceil() as u64, rays });
        }
        let directions =
            Side::ALL.into_iter().flat_map(|from| self.incidence_deg.iter().map(move |deg| (from, *deg)));
        let rows: Vec<&[[f64; QUANTITIES]]> = replicates.iter().map(|one| &one.rows[..]).collect();
        let total = |(row, (from, theta_deg))| Total::of(&rows, row, (from, theta_deg, None));
        Ok(directions.enumerate().map(total).collect())
    }

    /// What all facets have in common.
    fn facets(&self) -> Facets<'_> {
        Facets { index: self.index(), coating: &self.coating }
    }

    /// Indices above and below.
    fn index(&self) -> [f64; 2] {
        [self.index_above, self.index_below]
    }

    /// Index of a side.
    pub fn index_of(&self, side: Side) -> f64 {
        match side {
            Side::Above => self.index_above,
            Side::Below => self.index_below,
        }
    }
}

/// Part of the random numbers of inclinations by azimuth.
const ROWS_BY_AZIMUTH: u64 = 0x617a_696d_7574_6873;

/// A ray at a place of the period, 0 to 1 along x and y, just outside of all heights.
pub(crate) fn start(
    face: &dyn Face,
    side: Side,
    [sine, cosine]: [f64; 2],
    [x, y]: [f64; 2],
    azimuth: f64,
) -> Ray {
    let period = face.period_um();
    let [lowest, highest] = face.heights_um();
    let (sin_phi, cos_phi) = (std::f64::consts::TAU * azimuth).sin_cos();
    let (height, up) = match side {
        Side::Above => (highest, -cosine),
        Side::Below => (lowest, cosine),
    };
    Ray { at: [x * period[0], y * period[1], height], along: [sine * cos_phi, sine * sin_phi, up] }
}
