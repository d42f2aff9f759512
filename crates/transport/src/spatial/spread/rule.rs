//! Directions at which the density of a spread is taken.
//!
//! **Rule.** The plane is divided into the cells of points that are nearer to one peak than to the others;
//! each is integrated in polar coordinates about its peak, with panels that are graded towards the peaks and
//! the rim of the disc of air.
//!
//! **Functions with kinks**, such as an area of a pixel at the place that is seen, converge slowly with any rule. [`SUMS`] sums over
//! other directions, each a rule of its own, tell the error that kinks cause; azimuths and radii of all are different. Their mean
//! has as many directions as the whole rule, and its error is no larger.

use std::f64::consts::PI;

use papilio_optics::Beta;
use papilio_optics::lobe::Lobe;

use super::pair::{Pair, Peak};
use super::{Incoming, Sample};
use crate::numerics::quadrature::{MOST_POINTS, MULTIPLE_POLES, Node, Pole, gauss, panels, points_for};

/// Number of sums over other directions: three degrees of freedom of their scatter.
pub(in crate::spatial) const SUMS: usize = 4;

/// Directions of a rule.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::spatial) enum Directions {
    /// All.
    Whole,
    /// Those of a sum of this number, below [`SUMS`].
    Sum(usize),
}

impl Directions {
    /// Number of azimuths, given that of smooth light and that of the whole rule: each sum resolves smooth light.
    fn count(self, smooth: f64, whole: f64) -> f64 {
        match self {
            Self::Whole => whole,
            Self::Sum(_) => (whole / SUMS as f64).max(smooth),
        }
    }

    /// The first of equal azimuths, in steps. Those of sums lie between each other in both halves of an odd number, none of
    /// them is a mirror image of another, and the errors of kinks along x and y through a peak cancel in their mean.
    fn first(self) -> f64 {
        match self {
            Self::Whole => 0.5,
            Self::Sum(number) => FIRST_OF_SUM + 0.5 * number as f64 / SUMS as f64,
        }
    }

    /// Points of a panel more than those of the whole rule.
    fn more_points(self) -> f64 {
        match self {
            Self::Whole => 0.0,
            Self::Sum(number) => number as f64 - 1.0,
        }
    }
}

/// Root of Bernoulli's second polynomial over twice the number of sums: where a kink on an axis through the peak, at a fourth of a
/// step, has no error of second order in the mean.
const FIRST_OF_SUM: f64 = 0.211_324_865_405_187_13 / (2 * SUMS) as f64;

/// Ray of a polar rule: its end, and the places near which the integrand changes quickly.
struct Ray {
    end: f64,
    breaks: Vec<f64>,
    poles: Vec<Pole>,
}

impl Pair {
    /// Calls `each` with the samples of scattered light, of all directions or those of a sum.
    pub(in crate::spatial) fn each_scattered(&self, directions: Directions, each: &mut dyn FnMut(Sample)) {
        let peaks = self.peaks();
        for (k, peak) in peaks.iter().enumerate() {
            let others: Vec<Peak> =
                peaks.iter().enumerate().filter(|(other, _)| *other != k).map(|(_, other)| *other).collect();
            for turn in self.turns(*peak, &others, directions) {
                let (sin, cos) = turn.x.sin_cos();
                let ray = self.ray(*peak, [cos, sin], &others);
                for node in self.along(peak.centre, [cos, sin], (&ray, directions)) {
                    let beta = peak.centre + Beta { x: node.x * cos, y: node.x * sin };
                    each(self.seen_along(beta, turn.weight * node.weight * node.x));
                }
            }
        }
    }

    /// Phase of the highest frequency at a shift of one thickness, radians.
    fn phase(&self) -> f64 {
        2.0 * PI * self.accuracy.most_per_mm * self.gap.thickness_mm
    }

    /// Largest shift whose phase azimuths resolve, in thicknesses: shifts grow without limit towards grazing
    /// light, of which there is little.
    fn around(&self) -> f64 {
        AROUND[usize::from(self.width() > WIDE)]
    }

    /// Number of azimuths that details of the light take besides the phase, over the number of digits.
    fn details(&self, peak: Peak) -> f64 {
        let width = self.width();
        let of_peak = peak.radius / width;
        match &self.light {
            // Where light is rough, far from the view, there is little of it.
            Incoming::Field(_) => of_peak + FIELD_DETAIL / width.sqrt(),
            // The rim of the disc of air is near the view.
            Incoming::Diffuse => {
                of_peak + peak.centre.squared() / (width.sqrt() + 1.0 - peak.centre.length()).max(0.05)
            }
            _ => of_peak,
        }
    }

    /// Azimuths about a peak. Where the border of its cell has a corner, a panel ends.
    fn turns(&self, peak: Peak, others: &[Peak], directions: Directions) -> Vec<Node> {
        let digits = self.accuracy.digits;
        let details = self.details(peak);
        if others.is_empty() {
            // A periodic integrand: the trapezoidal rule converges exponentially. Kinks of areas along a line through the peak come in
            // pairs on either side of it: an odd number of azimuths meets both differently.
            let smooth = digits * (2.0 + details);
            let count = directions.count(smooth, smooth + self.around() * self.phase()).ceil() as usize | 1;
            let step = 2.0 * PI / count as f64;
            return (0..count)
                .map(|k| Node { x: (k as f64 + directions.first()) * step, weight: step })
                .collect();
        }
        let mut ends: Vec<f64> = others.iter().flat_map(|other| self.corners(peak, *other)).collect();
        ends.sort_by(f64::total_cmp);
        let first = ends.first().copied().unwrap_or(0.0);
        ends.push(first + 2.0 * PI);
        let mut nodes = Vec::new();
        for pair in ends.windows(2) {
            let span = pair[1] - pair[0];
            let panels = (span * (8.0 + 4.0 * details) / PI).ceil().max(1.0);
            let smooth = panels * points_for(digits, 1.5) as f64;
            let whole = smooth + POINTS_PER_RADIAN * 0.5 * span * self.around() * self.phase();
            let wanted = directions.count(smooth, whole) + panels * directions.more_points();
            add_resolved([pair[0], pair[1]], wanted, panels, &mut nodes);
        }
        nodes
    }

