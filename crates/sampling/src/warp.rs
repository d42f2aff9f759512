//! Maps from the unit square, each with its density.

use std::f64::consts::TAU;

/// The point at this radius and at azimuth `2 pi v`, v in [0, 1].
///
/// Error of sine and cosine below 4e-16. Because the argument is a fraction of a turn, the
/// reduction to an eighth of a turn is exact, and the function is several times as fast as `sin_cos`.
#[inline(always)]
pub fn polar(radius: f64, v: f64) -> (f64, f64) {
    let (nearest, quarter) = rounded(4.0 * v);
    let turn = v - 0.25 * nearest;
    let (sin, cos) = (turn * polynomial(turn * turn, SINE), polynomial(turn * turn, COSINE));
    let (sin, cos) = if quarter & 1 == 0 { (sin, cos) } else { (cos, -sin) };
    let radius = if quarter & 2 == 0 { radius } else { -radius };
    (radius * cos, radius * sin)
}

/// Returns the integer nearest to x, for x from -1/2 to 2^51, and its lowest bits. (Conversions saturate,
/// which compilers do not vectorise, and rounding is a function call on baseline processors.)
#[inline(always)]
pub fn rounded(x: f64) -> (f64, u32) {
    // Numbers from 2^52 to 2^53 are integers.
    const SHIFT: f64 = 1.5 * 4_503_599_627_370_496.0;
    let shifted = x + SHIFT;
    (shifted - SHIFT, shifted.to_bits() as u32)
}

/// Minimax polynomials (Remez' algorithm) of `sin(2 pi t)/t` and `cos(2 pi t)` in powers of `t^2`, for |t| up
/// to 1/8; the largest errors are 1e-18 and 5e-17.
const SINE: [f64; 7] = [
    TAU,
    -41.341_702_240_399_41,
    81.605_249_275_830_35,
    -76.705_859_678_452_78,
    42.058_682_266_012_006,
    -15.093_663_204_857_455,
    3.778_092_362_991_274_3,
];
const COSINE: [f64; 7] = [
    1.0,
    -19.739_208_802_178_42,
    64.939_394_022_365_58,
    -85.456_817_090_398_12,
    60.244_620_092_960_24,
    -26.424_257_434_735_12,
    7.810_299_497_052_723,
];

/// Evaluates a polynomial with even and odd powers in parallel, which halves the dependency chain of Horner's
/// rule.
#[inline(always)]
fn polynomial(x: f64, [a, b, c, d, e, f, g]: [f64; 7]) -> f64 {
    let x2 = x * x;
    (a + x2 * (c + x2 * (e + x2 * g))) + x * (b + x2 * (d + x2 * f))
}

/// Maps to a point of the disc of this radius, with density [`uniform_disc_density`].
///
/// With radius n, the point is a direction of the hemisphere with density cos(theta)/pi per
/// steradian, in direction cosines of a medium of index n.
#[inline]
pub fn uniform_disc(radius: f64, u: [f64; 2]) -> (f64, f64) {
    polar(radius * u[0].sqrt(), u[1])
}

/// Density of [`uniform_disc`], per unit area.
#[inline]
pub fn uniform_disc_density(radius: f64) -> f64 {
    2.0 / (TAU * radius * radius)
}

/// Maps to a unit vector within `half_angle` (radians) of `axis`, uniform in solid angle,
/// with density [`uniform_cone_density`]. `axis` is a unit vector.
#[inline(always)]
pub fn uniform_cone(axis: [f64; 3], half_angle: f64, u: [f64; 2]) -> [f64; 3] {
    deflected(axis, one_minus_cos(half_angle) * u[0], u[1])
}

/// 1 - cos(angle) without cancellation; fields of view of 0.1 deg are common.
#[inline]
pub fn one_minus_cos(angle: f64) -> f64 {
    2.0 * (0.5 * angle).sin().powi(2)
}

