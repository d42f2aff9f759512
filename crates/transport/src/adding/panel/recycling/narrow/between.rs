//! Integrals over a disc of the product of two lobes around two directions and a smooth function.
//!
//! The plane is divided between both ends by factors that are one at one of them and vanish at the other,
//! with the sixth power of the distance: enough to remove the peak there. Around each end it is integrated in
//! polar coordinates, with the radius stretched as for a rim ([`super::basis`]), and the azimuth counted from
//! the line between both ends. If the centre of the disc is on that line, one half of the disc is the mirror
//! image of the other, and only one is computed: the smooth function depends on the distances from the centre
//! and from the ends. Weights at the ends complete the rule, so that linear functions along the line between
//! them are integrated exactly over the plane: what it has to resolve is only how the smooth function differs
//! from a linear one, and the rim.

use std::f64::consts::TAU;

use papilio_optics::Beta;

use crate::numerics::quadrature::{Node, gauss};

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
        let computed = if is_mirrored { rays.div_ceil(2) } else { rays };
        for (end, other) in [(ends[0], ends[1]), (ends[1], ends[0])] {
            for ray in 0..computed {
                let (sin, cos) = (TAU * (ray as f64 + 0.5) / rays as f64).sin_cos();
                let (cos, sin) = (axis.x * cos - axis.y * sin, axis.y * cos + axis.x * sin);
                // That on the line is its own image.
                let images = if is_mirrored && 2 * ray + 1 != rays { 2.0 } else { 1.0 };
                let turn = images * TAU / rays as f64;
                let along = end.x * cos + end.y * sin;
                let square = radius * radius - end.squared() + along * along;
                let rim = ((square.max(0.0).sqrt() - along).max(0.0) / width).asinh();
                for (from, to, out) in [(0.0, rim, &mut at), (rim, end_of_plane, &mut outside)] {
                    for node in &unit {
                        let u = from + (to - from) * node.x;
                        let grown = u.exp();
                        let (sinh, cosh) = (0.5 * (grown - 1.0 / grown), 0.5 * (grown + 1.0 / grown));
                        let away = width * sinh;
                        let area = turn * away * width * cosh * (to - from) * node.weight;
                        let at = Beta { x: end.x + away * cos, y: end.y + away * sin };
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

/// Distance of the centre of the disc from the line between both ends below which it is on the line, and of
/// ends at the same place.
const ON_THE_LINE: f64 = 1e-9;
const SAME_PLACE: f64 = 1e-9;

const RAYS_A_DIGIT: f64 = 2.0;
const FEWEST_RAYS: usize = 6;
const STEPS_A_DIGIT: f64 = 1.0;
const FEWEST_STEPS: usize = 3;
/// Distance beyond which hardly anything is left of a product of two lobes.
const FAR: f64 = 30.0;
