//! Light of a spread by place: strips, rings and cells of the pixel plane.
//!
//! Every place r of the pixel plane is seen along one direction in the glass, `beta = n r / sqrt(d^2 + r^2)`,
//! with `d2beta = n^2 d^2/(d^2 + r^2)^2 d2r`. A density over beta is therefore one over places. It is
//! integrated between given borders, so that a bin holds its light exactly, however narrow the lobe; the
//! pixel's reflectance, a function of `|beta|^2`, is applied last, so that one rule serves all states and
//! wavelengths.
//!
//! Places are relative to that of the view's own ray, in mm.

use std::f64::consts::PI;

use papilio_optics::Beta;

use super::{Gap, Sample};
use crate::numerics::quadrature::{MULTIPLE_POLES, Node, Pole, gauss, panels, points_for};

/// Distance, in thicknesses of the glass, beyond which light is neglected: within 0.06 deg of grazing.
const REACH: f64 = 1000.0;

/// Cells of a picture are divided until they are this much smaller than their distance to a peak and its
/// width.
const SMALL_CELL: f64 = 0.75;

/// Largest ellipse assumed about a cell: besides the peaks there are functions of direction.
const LARGEST_ELLIPSE: f64 = 60.0;

/// Place near which the density changes quickly.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Peak {
    /// The place, mm.
    pub at_mm: [f64; 2],
    /// Width, mm.
    pub width_mm: f64,
}

/// Light from a single place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Image {
    /// The place, mm.
    pub at_mm: [f64; 2],
    /// Its `|beta|^2`.
    pub beta_squared: f64,
    /// Part of the reflectance factor, as of a [`Sample`].
    pub weight: f64,
}

impl From<&Sample> for Image {
    fn from(sample: &Sample) -> Self {
        Self { at_mm: sample.place_mm, beta_squared: sample.beta.squared(), weight: sample.weight }
    }
}

/// Least angle, rad, over which the light of a sky varies on a circle: on wide circles there is little light.
const LEAST_TURN: f64 = 0.25;

/// Density of what a viewer sees over the places of the pixel plane.
pub struct PointSpread<'a> {
    /// Density over beta of light that leaves the pixel, and its `|beta|^2`.
    pub(super) density: Box<dyn Fn(Beta) -> [f64; 2] + Sync + 'a>,
    /// The glass.
    pub(super) gap: Gap,
    /// Place of the view's own ray, mm.
    pub(super) own_mm: [f64; 2],
    /// Peaks of the density, the sharpest features.
    pub(super) peaks: Vec<Peak>,
    /// Whether the density varies around the view's own ray where no peak does, in the light of a sky: over
    /// this distance, mm.
    pub(super) varies_over_mm: Option<f64>,
    /// Images of unscattered light.
    pub(super) images: Vec<Image>,
    /// Whether the density drops where `|beta| = 1`, over this width in beta.
    pub(super) rim: Option<f64>,
    /// Natural digits.
    pub(super) digits: f64,
}

/// A part of the light of a bin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Part {
    pub(super) bin: u32,
    pub(super) beta_squared: f64,
    pub(super) weight: f64,
}

/// Light by bin, before the pixel's reflectance.
#[derive(Debug, Clone, PartialEq)]
pub struct Binned {
    pub(super) bins: usize,
    pub(super) parts: Vec<Part>,
}

impl Binned {
    /// Light of each bin for several states, `[state][bin]`; `reflectance` writes that of each state at a
    /// `|beta|^2`.
    pub fn sums_of(&self, states: usize, reflectance: impl Fn(f64, &mut [f64])) -> Vec<Vec<f64>> {
        let mut sums = vec![vec![0.0; self.bins]; states];
        let mut rho = vec![0.0; states];
        for part in &self.parts {
            reflectance(part.beta_squared, &mut rho);
            for (sums, rho) in sums.iter_mut().zip(&rho) {
                sums[part.bin as usize] += part.weight * rho;
            }
        }
        sums
    }