/// The unit vector at an angle with this `1 - cos` from the unit vector `axis`, at azimuth `2 pi v`.
#[inline(always)]
pub fn deflected(axis: [f64; 3], one_minus_cos: f64, v: f64) -> [f64; 3] {
    let sin = (one_minus_cos * (2.0 - one_minus_cos)).max(0.0).sqrt();
    let (x, y) = polar(sin, v);
    let z = 1.0 - one_minus_cos;
    let (tangent, bitangent) = frame(axis);
    std::array::from_fn(|i| x * tangent[i] + y * bitangent[i] + z * axis[i])
}

/// Density of [`uniform_cone`], per steradian.
pub fn uniform_cone_density(half_angle: f64) -> f64 {
    1.0 / (TAU * one_minus_cos(half_angle))
}

/// Two unit vectors that are orthogonal to `axis` and each other (Duff et al., JCGT 6:1, 2017).
#[inline(always)]
fn frame(axis: [f64; 3]) -> ([f64; 3], [f64; 3]) {
    let [x, y, z] = axis;
    let sign = 1.0_f64.copysign(z);
    let a = -1.0 / (sign + z);
    let b = x * y * a;
    ([1.0 + sign * x * x * a, sign * b, -sign * x], [b, sign + y * y * a, -y])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{SampleStream, Sampler};
    use papilio_testing::ChiSquare;

    const POINTS: u64 = 40_000;

    /// Chi-square of samples on 16 x 16 cells of equal probability. `sample` maps them back to the unit
    /// square by the cumulative distribution.
    fn chi_square(sample: impl Fn([f64; 2]) -> [f64; 2]) -> ChiSquare {
        let numbers = SampleStream::new(Sampler::Random, 11, 0);
        let mut cells = [0.0_f64; 256];
        for path in 0..POINTS {
            let u = numbers.block(path, 0);
            let square = sample([u[0], u[1]]);
            let cell = |v: f64| ((v * 16.0) as usize).min(15);
            cells[cell(square[0]) * 16 + cell(square[1])] += 1.0;
        }
        ChiSquare::uniform(&cells)
    }

    fn turn(x: f64, y: f64) -> f64 {
        y.atan2(x).rem_euclid(TAU) / TAU
    }

    #[test]
    fn polar_equals_sine_and_cosine() {
        for step in 0..=10_000 {
            let v = f64::from(step) / 10_000.0;
            let (x, y) = polar(2.0, v);
            let (sin, cos) = (TAU * v).sin_cos();
            // The reference itself rounds 2 pi v, by up to 4e-16.
            assert!((x - 2.0 * cos).abs() < 2e-15 && (y - 2.0 * sin).abs() < 2e-15, "{v}");
        }
    }

    #[test]
    fn uniform_disc_samples_follow_their_density() {
        let radius: f64 = 1.5;
        let fraction_within = |r: f64| uniform_disc_density(radius) * std::f64::consts::PI * r * r;
        let found = chi_square(|u| {
            let (x, y) = uniform_disc(radius, u);
            [fraction_within(x.hypot(y)), turn(x, y)]
        });
        assert!(found.is_likely(), "{found:?}");
    }

    #[test]
    fn chi_square_detects_wrong_density() {
        let found = chi_square(|u| {
            let (x, y) = polar(u[0], u[1]);
            [x * x + y * y, turn(x, y)]
        });
        assert!(!found.is_likely(), "{found:?}");
    }

    #[test]
    fn uniform_cone_samples_follow_their_density() {
        for (axis, half_angle) in [
            ([0.0, 0.0, 1.0], 0.4),
            ([0.6, 0.0, 0.8], 0.01),
            ([0.0, -0.8, -0.6], 1.2),
            ([0.0, 0.0, -1.0], 0.3),
        ] {
            let (tangent, bitangent) = frame(axis);
            let dot = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).map(|(p, q)| p * q).sum::<f64>();
            let found = chi_square(|u| {
                let d = uniform_cone(axis, half_angle, u);
                assert!((dot(d, d) - 1.0).abs() < 1e-12);
                let (x, y) = (dot(d, tangent), dot(d, bitangent));
                let one_minus_cos = (x * x + y * y) / (1.0 + dot(d, axis));
                [uniform_cone_density(half_angle) * TAU * one_minus_cos, turn(x, y)]
            });
            assert!(found.is_likely(), "{axis:?} {half_angle}: {found:?}");
        }
    }
}
