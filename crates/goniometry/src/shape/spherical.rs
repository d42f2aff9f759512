//! Smooth interpolation of a grid of inclinations between the viewer's directions.
//!
//! A lobe about the specular direction is narrow on the rings of such a grid at oblique incidence: at 70 deg, azimuths
//! in steps of 15 deg are 0.24 apart in direction cosines. It is therefore interpolated in two steps.
//!
//! - **A round lobe**: f along the plane of incidence, from the specular direction over the normal, as a function of
//!   `|delta|` ([`Line`]), and the mean of its logarithm on both sides next to the specular direction ([`Tilt`]).
//! - **The ratio to it**: cubic in the azimuth and then in the inclination. The azimuth is stretched about the specular
//!   direction by `tan(s/2) = (1 + A)^(1/4) tan(psi/2)`, with which the round lobe on a ring, a function of
//!   `1 + A sin^2(psi/2)`, varies as much on each side of a quarter turn.
//!
//! A lobe that is round in direction cosines is thus as exact as its values in the plane of incidence, whatever the
//! azimuths; that of any other follows from them.

use super::abscissa;
use super::cells::best_width;
use super::line::Line;
use crate::{Direction, SphericalGrid};

/// Values of one channel on a grid of inclinations and azimuths, for light from the grid's own inclinations and its
/// first azimuth.
pub(super) struct Smooth<'a> {
    grid: &'a SphericalGrid,
    /// Values over those of the round lobe.
    ratios: Vec<f64>,
    lobes: Vec<Round>,
    /// Ascending azimuths from that of the light, degrees, with their indices on the grid's axis: a little
    /// more than one turn.
    azimuths: Vec<(f64, usize)>,
    /// True if the azimuths of one side represent both.
    mirrored: bool,
    /// Exponent of the stretch of azimuths.
    power: f64,
}

impl<'a> Smooth<'a> {
    /// Interpolation with this exponent of the stretch of azimuths and width of the abscissa; without a width, with the one
    /// that the values determine.
    pub(super) fn new(grid: &'a SphericalGrid, values: &[f64], power: f64, width: Option<f64>) -> Self {
        let light = grid.phi_i_deg.first().copied().unwrap_or(0.0);
        let axis: Vec<(f64, usize)> =
            grid.phi_o_deg.iter().enumerate().map(|(place, phi)| (phi - light, place)).collect();
        let mirrored = grid.is_half();
        let copy = |sign: f64, turn: f64| axis.iter().map(move |(phi, place)| (sign * phi + turn, *place));
        let mut azimuths: Vec<(f64, usize)> = if mirrored {
            copy(1.0, 0.0).chain(copy(-1.0, 0.0)).chain(copy(-1.0, 360.0)).collect()
        } else {
            copy(1.0, 0.0).chain(copy(1.0, -360.0)).chain(copy(1.0, 360.0)).collect()
        };
        azimuths.sort_by(|a, b| a.0.total_cmp(&b.0));
        azimuths.dedup_by(|b, a| b.0 - a.0 < 1e-9);
        let (lobes, ratios) = rounds(grid, values, width);
        Self { grid, ratios, lobes, azimuths, mirrored, power }
    }

    /// Returns whether the lobe of an incidence, given by its index, falls to half within a step.
    pub(super) fn halves_at_once(&self, theta_i: usize) -> bool {
        self.lobes[theta_i].line.as_ref().is_some_and(|(_, line)| line.halves_at_once())
    }

