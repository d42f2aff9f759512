//! Several wavelengths at once: arrays of numbers with the usual operators, which the compiler turns into SIMD.
//!
//! What is used within [`with_widest_simd`] is `inline(always)`: it is compiled for each instruction set at each place. What is large has an own
//! such block.

use std::ops::{Add, Mul, Neg, Sub};

use crate::with_widest_simd;

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
    /// Returns the sum of another element and i times this one.
    fn times_i(self, sum: Self) -> Complex;
    /// Returns at least the absolute value.
    fn size(self) -> Real;
}

impl Real {
    #[inline(always)]
    pub(super) fn splat(value: f64) -> Self {
        Self([value; LANES])
    }

    #[inline(always)]
    pub(super) fn root(mut self) -> Self {
        for value in &mut self.0 {
            *value = value.sqrt();
        }
        self
    }

    #[inline(always)]
    pub(super) fn at_least(mut self, least: f64) -> Self {
        for value in &mut self.0 {
            *value = value.max(least);
        }
        self
    }

    #[inline(always)]
    pub(super) fn larger(mut self, other: Self) -> Self {
        for k in 0..LANES {
            self.0[k] = if self.0[k] > other.0[k] { self.0[k] } else { other.0[k] };
        }
        self
    }

    #[inline(always)]
    pub(super) fn max(self) -> f64 {
        let mut most = 0.0;
        for value in self.0 {
            most = f64::max(most, value);
        }
        most
    }
}

impl Add for Real {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let mut out = self;
        for k in 0..LANES {
            out.0[k] += other.0[k];
        }
        out
    }
}

impl Sub for Real {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        let mut out = self;
        for k in 0..LANES {
            out.0[k] -= other.0[k];
        }
        out
    }
}

impl Mul for Real {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let mut out = self;
        for k in 0..LANES {
            out.0[k] *= other.0[k];
        }
        out
    }
}

impl Neg for Real {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        let mut out = self;
        for value in &mut out.0 {
            *value = -*value;
        }
        out
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
        let mut out = self;
        for value in &mut out.0 {
            *value = 1.0 / *value;
        }
        out
    }
    #[inline(always)]
    fn times(self, other: Complex, sum: Complex) -> Complex {
        Complex { re: self * other.re + sum.re, im: self * other.im + sum.im }
    }
    #[inline(always)]
    fn times_i(self, sum: Self) -> Complex {
        Complex { re: sum, im: self }
    }
    #[inline(always)]
    fn size(mut self) -> Real {
        for value in &mut self.0 {
            *value = value.abs();
        }
        self
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
        self.re * self.re + self.im * self.im
    }

    /// Returns exp(i z).
    pub(super) fn wave(self) -> Self {
        let mut out = self;
        for k in 0..LANES {
            let (sin, cos) = self.re.0[k].sin_cos();
            let size = (-self.im.0[k]).exp();
            (out.re.0[k], out.im.0[k]) = (size * cos, size * sin);
        }
        out
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
        let scale = self.norm_sqr().inverse();
        Self { re: self.re * scale, im: -(self.im * scale) }
    }
    #[inline(always)]
    fn times(self, other: Complex, sum: Complex) -> Complex {
        Complex {
            re: self.re * other.re - self.im * other.im + sum.re,
            im: self.re * other.im + self.im * other.re + sum.im,
        }
    }
    #[inline(always)]
    fn times_i(self, sum: Self) -> Complex {
        Complex { re: sum.re - self.im, im: sum.im + self.re }
    }
    #[inline(always)]
    fn size(self) -> Real {
        self.re.size() + self.im.size()
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

impl Neg for Pair {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        let [[a, b], [c, d]] = self.0;
        Self([[-a, -b], [-c, -d]])
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
    /// Returns those of no layer.
    pub(super) fn nothing() -> Self {
        let none = Pair::diagonal(Complex::zero(), Complex::zero());
        Self { r: none, t: Pair::one(), r_below: none, t_up: Pair::one() }
    }

    /// Returns both parts together, `below` being below this one.
    pub(super) fn over(&self, below: &Self) -> Self {
        with_widest_simd(
            #[inline(always)]
            || {
                let between = (Pair::one() - self.r_below * below.r).inverse();
                let down = between * self.t;
                let up = (Pair::one() - below.r * self.r_below).inverse() * below.t_up;
                Self {
                    r: self.r + self.t_up * (below.r * down),
                    t: below.t * down,
                    r_below: below.r_below + below.t * (self.r_below * up),
                    t_up: self.t_up * up,
                }
            },
        )
    }

    /// Returns the reflection of this part over one that reflects.
    #[inline(always)]
    pub(super) fn over_reflection(&self, below: Pair) -> Pair {
        let down = (Pair::one() - self.r_below * below).inverse() * self.t;
        self.r + self.t_up * (below * down)
    }
}
