//! The director of a nematic cell at a voltage, by one-dimensional Frank-Oseen theory.
//!
//! **Model.** Between two plane electrodes the director `n` depends on depth only, and is fixed at the surfaces (strong anchoring). It is a
//! minimum of the free energy at this voltage, per area
//!
//! `integral of [K11 n_z'^2 + K22 (s - q)^2 + K33 (n_x'^2 + n_y'^2 - s^2)]/2 dz - epsilon_0 U^2/2 / (integral of dz/epsilon(n_z))`,
//!
//! with the twist `s = n_x n_y' - n_y n_x'`, the natural twist `q` of a chiral dopant, and the permittivity `epsilon` along the normal, whose integral follows from `D = const`.
//!
//! **Which minimum.** The one that a drive reaches whose voltage rises from 0: cells that turn by 180 deg or more may have others, of less
//! energy, behind a barrier. Among two equivalent ones of a cell without pretilt, the one with a positive change of tilt is found. A cell
//! without twist or dopant stays in its plane.
//!
//! **Parameters.** Elastic constants in pN, relative permittivities at the frequency of the drive (usually 1 kHz), volts rms. The thickness does not
//! matter: lengths are fractions of the gap.
//!
//! **Method.** Unit vectors at [`INTERVALS`]` + 1` depths, energies by differences (error of second order), Newton's method on the
//! spheres with a line search on the energy. The depths follow the director: half of the intervals are spread evenly, the other half in
//! proportion to the root of its rate of turn: at high voltages it turns within the electric coherence length of the surfaces, 0.3 % of the
//! gap at 100 V. Vectors have no singular direction: tilt and azimuth would at the normal, through which a director that turns by more than
//! 180 deg escapes from its twist. The field couples all depths, by one term of rank one; the rest of the Hessian matrix is a band.
//!
//! **Validity.** No flexoelectricity, ions, finite anchoring, flow or change of the order.
//!
//! Source: F. C. Frank, Discuss. Faraday Soc. 25, 19 (1958); H. J. Deuling, Mol. Cryst. Liq. Cryst. 19, 123 (1972); I. W. Stewart, "The Static
//! and Dynamic Continuum Theory of Liquid Crystals" (2004), chapter 3.

use std::f64::consts::{FRAC_PI_4, PI, TAU};

use crate::OpticsError;

/// Number of intervals of depth.
pub const INTERVALS: usize = 400;

/// Permittivity of vacuum, pN/V^2.
const EPSILON_0: f64 = 8.854_187_812_8;

/// Largest step of the voltage while it rises, V, and the fewest steps.
const STEP_V: f64 = 0.25;
const FEWEST_STEPS: usize = 4;

/// Change of tilt in the middle from which each voltage begins, radians.
const NUDGE: f64 = 1e-2;

/// Iterations for one voltage, and the largest turn of a director in one of them, radians.
const MOST_ITERATIONS: usize = 500;
const LARGEST_TURN: f64 = 0.05;

/// A director with less than this across the normal has no azimuth of its own.
const NORMAL: f64 = 1e-6;

/// Turns that end the iterations, radians: on the way to the voltage, and there.
const NEARLY_SETTLED: f64 = 1e-4;
const SETTLED: f64 = 1e-11;

/// Elastic constants and permittivities of a nematic.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nematic {
    /// Elastic constants of splay, twist and bend, pN.
    pub elastic_pn: [f64; 3],
    /// Relative permittivities along the director and across it.
    pub permittivity: [f64; 2],
}

/// A cell: what its surfaces impose, and the voltage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DrivenCell {
    /// The liquid crystal.
    pub nematic: Nematic,
    /// Tilt at the top and at the bottom, degrees. Above 90 at the bottom: the director turns through the normal (bend).
    pub tilt_deg: [f64; 2],
    /// Turn of the azimuth from the top to the bottom, degrees.
    pub twist_deg: f64,
    /// The same turn of the liquid crystal by itself, with a chiral dopant: 360 times the gap over the pitch.
    pub natural_twist_deg: f64,
    /// Voltage, rms.
    pub volts: f64,
}

/// Director by depth.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    /// Depths from the top, fractions of the gap from 0 to 1, denser where the director turns.
    pub depth: Vec<f64>,
    /// Tilt at these depths, degrees.
    pub tilt_deg: Vec<f64>,
    /// Azimuth from that at the top, degrees.
    pub twist_deg: Vec<f64>,
    /// Free energy per area times the gap, pN: elastic less electric.
    pub energy_pn: f64,
}

