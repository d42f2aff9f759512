//! Mirror images of round sources, where the field of view and the mirrored source overlap, and of
//! fields, as far as the view reaches.
//!
//! The overlap is integrated in polar coordinates around the axis of the smaller cone: the arc
//! of a circle that lies within the other cone is known in closed form (half-side formula of
//! spherical trigonometry), and a square root ends the range of radii where arcs begin.

use std::borrow::Cow;
use std::f64::consts::{FRAC_PI_2, PI, SQRT_2, TAU};

use papilio_optics::Beta;

use super::field::{Light, Lit};
use super::formula::{Formula, Polar};
use super::pixels::{Pixels, rotated};
use crate::light::GOLDEN_SECTION;
use crate::light::cone_points::{Nodes, Point, cone_points, cone_points_of, smooth_at};
use crate::numerics::quadrature::{Node, gauss};
use crate::{Cone, Field, Source};

/// Points of a source's image that a view sees: `rho` is the sum of weights times
/// [`specular_image`](crate::specular_image).
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ImagePoints {
    pub(crate) source: usize,
    pub(crate) points: Vec<Point>,
}

/// What the mirror of a view shows: how its reflectance varies across the view.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Mirror {
    /// It is the same everywhere.
    Uniform,
    /// It changes slowly, and with the base's table, of which this many nodes lie across the view: the
    /// fringes of a film have a few each.
    Across(f64),
}

/// Returns the images of all sources in this field of view.
pub(crate) fn image_points(view: &Cone, sources: &[Source], digits: f64, mirror: Mirror) -> Vec<ImagePoints> {
    let across = match mirror {
        Mirror::Uniform => 0.0,
        Mirror::Across(nodes) => nodes,
    };
    let fine = Fine { digits, across, moments: mirror != Mirror::Uniform };
    let seen = |(source, light): (usize, &Source)| {
        let points = match light {
            Source::Diffuse | Source::Beam(_) => return None,
            Source::Disc(disc) => overlap(view, &disc.mirrored(), PI / disc.projected_solid_angle(), fine),
            Source::Field(field) => in_view(view, field, fine),
        };
        let points = if fine.moments { points } else { all_in_one(view, &points) };
        (!points.is_empty()).then_some(ImagePoints { source, points })
    };
    sources.iter().enumerate().filter_map(seen).collect()
}

/// Returns one point with the light of all points.
fn all_in_one(view: &Cone, points: &[Point]) -> Vec<Point> {
    let weight: f64 = points.iter().map(|point| point.weight).sum();
    if weight > 0.0 { vec![Point { beta: view.axis_towards(), weight }] } else { Vec::new() }
}

#[derive(Debug, Clone, Copy)]
struct Fine {
    digits: f64,
    /// Number of nodes of the base's table across the view.
    across: f64,
    /// Whether directions matter, and not only the sum of the light.
    moments: bool,
}

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
        Light::Cells(lit) if !view.is_point() => of_cells(view, &Rows::of_cells(&lit), fine),
        // Circles about another axis than the normal are no circles in a medium, and the horizon cuts them.
        Light::Pixels(pixels, scale, _) if !view.is_point() && view.is_in_air() && view.is_above() => {
            of_cells(view, &Rows::of_pixels(pixels, scale, view), fine)
        }
        _ => by_spiral(view, field, fine),
    }
}

