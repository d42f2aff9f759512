//! Spheres and fibres in a slab of a clear matrix.
//!
//! **Geometry.** Particles are placed at random, one after another; one that would overlap another is placed
//! again (random sequential addition). All lie wholly within the slab, which repeats along x and y. A fibre
//! is a cylinder with hemispherical ends, of random direction. The faces of the slab are not surfaces: the
//! media above and below are the matrix.
//!
//! **Validity.** Particles much larger than a wavelength, and apart from each other by more than one.

use papilio_sampling::{SampleStream, Sampler};

use crate::MicrogeometryError;
use crate::grid::{Bounds, Grid, Walked};
use crate::ray::{Face, Met, Ray, Side, dot, moved};

/// Way, relative to the radius, by which a ray on a particle may be off by rounding.
const ROUNDING: f64 = 1e-10;

/// Particles of a period.
const PARTICLES: f64 = 1000.0;

/// Smallest period, in lengths of a particle.
const LEAST_PERIOD: f64 = 4.0;

/// Largest period, in lengths of a particle: beyond it, places are rounded by more than [`ROUNDING`] of a
/// particle.
const MOST_PERIOD: f64 = 1e5;

/// Cells in which touching particles are searched.
const MOST_CELLS: f64 = 1e6;

/// Most particles of a period.
const MOST_PARTICLES: f64 = 200_000.0;

/// Places that are tried for a particle.
const MOST_TRIES: u32 = 20_000;

/// Particles in a slab.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Volume {
    /// Radius of the spheres or fibres, um.
    pub radius_um: f64,
    /// Length of the axis of a fibre between the middles of its ends, um; 0 for spheres.
    pub length_um: f64,
    /// Index of the particles.
    pub index: f64,
    /// Fraction of the slab that they fill.
    pub volume_fraction: f64,
    /// Thickness of the slab, um.
    pub thickness_um: f64,
    /// Seed of their places.
    pub seed: u64,
}

impl Volume {
    /// Volume of a particle, um³.
    pub fn particle_um3(&self) -> f64 {
        std::f64::consts::PI * self.radius_um * self.radius_um * (4.0 / 3.0 * self.radius_um + self.length_um)
    }

    /// Smallest size parameter of the particles in a matrix, `2 pi r n/λ`.
    pub fn size_parameter(&self, matrix_index: f64, wavelength_nm: f64) -> f64 {
        std::f64::consts::TAU * 1e3 * self.radius_um * matrix_index / wavelength_nm
    }

    /// Fails for quantities that contradict each other.
    pub(crate) fn check(&self) -> Result<(), MicrogeometryError> {
        let Self { radius_um, length_um, index, volume_fraction, thickness_um, .. } = *self;
        let positive = [
            ("radius (um)", radius_um),
            ("index of the particles", index),
            ("volume fraction", volume_fraction),
            ("thickness (um)", thickness_um),
            ("length (um)", length_um + f64::MIN_POSITIVE),
        ];
        for (what, value) in positive {
            if !(value.is_finite() && value > 0.0) {
                return Err(MicrogeometryError::NotANumber {
                    of: "a volume",
                    what,
                    value,
                    wanted: "positive",
                });
            }
        }
        if 2.0 * radius_um >= thickness_um {
            return Err(wrong(format!(
                "particles with a diameter of {} um do not fit into a slab of {thickness_um} um (expected a larger `thickness_um`)",
                2.0 * radius_um
            )));
        }
        let length = length_um + 2.0 * radius_um;
        let period_um = self.period_um();
        if period_um.is_nan() || period_um > MOST_PERIOD * length {
            let least = PARTICLES * self.particle_um3() / (thickness_um * (MOST_PERIOD * length).powi(2));
            return Err(wrong(format!(
                "a volume fraction of {volume_fraction:e} leaves {:e} um between particles, too far for rays to meet them (expected a `volume_fraction` \
                 of at least {least:.1e}, or no particles)",
                self.period_um() / PARTICLES.sqrt()
            )));
        }
        let count = self.period_um().powi(2) * thickness_um * volume_fraction / self.particle_um3();
        if count.is_nan() || count > MOST_PARTICLES {
            return Err(wrong(format!(
                "a period would have {count:.0} particles (expected at most {MOST_PARTICLES}): a thinner slab, or shorter fibres"
            )));
        }
        Ok(())
    }

    /// Side of the square that repeats, um.
    fn period_um(&self) -> f64 {
        let length = self.length_um + 2.0 * self.radius_um;
        let area = PARTICLES * self.particle_um3() / (self.volume_fraction * self.thickness_um);
        area.sqrt().max(LEAST_PERIOD * length)
    }
}