/// Returns the director of the cell.
///
/// ```
/// use papilio_optics::frank_oseen::{DrivenCell, Nematic, director};
/// let nematic = Nematic { elastic_pn: [10.0, 7.0, 15.0], permittivity: [15.0, 5.0] };
/// let cell = DrivenCell { nematic, tilt_deg: [0.0; 2], twist_deg: 0.0, natural_twist_deg: 0.0, volts: 1.0 };
/// // Freedericksz: nothing moves below pi sqrt(K11/(epsilon_0 Delta epsilon)) = 1.0558 V.
/// assert!(director(&cell)?.tilt_deg[200].abs() < 1e-6);
/// // Just above, sin^2 of the tilt in the middle is 4 (V/V0 - 1)/(K33/K11 + Delta epsilon/epsilon_perpendicular): 12.6 degrees.
/// let tilt = director(&DrivenCell { volts: 1.1, ..cell })?.tilt_deg[200];
/// assert!((tilt - 12.6).abs() < 0.6, "{tilt}");
/// # Ok::<(), papilio_optics::OpticsError>(())
/// ```
///
/// # Errors
/// Constants that are not above 0, tilts beyond 180 deg, a voltage that is not 0 or more.
pub fn director(cell: &DrivenCell) -> Result<Profile, OpticsError> {
    let Nematic { elastic_pn, permittivity } = cell.nematic;
    let is_positive = |values: &[f64]| values.iter().all(|value| value.is_finite() && *value > 0.0);
    let checks = [
        (is_positive(&elastic_pn), "elastic constants", "numbers above 0"),
        (is_positive(&permittivity), "permittivities", "numbers above 0"),
        (cell.tilt_deg.iter().all(|tilt| tilt.abs() <= 180.0), "tilts", "-180 to 180 degrees"),
        (cell.twist_deg.is_finite(), "twist", "a finite angle"),
        (cell.natural_twist_deg.is_finite(), "natural twist", "a finite angle"),
        (cell.volts.is_finite() && cell.volts >= 0.0, "volts", "0 or more"),
    ];
    for (is_right, what, expected) in checks {
        if !is_right {
            return Err(OpticsError::Axis { what, expected });
        }
    }
    let mut problem = Problem {
        elastic: elastic_pn,
        permittivity,
        natural_twist: cell.natural_twist_deg.to_radians(),
        is_planar: cell.twist_deg == 0.0 && cell.natural_twist_deg == 0.0,
        square_volts: 0.0,
        depth: (0..=INTERVALS).map(|k| k as f64 / INTERVALS as f64).collect(),
    };
    let [top, bottom] = cell.tilt_deg.map(f64::to_radians);
    // Upwards from a flat director, away from the normal from a standing one; the reverse of both where it points down.
    let mean = 0.5 * (top + bottom);
    let sign = if (mean < 0.0) == (mean.abs() > FRAC_PI_4) { 1.0 } else { -1.0 };
    let at = |depth: &f64| {
        let depth = *depth;
        let (tilt, azimuth) = (top + (bottom - top) * depth, cell.twist_deg.to_radians() * depth);
        let size = sign * NUDGE * (PI * depth).sin();
        (director_of(tilt, azimuth), director_of(tilt + 0.5 * PI, azimuth).map(|part| size * part))
    };
    let nudge = |depth: &f64| at(depth).1;
    let mut directors: Vec<_> = problem.depth.iter().map(|depth| at(depth).0).collect();
    let steps = ((cell.volts / STEP_V).ceil() as usize).max(FEWEST_STEPS);
    for step in 0..=steps {
        problem.square_volts = (cell.volts * step as f64 / steps as f64).powi(2);
        problem.spread(&mut directors);
        let nudges: Vec<_> = problem.depth.iter().map(nudge).collect();
        problem.settle(&mut directors, &nudges, NEARLY_SETTLED);
    }
    // On the depths of the director at the voltage itself.
    problem.spread(&mut directors);
    problem.settle(&mut directors, &[], SETTLED);
    let angles = angles(&directors, top);
    Ok(Profile {
        energy_pn: problem.energy(&directors),
        tilt_deg: angles.iter().map(|[tilt, _]| tilt.to_degrees()).collect(),
        twist_deg: angles.iter().map(|[_, azimuth]| azimuth.to_degrees()).collect(),
        depth: problem.depth,
    })
}

type Vector = [f64; 3];

