//! The director of a nematic cell at a voltage, by one-dimensional Frank-Oseen theory.
//!
//! **Model.** Between two plane electrodes the director depends on depth only: tilt `theta(z)` out of the panel and azimuth `phi(z)`, both
//! fixed at the surfaces (strong anchoring). It has the least free energy at this voltage, per area
//!
//! `integral of [k(theta) theta'^2 + a(theta) phi'^2]/2 dz - epsilon_0 U^2/2 / (integral of dz/epsilon(theta))`,
//!
//! with `k = K11 cos^2 + K33 sin^2`, `a = (K22 cos^2 + K33 sin^2) cos^2` and `epsilon` the permittivity along the normal. The field follows
//! from the director by `D = const`, the azimuth by `a phi' = const`: both leave a problem in the tilt alone.
//!
//! **Parameters.** Elastic constants in pN, relative permittivities at the frequency of the drive (usually 1 kHz), volts rms. The thickness does not
//! matter: lengths are fractions of the gap.
//!
//! **Method.** Tilts at [`INTERVALS`]` + 1` depths, energies by the midpoint rule (error of second order), Newton's method with a line
//! search on the energy. Both integrals couple all depths, by one term of rank one each; the rest of the Hessian matrix is tridiagonal. The voltage rises from
//! 0 in steps, so that the director is the one that a drive reaches. Among two equivalent ones of a cell without pretilt, the one with
//! a positive change of tilt is found.
//!
//! **Validity.** No flexoelectricity, ions, chiral dopant, finite anchoring, flow or change of the order.
//!
//! Source: F. C. Frank, Discuss. Faraday Soc. 25, 19 (1958); H. J. Deuling, Mol. Cryst. Liq. Cryst. 19, 123 (1972); I. W. Stewart, "The Static
//! and Dynamic Continuum Theory of Liquid Crystals" (2004), chapter 3.

use crate::OpticsError;

/// Number of intervals of depth.
pub const INTERVALS: usize = 400;

/// Permittivity of vacuum, pN/V^2.
const EPSILON_0: f64 = 8.854_187_812_8;

/// Largest step of the voltage while it rises, V, and the fewest steps.
const STEP_V: f64 = 0.5;
const FEWEST_STEPS: usize = 4;

/// Change of tilt in the middle from which each voltage begins, radians.
const NUDGE: f64 = 1e-2;

/// Iterations for one voltage, and the largest step of a tilt that ends them, radians.
const MOST_ITERATIONS: usize = 500;
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
    /// Voltage, rms.
    pub volts: f64,
}

/// Director by depth.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    /// Tilt at equal steps of depth from the top, degrees.
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
/// let cell = DrivenCell { nematic, tilt_deg: [0.0; 2], twist_deg: 0.0, volts: 1.0 };
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
        (cell.volts.is_finite() && cell.volts >= 0.0, "volts", "0 or more"),
    ];
    for (is_right, what, expected) in checks {
        if !is_right {
            return Err(OpticsError::Axis { what, expected });
        }
    }
    let mut problem = Problem::new(cell);
    let [top, bottom] = cell.tilt_deg.map(f64::to_radians);
    let at = |k: usize| top + (bottom - top) * k as f64 / INTERVALS as f64;
    let mut tilt: Vec<f64> = (0..=INTERVALS).map(at).collect();
    let steps = ((cell.volts / STEP_V).ceil() as usize).max(FEWEST_STEPS);
    for step in 0..=steps {
        problem.square_volts = (cell.volts * step as f64 / steps as f64).powi(2);
        problem.settle(&mut tilt);
    }
    let twist = problem.twist(&tilt);
    Ok(Profile {
        energy_pn: problem.energy(&tilt),
        tilt_deg: tilt.iter().map(|tilt| tilt.to_degrees()).collect(),
        twist_deg: twist.iter().map(|twist| twist.to_degrees()).collect(),
    })
}

/// A function of tilt with its first two derivatives.
type Jet = [f64; 3];

/// A factor, and the function of tilt by whose integral it is divided.
type Integral = (f64, fn(&Problem, f64) -> Jet);

/// The energy in units of pN, as a function of the tilts.
struct Problem {
    elastic: [f64; 3],
    permittivity: [f64; 2],
    twist: f64,
    square_volts: f64,
}

/// Gradient and Hessian matrix of the energy in the inner tilts: tridiagonal, plus `factor * direction direction^T` twice.
struct Expansion {
    gradient: Vec<f64>,
    diagonal: Vec<f64>,
    beside: Vec<f64>,
    rank_one: [(f64, Vec<f64>); 2],
}

