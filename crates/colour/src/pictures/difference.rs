//! CIEDE2000 of many colours in single precision, without trigonometric functions.

use super::lab::{COS_6, COS_30, COS_63, COS_BLUE, SIN_6, SIN_63, SIN_BLUE};
use super::rows::{LANES, lanes};
use crate::Lab;

/// Sine of twice the rotation of CIEDE2000, by the tangent of half of the hue beyond blue.
pub(super) struct Hues {
    turns: Vec<f32>,
}

/// Largest tangent of half of a hue from blue: beyond 110 degrees the rotation is below 1e-8.
const FAR: f32 = 1.428_148;

/// Steps of the table.
const STEPS: usize = 4096;

impl Hues {
    pub(super) fn new() -> Self {
        let turn = |step: usize| {
            let tangent = f64::from(FAR) * (2.0 * step as f64 / STEPS as f64 - 1.0);
            let degrees = 2.0 * tangent.atan().to_degrees();
            (2.0 * 30.0_f64.to_radians() * (-(degrees / 25.0).powi(2)).exp()).sin() as f32
        };
        Self { turns: (0..STEPS + 2).map(turn).collect() }
    }

    /// Place of a hue in the table, from cosine and sine of its distance from blue.
    #[inline(always)]
    fn place(cos: f32, sin: f32) -> f32 {
        let tangent = sin / (1.0 + cos);
        ((tangent / FAR + 1.0) * (0.5 * STEPS as f32)).clamp(0.0, STEPS as f32)
    }

    /// Sine of twice the rotation at a place.
    #[inline(always)]
    fn turn(&self, place: f32) -> f32 {
        let step = place as usize;
        let (one, other) = (self.turns[step], self.turns[step + 1]);
        one + (place - step as f32) * (other - one)
    }
}

/// CIEDE2000 of colours in CIELAB by planes, whose lengths are multiples of [`LANES`].
#[inline(always)]
pub(super) fn delta_e_2000(one: [&[f32]; 3], other: [&[f32]; 3], hues: &Hues, into: &mut [f32]) {
    for (block, into) in into.as_chunks_mut::<LANES>().0.iter_mut().enumerate() {
        let at = block * LANES;
        let one = [lanes(one[0], at), lanes(one[1], at), lanes(one[2], at)];
        let other = [lanes(other[0], at), lanes(other[1], at), lanes(other[2], at)];
        let Parts { plain, crossed, cos, sin } = parts(one, other);
        let (mut blue, mut places) = ([0.0; LANES], [0.0; LANES]);
        for k in 0..LANES {
            let from_blue = sin[k] * COS_BLUE as f32 - cos[k] * SIN_BLUE as f32;
            blue[k] = cos[k] * COS_BLUE as f32 + sin[k] * SIN_BLUE as f32;
            places[k] = Hues::place(blue[k], from_blue);
        }
        let mut turned = [0.0; LANES];
        for k in 0..LANES {
            if blue[k] > -0.342_02 {
                turned[k] = crossed[k] * hues.turn(places[k]);
            }
        }
        let mut has_none = false;
        for k in 0..LANES {
            into[k] = (plain[k] + turned[k]).max(0.0).sqrt();
            has_none |= cos[k].is_nan();
        }
        if has_none {
            // Opposite hues, whose mean is a convention.
            for (k, into) in into.iter_mut().enumerate().filter(|(k, _)| cos[*k].is_nan()) {
                let lab =
                    |[l, a, b]: [&[f32; LANES]; 3]| Lab { l: l[k].into(), a: a[k].into(), b: b[k].into() };
                *into = lab(one).delta_e_2000(lab(other)) as f32;
            }
        }
    }
}

/// The squared difference without the part of blue hues, that part over the sine of twice the rotation, and the
/// mean hue, not a number where there is none.
struct Parts {
    plain: [f32; LANES],
    crossed: [f32; LANES],
    cos: [f32; LANES],
    sin: [f32; LANES],
}