fn director_of(tilt: f64, azimuth: f64) -> Vector {
    [tilt.cos() * azimuth.cos(), tilt.cos() * azimuth.sin(), tilt.sin()]
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The directions of rising tilt and of rising azimuth.
fn frame([x, y, z]: Vector) -> [Vector; 2] {
    let (across, azimuth) = (x.hypot(y), y.atan2(x));
    [[-z * azimuth.cos(), -z * azimuth.sin(), across], [-azimuth.sin(), azimuth.cos(), 0.0]]
}

/// Tilts and azimuths without jumps; the first azimuth is about 0. Beyond the normal the tilt is above 90 deg, or the azimuth turned by half
/// a turn: whichever is nearer.
fn angles(directors: &[Vector], first_tilt: f64) -> Vec<[f64; 2]> {
    let mut last = [first_tilt, 0.0];
    let next = |[x, y, z]: &Vector| {
        let across = x.hypot(*y);
        let [tilt, azimuth] = [z.atan2(across), if across > NORMAL { y.atan2(*x) } else { last[1] }];
        let distance = |one: &[f64; 2]| (one[0] - last[0]).abs() + (one[1] - last[1]).abs();
        let [own, other] = [[tilt, azimuth], [PI - tilt, azimuth + PI]]
            .map(|one| [0, 1].map(|axis: usize| one[axis] + TAU * ((last[axis] - one[axis]) / TAU).round()));
        last = if distance(&own) <= distance(&other) { own } else { other };
        last
    };
    directors.iter().map(next).collect()
}

/// The energy in units of pN, as a function of the directors.
struct Problem {
    elastic: [f64; 3],
    permittivity: [f64; 2],
    natural_twist: f64,
    /// Whether the azimuth is fixed.
    is_planar: bool,
    square_volts: f64,
    /// Depths of the directors, fractions of the gap.
    depth: Vec<f64>,
}

/// Gradient and Hessian matrix of the energy in the turns of the inner directors, two each ([`frame`]): a band, plus
/// `factor * slopes slopes^T` of the field.
struct Expansion {
    gradient: Vec<f64>,
    band: Band,
    field: (f64, Vec<f64>),
}

impl Problem {
    /// Inverse of the permittivity along the normal, with its first two derivatives in `n_z`.
    fn over_permittivity(&self, z: f64) -> [f64; 3] {
        let [along, across] = self.permittivity;
        let more = along - across;
        let over = 1.0 / (across + more * z * z);
        let first = -2.0 * more * z * over * over;
        [over, first, -2.0 * more * over * over - 4.0 * more * z * first * over]
    }

    /// The energy of the field is this factor over the integral of the inverse permittivity.
    fn of_field(&self) -> f64 {
        -0.5 * EPSILON_0 * self.square_volts
    }

    /// Thickness of an interval.
    fn interval(&self, k: usize) -> f64 {
        self.depth[k + 1] - self.depth[k]
    }

    /// Integral of the inverse permittivity (trapezoids).
    fn integral(&self, directors: &[Vector]) -> f64 {
        let pairs =
            directors.windows(2).map(|pair| [pair[0], pair[1]].map(|n| self.over_permittivity(n[2])[0]));
        pairs.enumerate().map(|(k, [a, b])| 0.5 * (a + b) * self.interval(k)).sum()
    }

    /// Moves the depths to where the director turns, and the directors, linear between them, to the new depths.
    fn spread(&mut self, directors: &mut Vec<Vector>) {
        let root_of_turn: Vec<f64> = (0..INTERVALS)
            .map(|k| {
                let square: f64 =
                    (0..3).map(|axis| (directors[k + 1][axis] - directors[k][axis]).powi(2)).sum();
                (square.sqrt() * self.interval(k)).sqrt()
            })
            .collect();
        let sum: f64 = root_of_turn.iter().sum();
        if sum < 1e-6 {
            return;
        }
        // Half of the number of intervals above each depth from the depth itself, half from the turn.
        let mut number = vec![0.0];
        for (k, root) in root_of_turn.iter().enumerate() {
            number.push(number[k] + 0.5 * INTERVALS as f64 * (self.interval(k) + root / sum));
        }
        let (mut depth, mut moved) = (self.depth.clone(), directors.clone());
        for k in 1..INTERVALS {
            let right = number.partition_point(|number| *number < k as f64).clamp(1, INTERVALS);
            let share =
                ((k as f64 - number[right - 1]) / (number[right] - number[right - 1])).clamp(0.0, 1.0);
            depth[k] = self.depth[right - 1] + share * self.interval(right - 1);
            let (a, b) = (directors[right - 1], directors[right]);
            moved[k] = turned(a, [0, 1, 2].map(|axis: usize| share * (b[axis] - a[axis])));
        }
        (self.depth, *directors) = (depth, moved);
    }

    fn energy(&self, directors: &[Vector]) -> f64 {
        let [splay, twist, bend] = self.elastic;
        let natural = self.natural_twist;
        let of_pair = |(k, pair): (usize, &[Vector])| {
            let (a, b) = (pair[0], pair[1]);
            let [x, y, z] = [0, 1, 2].map(|axis: usize| b[axis] - a[axis]);
            let turn = a[0] * b[1] - a[1] * b[0];
            let straight = splay * z * z + bend * (x * x + y * y);
            0.5 / self.interval(k) * (straight + (twist - bend) * turn * turn) - twist * natural * turn
        };
        let elastic: f64 = directors.windows(2).enumerate().map(of_pair).sum();
        elastic + 0.5 * twist * natural * natural + self.of_field() / self.integral(directors)
    }

    fn expansion(&self, directors: &[Vector]) -> Expansion {
        let (count, inner) = (directors.len(), directors.len() - 2);
        let frames: Vec<_> = directors.iter().copied().map(frame).collect();
        let natural = self.elastic[1] * self.natural_twist;
        let mut slopes = vec![[0.0; 3]; count];
        // Of each director with itself, in the order of a symmetric matrix's lower half, and with the next one.
        let (mut own, mut next) = (vec![[0.0; 3]; count], vec![[[0.0; 2]; 2]; count]);
        for k in 0..INTERVALS {
            let [splay, twist, bend] = self.elastic.map(|elastic| elastic / self.interval(k));
            let stiff = |u: &Vector, v: &Vector| bend * (u[0] * v[0] + u[1] * v[1]) + splay * u[2] * v[2];
            let (a, b) = (directors[k], directors[k + 1]);
            let change = [0, 1, 2].map(|axis: usize| b[axis] - a[axis]);
            let torque = (twist - bend) * (a[0] * b[1] - a[1] * b[0]) - natural;
            // Changes of the turn with both directors.
            let turns = [[b[1], -b[0], 0.0], [-a[1], a[0], 0.0]];
            for (side, sign) in [(0, -1.0), (1, 1.0)] {
                let (slope, by) = (&mut slopes[k + side], turns[side]);
                let straight = [bend * change[0], bend * change[1], splay * change[2]];
                for axis in 0..3 {
                    slope[axis] += sign * straight[axis] + torque * by[axis];
                }
                let along = frames[k + side].map(|direction| dot(&by, &direction));
                for (value, [i, j]) in own[k + side].iter_mut().zip([[0, 0], [1, 0], [1, 1]]) {
                    let [u, v] = [i, j].map(|axis: usize| &frames[k + side][axis]);
                    *value += stiff(u, v) + (twist - bend) * along[i] * along[j];
                }
            }
            for (i, u) in frames[k].iter().enumerate() {
                for (j, v) in frames[k + 1].iter().enumerate() {
                    let both = (twist - bend) * dot(&turns[0], u) * dot(&turns[1], v);
                    next[k][i][j] = both + torque * (u[0] * v[1] - u[1] * v[0]) - stiff(u, v);
                }
            }
        }
        let integral = self.integral(directors);
        let rate = -self.of_field() / (integral * integral);
        let mut of_field = Vec::with_capacity(2 * inner);
        let (mut gradient, mut band) = (Vec::with_capacity(2 * inner), Band::default());
        for k in 1..=inner {
            let h = 0.5 * (self.interval(k - 1) + self.interval(k));
            let [_, first, second] = self.over_permittivity(directors[k][2]).map(|value| h * value);
            slopes[k][2] += rate * first;
            // What a turn on the sphere loses along the director itself.
            let radial = dot(&slopes[k], &directors[k]);
            let up = frames[k].map(|direction| direction[2]);
            for (value, [i, j]) in own[k].iter_mut().zip([[0, 0], [1, 0], [1, 1]]) {
                *value += rate * second * up[i] * up[j] - if i == j { radial } else { 0.0 };
            }
            of_field.extend(up.map(|up| first * up));
            gradient.extend(frames[k].map(|direction| dot(&slopes[k], &direction)));
            let [tilt, both, azimuth] = own[k];
            let before = next[k - 1];
            band.rows.push([tilt, before[1][0], before[0][0], 0.0]);
            band.rows.push([azimuth, both, before[1][1], before[0][1]]);
            if self.is_planar {
                gradient[2 * k - 1] = 0.0;
                band.rows[2 * k - 2][1] = 0.0;
                band.rows[2 * k - 1] = [self.elastic[0] / h, 0.0, 0.0, 0.0];
            }
        }
        Expansion { gradient, band, field: (2.0 * self.of_field() / integral.powi(3), of_field) }
    }

    /// Moves the directors to the nearest minimum of the energy, until they turn by less than `settled`.
    fn settle(&self, directors: &mut Vec<Vector>, nudges: &[Vector], settled: f64) {
        for (n, nudge) in directors.iter_mut().zip(nudges) {
            *n = turned(*n, *nudge);
        }
        let mut energy = self.energy(directors);
        for _ in 0..MOST_ITERATIONS {
            let expansion = self.expansion(directors);
            // Soft directors turn by no more than the largest turn, as in a flow downhill with small steps of time; stiff ones as by Newton.
            let steepest = largest(&expansion.gradient);
            let mut damping = steepest / LARGEST_TURN;
            let step = loop {
                match expansion.step(damping) {
                    Some(step) => break step,
                    None => damping = f64::max(2.0 * damping, 1e-8),
                }
                if damping > 1e9 {
                    return;
                }
            };
            let turn = largest(&step);
            let mut length = (LARGEST_TURN / turn).min(1.0);
            let moved = loop {
                let mut next = directors.clone();
                for (n, step) in next[1..].iter_mut().zip(step.chunks_exact(2)) {
                    let [up, around] = frame(*n);
                    let turn = [0, 1, 2].map(|axis: usize| step[0] * up[axis] + step[1] * around[axis]);
                    *n = turned(*n, turn.map(|part| length * part));
                }
                let found = self.energy(&next);
                // Rounding of a large energy hides small gains near the minimum.
                if found <= energy + 1e-14 * energy.abs() {
                    break Some((next, found));
                }
                length *= 0.5;
                if length < 1e-12 {
                    break None;
                }
            };
            let Some((next, found)) = moved else { return };
            (*directors, energy) = (next, found);
            if turn * length < settled {
                return;
            }
        }
    }
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, value| most.max(value.abs()))
}

