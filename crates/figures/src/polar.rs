//! Polar maps as drawn by conoscopes: the normal is in the centre, the inclination increases outwards,
//! and azimuth 0° is to the right, 90° up.

use std::f64::consts::TAU;

use papilio_display::ConeLight;

use crate::axis::Axis;
use crate::colour_map::viridis;
use crate::contour::{Contour, PolarField, thinned};
use crate::panel::SMALL;
use crate::place::Places;
use crate::style::{INK, degrees};
use crate::svg::{Anchor, Point, Stroke, Svg, Text, finite};

/// Largest distance of columns, degrees. Between columns further apart, values are interpolated, because
/// straight lines would cut into the circle.
const FINE_DEG: f64 = 5.0;
/// Largest distance of columns between which values are interpolated, degrees.
const GAP_DEG: f64 = 90.0;
/// Distance of the rings, degrees.
const RING_DEG: f64 = 20.0;
/// Azimuth of the labels of the rings, degrees.
const RING_NAMES_DEG: f64 = 270.0;
/// Points of a contour closer than this to a straight line are removed, px.
const REACH: f64 = 0.12;

/// Colour of areas without data.
pub(crate) const BLANK: &str = "#f2f2f2";

/// The directions of a map.
#[derive(Debug)]
pub(crate) struct Directions<'a> {
    theta_deg: &'a [f64],
    phi_deg: &'a [f64],
    /// Inclination of the rim, degrees.
    rim_deg: f64,
    /// Whether the azimuths cover the full circle.
    periodic: bool,
}

/// Position and style of a map.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Map<'a> {
    /// Centre on the page.
    pub(crate) centre: Point,
    /// Radius of the rim, px.
    pub(crate) radius: f64,
    /// Scale of the colours.
    pub(crate) scale: &'a Axis,
    /// Whether the map has labels.
    pub(crate) labelled: bool,
    /// Whether contour lines are drawn at the ticks of the scale; at discontinuities they would coincide.
    pub(crate) contours: bool,
}

impl<'a> Directions<'a> {
    /// Returns `None` if the directions do not span an area.
    pub(crate) fn new(theta_deg: &'a [f64], phi_deg: &'a [f64]) -> Option<Self> {
        let (first, last) = (phi_deg.first()?, phi_deg.last()?);
        let widest = phi_deg.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
        let periodic = phi_deg.len() > 2 && 360.0 - (last - first) <= widest.clamp(1.0, GAP_DEG) + 1e-6;
        let outermost = theta_deg.iter().copied().fold(0.0, f64::max);
        let spanned = theta_deg.len() > 1 && phi_deg.len() > 1 && outermost > 0.0 && widest <= GAP_DEG;
        let rim_deg = ((outermost / 10.0).ceil() * 10.0).min(90.0);
        spanned.then_some(Self { theta_deg, phi_deg, rim_deg, periodic })
    }

    /// Returns a quantity over all directions, on the page. `value` takes indices into `theta_deg` and
    /// `phi_deg`.
    fn field(&self, map: &Map<'_>, value: impl Fn(usize, usize) -> f64) -> PolarField {
        let count = self.phi_deg.len();
        let mut columns = Vec::new();
        for j in 0..count {
            let next = (j + 1) % count;
            let turn = if next == 0 { 360.0 } else { 0.0 };
            let gap = self.phi_deg[next] + turn - self.phi_deg[j];
            let last = next == 0 && !self.periodic;
            let steps = if last { 1 } else { (gap / FINE_DEG - 1e-6).ceil().clamp(1.0, 72.0) as usize };
            for step in 0..steps {
                let fraction = step as f64 / steps as f64;
                let node = |i: usize| {
                    let at = self.at(map, self.theta_deg[i], self.phi_deg[j] + fraction * gap);
                    let here = value(i, j);
                    let between = if step == 0 { here } else { here + fraction * (value(i, next) - here) };
                    // Directions without data are blank; values below a logarithmic scale have its lowest
                    // colour.
                    let level = map.scale.fraction(between).clamp(-0.5, 1.5);
                    (at, if between.is_finite() { level } else { f64::NAN })
                };
                columns.push((0..self.theta_deg.len()).map(node).collect());
            }
        }
        PolarField::new(&columns, self.periodic)
    }

    /// Returns the position of a direction on the page.
    pub(crate) fn at(&self, map: &Map<'_>, theta_deg: f64, phi_deg: f64) -> Point {
        let (sin, cos) = phi_deg.to_radians().sin_cos();
        let r = map.radius * theta_deg / self.rim_deg;
        (map.centre.0 + r * cos, map.centre.1 - r * sin)
    }

    /// Returns the position of a direction that may have a negative inclination, if it is on the map.
    pub(crate) fn inside(&self, map: &Map<'_>, theta_deg: f64, phi_deg: f64) -> Option<Point> {
        let at = self.at(map, theta_deg, phi_deg);
        (theta_deg.abs() <= self.rim_deg && finite(at)).then_some(at)
    }