    /// Light of each bin, for a reflectance as a function of `|beta|^2`.
    pub fn sums(&self, reflectance: impl Fn(f64) -> f64) -> Vec<f64> {
        let mut sums = vec![0.0; self.bins];
        for part in &self.parts {
            sums[part.bin as usize] += part.weight * reflectance(part.beta_squared);
        }
        sums
    }
}

impl PointSpread<'_> {
    /// Sharp images alone.
    pub(super) fn of_images(images: impl Iterator<Item = Image>) -> Self {
        Self {
            density: Box::new(|_| [0.0; 2]),
            gap: Gap { index: 1.5, thickness_mm: 0.0 },
            own_mm: [0.0; 2],
            peaks: Vec::new(),
            varies_over_mm: None,
            images: images.collect(),
            rim: None,
            digits: 1.0,
        }
    }

    /// The same light, of which this part is seen, farther away by a displacement, mm.
    pub(super) fn moved(self, by_mm: [f64; 2], part: f64) -> Self {
        let Self { density, own_mm, mut peaks, mut images, .. } = self;
        let add = |at_mm: &mut [f64; 2]| (0..2).for_each(|k| at_mm[k] += by_mm[k]);
        peaks.iter_mut().for_each(|peak| add(&mut peak.at_mm));
        for image in &mut images {
            add(&mut image.at_mm);
            image.weight *= part;
        }
        let own_mm = [0, 1].map(|k| own_mm[k] - by_mm[k]);
        let density = move |beta: Beta| {
            let [light, beta_squared] = density(beta);
            [part * light, beta_squared]
        };
        Self { density: Box::new(density), own_mm, peaks, images, ..self }
    }

    /// Peaks of the density.
    pub fn peaks(&self) -> &[Peak] {
        &self.peaks
    }

    /// Images of unscattered light.
    pub fn images(&self) -> &[Image] {
        &self.images
    }

    /// Strips along one axis (0: x) between ascending places, mm; the first bin is everything below the first
    /// place, the last everything above the last. Images at a border count half on each side.
    pub fn strips(&self, axis: usize, edges_mm: &[f64]) -> Binned {
        let mut parts = Vec::new();
        let reach = self.reach();
        let poles = self.poles_along(axis);
        for (bin, ends) in bounded(-reach, edges_mm, reach).windows(2).enumerate() {
            self.rule(ends[0], ends[1], &poles, &mut |across| {
                self.line(axis, across.x, |beta_squared, weight| {
                    parts.push(Part { bin: bin as u32, beta_squared, weight: across.weight * weight });
                });
            });
        }
        for image in &self.images {
            self.add_image(&mut parts, edges_mm, image, image.at_mm[axis]);
        }
        Binned { bins: edges_mm.len() + 1, parts }
    }

    /// Calls `each` with the panels along an axis on which the light of lines across it is smooth, and the
    /// nodes of a rule on each: enough for the polynomial through them.
    pub(super) fn panels_along(&self, axis: usize, mut each: impl FnMut([f64; 2], &[Node])) {
        let reach = self.reach();
        if reach == 0.0 {
            return;
        }
        panels(-reach, reach, &[], &self.poles_along(axis), &mut |from, to, ellipse: f64| {
            let count = points_for(self.digits + MULTIPLE_POLES, ellipse.ln());
            each([from, to], &gauss(from, to, count).collect::<Vec<_>>());
        });
    }

    /// Calls `each` with `|beta|^2` and the light per mm of places on the line across an axis at a place.
    pub(super) fn line(&self, axis: usize, at: f64, mut each: impl FnMut(f64, f64)) {
        let reach = self.reach();
        let (breaks, poles) = self.features_across(axis, at);
        self.rule_between(-reach, reach, &breaks, &poles, &mut |along| {
            let mut place = [along.x; 2];
            place[axis] = at;
            let part = self.part(0, place, along.weight);
            each(part.beta_squared, part.weight);
        });
    }

    /// Rings about the view's own ray between ascending radii, mm, above 0; the last bin is everything
    /// outside.
    pub fn rings(&self, radii_mm: &[f64]) -> Binned {
        let mut parts = Vec::new();
        let rim = self.rim_radius();
        let own = length(self.own_mm);
        let mut poles = vec![Pole { at: 0.0, off: self.gap.thickness_mm.max(own) }];
        for peak in &self.peaks {
            poles.push(Pole { at: length(peak.at_mm), off: peak.width_mm });
        }
        if let Some((radius, width)) = rim {
            poles.extend([radius - own, radius + own].map(|at| Pole { at: at.abs(), off: width }));
        }
        for (bin, ends) in bounded(0.0, radii_mm, self.reach()).windows(2).enumerate() {
            self.rule(ends[0], ends[1], &poles, &mut |ring| {
                let (from, poles) = self.features_around(ring.x);
                let mut add = |turn: Node| {
                    let (sin, cos) = turn.x.sin_cos();
                    let place = [ring.x * cos, ring.x * sin];
                    parts.push(self.part(bin, place, ring.weight * ring.x * turn.weight));
                };
                if poles.is_empty() {
                    add(Node { x: 0.0, weight: 2.0 * PI });
                } else {
                    self.rule_between(from, from + 2.0 * PI, &[], &poles, &mut add);
                }
            });
        }
        for image in &self.images {
            self.add_image(&mut parts, radii_mm, image, length(image.at_mm));
        }
        Binned { bins: radii_mm.len() + 1, parts }
    }

    /// Cells between ascending borders, mm, rows along x from the bottom; light outside is left out.
    pub fn cells(&self, x_mm: &[f64], y_mm: &[f64]) -> Binned {
        let columns = x_mm.len().saturating_sub(1);
        let mut parts = Vec::new();
        for (row, y) in y_mm.windows(2).enumerate() {
            for (column, x) in x_mm.windows(2).enumerate() {
                self.cell(row * columns + column, [x[0], x[1]], [y[0], y[1]], &mut parts);
            }
        }
        for image in &self.images {
            let inside =
                |edges: &[f64], at: f64| edges.windows(2).position(|ends| (ends[0]..ends[1]).contains(&at));
            if let (Some(column), Some(row)) = (inside(x_mm, image.at_mm[0]), inside(y_mm, image.at_mm[1])) {
                let bin = (row * columns + column) as u32;
                parts.push(Part { bin, beta_squared: image.beta_squared, weight: image.weight });
            }
        }
        Binned { bins: columns * y_mm.len().saturating_sub(1), parts }
    }

    /// Rectangles, each with its borders along x and y, mm. An image at a border belongs to the one above and
    /// to the right.
    pub fn rectangles(&self, rectangles: &[[[f64; 2]; 2]]) -> Binned {
        let mut parts = Vec::new();
        for (bin, [x, y]) in rectangles.iter().enumerate() {
            self.cell(bin, *x, *y, &mut parts);
            for image in &self.images {
                let inside = |[from, to]: [f64; 2], at: f64| (from..to).contains(&at);
                if inside(*x, image.at_mm[0]) && inside(*y, image.at_mm[1]) {
                    let (bin, beta_squared) = (bin as u32, image.beta_squared);
                    parts.push(Part { bin, beta_squared, weight: image.weight });
                }
            }
        }
        Binned { bins: rectangles.len(), parts }
    }

    fn cell(&self, bin: usize, x: [f64; 2], y: [f64; 2], parts: &mut Vec<Part>) {
        let size = (x[1] - x[0]).max(y[1] - y[0]);
        let beyond = |ends: [f64; 2], at: f64| (ends[0] - at).max(at - ends[1]).max(0.0);
        // Distance to the nearest peak, with its width.
        let to_peak = |peak: &Peak| beyond(x, peak.at_mm[0]).hypot(beyond(y, peak.at_mm[1])) + peak.width_mm;
        let nearest = self.peaks.iter().map(to_peak).fold(f64::INFINITY, f64::min);
        if size > SMALL_CELL * nearest {
            let [x_middle, y_middle] = [x, y].map(|ends| 0.5 * (ends[0] + ends[1]));
            for x in [[x[0], x_middle], [x_middle, x[1]]] {
                for y in [[y[0], y_middle], [y_middle, y[1]]] {
                    self.cell(bin, x, y, parts);
                }
            }
            return;
        }
        let smooth = nearest.min(self.gap.thickness_mm).min(self.to_rim(x, y));
        let axis = 1.0 + 2.0 * smooth / size;
        let ellipse = (axis + (axis * axis - 1.0).sqrt()).min(LARGEST_ELLIPSE);
        let count = points_for(self.digits + MULTIPLE_POLES, 2.0 * ellipse.ln());
        for across in gauss(x[0], x[1], count) {
            for along in gauss(y[0], y[1], count) {
                parts.push(self.part(bin, [across.x, along.x], across.weight * along.weight));
            }
        }
    }

    fn part(&self, bin: usize, place: [f64; 2], weight: f64) -> Part {
        let Gap { index, thickness_mm: d } = self.gap;
        let [x, y] = [0, 1].map(|k| place[k] + self.own_mm[k]);
        let slant = d * d + x * x + y * y;
        let per_mm = index / slant.sqrt();
        let beta = Beta { x: x * per_mm, y: y * per_mm };
        let jacobian = (index * d / slant).powi(2);
        let [density, beta_squared] = (self.density)(beta);
        Part { bin: bin as u32, beta_squared, weight: weight * jacobian * density }
    }

    fn add_image(&self, parts: &mut Vec<Part>, edges: &[f64], image: &Image, at: f64) {
        let bins = [edges.partition_point(|edge| *edge < at), edges.partition_point(|edge| *edge <= at)];
        for bin in bins {
            let (bin, weight) = (bin as u32, 0.5 * image.weight);
            parts.push(Part { bin, beta_squared: image.beta_squared, weight });
        }
    }

    fn reach(&self) -> f64 {
        REACH * self.gap.thickness_mm + length(self.own_mm)
    }

    /// Radius of the circle about the foot of the normal where `|beta| = 1`, and the width over which the
    /// density drops there, mm.
    fn rim_radius(&self) -> Option<(f64, f64)> {
        let Gap { index, thickness_mm: d } = self.gap;
        let rest = index * index - 1.0;
        let per_beta = d * index * index / rest.powf(1.5);
        self.rim.filter(|_| rest > 1e-6).map(|width| (d / rest.sqrt(), width * per_beta))
    }

    /// Distance of a cell to the circle where `|beta| = 1`, with the width of the drop of the density there,
    /// mm.
    fn to_rim(&self, x: [f64; 2], y: [f64; 2]) -> f64 {
        let Some((radius, width)) = self.rim_radius() else { return f64::INFINITY };
        let middle = [x, y].map(|ends| 0.5 * (ends[0] + ends[1]));
        let foot = length([0, 1].map(|axis| middle[axis] + self.own_mm[axis]));
        let half_diagonal = 0.5 * (x[1] - x[0]).hypot(y[1] - y[0]);
        ((foot - radius).abs() - half_diagonal).max(0.0) + width
    }

    fn poles_along(&self, axis: usize) -> Vec<Pole> {
        let mut poles = vec![Pole { at: -self.own_mm[axis], off: self.gap.thickness_mm }];
        poles.extend(self.peaks.iter().map(|peak| Pole { at: peak.at_mm[axis], off: peak.width_mm }));
        if let Some((radius, width)) = self.rim_radius() {
            poles.extend([-radius, radius].map(|at| Pole { at: at - self.own_mm[axis], off: width }));
        }
        poles
    }

    /// Breaks and poles on the line across an axis at a place.
    fn features_across(&self, axis: usize, at: f64) -> (Vec<f64>, Vec<Pole>) {
        let other = 1 - axis;
        let foot = at + self.own_mm[axis];
        let mut poles = vec![Pole { at: -self.own_mm[other], off: self.gap.thickness_mm.hypot(foot) }];
        for peak in &self.peaks {
            poles.push(Pole { at: peak.at_mm[other], off: peak.width_mm.hypot(at - peak.at_mm[axis]) });
        }
        let mut breaks = Vec::new();
        if let Some((radius, width)) = self.rim_radius()
            && foot.abs() < radius
        {
            let half = (radius * radius - foot * foot).sqrt();
            let off = width * radius / half.max(width);
            breaks.extend([-half, half].map(|half| half - self.own_mm[other]));
            poles.extend(breaks.iter().map(|at| Pole { at: *at, off }));
        }
        (breaks, poles)
    }

    /// Start and poles on a circle about the view's own ray; none if the density is the same all around.
    fn features_around(&self, radius: f64) -> (f64, Vec<Pole>) {
        let mut poles = Vec::new();
        let mut add = |place: [f64; 2], off: f64| {
            let at = place[1].atan2(place[0]).rem_euclid(2.0 * PI);
            poles.extend([at - 2.0 * PI, at, at + 2.0 * PI].map(|at| Pole { at, off }));
        };
        for peak in &self.peaks {
            let distance = length(peak.at_mm);
            if distance > 1e-6 * peak.width_mm {
                add(peak.at_mm, peak.width_mm.hypot(radius - distance) / radius.max(distance));
            }
        }
        if let Some(distance) = self.varies_over_mm {
            let off = (distance / radius).clamp(LEAST_TURN, 1.0);
            for k in 0..6 {
                let (sin, cos) = (f64::from(k) * PI / 3.0).sin_cos();
                add([cos, sin], off);
            }
        }
        let own = length(self.own_mm);
        if own > 1e-9 * self.gap.thickness_mm {
            add(self.own_mm.map(|x| -x), self.gap.thickness_mm.hypot(radius - own) / radius.max(own));
            if let Some((rim, width)) = self.rim_radius() {
                // Where the circle meets the rim, by the law of cosines.
                let cosine = (rim * rim - radius * radius - own * own) / (2.0 * radius * own);
                let turn = cosine.clamp(-1.0, 1.0).acos();
                let along = self.own_mm[1].atan2(self.own_mm[0]);
                let off = width / own.min(radius).max(width);
                for at in [along + turn, along - turn] {
                    add([at.cos(), at.sin()], off);
                }
            }
        }
        let from = self.peaks.last().map_or(0.0, |peak| peak.at_mm[1].atan2(peak.at_mm[0]));
        (from.rem_euclid(2.0 * PI), poles)
    }

    fn rule(&self, from: f64, to: f64, poles: &[Pole], each: &mut dyn FnMut(Node)) {
        self.rule_between(from, to, &[], poles, each);
    }

    fn rule_between(&self, from: f64, to: f64, breaks: &[f64], poles: &[Pole], each: &mut dyn FnMut(Node)) {
        panels(from, to, breaks, poles, &mut |from, to, ellipse: f64| {
            let points = points_for(self.digits + MULTIPLE_POLES, 2.0 * ellipse.ln());
            gauss(from, to, points).for_each(&mut *each);
        });
    }
}

