//! Integrals over a disc of the product of two lobes around two directions and a smooth function.
//!
//! The plane is divided between both ends by factors that are one at one of them and vanish at the other,
//! with the sixth power of the distance: enough to remove the peak there. Around each end it is integrated in
//! polar coordinates, with the radius stretched as for a rim ([`super::basis`]), and the azimuth counted from
//! the line between both ends. If the centre of the disc is on that line, one half of the disc is the mirror
//! image of the other, and only one is computed: the smooth function depends on the distances from the centre
//! and from the ends.
//!
//! From an end near the rim, the distance to the rim changes abruptly with the azimuth, at right angles to the
//! radius; and what is lost beyond the rim is then as large as what the rule has to resolve around both ends.
//! There the azimuth is stretched around these right angles, and each ray has one interval more.
//!
//! Weights at the ends complete the rule, so that linear functions along the line between
//! them are integrated exactly over the plane: what it has to resolve is only how the smooth function differs
//! from a linear one, and the rim.

use std::f64::consts::{FRAC_PI_2, TAU};

use papilio_optics::Beta;

use crate::numerics::quadrature::{Node, Pole, gauss, points_for};

/// Returns the density of a lobe of this width.
#[inline(always)]
pub(super) fn density(width: f64, away: Beta) -> f64 {
    let square = away.squared() + width * width;
    width / (TAU * square * square.sqrt())
}

/// Rule between two directions, its ends.
pub(super) struct Between {
    ends: [Beta; 2],
    width: f64,
    /// Directions inside the disc and their areas, then those outside.
    at: Vec<(Beta, f64)>,
    inside: usize,
}

impl Between {
    pub(super) fn new(ends: [Beta; 2], width: f64, radius: f64, digits: f64) -> Self {
        let rays = (RAYS_A_DIGIT * digits).ceil() as usize + FEWEST_RAYS;
        let steps = (STEPS_A_DIGIT * digits).ceil() as usize + FEWEST_STEPS;
        let unit: Vec<Node> = gauss(0.0, 1.0, steps).collect();
        let (mut at, mut outside) =
            (Vec::with_capacity(4 * rays * steps), Vec::with_capacity(2 * rays * steps));
        let cube = |at: Beta, end: Beta| ((at - end).squared() + width * width).powi(3);
        let end_of_plane = (FAR / width).asinh();
        let axis = axis(ends);
        let is_mirrored = (axis.x * ends[0].y - axis.y * ends[0].x).abs() < ON_THE_LINE;
        let is_near_rim = ends.iter().any(|end| {
            let beyond = ((radius - end.length()) / width).max(1.0).ln();
            rays as f64 * off_right_angle(*end, radius) + beyond < digits
        });
        // Between both ends, or where their peaks end.
        let between = if is_near_rim {
            (0.5 * (ends[1] - ends[0]).length() / width).max(PEAK).asinh()
        } else {
            end_of_plane
        };
        for (end, other) in [(ends[0], ends[1]), (ends[1], ends[0])] {
            let directions = if is_near_rim {
                rays_about_right_angles(end, axis, (radius, width), digits, is_mirrored)
            } else {
                even_rays(rays, axis, is_mirrored)
            };
            for (ray, turn) in directions {
                let along = end.x * ray.x + end.y * ray.y;
                let square = radius * radius - end.squared() + along * along;
                let rim = ((square.max(0.0).sqrt() - along).max(0.0) / width).asinh();
                let edges = [0.0, rim.min(between), rim.max(between), end_of_plane];
                for edge in edges.windows(2).filter(|edge| edge[0] < edge[1]) {
                    let (from, to) = (edge[0], edge[1]);
                    let out = if from < rim { &mut at } else { &mut outside };
                    for node in &unit {
                        let u = from + (to - from) * node.x;
                        let grown = u.exp();
                        let (sinh, cosh) = (0.5 * (grown - 1.0 / grown), 0.5 * (grown + 1.0 / grown));
                        let away = width * sinh;
                        let area = turn * away * width * cosh * (to - from) * node.weight;
                        let at = Beta { x: end.x + away * ray.x, y: end.y + away * ray.y };
                        let [own, other] = [cube(at, end), cube(at, other)];
                        out.push((at, area * other / (own + other)));
                    }
                }
            }
        }
        let inside = at.len();
        at.extend(outside);
        Self { ends, width, at, inside }
    }

    pub(super) fn inside(&self) -> &[(Beta, f64)] {
        &self.at[..self.inside]
    }