    /// Draws a map of `value`, with the directions of the light.
    pub(crate) fn draw(
        &self,
        svg: &mut Svg,
        map: &Map<'_>,
        lights: &[ConeLight],
        value: impl Fn(usize, usize) -> f64,
    ) {
        svg.circle(map.centre, map.radius, BLANK, &Stroke::solid(BLANK, 0.5));
        let field = self.field(map, value);
        for (level, colour) in bands(map.scale, map.labelled) {
            let areas: Vec<_> = field.contour(level).areas.iter().map(|area| thinned(area, REACH)).collect();
            svg.area(&areas, &colour);
        }
        self.frame(svg, map);
        let corner = (map.centre.0 - map.radius, map.centre.1 - map.radius);
        let marks: Vec<Point> = lights.iter().flat_map(|light| self.mark(svg, map, light)).collect();
        let names = self.rings().map(|ring| self.at(map, ring, RING_NAMES_DEG));
        let mut places =
            Places::around(corner, (2.0 * map.radius, 2.0 * map.radius), marks.into_iter().chain(names));
        for (tick, text) in map.scale.ticks().iter().filter(|_| map.contours) {
            let fraction = map.scale.fraction(*tick);
            let contour = field.contour(fraction);
            // Lines are light on dark colours and dark on light colours.
            let colour = if fraction < 0.6 { "#ffffff" } else { "#222222" };
            let lines: Vec<_> = contour.lines.iter().map(|line| thinned(line, REACH)).collect();
            svg.lines(&lines, &Stroke::solid(colour, if map.labelled { 0.9 } else { 0.6 }), 0.7);
            label(svg, map, &contour, text, &mut places);
        }
        if map.labelled {
            self.ring_names(svg, map);
        }
    }

    /// Draws rings, spokes, and the labels of the spokes.
    fn frame(&self, svg: &mut Svg, map: &Map<'_>) {
        let faint = Stroke::solid("#ffffff", 0.6);
        for ring in self.rings() {
            let circle = (0..=72).map(|k| self.at(map, ring, 5.0 * f64::from(k))).collect();
            svg.lines(&[circle], &faint, 0.35);
        }
        for k in 0..8 {
            let phi = 45.0 * f64::from(k);
            svg.lines(&[vec![map.centre, self.at(map, self.rim_deg, phi)]], &faint, 0.35);
            if map.labelled {
                let (sin, cos) = phi.to_radians().sin_cos();
                let anchor = match cos {
                    c if c > 0.3 => Anchor::Start,
                    c if c < -0.3 => Anchor::End,
                    _ => Anchor::Middle,
                };
                let r = map.radius + 6.0;
                let at = (map.centre.0 + r * cos, map.centre.1 - (r + 3.0) * sin + 4.0);
                svg.text(at, &degrees(phi), Text::new(10.0, "#777777").anchor(anchor));
            }
        }
        svg.circle(map.centre, map.radius, "none", &Stroke::solid(INK, 1.0));
    }

    /// Returns the inclinations of the rings, degrees.
    fn rings(&self) -> impl Iterator<Item = f64> {
        (1..).map(|k| RING_DEG * f64::from(k)).take_while(|ring| *ring < self.rim_deg)
    }

    fn ring_names(&self, svg: &mut Svg, map: &Map<'_>) {
        for ring in self.rings() {
            let (x, y) = self.at(map, ring, RING_NAMES_DEG);
            let style = Text::new(10.0, "#333333").anchor(Anchor::Middle).halo();
            svg.text((x, y + 3.0), &degrees(ring), style);
        }
    }

    /// Draws the direction of a light and of its mirror image, and returns their positions.
    fn mark(&self, svg: &mut Svg, map: &Map<'_>, light: &ConeLight) -> Vec<Point> {
        let size = if map.labelled { 4.5 } else { 2.5 };
        let (source, image) =
            [0.0, 180.0].map(|turn| self.at(map, light.theta_deg, light.phi_deg + turn)).into();
        if light.theta_deg.abs() > self.rim_deg || !finite(source) {
            return vec![];
        }
        sun(svg, source, size);
        svg.circle(image, size, "none", &Stroke::solid("#ffffff", 2.6));
        svg.circle(image, size, "none", &Stroke::solid(INK, 1.2));
        vec![source, image]
    }
}

/// Draws the symbol of a directed source: a disc with rays.
pub(crate) fn sun(svg: &mut Svg, (x, y): Point, size: f64) {
    for (colour, width) in [("#ffffff", 3.0), (INK, 1.1)] {
        for k in 0..8 {
            let (sin, cos) = (TAU * f64::from(k) / 8.0).sin_cos();
            let ray = |r: f64| (x + r * size * cos, y + r * size * sin);
            svg.line(ray(1.3), ray(1.9), &Stroke::solid(colour, width));
        }
        svg.circle((x, y), size, "#ffd23f", &Stroke::solid(colour, width));
    }
}

