//! Mirror images of round sources, where the field of view and the mirrored source overlap, and of
//! fields, as far as the view reaches.
//!
//! The overlap is integrated in polar coordinates around the axis of the smaller cone: the arc
//! of a circle that lies within the other cone is known in closed form (half-side formula of
//! spherical trigonometry), and a square root ends the range of radii where arcs begin.

use std::f64::consts::{FRAC_PI_2, PI, SQRT_2, TAU};

use papilio_optics::Beta;

use super::quadrature::{Nodes, Point, cone_points, cone_points_of, gauss, smooth_at};
use crate::field::Light;
use crate::formula::{Formula, Polar};
use crate::{Cone, Field, Source};

/// Points of a source's image that a view sees: `rho` is the sum of weights times
/// [`specular_image`](crate::specular_image).
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ImagePoints {
    pub(super) source: usize,
    pub(super) points: Vec<Point>,
}

/// Returns the images of all sources in this field of view, `across` which lie this many nodes of the base's
/// table: the fringes of a film have a few each.
pub(super) fn image_points(view: &Cone, sources: &[Source], digits: f64, across: f64) -> Vec<ImagePoints> {
    let seen = |(source, light): (usize, &Source)| {
        let points = match light {
            Source::Diffuse | Source::Beam(_) => return None,
            Source::Disc(disc) => {
                overlap(view, &disc.mirrored(), PI / disc.projected_solid_angle(), (digits, across))
            }
            Source::Field(field) => in_view(view, field, (digits, across)),
        };
        (!points.is_empty()).then_some(ImagePoints { source, points })
    };
    sources.iter().enumerate().filter_map(seen).collect()
}

/// Digits, and nodes of the base's table across the view.
type Fine = (f64, f64);

/// Returns points for the mean of a field's radiance over the view: light that is uniform within the view
/// needs few points. Other light is summed at many points, by parts of the view so small that the
/// reflectance is hardly curved within them, each represented by points that have its moments.
fn in_view(view: &Cone, field: &Field, fine: Fine) -> Vec<Point> {
    match field.light() {
        Light::Formula(..) if view.is_point() => {
            let beta = view.axis_towards();
            let weight = PI * field.radiance(beta);
            if weight > 0.0 { vec![Point { beta, weight }] } else { Vec::new() }
        }
        // In a medium the angles differ from those of the formula.
        Light::Formula(formula, scale) if view.is_in_air() => {
            let formula = formula.about(Polar::mirrored(view));
            of_formula(view, &formula, PI * scale / view.solid_angle(), fine)
        }
        _ => of_cells(view, field, fine),
    }
}

/// Returns points of a rule that takes into account where the formula is not smooth.
fn of_formula(view: &Cone, formula: &Formula, scale: f64, fine: Fine) -> Vec<Point> {
    let (digits, across) = fine;
    let degree = digits + across;
    let mut points = Vec::new();
    for ring in formula.over_angle(0.0, view.half_angle(), digits, degree) {
        for spoke in formula.around(ring.x, digits, degree as usize) {
            let light = scale * ring.weight * ring.x.sin() * spoke.weight * formula.seen_at(ring.x, spoke.x);
            points.push((ring.x, spoke.x, light));
        }
    }
    let mut parts = Parts::new(view, fine);
    if points.len() <= parts.sums.len() {
        let point = |(angle, turn, weight)| Point { beta: view.around(angle, turn), weight };
        return points.into_iter().map(point).filter(|point| point.weight > 0.0).collect();
    }
    for (angle, turn, light) in points {
        parts.add(angle / view.half_angle(), turn, view.around(angle, turn), light);
    }
    parts.points()
}

/// Largest number of rings of parts of a view.
const MOST_RINGS: f64 = 64.0;

/// Light of the parts of a view, by its moments: sums of 1, x, y, xx, xy and yy of the directions from the
/// axis.
struct Parts {
    axis: Beta,
    rings: f64,
    sectors: f64,
    sums: Vec<[f64; 6]>,
}

impl Parts {
    fn new(view: &Cone, (digits, across): Fine) -> Self {
        let size = view.half_angle() / smooth_at(view, SMOOTH);
        // Two points represent each part: one for each node of a fringe, more at finer levels.
        let rings = (1.0 + (2.0 * digits * size).ceil()).max((0.05 * digits * across).ceil()).min(MOST_RINGS);
        let sectors = 4.0 * rings;
        Self { axis: view.axis_towards(), rings, sectors, sums: vec![[0.0; 6]; (rings * sectors) as usize] }
    }

