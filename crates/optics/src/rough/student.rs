//! Slopes with a tail of any weight: Student's t-distribution in two dimensions.
//!
//! **Model.** Slopes r in units of alpha have the density `(1 + r^2/c^2)^-gamma/pi` with `c^2 = gamma - 1`.
//! For gamma = 2 this is GGX, for gamma to infinity Beckmann's Gaussian. Along one axis it is Student's
//! t-distribution with `2 gamma - 2` degrees of freedom.
//!
//! **Substitution.** With a slope `x = c sinh z` along one axis and `w = tanh z`, the fraction of slopes above
//! x is `J(w)/(2 J(0))`, `J(w)` being the integral of `(1 - t^2)^(a - 1)` from w to 1 and `a = gamma - 1`.
//! Smith's Lambda and the visible slopes follow from J in closed form. The slope across, given that along, is
//! of the same kind with `a + 1/2`, in units of `sqrt(c^2 + x^2)`.
//!
//! **Accuracy.** J over `(1 - w^2)^a` is a polynomial in `1/(1 + k w)`, within 1e-11 of its value for gamma up
//! to 100 and within 1e-9 for gamma up to 1000.
//!
//! Source: M. Ribardière, B. Bringier, D. Meneveaux, L. Simonot, "STD: Student's t-Distribution of Slopes for
//! Microfacet Based BSDFs", Comput. Graph. Forum 36 (2), 2017 (its eq. 22 for Lambda in another form).

use std::f64::consts::PI;

use super::invert;
use super::shadowing::beta_function;

/// Number of terms of the polynomial.
const TERMS: usize = 20;

/// Tables of the slopes of an interface.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct StudentSlopes {
    /// `gamma - 1`, the square of c.
    a: f64,
    along: Survival,
    beside: Survival,
}

/// Fraction of slopes along one axis above a slope.
#[derive(Debug, Clone, PartialEq)]
struct Survival {
    a: f64,
    /// `1/(2 J(0))`.
    norm: f64,
    /// k of the variable of the polynomial.
    k: f64,
    terms: [f64; TERMS],
}

impl StudentSlopes {
    pub(super) fn new(gamma: f64) -> Self {
        let a = gamma - 1.0;
        Self { a, along: Survival::new(a), beside: Survival::new(a + 0.5) }
    }

    /// As [`Distribution::hidden`](super::Distribution::hidden).
    pub(super) fn hidden(&self, alpha: f64, q: f64, beta_squared: f64) -> f64 {
        hidden(self.a, self.along.norm, [alpha, q, beta_squared], |w| self.along.ratio(w))
    }

    /// Samples a normal, of any length, among those of an interface of alpha 1 that are visible to light
    /// from `towards`, a unit vector, weighted by their projected areas.
    pub(super) fn visible(&self, towards: [f64; 3], [u, v]: [f64; 2]) -> [f64; 3] {
        let across = towards[0].hypot(towards[1]);
        let (cos, sin) = if across > 0.0 { (towards[0] / across, towards[1] / across) } else { (1.0, 0.0) };
        let c = self.a.sqrt();
        let z = self.visible_along(across, towards[2], v);
        let (along, beside) = (c * z.sinh(), c * z.cosh() * self.beside.at_fraction(u));
        [cos * along - sin * beside, sin * along + cos * beside, 1.0]
    }

    /// Returns z of the slope towards the light, weighted by `cos + slope sin` where that is positive, that a
    /// fraction u of the visible area exceeds.
    fn visible_along(&self, sin: f64, cos: f64, u: f64) -> f64 {
        let Self { a, along, .. } = self;
        let (c, far) = (a.sqrt(), along.far());
        let least = if sin > 0.0 { (-cos / (sin * c)).asinh().max(-far) } else { -far };
        let steeper = |z: f64| {
            let sech_squared = z.cosh().powi(-2);
            let facing = c * along.norm / (2.0 * a - 1.0) * sech_squared.powf(a - 0.5);
            cos * along.above(z) + sin * facing
        };
        let density = |z: f64| (cos + c * z.sinh() * sin) * along.norm * z.cosh().powf(-2.0 * a);
        invert([least, far], -u * steeper(least), |z| -steeper(z), density)
    }
}

