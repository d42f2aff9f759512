//! Several wavelengths at once: arrays of numbers with the usual operators, which the compiler turns into SIMD.
//!
//! Everything is `inline(always)`: see [`with_widest_simd`](crate::with_widest_simd).

use std::ops::{Add, Mul, Neg, Sub};

/// Number of wavelengths that are computed together.
pub(super) const LANES: usize = 8;

/// Real numbers.
#[derive(Debug, Clone, Copy)]
pub(super) struct Real(pub(super) [f64; LANES]);

/// Complex numbers.
#[derive(Debug, Clone, Copy)]
pub(super) struct Complex {
    pub(super) re: Real,
    pub(super) im: Real,
}

/// Elements of a Berreman matrix: real where nothing absorbs, which takes half of the time.
pub(super) trait Element: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> {
    fn real(value: Real) -> Self;
    fn scaled(self, factor: Real) -> Self;
    fn inverse(self) -> Self;
    /// Returns sum + self * other.
    fn times(self, other: Complex, sum: Complex) -> Complex;
    /// Returns at least the largest absolute value.
    fn size(self) -> f64;
}

impl Real {
    #[inline(always)]
    pub(super) fn splat(value: f64) -> Self {
        Self([value; LANES])
    }

    #[inline(always)]
    pub(super) fn map(self, f: impl Fn(f64) -> f64) -> Self {
        Self(self.0.map(f))
    }

    #[inline(always)]
    fn with(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        Self(std::array::from_fn(|k| f(self.0[k], other.0[k])))
    }

    /// Returns self * a + b.
    #[inline(always)]
    pub(super) fn mul_add(self, a: Self, b: Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k].mul_add(a.0[k], b.0[k])))
    }

    #[inline(always)]
    pub(super) fn max(self) -> f64 {
        self.0.into_iter().fold(0.0, f64::max)
    }
}

impl Add for Real {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.with(other, |a, b| a + b)
    }
}

impl Sub for Real {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.with(other, |a, b| a - b)
    }
}

impl Mul for Real {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.with(other, |a, b| a * b)
    }
}

impl Neg for Real {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.map(|a| -a)
    }
}

impl Element for Real {
    #[inline(always)]
    fn real(value: Real) -> Self {
        value
    }
    #[inline(always)]
    fn scaled(self, factor: Real) -> Self {
        self * factor
    }
    #[inline(always)]
    fn inverse(self) -> Self {
        self.map(|a| 1.0 / a)
    }
    #[inline(always)]
    fn times(self, other: Complex, sum: Complex) -> Complex {
        Complex { re: self.mul_add(other.re, sum.re), im: self.mul_add(other.im, sum.im) }
    }
    #[inline(always)]
    fn size(self) -> f64 {
        self.map(f64::abs).max()
    }
}

impl Complex {
    #[inline(always)]
    pub(super) fn splat(value: f64) -> Self {
        Real::splat(value).into()
    }

    #[inline(always)]
    pub(super) fn zero() -> Self {
        Self::splat(0.0)
    }

    #[inline(always)]
    pub(super) fn norm_sqr(self) -> Real {
        self.re.mul_add(self.re, self.im * self.im)
    }

    /// Returns -i times it.
    #[inline(always)]
    pub(super) fn minus_i(self) -> Self {
        Self { re: self.im, im: -self.re }
    }
}

impl From<Real> for Complex {
    #[inline(always)]
    fn from(re: Real) -> Self {
        Self { re, im: Real::splat(0.0) }
    }
}

impl Add for Complex {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { re: self.re + other.re, im: self.im + other.im }
    }
}

impl Sub for Complex {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { re: self.re - other.re, im: self.im - other.im }
    }
}

impl Mul for Complex {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.times(other, Self::zero())
    }
}

impl Neg for Complex {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self { re: -self.re, im: -self.im }
    }
}

impl Element for Complex {
    #[inline(always)]
    fn real(value: Real) -> Self {
        value.into()
    }
    #[inline(always)]
    fn scaled(self, factor: Real) -> Self {
        Self { re: self.re * factor, im: self.im * factor }
    }
    #[inline(always)]
    fn inverse(self) -> Self {
        let scale = self.norm_sqr().map(|square| 1.0 / square);
        Self { re: self.re * scale, im: -(self.im * scale) }
    }
    #[inline(always)]
    fn times(self, other: Complex, sum: Complex) -> Complex {
        Complex {
            re: self.re.mul_add(other.re, (-self.im).mul_add(other.im, sum.re)),
            im: self.re.mul_add(other.im, self.im.mul_add(other.re, sum.im)),
        }
    }
    #[inline(always)]
    fn size(self) -> f64 {
        (self.re.map(f64::abs) + self.im.map(f64::abs)).max()
    }
}

/// 2x2 matrix, by rows.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pair(pub(super) [[Complex; 2]; 2]);

impl Pair {
    #[inline(always)]
    pub(super) fn diagonal(p: Complex, s: Complex) -> Self {
        let zero = Complex::zero();
        Self([[p, zero], [zero, s]])
    }

    #[inline(always)]
    pub(super) fn one() -> Self {
        Self::diagonal(Complex::splat(1.0), Complex::splat(1.0))
    }

    #[inline(always)]
    pub(super) fn inverse(self) -> Self {
        let [[a, b], [c, d]] = self.0;
        let scale = (a * d - b * c).inverse();
        Self([[d * scale, -(b * scale)], [-(c * scale), a * scale]])
    }
}

impl Mul for Pair {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let ([[a, b], [c, d]], [[e, f], [g, h]]) = (self.0, other.0);
        Self([[b.times(g, a * e), b.times(h, a * f)], [d.times(g, c * e), d.times(h, c * f)]])
    }
}

impl Add for Pair {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let ([a, b], [c, d]) = (self.0, other.0);
        Self([[a[0] + c[0], a[1] + c[1]], [b[0] + d[0], b[1] + d[1]]])
    }
}

impl Sub for Pair {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        let ([a, b], [c, d]) = (self.0, other.0);
        Self([[a[0] - c[0], a[1] - c[1]], [b[0] - d[0], b[1] - d[1]]])
    }
}

/// Scattering matrix of 2x2 blocks.
#[derive(Debug, Clone, Copy)]
pub(super) struct Blocks {
    pub(super) r: Pair,
    pub(super) t: Pair,
    pub(super) r_below: Pair,
    pub(super) t_up: Pair,
}

impl Blocks {
    /// Returns both parts together, `below` being below this one.
    #[inline(always)]
    pub(super) fn over(&self, below: &Self) -> Self {
        let between = (Pair::one() - self.r_below * below.r).inverse();
        let down = between * self.t;
        let up = (Pair::one() - below.r * self.r_below).inverse() * below.t_up;
        Self {
            r: self.r + self.t_up * (below.r * down),
            t: below.t * down,
            r_below: below.r_below + below.t * (self.r_below * up),
            t_up: self.t_up * up,
        }
    }

    /// Returns the reflection of this part over one that reflects.
    #[inline(always)]
    pub(super) fn over_reflection(&self, below: Pair) -> Pair {
        let down = (Pair::one() - self.r_below * below).inverse() * self.t;
        self.r + self.t_up * (below * down)
    }
}
