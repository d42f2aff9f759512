//! Tristimulus values and chromaticity diagrams.

use std::ops::{Add, Mul, Sub};

/// CIE tristimulus values X, Y, Z; relative values have Y = 1 for a perfect white.
///
/// Noise may make them slightly negative; all functions accept this.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Xyz {
    /// Tristimulus value X.
    pub x: f64,
    /// Tristimulus value Y, proportional to luminance.
    pub y: f64,
    /// Tristimulus value Z.
    pub z: f64,
}

/// CIE 1931 x, y chromaticity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Xy {
    /// x = X/(X + Y + Z).
    pub x: f64,
    /// y = Y/(X + Y + Z).
    pub y: f64,
}

/// CIE 1976 u', v' chromaticity: a point of the uniform chromaticity scale diagram.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UvPrime {
    /// u' = 4X/(X + 15Y + 3Z).
    pub u: f64,
    /// v' = 9Y/(X + 15Y + 3Z).
    pub v: f64,
}

/// CIE 1976 u', v' of D65, the reference of `distance_from_d65_uv` (CIE 15:2018: 0.1978, 0.4683;
/// the fifth digit is computed from x = 0.31272, y = 0.32903).
pub const D65_UV: UvPrime = UvPrime { u: 0.19784, v: 0.46834 };

/// Relative tristimulus values of D65 for the CIE 1931 observer (CIE 15:2018: 95.04, 100, 108.88; the digits
/// here are those of ASTM E308 and of most software).
pub const D65_WHITE: Xyz = Xyz { x: 0.95047, y: 1.0, z: 1.08883 };

impl Xyz {
    /// Returns `[X, Y, Z]`.
    #[inline]
    pub fn to_array(self) -> [f64; 3] {
        [self.x, self.y, self.z]
    }

    /// Computes the CIE 1931 x, y chromaticity; `None` if X + Y + Z is not positive.
    pub fn chromaticity(self) -> Option<Xy> {
        let sum = self.x + self.y + self.z;
        (sum > 0.0).then(|| Xy { x: self.x / sum, y: self.y / sum })
    }

    /// Computes the CIE 1976 u', v' chromaticity; `None` if X + 15Y + 3Z is not positive.
    pub fn uv_prime(self) -> Option<UvPrime> {
        let sum = self.x + 15.0 * self.y + 3.0 * self.z;
        (sum > 0.0).then(|| UvPrime { u: 4.0 * self.x / sum, v: 9.0 * self.y / sum })
    }
}

impl Xy {
    /// Converts to u', v'; `None` unless -2x + 12y + 3 is positive, as it is for all real colours.
    pub fn uv_prime(self) -> Option<UvPrime> {
        Xyz { x: self.x, y: self.y, z: 1.0 - self.x - self.y }.uv_prime()
    }

    /// Tristimulus values of this chromaticity with Y = `y`; `None` unless the chromaticity's y is positive.
    pub fn with_luminance(self, y: f64) -> Option<Xyz> {
        let Self { x: x_c, y: y_c } = self;
        (y_c > 0.0).then(|| Xyz { x: y * x_c / y_c, y, z: y * (1.0 - x_c - y_c) / y_c })
    }
}

impl Xyz {
    /// Euclidean distance.
    pub fn distance(self, other: Self) -> f64 {
        (self.x - other.x).hypot(self.y - other.y).hypot(self.z - other.z)
    }
}

impl UvPrime {
    /// Euclidean distance in the u'v' diagram.
    pub fn distance(self, other: Self) -> f64 {
        (self.u - other.u).hypot(self.v - other.v)
    }

    /// Tristimulus values of this chromaticity with Y = `y`; `None` unless v' is positive.
    pub fn with_luminance(self, y: f64) -> Option<Xyz> {
        let Self { u, v } = self;
        (v > 0.0).then(|| Xyz {
            x: y * 9.0 * u / (4.0 * v),
            y,
            z: y * (12.0 - 3.0 * u - 20.0 * v) / (4.0 * v),
        })
    }
}

impl Add for Xyz {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Self { x: self.x + other.x, y: self.y + other.y, z: self.z + other.z }
    }
}

impl Sub for Xyz {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + other * -1.0
    }
}

impl Mul<f64> for Xyz {
    type Output = Self;
    #[inline]
    fn mul(self, factor: f64) -> Self {
        Self { x: self.x * factor, y: self.y * factor, z: self.z * factor }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn d65_has_its_published_chromaticity() {
        let (xy, uv) = (D65_WHITE.chromaticity().unwrap(), D65_WHITE.uv_prime().unwrap());
        assert!((xy.x - 0.31272).abs() < 1e-5 && (xy.y - 0.32903).abs() < 1e-5);
        assert!(uv.distance(D65_UV) < 1e-5, "{uv:?}");
        assert!(xy.uv_prime().unwrap().distance(uv) < 1e-12);
    }

    #[test]
    fn chromaticity_and_luminance_give_the_tristimulus_values() {
        let colour = Xyz { x: 0.0701, y: 0.043, z: 0.0276 };
        let by_xy = colour.chromaticity().unwrap().with_luminance(colour.y).unwrap();
        let by_uv = colour.uv_prime().unwrap().with_luminance(colour.y).unwrap();
        for back in [by_xy, by_uv] {
            assert!((back - colour).to_array().iter().all(|d| d.abs() < 1e-15), "{back:?}");
        }
        assert_eq!(UvPrime { u: 0.2, v: 0.0 }.with_luminance(1.0), None);
    }

    #[test]
    fn chromaticity_without_light_is_undefined_and_with_noise_defined() {
        let dark = Xyz { x: 0.0, y: 0.0, z: 0.0 };
        assert_eq!((dark.chromaticity(), dark.uv_prime()), (None, None));
        let noisy = Xyz { x: -1e-6, y: 2e-6, z: 1e-6 };
        assert!(noisy.chromaticity().unwrap().x < 0.0);
        assert_eq!((noisy * -1.0).uv_prime(), None);
        let lost = Xyz { x: f64::NAN, y: 1.0, z: 1.0 };
        assert_eq!(lost.chromaticity(), None);
    }
}