fn length([x, y]: [f64; 2]) -> f64 {
    x.hypot(y)
}

/// Borders of bins between two ends; beyond them there is no light.
fn bounded(from: f64, edges: &[f64], to: f64) -> Vec<f64> {
    let edges = edges.iter().map(|edge| edge.clamp(from, to));
    std::iter::once(from).chain(edges).chain([to]).collect()
}

#[cfg(test)]
mod tests {
    use papilio_optics::lobe::Lobe;

    use super::super::{Accuracy, Light, Spread, closed};
    use super::*;
    use crate::Diffuser;

    fn spread(width: f64, thickness_mm: f64, view: Beta, light: Light) -> Spread {
        let diffuser = Diffuser {
            lobe: Lobe::KCorrelation { width },
            transmittance: vec![1.0].into(),
            regular_fraction: 0.1,
        };
        let accuracy = Accuracy { digits: 10.0, most_per_mm: 1.0 };
        Spread::new(&diffuser, Gap { index: 1.5, thickness_mm }, view, light, accuracy)
    }

    /// Strips, rings and cells hold all light, at oblique views and in beams too.
    #[test]
    fn bins_hold_all_light() {
        let [view, beam] = [Beta { x: 0.5, y: 0.2 }, Beta { x: -0.2, y: 0.3 }];
        for width in [1e-4, 0.02, 0.3] {
            for (view, light) in
                [(Beta::default(), Light::Diffuse), (view, Light::Diffuse), (view, Light::Beam(beam))]
            {
                let spread = spread(width, 0.5, view, light);
                let total = spread.transfer([0.0; 2], |_| 1.0).re;
                let points = spread.point_spread();
                let sums = [
                    points.strips(0, &[-0.4, 0.0, 0.1]).sums(|_| 1.0),
                    points.strips(1, &[-0.4, 0.0, 0.1]).sums(|_| 1.0),
                    points.rings(&[0.01, 0.1, 1.0]).sums(|_| 1.0),
                ];
                for sums in sums {
                    let found = sums.iter().sum::<f64>() / total;
                    // The rules of a spread neglect grazing light, of which a wide lobe has more.
                    assert!((found - 1.0).abs() < 2e-4 + 1e-3 * width, "{width} {light:?}: {found}");
                }
            }
        }
    }

