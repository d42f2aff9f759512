//! Spread of a panel with a diffuser: every direction in the glass is seen.

use std::f64::consts::PI;
use std::sync::Arc;

use papilio_optics::Beta;
use papilio_optics::lobe::Lobe;

use super::super::spread::{Bundle, FieldLight, Incoming, Pair};
use super::super::{Accuracy, FrontWay, Gap, Sample, displacement};
use super::{Heights, Moved, Part, SMOOTH, by_index};
use crate::adding::Shares;
use crate::layers::Indices;
use crate::light::cone_points::{Nodes, Point, cone_points_of, disc_points, smooth_at};
use crate::light::images::{Mirror, image_points};
use crate::light::rings::{Peaks, Ring, rings};
use crate::{Cone, Diffuser, Panel, Source};

/// Error of one direction in the place of a field of view, in those of the weights, times 8.
const NARROW: f64 = 16.0;

/// Digits of the mean over a field of view of light that goes to and fro in the front, as a part of all digits and more than
/// that: it is a small part of all.
const DIGITS_OF_WAYS: [f64; 2] = [0.5, 2.0];

/// Digits below which all directions are seen as one.
const FEWEST_DIGITS: f64 = 1.0;

/// Inclination in air up to which the places of a field are resolved, radians.
const GRAZING: f64 = 1.4;

/// Half-angle of a narrow field, radians: directions that are so close see the same through the lobe, about their own rays. What
/// is seen farther away, at places that differ, is wrong by less than a hundredth.
const CLOSE: f64 = 0.01;

/// Returns the parts of scattered light, one for each index and way through the front, and those of sharp images. Without ways,
/// all light goes the own way of the view.
pub(super) fn parts(
    (panel, diffuser): (&Panel, &Diffuser),
    (heights, leaving): (Heights, &[FrontWay]),
    view: &Cone,
    source: &Source,
    (accuracy, by_direction): (Accuracy, bool),
) -> Vec<Part> {
    let over = Diffused { panel, diffuser, heights, accuracy };
    let indices = Indices::new(&panel.medium, accuracy.digits);
    let seen = over.seen(view, source, by_direction);
    let light = over.arriving(view, source);
    let is_mirror = panel.base.is_specular();
    let factors: Vec<f64> = indices.nodes.iter().map(|index| over.received(&light, *index)).collect();
    // A Lambertian pixel sends its light everywhere; what it receives is a factor.
    let light = if is_mirror { light } else { Incoming::Pixel };
    let bins = panel.base.bins();
    let own = FrontWay { air_mm: 0.0, fraction: vec![1.0; bins].into() };
    let ways = if leaving.is_empty() { std::slice::from_ref(&own) } else { leaving };
    let beside: Vec<_> = ways.iter().skip(1).map(|way| over.beside(view, source, way)).collect();
    let mut parts = Vec::new();
    for (number, (index, factor)) in indices.nodes.iter().zip(&factors).enumerate() {
        let gap = Gap { index: *index, thickness_mm: heights.glass_mm };
        let pair = |seen: &Bundle| Arc::new(Pair::new(diffuser, gap, seen.clone(), light.clone(), accuracy));
        let through = |way: &FrontWay| -> Arc<[f64]> {
            let of =
                |bin: usize| factor * over.through(bin) * indices.blend_at(number, bin) * way.fraction[bin];
            (0..bins).map(of).collect()
        };
        let mut add = |through: &Arc<[f64]>, pair: Moved| {
            let (images, through) = (Vec::new(), Arc::clone(through));
            parts.push(Part { images, through, index: *index, pair: Some(pair) });
        };
        let through_own = through(&ways[0]);
        let pairs: Vec<Arc<Pair>> = seen.iter().map(pair).collect();
        for pair in &pairs {
            add(&through_own, Moved { pair: Arc::clone(pair), by_mm: [0.0; 2], part: 1.0, digits_less: 0.0 });
        }
        for (way, directions) in ways.iter().skip(1).zip(&beside) {
            let through = through(way);
            let by_mm = |point: &Point| displacement(point.beta, way.air_mm, 1.0);
            let digits_less = -largest(way).ln();
            let mut add = |pair, by_mm, part| add(&through, Moved { pair, by_mm, part, digits_less });
            match (&directions[..], &pairs[..]) {
                ([only], _) => {
                    let pairs = pairs.iter().map(Arc::clone);
                    pairs.for_each(|pair| add(pair, by_mm(only), 1.0));
                }
                (all, [own]) if view.half_angle() <= CLOSE && own.view.points.len() == 1 => {
                    all.iter().for_each(|point| add(Arc::clone(own), by_mm(point), point.weight));
                }
                (all, _) => {
                    let own = |point: &Point| pair(&Bundle::point(point.beta));
                    all.iter().for_each(|point| add(own(point), by_mm(point), point.weight));
                }
            }
        }
    }
    // Sharp images are not interpolated between indices: each wavelength has its place.
    let received = |bin: usize| {
        let factors = factors.iter().enumerate();
        factors.map(|(number, factor)| factor * indices.blend_at(number, bin)).sum::<f64>()
    };
    let images = if is_mirror { over.images(view, source) } else { Vec::new() };
    for (index, group) in by_index(panel) {
        let gap = Gap { index, thickness_mm: heights.glass_mm };
        let sharp = |seen: &Bundle| Pair::new(diffuser, gap, seen.clone(), light.clone(), accuracy).sharp();
        let moved = |sample: Sample, by_mm: [f64; 2]| Sample {
            place_mm: [0, 1].map(|k| sample.place_mm[k] + by_mm[k]),
            ..sample
        };
        // Each direction sees the image of a source at its own ray.
        let image = |point: &Point, way: &FrontWay| Sample {
            beta: point.beta,
            place_mm: displacement(point.beta, way.air_mm, 1.0),
            weight: point.weight,
        };
        for (number, way) in ways.iter().enumerate() {
            let through = |bin: usize| match group.contains(&bin) {
                true => received(bin) * over.through(bin) * way.fraction[bin],
                false => 0.0,
            };
            let mut samples: Vec<Sample> = Vec::new();
            match number.checked_sub(1) {
                None => samples.extend(seen.iter().flat_map(sharp)),
                Some(number) => {
                    let of_point = |point: &Point| {
                        let own = [Bundle { points: vec![*point], ..Bundle::point(point.beta) }];
                        let bundles = if beside[number].len() == 1 { &seen[..] } else { &own };
                        let by_mm = displacement(point.beta, way.air_mm, 1.0);
                        let all: Vec<Sample> = bundles.iter().flat_map(sharp).collect();
                        all.into_iter().map(move |sample| moved(sample, by_mm))
                    };
                    samples.extend(beside[number].iter().flat_map(of_point));
                }
            }
            samples.extend(images.iter().map(|point| image(point, way)));
            if !samples.is_empty() {
                let through = (0..bins).map(through).collect();
                parts.push(Part { images: samples, through, index, pair: None });
            }
        }
    }
    parts
}

