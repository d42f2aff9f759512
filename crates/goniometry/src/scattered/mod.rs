//! Smooth interpolation of listed pairs of directions, in any order.
//!
//! **Coordinates.** The scattering of an isotropic sample depends on the inclinations of light and viewer and on the azimuth
//! between them. Pairs that are mirror images in the plane of incidence, or rotations of each other, are therefore one point,
//! with the mean of their values. Its coordinates are `s ln(1 + (|delta|/w)^2)` (scaled to 0 ... 2 s), `cos(theta_i)` and
//! `cos(theta_o)`, with `delta = beta_out - beta_in`: lobes move with the light, and are smooth in this abscissa
//! ([`Shape`](crate::Shape)). None of them is undefined along the normal, as azimuths are. The width w and the weight s are
//! those with which the points best predict each other.
//!
//! **Interpolation.** A polynomial of second degree of ln f, fitted to the nearest [`NEAREST`] points with the weights
//! `((R - r)/(R r))^2` (Franke and Little; Renka, ACM Trans. Math. Softw. 14, 139, 1988), r the distance and R that of the
//! farthest: it goes through the points, reproduces constants, Gaussian lobes (w large) and power laws with their own w, and is
//! continuous. Next to a value of 0, the mean of f with these weights. A list with few incidences is denser in the other
//! directions; the axis of the incidence is compressed accordingly, so that neighbours of both sides take part.
//!
//! **Range.** Nothing is extrapolated: there is no value at inclinations beyond the largest measured ones, nor far outside the
//! box of the nearest points.
//!
//! **Errors.** [`PairErrors`]: the points are predicted from the others (leave one out), and those of one incidence from the
//! other incidences.

mod errors;
mod local;
mod near;

use std::collections::BTreeMap;

use crate::Direction;
pub use errors::{PairError, PairErrors};
use local::predicted;
use near::Tree;

/// Number of points of a fit.
const NEAREST: usize = 40;
/// Smallest number of points.
const FEWEST: usize = 12;
/// Inclinations and azimuths that differ by less are equal, degrees.
const SAME_DEG: f64 = 0.02;
/// Widths w and weights s that are tried.
const WIDTHS: [f64; 8] = [0.02, 0.05, 0.1, 0.2, 0.4, 1.0, 3.0, 10.0];
const WEIGHTS: [f64; 4] = [0.5, 1.0, 2.0, 4.0];
/// Fraction of the extent of the nearest points by which a direction may lie outside their box.
const SLACK: f64 = 0.25;
/// Largest number of inclinations of the light that count as incidences.
const MOST_INCIDENCES: usize = 24;

/// An isotropic sample's values at points of its three angles.
#[derive(Debug)]
pub struct PairInterpolation {
    points: Vec<Point>,
    /// Abscissa's width and weight, and the scale of the axis of the incidence.
    scale: Scale,
    tree: Tree,
    /// Largest inclinations of light and viewer, degrees.
    largest_deg: [f64; 2],
    asymmetry: f64,
}

/// Value of equivalent pairs.
#[derive(Debug, Clone, Copy)]
struct Point {
    theta_i_deg: f64,
    theta_o_deg: f64,
    /// Azimuth from the light to the viewer, 0 to 180 deg.
    azimuth_deg: f64,
    /// f, 1/sr.
    value: f64,
}

#[derive(Debug, Clone, Copy)]
struct Scale {
    width: f64,
    weight: f64,
    incidence: f64,
}

impl PairInterpolation {
    /// Interpolation of the values of pairs of directions; those that are not finite were not measured. `None` for fewer than
    /// 12 different points.
    pub fn new(pairs: &[[Direction; 2]], values: &[f64]) -> Option<Self> {
        let (points, asymmetry) = points(pairs, values);
        if points.len() < FEWEST {
            return None;
        }
        let largest = |angle: fn(&Point) -> f64| points.iter().map(angle).fold(0.0, f64::max);
        let largest_deg = [largest(|p| p.theta_i_deg), largest(|p| p.theta_o_deg)];
        let levels = levels(&points).len() as f64;
        let across = (points.len() as f64 / levels).sqrt();
        let incidence = (levels / across).min(1.0);
        let scale = errors::best_scale(&points, incidence);
        let tree = Tree::new(points.iter().map(|point| scale.place(point)).collect());
        Some(Self { points, scale, tree, largest_deg, asymmetry })
    }

    /// Returns f, 1/sr, for light from `i` towards `o`; `None` outside the measured range.
    pub fn value(&self, i: Direction, o: Direction) -> Option<f64> {
        let at = Point::new(i, o, 0.0);
        let beyond = |theta: f64, largest: f64| theta > largest + SAME_DEG;
        if beyond(at.theta_i_deg, self.largest_deg[0]) || beyond(at.theta_o_deg, self.largest_deg[1]) {
            return None;
        }
        let place = self.scale.place(&at);
        let near = self.tree.nearest(place, NEAREST, &|_| true);
        let places = || near.iter().map(|(k, _)| self.tree.place(*k));
        let is_inside = (0..3).all(|axis| {
            let of = |k: [f64; 3]| k[axis];
            let (least, most) =
                places().map(of).fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
            let slack = SLACK * (most - least) + 1e-9;
            (least - slack..=most + slack).contains(&place[axis])
        });
        is_inside.then(|| predicted(&self.tree, &self.points, place, &near))
    }

