//! Sine and cosine, and hyperbolic sine and cosine, up to a common factor.
//!
//! A layer's matrix may be scaled at will where only ratios of fields matter. This makes its functions
//! cheap: no quadrants (half a turn flips both signs), no exponential, no division. Lambert's continued
//! fraction for the tangent, truncated at level m, is the diagonal Pade approximant of exp,
//! `exp(y) = p(y)/p(-y)`, `p(y) = sum_j c_j y^j`, `c_j = m! (2m - j)!/((2m)! j! (m - j)!)`,
//! so that with p(2ix) = A + iB, tan x = B/A. A and B are polynomials in x^2; at
//! m = 11 the error is 2e-17 at |x| = pi/2. With all signs positive the same
//! polynomials give the hyperbolic functions.
//!
//! For a thin layer, of |x| up to [`THIN`], A and B need no reduction of x. Since they contain only x^2,
//! they can be evaluated at a complex or negative one as well: no square root is needed. The common factor
//! is then complex. At m = 13 the error is 2e-17 at |x| = 2.4.
//!
//! Source: W. B. Jones, W. J. Thron, "Continued Fractions" (1980), section 6.1;
//! reduction by pi in three parts after W. J. Cody and W. Waite, "Software Manual for the
//! Elementary Functions" (1980).

use pulp::Simd;

use super::lanes::{Complex, Lanes};

/// Coefficients of A and of B, which has an additional factor x, in powers of x^2, at m = 11.
const EVEN: [f64; 6] = coefficients(0);
const ODD: [f64; 6] = coefficients(1);

/// Value of |x| up to which it need not be reduced.
pub(super) const THIN: f64 = 2.4;
/// Coefficients for these |x|, at m = 13.
const THIN_EVEN: [f64; 7] = coefficients(0);
const THIN_ODD: [f64; 7] = coefficients(1);

/// Every second coefficient of the approximant of level m = 2 N - 1.
const fn coefficients<const N: usize>(parity: usize) -> [f64; N] {
    let level = 2 * N - 1;
    let mut table = [0.0; N];
    let mut c = 1.0;
    let mut j = 0;
    while j <= level {
        if j % 2 == parity {
            table[j / 2] = c;
        }
        // c_{j+1} 2^{j+1} from c_j 2^j.
        c *= 2.0 * (level - j) as f64 / ((2 * level - j) as f64 * (j + 1) as f64);
        j += 1;
    }
    table
}

/// (cos x, sin x/x) of a real x^2 of either sign, both times a common factor.
#[inline(always)]
pub(super) fn thin_real<S: Simd>(x2: Lanes<S>) -> (Lanes<S>, Lanes<S>) {
    let minus_x2 = -x2;
    (minus_x2.polynomial(&THIN_EVEN), minus_x2.polynomial(&THIN_ODD))
}

/// (cos x, sin x/x) of a complex x^2, both times a common complex factor.
#[inline(always)]
pub(super) fn thin<S: Simd>(x2: Complex<S>) -> (Complex<S>, Complex<S>) {
    let minus_x2 = Complex::new(-x2.re, -x2.im);
    (minus_x2.polynomial(&THIN_EVEN), minus_x2.polynomial(&THIN_ODD))
}

/// (cos x, sin x), both times a common factor of size 1 to 1.07, of either sign.
///
/// Accurate to 1e-15 for |x| < 1e5; a larger x loses digits in proportion.
#[inline(always)]
pub(super) fn circular<S: Simd>(x: Lanes<S>) -> (Lanes<S>, Lanes<S>) {
    // Parts of pi with 33 bits each, so that a product with up to 20 bits is exact.
    const PI_1: f64 = 2.0 * 1.570_796_326_734_125_6;
    const PI_2: f64 = 2.0 * 6.077_100_506_303_966e-11;
    const PI_3: f64 = 2.0 * 2.022_266_248_795_950_6e-21;
    // Adding it rounds to an integer: the last bit of the sum has the value 1.
    const ROUND: f64 = 6_755_399_441_055_744.0;
    let turns = x.mul_add(x.splat(std::f64::consts::FRAC_1_PI), x.splat(ROUND)) - x.splat(ROUND);
    let x = turns.neg_mul_add(x.splat(PI_1), x);
    let x = turns.neg_mul_add(x.splat(PI_2), x);
    let x = turns.neg_mul_add(x.splat(PI_3), x);
    let minus_x2 = -(x * x);
    (minus_x2.polynomial(&EVEN), x * minus_x2.polynomial(&ODD))
}

