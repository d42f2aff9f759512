//! Spread of a panel with a diffuser: every direction in the glass is seen.

use std::f64::consts::PI;
use std::sync::Arc;

use papilio_optics::Beta;
use papilio_optics::lobe::Lobe;

use super::super::spread::{Bundle, FieldLight, Incoming, Pair};
use super::super::{Accuracy, Gap, Sample};
use super::{Heights, Part, SMOOTH, by_index};
use crate::adding::Shares;
use crate::layers::Indices;
use crate::light::cone_points::{Nodes, Point, cone_points_of, disc_points, smooth_at};
use crate::light::images::{Mirror, image_points};
use crate::light::rings::{Peaks, Ring, rings};
use crate::{Cone, Diffuser, Panel, Source};

/// Error of one direction in the place of a field of view, in those of the weights, times 8.
const NARROW: f64 = 16.0;

/// Returns the parts of scattered light, one for each index, and those of sharp images.
pub(super) fn parts(
    (panel, diffuser): (&Panel, &Diffuser),
    heights: Heights,
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
    let mut parts = Vec::new();
    for (number, (index, factor)) in indices.nodes.iter().zip(&factors).enumerate() {
        let gap = Gap { index: *index, thickness_mm: heights.glass_mm };
        let through = |bin: usize| factor * over.through(bin) * indices.blend_at(number, bin);
        let through: Arc<[f64]> = (0..bins).map(through).collect();
        for seen in &seen {
            let pair = Pair::new(diffuser, gap, seen.clone(), light.clone(), accuracy);
            let (images, through) = (Vec::new(), Arc::clone(&through));
            parts.push(Part { images, through, index: *index, pair: Some(pair) });
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
        let through = |bin: usize| if group.contains(&bin) { received(bin) * over.through(bin) } else { 0.0 };
        // Each direction sees such an image at its own ray.
        let image = |point: &Point| Sample { beta: point.beta, place_mm: [0.0; 2], weight: point.weight };
        let sharp = |seen: &Bundle| Pair::new(diffuser, gap, seen.clone(), light.clone(), accuracy).sharp();
        let images: Vec<Sample> = seen.iter().flat_map(sharp).chain(images.iter().map(image)).collect();
        if !images.is_empty() {
            let through = (0..bins).map(through).collect();
            parts.push(Part { images, through, index, pair: None });
        }
    }
    parts
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
