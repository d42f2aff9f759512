//! Points of cones of directions: of fields of view and of round sources.

use std::f64::consts::PI;

use papilio_optics::Beta;

use super::Cone;
use crate::numerics::quadrature::{MOST_POINTS, Node, gauss, legendre, points_for};

/// A direction of a rule and its weight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Point {
    pub(crate) beta: Beta,
    pub(crate) weight: f64,
}

/// Returns the scale over a cone, for [`cone_points`], of a function that changes over `scale` in direction
/// cosines and over angles of the same size. Flat parts are smooth functions of the cosine of inclination,
/// which vanish with it at the horizon, so that their mean over a cone requires steps that are small
/// compared with it.
pub(crate) fn smooth_at(cone: &Cone, scale: f64) -> f64 {
    let cosine = (1.0 - cone.axis_towards().squared()).max(0.0).sqrt();
    // A cone of any width reaches beyond the smallest cosines.
    scale * cosine.max(cone.half_angle()).max(1e-9)
}

/// Returns points of a cone, with weights uniform in solid angle (or over its pupil) that sum to one, for functions that change
/// over a distance of `scale` (direction cosines: poles at this distance from the real plane). They are
/// symmetric about the cone's plane of incidence.
pub(crate) fn cone_points(cone: &Cone, scale: f64, digits: f64) -> Vec<Point> {
    cone_points_of(cone, scale, digits, Nodes::default())
}

/// Nodes of a rule over a cone in addition to those that its scale requires.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Nodes {
    /// Smallest number of rings. A rule that is the same at two levels gives no estimate of its error.
    pub(crate) rings: usize,
    /// Number of nodes of a table over the inclination across the cone: the fringes of a film have a few
    /// each.
    pub(crate) across: f64,
}

impl Nodes {
    /// Returns the number of additional rings and spokes. Both converge exponentially once there are two
    /// points for each few nodes.
    pub(crate) fn more(&self) -> usize {
        (0.5 * self.across) as usize
    }
}

/// Returns [`cone_points`] with this many more.
pub(crate) fn cone_points_of(cone: &Cone, scale: f64, digits: f64, nodes: Nodes) -> Vec<Point> {
    let half_angle = cone.half_angle();
    let size = half_angle / scale;
    if size * size <= (-digits).exp() {
        return vec![Point { beta: cone.axis_towards(), weight: 1.0 }];
    }
    let z = 1.0 + 2.0 / (size * size);
    let rings = points_for(digits, 2.0 * (z + (z * z - 1.0).sqrt()).ln()).min(digits as usize);
    let spokes = (digits / (1.0 / size).asinh()).ceil().clamp(3.0, 4.0 * digits) as usize;
    let more = nodes.more();
    let (rings, spokes) = ((rings + more).max(nodes.rings), spokes + more);
    let mut points = Vec::with_capacity(rings * spokes);
    for ring in rule_of(rings) {
        let angle = cone.angle_of(ring.x);
        for spoke in 0..spokes {
            let turn = 2.0 * PI * (spoke as f64 + 0.5) / spokes as f64;
            points.push(Point { beta: cone.around(angle, turn), weight: ring.weight / spokes as f64 });
        }
    }
    points
}

/// Returns the rule of this many points on (0, 1).
fn rule_of(points: usize) -> Vec<Node> {
    if points <= MOST_POINTS {
        return gauss(0.0, 1.0, points).collect();
    }
    legendre(points)
        .into_iter()
        .map(|node| Node { x: 0.5 + 0.5 * node.x, weight: 0.5 * node.weight })
        .collect()
}

/// Returns points of a uniform round source, for the light that propagates from them, with weights uniform
/// in direction cosines that sum to one.
pub(crate) fn disc_points(cone: &Cone, scale: f64, digits: f64) -> Vec<Point> {
    let mut points = cone_points(cone, scale, digits);
    for point in &mut points {
        point.weight *= (1.0 - point.beta.squared()).max(0.0).sqrt();
        point.beta = -point.beta;
    }
    let sum: f64 = points.iter().map(|point| point.weight).sum();
    if sum > 0.0 {
        points.iter_mut().for_each(|point| point.weight /= sum);
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The mean of a lobe over a cone converges as stated.
    #[test]
    fn cone_points_converge_with_digits() {
        let cone = Cone::new(30.0, 20.0, 4.0, 1.0);
        let f = |beta: Beta| (0.05 * 0.05 + (beta - Beta::towards(24.0, 20.0, 1.0)).squared()).powf(-1.5);
        let mean =
            |digits| -> f64 { cone_points(&cone, 0.05, digits).iter().map(|p| p.weight * f(p.beta)).sum() };
        let truth = mean(32.0);
        for digits in [11.5_f64, 15.0, 18.0] {
            let error = (mean(digits) / truth - 1.0).abs();
            assert!(error < 10.0 * (-digits).exp(), "{digits}: {error}");
        }
    }
}
