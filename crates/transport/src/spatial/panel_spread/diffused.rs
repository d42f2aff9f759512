//! Spread of a panel with a diffuser: every direction in the glass is seen.

use std::f64::consts::PI;

use papilio_optics::Beta;
use papilio_optics::lobe::Lobe;

use super::super::spread::{Bundle, Incoming, Pair};
use super::super::{Accuracy, Gap, Sample, Spread};
use super::{Heights, Part, SMOOTH, Sampled, by_index};
use crate::adding::Shares;
use crate::layers::Indices;
use crate::light::cone_points::{Nodes, Point, cone_points_of, disc_points};
use crate::light::images::{Mirror, image_points};
use crate::light::rings::{Peaks, Ring, rings};
use crate::{Cone, Diffuser, Panel, Source};

/// Returns the parts of scattered light, one for each index, and those of sharp images.
pub(super) fn parts(
    (panel, diffuser): (&Panel, &Diffuser),
    heights: Heights,
    view: &Cone,
    source: &Source,
    (accuracy, sampled): (Accuracy, Sampled),
) -> Vec<Part> {
    let over = Diffused { panel, diffuser, heights, accuracy };
    let indices = Indices::new(&panel.medium, accuracy.digits);
    let (seen, light) = (over.seen(view), over.arriving(view, source));
    let is_mirror = panel.base.is_specular();
    let factors: Vec<f64> = indices.nodes.iter().map(|index| over.received(&light, *index)).collect();
    // A Lambertian pixel sends its light everywhere; what it receives is a factor.
    let light = if is_mirror { light } else { Incoming::Pixel };
    let bins = panel.base.bins();
    let mut parts = Vec::new();
    for (number, (index, factor)) in indices.nodes.iter().zip(&factors).enumerate() {
        let gap = Gap { index: *index, thickness_mm: heights.glass_mm };
        let through = |bin: usize| factor * over.through(bin) * indices.blend_at(number, bin);
        let pair = Pair::new(diffuser, gap, seen.clone(), light.clone(), accuracy);
        let (samples, pair) = match sampled {
            Sampled::Yes => Spread::of(pair).into_scattered(),
            Sampled::No => (Vec::new(), pair),
        };
        let through = (0..bins).map(through).collect();
        parts.push(Part { samples, through, index: *index, ghosts: None, pair: Some(pair) });
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
        let pair = Pair::new(diffuser, gap, seen.clone(), light.clone(), accuracy);
        let images = images.iter().map(|point| pair.sample(point.beta, point.weight));
        let samples: Vec<Sample> = pair.sharp().into_iter().chain(images).collect();
        if !samples.is_empty() {
            let through = (0..bins).map(through).collect();
            parts.push(Part { samples, through, index, ghosts: None, pair: None });
        }
    }
    parts
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

    fn seen(&self, view: &Cone) -> Bundle {
        let nodes = Nodes { rings: 0, across: self.across(view) };
        let points = cone_points_of(view, self.width(), self.accuracy.digits, nodes);
        Bundle { points, centre: view.axis_towards(), radius: view.half_angle() }
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
                Incoming::Field(Bundle { points, centre: Beta { x: 0.0, y: 0.0 }, radius: 1.0 })
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
        match light {
            Incoming::Peak(light) | Incoming::Field(light) => {
                shares.density() * shares.arriving(self.diffuser, &light.points)
            }
            Incoming::Diffuse | Incoming::Pixel => shares.out,
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
