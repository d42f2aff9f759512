//! Several wavelengths at once: a SIMD register, and a pair of them as complex numbers,
//! with the usual operators.
//!
//! The `pulp` crate selects the best instruction set at run time. Everything here is `inline(always)`, since
//! only then is the code compiled for that instruction set, as part of the calling function.

use std::ops::{Add, Mul, Neg, Sub};

use pulp::{Arch, Simd, WithSimd};

use crate::clear_wide_registers;

/// An instruction set of this machine.
#[derive(Clone, Copy)]
pub struct SimdLevel {
    name: &'static str,
    arch: Arch,
}

impl SimdLevel {
    /// Returns the best one.
    pub fn best() -> Self {
        let levels = Self::available();
        levels[levels.len() - 1]
    }

    /// Returns plain scalar code.
    pub fn portable() -> Self {
        Self { name: "portable", arch: Arch::Scalar }
    }

    /// Returns all that this machine supports, slowest first; the first is [`portable`](Self::portable).
    pub fn available() -> Vec<Self> {
        let mut levels = vec![Self::portable()];
        #[cfg(target_arch = "x86_64")]
        {
            let avx2 = pulp::x86::V3::try_new().map(Arch::V3);
            levels.extend(avx2.map(|arch| Self { name: "AVX2", arch }));
            let avx512 = pulp::x86::V4::try_new().map(Arch::V4);
            levels.extend(avx512.map(|arch| Self { name: "AVX-512", arch }));
        }
        #[cfg(not(target_arch = "x86_64"))]
        levels.push(Self { name: "native", arch: Arch::new() });
        levels
    }

    /// `portable`, `AVX2`, `AVX-512` or `native`.
    pub fn name(self) -> &'static str {
        self.name
    }

    pub(super) fn dispatch<W: WithSimd>(self, work: W) -> W::Output {
        let result = self.arch.dispatch(work);
        clear_wide_registers();
        result
    }
}

impl std::fmt::Debug for SimdLevel {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name)
    }
}

/// A register of f64.
#[derive(Clone, Copy)]
pub(super) struct Lanes<S: Simd> {
    simd: S,
    x: S::f64s,
}

impl<S: Simd> Lanes<S> {
    /// The same number in every lane.
    #[inline(always)]
    pub(super) fn new(simd: S, value: f64) -> Self {
        Self { simd, x: simd.splat_f64s(value) }
    }

    /// Loads as many numbers as there are lanes; missing ones are zero.
    #[inline(always)]
    pub(super) fn load(simd: S, values: &[f64]) -> Self {
        Self { simd, x: simd.partial_load_f64s(values) }
    }

    /// Stores into `out`, which may be shorter than the register.
    #[inline(always)]
    pub(super) fn store(self, out: &mut [f64]) {
        match S::as_mut_simd_f64s(out) {
            ([first, ..], _) => *first = self.x,
            (_, tail) => self.simd.partial_store_f64s(tail, self.x),
        }
    }

    #[inline(always)]
    pub(super) fn splat(self, value: f64) -> Self {
        Self::new(self.simd, value)
    }

    #[inline(always)]
    fn with(self, x: S::f64s) -> Self {
        Self { simd: self.simd, x }
    }

    /// self * a + b, fused where the machine can.
    #[inline(always)]
    pub(super) fn mul_add(self, a: Self, b: Self) -> Self {
        self.with(self.simd.mul_add_e_f64s(self.x, a.x, b.x))
    }

    /// b - self * a, fused where the machine can.
    #[inline(always)]
    pub(super) fn neg_mul_add(self, a: Self, b: Self) -> Self {
        self.with(self.simd.negate_mul_add_e_f64s(self.x, a.x, b.x))
    }

    #[inline(always)]
    pub(super) fn div(self, other: Self) -> Self {
        self.with(self.simd.div_f64s(self.x, other.x))
    }

    #[inline(always)]
    pub(super) fn recip(self) -> Self {
        self.splat(1.0).div(self)
    }

    #[inline(always)]
    pub(super) fn sqrt(self) -> Self {
        self.with(self.simd.sqrt_f64s(self.x))
    }

    #[inline(always)]
    pub(super) fn abs(self) -> Self {
        // `Simd::abs_f64s` is a call of a function unless everything is optimised.
        self.max(-self)
    }

    #[inline(always)]
    pub(super) fn min(self, other: Self) -> Self {
        self.with(self.simd.min_f64s(self.x, other.x))
    }

    #[inline(always)]
    pub(super) fn max(self, other: Self) -> Self {
        self.with(self.simd.max_f64s(self.x, other.x))
    }

    /// Lane by lane: `yes` where self > 0, else `no`.
    #[inline(always)]
    pub(super) fn if_positive(self, yes: Self, no: Self) -> Self {
        let positive = self.simd.greater_than_f64s(self.x, self.splat(0.0).x);
        self.with(self.simd.select_f64s(positive, yes.x, no.x))
    }