/// Returns points of a rule that takes into account where the formula is not smooth.
fn of_formula(view: &Cone, formula: &Formula, scale: f64, fine: Fine) -> Vec<Point> {
    let Fine { digits, across, .. } = fine;
    let degree = digits + across;
    let mut points = Vec::new();
    for ring in formula.over_angle(0.0, view.half_angle(), digits, degree) {
        for spoke in formula.around(ring.x, digits, degree as usize) {
            let light = scale * ring.weight * ring.x.sin() * spoke.weight * formula.seen_at(ring.x, spoke.x);
            points.push((ring.x, spoke.x, light));
        }
    }
    let mut parts = Parts::new(view, fine);
    if points.len() <= parts.sums.len() || !fine.moments {
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
    fn new(view: &Cone, Fine { digits, across, .. }: Fine) -> Self {
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

/// Cells of a field: the inclinations between which rows lie, radians, and their radiances, in a frame of
/// their own (azimuth 0, azimuth 90 deg, pole).
struct Rows<'a> {
    rows: Vec<([f64; 2], Cow<'a, [f64]>)>,
    frame: [[f64; 3]; 3],
}

impl<'a> Rows<'a> {
    fn of_cells(lit: &Lit<'a>) -> Self {
        let (sin, cos) = lit.turn.sin_cos();
        let rows = lit.rows.iter().map(|(edges, row)| (*edges, Cow::Borrowed(*row)));
        Self { rows: rows.collect(), frame: [[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]] }
    }

    /// Returns the rows of pixels that the mirror of this view shows, from the pole on whose side it is.
    fn of_pixels(pixels: &Pixels, scale: f64, view: &Cone) -> Self {
        let axis = source_of(view);
        let flipped = rotated(&pixels.frame, axis)[2] < 0.0;
        let frame = if flipped {
            let [x, y, pole] = pixels.frame;
            [x, y.map(|part| -part), pole.map(|part| -part)]
        } else {
            pixels.frame
        };
        let middle = inclination(rotated(&frame, axis));
        let rows = pixels.rows_within([middle - view.half_angle(), middle + view.half_angle()], flipped);
        let scaled = |(edges, mut row): ([f64; 2], Vec<f64>)| {
            row.iter_mut().for_each(|value| *value *= scale);
            (edges, Cow::Owned(row))
        };
        Self { rows: rows.map(scaled).collect(), frame }
    }
}

/// Returns the direction, in the medium of the view, from which the mirror shows light in its middle.
fn source_of(view: &Cone) -> [f64; 3] {
    let (axis, index) = (view.axis_towards(), view.index());
    let (x, y) = (-axis.x / index, -axis.y / index);
    [x, y, (1.0 - x * x - y * y).max(0.0).sqrt()]
}

fn inclination([x, y, z]: [f64; 3]) -> f64 {
    x.hypot(y).atan2(z)
}

/// Returns points of cells: circles about their pole cross the view and the cells in arcs that are known in
/// closed form.
fn of_cells(view: &Cone, rows: &Rows<'_>, fine: Fine) -> Vec<Point> {
    let circles = CirclesInView::new(view, rows.frame);
    let scale = PI / view.solid_angle();
    let points = (2.0 + 0.4 * fine.digits).ceil() as usize;
    let (mut light, mut sum) = (Vec::new(), 0.0);
    for (edges, row) in &rows.rows {
        let step = TAU / row.len() as f64;
        for node in circles.nodes(edges.map(|edge| circles.inclination(edge)), step, points) {
            let half = circles.half_arc(node.x);
            let scale = scale * node.weight * node.x.sin();
            let (from, to) = ((circles.azimuth - half) / step, (circles.azimuth + half) / step);
            let mut at = from;
            while at < to {
                let end = (at.floor() + 1.0).min(to);
                let radiance = row[(at.floor() as i64).rem_euclid(row.len() as i64) as usize];
                if !fine.moments {
                    sum += scale * radiance * (end - at) * step;
                } else if radiance > 0.0 {
                    let turns = gauss(at * step, end * step, POINTS_OF_AN_ARC);
                    light.extend(turns.map(|turn| (node.x, turn.x, scale * radiance * turn.weight)));
                }
                at = end;
            }
        }
    }
    if !fine.moments {
        return all_in_one(view, &[Point { beta: view.axis_towards(), weight: sum }]);
    }
    let mut parts = Parts::new(view, fine);
    let is_few = light.len() <= parts.sums.len();
    let mut all = Vec::new();
    for (inclination, turn, light) in light {
        let beta = -circles.from(inclination, turn);
        let (angle, turn) = view.bearing_of(beta);
        if is_few {
            all.push(Point { beta, weight: light });
        } else {
            parts.add(angle / view.half_angle(), turn, beta, light);
        }
    }
    if is_few { all } else { parts.points() }
}

/// Number of points of the arc of a circle in a cell: cells are small.
const POINTS_OF_AN_ARC: usize = 3;

/// Circles about the pole of cells, as far as they lie in the directions that a mirror shows in a view.
/// Angles are those in the medium of the view; the pole is the normal, or the medium is air.
struct CirclesInView {
    half_angle: f64,
    /// Inclination and azimuth of the middle.
    middle: f64,
    azimuth: f64,
    index: f64,
    frame: [[f64; 3]; 3],
}

impl CirclesInView {
    fn new(view: &Cone, frame: [[f64; 3]; 3]) -> Self {
        let [x, y, z] = rotated(&frame, source_of(view));
        let middle = inclination([x, y, z]);
        Self { half_angle: view.half_angle(), middle, azimuth: y.atan2(x), index: view.index(), frame }
    }

    /// Converts an inclination in the air.
    fn inclination(&self, in_air: f64) -> f64 {
        if self.index == 1.0 { in_air } else { (in_air.sin() / self.index).min(1.0).asin() }
    }

    /// Returns the direction cosines towards a place on a circle.
    fn from(&self, inclination: f64, azimuth: f64) -> Beta {
        let ((sin, cos), (sin_turn, cos_turn)) = (inclination.sin_cos(), azimuth.sin_cos());
        let [out, side, pole] = &self.frame;
        let along = |i: usize| sin * (cos_turn * out[i] + sin_turn * side[i]) + cos * pole[i];
        Beta { x: self.index * along(0), y: self.index * along(1) }
    }

    /// Returns half of the arc of a circle that lies in the view.
    fn half_arc(&self, inclination: f64) -> f64 {
        if inclination <= self.half_angle - self.middle {
            return PI;
        }
        half_arc(inclination, self.half_angle, self.middle)
    }

    /// Returns a rule over the inclinations of a row of cells, for columns of this width: arcs end smoothly
    /// between the inclinations at which the rim of the view crosses an edge of a cell.
    fn nodes(&self, [from, to]: [f64; 2], step: f64, points: usize) -> Vec<Node> {
        let first = (self.middle - self.half_angle).abs();
        // Rows end at the horizon, if the pole is the normal.
        let last = (self.middle + self.half_angle).min(PI);
        let mut nodes = Vec::new();
        // Whole circles around the normal.
        if self.half_angle > self.middle && from < first {
            nodes.extend(gauss(from, to.min(first), points));
        }
        let (from, to) = (from.max(first), to.min(last));
        if from >= to {
            return nodes;
        }
        let whole = self.middle + self.half_angle;
        let (centre, half) = (0.5 * (first + whole), 0.5 * (whole - first));
        let place = |inclination: f64| ((inclination - centre) / half).clamp(-1.0, 1.0).asin();
        let mut breaks: Vec<f64> = self.crossings(step, [from, to]).into_iter().map(place).collect();
        breaks.extend([place(from), place(to)]);
        breaks.sort_by(f64::total_cmp);
        for pair in breaks.windows(2).filter(|pair| pair[1] > pair[0]) {
            // Square roots end the range on both sides.
            nodes.extend(gauss(pair[0], pair[1], points).map(|node| {
                let (sin, cos) = node.x.sin_cos();
                Node { x: centre + half * sin, weight: node.weight * half * cos }
            }));
        }
        nodes
    }

    /// Returns the inclinations in this range at which the rim of the view crosses the border of two columns.
    fn crossings(&self, step: f64, [from, to]: [f64; 2]) -> Vec<f64> {
        let (sin, cos) = self.middle.sin_cos();
        // The widest arc of the view; all azimuths if it contains the normal.
        let widest =
            if self.half_angle < self.middle { (self.half_angle.sin() / sin).min(1.0).asin() } else { PI };
        let [first, last] = [-widest, widest].map(|off| ((self.azimuth + off) / step).round() as i64);
        let crossing = |border: i64| {
            let along = (border as f64 * step - self.azimuth).cos() * sin;
            let (middle, length) = (along.atan2(cos), along.hypot(cos));
            let half = (self.half_angle.cos() / length).min(1.0).acos();
            [middle - half, middle + half]
        };
        (first - 1..=last + 1).flat_map(crossing).filter(|at| (from..to).contains(at)).collect()
    }
}

/// Returns points of light by spiral sampling, wherever its edges lie.
fn by_spiral(view: &Cone, field: &Field, fine: Fine) -> Vec<Point> {
    let Fine { digits, across, .. } = fine;
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
        let (along, turn) = ((k as f64 + 0.5) / count as f64, TAU * (k as f64 * GOLDEN_SECTION).fract());
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

/// Angle over which interfaces and films change.
const SMOOTH: f64 = 0.3;

/// Returns points for the mean over the view of the indicator of the mirrored source, times `scale`.
fn overlap(view: &Cone, mirrored: &Cone, scale: f64, fine: Fine) -> Vec<Point> {
    let Fine { digits, across, .. } = fine;
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

    /// The light of cells, its centre and its extent equal those of many directions of a spiral, in air and
    /// in a medium; the view may contain the normal, the horizon, or lie within a cell.
    #[test]
    fn cells_in_view_have_the_moments_of_a_spiral() {
        let radiance: Vec<f64> = (0..18 * 24).map(|k| ((k * k * 7919 + k) % 101) as f64).collect();
        let edges: Vec<f64> = (0..=18).map(|row| 5.0 * f64::from(row)).collect();
        let (field, _) = Field::new(&edges, 24, radiance).unwrap();
        for (theta, phi, half, index) in [
            (33.0, 20.0, 4.0, 1.0),
            (2.0, -70.0, 9.0, 1.0),
            (0.0, 0.0, 12.0, 1.0),
            (9.0, 100.0, 9.0, 1.0),
            (80.0, 200.0, 9.9, 1.0),
            (52.4, 7.4, 0.05, 1.0),
            (20.0, 33.0, 6.0, 1.5),
        ] {
            let view = Cone::new(theta, phi, half, index);
            let (axis, half, count) = (view.axis_towards(), view.half_angle(), 400_000);
            let mut truth = [0.0; 6];
            let moments = |sums: &mut [f64; 6], beta: Beta, light: f64| {
                let (x, y) = ((beta.x - axis.x) / half, (beta.y - axis.y) / half);
                sums.iter_mut().zip([1.0, x, y, x * x, x * y, y * y]).for_each(|(s, m)| *s += light * m);
            };
            for k in 0..count {
                let (along, turn) =
                    ((f64::from(k) + 0.5) / f64::from(count), TAU * (f64::from(k) * GOLDEN_SECTION).fract());
                let angle = 2.0 * (along.sqrt() * (0.5 * half).sin()).asin();
                let beta = view.around(angle, turn);
                moments(&mut truth, beta, PI * field.radiance(beta) / f64::from(count));
            }
            for across in [0.0, 40.0] {
                let fine = Fine { digits: 15.0, across, moments: true };
                let mut found = [0.0; 6];
                in_view(&view, &field, fine).iter().for_each(|p| moments(&mut found, p.beta, p.weight));
                let sum = in_view(&view, &field, Fine { moments: false, ..fine })[0].weight;
                assert!((sum / found[0] - 1.0).abs() < 1e-12, "{theta}: {sum} {found:?}");
                for (found, moment) in found.iter().zip(truth) {
                    assert!((found - moment).abs() < 2e-4 * truth[0], "{theta} {across}: {found} {moment}");
                }
            }
        }
    }

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
            let fine = Fine { digits: 18.0, across: 0.0, moments: true };
            let share: f64 = overlap(&view, &mirrored, 1.0, fine).iter().map(|p| p.weight).sum();
            let truth = lens(a, b, d) / (PI * a * a);
            assert!((share - truth).abs() < 1e-6 * truth.max(1e-2), "{a} {b} {d}: {share} against {truth}");
        }
    }
}