#[inline(always)]
fn parts(one: [&[f32; LANES]; 3], other: [&[f32; LANES]; 3]) -> Parts {
    const FAR_CHROMA: f32 = 6_103_515_625.0; // 25^7
    let weight = |chroma: f32| {
        let square = chroma * chroma;
        let seventh = square * square * square * chroma;
        (seventh / (seventh + FAR_CHROMA)).sqrt()
    };
    let length = |a: f32, b: f32| (a * a + b * b).sqrt();
    let zero = [0.0; LANES];
    let mut parts = Parts { plain: zero, crossed: zero, cos: zero, sin: zero };
    for at in 0..LANES {
        let (l1, a1, b1) = (one[0][at], one[1][at], one[2][at]);
        let (l2, a2, b2) = (other[0][at], other[1][at], other[2][at]);
        let stretch = 1.5 - 0.5 * weight(0.5 * (length(a1, b1) + length(a2, b2)));
        let (a1, a2) = (a1 * stretch, a2 * stretch);
        let (c1, c2) = (length(a1, b1), length(a2, b2));
        let (u, v) = (a1 * c2 + a2 * c1, b1 * c2 + b2 * c1);
        let sum = length(u, v);
        // The difference of a grey has no part of hue.
        let has_mean = (c1 * c2 == 0.0) | (sum > 1e-3 * c1 * c2);
        let sum = if sum > 0.0 { sum } else { 1.0 };
        let (cos, sin) = (u / sum, v / sum);
        let (cos2, sin2) = (cos * cos - sin * sin, 2.0 * cos * sin);
        let (cos3, sin3) = (cos2 * cos - sin2 * sin, sin2 * cos + cos2 * sin);
        let (cos4, sin4) = (cos2 * cos2 - sin2 * sin2, 2.0 * cos2 * sin2);
        let t = 1.0 - 0.17 * (COS_30 as f32 * cos + 0.5 * sin)
            + 0.24 * cos2
            + 0.32 * (COS_6 as f32 * cos3 - SIN_6 as f32 * sin3)
            - 0.2 * (COS_63 as f32 * cos4 + SIN_63 as f32 * sin4);
        let (l, c) = (0.5 * (l1 + l2) - 50.0, 0.5 * (c1 + c2));
        let lightness = (l2 - l1) / (1.0 + 0.015 * l * l / (20.0 + l * l).sqrt());
        let chroma = (c2 - c1) / (1.0 + 0.045 * c);
        let turned = a1 * b2 - a2 * b1;
        let hue = 2.0 * (c1 * c2).sqrt() * turned / (sum * (1.0 + 0.015 * c * t));
        parts.plain[at] = lightness * lightness + chroma * chroma + hue * hue;
        parts.crossed[at] = -2.0 * weight(c) * chroma * hue;
        parts.cos[at] = if has_mean { cos } else { f32::NAN };
        parts.sin[at] = sin;
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_in_single_precision_are_those_of_colours() {
        let spread = |k: usize, step: f64| 2.0 * (step * k as f64).fract() - 1.0;
        let plane = |scale: f64, shift: f64, step: f64| -> Vec<f32> {
            (0..30_016).map(|k| (shift + scale * spread(k, step)) as f32).collect()
        };
        let one =
            [plane(50.0, 50.0, 0.414_213_56), plane(90.0, 0.0, 0.732_050_8), plane(90.0, 0.0, 0.236_067_98)];
        let far =
            [plane(50.0, 50.0, 0.645_751_31), plane(90.0, 0.0, 0.316_624_79), plane(90.0, 0.0, 0.605_551_28)];
        let near = [0, 1, 2].map(|k| one[k].iter().zip(&far[k]).map(|(one, far)| one + 0.03 * far).collect());
        let grey = [one[0].clone(), vec![0.0; 30_016], vec![0.0; 30_016]];
        let hues = Hues::new();
        for other in [&far, &near, &grey, &one] {
            let mut found = vec![0.0; 30_016];
            let [a, b] = [&one, other].map(|planes| planes.each_ref().map(Vec::as_slice));
            delta_e_2000(a, b, &hues, &mut found);
            for (at, found) in found.into_iter().enumerate() {
                let lab =
                    |[l, a, b]: &[Vec<f32>; 3]| Lab { l: l[at].into(), a: a[at].into(), b: b[at].into() };
                let expected = lab(&one).delta_e_2000(lab(other));
                assert!(
                    (f64::from(found) - expected).abs() < 2e-4 * (1.0 + expected),
                    "{at}: {found} {expected}"
                );
            }
        }
    }
}