    /// Half of the light of a narrow lobe is within sqrt(3) widths.
    #[test]
    fn half_of_a_lobe_is_within_a_known_radius() {
        let (b, d) = (1e-4, 0.7);
        let radius = 3.0_f64.sqrt() * b * d / 1.5;
        let spread = spread(b, d, Beta::default(), Light::Diffuse);
        let rings = spread.point_spread().rings(&[radius]).sums(|_| 1.0);
        // A tenth is not scattered.
        assert!((rings[0] / (rings[0] + rings[1]) - 0.55).abs() < 2e-4, "{rings:?}");
    }

    /// Sharp images are in the rings and strips of their places, and nothing else is; beyond all light a ring has none.
    #[test]
    fn bins_of_images_hold_their_light() {
        let image = |x: f64, weight: f64| Image { at_mm: [x, 0.0], beta_squared: 0.0, weight };
        let points = PointSpread::of_images([image(0.0, 0.6), image(0.2, 0.3)].into_iter());
        assert_eq!(points.rings(&[1e-6, 0.1, 0.3, 1.0]).sums(|_| 1.0), [0.6, 0.0, 0.3, 0.0, 0.0]);
        assert_eq!(points.strips(0, &[-0.1, 0.1, 1.0]).sums(|_| 1.0), [0.0, 0.6, 0.3, 0.0]);
        let spread = spread(0.02, 1e-3, Beta::default(), Light::Diffuse);
        let rings = spread.point_spread().rings(&[0.5, 2.0, 5.0]).sums(|_| 1.0);
        assert_eq!(rings[2..], [0.0, 0.0]);
    }

    /// Cells of a narrow lobe have the closed form of small angles: solid angles of rectangles.
    #[test]
    fn cells_have_closed_forms() {
        let (b, d) = (0.002, 0.5);
        let c = b * d / 1.5;
        let spread = spread(b, d, Beta::default(), Light::Diffuse);
        let edges: Vec<f64> = (0..=8).map(|k| (f64::from(k) - 4.0) * 0.001).collect();
        let cells = spread.point_spread().cells(&edges, &edges).sums(|_| 1.0);
        let total = spread.transfer([0.0; 2], |_| 1.0).re;
        for (cell, found) in cells.iter().enumerate() {
            let at = |k: usize| [edges[k], edges[k + 1]];
            // A tenth is not scattered, in the cell above and to the right of the middle.
            let sharp = if cell == 4 * 8 + 4 { 0.1 } else { 0.0 };
            let expected = sharp + 0.9 * closed::lobe_from_rectangle(at(cell % 8), at(cell / 8), c);
            assert!((found / total - expected).abs() < 1e-3, "{cell}: {} {expected}", found / total);
        }
    }
}
