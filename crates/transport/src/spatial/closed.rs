//! Closed forms of the spread of light, for tests, estimates and documentation.
//!
//! **k-correlation lobe** of width b over a mirror, seen through a clear medium (thickness d, index n), for
//! small angles and without the edge of the hemisphere: the blur of one pass has the width `c = b d/n` in the
//! plane of the panel.

use std::f64::consts::PI;

use crate::numerics::bessel::x2_k2_half;

/// Modulation transfer of a k-correlation lobe in diffuse light: `exp(-2 pi f c)`.
pub fn lobe_in_diffuse_light(frequency_per_mm: f64, width_mm: f64) -> f64 {
    (-2.0 * PI * frequency_per_mm * width_mm).exp()
}

/// Modulation transfer of a k-correlation lobe that is seen in the mirror direction of a beam:
/// `x^2 K_2(x)/2`, x = 2 pi f c.
pub fn lobe_in_mirrored_beam(frequency_per_mm: f64, width_mm: f64) -> f64 {
    x2_k2_half(2.0 * PI * frequency_per_mm * width_mm)
}

/// Fraction of the light seen at a point, in diffuse light through a k-correlation lobe, that comes from a
/// rectangle `[x0, x1] x [y0, y1]` (mm, relative to the point): the solid angle of the rectangle from a
/// height c, over 2 pi.
pub fn lobe_from_rectangle([x0, x1]: [f64; 2], [y0, y1]: [f64; 2], width_mm: f64) -> f64 {
    let corner = |x: f64, y: f64| {
        let slant = (width_mm * width_mm + x * x + y * y).sqrt();
        (x * y / (width_mm * slant)).atan() / (2.0 * PI)
    };
    corner(x1, y1) - corner(x0, y1) - corner(x1, y0) + corner(x0, y0)
}

/// Integral over a rectangle `[x, y]` (mm) of the fraction of the light seen at its points, in diffuse light
/// through a k-correlation lobe, that comes from another rectangle, mm^2. Exchanging the two changes nothing.
pub fn lobe_between_rectangles(seen: [[f64; 2]; 2], source: [[f64; 2]; 2], width_mm: f64) -> f64 {
    let c = width_mm;
    // Derived twice by x and by y, it is the lobe's spread.
    let corner = |x: f64, y: f64| {
        let slant = (c * c + x * x + y * y).sqrt();
        let angle = x * y * (x * y / (c * slant)).atan();
        let sides = y * (y / c.hypot(x)).asinh() + x * (x / c.hypot(y)).asinh() - slant;
        (angle + c * sides) / (2.0 * PI)
    };
    // Differences of edges along an axis, with their signs.
    let edges = |axis: usize| {
        let ([a, b], [from, to]) = (seen[axis], source[axis]);
        [(to - a, 1.0), (to - b, -1.0), (from - a, -1.0), (from - b, 1.0)]
    };
    let pairs = edges(0).into_iter().flat_map(|x| edges(1).map(|y| (x, y)));
    pairs.map(|((x, sign), (y, other))| sign * other * corner(x, y)).sum()
}

/// Fraction of the light that reaches a stripe from the hemisphere of the air, through an ideal
/// antireflection face, that entered above the stripe itself: through the stripe of the same width at this
/// height. The height is at most `sqrt(index^2 - 1)` widths, so that no light comes from beyond the next
/// stripe.
pub fn entrance_own_stripe(stripe_mm: f64, height_mm: f64, index: f64) -> f64 {
    let mean_shift = 2.0 / PI * (index * index * (1.0 / index).asin() - (index * index - 1.0).sqrt());
    1.0 - mean_shift * height_mm / stripe_mm
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(found: f64, expected: f64) {
        assert!((found - expected).abs() < 6e-7, "{found} {expected}");
    }

    /// Mean over a stripe of this width of the fraction of light that comes from the stripe itself.
    fn lobe_own_stripe(stripe_mm: f64, width_mm: f64) -> f64 {
        let ratio = stripe_mm / width_mm;
        2.0 / PI * (ratio.atan() - (ratio * ratio).ln_1p() / (2.0 * ratio))
    }

    /// Values of a separate program (numpy, scipy).
    #[test]
    fn lobes_have_known_transfer() {
        for (x, diffuse, beam) in [
            (0.1, 0.904_837, 0.997_520),
            (0.5, 0.606_531, 0.943_773),
            (2.0_f64.ln(), 0.5, 0.898_784),
            (1.0, 0.367_879, 0.812_419),
            (2.0, 0.135_335, 0.507_520),
            (3.0, 0.049_787, 0.276_797),
        ] {
            close(lobe_in_diffuse_light(x / (2.0 * PI), 1.0), diffuse);
            close(lobe_in_mirrored_beam(x / (2.0 * PI), 1.0), beam);
        }
    }

    /// H78 (b = 0.05667) under 0.5 mm of glass: stripes and a square pixel of 300 ppi.
    #[test]
    fn lobe_has_known_fractions_of_rectangles() {
        let c = 0.05667 * 0.5 / 1.5;
        let pixel = 25.4 / 300.0;
        assert!((lobe_own_stripe(pixel / 3.0, c) - 0.374_55).abs() < 1e-5);
        assert!((lobe_own_stripe(pixel, c) - 0.643_74).abs() < 1e-5);
        let half = [-pixel / 2.0, pixel / 2.0];
        assert!((lobe_from_rectangle(half, half, c) - 0.6279).abs() < 5e-5);
        let far = [-1e9, 1e9];
        close(lobe_from_rectangle(far, far, c), 1.0);
        // The own share of a stripe is the mean of that of its points.
        let steps = 4000;
        let at = |k: usize| pixel * (k as f64 + 0.5) / f64::from(steps as u32);
        let mean = (0..steps).map(|k| lobe_from_rectangle([-at(k), pixel - at(k)], far, c)).sum::<f64>();
        close(mean / f64::from(steps as u32), lobe_own_stripe(pixel, c));
    }

    /// Between rectangles: the mean over the points of one, by the midpoint rule.
    #[test]
    fn lobe_between_rectangles_is_the_mean_over_points() {
        let c = 0.3;
        let (seen, source) = ([[0.1, 0.5], [-0.2, 0.3]], [[0.4, 1.4], [0.0, 0.7]]);
        let steps = 200;
        let at =
            |side: [f64; 2], k: usize| side[0] + (side[1] - side[0]) * (k as f64 + 0.5) / f64::from(steps);
        let mut sum = 0.0;
        for column in 0..steps as usize {
            for row in 0..steps as usize {
                let (x, y) = (at(seen[0], column), at(seen[1], row));
                sum += lobe_from_rectangle(source[0].map(|edge| edge - x), source[1].map(|edge| edge - y), c);
            }
        }
        let expected = sum * 0.4 * 0.5 / f64::from(steps * steps);
        assert!((lobe_between_rectangles(seen, source, c) - expected).abs() < 1e-6);
        close(lobe_between_rectangles(seen, source, c), lobe_between_rectangles(source, seen, c));
        // Long stripes: the closed form of a single stripe.
        let (pixel, long) = (25.4 / 900.0, [-50.0, 50.0]);
        let stripe = [[0.0, pixel], [-0.5, 0.5]];
        let own = lobe_between_rectangles(stripe, [[0.0, pixel], long], 0.018_89) / pixel;
        assert!((own - lobe_own_stripe(pixel, 0.018_89)).abs() < 1e-6);
    }
}
