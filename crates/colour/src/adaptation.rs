//! Chromatic adaptation: which colour in one light looks as a colour in another light does.
//!
//! **What.** The eye is completely adapted to the white of each light (degree of adaptation D = 1): the cone
//! responses of a colour, divided by those of its white, are the same in both lights (von Kries). Whites have
//! a luminance, too: the one white becomes the other exactly.
//!
//! **Parameters.** Both whites, each on the scale of its colours.
//!
//! **Range.** Whites with positive cone responses. Colours may have any values, as of noise.
//!
//! **Source.** The sharpened cone responses of CAT16: Li, Li, Wang, Zu, Luo, Cui, Melgosa, Brill, Pointer,
//! *Comprehensive color solutions: CAM16, CAT16, and CAM16-UCS*, Color Res. Appl. 42, 703 (2017); also those
//! of CIECAM16 (CIE 248:2022).

use crate::matrix::{Matrix, inverse, times};
use crate::{D65_WHITE, Xyz};

/// Matrix from X, Y, Z to the cone responses of CAT16 and CIECAM16.
pub(crate) const TO_CONES: Matrix =
    [[0.401288, 0.650173, -0.051461], [-0.250268, 1.204414, 0.045854], [-0.002079, 0.048952, 0.953127]];
/// Its inverse.
pub(crate) const FROM_CONES: Matrix = inverse(&TO_CONES);

/// Complete adaptation from one white to another: a matrix for X, Y and Z.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Adaptation {
    matrix: Matrix,
}

impl Adaptation {
    /// Computes the adaptation from one white to another; `None` unless all cone responses of both are
    /// positive.
    pub fn between(from: Xyz, to: Xyz) -> Option<Self> {
        let [from, to] = [from, to].map(|white| times(&TO_CONES, white.to_array()));
        let usable = |cones: [f64; 3]| cones.iter().all(|cone| *cone > 0.0 && cone.is_finite());
        (usable(from) && usable(to)).then(|| {
            let column = |k: usize| {
                let unit = [0, 1, 2].map(|i| f64::from(u8::from(i == k)));
                let cones = times(&TO_CONES, unit);
                times(&FROM_CONES, [0, 1, 2].map(|i| cones[i] * to[i] / from[i]))
            };
            let [x, y, z] = [column(0), column(1), column(2)];
            Self { matrix: [0, 1, 2].map(|i| [x[i], y[i], z[i]]) }
        })
    }

    /// The adaptation with this matrix.
    pub fn of_matrix(matrix: [[f64; 3]; 3]) -> Self {
        Self { matrix }
    }

    /// The matrix.
    pub fn matrix(&self) -> &[[f64; 3]; 3] {
        &self.matrix
    }

    /// Returns the corresponding colour in the other light.
    #[inline]
    pub fn apply(&self, colour: Xyz) -> Xyz {
        let [x, y, z] = times(&self.matrix, colour.to_array());
        Xyz { x, y, z }
    }
}

impl Xyz {
    /// Computes the corresponding colour of a surface under D65, relative to [`D65_WHITE`].
    ///
    /// `self` and `white` must be on the same scale. Returns `None` unless all cone responses of the white
    /// are positive.
    pub fn adapted_to_d65(self, white: Self) -> Option<Self> {
        Some(Adaptation::between(white, D65_WHITE)?.apply(self))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const A: Xyz = Xyz { x: 1.0985, y: 1.0, z: 0.35585 };

    fn assert_near(ours: Xyz, theirs: [f64; 3], tolerance: f64) {
        let ours = ours.to_array();
        assert!(ours.iter().zip(theirs).all(|(o, t)| (o - t).abs() < tolerance), "{ours:?} {theirs:?}");
    }

    /// colour-science 0.4.7,
    /// `chromatic_adaptation_VonKries([0.2, 0.12, 0.05], A, D65_WHITE, transform="CAT16")`.
    #[test]
    fn adapted_colour_agrees_with_colour_science() {
        let seen = Xyz { x: 0.2, y: 0.12, z: 0.05 }.adapted_to_d65(A).unwrap();
        assert_near(seen, [0.18079224949721415, 0.11816578251968769, 0.15099929143090574], 1e-12);
    }

    #[test]
    fn adapted_paper_is_white_in_any_light() {
        for white in [A, D65_WHITE, Xyz { x: 1.0, y: 1.0, z: 1.0 }] {
            let seen = (white * 0.3).adapted_to_d65(white).unwrap();
            assert_near(seen, (D65_WHITE * 0.3).to_array(), 1e-14);
        }
        assert_eq!(A.adapted_to_d65(Xyz { x: 0.0, y: 0.0, z: 0.0 }), None);
    }

    #[test]
    fn adaptation_there_and_back_returns_the_colour() {
        let (there, back) =
            (Adaptation::between(A, D65_WHITE * 0.4), Adaptation::between(D65_WHITE * 0.4, A));
        let colour = Xyz { x: 0.7, y: 0.2, z: -0.1 };
        assert_near(back.unwrap().apply(there.unwrap().apply(colour)), colour.to_array(), 1e-14);
    }
}
