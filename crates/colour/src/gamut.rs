//! Colour gamut as an area of a chromaticity diagram: CIE 1976 u'v', or CIE 1931 xy.
//!
//! **What.** *Area*: the area of the triangle of three primaries over that of a reference, in
//! percent (Feng 2012, eq. 5-9, in u'v'; data sheets state "NTSC" in xy). *Coverage*: the fraction of
//! the reference triangle that the triangle of the primaries covers, in percent (IDMS 1.1, section
//! 5.18; there in x, y or u', v'). The type of the primaries selects the diagram ([`Chromaticity`]).
//! **Limits.** Neither quantity describes lightness. The triangle may be displaced from the
//! reference: an area of 100 % does not imply a coverage of 100 %. The two diagrams weight colours
//! differently, green more in xy and blue more in u'v': percentages of the two are not comparable.

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

/// Chromaticity of a diagram: [`UvPrime`] (CIE 1976 u'v') or [`Xy`] (CIE 1931 xy).
pub trait Chromaticity: Copy {
    /// Horizontal and vertical coordinate in the diagram.
    fn coordinates(self) -> [f64; 2];

    /// Red, green and blue of a reference in this diagram.
    fn primaries_of(reference: GamutReference) -> [Self; 3];
}

impl Chromaticity for UvPrime {
    fn coordinates(self) -> [f64; 2] {
        [self.u, self.v]
    }

    fn primaries_of(reference: GamutReference) -> [Self; 3] {
        reference.primaries_uv()
    }
}

impl Chromaticity for Xy {
    fn coordinates(self) -> [f64; 2] {
        [self.x, self.y]
    }

    fn primaries_of(reference: GamutReference) -> [Self; 3] {
        reference.primaries()
    }
}

/// A point of a diagram.
type Point = [f64; 2];

/// Area of a triangle in its diagram; its orientation does not matter.
pub fn triangle_area<C: Chromaticity>(corners: [C; 3]) -> f64 {
    area(corners.map(C::coordinates))
}

fn area([a, b, c]: [Point; 3]) -> f64 {
    0.5 * turn(a, b, c).abs()
}

/// Twice the signed area of a triangle, positive if its corners are anticlockwise.
fn turn(a: Point, b: Point, c: Point) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])
}

/// Gamut area: area of the triangle of the primaries in their diagram, % of the reference's area there.
///
/// ```
/// use papilio_colour::{GamutReference, gamut_percent};
/// // sRGB has 70.8 % of the area of NTSC in xy, as data sheets state it, and 87.2 % in u'v'.
/// let srgb = GamutReference::Srgb;
/// assert!((gamut_percent(srgb.primaries(), GamutReference::Ntsc) - 70.8).abs() < 0.05);
/// assert!((gamut_percent(srgb.primaries_uv(), GamutReference::Ntsc) - 87.2).abs() < 0.05);
/// ```
pub fn gamut_percent<C: Chromaticity>(primaries: [C; 3], reference: GamutReference) -> f64 {
    100.0 * triangle_area(primaries) / triangle_area(C::primaries_of(reference))
}

/// Gamut coverage: fraction of the reference triangle that the triangle of the primaries covers in their
/// diagram, %.
pub fn coverage_percent<C: Chromaticity>(primaries: [C; 3], reference: GamutReference) -> f64 {
    let of_reference = C::primaries_of(reference);
    let common = common_area(primaries.map(C::coordinates), of_reference.map(C::coordinates));
    100.0 * common / triangle_area(of_reference)
}

/// Area of the intersection of two triangles of any orientation.
fn common_area(one: [Point; 3], other: [Point; 3]) -> f64 {
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

/// Clips a polygon to the left of the line `from` - `to` (Sutherland, Hodgman 1974); returns its corners and
/// their number.
fn cut(shape: &[Point], from: Point, to: Point) -> ([Point; 6], usize) {
    let (mut kept, mut count) = ([from; 6], 0);
    let mut keep = |corner: Point| {
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
            keep([start[0] + t * (end[0] - start[0]), start[1] + t * (end[1] - start[1])]);
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

    /// Areas in xy by hand; data sheets take 0.1582 for NTSC, and state sRGB as "72 % NTSC" (from its
    /// 0.1121).
    #[test]
    fn areas_in_xy_equal_those_of_the_standards() {
        for (reference, area, percent_ntsc) in [
            (GamutReference::Srgb, 0.11205, 70.83),
            (GamutReference::Ebu, 0.113_4, 71.68),
            (GamutReference::Ntsc, 0.158_2, 100.0),
            (GamutReference::DciP3, 0.152_0, 96.08),
        ] {
            let primaries = reference.primaries();
            assert!((triangle_area(primaries) - area).abs() < 5.1e-5, "{reference:?}");
            assert!((gamut_percent(primaries, GamutReference::Ntsc) - percent_ntsc).abs() < 5.1e-3);
            assert!((coverage_percent(primaries, reference) - 100.0).abs() < 1e-12);
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

    fn at(u: f64, v: f64) -> Point {
        [u, v]
    }

    /// A right triangle and a copy rotated by 180 degrees and moved: the intersection is empty, a square, a
    /// hexagon.
    #[test]
    fn intersections_of_triangles_equal_areas_computed_by_hand() {
        let one = [at(0.0, 0.0), at(1.0, 0.0), at(0.0, 1.0)];
        let turned = |d: f64| [at(d, d), at(d - 1.0, d), at(d, d - 1.0)];
        assert!(common_area(one, turned(1.0)).abs() < 1e-15);
        assert!((common_area(one, turned(0.5)) - 0.25).abs() < 1e-15);
        assert!((common_area(one, turned(2.0 / 3.0)) - 1.0 / 3.0).abs() < 1e-15);
        assert!((common_area(one, one.map(|p| at(p[0] + 0.5, p[1]))) - 0.125).abs() < 1e-15);
        assert_eq!(common_area(one, one.map(|p| at(p[0] + 2.0, p[1]))), 0.0);
    }

    /// The area of an intersection is symmetric, at most that of either triangle, and equal to that of a
    /// contained one.
    #[test]
    fn intersection_of_triangles_is_symmetric_and_bounded() {
        let triangle = |dice: &mut Dice| [(); 3].map(|()| at(dice.throw(), dice.throw()));
        laws(
            300,
            |dice| (triangle(dice), triangle(dice), dice.throw()),
            |&(one, other, s)| {
                let shared = common_area(one, other);
                assert!((shared - common_area(other, one)).abs() < 1e-12);
                assert!(shared <= area(one).min(area(other)) + 1e-12);
                let [a, b, c] = one;
                let middle = at((a[0] + b[0] + c[0]) / 3.0, (a[1] + b[1] + c[1]) / 3.0);
                let within =
                    one.map(|p| at(middle[0] + s * (p[0] - middle[0]), middle[1] + s * (p[1] - middle[1])));
                assert!((common_area(within, one) - s * s * area(one)).abs() < 1e-12);
            },
        );
    }
}
