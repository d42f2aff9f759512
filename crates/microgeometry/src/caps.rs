//! Spherical caps on a flat face: bumps of the medium below, up to hemispheres.
//!
//! Each cap is the part of a ball above the face; the balls reach no higher than their middles below it. The
//! medium below is what lies under the face or in a ball: caps that overlap form their union. Rays are
//! followed through the squares of a grid, each of which knows the caps that overlap it.

use std::f64::consts::PI;

use papilio_sampling::{SampleStream, Sampler};

use crate::ray::{Face, Met, Ray, Side, dot, moved};
use crate::{HeightMap, MicrogeometryError};

/// Fewest heights along a side of a period, and of the square of a cap.
const LEAST_SAMPLES: usize = 512;
const SAMPLES_OF_CAP: usize = 32;

/// Squares that a ray may cross before it counts as lost.
const MOST_SQUARES: usize = 1_000_000;

/// Largest radius of the rims of random caps, in pitches: 200 caps overlap each place.
const MOST_APERTURE: f64 = 8.0;

/// Way, relative to the radius, by which a ray on a ball may be off by rounding.
const ROUNDING: f64 = 1e-10;

/// Lowest cap over the radius of its ball: a thousand times the rounding error of a place on it.
const FLATTEST: f64 = 1e3 * ROUNDING;

/// Where caps stand.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lattice {
    /// On squares with sides of one pitch.
    Square,
    /// On triangles with sides of one pitch.
    Hexagonal,
    /// At random places, as many as on squares; caps may overlap.
    Random {
        /// Seed of the places.
        seed: u64,
    },
}

/// Spherical caps on a flat face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Caps {
    /// Distance of neighbours in a lattice, um.
    pub pitch_um: f64,
    /// Radius of the balls, um.
    pub radius_um: f64,
    /// Radius of the rim of a cap, um, up to that of the ball: a hemisphere.
    pub aperture_um: f64,
    /// Where they stand.
    pub lattice: Lattice,
}

/// Fewest and most caps along each side of the period of random places.
const RANDOM_SIDE: [usize; 2] = [64, 128];

/// Caps of a period, sorted into a grid.
#[derive(Debug)]
pub(crate) struct Balls {
    period_um: [f64; 2],
    /// Squares of the grid along x and y.
    squares: [usize; 2],
    radius_um: f64,
    /// Depth of the middles below the face, um.
    depth_um: f64,
    /// Middles of the caps that overlap each square, um; those of neighbouring periods, too.
    in_square: Vec<Vec<[f64; 2]>>,
}

impl Balls {
    /// Places the caps. Random places are another set for each replicate.
    pub(crate) fn new(caps: &Caps, replicate: u64) -> Result<Self, MicrogeometryError> {
        Self::over(caps, replicate, 0.0)
    }

    /// Places the caps; random ones over a period that is at least this long, um, as far as the largest
    /// number of caps allows.
    pub(crate) fn over(caps: &Caps, replicate: u64, least_um: f64) -> Result<Self, MicrogeometryError> {
        let Caps { pitch_um, radius_um, aperture_um, lattice } = *caps;
        for (what, value) in
            [("pitch (um)", pitch_um), ("radius (um)", radius_um), ("aperture radius (um)", aperture_um)]
        {
            if !(value.is_finite() && value > 0.0) {
                return Err(MicrogeometryError::NotANumber { of: "caps", what, value, wanted: "positive" });
            }
        }
        if aperture_um > radius_um * (1.0 + ROUNDING) {
            return Err(MicrogeometryError::ApertureBeyondRadius { aperture_um, radius_um });
        }
        let overlap = 2.0 * aperture_um > pitch_um * (1.0 + ROUNDING);
        if overlap && !matches!(lattice, Lattice::Random { .. }) {
            return Err(MicrogeometryError::CapsOverlap { aperture_um, pitch_um });
        }
        if aperture_um > MOST_APERTURE * pitch_um {
            let overlaps = PI * (aperture_um / pitch_um).powi(2);
            let wrong = format!(
                "random caps with an aperture radius of {aperture_um} um and a `pitch_um` of {pitch_um} overlap {overlaps:.0} times everywhere \
                 (expected a `pitch_um` of at least {})",
                aperture_um / MOST_APERTURE
            );
            return Err(MicrogeometryError::RandomFace { wrong });
        }
        let (period_um, squares, middles) = match lattice {
            Lattice::Square => ([pitch_um; 2], [1; 2], vec![[0.5 * pitch_um; 2]]),
            Lattice::Hexagonal => {
                let height = 3_f64.sqrt() * pitch_um;
                let middles = vec![[0.25 * pitch_um, 0.25 * height], [0.75 * pitch_um, 0.75 * height]];
                ([pitch_um, height], [1, 2], middles)
            }
            Lattice::Random { seed } => {
                let numbers = SampleStream::new(Sampler::Random, seed, replicate);
                let wanted = (least_um / pitch_um).ceil() as usize;
                let count = wanted.clamp(RANDOM_SIDE[0], RANDOM_SIDE[1]);
                let side = count as f64 * pitch_um;
                let place = |cap: usize| {
                    let [x, y, ..] = numbers.block(cap as u64, 0);
                    [side * x, side * y]
                };
                ([side; 2], [count; 2], (0..count * count).map(place).collect())
            }
        };
        let mut in_square = vec![Vec::new(); squares[0] * squares[1]];
        let size = [0, 1].map(|k| period_um[k] / squares[k] as f64);
        for middle in middles {
            // The squares that the rim of the cap may reach, in any period.
            let range = |k: usize| {
                let first = ((middle[k] - aperture_um) / size[k]).floor() as i64;
                first..=((middle[k] + aperture_um) / size[k]).floor() as i64
            };
            for (row, column) in range(1).flat_map(|row| range(0).map(move |column| (row, column))) {
                let nearest = |k: usize, at: i64| {
                    middle[k].clamp(at as f64 * size[k], (at + 1) as f64 * size[k]) - middle[k]
                };
                if nearest(0, column).hypot(nearest(1, row)) > aperture_um {
                    continue;
                }
                let wrapped = [column.rem_euclid(squares[0] as i64), row.rem_euclid(squares[1] as i64)];
                let moved = [column - wrapped[0], row - wrapped[1]];
                let there = [0, 1].map(|k| middle[k] - moved[k] as f64 * size[k]);
                in_square[wrapped[1] as usize * squares[0] + wrapped[0] as usize].push(there);
            }
        }
        let depth_um = ((radius_um - aperture_um).max(0.0) * (radius_um + aperture_um)).sqrt();
        let high_um = aperture_um.powi(2) / (radius_um + depth_um);
        if high_um < FLATTEST * radius_um {
            return Err(MicrogeometryError::FlatCaps {
                aperture_um,
                radius_um,
                most_um: aperture_um / (2.0 * FLATTEST).sqrt(),
            });
        }
        Ok(Self { period_um, squares, radius_um, depth_um, in_square })
    }