impl Problem {
    fn new(cell: &DrivenCell) -> Self {
        Self {
            elastic: cell.nematic.elastic_pn,
            permittivity: cell.nematic.permittivity,
            twist: cell.twist_deg.to_radians(),
            square_volts: 0.0,
        }
    }

    /// Returns `across + (along - across) sin^2` of a tilt.
    fn mixed([across, along]: [f64; 2], tilt: f64) -> Jet {
        let ((sin, cos), more) = (tilt.sin_cos(), along - across);
        let double = 2.0 * sin * cos;
        [across + more * sin * sin, more * double, 2.0 * more * (cos * cos - sin * sin)]
    }

    fn inverse([value, first, second]: Jet) -> Jet {
        let over = 1.0 / value;
        [over, -first * over * over, (2.0 * first * first * over - second) * over * over]
    }

    /// Elastic constant of a change of tilt.
    fn stiffness(&self, tilt: f64) -> Jet {
        Self::mixed([self.elastic[0], self.elastic[2]], tilt)
    }

    /// Inverse of that of a change of azimuth, which the normal direction does not resist.
    fn over_twist(&self, tilt: f64) -> Jet {
        let a = Self::mixed([self.elastic[1], self.elastic[2]], tilt);
        let b = Self::mixed([1.0, 1e-9], tilt);
        Self::inverse([a[0] * b[0], a[1] * b[0] + a[0] * b[1], a[2] * b[0] + 2.0 * a[1] * b[1] + a[0] * b[2]])
    }

    /// Inverse of the permittivity along the normal.
    fn over_permittivity(&self, tilt: f64) -> Jet {
        let [along, across] = self.permittivity;
        Self::inverse(Self::mixed([across, along], tilt))
    }

    /// The energies `c/(integral of w)`: c and w of the twist and of the field.
    fn integrals(&self) -> [Integral; 2] {
        [
            (0.5 * self.twist * self.twist, Self::over_twist),
            (-0.5 * EPSILON_0 * self.square_volts, Self::over_permittivity),
        ]
    }

    fn energy(&self, tilt: &[f64]) -> f64 {
        let h = 1.0 / INTERVALS as f64;
        let pairs = || tilt.windows(2).map(|pair| (0.5 * (pair[0] + pair[1]), pair[1] - pair[0]));
        let elastic: f64 =
            pairs().map(|(mean, change)| 0.5 * self.stiffness(mean)[0] * change * change / h).sum();
        let others = self.integrals().map(|(factor, weight)| {
            if factor == 0.0 {
                0.0
            } else {
                factor / (h * pairs().map(|(mean, _)| weight(self, mean)[0]).sum::<f64>())
            }
        });
        elastic + others[0] + others[1]
    }

    fn expansion(&self, tilt: &[f64]) -> Expansion {
        let (h, count) = (1.0 / INTERVALS as f64, tilt.len());
        let (mut gradient, mut diagonal, mut beside) = (vec![0.0; count], vec![0.0; count], vec![0.0; count]);
        for k in 0..INTERVALS {
            let (mean, change) = (0.5 * (tilt[k] + tilt[k + 1]), tilt[k + 1] - tilt[k]);
            let [value, first, second] = self.stiffness(mean).map(|k| k / h);
            let (slope, curve) = (0.25 * first * change * change, 0.125 * second * change * change);
            gradient[k] += slope - value * change;
            gradient[k + 1] += slope + value * change;
            diagonal[k] += curve - first * change + value;
            diagonal[k + 1] += curve + first * change + value;
            beside[k] += curve - value;
        }
        let rank_one = self.integrals().map(|(factor, weight)| {
            let mut slopes = vec![0.0; count];
            if factor == 0.0 {
                return (0.0, slopes);
            }
            let jets: Vec<Jet> =
                tilt.windows(2).map(|pair| weight(self, 0.5 * (pair[0] + pair[1])).map(|w| w * h)).collect();
            let sum: f64 = jets.iter().map(|jet| jet[0]).sum();
            let rate = -factor / (sum * sum);
            for (k, [_, first, second]) in jets.into_iter().enumerate() {
                slopes[k] += 0.5 * first;
                slopes[k + 1] += 0.5 * first;
                diagonal[k] += 0.25 * rate * second;
                diagonal[k + 1] += 0.25 * rate * second;
                beside[k] += 0.25 * rate * second;
            }
            gradient.iter_mut().zip(&slopes).for_each(|(sum, slope)| *sum += rate * slope);
            (2.0 * factor / sum.powi(3), slopes)
        });
        let inner = |mut values: Vec<f64>| {
            values.pop();
            values.remove(0);
            values
        };
        let rank_one = rank_one.map(|(factor, slopes)| (factor, inner(slopes)));
        let mut beside = inner(beside);
        beside.pop();
        Expansion { gradient: inner(gradient), diagonal: inner(diagonal), beside, rank_one }
    }