impl Survival {
    fn new(a: f64) -> Self {
        let k = 0.5 * (a + 1.0).sqrt();
        let angle = |j: usize| PI * (j as f64 + 0.5) / TERMS as f64;
        let mut survival = Self { a, norm: 0.5 / half(a), k, terms: [0.0; TERMS] };
        let values: [f64; TERMS] =
            std::array::from_fn(|j| exact_ratio(a, survival.argument(angle(j).cos()).clamp(0.0, 1.0)));
        let term = |m: usize| {
            let sum: f64 =
                values.iter().enumerate().map(|(j, value)| value * (m as f64 * angle(j)).cos()).sum();
            sum * if m == 0 { 1.0 } else { 2.0 } / TERMS as f64
        };
        survival.terms = std::array::from_fn(term);
        survival
    }

    /// Returns w at an argument of the polynomial, -1 to 1.
    fn argument(&self, x: f64) -> f64 {
        let least = 1.0 / (1.0 + self.k);
        (1.0 / (least + 0.5 * (1.0 - least) * (1.0 + x)) - 1.0) / self.k
    }

    /// Returns `J(w)/(1 - w^2)^a`, w from 0 to 1.
    fn ratio(&self, w: f64) -> f64 {
        let least = 1.0 / (1.0 + self.k);
        let x = 2.0 * (1.0 / (1.0 + self.k * w) - least) / (1.0 - least) - 1.0;
        // Clenshaw's recurrence.
        let (mut last, mut before) = (0.0, 0.0);
        for term in self.terms[1..].iter().rev() {
            (last, before) = (2.0 * x * last - before + term, last);
        }
        x * last - before + self.terms[0]
    }

    /// Returns the fraction of slopes above `c sinh z`.
    fn above(&self, z: f64) -> f64 {
        let w = z.abs().tanh();
        let beyond = self.norm * z.cosh().powf(-2.0 * self.a) * self.ratio(w);
        if z < 0.0 { 1.0 - beyond } else { beyond }
    }

    /// Returns z beyond which the fraction is below 1e-16.
    fn far(&self) -> f64 {
        19.0 / self.a + 1.5
    }

    /// Returns the slope over c that a fraction u of the slopes exceeds.
    fn at_fraction(&self, u: f64) -> f64 {
        let (wanted, far) = (u.min(1.0 - u).max(1e-16), self.far());
        let density = |z: f64| self.norm * z.cosh().powf(-2.0 * self.a);
        let z = invert([0.0, far], -wanted, |z| -self.above(z), density);
        if u > 0.5 { -z.sinh() } else { z.sinh() }
    }
}

/// As [`Distribution::hidden`](super::Distribution::hidden) for this gamma, without tables.
pub(super) fn hidden_exactly(gamma: f64, of: [f64; 3]) -> f64 {
    let a = gamma - 1.0;
    hidden(a, 0.5 / half(a), of, |w| exact_ratio(a, w))
}

/// Returns `q Lambda` for `[alpha, q, |beta|^2]`.
fn hidden(a: f64, norm: f64, [alpha, q, beta_squared]: [f64; 3], ratio: impl Fn(f64) -> f64) -> f64 {
    let across = a * alpha * alpha * beta_squared;
    let length_squared = q * q + across;
    if across == 0.0 || length_squared == 0.0 {
        return 0.0;
    }
    let length = length_squared.sqrt();
    let w = (q / length).min(1.0);
    let tail = (across / length_squared).powf(a);
    (length * norm * tail * (1.0 / (2.0 * a - 1.0) - w * ratio(w))).max(0.0)
}

/// Returns the mean of the absolute slope along one axis, in units of alpha.
pub(super) fn mean_slope(gamma: f64) -> f64 {
    let a = gamma - 1.0;
    a.sqrt() / (half(a) * (2.0 * a - 1.0))
}