    /// Returns the weights at the ends for lobes of these widths around them.
    #[inline(always)]
    pub(super) fn weights_at_ends(&self, widths: [f64; 2]) -> [f64; 2] {
        let [one, other] = self.ends;
        let line = other - one;
        let (square, middle) =
            (line.squared(), Beta { x: 0.5 * (one.x + other.x), y: 0.5 * (one.y + other.y) });
        // Finite also between ends at the same place.
        let scale = 1.0 / (square + self.width * self.width);
        let (mut sum, mut moment) = (0.0, 0.0);
        for (at, area) in &self.at {
            let away = *at - middle;
            let weight = area * density(widths[0], *at - one) * density(widths[1], *at - other);
            sum += weight;
            moment += weight * scale * (away.x * line.x + away.y * line.y);
        }
        let all = density(widths[0] + widths[1], line);
        let moment_of_plane = all * (widths[0] / (widths[0] + widths[1]) - 0.5) * square * scale;
        let (less, turned) = (0.5 * (all - sum), moment_of_plane - moment);
        [less - turned, less + turned]
    }
}

/// Returns the direction of the line between two ends, or of the ends if they are at the same place.
fn axis([one, other]: [Beta; 2]) -> Beta {
    let longer = |a: Beta, b: Beta| if a.length() > SAME_PLACE { a } else { b };
    let along = longer(other - one, longer(one, Beta { x: 1.0, y: 0.0 }));
    let length = along.length();
    Beta { x: along.x / length, y: along.y / length }
}

/// Returns a direction turned by an angle.
fn turned(direction: Beta, angle: f64) -> Beta {
    let (sin, cos) = angle.sin_cos();
    Beta { x: direction.x * cos - direction.y * sin, y: direction.y * cos + direction.x * sin }
}

/// Returns directions at even angles from the axis and the angle of each; of those that are mirror images, one
/// for both.
fn even_rays(count: usize, axis: Beta, is_mirrored: bool) -> Vec<(Beta, f64)> {
    let ray = |number: usize| {
        // That on the line is its own image.
        let images = if is_mirrored && 2 * number + 1 != count { 2.0 } else { 1.0 };
        (turned(axis, TAU * (number as f64 + 0.5) / count as f64), images * TAU / count as f64)
    };
    (0..if is_mirrored { count.div_ceil(2) } else { count }).map(ray).collect()
}

/// Returns the distance from the real azimuths of the singularity of the distance to the rim: it is at right
/// angles to the radius.
fn off_right_angle(end: Beta, radius: f64) -> f64 {
    (radius / end.length()).max(1.0).acosh()
}

/// Returns the same around the right angles to the radius of an end, where the distance to the rim changes
/// abruptly: from them, angles are stretched as the radius is from a rim.
fn rays_about_right_angles(
    end: Beta,
    axis: Beta,
    (radius, width): (f64, f64),
    digits: f64,
    is_mirrored: bool,
) -> Vec<(Beta, f64)> {
    // Much nearer to the rim than the width, the width counts.
    let off = off_right_angle(end, radius).clamp(0.5 * width, 1.0);
    let quarter = (FRAC_PI_2 / off).asinh();
    let each = 2.0 * Pole { at: 0.0, off: FRAC_PI_2 }.ellipse(0.0, quarter).ln();
    let count = points_for(digits, each) + MORE_RAYS;
    let length = end.length();
    let outward = if length > SAME_PLACE { Beta { x: end.x / length, y: end.y / length } } else { axis };
    let sides: &[f64] = if is_mirrored { &[1.0] } else { &[1.0, -1.0] };
    let mut rays = Vec::with_capacity(4 * count);
    for node in gauss(0.0, quarter, count) {
        let (away, turn) = (off * node.x.sinh(), off * node.x.cosh() * node.weight);
        for side in sides {
            for angle in [FRAC_PI_2 - away, FRAC_PI_2 + away] {
                rays.push((turned(outward, side * angle), turn * 2.0 / sides.len() as f64));
            }
        }
    }
    rays
}

/// Distance of the centre of the disc from the line between both ends below which it is on the line, and of
/// ends at the same place.
const ON_THE_LINE: f64 = 1e-9;
const SAME_PLACE: f64 = 1e-9;

const RAYS_A_DIGIT: f64 = 2.0;
const FEWEST_RAYS: usize = 6;
/// Rays in each quarter in addition to those that its singularity requires.
const MORE_RAYS: usize = 3;
const STEPS_A_DIGIT: f64 = 1.0;
const FEWEST_STEPS: usize = 3;
/// Distance, in widths, at which the peak around an end is over.
const PEAK: f64 = 2.0;
/// Distance beyond which hardly anything is left of a product of two lobes.
const FAR: f64 = 30.0;
