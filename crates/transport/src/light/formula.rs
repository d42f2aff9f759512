//! Light by a formula: radiance is known in every direction, and so are the places where it is not smooth.
//!
//! # Method
//! Integrals over directions use polar coordinates about an axis: the display's normal, or that of a field
//! of view. A formula gives the circles of the sphere on which it is not smooth: edges, angles of a table, a
//! horizon, or (circles of radius zero) a sun. On a circle about the axis, the distance to such a circle is
//! a function of the cosine of the azimuth. The intersections, or their distance from the real line, are
//! thus known, and rules are graded there ([`quadrature`](crate::numerics::quadrature)). Over inclination,
//! panels end where circles touch.
//!
//! All `digits` are natural: the requested error is `exp(-digits)`.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::fmt::Debug;
use std::sync::Arc;

use crate::Cone;
use crate::numerics::quadrature::{MOST_POINTS, Node, Pole, gauss, panels, points_for};

/// Radiance by direction.
pub trait Radiance: Debug + Send + Sync {
    /// Returns the radiance of light that comes from this direction: a unit vector away from the display, z
    /// its normal.
    fn at(&self, direction: [f64; 3]) -> f64;

    /// Returns the circles on which it is not smooth.
    fn edges(&self) -> Vec<Edge>;

    /// Returns the inclinations beyond which it is dark, radians.
    fn span(&self) -> [f64; 2] {
        [0.0, FRAC_PI_2]
    }

    /// Returns true if it is uniform between its edges.
    fn is_even(&self) -> bool {
        false
    }

    /// Returns true if it depends on the azimuth, even where its edges do not.
    fn has_azimuths(&self) -> bool {
        false
    }
}

/// A circle on the sphere of directions at which a radiance is not smooth; a point if its radius is zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Edge {
    /// Its centre, a unit vector.
    pub centre: [f64; 3],
    /// Its angular radius.
    pub radius: f64,
    /// Distance from it over which the radiance changes fast, radians; infinite if it is smooth on either
    /// side.
    pub scale: f64,
}

/// Polar coordinates: the axis, and the azimuths 0 and 90 deg.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Polar([[f64; 3]; 3]);

impl Polar {
    /// Coordinates about the display's normal.
    pub(crate) const NORMAL: Self = Self([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);

    /// Returns coordinates about the direction that a mirror shows in the middle of this field of view.
    pub(crate) fn mirrored(view: &Cone) -> Self {
        Self(view.frame().map(|[x, y, z]| [-x, -y, z]))
    }

    fn at(&self, angle: f64, turn: f64) -> [f64; 3] {
        let ((sin, cos), (sin_turn, cos_turn)) = (angle.sin_cos(), turn.sin_cos());
        let Self([out, side, axis]) = self;
        std::array::from_fn(|i| sin * (cos_turn * out[i] + sin_turn * side[i]) + cos * axis[i])
    }

    fn sees(&self, edge: &Edge) -> PolarCircle {
        let dot = |a: &[f64; 3]| a.iter().zip(&edge.centre).map(|(a, b)| a * b).sum::<f64>();
        let [out, side, along] = [dot(&self.0[0]), dot(&self.0[1]), dot(&self.0[2])];
        PolarCircle {
            distance: out.hypot(side).atan2(along),
            turn: side.atan2(out),
            radius: edge.radius,
            scale: edge.scale,
        }
    }
}

/// A circle in polar coordinates.
#[derive(Debug, Clone, Copy)]
struct PolarCircle {
    /// Distance of its centre from the axis.
    distance: f64,
    turn: f64,
    radius: f64,
    scale: f64,
}

/// Largest distance of its centre from the axis at which a circle is concentric.
const CONCENTRIC: f64 = 1e-9;

impl PolarCircle {
    fn is_concentric(&self) -> bool {
        self.distance < CONCENTRIC || self.distance > PI - CONCENTRIC
    }

    /// Returns the angles from the axis at which it begins and ends.
    fn ends(&self) -> [f64; 2] {
        let sum = self.distance + self.radius;
        [(self.distance - self.radius).abs(), if sum > PI { TAU - sum } else { sum }]
    }

    /// Returns the poles of integrals over circles about the axis, by their angle, and the breaks.
    fn over_angle(&self, finest: f64) -> impl Iterator<Item = (f64, Option<f64>)> {
        let off = if self.is_concentric() {
            // PolarCircle from a point on the axis everything is smooth.
            (self.radius > 0.0 && self.scale.is_finite()).then_some(self.scale.max(finest))
        } else {
            // Where circles touch there is a square root; about a point, a logarithm.
            Some(finest)
        };
        self.ends().into_iter().map(move |at| (at, off))
    }

