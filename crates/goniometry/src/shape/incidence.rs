//! Smooth lobe of one incidence: its value in any direction, and its total.

use std::f64::consts::PI;

use papilio_optics::Beta;

use super::abscissa;
use super::cells::{Cells, SAME_DEG};
use super::line::Line;

/// Numbers of steps of Simpson's rule in radius and of the trapezoidal rule in azimuth.
const RADIAL_STEPS: usize = 96;
const AROUND: usize = 48;

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Incidence {
    pub(super) theta_deg: f64,
    pub(super) beta: f64,
    /// Approximate distance at which the lobe falls to half its peak; sets the steps of integrals.
    pub(super) half: f64,
    /// Azimuths about the specular direction, radians, 0 (towards the normal) to pi.
    pub(super) azimuths: Vec<f64>,
    pub(super) lines: Vec<Line>,
    /// Distance of the last point of each line.
    pub(super) lengths: Vec<f64>,
    /// True for linear interpolation between azimuths; otherwise logarithmic where both lines are positive.
    pub(super) linear: bool,
    /// Cosine of the distance from the specular direction beyond which values are unknown and taken as 0.
    pub(super) ends_at: Option<f64>,
    /// Smallest distance, degrees, at which measured cells end before the horizon.
    pub(super) measured_to_deg: Option<f64>,
    /// `|beta|` of the scattered light beyond which values are unknown and taken as 0.
    pub(super) within: f64,
}

impl Incidence {
    /// Lobe through these cells, up to a `|beta|` of the scattered light. With `tails`, it is extrapolated beyond the last
    /// measured distance.
    pub(super) fn new(cells: &Cells, width: f64, tails: bool, within: f64) -> Self {
        let line = |points: &Vec<[f64; 2]>| {
            let x = points.iter().map(|[delta, _]| abscissa(*delta, width)).collect();
            Line::new(x, &points.iter().map(|[_, f]| *f).collect::<Vec<_>>())
        };
        Self {
            theta_deg: cells.theta_deg,
            beta: cells.theta_deg.to_radians().sin(),
            half: cells.half().min(width),
            azimuths: cells.azimuths.clone(),
            lines: cells.lines.iter().map(line).collect(),
            lengths: cells
                .lines
                .iter()
                .map(|points| points.last().map_or(0.0, |[delta, _]| *delta))
                .collect(),
            linear: false,
            ends_at: cells.limit_deg.filter(|_| !tails).map(|limit| (limit + SAME_DEG).to_radians().cos()),
            measured_to_deg: cells.measured_to_deg,
            within,
        }
    }

    pub(super) fn value(&self, delta: Beta, width: f64) -> f64 {
        let is_inclined = (self.beta + delta.x).hypot(delta.y) > self.within;
        if is_inclined || self.ends_at.is_some_and(|cosine| self.cosine(delta) < cosine) {
            0.0
        } else {
            self.extrapolated(delta, width)
        }
    }

    /// The value, extrapolated beyond the end of the lobe.
    pub(super) fn extrapolated(&self, delta: Beta, width: f64) -> f64 {
        let x = abscissa(delta.length(), width);
        let azimuth = self.azimuth(delta);
        let upper = self.azimuths.partition_point(|known| *known <= azimuth).min(self.azimuths.len() - 1);
        let lower = upper.saturating_sub(1);
        let step = self.azimuths[upper] - self.azimuths[lower];
        let t = if step > 0.0 { ((azimuth - self.azimuths[lower]) / step).clamp(0.0, 1.0) } else { 0.0 };
        let [a, b] = [lower, upper].map(|k| self.lines[k].value(x));
        if a > 0.0 && b > 0.0 && !self.linear { a.powf(1.0 - t) * b.powf(t) } else { (1.0 - t) * a + t * b }
    }

    /// Returns true if `delta` is on the hemisphere and within the measured length of the lines of its
    /// azimuth.
    pub(super) fn is_known(&self, delta: Beta) -> bool {
        let length = delta.length();
        if length == 0.0 {
            return true;
        }
        let azimuth = self.azimuth(delta);
        let upper = self.azimuths.partition_point(|known| *known <= azimuth).min(self.azimuths.len() - 1);
        let lower = upper.saturating_sub(1);
        let step = self.azimuths[upper] - self.azimuths[lower];
        let t = if step > 0.0 { ((azimuth - self.azimuths[lower]) / step).clamp(0.0, 1.0) } else { 0.0 };
        let last = (1.0 - t) * self.lengths[lower] + t * self.lengths[upper];
        self.reach(delta) >= 1.0 && length <= last
    }