fn wrong(wrong: String) -> MicrogeometryError {
    MicrogeometryError::Volume { wrong }
}

/// The axis of a particle: from a place along a vector. Spheres have none.
#[derive(Debug, Clone, Copy)]
struct Axis {
    from: [f64; 3],
    along: [f64; 3],
}

/// Particles of a period.
#[derive(Debug)]
pub(crate) struct Particles {
    radius_um: f64,
    index: f64,
    thickness_um: f64,
    axes: Vec<Axis>,
    grid: Grid,
}

impl Particles {
    /// Places the particles: others for each replicate.
    pub(crate) fn new(volume: &Volume, replicate: u64) -> Result<Self, MicrogeometryError> {
        volume.check()?;
        let Volume { radius_um, length_um, volume_fraction, thickness_um, .. } = *volume;
        let period = volume.period_um();
        let wanted = period * period * thickness_um * volume_fraction / volume.particle_um3();
        let numbers = SampleStream::new(Sampler::Random, volume.seed, replicate);
        // The mean number of particles is that of the fraction.
        let [chance, ..] = numbers.block(0, 0);
        let count = (wanted + chance).floor() as usize;
        let mut cells = Neighbours::new(period, thickness_um, length_um + 2.0 * radius_um);
        let mut axes: Vec<Axis> = Vec::with_capacity(count);
        for particle in 0..count {
            let axis = (0..MOST_TRIES).find_map(|attempt| {
                let number = |which: u32| numbers.block(particle as u64 + 1, 2 * attempt + which);
                let axis =
                    placed(number(0), if length_um > 0.0 { number(1) } else { [0.0; 4] }, volume, period);
                let fits = is_within(&axis, radius_um, thickness_um)
                    && cells
                        .near(&axis)
                        .all(|other| apart(&axis, &axes[other], period) >= 4.0 * radius_um * radius_um);
                fits.then_some(axis)
            });
            let Some(axis) = axis else {
                let placed = axes.len() as f64 * volume.particle_um3() / (period * period * thickness_um);
                return Err(wrong(format!(
                    "particles that fill {volume_fraction} of the slab cannot be placed one by one at random: the slab was full at {placed:.3} \
                     (expected a lower `volume_fraction`; spheres in a thick slab reach 0.38)"
                )));
            };
            cells.add(&axis, axes.len());
            axes.push(axis);
        }
        let bounds = |axis: &Axis| -> Bounds {
            let end = moved(axis.from, 1.0, axis.along);
            let of = |sign: f64, pick: fn(f64, f64) -> f64| {
                [0, 1, 2].map(|k| pick(axis.from[k], end[k]) + sign * radius_um)
            };
            [of(-1.0, f64::min), of(1.0, f64::max)]
        };
        let boxes: Vec<Bounds> = axes.iter().map(bounds).collect();
        let side = (period * period * thickness_um / (count.max(1) as f64)).cbrt();
        let grid = Grid::new([period; 2], [0.0, thickness_um], &boxes, side);
        Ok(Self { radius_um, index: volume.index, thickness_um, axes, grid })
    }

    /// One sphere in a period.
    #[cfg(test)]
    pub(crate) fn single(at: [f64; 3], volume: &Volume, period: f64) -> Self {
        let Volume { radius_um, index, thickness_um, .. } = *volume;
        let axes = vec![Axis { from: at, along: [0.0; 3] }];
        let boxes = [[at.map(|value| value - radius_um), at.map(|value| value + radius_um)]];
        let grid = Grid::new([period; 2], [0.0, thickness_um], &boxes, period);
        Self { radius_um, index, thickness_um, axes, grid }
    }

    /// Number of particles of a period.
    #[cfg(test)]
    pub(crate) fn count(&self) -> usize {
        self.axes.len()
    }

    /// Way to the nearest particle that a ray in the matrix meets, of all of the neighbouring periods.
    #[cfg(test)]
    pub(crate) fn way_to_any(&self, ray: &Ray) -> Option<f64> {
        let periods = (-2..=2).flat_map(|x| (-2..=2).map(move |y| [f64::from(x), f64::from(y)]));
        let all = periods.flat_map(|turns| self.axes.iter().map(move |axis| (axis, turns)));
        let ways = all.filter_map(|(axis, turns)| self.within(ray, axis, turns)).map(|[enters, _]| enters.0);
        ways.filter(|way| *way > 0.0).min_by(f64::total_cmp)
    }