    /// Adds the same on a circle about the axis: azimuths that end panels, and poles.
    fn around(&self, angle: f64, finest: f64, breaks: &mut Vec<f64>, poles: &mut Vec<Pole>) {
        let product = angle.sin() * self.distance.sin();
        if self.is_concentric() || product <= 0.0 {
            return;
        }
        let cosine = (self.radius.cos() - angle.cos() * self.distance.cos()) / product;
        let pole = |at: f64, off: f64| Pole { at, off: off.max(finest) };
        if self.radius == 0.0 {
            // By half angles: 1 + this.
            let excess = 2.0 * (0.5 * (angle - self.distance)).sin().powi(2) / product;
            poles.push(pole(self.turn, 2.0 * (0.5 * excess).sqrt().asinh()));
        } else if cosine.abs() < 1.0 {
            let half = cosine.acos();
            let slope = product * half.sin() / self.radius.sin();
            for at in [self.turn - half, self.turn + half] {
                breaks.push(at);
                if self.scale.is_finite() {
                    poles.push(pole(at, self.scale / slope));
                }
            }
        } else if self.scale.is_finite() {
            let at = if cosine > 0.0 { self.turn } else { self.turn + PI };
            poles.push(pole(at, cosine.abs().acosh()));
        }
    }
}

/// A formula in polar coordinates.
#[derive(Debug, Clone)]
pub(crate) struct Formula {
    radiance: Arc<dyn Radiance>,
    polar: Polar,
    seen: Vec<PolarCircle>,
}

/// Natural digits that rules over formulas have in addition to those of the result: they cost little.
const MORE_DIGITS: f64 = 3.0;
/// Number of points on a circle above which, or in the presence of edges, rules are graded.
const MOST_EVEN: f64 = 96.0;

impl Formula {
    pub(crate) fn new(radiance: Arc<dyn Radiance>, polar: Polar) -> Self {
        let seen = radiance.edges().iter().map(|edge| polar.sees(edge)).collect();
        Self { radiance, polar, seen }
    }

    /// The radiances by direction.
    pub(crate) fn of_light(&self) -> Arc<dyn Radiance> {
        Arc::clone(&self.radiance)
    }

    /// Returns the same formula in other coordinates.
    pub(crate) fn about(&self, polar: Polar) -> Self {
        Self::new(self.radiance.clone(), polar)
    }

    pub(crate) fn radiance(&self, direction: [f64; 3]) -> f64 {
        self.radiance.at(direction)
    }

    pub(crate) fn span(&self) -> [f64; 2] {
        self.radiance.span()
    }

    /// Returns true if it is the same at all azimuths.
    pub(crate) fn is_round(&self) -> bool {
        !self.radiance.has_azimuths() && self.seen.iter().all(PolarCircle::is_concentric)
    }

    /// Returns the irradiance: the integral over the hemisphere by area of direction cosines.
    pub(crate) fn irradiance(&self) -> f64 {
        let [from, to] = self.span();
        let nodes = self.over_angle(from, to, DIGITS_OF_WHOLE, 0.0);
        let ring = |node: &Node| self.harmonics(node.x, DIGITS_OF_WHOLE, 0)[0][0];
        nodes.iter().map(|node| node.weight * node.x.sin() * node.x.cos() * ring(node)).sum()
    }

    /// Returns a rule over angles from the axis for products with polynomials of this degree.
    pub(crate) fn over_angle(&self, from: f64, to: f64, digits: f64, degree: f64) -> Vec<Node> {
        let finest = (-0.5 * digits).exp();
        let (mut breaks, mut poles) = (Vec::new(), Vec::new());
        // Edges farther away have no influence, and a table has many rows.
        let near = (from - 2.0 * (to - from))..=(to + 2.0 * (to - from));
        let ends = self.seen.iter().flat_map(|seen| seen.over_angle(finest));
        for (at, off) in ends.filter(|(at, _)| near.contains(at)) {
            breaks.push(at);
            poles.extend(off.map(|off| Pole { at, off }));
        }
        let mut nodes = Vec::new();
        panels(from, to, &breaks, &poles, &mut |start, end, ellipse: f64| {
            let own = points_for(digits + MORE_DIGITS, 2.0 * ellipse.ln());
            let others = (0.5 * degree * (end - start) / (to - from)).ceil() as usize;
            nodes.extend(gauss(start, end, own + others));
        });
        nodes
    }