    /// Azimuth about the specular direction, radians, 0 to pi. For a direction beyond the hemisphere, the
    /// azimuth where its line leaves the hemisphere.
    fn azimuth(&self, delta: Beta) -> f64 {
        let [x, y, z] = self.direction(delta);
        let cos = (1.0 - self.beta * self.beta).sqrt();
        y.abs().atan2(self.beta * z - cos * x)
    }

    /// Cosine of the angle from the specular direction; beyond the hemisphere, that of the point where the
    /// line leaves it.
    fn cosine(&self, delta: Beta) -> f64 {
        let [x, _, z] = self.direction(delta);
        self.beta * x + (1.0 - self.beta * self.beta).sqrt() * z
    }

    /// Unit vector at `delta` from the specular direction, limited to the horizon.
    fn direction(&self, delta: Beta) -> [f64; 3] {
        let reach = self.reach(delta);
        let k = if reach < 1.0 { reach } else { 1.0 };
        let (x, y) = (self.beta + k * delta.x, k * delta.y);
        [x, y, (1.0 - x * x - y * y).max(0.0).sqrt()]
    }

    /// Distance from the specular direction at which the lobe ends, in the direction of a unit vector;
    /// infinity if it does not end before the horizon. On a line, the angle from the specular direction
    /// increases with the distance.
    pub(super) fn end(&self, unit: Beta) -> f64 {
        let Some(cosine) = self.ends_at else { return f64::INFINITY };
        let cosine_at = |distance: f64| self.cosine(Beta { x: distance * unit.x, y: distance * unit.y });
        let (mut inner, mut outer) = (0.0, self.reach(unit));
        if cosine_at(outer) >= cosine {
            return f64::INFINITY;
        }
        for _ in 0..50 {
            let middle = 0.5 * (inner + outer);
            if cosine_at(middle) >= cosine { inner = middle } else { outer = middle }
        }
        inner
    }

    /// The lobe on a coarser grid of azimuths: every other one, and the last; `None` for less than three.
    pub(super) fn with_fewer_azimuths(&self) -> Option<Self> {
        let last = self.azimuths.len().checked_sub(1).filter(|last| *last > 1)?;
        let retained = || (0..=last).filter(|k| k.is_multiple_of(2) || *k == last);
        Some(Self {
            azimuths: retained().map(|k| self.azimuths[k]).collect(),
            lines: retained().map(|k| self.lines[k].clone()).collect(),
            lengths: retained().map(|k| self.lengths[k]).collect(),
            ..*self
        })
    }

    /// Distances from the specular direction, in the direction of a unit vector, between which the scattered light is within its
    /// largest `|beta|`.
    fn inclined(&self, unit: Beta) -> [f64; 2] {
        if self.within == f64::INFINITY {
            return [0.0, f64::INFINITY];
        }
        let (along, across) = (self.beta * unit.x, self.beta * unit.y);
        let squared = self.within * self.within - across * across;
        if squared < 0.0 { [0.0; 2] } else { [(-along - squared.sqrt()).max(0.0), squared.sqrt() - along] }
    }

    /// Multiple of `delta` that reaches from the specular direction to the edge of the hemisphere.
    fn reach(&self, delta: Beta) -> f64 {
        let squared = delta.squared();
        if squared == 0.0 {
            return f64::INFINITY;
        }
        let half = self.beta * delta.x / squared;
        ((half * half + (1.0 - self.beta * self.beta) / squared).sqrt() - half).max(0.0)
    }

    /// Integral by the trapezoidal rule in azimuth and Simpson's rule in `ln(1 + (|delta|/half)^2)`, where
    /// lobes are smooth.
    pub(super) fn total(&self, width: f64, radius: f64) -> f64 {
        let mut sum = 0.0;
        for around in 0..=AROUND {
            let (sin, cos) = (PI * around as f64 / AROUND as f64).sin_cos();
            let ends = if around == 0 || around == AROUND { 0.5 } else { 1.0 };
            let unit = Beta { x: cos, y: sin };
            let [inner, outer] = self.inclined(unit);
            let edge = self.reach(unit).min(radius).min(self.end(unit)).min(outer);
            if edge <= inner {
                continue;
            }
            let first = abscissa(inner, self.half);
            let step = (abscissa(edge, self.half) - first) / RADIAL_STEPS as f64;
            for k in 0..=RADIAL_STEPS {
                let simpson = if k == 0 || k == RADIAL_STEPS { 1.0 } else { 2.0 + 2.0 * (k % 2) as f64 };
                let x = first + k as f64 * step;
                let delta = (self.half * x.exp_m1().sqrt()).min(edge);
                let f = self.extrapolated(Beta { x: delta * cos, y: delta * sin }, width);
                sum += ends * simpson * step / 3.0 * 0.5 * self.half * self.half * x.exp() * f;
            }
        }
        // The factor 2 is for both half planes.
        2.0 * sum * PI / AROUND as f64
    }
}