    /// Distance of a place from the nearest axis, in any period.
    #[cfg(test)]
    pub(crate) fn distance(&self, at: [f64; 3]) -> f64 {
        let place = Axis { from: at, along: [0.0; 3] };
        let squares = self.axes.iter().map(|axis| apart(&place, axis, self.grid.period_um()[0]));
        squares.fold(f64::INFINITY, f64::min).sqrt()
    }

    /// Ways at which a line enters and leaves a particle, with the point of the axis nearest to each.
    fn within(&self, ray: &Ray, axis: &Axis, turns: [f64; 2]) -> Option<[(f64, [f64; 3]); 2]> {
        let [x, y] = self.grid.period_um();
        let from = [axis.from[0] + turns[0] * x, axis.from[1] + turns[1] * y, axis.from[2]];
        let away = [0, 1, 2].map(|k| ray.at[k] - from[k]);
        let length = dot(axis.along, axis.along).sqrt();
        let square = self.radius_um * self.radius_um;
        let of_ball = |along: f64| -> Option<[(f64, [f64; 3]); 2]> {
            let centre = if length > 0.0 { moved(from, along / length, axis.along) } else { from };
            let away = [0, 1, 2].map(|k| ray.at[k] - centre[k]);
            let b = dot(away, ray.along);
            let nearest = moved(away, -b, ray.along);
            let half = square - dot(nearest, nearest);
            (half > 0.0).then(|| [(-b - half.sqrt(), centre), (-b + half.sqrt(), centre)])
        };
        if length == 0.0 {
            return of_ball(0.0);
        }
        let unit = axis.along.map(|part| part / length);
        // The particle is the union of a cylinder and two balls: convex, so that the line has one interval in
        // it.
        let balls = [of_ball(0.0), of_ball(length)].into_iter().flatten();
        let (slope, height) = (dot(ray.along, unit), dot(away, unit));
        let across = moved(ray.along, -slope, unit);
        let beside = moved(away, -height, unit);
        let (a, b) = (dot(across, across), dot(across, beside));
        let side = (a > 0.0).then(|| {
            let nearest = moved(beside, -b / a, across);
            (square - dot(nearest, nearest)) / a
        });
        let side = side.filter(|half| *half > 0.0).into_iter().flat_map(|half| {
            [-b / a - half.sqrt(), -b / a + half.sqrt()].map(|way| (way, height + way * slope))
        });
        let side = side.filter(|(_, along)| (0.0..=length).contains(along));
        let side = side.map(|(way, along)| (way, moved(from, along, unit)));
        let all: Vec<(f64, [f64; 3])> = balls.flatten().chain(side).collect();
        let first = all.iter().copied().min_by(|a, b| a.0.total_cmp(&b.0))?;
        let last = all.iter().copied().max_by(|a, b| a.0.total_cmp(&b.0))?;
        Some([first, last])
    }

    fn facet(&self, ray: &Ray, (way, centre): (f64, [f64; 3])) -> Met {
        let at = moved(ray.at, way.max(0.0), ray.along);
        let away = [0, 1, 2].map(|k| at[k] - centre[k]);
        Met::Facet { at, normal: crate::ray::normalised(away) }
    }
}

impl Face for Particles {
    fn period_um(&self) -> [f64; 2] {
        self.grid.period_um()
    }

    fn heights_um(&self) -> [f64; 2] {
        [0.0, self.thickness_um]
    }

    fn particle_index(&self) -> Option<f64> {
        Some(self.index)
    }

    /// Above is the matrix, below the inside of a particle.
    fn next(&self, ray: &Ray, side: Side) -> Met {
        let tiny = ROUNDING * self.radius_um;
        let walked = self.grid.walk(ray, |entries, cell, end| {
            let met = entries.iter().filter_map(|(number, period)| {
                let turns = [0, 1].map(|k| (period[k] + cell[k]) as f64);
                let [enters, leaves] = self.within(ray, &self.axes[*number as usize], turns)?;
                match side {
                    // On a particle and away from it, the whole interval is behind.
                    Side::Above if enters.0 > -tiny && enters.0 <= end + tiny && leaves.0 > tiny => {
                        Some(enters)
                    }
                    // In the particle: particles do not touch.
                    Side::Below if enters.0 < tiny && leaves.0 > -tiny => Some(leaves),
                    _ => None,
                }
            });
            let first = match side {
                Side::Above => met.min_by(|a, b| a.0.total_cmp(&b.0)),
                Side::Below => met.max_by(|a, b| a.0.total_cmp(&b.0)),
            };
            first.map(|met| self.facet(ray, met))
        });
        match (walked, side) {
            (Walked::Found(met), _) => met,
            (Walked::Left, Side::Above) => Met::Nothing,
            (Walked::Left, Side::Below) | (Walked::Unknown, _) => Met::Unknown,
        }
    }
}