    /// Horner's rule, lowest power first.
    #[inline(always)]
    pub(super) fn polynomial<const N: usize>(self, coefficients: &[f64; N]) -> Self {
        let mut sum = self.splat(coefficients[N - 1]);
        for &c in coefficients.iter().rev().skip(1) {
            sum = sum.mul_add(self, self.splat(c));
        }
        sum
    }
}

impl<S: Simd> Add for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.with(self.simd.add_f64s(self.x, other.x))
    }
}

impl<S: Simd> Sub for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.with(self.simd.sub_f64s(self.x, other.x))
    }
}

impl<S: Simd> Mul for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.with(self.simd.mul_f64s(self.x, other.x))
    }
}

impl<S: Simd> Neg for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.with(self.simd.neg_f64s(self.x))
    }
}

/// A register of complex numbers, with separate registers for the two parts.
#[derive(Clone, Copy)]
pub(super) struct Complex<S: Simd> {
    pub(super) re: Lanes<S>,
    pub(super) im: Lanes<S>,
}

impl<S: Simd> Complex<S> {
    #[inline(always)]
    pub(super) fn new(re: Lanes<S>, im: Lanes<S>) -> Self {
        Self { re, im }
    }

    #[inline(always)]
    pub(super) fn real(re: Lanes<S>) -> Self {
        Self { re, im: re.splat(0.0) }
    }

    #[inline(always)]
    pub(super) fn scale(self, factor: Lanes<S>) -> Self {
        Self { re: self.re * factor, im: self.im * factor }
    }

    /// self * factor + b.
    #[inline(always)]
    pub(super) fn scale_add(self, factor: Lanes<S>, b: Self) -> Self {
        Self { re: self.re.mul_add(factor, b.re), im: self.im.mul_add(factor, b.im) }
    }

    /// self * a + b.
    #[inline(always)]
    pub(super) fn mul_add(self, a: Self, b: Self) -> Self {
        let re = self.re.mul_add(a.re, self.im.neg_mul_add(a.im, b.re));
        let im = self.re.mul_add(a.im, self.im.mul_add(a.re, b.im));
        Self { re, im }
    }

    #[inline(always)]
    pub(super) fn minus_i(self) -> Self {
        Self { re: self.im, im: -self.re }
    }

    #[inline(always)]
    pub(super) fn conj(self) -> Self {
        Self { re: self.re, im: -self.im }
    }

    /// Lane by lane: `yes` where the condition is > 0, else `no`.
    #[inline(always)]
    pub(super) fn if_positive(condition: Lanes<S>, yes: Self, no: Self) -> Self {
        Self { re: condition.if_positive(yes.re, no.re), im: condition.if_positive(yes.im, no.im) }
    }

    /// Between |z| and sqrt(2) |z|.
    #[inline(always)]
    pub(super) fn size(self) -> Lanes<S> {
        self.re.abs() + self.im.abs()
    }

    #[inline(always)]
    pub(super) fn norm_sqr(self) -> Lanes<S> {
        self.re.mul_add(self.re, self.im * self.im)
    }

    #[inline(always)]
    pub(super) fn recip(self) -> Self {
        let r = self.norm_sqr().recip();
        Self { re: self.re * r, im: -(self.im * r) }
    }

    /// A polynomial of real coefficients, lowest power first: Horner's rule with the quadratic factor
    /// of z and its conjugate (D. E. Knuth, "The Art of Computer Programming", section 4.6.4).
    #[inline(always)]
    pub(super) fn polynomial<const N: usize>(self, coefficients: &[f64; N]) -> Self {
        let (twice, norm) = (self.re + self.re, self.norm_sqr());
        let mut sums = [norm.splat(coefficients[N - 1]), norm.splat(0.0)];
        for &c in coefficients[1..N - 1].iter().rev() {
            sums = [sums[0].mul_add(twice, sums[1].neg_mul_add(norm, norm.splat(c))), sums[0]];
        }
        let rest = sums[1].neg_mul_add(norm, norm.splat(coefficients[0]));
        Self { re: sums[0].mul_add(self.re, rest), im: sums[0] * self.im }
    }

    /// Returns the square root with both parts >= 0 of a number with Im >= 0, accurate in both parts.
    #[inline(always)]
    pub(super) fn sqrt(self) -> Self {
        let half = self.re.splat(0.5);
        let large = ((self.norm_sqr().sqrt() + self.re.abs()) * half).sqrt();
        let small = (self.im * half).div(large);
        Self { re: self.re.if_positive(large, small), im: self.re.if_positive(small, large) }
    }
}

impl<S: Simd> Add for Complex<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { re: self.re + other.re, im: self.im + other.im }
    }
}

impl<S: Simd> Sub for Complex<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { re: self.re - other.re, im: self.im - other.im }
    }
}

impl<S: Simd> Mul for Complex<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self {
            re: self.re.mul_add(other.re, -(self.im * other.im)),
            im: self.re.mul_add(other.im, self.im * other.re),
        }
    }
}