    /// Azimuths at which the line between two peaks' cells meets the disc of the glass.
    fn corners(&self, peak: Peak, other: Peak) -> Vec<f64> {
        let (peak, other) = (peak.centre, other.centre);
        let (between, apart) = (0.5 * (peak + other), other - peak);
        let along = Beta { x: -apart.y / apart.length(), y: apart.x / apart.length() };
        let middle = between.x * along.x + between.y * along.y;
        let half = (middle * middle - between.squared() + self.gap.index.powi(2)).sqrt();
        [half, -half]
            .map(|half| {
                let corner = between + (half - middle) * along - peak;
                corner.y.atan2(corner.x).rem_euclid(2.0 * PI)
            })
            .to_vec()
    }

    fn ray(&self, peak: Peak, [cos, sin]: [f64; 2], others: &[Peak]) -> Ray {
        let along = |beta: Beta| beta.x * cos + beta.y * sin;
        let centre = peak.centre;
        // Where |peak + r u| is this radius.
        let reaches = |radius: f64| {
            let at = along(centre);
            -at + (at * at - centre.squared() + radius * radius).sqrt()
        };
        let width = self.width();
        let edge = reaches(self.rim());
        // Shifts grow without limit towards grazing light.
        let mut ray = Ray { end: edge, breaks: Vec::new(), poles: vec![Pole { at: edge, off: 0.02 * edge }] };
        if self.lobe == Lobe::Lambertian {
            return ray;
        }
        for other in others.iter().chain([&peak]) {
            let apart = other.centre - centre;
            let at = along(apart);
            let aside = (apart.squared() - at * at).max(0.0).sqrt();
            self.add_poles(at, aside, other.radius, &mut ray.poles);
            if at > 0.0 && other.centre != centre {
                ray.end = ray.end.min(0.5 * apart.squared() / at);
            }
        }
        match &self.light {
            Incoming::Diffuse => {
                let rim = reaches(1.0);
                // Change of |beta| along the ray.
                let slope = rim + along(centre);
                ray.poles.push(Pole { at: rim, off: width / slope.max(1e-3) });
                ray.breaks.push(rim);
            }
            Incoming::Field(_) => {
                let step = FIELD_STEP * width;
                let count = (reaches(1.0) / step).ceil().min(200.0);
                ray.poles.extend((1..=count as usize).map(|k| Pole { at: k as f64 * step, off: step }));
            }
            Incoming::Peak(_) | Incoming::Pixel => {}
        }
        ray
    }

    /// Adds the singularities of lobes around a disc of this radius whose centre is at `at` along a ray, and
    /// `aside` of it.
    fn add_poles(&self, at: f64, aside: f64, radius: f64, poles: &mut Vec<Pole>) {
        let width = self.width();
        let half = (radius * radius - aside * aside).max(0.0).sqrt();
        let off = (aside - radius).max(0.0).hypot(width);
        let steps = (2.0 * half / width).ceil().min(64.0);
        for k in 0..=steps as usize {
            let place = if steps > 0.0 { at + half * (2.0 * k as f64 / steps - 1.0) } else { at };
            poles.push(Pole { at: place, off });
        }
    }

    /// Rule along a ray: panels are divided until the phase of the highest frequency is resolved, too.
    fn along(&self, peak: Beta, [cos, sin]: [f64; 2], (ray, directions): (&Ray, Directions)) -> Vec<Node> {
        let index = self.gap.index;
        let most = self.around().max(3.0);
        let least = index * index / (1.0 + most * most);
        let turns_at = |r: f64| {
            let beta = peak + Beta { x: r * cos, y: r * sin };
            beta.length() / (index * index - beta.squared()).max(least).sqrt()
        };
        let mut nodes = Vec::new();
        panels(0.0, ray.end, &ray.breaks, &ray.poles, &mut |from, to, ellipse: f64| {
            let points = points_for(self.accuracy.digits + MULTIPLE_POLES, 2.0 * ellipse.ln()) as f64;
            let phase = self.phase() * (turns_at(to) - turns_at(from)).abs();
            let wanted = points + POINTS_PER_RADIAN * phase + directions.more_points();
            add_resolved([from, to], wanted, 1.0, &mut nodes);
        });
        nodes
    }
}

/// Adds a rule on an interval: at least so many points, in at least so many panels.
fn add_resolved([from, to]: [f64; 2], wanted: f64, panels: f64, nodes: &mut Vec<Node>) {
    let panels = (wanted / MOST_POINTS as f64).ceil().max(panels);
    let step = (to - from) / panels;
    for panel in 0..panels as usize {
        let from = from + step * panel as f64;
        nodes.extend(gauss(from, from + step, (wanted / panels).ceil() as usize));
    }
}

/// Points of Gauss's rules for each radian of phase.
const POINTS_PER_RADIAN: f64 = 0.6;

/// Shifts up to which azimuths resolve the phase, in thicknesses of the glass: beyond, light of a lobe that
/// is narrower than [`WIDE`] is weak.
const AROUND: [f64; 2] = [2.0, 5.0];
const WIDE: f64 = 0.1;

/// Distance of the panels of a field, in widths of the lobe, and the factor of its azimuths.
const FIELD_STEP: f64 = 2.0;
const FIELD_DETAIL: f64 = 0.7;