/// A particle at random; of random direction, if it is a fibre.
fn placed([x, y, z, turn]: [f64; 4], [up, ..]: [f64; 4], volume: &Volume, period: f64) -> Axis {
    let cosine = 2.0 * up - 1.0;
    let sine = ((1.0 - cosine) * (1.0 + cosine)).max(0.0).sqrt();
    let (sin_phi, cos_phi) = (std::f64::consts::TAU * turn).sin_cos();
    let along = [sine * cos_phi, sine * sin_phi, cosine].map(|part| part * volume.length_um);
    let middle =
        [x * period, y * period, volume.radius_um + z * (volume.thickness_um - 2.0 * volume.radius_um)];
    Axis { from: moved(middle, -0.5, along), along }
}

fn is_within(axis: &Axis, radius_um: f64, thickness_um: f64) -> bool {
    [axis.from[2], axis.from[2] + axis.along[2]]
        .iter()
        .all(|z| (radius_um..=thickness_um - radius_um).contains(z))
}

/// Square of the smallest distance of two axes, the nearest in all periods.
fn apart(a: &Axis, b: &Axis, period: f64) -> f64 {
    let middle = |axis: &Axis| moved(axis.from, 0.5, axis.along);
    let mut away = [0, 1, 2].map(|k| middle(a)[k] - middle(b)[k]);
    // A period is longer than four particles.
    for axis in &mut away[..2] {
        *axis -= period * (*axis / period).round();
    }
    // Of two segments about their middles, with parameters from -1/2 to 1/2 (Ericson, "Real-Time Collision
    // Detection", section 5.1.9).
    let (u, v) = (a.along, b.along);
    let (uu, uv, vv) = (dot(u, u), dot(u, v), dot(v, v));
    let (ua, va) = (dot(u, away), dot(v, away));
    let half = |value: f64| value.clamp(-0.5, 0.5);
    let divided = |a: f64, b: f64| if b > 0.0 { half(a / b) } else { 0.0 };
    let det = uu * vv - uv * uv;
    let mut s = if det > 1e-12 * uu * vv { half((uv * va - vv * ua) / det) } else { 0.0 };
    let t = divided(uv * s + va, vv);
    s = divided(uv * t - ua, uu);
    let between = [0, 1, 2].map(|k| away[k] + s * u[k] - t * v[k]);
    dot(between, between)
}

/// Particles that may touch: those of neighbouring cells, whose sides are at least the length of a particle.
struct Neighbours {
    size: [f64; 3],
    counts: [i64; 3],
    cells: Vec<Vec<usize>>,
}

impl Neighbours {
    fn new(period: f64, thickness: f64, length: f64) -> Self {
        let extent = [period, period, thickness];
        // Larger cells where these would be too many: particles that are far apart, or a thick slab.
        let wanted = extent.map(|extent| (extent / length).max(1.0)).iter().product::<f64>();
        let length = length * (wanted / MOST_CELLS).max(1.0);
        let counts = extent.map(|extent| (extent / length).floor().max(1.0) as i64);
        let size = [0, 1, 2].map(|k| extent[k] / counts[k] as f64);
        Self { size, counts, cells: vec![Vec::new(); counts.iter().product::<i64>() as usize] }
    }

    fn cell(&self, axis: &Axis) -> [i64; 3] {
        let middle = moved(axis.from, 0.5, axis.along);
        [0, 1, 2].map(|k| (middle[k] / self.size[k]).floor() as i64)
    }

    fn number(&self, cell: [i64; 3]) -> Option<usize> {
        let [x, y] = [0, 1].map(|k| cell[k].rem_euclid(self.counts[k]));
        let is_within = (0..self.counts[2]).contains(&cell[2]);
        is_within.then(|| ((cell[2] * self.counts[1] + y) * self.counts[0] + x) as usize)
    }

    fn near(&self, axis: &Axis) -> impl Iterator<Item = usize> {
        let own = self.cell(axis);
        let steps = (0..27).map(|k| [k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1]);
        let cells = steps.filter_map(move |step| self.number([0, 1, 2].map(|k| own[k] + step[k])));
        cells.flat_map(|cell| self.cells[cell].iter().copied())
    }

    fn add(&mut self, axis: &Axis, particle: usize) {
        if let Some(cell) = self.number(self.cell(axis)) {
            self.cells[cell].push(particle);
        }
    }
}
