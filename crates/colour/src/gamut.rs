//! Gamut as an area of the u'v' diagram.
//!
//! **What.** The triangle of three primaries over that of a reference, in
//! percent (Feng 2012, eq. 5-9). **Limits.** An area says nothing about
//! lightness and may lie elsewhere than the reference: 100 % is not coverage.

use crate::{UvPrime, Xy};

/// A set of primaries to compare with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GamutReference {
    /// sRGB and ITU-R BT.709.
    Srgb,
    /// EBU Tech 3213.
    Ebu,
    /// NTSC 1953 (ITU-R BT.470, system M).
    Ntsc,
}

impl GamutReference {
    /// Red, green and blue.
    pub fn primaries(self) -> [Xy; 3] {
        let xy = |x, y| Xy { x, y };
        match self {
            Self::Srgb => [xy(0.64, 0.33), xy(0.30, 0.60), xy(0.15, 0.06)],
            Self::Ebu => [xy(0.64, 0.33), xy(0.29, 0.60), xy(0.15, 0.06)],
            Self::Ntsc => [xy(0.67, 0.33), xy(0.21, 0.71), xy(0.14, 0.08)],
        }
    }

    /// Red, green and blue in u'v'.
    pub fn primaries_uv(self) -> [UvPrime; 3] {
        // The same map as `Xy::uv_prime`, whose `None` cannot happen at a primary.
        self.primaries().map(|Xy { x, y }| {
            let sum = -2.0 * x + 12.0 * y + 3.0;
            UvPrime { u: 4.0 * x / sum, v: 9.0 * y / sum }
        })
    }

    /// Area of the triangle in u'v'.
    pub fn area(self) -> f64 {
        triangle_area(self.primaries_uv())
    }
}

/// Area of a triangle in u'v', whichever way round.
pub fn triangle_area([a, b, c]: [UvPrime; 3]) -> f64 {
    0.5 * ((b.u - a.u) * (c.v - a.v) - (c.u - a.u) * (b.v - a.v)).abs()
}

/// Area of the primaries' triangle in u'v', % of the reference's.
pub fn gamut_percent(primaries: [UvPrime; 3], reference: GamutReference) -> f64 {
    100.0 * triangle_area(primaries) / reference.area()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Areas computed by hand from the standards' chromaticities.
    #[test]
    fn the_references_have_their_known_areas() {
        for (reference, area) in [
            (GamutReference::Srgb, 0.064892),
            (GamutReference::Ebu, 0.065537),
            (GamutReference::Ntsc, 0.074426),
        ] {
            assert!((reference.area() - area).abs() < 5e-7, "{reference:?} {}", reference.area());
            assert!((gamut_percent(reference.primaries_uv(), reference) - 100.0).abs() < 1e-12);
        }
    }

    #[test]
    fn order_does_not_matter_and_a_line_has_no_area() {
        let [r, g, b] = GamutReference::Srgb.primaries_uv();
        assert!((triangle_area([g, r, b]) - triangle_area([r, g, b])).abs() < 1e-15);
        assert!(triangle_area([r, g, r]) < 1e-15);
    }
}