/// (cosh x, sinh x) for x >= 0, both times a common factor that keeps them within (0, 1e11).
#[inline(always)]
pub(super) fn hyperbolic<S: Simd>(x: Lanes<S>) -> (Lanes<S>, Lanes<S>) {
    // tanh(20) is 1 within 1e-17. The approximant is used for a quarter of x, then two doublings, which
    // increase the accuracy: tanh saturates.
    let x = x.min(x.splat(20.0)) * x.splat(0.25);
    let x2 = x * x;
    let (c, s) = (x2.polynomial(&EVEN), x * x2.polynomial(&ODD));
    let (c, s) = (c.mul_add(c, s * s), (c + c) * s);
    (c.mul_add(c, s * s), (c + c) * s)
}

/// Value by which [`hyperbolic_and_factor`] replaces a larger x.
pub(super) const DEEPEST: f64 = 20.0;

/// As [`hyperbolic`], and the square of the common factor, within 1e-12 of itself.
#[inline(always)]
pub(super) fn hyperbolic_and_factor<S: Simd>(x: Lanes<S>) -> (Lanes<S>, Lanes<S>, Lanes<S>) {
    // The factor follows from cosh^2 - sinh^2 = 1. For an eighth of x, three doublings before cosh and sinh
    // become nearly equal.
    let x = x.min(x.splat(DEEPEST)) * x.splat(0.125);
    let x2 = x * x;
    let (mut c, mut s) = (x2.polynomial(&EVEN), x * x2.polynomial(&ODD));
    let mut factor = (c - s) * (c + s);
    for _ in 0..3 {
        (c, s) = (c.mul_add(c, s * s), (c + c) * s);
        factor = factor * factor;
    }
    (c, s, factor)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use num_complex::Complex64;
    use pulp::WithSimd;

    use super::super::lanes::SimdLevel;
    use super::*;

    /// Runs `f` on every x at one SIMD level.
    struct Map<'a, F> {
        x: &'a [f64],
        f: F,
    }

    trait Pair {
        fn of<S: Simd>(&self, x: Lanes<S>) -> (Lanes<S>, Lanes<S>);
    }
    struct Circular;
    struct Hyperbolic;
    impl Pair for Circular {
        #[inline(always)]
        fn of<S: Simd>(&self, x: Lanes<S>) -> (Lanes<S>, Lanes<S>) {
            circular(x)
        }
    }
    impl Pair for Hyperbolic {
        #[inline(always)]
        fn of<S: Simd>(&self, x: Lanes<S>) -> (Lanes<S>, Lanes<S>) {
            hyperbolic(x)
        }
    }

    impl<F: Pair> WithSimd for Map<'_, F> {
        type Output = Vec<(f64, f64)>;
        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
            let one = |&x: &f64| {
                let (mut c, mut s) = ([0.0], [0.0]);
                let pair = self.f.of(Lanes::new(simd, x));
                pair.0.store(&mut c);
                pair.1.store(&mut s);
                (c[0], s[0])
            };
            self.x.iter().map(one).collect()
        }
    }

    #[test]
    fn circular_is_a_sine_and_cosine_of_either_sign() {
        let mut x: Vec<f64> = (-4000..4000).map(|i| f64::from(i) * 0.01237).collect();
        x.extend([0.0, 1e-300, 1e-9, FRAC_PI_2, PI, 1e3, 12_345.678, -99_999.0]);
        for level in SimdLevel::available() {
            for (&x, (c, s)) in x.iter().zip(level.dispatch(Map { x: &x, f: Circular })) {
                let size = c.hypot(s);
                assert!((1.0 - 1e-15..1.07).contains(&size), "{level:?} at {x}: {size}");
                let factor = if c * x.cos() + s * x.sin() < 0.0 { -size } else { size };
                let error = (c / factor - x.cos()).abs().max((s / factor - x.sin()).abs());
                assert!(error < 1e-15, "{level:?} at {x}: {error:e}");
            }
        }
    }

    /// The tangent over x of thin layers, real part and imaginary part, of these complex x.
    struct Thin<'a>(&'a [Complex64]);

    impl WithSimd for Thin<'_> {
        type Output = Vec<[Complex64; 2]>;
        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
            let first = |lanes: Lanes<S>| {
                let mut out = [0.0];
                lanes.store(&mut out);
                out[0]
            };
            let one = |x: &Complex64| {
                let x2 = x * x;
                let (re, im) = (Lanes::new(simd, x2.re), Lanes::new(simd, x2.im));
                let (c, s) = thin(super::super::lanes::Complex::new(re, im));
                let (c, s) =
                    (Complex64::new(first(c.re), first(c.im)), Complex64::new(first(s.re), first(s.im)));
                let real = thin_real(re);
                [s / c, Complex64::from(first(real.1) / first(real.0))]
            };
            self.0.iter().map(one).collect()
        }
    }

    #[test]
    fn thin_layers_have_tangent_of_complex_angle() {
        let polar =
            |k: i32| Complex64::from_polar(THIN * f64::from(k % 50 + 1) / 50.0, 0.0123 * f64::from(k));
        let on_axes = [1.2, 2.4].map(|x| [Complex64::from(x), Complex64::new(0.0, x)]);
        let x: Vec<Complex64> = (0..500).map(polar).chain(on_axes.into_iter().flatten()).collect();
        for level in SimdLevel::available() {
            for (x, [complex, real]) in x.iter().zip(level.dispatch(Thin(&x))) {
                // Near its pole, at pi/2, the relative uncertainty of a tangent grows as its square.
                let truth = x.tan() / x;
                let bound = 3e-15 * (1.0 + truth.norm_sqr());
                assert!((complex - truth).norm() < bound, "{level:?} at {x}: {complex} for {truth}");
                if (x * x).im == 0.0 {
                    assert!((real - truth).norm() < bound, "{level:?} at {x}: {real} for {truth}");
                }
            }
        }
    }

    #[test]
    fn small_angles_keep_their_relative_accuracy() {
        let x = [1e-300, 1e-12, 1e-3];
        for level in SimdLevel::available() {
            for (&x, (c, s)) in x.iter().zip(level.dispatch(Map { x: &x, f: Circular })) {
                assert!((s / c / x.tan() - 1.0).abs() < 1e-15, "{level:?} at {x}");
            }
            for (&x, (c, s)) in x.iter().zip(level.dispatch(Map { x: &x, f: Hyperbolic })) {
                assert!((s / c / x.tanh() - 1.0).abs() < 1e-15, "{level:?} at {x}");
            }
        }
    }

    #[test]
    fn hyperbolic_has_hyperbolic_tangent() {
        let x: Vec<f64> = (0..6000).map(|i| f64::from(i) * 0.005).chain([700.0, 1e6, 1e300]).collect();
        for level in SimdLevel::available() {
            for (&x, (c, s)) in x.iter().zip(level.dispatch(Map { x: &x, f: Hyperbolic })) {
                let error = (s / c - x.tanh()).abs();
                assert!(error < 1e-15 && c < 1e11, "{level:?} at {x}: {error:e}, {c:e}");
            }
        }
    }
}