    /// Heights of a period, at the middles of square numbers of cells.
    pub(crate) fn sampled(&self) -> Result<HeightMap, MicrogeometryError> {
        let side = LEAST_SAMPLES.max(SAMPLES_OF_CAP * self.squares[0].max(self.squares[1]));
        let pitch = self.period_um.map(|period| period / side as f64);
        let size = [0, 1].map(|k| self.period_um[k] / self.squares[k] as f64);
        let height = |at: usize| {
            let place = [(at % side) as f64 + 0.5, (at / side) as f64 + 0.5];
            let place = [0, 1].map(|k| place[k] * pitch[k]);
            let square = [0, 1].map(|k| ((place[k] / size[k]) as usize).min(self.squares[k] - 1));
            let caps = self.in_square[square[1] * self.squares[0] + square[0]].iter();
            let cap = |middle: &[f64; 2]| {
                let away = [0, 1].map(|k| place[k] - middle[k]);
                let below = self.radius_um * self.radius_um - away[0] * away[0] - away[1] * away[1];
                below.max(0.0).sqrt() - self.depth_um
            };
            caps.map(cap).fold(0.0, f64::max)
        };
        HeightMap::new(side, pitch, (0..side * side).map(height).collect())
    }

    /// Ways at which a line enters and leaves the ball around a middle.
    fn within(&self, ray: &Ray, middle: [f64; 2], offset: [f64; 2]) -> Option<([f64; 2], [f64; 3])> {
        let centre = [middle[0] + offset[0], middle[1] + offset[1], -self.depth_um];
        let from = [0, 1, 2].map(|k| ray.at[k] - centre[k]);
        let b = dot(from, ray.along);
        // The distance of the line from the middle: exact for rays that start far away.
        let nearest = moved(from, -b, ray.along);
        let half = self.radius_um * self.radius_um - dot(nearest, nearest);
        (half > 0.0).then(|| ([-b - half.sqrt(), -b + half.sqrt()], centre))
    }

    /// The first ball or the face that a ray in the medium above enters on the way through a square.
    fn entered(&self, ray: &Ray, caps: &[[f64; 2]], offset: [f64; 2], ways: [f64; 2]) -> Option<Met> {
        let tiny = ROUNDING * self.radius_um;
        let mut first: Option<(f64, Option<[f64; 3]>)> = None;
        let mut consider = |way: f64, centre: Option<[f64; 3]>| {
            if way > tiny && way <= ways[1] + tiny && first.is_none_or(|(known, _)| way < known) {
                first = Some((way, centre));
            }
        };
        if ray.along[2] < 0.0 {
            consider(-ray.at[2] / ray.along[2], None);
        }
        for middle in caps {
            if let Some(([enters, _], centre)) = self.within(ray, *middle, offset) {
                // Below the face the ball is not a surface.
                if ray.at[2] + enters * ray.along[2] >= -tiny {
                    consider(enters, Some(centre));
                }
            }
        }
        first.map(|(way, centre)| self.facet(ray, way, centre))
    }