    /// Returns a rule over a circle about the axis for products with this many azimuthal orders.
    pub(crate) fn around(&self, angle: f64, digits: f64, orders: usize) -> Vec<Node> {
        let finest = (-digits / 3.0).exp();
        let (mut breaks, mut poles) = (Vec::new(), Vec::new());
        self.seen.iter().for_each(|seen| seen.around(angle, finest, &mut breaks, &mut poles));
        let nearest = poles.iter().map(|pole| pole.off).fold(LEAST_SMOOTH, f64::min);
        let even = ((digits + MORE_DIGITS) / nearest).ceil();
        if breaks.is_empty() && even <= MOST_EVEN {
            let count = orders + even as usize + 1;
            let step = TAU / count as f64;
            return (0..count).map(|k| Node { x: k as f64 * step, weight: step }).collect();
        }
        let start = breaks.first().or(poles.first().map(|pole| &pole.at)).copied().unwrap_or(0.0);
        let turn = |at: f64| start + (at - start).rem_euclid(TAU);
        breaks.iter_mut().for_each(|at| *at = turn(*at));
        let again = poles.iter().flat_map(|pole| {
            let at = turn(pole.at);
            [at - TAU, at, at + TAU].map(|at| Pole { at, ..*pole })
        });
        let mut nodes = Vec::new();
        panels(start, start + TAU, &breaks, &again.collect::<Vec<_>>(), &mut |from, to, ellipse: f64| {
            let own = points_for(digits + MORE_DIGITS, 2.0 * ellipse.ln());
            let waves = 0.25 * orders as f64 * (to - from);
            let pieces = (waves / (MOST_POINTS - own.min(MOST_POINTS - 8)) as f64).ceil().max(1.0);
            let step = (to - from) / pieces;
            for piece in 0..pieces as usize {
                let from = from + piece as f64 * step;
                nodes.extend(gauss(from, from + step, own + (waves / pieces).ceil() as usize));
            }
        });
        nodes
    }

    /// Returns the integrals of radiance times `exp(-i m turn)` over a circle about the axis, real and
    /// imaginary parts, for m = 0 and on, up to these orders or until they are smaller than the requested
    /// error.
    pub(crate) fn harmonics(&self, angle: f64, digits: f64, orders: usize) -> Vec<[f64; 2]> {
        if self.is_round() {
            return vec![[TAU * self.radiance.at(self.polar.at(angle, 0.0)), 0.0]];
        }
        if self.radiance.is_even() {
            return self.harmonics_of_arcs(angle, orders);
        }
        let mut up_to = orders.min(FEW_ORDERS);
        loop {
            let harmonics = self.harmonics_up_to(angle, digits, up_to);
            let least = (-digits - MORE_DIGITS).exp() * harmonics[0][0];
            let last = &harmonics[harmonics.len() - harmonics.len() / 4..];
            if up_to == orders || last.iter().all(|[re, im]| re.hypot(*im) <= least) {
                return harmonics;
            }
            up_to = (2 * up_to).min(orders);
        }
    }

    fn harmonics_up_to(&self, angle: f64, digits: f64, orders: usize) -> Vec<[f64; 2]> {
        let mut sums = vec![[0.0; 2]; orders + 1];
        // The rotation of each point, order by order.
        let points = self.around(angle, digits, orders).into_iter().map(|node| {
            let (sin, cos) = node.x.sin_cos();
            (node.weight * self.radiance.at(self.polar.at(angle, node.x)), [cos, -sin])
        });
        let (mut now, steps): (Vec<[f64; 2]>, Vec<[f64; 2]>) =
            points.map(|(light, step)| ([light, 0.0], step)).unzip();
        for sum in &mut sums {
            for (now, [cos, sin]) in now.iter_mut().zip(&steps) {
                let [re, im] = *now;
                sum[0] += re;
                sum[1] += im;
                *now = [re * cos - im * sin, re * sin + im * cos];
            }
        }
        sums
    }

    /// Returns the same in closed form for light that is uniform between edges.
    fn harmonics_of_arcs(&self, angle: f64, orders: usize) -> Vec<[f64; 2]> {
        let mut breaks = Vec::new();
        self.seen.iter().for_each(|seen| seen.around(angle, 0.0, &mut breaks, &mut Vec::new()));
        breaks.iter_mut().for_each(|at| *at = at.rem_euclid(TAU));
        breaks.sort_by(f64::total_cmp);
        let Some(first) = breaks.first().copied() else {
            return vec![[TAU * self.radiance.at(self.polar.at(angle, 0.0)), 0.0]];
        };
        breaks.push(first + TAU);
        let mut sums = vec![[0.0; 2]; orders + 1];
        for ends in breaks.windows(2) {
            let (middle, half) = (0.5 * (ends[0] + ends[1]), 0.5 * (ends[1] - ends[0]));
            let light = self.radiance.at(self.polar.at(angle, middle));
            if light == 0.0 {
                continue;
            }
            for (m, sum) in sums.iter_mut().enumerate() {
                let m = m as f64;
                let width = if m > 0.0 { 2.0 * (m * half).sin() / m } else { 2.0 * half };
                let (sin, cos) = (m * middle).sin_cos();
                sum[0] += light * width * cos;
                sum[1] -= light * width * sin;
            }
        }
        sums
    }

    /// Returns the radiance in these coordinates.
    pub(crate) fn seen_at(&self, angle: f64, turn: f64) -> f64 {
        self.radiance.at(self.polar.at(angle, turn))
    }
}

/// Natural digits of the light on the display: everything else is relative to it.
const DIGITS_OF_WHOLE: f64 = 24.0;
/// Azimuthal orders that are computed first.
const FEW_ORDERS: usize = 32;
/// Largest distance over azimuth over which a radiance is assumed to be smooth, radians.
const LEAST_SMOOTH: f64 = 0.7;