    /// Returns f for light from one of the grid's inclinations, given by its index, towards `o`, interpolated
    /// between the grid's directions.
    pub(super) fn value(&self, theta_i: usize, o: Direction) -> f64 {
        let light = self.grid.phi_i_deg.first().copied().unwrap_or(0.0);
        let turned = (o.phi_deg - light).rem_euclid(360.0);
        let phi = if self.mirrored { turned.min(360.0 - turned) } else { turned };
        let lobe = &self.lobes[theta_i];
        let azimuths = &self.azimuths[around(&self.azimuths, |(known, _)| *known <= phi)];
        let thetas = around(&self.grid.theta_o_deg, |known| *known <= o.theta_deg);
        let first = theta_i * self.grid.phi_i_deg.len() * self.grid.theta_o_deg.len();
        let ring = |theta_o: usize| {
            let cell = (first + theta_o) * self.grid.phi_o_deg.len();
            let stretch = lobe.stretch(self.grid.theta_o_deg[theta_o], self.power);
            let angles: Vec<f64> = azimuths.iter().map(|(angle, _)| stretched(*angle, stretch)).collect();
            let values: Vec<f64> = azimuths.iter().map(|(_, place)| self.ratios[cell + place]).collect();
            let ratio = through_measured(&angles, &values, stretched(phi, stretch));
            ratio.min(lobe.largest_ratio(self.grid.theta_o_deg[theta_o], phi, azimuths, &values))
        };
        let rings: Vec<f64> = thetas.clone().map(ring).collect();
        through_measured(&self.grid.theta_o_deg[thetas], &rings, o.theta_deg) * lobe.value(o.theta_deg, phi)
    }
}

/// Lobe that is round in direction cosines.
struct Round {
    /// Sine of the inclination of the light.
    sine: f64,
    /// Distance at which the lobe falls to half its peak.
    half: f64,
    /// Width of the abscissa of the line; `None` for the constant 1.
    line: Option<(f64, Line)>,
}

impl Round {
    /// f towards an inclination and an azimuth from that of the light.
    fn value(&self, theta_deg: f64, azimuth_deg: f64) -> f64 {
        let Some((width, line)) = &self.line else { return 1.0 };
        line.value(abscissa(self.distance(theta_deg, azimuth_deg), *width))
    }

    /// Largest ratio at an azimuth of a ring, so that f does not exceed that of the azimuths next to it, but where the round
    /// lobe does: where azimuths are far apart, the ratio rises by powers of ten between them.
    fn largest_ratio(
        &self,
        theta_deg: f64,
        azimuth_deg: f64,
        azimuths: &[(f64, usize)],
        ratios: &[f64],
    ) -> f64 {
        let upper = azimuths.partition_point(|(known, _)| *known <= azimuth_deg).min(azimuths.len() - 1);
        let near = [upper.saturating_sub(1), upper];
        let round = near.map(|k| self.value(theta_deg, azimuths[k].0));
        let largest = f64::max(ratios[near[0]] * round[0], ratios[near[1]] * round[1]);
        let here = self.value(theta_deg, azimuth_deg);
        LARGEST_EXCESS * largest * (here / round[0].max(round[1])).max(1.0) / here
    }

    fn distance(&self, theta_deg: f64, azimuth_deg: f64) -> f64 {
        let sine = theta_deg.to_radians().sin();
        let aside = (0.5 * azimuth_deg).to_radians().cos();
        (sine - self.sine).hypot(2.0 * (sine * self.sine).max(0.0).sqrt() * aside)
    }

    /// Factor `(1 + A)^(1/4)` of a ring.
    fn stretch(&self, theta_deg: f64, power: f64) -> f64 {
        let sine = theta_deg.to_radians().sin();
        let squared = self.half * self.half + (sine - self.sine).powi(2);
        (1.0 + 4.0 * sine * self.sine / squared).powf(power)
    }
}

/// Azimuth from the specular direction, stretched about it; `azimuth_deg` is that from the light.
fn stretched(azimuth_deg: f64, stretch: f64) -> f64 {
    let psi = azimuth_deg - 180.0;
    let turns = (psi / 360.0).round();
    let (sin, cos) = (0.5 * (psi - 360.0 * turns)).to_radians().sin_cos();
    2.0 * (stretch * sin).atan2(cos).to_degrees() + 360.0 * turns
}