/// Returns the lower end of each band of colour, as a position (0 to 1) on the scale, and its colour. The
/// lowest band includes all data below it.
fn bands(scale: &Axis, fine: bool) -> Vec<(f64, String)> {
    let ticks: Vec<f64> = scale.ticks().iter().map(|(tick, _)| scale.fraction(*tick)).collect();
    let parts = if fine { 4 } else { 2 };
    let edges = ticks.windows(2).flat_map(|pair| {
        let (from, to) = (pair[0], pair[1]);
        (0..parts).map(move |k| from + (to - from) * f64::from(k) / f64::from(parts))
    });
    let mut edges: Vec<f64> = edges.chain([1.0]).collect();
    let middles: Vec<f64> = edges.windows(2).map(|pair| (pair[0] + pair[1]) / 2.0).collect();
    edges.truncate(middles.len());
    let (low, high) = (middles.first().copied().unwrap_or(0.0), middles.last().copied().unwrap_or(1.0));
    let colour = |middle: &f64| viridis((middle - low) / (high - low).max(1e-9));
    let lowest = |(k, edge): (usize, f64)| if k == 0 { -1.0 } else { edge };
    edges.into_iter().enumerate().map(lowest).zip(middles.iter().map(colour)).collect()
}

/// Labels a contour, once on each long line, near the upper right.
fn label(svg: &mut Svg, map: &Map<'_>, contour: &Contour, text: &str, places: &mut Places) {
    let size = if map.labelled { 10.0 } else { 8.0 };
    for line in contour.lines.iter().filter(|line| length(line) > 40.0) {
        let mut points: Vec<Point> = line.clone();
        let right = |p: &Point| (map.centre.1 - p.1) + 0.5 * (p.0 - map.centre.0);
        points.sort_by(|a, b| right(b).total_cmp(&right(a)));
        let at = points.iter().map(|(x, y)| (*x, y + 0.35 * size));
        let free = |at: &Point| places.take_in_disc(*at, text, size, (map.centre, map.radius - 2.0));
        if let Some(at) = at.into_iter().find(free) {
            svg.text(at, text, Text::new(size, INK).anchor(Anchor::Middle).halo());
        }
    }
}

fn length(line: &[Point]) -> f64 {
    line.windows(2).map(|pair| (pair[1].0 - pair[0].0).hypot(pair[1].1 - pair[0].1)).sum()
}

/// Draws the colours of a scale, with its ticks, from `top` down.
pub(crate) fn colour_bar(svg: &mut Svg, scale: &Axis, (left, top): Point, height: f64, fine: bool) {
    const WIDTH: f64 = 12.0;
    let bottom = top + height;
    let bands = bands(scale, fine);
    let ends = bands.iter().skip(1).map(|(from, _)| *from).chain([1.0]);
    for ((from, colour), to) in bands.iter().zip(ends) {
        let (from, to) = (bottom - height * from.max(0.0), bottom - height * to);
        // A little higher than it is, so that no seam shows.
        svg.rect((left, to), (WIDTH, (from - to + 0.5).min(bottom - to)), 0.0, colour, "");
    }
    for (tick, _) in scale.ticks() {
        let y = bottom - height * scale.fraction(*tick);
        svg.line((left + WIDTH, y), (left + WIDTH + 3.0, y), &Stroke::solid(INK, 0.8));
    }
    for (tick, text) in scale.labelled(height, |_| SMALL - 1.0) {
        let y = bottom - height * scale.fraction(tick);
        svg.text((left + WIDTH + 6.0, y + 4.0), text, Text::new(SMALL - 1.0, INK));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_without_data_have_no_colour() {
        let (theta, phi) = ([0.0, 30.0, 60.0], [0.0, 90.0, 180.0, 270.0]);
        let directions = Directions::new(&theta, &phi).unwrap();
        let wide = [1e-9, 1.0];
        let logarithmic = Axis::logarithmic_beyond(30.0, &wide, "").unwrap();
        for scale in [Axis::exact(0.0, 1.0, 5, ""), logarithmic] {
            let map = Map { centre: (0.0, 0.0), radius: 60.0, scale: &scale, labelled: true, contours: true };
            let reached = |value: f64| {
                let field = directions.field(&map, |i, _| if i == 2 { value } else { 0.5 });
                let areas = field.contour(-1.0).areas;
                areas.iter().flatten().map(|(x, y)| x.hypot(*y)).fold(0.0, f64::max)
            };
            for value in [0.0, -1.0, 1e-12, 0.5, 1e9] {
                assert!((reached(value) - 60.0).abs() < 1e-9, "{value}");
            }
            for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                assert!((reached(value) - 30.0).abs() < 1e-9, "{value}");
            }
        }
    }

    #[test]
    fn bands_cover_scale_and_values_below() {
        let scale = Axis::exact(0.0, 1.0, 5, "");
        let bands = bands(&scale, true);
        assert_eq!(bands.len(), 20);
        assert_eq!(bands[0].0, -1.0);
        assert!((bands[19].0 - 0.95).abs() < 1e-12);
        assert_eq!((bands[0].1.as_str(), bands[19].1.as_str()), ("#440154", "#fde725"));
    }
}