    /// Inclinations of the light, degrees, ascending, if there are few of them; otherwise `None`.
    pub fn incidences_deg(&self) -> Option<Vec<f64>> {
        let levels = levels(&self.points);
        (levels.len() <= MOST_INCIDENCES).then_some(levels)
    }

    /// Largest inclinations of light and viewer, degrees.
    pub fn largest_deg(&self) -> [f64; 2] {
        self.largest_deg
    }

    /// Number of different points: pairs that symmetry makes equivalent are one.
    pub fn points(&self) -> usize {
        self.points.len()
    }

    /// Difference of equivalent pairs from their mean, relative (root mean square); 0 without equivalent pairs.
    pub fn asymmetry(&self) -> f64 {
        self.asymmetry
    }

    /// Returns the errors of the interpolation.
    pub fn errors(&self) -> PairErrors {
        errors::errors(&self.points, self.scale, &self.tree)
    }
}

impl Point {
    fn new(i: Direction, o: Direction, value: f64) -> Self {
        let turned = (o.phi_deg - i.phi_deg).rem_euclid(360.0);
        // Along the normal all azimuths are the same.
        let has_azimuth = i.theta_deg > SAME_DEG && o.theta_deg > SAME_DEG;
        let azimuth_deg = if has_azimuth { turned.min(360.0 - turned) } else { 0.0 };
        Self { theta_i_deg: i.theta_deg, theta_o_deg: o.theta_deg, azimuth_deg, value }
    }
}

impl Scale {
    /// Coordinates of a point.
    fn place(&self, point: &Point) -> [f64; 3] {
        let ([sin_i, cos_i], [sin_o, cos_o]) = (sines(point.theta_i_deg), sines(point.theta_o_deg));
        let cos = point.azimuth_deg.to_radians().cos();
        let squared = (sin_i * sin_i + sin_o * sin_o + 2.0 * sin_i * sin_o * cos).max(0.0);
        let unit = self.width * self.width;
        let along = 2.0 * self.weight * (squared / unit).ln_1p() / (4.0 / unit).ln_1p();
        [along, self.incidence * cos_i, cos_o]
    }
}

fn sines(theta_deg: f64) -> [f64; 2] {
    let (sin, cos) = theta_deg.to_radians().sin_cos();
    [sin, cos]
}

/// Returns the points of pairs, with the mean of equivalent ones, and the relative root mean square difference of these.
fn points(pairs: &[[Direction; 2]], values: &[f64]) -> (Vec<Point>, f64) {
    let (mut differences, mut sizes) = (0.0, 0.0);
    let mut mean = |group: &Vec<Point>| {
        let value = group.iter().map(|point| point.value).sum::<f64>() / group.len() as f64;
        if group.len() > 1 {
            differences += group.iter().map(|point| (point.value - value).powi(2)).sum::<f64>();
            sizes += group.len() as f64 * value * value;
        }
        Point { value, ..group[0] }
    };
    let points = groups(pairs, values).values().map(&mut mean).collect();
    (points, if sizes > 0.0 { (differences / sizes).sqrt() } else { 0.0 })
}

/// Groups equivalent pairs by their rounded angles: inclinations of light and viewer, azimuth between them.
fn groups(pairs: &[[Direction; 2]], values: &[f64]) -> BTreeMap<[i64; 3], Vec<Point>> {
    let mut groups: BTreeMap<[i64; 3], Vec<Point>> = BTreeMap::new();
    for ([i, o], value) in pairs.iter().zip(values).filter(|(_, value)| value.is_finite()) {
        let point = Point::new(*i, *o, *value);
        let angles = [point.theta_i_deg, point.theta_o_deg, point.azimuth_deg];
        groups.entry(angles.map(|deg| (deg / SAME_DEG).round() as i64)).or_default().push(point);
    }
    groups
}

/// Returns the values of listed pairs and of those in the opposite direction, where both are listed.
pub(crate) fn opposite_values(pairs: &[[Direction; 2]], values: &[f64]) -> Vec<[f64; 2]> {
    let groups = groups(pairs, values);
    let mean = |group: &Vec<Point>| group.iter().map(|point| point.value).sum::<f64>() / group.len() as f64;
    let once = groups.iter().filter(|([i, o, _], _)| i < o);
    once.filter_map(|([i, o, azimuth], group)| Some([mean(group), mean(groups.get(&[*o, *i, *azimuth])?)]))
        .collect()
}

/// Inclinations of the light, ascending.
fn levels(points: &[Point]) -> Vec<f64> {
    let mut levels: Vec<f64> = points.iter().map(|point| point.theta_i_deg).collect();
    levels.sort_by(f64::total_cmp);
    levels.dedup_by(|b, a| *b - *a < 5.0 * SAME_DEG);
    levels
}