    /// Where a ray in the medium below leaves it on the way through a square.
    fn left(&self, ray: &Ray, caps: &[[f64; 2]], offset: [f64; 2], ways: [f64; 2]) -> Option<Met> {
        let tiny = ROUNDING * self.radius_um;
        // The interval of the half space, and those of the balls.
        let mut within: Vec<([f64; 2], Option<[f64; 3]>)> = Vec::with_capacity(caps.len() + 1);
        let meets = -ray.at[2] / ray.along[2];
        within.push(match ray.along[2] > 0.0 {
            true => ([f64::NEG_INFINITY, meets], None),
            false if ray.along[2] < 0.0 => ([meets, f64::INFINITY], None),
            // Along the face.
            false => {
                ([f64::NEG_INFINITY, if ray.at[2] <= 0.0 { f64::INFINITY } else { f64::NEG_INFINITY }], None)
            }
        });
        let balls = caps.iter().filter_map(|middle| self.within(ray, *middle, offset));
        within.extend(balls.map(|(ways, centre)| (ways, Some(centre))));
        let mut at = (ways[0], None);
        loop {
            let further = within.iter().find(|([from, to], _)| *from <= at.0 + tiny && *to > at.0 + tiny);
            match further {
                Some(([_, to], _)) if *to >= ways[1] => return None,
                Some(([_, to], of)) => at = (*to, Some(*of)),
                None => break,
            }
        }
        match at.1 {
            Some(centre) => Some(self.facet(ray, at.0, centre)),
            // It starts on the surface, and leaves at once: the nearest end of an interval.
            None => {
                let ends = within.iter().filter(|([_, to], _)| (*to - ways[0]).abs() <= 1e3 * tiny);
                let nearest =
                    ends.min_by(|a, b| (a.0[1] - ways[0]).abs().total_cmp(&(b.0[1] - ways[0]).abs()));
                Some(nearest.map_or(Met::Unknown, |([_, to], of)| self.facet(ray, to.max(0.0), *of)))
            }
        }
    }

    fn facet(&self, ray: &Ray, way: f64, centre: Option<[f64; 3]>) -> Met {
        let at = moved(ray.at, way, ray.along);
        match centre {
            None => Met::Facet { at: [at[0], at[1], 0.0], normal: [0.0, 0.0, 1.0] },
            Some(centre) => {
                let normal = [0, 1, 2].map(|k| (at[k] - centre[k]) / self.radius_um);
                Met::Facet { at, normal }
            }
        }
    }
}

impl Face for Balls {
    fn period_um(&self) -> [f64; 2] {
        self.period_um
    }

    fn heights_um(&self) -> [f64; 2] {
        [0.0, self.radius_um - self.depth_um]
    }

    fn next(&self, ray: &Ray, side: Side) -> Met {
        let top = self.heights_um()[1];
        let tiny = ROUNDING * self.radius_um;
        let end = match side {
            Side::Above if ray.along[2] > 0.0 => (top - ray.at[2]) / ray.along[2],
            Side::Below if ray.along[2] < 0.0 => -ray.at[2] / ray.along[2],
            _ => f64::INFINITY,
        };
        if end <= 0.0 {
            return Met::Nothing;
        }
        let size = [0, 1].map(|k| self.period_um[k] / self.squares[k] as f64);
        let mut square = [0, 1].map(|k| (ray.at[k] / size[k]).floor() as i64);
        let line = |k: usize, number: i64| {
            if ray.along[k] == 0.0 {
                return f64::INFINITY;
            }
            let next = number + i64::from(ray.along[k] > 0.0);
            (next as f64 * size[k] - ray.at[k]) / ray.along[k]
        };
        let mut ways = [0.0_f64, 0.0];
        for _ in 0..MOST_SQUARES {
            let lines = [line(0, square[0]), line(1, square[1])];
            ways[1] = lines[0].min(lines[1]).max(ways[0]);
            let counts = self.squares.map(|count| count as i64);
            let wrapped = [0, 1].map(|k| square[k].rem_euclid(counts[k]));
            let offset = [0, 1].map(|k| (square[k] - wrapped[k]) as f64 * size[k]);
            let caps = &self.in_square[(wrapped[1] * counts[0] + wrapped[0]) as usize];
            let met = match side {
                Side::Above => self.entered(ray, caps, offset, ways),
                Side::Below => self.left(ray, caps, offset, ways),
            };
            if let Some(met) = met {
                return met;
            }
            if ways[1] >= end - tiny {
                return Met::Nothing;
            }
            let axis = usize::from(lines[1] < lines[0]);
            square[axis] += if ray.along[axis] > 0.0 { 1 } else { -1 };
            ways[0] = ways[1];
        }
        Met::Unknown
    }
}
