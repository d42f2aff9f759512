//! Colour gamut as an area of the u'v' diagram.
//!
//! **What.** *Area*: the area of the triangle of three primaries over that of a reference, in
//! percent (Feng 2012, eq. 5-9). *Coverage*: the fraction of the reference triangle that the
//! triangle of the primaries covers, in percent (IDMS 1.1, section 5.18; there in x, y or u', v').
//! **Limits.** Neither quantity describes lightness. The triangle may be displaced from the
//! reference: an area of 100 % does not imply a coverage of 100 %.

use crate::{UvPrime, Xy};

/// Reference set of primaries of a gamut.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GamutReference {
    /// sRGB and ITU-R BT.709.
    Srgb,
    /// EBU Tech 3213.
    Ebu,
    /// NTSC 1953 (ITU-R BT.470, system M).
    Ntsc,
    /// DCI-P3 (SMPTE RP 431-2), whose primaries Display P3 shares.
    DciP3,
}

impl GamutReference {
    /// CIE 1931 x, y of red, green and blue.
    pub fn primaries(self) -> [Xy; 3] {
        let xy = |x, y| Xy { x, y };
        match self {
            Self::Srgb => [xy(0.64, 0.33), xy(0.30, 0.60), xy(0.15, 0.06)],
            Self::Ebu => [xy(0.64, 0.33), xy(0.29, 0.60), xy(0.15, 0.06)],
            Self::Ntsc => [xy(0.67, 0.33), xy(0.21, 0.71), xy(0.14, 0.08)],
            Self::DciP3 => [xy(0.680, 0.320), xy(0.265, 0.690), xy(0.150, 0.060)],
        }
    }

    /// CIE 1976 u', v' of red, green and blue.
    pub fn primaries_uv(self) -> [UvPrime; 3] {
        // The same conversion as `Xy::uv_prime`, which is always defined for a primary.
        self.primaries().map(|Xy { x, y }| {
            let sum = -2.0 * x + 12.0 * y + 3.0;
            UvPrime { u: 4.0 * x / sum, v: 9.0 * y / sum }
        })
    }

    /// Area of the triangle of the primaries in u'v'.
    pub fn area(self) -> f64 {
        triangle_area(self.primaries_uv())
    }
}

/// Area of a triangle in u'v'; its orientation does not matter.
pub fn triangle_area([a, b, c]: [UvPrime; 3]) -> f64 {
    0.5 * turn(a, b, c).abs()
}

/// Twice the signed area of a triangle, positive if its corners are anticlockwise.
fn turn(a: UvPrime, b: UvPrime, c: UvPrime) -> f64 {
    (b.u - a.u) * (c.v - a.v) - (c.u - a.u) * (b.v - a.v)
}

/// Gamut area: area of the triangle of the primaries in u'v', % of the reference's area.
pub fn gamut_percent(primaries: [UvPrime; 3], reference: GamutReference) -> f64 {
    100.0 * triangle_area(primaries) / reference.area()
}

/// Gamut coverage: fraction of the reference triangle that the triangle of the primaries covers, %.
pub fn coverage_percent(primaries: [UvPrime; 3], reference: GamutReference) -> f64 {
    100.0 * common_area(primaries, reference.primaries_uv()) / reference.area()
}

/// Area of the intersection of two triangles of any orientation.
fn common_area(one: [UvPrime; 3], other: [UvPrime; 3]) -> f64 {
    let [a, b, c] = other;
    let other = if turn(a, b, c) < 0.0 { [a, c, b] } else { other };
    // A triangle clipped by three lines has at most six corners.
    let mut shape = [one[0]; 6];
    shape[..3].copy_from_slice(&one);
    let mut corners = 3;
    for (from, to) in [(0, 1), (1, 2), (2, 0)] {
        (shape, corners) = cut(&shape[..corners], other[from], other[to]);
    }
    let fan = (2..corners).map(|k| turn(shape[0], shape[k - 1], shape[k]));
    0.5 * fan.sum::<f64>().abs()
}