/// Returns the largest fraction of the light that a way has.
fn largest(way: &FrontWay) -> f64 {
    way.fraction.iter().copied().fold(f64::MIN_POSITIVE, f64::max)
}

/// Returns the mirror image of a beam, of its light that is never scattered.
pub(super) fn image((panel, diffuser): (&Panel, &Diffuser), beta: Beta) -> Vec<Part> {
    let through = |bin: usize| {
        (panel.front.transmittance[bin] * diffuser.transmittance[bin] * diffuser.regular_fraction).powi(2)
    };
    let of_index = |(index, group): (f64, Vec<usize>)| Part {
        images: vec![Sample { beta, place_mm: [0.0; 2], weight: 1.0 }],
        through: (0..panel.base.bins())
            .map(|bin| if group.contains(&bin) { through(bin) } else { 0.0 })
            .collect(),
        index,
        pair: None,
    };
    by_index(panel).into_iter().map(of_index).collect()
}

/// A panel with a diffuser.
struct Diffused<'a> {
    panel: &'a Panel,
    diffuser: &'a Diffuser,
    heights: Heights,
    accuracy: Accuracy,
}

impl Diffused<'_> {
    /// Distance over which the lobe changes.
    fn width(&self) -> f64 {
        match self.diffuser.lobe {
            Lobe::KCorrelation { width } => width.min(SMOOTH),
            Lobe::Lambertian => SMOOTH,
        }
    }

    /// Transmittance of front and diffuser on both ways.
    fn through(&self, bin: usize) -> f64 {
        (self.panel.front.transmittance[bin] * self.diffuser.transmittance[bin]).powi(2)
    }

    /// Number of nodes of the base's table across a view: only unscattered light resolves them.
    fn across(&self, view: &Cone) -> f64 {
        let sharp = self.diffuser.regular_fraction > 0.0;
        if sharp { self.panel.base.nodes_across(view, &self.panel.medium) } else { 0.0 }
    }

    /// Directions of view, in bundles over each of which the reflectance of the pixel changes little.
    fn seen(&self, view: &Cone, source: &Source, by_direction: bool) -> Vec<Bundle> {
        let (half, smooth) = (view.half_angle(), smooth_at(view, SMOOTH));
        let is_mirror = self.panel.base.is_specular();
        // A lobe does not show fringes that are closer than its width.
        let across = match self.diffuser.regular_fraction > 0.0 {
            true => self.across(view),
            false => self.panel.base.nodes_across(view, &self.panel.medium).min(2.0 * half / self.width()),
        };
        let points = |scale: f64| {
            // The mean of a smooth function over a narrow cone is off by an eighth of this square.
            let is_narrow = (half / scale).powi(2) <= NARROW * (-self.accuracy.digits).exp();
            match is_narrow && across < 1.0 {
                true => vec![Point { beta: view.axis_towards(), weight: 1.0 }],
                false => cone_points_of(view, scale, self.accuracy.digits, Nodes { rings: 0, across }),
            }
        };
        let alone = |point: &Point| Bundle { points: vec![*point], centre: point.beta, radius: 0.0 };
        let middles = points(smooth);
        let is_alone = self.diffuser.lobe == Lobe::Lambertian || by_direction;
        if !is_mirror && !is_alone {
            return vec![Bundle { points: middles, centre: view.axis_towards(), radius: half }];
        }
        // About their own rays all directions see nearly the same of diffuse light; images of a light move.
        let scale = match source {
            Source::Diffuse => smooth,
            _ if !is_mirror => smooth,
            Source::Beam(_) | Source::Disc(_) | Source::Field(_) => smooth.min(self.width()),
        };
        let mut bundles: Vec<Bundle> = middles.iter().map(alone).collect();
        if scale == smooth || is_alone {
            return bundles;
        }
        bundles.iter_mut().for_each(|bundle| bundle.points.clear());
        for point in points(scale) {
            let apart = |bundle: &Bundle| (bundle.centre - point.beta).length();
            if let Some(nearest) = bundles.iter_mut().min_by(|a, b| apart(a).total_cmp(&apart(b))) {
                nearest.radius = nearest.radius.max(apart(&*nearest));
                nearest.points.push(point);
            }
        }
        bundles.retain(|bundle| !bundle.points.is_empty());
        let own = |bundle: Bundle| if let [only] = bundle.points[..] { alone(&only) } else { bundle };
        bundles.into_iter().map(own).collect()
    }

    /// Directions of view that see an order of light between parts of the front at places of their own.
    fn beside(&self, view: &Cone, source: &Source, way: &FrontWay) -> Vec<Point> {
        let [part, more] = DIGITS_OF_WAYS;
        let digits = part * self.accuracy.digits + more + largest(way).ln();
        let farthest = view.axis_towards().length().min(1.0).asin() + view.half_angle();
        let per_radian = way.air_mm / farthest.min(GRAZING).cos().powi(2);
        let phase = 2.0 * PI * self.accuracy.most_per_mm * per_radian * view.half_angle();
        // Images of a light move.
        let moves = self.panel.base.is_specular() && *source != Source::Diffuse;
        let of_lobe = if moves { 2.0 * view.half_angle() / self.width() } else { 0.0 };
        if digits < FEWEST_DIGITS {
            return vec![Point { beta: view.axis_towards(), weight: 1.0 }];
        }
        let directions = view.directions(phase.max(of_lobe), digits);
        directions.into_iter().map(|(beta, weight)| Point { beta, weight }).collect()
    }

    fn arriving(&self, view: &Cone, source: &Source) -> Incoming {
        let (digits, width) = (self.accuracy.digits, self.width());
        match source {
            Source::Diffuse => Incoming::Diffuse,
            Source::Beam(beta) => Incoming::Peak(Bundle::point(*beta)),
            Source::Disc(cone) => Incoming::Peak(Bundle {
                points: disc_points(cone, width, digits),
                centre: cone.mirrored().axis_towards(),
                radius: cone.half_angle(),
            }),
            Source::Field(field) => {
                let passes = if self.diffuser.regular_fraction == 0.0 { 2.0 } else { 1.0 };
                // Half of a double image lies at the place of each direction of the light.
                let wave = 2.0 * PI * self.accuracy.most_per_mm * self.heights.glass_mm;
                let width = (passes * width).min(2.0 / wave).clamp(0.5 * width, SMOOTH);
                let everywhere = Cone::new(45.0, 0.0, 45.0, 1.0);
                let rings = rings(field, Peaks { views: &[*view, everywhere], width }, digits - 4.0);
                let points = rings.iter().flat_map(Ring::points).collect();
                let bundle = Bundle { points, centre: Beta { x: 0.0, y: 0.0 }, radius: 1.0 };
                let within = (self.panel.medium.index().max(), digits);
                Incoming::Field(Arc::new(FieldLight::new(bundle, self.diffuser.lobe, within)))
            }
        }
    }

    /// Returns what reaches a Lambertian pixel times the density of its directions, or what leaves of its
    /// light into diffuse light; 1 for a mirror.
    fn received(&self, light: &Incoming, index: f64) -> f64 {
        if self.panel.base.is_specular() {
            return 1.0;
        }
        let shares = Shares::new(self.diffuser, index, self.accuracy.digits);
        match light.bundle() {
            Some(light) => shares.density() * shares.arriving(self.diffuser, &light.points),
            None => shares.out,
        }
    }

    /// Returns the image of a source in the pixel, of light that is never scattered.
    fn images(&self, view: &Cone, source: &Source) -> Vec<Point> {
        if self.diffuser.regular_fraction == 0.0 {
            return Vec::new();
        }
        let (sources, mirror) = (std::slice::from_ref(source), Mirror::Across(self.across(view)));
        let images = image_points(view, sources, self.accuracy.digits, mirror);
        let mut points: Vec<Point> = images.into_iter().flat_map(|image| image.points).collect();
        points.iter_mut().for_each(|point| point.weight *= self.diffuser.regular_fraction.powi(2));
        points
    }
}
