//! Spread of a bare panel: every direction of view has one place, that of its own ray.

use papilio_optics::Beta;

use super::super::{Accuracy, Sample, displacement, fraction_of_order, orders_between};
use super::{Heights, Part, SMOOTH, by_index};
use crate::adding::{diffuse_shares, smooth_points};
use crate::light::cone_points::{Nodes, Point, cone_points_of, disc_points, smooth_at};
use crate::light::images::{Mirror, image_points};
use crate::specular::FlatTop;
use crate::{Cone, Panel, Source};

/// Nodes across a view for each period of the highest frequency between ghosts.
const NODES_OF_A_PERIOD: f64 = 2.0;
/// Inclination in air beyond which light is weak, radians.
const GRAZING: f64 = 1.5;

/// Returns the parts: one for each direction, index of the glass and order.
pub(super) fn parts(
    panel: &Panel,
    heights: Heights,
    view: &Cone,
    source: &Source,
    (accuracy, by_direction): (Accuracy, bool),
) -> Vec<Part> {
    let light = light_of(panel, source, accuracy.digits);
    let (more, left) = match by_direction {
        true => (accuracy.most_per_mm * ghosts_apart_mm(panel, heights, view), 1.0),
        false => (0.0, (-accuracy.digits).exp()),
    };
    let points = seen_points(panel, view, source, (accuracy.digits, NODES_OF_A_PERIOD * more));
    in_directions((panel, heights), &points, light.as_deref(), left)
}

/// Returns the parts of these directions; `light` as of [`light_of`]. Light between a face and a front of screen above it, on the
/// way to the viewer, is followed until the fraction `left` of it is left.
pub(super) fn in_directions(
    (panel, heights): (&Panel, Heights),
    points: &[Point],
    light: Option<&[f64]>,
    left: f64,
) -> Vec<Part> {
    let bins = panel.base.bins();
    let each = panel.of_each();
    // Front and face together, and the face alone.
    let mut tops: Vec<[FlatTop; 2]> = each.iter().map(|_| [0, 1].map(|_| FlatTop::new(bins))).collect();
    let mut parts = Vec::new();
    for point in points {
        for (one, [flat, face]) in each.iter().zip(&mut tops) {
            flat.set(one, point.beta.squared());
            face.set_surface(one, point.beta.squared());
        }
        let between = |face: &FlatTop, bin: usize| face.above[bin] * panel.front.reflectance_below[bin];
        let of_top = |[_, face]: &[FlatTop; 2]| (0..bins).map(|bin| between(face, bin)).fold(0.0, f64::max);
        let largest = tops.iter().map(of_top).fold(0.0, f64::max);
        let orders = if heights.front_mm > 0.0 { orders_between(largest, left) } else { 1 };
        let air = displacement(point.beta, 2.0 * heights.front_mm, 1.0);
        for (index, group) in by_index(panel) {
            for order in 0..orders {
                // Fraction of what leaves that does so in this order.
                let part = |between: f64| fraction_of_order(between, order, orders);
                let through = |bin: usize| {
                    let of = |[flat, face]: &[FlatTop; 2]| {
                        let entering = light.map_or(flat.t[bin], |light| light[bin]);
                        entering * flat.t[bin] * part(between(face, bin))
                    };
                    let all = || tops.iter().map(of).sum::<f64>() / tops.len() as f64;
                    if group.contains(&bin) { all() } else { 0.0 }
                };
                let place_mm = air.map(|air| order as f64 * air);
                parts.push(Part {
                    images: vec![Sample { beta: point.beta, place_mm, weight: point.weight }],
                    through: (0..bins).map(through).collect(),
                    index,
                    pair: None,
                });
            }
        }
    }
    parts
}

/// Returns how far apart the first ghosts of a mirror are in the directions of a view, mm.
fn ghosts_apart_mm(panel: &Panel, heights: Heights, view: &Cone) -> f64 {
    if !panel.base.is_specular() {
        return 0.0;
    }
    let axis = view.axis_towards().length().min(1.0).asin();
    let index = panel.medium.index().min();
    let at = |angle: f64| {
        let x = angle.clamp(-GRAZING, GRAZING).sin();
        2.0 * displacement(Beta { x, y: 0.0 }, heights.glass_mm, index)[0]
    };
    at(axis + view.half_angle()) - at(axis - view.half_angle())
}

/// Returns the directions of a bare panel that are seen, with the weights of their light, with so many nodes
/// more across a view than its reflectance takes.
fn seen_points(panel: &Panel, view: &Cone, source: &Source, (digits, more): (f64, f64)) -> Vec<Point> {
    let across = panel.base.nodes_across(view, &panel.medium) + more;
    if *source != Source::Diffuse && panel.base.is_specular() {
        let images = image_points(view, std::slice::from_ref(source), digits, Mirror::Across(across));
        return images.into_iter().flat_map(|image| image.points).collect();
    }
    let nodes = Nodes { rings: (digits / 2.5) as usize, across };
    cone_points_of(view, smooth_at(view, SMOOTH), digits, nodes)
}

/// Returns, for a Lambertian pixel, what reaches it of the light, times that which leaves into the directions
/// of the light, over what is emitted; none for a mirror, which sees the light in the direction of view.
/// Shape `[wavelength]`.
fn light_of(panel: &Panel, source: &Source, digits: f64) -> Option<Vec<f64>> {
    if panel.base.is_specular() {
        return None;
    }
    let points = match source {
        Source::Diffuse => return Some(diffuse_shares(panel, digits).0),
        Source::Beam(beta) => vec![Point { beta: *beta, weight: 1.0 }],
        Source::Disc(cone) => disc_points(cone, smooth_at(cone, SMOOTH), digits),
        Source::Field(field) => smooth_points(field, SMOOTH, digits),
    };
    let mut flat = FlatTop::new(panel.base.bins());
    let mut sum = vec![0.0; panel.base.bins()];
    for point in points {
        flat.set(panel, point.beta.squared());
        let index = panel.medium.index().iter();
        for ((sum, t), index) in sum.iter_mut().zip(&flat.t).zip(index) {
            *sum += point.weight * t / (index * index);
        }
    }
    Some(sum)
}