/// Clips a polygon to the left of the line `from` - `to` (Sutherland, Hodgman 1974); returns its corners and their number.
fn cut(shape: &[UvPrime], from: UvPrime, to: UvPrime) -> ([UvPrime; 6], usize) {
    let (mut kept, mut count) = ([from; 6], 0);
    let mut keep = |corner: UvPrime| {
        if let Some(slot) = kept.get_mut(count) {
            *slot = corner;
            count += 1;
        }
    };
    for (k, &end) in shape.iter().enumerate() {
        let start = shape[(k + shape.len() - 1) % shape.len()];
        let (before, after) = (turn(from, to, start), turn(from, to, end));
        if before * after < 0.0 {
            let t = before / (before - after);
            keep(UvPrime { u: start.u + t * (end.u - start.u), v: start.v + t * (end.v - start.v) });
        }
        if after >= 0.0 {
            keep(end);
        }
    }
    (kept, count)
}

#[cfg(test)]
mod tests {
    use papilio_testing::{Dice, laws};

    use super::*;

    /// Areas computed by hand from the chromaticities of the standards.
    #[test]
    fn areas_of_the_references_equal_those_of_the_standards() {
        for (reference, area) in [
            (GamutReference::Srgb, 0.064892),
            (GamutReference::Ebu, 0.065537),
            (GamutReference::Ntsc, 0.074426),
            (GamutReference::DciP3, 0.081480),
        ] {
            assert!((reference.area() - area).abs() < 5e-7, "{reference:?} {}", reference.area());
            assert!((gamut_percent(reference.primaries_uv(), reference) - 100.0).abs() < 1e-12);
            assert!((coverage_percent(reference.primaries_uv(), reference) - 100.0).abs() < 1e-12);
        }
    }

    #[test]
    fn area_is_independent_of_the_order_and_zero_for_a_line() {
        let [r, g, b] = GamutReference::Srgb.primaries_uv();
        assert!((triangle_area([g, r, b]) - triangle_area([r, g, b])).abs() < 1e-15);
        assert!(triangle_area([r, g, r]) < 1e-15);
        assert!(coverage_percent([r, g, r], GamutReference::Srgb) < 1e-12);
        assert!((coverage_percent([g, r, b], GamutReference::Srgb) - 100.0).abs() < 1e-12);
    }

    fn at(u: f64, v: f64) -> UvPrime {
        UvPrime { u, v }
    }

    /// A right triangle and a copy rotated by 180 degrees and moved: the intersection is empty, a square, a hexagon.
    #[test]
    fn intersections_of_triangles_equal_areas_computed_by_hand() {
        let one = [at(0.0, 0.0), at(1.0, 0.0), at(0.0, 1.0)];
        let turned = |d: f64| [at(d, d), at(d - 1.0, d), at(d, d - 1.0)];
        assert!(common_area(one, turned(1.0)).abs() < 1e-15);
        assert!((common_area(one, turned(0.5)) - 0.25).abs() < 1e-15);
        assert!((common_area(one, turned(2.0 / 3.0)) - 1.0 / 3.0).abs() < 1e-15);
        assert!((common_area(one, one.map(|p| at(p.u + 0.5, p.v))) - 0.125).abs() < 1e-15);
        assert_eq!(common_area(one, one.map(|p| at(p.u + 2.0, p.v))), 0.0);
    }

    /// The area of an intersection is symmetric, at most that of either triangle, and equal to that of a contained one.
    #[test]
    fn intersection_of_triangles_is_symmetric_and_bounded() {
        let triangle = |dice: &mut Dice| [(); 3].map(|()| at(dice.throw(), dice.throw()));
        laws(
            300,
            |dice| (triangle(dice), triangle(dice), dice.throw()),
            |&(one, other, s)| {
                let shared = common_area(one, other);
                assert!((shared - common_area(other, one)).abs() < 1e-12);
                assert!(shared <= triangle_area(one).min(triangle_area(other)) + 1e-12);
                let [a, b, c] = one;
                let middle = at((a.u + b.u + c.u) / 3.0, (a.v + b.v + c.v) / 3.0);
                let within =
                    one.map(|p| at(middle.u + s * (p.u - middle.u), middle.v + s * (p.v - middle.v)));
                assert!((common_area(within, one) - s * s * triangle_area(one)).abs() < 1e-12);
            },
        );
    }
}