/// Returns `J(0) = B(a, 1/2)/2`.
fn half(a: f64) -> f64 {
    (a + 0.5) * beta_function(a - 1.0, 0.5)
}

/// Returns `J(w)/(1 - w^2)^a`, w from 0 to 1: by the series of the integral from 0 where w is small, elsewhere
/// by the continued fraction of the incomplete beta function.
fn exact_ratio(a: f64, w: f64) -> f64 {
    let squared = w * w;
    let rest = (1.0 - w) * (1.0 + w);
    if squared < 1.5 / (a + 2.5) {
        let (mut term, mut sum) = (1.0, 0.0);
        for k in 0..500 {
            let k = f64::from(k);
            sum += term / (2.0 * k + 1.0);
            term *= (k + 1.0 - a) / (k + 1.0) * squared;
            if term.abs() < 1e-17 {
                break;
            }
        }
        return (half(a) - w * sum) / rest.powf(a);
    }
    // Lentz's method; b = 1/2.
    let (mut c, mut d) = (1.0, 1.0 / (1.0 - (a + 0.5) * rest / (a + 1.0)));
    let mut fraction = d;
    for m in 1..300 {
        let m = f64::from(m);
        let even = m * (0.5 - m) * rest / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        d = 1.0 / (1.0 + even * d);
        c = 1.0 + even / c;
        fraction *= c * d;
        let odd = -(a + m) * (a + 0.5 + m) * rest / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        d = 1.0 / (1.0 + odd * d);
        c = 1.0 + odd / c;
        fraction *= c * d;
        if (c * d - 1.0).abs() < 1e-16 {
            break;
        }
    }
    0.5 * w / a * fraction
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rough::Distribution;

    /// The integral of J by the midpoint rule, in the angle `t = sin(angle)`.
    #[test]
    fn survival_equals_its_integral() {
        for gamma in [2.0, 2.3, 3.0, 7.5, 40.0, 100.0] {
            let a = gamma - 1.0;
            let survival = Survival::new(a);
            for w in [0.0, 0.02, 0.2, 0.5, 0.8, 0.97] {
                let (from, steps) = (f64::asin(w), 100_000);
                let step = (0.5 * PI - from) / f64::from(steps);
                let sum: f64 =
                    (0..steps).map(|k| (from + step * (f64::from(k) + 0.5)).cos().powf(2.0 * a - 1.0)).sum();
                let expected = sum * step / (1.0 - w * w).powf(a);
                for found in [survival.ratio(w), exact_ratio(a, w)] {
                    assert!((found / expected - 1.0).abs() < 2e-7, "{gamma} {w}: {found} {expected}");
                }
                assert!((survival.ratio(w) / exact_ratio(a, w) - 1.0).abs() < 1e-9, "{gamma} {w}");
            }
            assert!((survival.above(0.0) - 0.5).abs() < 1e-9);
        }
    }

    /// Fractions that slopes exceed, and back.
    #[test]
    fn fractions_and_slopes_are_inverse() {
        for a in [1.0, 1.7, 5.0, 60.0] {
            let survival = Survival::new(a);
            for u in [1e-9, 0.003, 0.3, 0.5, 0.9, 1.0 - 1e-6] {
                let z = survival.at_fraction(u).asinh();
                let found = survival.above(z);
                assert!((found - u).abs() < 1e-9 * u.min(1.0 - u) + 1e-15, "{a} {u}: {found}");
            }
        }
    }

    #[test]
    fn table_of_lambda_equals_exact_values() {
        for gamma in [2.0, 2.5, 4.0, 30.0, 1000.0] {
            let slopes = StudentSlopes::new(gamma);
            for (q, beta_squared) in [(1.0, 1e-6), (0.9, 0.19), (0.4, 0.84), (0.01, 0.9999), (0.0, 1.0)] {
                let exact = Distribution::StudentT { tail: gamma }.hidden(0.3, q, beta_squared);
                let found = slopes.hidden(0.3, q, beta_squared);
                assert!((found - exact).abs() <= 1e-6 * exact + 1e-15, "{gamma} {q}: {found} {exact}");
            }
        }
    }
}