/// A director after a small turn across it.
fn turned(n: Vector, turn: Vector) -> Vector {
    let sum = [0, 1, 2].map(|axis: usize| n[axis] + turn[axis]);
    let length = dot(&sum, &sum).sqrt();
    sum.map(|part| part / length)
}

impl Expansion {
    /// Returns Newton's step with a damped Hessian matrix; `None` if it does not lead downwards.
    fn step(&self, damping: f64) -> Option<Vec<f64>> {
        let factors = self.band.factors(damping)?;
        let mut step = factors.solved(self.gradient.iter().map(|value| -value).collect());
        let (factor, slopes) = &self.field;
        // Sherman and Morrison. A negative factor must leave the matrix positive.
        let solved = factors.solved(slopes.clone());
        let over = 1.0 + factor * dot(slopes, &solved);
        if over <= 1e-12 {
            return None;
        }
        let share = factor * dot(slopes, &step) / over;
        step.iter_mut().zip(&solved).for_each(|(value, solved)| *value -= share * solved);
        (dot(&step, &self.gradient) <= 0.0).then_some(step)
    }
}

/// A symmetric matrix by rows: the diagonal, and three elements to its left, the nearest one first. Or its factors `L D L^T`.
#[derive(Default)]
struct Band {
    rows: Vec<[f64; 4]>,
}