/// Round lobe of each incidence, and the ratios of the values to it.
fn rounds(grid: &SphericalGrid, values: &[f64], width: Option<f64>) -> (Vec<Round>, Vec<f64>) {
    let light = grid.phi_i_deg.first().copied().unwrap_or(0.0);
    let (azimuths, rows) = (grid.phi_o_deg.len(), grid.theta_o_deg.len());
    let lights = grid.phi_i_deg.len();
    let lobe = |theta: &f64| Round { sine: theta.to_radians().sin(), half: 1.0, line: None };
    let mut lobes: Vec<Round> = grid.theta_i_deg.iter().map(lobe).collect();
    let sides: Vec<Sides> = lobes
        .iter()
        .enumerate()
        .map(|(k, lobe)| Sides::new(grid, &values[k * lights * rows * azimuths..][..rows * azimuths], lobe))
        .collect();
    let width = width.unwrap_or_else(|| best_width(sides.iter().map(|sides| &sides.over)));
    for (lobe, sides) in lobes.iter_mut().zip(sides) {
        let line = sides.mean(width);
        if line.len() < 3 {
            continue;
        }
        let peak = line[0][1];
        lobe.half = line.iter().find(|[_, f]| *f < 0.5 * peak).map_or(1.0, |[delta, _]| *delta);
        let mut x: Vec<f64> = line.iter().map(|[delta, _]| abscissa(*delta, width)).collect();
        let mut f: Vec<f64> = line.iter().map(|[_, f]| *f).collect();
        if line[0][0] > SPECULAR {
            // The specular direction was not measured.
            let slope = (f[1] / f[0]).ln() / (x[1] - x[0]);
            f.insert(0, f[0] * (-slope.min(0.0) * x[0]).min(LARGEST_RISE).exp());
            x.insert(0, 0.0);
        }
        lobe.line = Some((width, Line::new(x, &f)));
    }
    let mut ratios = values.to_vec();
    for (row, ratios) in ratios.chunks_exact_mut(azimuths).enumerate() {
        let lobe = &lobes[row / rows / lights];
        if lobe.line.is_none() {
            continue;
        }
        for (ratio, phi) in ratios.iter_mut().zip(&grid.phi_o_deg) {
            let round = lobe.value(grid.theta_o_deg[row % rows], phi - light);
            *ratio = if *ratio > 0.0 && round > 0.0 { *ratio / round } else { 0.0 * *ratio };
        }
    }
    (lobes, ratios)
}

/// Distance below which a direction is the specular one, up to rounding.
const SPECULAR: f64 = 1e-6;
/// Largest rise of ln f from the nearest value to the specular direction.
const LARGEST_RISE: f64 = 5.0;
/// Factor by which f may exceed that of the azimuths next to it.
const LARGEST_EXCESS: f64 = 1.5;
/// Largest logarithm of the factor by which f differs from the lobe of both sides, at the first points.
const LARGEST_TILT: f64 = 0.5;
/// Steps from the specular direction over which the two sides differ by a nearly constant slope.
const TILTED: f64 = 4.0;
/// Fraction of the first distance over the normal below which points of the other side are nearer: from two points at nearly
/// the same distance, nothing follows about the peak.
const NEARER: f64 = 0.8;
/// Azimuths that differ by less are equal, degrees.
const SAME_DEG: f64 = 0.03;

/// Positive values of an incidence along the plane of incidence, or along the nearest azimuths, as points (distance from the
/// specular direction, f), ascending.
struct Sides {
    /// From the specular direction over the normal.
    over: Vec<[f64; 2]>,
    /// From the specular direction away from the normal.
    beyond: Vec<[f64; 2]>,
}

impl Sides {
    fn new(grid: &SphericalGrid, cells: &[f64], lobe: &Round) -> Self {
        let light = grid.phi_i_deg.first().copied().unwrap_or(0.0);
        let azimuths = grid.phi_o_deg.len();
        if azimuths < 2 {
            return Self { over: Vec::new(), beyond: Vec::new() };
        }
        let from_light = |k: usize| {
            let turned = (grid.phi_o_deg[k] - light).rem_euclid(360.0);
            turned.min(360.0 - turned)
        };
        let column = |aside: &dyn Fn(usize) -> f64| -> Vec<[f64; 3]> {
            let least = (0..azimuths).map(aside).fold(f64::INFINITY, f64::min);
            let nearest: Vec<usize> = (0..azimuths).filter(|k| aside(*k) < least + SAME_DEG).collect();
            let point = |(row, theta): (usize, &f64)| {
                let known = nearest.iter().map(|k| cells[row * azimuths + k]).filter(|f| *f > 0.0);
                let (sum, count) = known.fold((0.0, 0), |(sum, count), f| (sum + f, count + 1));
                (count > 0)
                    .then(|| [*theta, lobe.distance(*theta, from_light(nearest[0])), sum / f64::from(count)])
            };
            grid.theta_o_deg.iter().enumerate().filter_map(point).collect()
        };
        let is_before = |point: &[f64; 3]| point[0].to_radians().sin() <= lobe.sine + 1e-9;
        let (mut over, beyond): (Vec<_>, Vec<_>) =
            column(&|k| 180.0 - from_light(k)).into_iter().partition(is_before);
        over.extend(column(&from_light));
        let [over, beyond] = [over, beyond].map(|side| {
            let mut points: Vec<[f64; 2]> = side.iter().map(|point| [point[1], point[2]]).collect();
            points.sort_by(|a, b| a[0].total_cmp(&b[0]));
            points.dedup_by(|b, a| b[0] - a[0] < 1e-9);
            points
        });
        Self { over, beyond }
    }