    /// Adds light; `along`: fraction of the distance from the axis to the rim; `turn`: angle around it,
    /// radians.
    fn add(&mut self, along: f64, turn: f64, beta: Beta, light: f64) {
        let turn = (turn / TAU).rem_euclid(1.0);
        let (ring, sector) = ((along * self.rings).floor(), (turn * self.sectors).floor());
        let part = ring.min(self.rings - 1.0) * self.sectors + sector.min(self.sectors - 1.0);
        let (x, y) = (beta.x - self.axis.x, beta.y - self.axis.y);
        let sums = self.sums[part as usize].iter_mut().zip([1.0, x, y, x * x, x * y, y * y]);
        sums.for_each(|(sum, moment)| *sum += light * moment);
    }

    fn points(self) -> Vec<Point> {
        let lit = self.sums.into_iter().filter(|part| part[0] > 0.0);
        lit.flat_map(|[light, sums @ ..]| of_moments(light, sums.map(|sum| sum / light), self.axis)).collect()
    }
}

/// Returns four points of a part, which have its light, its centre and its extent (mean squares and product
/// of directions from the centre). A parabola over the part is summed exactly.
fn of_moments(light: f64, [x, y, xx, xy, yy]: [f64; 5], axis: Beta) -> [Point; 4] {
    // Any square root of the matrix of the extent can be used: its columns are half of a point's offset,
    // squared.
    let wide = (xx - x * x).max(0.0).sqrt();
    let aslant = if wide > 0.0 { (xy - x * y) / wide } else { 0.0 };
    let high = (yy - y * y - aslant * aslant).max(0.0).sqrt();
    let (x, y) = (axis.x + x, axis.y + y);
    let at = |(dx, dy): (f64, f64)| Beta { x: x + SQRT_2 * dx, y: y + SQRT_2 * dy };
    let around = [(wide, aslant), (-wide, -aslant), (0.0, high), (0.0, -high)].map(at);
    // Beyond the horizon there is no direction.
    let is_above = around.iter().all(|beta| beta.squared() < 1.0);
    around.map(|beta| Point { beta: if is_above { beta } else { Beta { x, y } }, weight: 0.25 * light })
}

/// Returns points of cells, whose edges may lie anywhere, by spiral sampling.
fn of_cells(view: &Cone, field: &Field, fine: Fine) -> Vec<Point> {
    let (digits, across) = fine;
    let seen = |p: Point| Point { weight: PI * p.weight * field.radiance(p.beta), ..p };
    let half = view.half_angle();
    let few = cone_points_of(view, SMOOTH, digits, Nodes { rings: 0, across });
    let mut many = cone_points(view, half / digits, digits);
    many.iter_mut().for_each(|point| point.weight = field.radiance(point.beta));
    if view.is_point() || many.iter().all(|point| point.weight == many[0].weight) {
        return few.into_iter().map(seen).filter(|point| point.weight > 0.0).collect();
    }
    let mut parts = Parts::new(view, fine);
    let count = seeds(&many, digits);
    let whole = 2.0 * (0.5 * half).sin();
    for k in 0..count {
        // A sunflower spiral: uniform in solid angle.
        let (along, turn) = ((k as f64 + 0.5) / count as f64, TAU * (k as f64 * GOLDEN).fract());
        let angle = 2.0 * (0.5 * along.sqrt() * whole).asin();
        let beta = view.around(angle, turn);
        parts.add(along.sqrt(), turn, beta, PI * field.radiance(beta) / count as f64);
    }
    parts.points()
}

/// Returns the number of spiral points that edges require, from radiances in the view: the error is that of
/// an edge's step over the mean and decreases as 1/count^(3/4), so that small steps, as those of a sky from
/// cell to cell, take few.
fn seeds(seen: &[Point], digits: f64) -> usize {
    let radiances = || seen.iter().map(|point| point.weight);
    let (least, most) = (radiances().fold(f64::INFINITY, f64::min), radiances().fold(0.0, f64::max));
    let mean = radiances().sum::<f64>() / seen.len() as f64;
    let step = ((most - least) / mean).min(1.0);
    let of_whole_steps = (400.0 * (0.4 * digits).exp()).min(MOST_SEEDS);
    (of_whole_steps * step.powf(4.0 / 3.0)).max(FEWEST_SEEDS) as usize
}