impl Band {
    /// Returns the factors, with this on the diagonal in addition; `None` if the matrix is not positive.
    fn factors(&self, more: f64) -> Option<Self> {
        let mut rows = self.rows.clone();
        for row in 0..rows.len() {
            rows[row][0] += more;
            for column in row.saturating_sub(3)..=row {
                let before = row.saturating_sub(3)..column;
                let sum: f64 =
                    before.map(|k| rows[row][row - k] * rows[k][0] * rows[column][column - k]).sum();
                let value = rows[row][row - column] - sum;
                rows[row][row - column] = if column < row { value / rows[column][0] } else { value };
            }
            if rows[row][0] <= 0.0 {
                return None;
            }
        }
        Some(Self { rows })
    }

    /// Solves for a right side, by the factors.
    fn solved(&self, mut values: Vec<f64>) -> Vec<f64> {
        for row in 0..values.len() {
            for k in row.saturating_sub(3)..row {
                values[row] -= self.rows[row][row - k] * values[k];
            }
        }
        values.iter_mut().zip(&self.rows).for_each(|(value, row)| *value /= row[0]);
        for row in (0..values.len()).rev() {
            for k in row.saturating_sub(3)..row {
                values[k] -= self.rows[row][row - k] * values[row];
            }
        }
        values
    }
}
