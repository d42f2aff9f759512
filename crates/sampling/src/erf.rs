//! The complementary error function and its inverse.
//!
//! **Definition.** `erfc(x) = 2/sqrt(pi) int_x^inf exp(-t^2) dt` and its inverse, each as piecewise rational
//! approximations. The cumulative normal distribution is `erfc(-z/sqrt 2)/2`. **Accuracy.** Relative error of
//! `erfc` 1e-10, because the constants of its tail have ten digits; of `erfc_inv` 1e-14. **Source.** The
//! coefficients are those of the Boost Math Toolkit (copyright John Maddock 2006, `LICENSE-BOOST`). The
//! constants of the tail are rounded, and the operations ordered, as in the crate statrs; results equal those
//! of statrs to the last bit.

mod pieces;

use pieces::{CENTRE, INVERSE_CENTRE, INVERSE_FLANK, INVERSE_TAIL, Piece, TAIL};

impl Piece {
    fn numerator(&self, x: f64) -> f64 {
        polynomial(self.above, x - self.from)
    }

    fn denominator(&self, x: f64) -> f64 {
        polynomial(self.below, x - self.from)
    }

    /// Base plus ratio, times `scale`.
    fn scaled(&self, x: f64, scale: f64) -> f64 {
        scale * self.base + scale * (self.numerator(x) / self.denominator(x))
    }
}

fn polynomial(coefficients: &[f64], x: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, coefficient| sum * x + coefficient)
}

/// The complementary error function.
///
/// ```
/// assert!((papilio_sampling::erfc(1.0) - 0.157299207050285).abs() < 1e-10);
/// ```
pub fn erfc(x: f64) -> f64 {
    if x.is_nan() {
        x
    } else if x < -0.5 {
        2.0 - tail(-x)
    } else if x < 0.0 {
        1.0 + erf(-x)
    } else if x < 0.5 {
        1.0 - erf(x)
    } else {
        tail(x)
    }
}

/// The error function for x from 0 to 0.5.
fn erf(x: f64) -> f64 {
    if x < 1e-10 {
        x * CENTRE.base + x * CENTRE.above[0]
    } else if x < CENTRE.until {
        x * CENTRE.base + x * CENTRE.numerator(x) / CENTRE.denominator(x)
    } else {
        1.0 - tail(x)
    }
}

/// The complementary error function for x from 0.5.
fn tail(x: f64) -> f64 {
    let piece = TAIL.iter().find(|piece| x < piece.until);
    piece.map_or(0.0, |piece| piece.scaled(x, (-x * x).exp() / x))
}

/// The inverse of [`erfc`]; infinite where q is not between 0 and 2.
///
/// ```
/// assert!((papilio_sampling::erfc_inv(0.5) - 0.476936276204470).abs() < 1e-15);
/// ```
pub fn erfc_inv(q: f64) -> f64 {
    if q <= 0.0 {
        f64::INFINITY
    } else if q >= 2.0 {
        f64::NEG_INFINITY
    } else if q > 1.0 {
        -positive(q - 1.0, 2.0 - q)
    } else {
        positive(1.0 - q, q)
    }
}

/// Returns the x >= 0 with erf(x) = `p` and erfc(x) = `q`. Both are given because the smaller one has more
/// digits.
fn positive(p: f64, q: f64) -> f64 {
    if p <= INVERSE_CENTRE.until {
        INVERSE_CENTRE.scaled(p, p * (p + 10.0))
    } else if q >= INVERSE_FLANK.from {
        let ratio = INVERSE_FLANK.numerator(q) / INVERSE_FLANK.denominator(q);
        (-2.0 * q.ln()).sqrt() / (INVERSE_FLANK.base + ratio)
    } else {
        let x = (-q.ln()).sqrt();
        let piece = INVERSE_TAIL.iter().find(|piece| x < piece.until);
        piece.map_or(f64::NAN, |piece| piece.scaled(x, x))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Computed with mpmath 1.3, 40 digits.
    #[test]
    fn erfc_equals_published_values() {
        for (x, exact) in [
            (-6.0, 2.0),
            (-2.5, 1.999593047982555),
            (-0.5, 1.5204998778130465),
            (-0.1, 1.1124629160182848),
            (0.0, 1.0),
            (1e-11, 0.9999999999887162),
            (0.25, 0.7236736098317631),
            (0.49, 0.4883317388114769),
            (0.6, 0.3961439091520741),
            (1.0, 0.15729920705028513),
            (1.5, 0.033894853524689274),
            (2.3, 0.0011431765973566525),
            (3.0, 2.209049699858544e-05),
            (4.5, 1.9661604415428876e-10),
            (6.5, 3.8421483271206475e-20),
            (10.0, 2.088487583762545e-45),
            (14.0, 3.0372298477503115e-87),
            (20.0, 5.395865611607901e-176),
            (26.0, 5.663192408856143e-296),
        ] {
            assert!((erfc(x) / exact - 1.0).abs() < 1e-10, "{x}: {} {exact}", erfc(x));
        }
        assert_eq!([f64::NEG_INFINITY, f64::INFINITY, 40.0].map(erfc), [2.0, 0.0, 0.0]);
        assert!(erfc(f64::NAN).is_nan());
    }

    /// Computed with mpmath 1.3, 40 digits: roots of its erfc.
    #[test]
    fn erfc_inv_equals_published_values() {
        for (q, exact) in [
            (1e-300, 26.209469960516124),
            (1e-150, 18.490448550008626),
            (1e-100, 15.065574702592645),
            (1e-30, 8.148616223169865),
            (1e-16, 5.8723700904539635),
            (1e-10, 4.572824967389486),
            (0.001, 2.3267537655135246),
            (0.1, 1.163087153676674),
            (0.2499, 0.8135916215750183),
            (0.3, 0.7328690779592169),
            (0.4999, 0.4770475405909757),
            (0.5, 0.4769362762044699),
            (0.9, 0.08885599049425767),
            (1.0, 0.0),
            (1.3, -0.2724627147267544),
            (1.9, -1.1630871536766738),
            (1.9999, -2.75106390571208),
        ] {
            assert!((erfc_inv(q) - exact).abs() <= 1e-14 * exact.abs(), "{q}: {} {exact}", erfc_inv(q));
        }
        assert_eq!([-1.0, 0.0, 2.0].map(erfc_inv), [f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY]);
        assert!(erfc_inv(f64::from_bits(1)).is_finite() && erfc_inv(f64::NAN).is_nan());
    }

    /// Across all boundaries of the pieces, erfc_inv inverts erfc, and erfc decreases monotonically.
    #[test]
    fn erfc_inv_inverts_erfc_across_pieces() {
        let mut last = f64::INFINITY;
        for i in -240..2600 {
            let x = f64::from(i) / 100.0;
            let (q, back) = (erfc(x), erfc_inv(erfc(x)));
            // Near 2, erfc has lost digits of x.
            let allowed = if x < 0.0 { 1e-9 + 1e-15 * (x * x).exp() } else { 1e-9 };
            assert!((back - x).abs() < allowed, "{x}: {back}");
            assert!(q < last, "{x}");
            last = q;
        }
    }
}