    /// Moves the tilts to the nearest minimum of the energy.
    fn settle(&self, tilt: &mut Vec<f64>) {
        let (last, sign) = (tilt.len() - 1, Self::nudge_sign(tilt));
        for (k, tilt) in tilt.iter_mut().enumerate() {
            *tilt += sign * NUDGE * (std::f64::consts::PI * k as f64 / last as f64).sin();
        }
        let mut energy = self.energy(tilt);
        let mut damping = 0.0;
        for _ in 0..MOST_ITERATIONS {
            let expansion = self.expansion(tilt);
            let scale = expansion.diagonal.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
            let step = loop {
                match expansion.step(damping * scale) {
                    Some(step) => break step,
                    None => damping = f64::max(4.0 * damping, 1e-8),
                }
                if damping > 1e6 {
                    return;
                }
            };
            let largest = step.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
            let mut length = (0.5 / largest).min(1.0);
            let moved = loop {
                let mut next = tilt.clone();
                next[1..last].iter_mut().zip(&step).for_each(|(tilt, step)| *tilt += length * step);
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
            (*tilt, energy) = (next, found);
            damping = if length == 1.0 { damping / 8.0 } else { damping };
            if damping < 1e-10 {
                damping = 0.0;
            }
            if largest * length < SETTLED {
                return;
            }
        }
    }

    /// Upwards from a flat director, away from the normal from a standing one; the reverse of both where it points down.
    fn nudge_sign(tilt: &[f64]) -> f64 {
        let mean = 0.5 * (tilt[0] + tilt[tilt.len() - 1]);
        let is_standing = mean.abs() > std::f64::consts::FRAC_PI_4;
        if (mean < 0.0) == is_standing { 1.0 } else { -1.0 }
    }

    /// Azimuths from the top, by a constant torque.
    fn twist(&self, tilt: &[f64]) -> Vec<f64> {
        let weights: Vec<f64> =
            tilt.windows(2).map(|pair| self.over_twist(0.5 * (pair[0] + pair[1]))[0]).collect();
        let total: f64 = weights.iter().sum();
        let mut sum = 0.0;
        let mut out = vec![0.0];
        out.extend(weights.iter().map(|weight| {
            sum += weight;
            self.twist * sum / total
        }));
        out
    }
}

impl Expansion {
    /// Returns Newton's step with a damped Hessian matrix; `None` if it does not lead downwards.
    fn step(&self, damping: f64) -> Option<Vec<f64>> {
        let downhill: Vec<f64> = self.gradient.iter().map(|value| -value).collect();
        let mut step = self.solved(damping, &downhill)?;
        // Sherman-Morrison, one term after the other.
        let mut directions: Vec<(f64, &Vec<f64>, Vec<f64>)> = Vec::new();
        for (factor, direction) in &self.rank_one {
            if *factor == 0.0 {
                continue;
            }
            let mut solved = self.solved(damping, direction)?;
            for (factor, direction, before) in &directions {
                corrected(&mut solved, *factor, direction, before);
            }
            // A negative factor must leave the matrix positive.
            if 1.0 + factor * dot(direction, &solved) <= 1e-12 {
                return None;
            }
            directions.push((*factor, direction, solved));
        }
        for (factor, direction, solved) in &directions {
            corrected(&mut step, *factor, direction, solved);
        }
        (dot(&step, &self.gradient) <= 0.0).then_some(step)
    }

    /// Returns the solution with the tridiagonal part; `None` if it is not positive.
    fn solved(&self, damping: f64, right: &[f64]) -> Option<Vec<f64>> {
        let count = right.len();
        let (mut ratios, mut out) = (vec![0.0; count], right.to_vec());
        let mut pivot = self.diagonal[0] + damping;
        for k in 0..count {
            if k > 0 {
                ratios[k - 1] = self.beside[k - 1] / pivot;
                pivot = self.diagonal[k] + damping - self.beside[k - 1] * ratios[k - 1];
                out[k] -= self.beside[k - 1] * out[k - 1];
            }
            if pivot <= 0.0 {
                return None;
            }
            out[k] /= pivot;
        }
        for k in (0..count - 1).rev() {
            out[k] -= ratios[k] * out[k + 1];
        }
        Some(out)
    }
}

/// Corrects a solution for a matrix that has `factor * direction direction^T` in addition; `solved` is that of `direction` without it.
fn corrected(solution: &mut [f64], factor: f64, direction: &[f64], solved: &[f64]) {
    let share = factor * dot(direction, solution) / (1.0 + factor * dot(direction, solved));
    solution.iter_mut().zip(solved).for_each(|(value, solved)| *value -= share * solved);
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