    /// Returns the lobe of both sides: that over the normal, with points of the other side that are clearly nearer than its first,
    /// each without the tilt of the lobe.
    fn mean(&self, width: f64) -> Vec<[f64; 2]> {
        let tilt = Tilt::new(self, width);
        let first = self.over.first().map_or(f64::INFINITY, |point| point[0]);
        let nearer = self.beyond.iter().take_while(|point| point[0] < NEARER * first);
        let nearer = nearer.map(|[delta, f]| [*delta, f / tilt.factor(*delta)]);
        nearer.chain(self.over.iter().map(|[delta, f]| [*delta, f * tilt.factor(*delta)])).collect()
    }
}

/// Difference of the two sides of a lobe next to the specular direction: f is `exp(slope delta)` times the mean of both sides away from the
/// normal, and `exp(-slope delta)` times it over the normal.
///
/// Without it, two directions at nearly the same distance on the two sides would differ as if f changed over the small difference
/// of their distances.
struct Tilt {
    /// Logarithm of the factor for each unit of distance.
    slope: f64,
    /// Distance from which on the factor decreases.
    reach: f64,
}

impl Tilt {
    /// From the side whose first point is nearer, interpolated at the first distance of the other one.
    fn new(sides: &Sides, width: f64) -> Self {
        let none = Self { slope: 0.0, reach: 1.0 };
        let Some((over, beyond)) = sides.over.first().zip(sides.beyond.first()) else { return none };
        let ([near, far], sign) = match over[0] < beyond[0] {
            true => ([&sides.over, &sides.beyond], 1.0),
            false => ([&sides.beyond, &sides.over], -1.0),
        };
        let [delta, f] = far[0];
        if near.last().is_none_or(|last| last[0] < delta) || delta <= SPECULAR {
            return none;
        }
        let x = near.iter().map(|[delta, _]| abscissa(*delta, width)).collect();
        let line = Line::new(x, &near.iter().map(|[_, f]| *f).collect::<Vec<f64>>());
        let log = 0.5 * sign * (f / line.value(abscissa(delta, width))).ln();
        let of_one = Self { slope: 1.0 / delta, reach: TILTED * delta };
        Self { slope: of_one.slope * log.clamp(-LARGEST_TILT, LARGEST_TILT) / of_one.log(delta), ..of_one }
    }

    /// Logarithm of the factor of the side away from the normal.
    fn log(&self, delta: f64) -> f64 {
        self.slope * delta / (1.0 + (delta / self.reach).powi(2))
    }

    fn factor(&self, delta: f64) -> f64 {
        self.log(delta).exp()
    }
}

/// Value at `x` of the line through the measured ones of a few points; NaN if none was measured.
fn through_measured(axis: &[f64], values: &[f64], x: f64) -> f64 {
    let known = || axis.iter().zip(values).filter(|(_, value)| value.is_finite());
    let values: Vec<f64> = known().map(|(_, value)| *value).collect();
    if values.is_empty() { f64::NAN } else { Line::new(known().map(|(x, _)| *x).collect(), &values).value(x) }
}

/// Range of the two nodes before and the two after the point where `below` becomes false; fewer at the ends
/// of the axis.
fn around<T>(axis: &[T], below: impl FnMut(&T) -> bool) -> std::ops::Range<usize> {
    let upper = axis.partition_point(below);
    upper.saturating_sub(2)..(upper + 2).min(axis.len())
}