/// Largest number: it leaves about 1e-5 of an edge, and takes a fifth of a second.
const MOST_SEEDS: f64 = 2e6;

/// Smallest number: fewer do not save time.
const FEWEST_SEEDS: f64 = 4096.0;

/// The golden section.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// Angle over which interfaces and films change.
const SMOOTH: f64 = 0.3;

/// Returns points for the mean over the view of the indicator of the mirrored source, times `scale`.
fn overlap(view: &Cone, mirrored: &Cone, scale: f64, (digits, across): Fine) -> Vec<Point> {
    if view.is_point() {
        let beta = view.axis_towards();
        let seen = mirrored.holds(beta);
        return if seen { vec![Point { beta, weight: scale }] } else { Vec::new() };
    }
    let (small, large) =
        if view.half_angle() <= mirrored.half_angle() { (view, mirrored) } else { (mirrored, view) };
    let (a, b) = (small.half_angle(), large.half_angle());
    let (distance, turn) = small.bearing(large);
    if distance >= a + b {
        return Vec::new();
    }
    let scale = scale / view.solid_angle();
    // Interfaces change over a tenth of a radian or more; of the nodes of a table, the smaller cone contains
    // its fraction.
    let of_table = 0.05 * digits * across * a / view.half_angle();
    let across = 2 + (digits * a + of_table).ceil() as usize;
    let mut points = Vec::new();
    let whole = (b - distance).clamp(0.0, a);
    for ring in gauss(0.0, whole, across) {
        arc(small, ring.x, turn, PI, 2 * across, scale * ring.weight * ring.x.sin(), &mut points);
    }
    let first = (b - distance).abs().min(a);
    if first < a {
        for ring in gauss(0.0, FRAC_PI_2, digits as usize + of_table as usize) {
            let (sin, cos) = ring.x.sin_cos();
            let angle = first + (a - first) * sin * sin;
            let weight = scale * ring.weight * 2.0 * sin * cos * (a - first) * angle.sin();
            let half = half_arc(angle, b, distance);
            arc(small, angle, turn, half, 2 * across, weight, &mut points);
        }
    }
    points
}

/// Returns half of the arc, at this angle around an axis, within `radius` of a point at `distance`.
fn half_arc(angle: f64, radius: f64, distance: f64) -> f64 {
    let product = (0.5 * (radius + angle - distance)).sin() * (0.5 * (radius - angle + distance)).sin();
    let square = product / (angle.sin() * distance.sin());
    2.0 * square.clamp(0.0, 1.0).sqrt().asin()
}

fn arc(cone: &Cone, angle: f64, turn: f64, half: f64, count: usize, weight: f64, points: &mut Vec<Point>) {
    for node in gauss(turn - half, turn + half, count) {
        points.push(Point { beta: cone.around(angle, node.x), weight: weight * node.weight });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The fraction of two overlapping small circles equals the planar lens formula.
    #[test]
    fn overlap_equals_area_of_lens() {
        let lens = |a: f64, b: f64, d: f64| {
            let part = |a: f64, b: f64| a * a * ((d * d + a * a - b * b) / (2.0 * d * a)).acos();
            let root = (-d + a + b) * (d + a - b) * (d - a + b) * (d + a + b);
            part(a, b) + part(b, a) - 0.5 * root.sqrt()
        };
        for (a, b, d) in [(0.01, 0.01, 0.012), (0.02, 0.01, 0.015), (0.01, 0.03, 0.0399), (0.01, 0.03, 0.021)]
        {
            let view = Cone::new(20.0, 10.0, a, 1.0);
            let mirrored = Cone::new(20.0 + d, 10.0, b, 1.0);
            let share: f64 = overlap(&view, &mirrored, 1.0, (18.0, 0.0)).iter().map(|p| p.weight).sum();
            let truth = lens(a, b, d) / (PI * a * a);
            assert!((share - truth).abs() < 1e-6 * truth.max(1e-2), "{a} {b} {d}: {share} against {truth}");
        }
    }
}
