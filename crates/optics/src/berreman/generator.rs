//! Berreman's matrix of a homogeneous slice, and its exponential.
//!
//! By the theorem of Cayley and Hamilton every power of the matrix is a polynomial of third degree in it. The Taylor series of the
//! exponential therefore acts on four coefficients, real where nothing absorbs, and a thick layer is the square of a thinner one in these
//! coefficients. No eigenvalue is needed, so that isotropic layers and light along an optic axis are ordinary cases.

use super::lanes::{Blocks, Complex, Element, Pair, Real};

/// Largest norm of a step of the Taylor series, and of that of a layer that is doubled.
const STEP: f64 = 2.0;
const THIN: f64 = 0.5;

/// Error of the Taylor series of a step, and of that of a layer that is doubled.
const SERIES: f64 = 1e-12;
const THIN_SERIES: f64 = 1e-16;

/// Largest exponent by which waves may grow before they become a reflection matrix again.
const GROWTH: f64 = 2.0;

/// Berreman's matrix relative to the reference, whose elements are these: rows
/// `(along, electric, across, 0)`, `(magnetic, along, mixed, 0)`, `(0, 0, 0, s)`, `(mixed, across, other, 0)`.
#[derive(Clone, Copy)]
pub(super) struct Generator<T> {
    pub(super) along: T,
    pub(super) across: T,
    pub(super) mixed: T,
    pub(super) electric: T,
    pub(super) magnetic: T,
    pub(super) other: T,
    pub(super) s: Real,
}

/// Polynomial of third degree in a matrix, from the constant term on.
type Cubic = [Complex; 4];

/// Fields of two independent waves: p of H and E, s of E and H, relative to the reference.
pub(super) type Columns = [[Complex; 4]; 2];

impl<T: Element> Generator<T> {
    /// Returns the product with a field, plus another field.
    #[inline(always)]
    pub(super) fn times(&self, field: [Complex; 4], sum: [Complex; 4]) -> [Complex; 4] {
        let [a, b, c, d] = field;
        [
            self.across.times(c, self.electric.times(b, self.along.times(a, sum[0]))),
            self.mixed.times(c, self.along.times(b, self.magnetic.times(a, sum[1]))),
            self.s.times(d, sum[2]),
            self.other.times(c, self.across.times(b, self.mixed.times(a, sum[3]))),
        ]
    }

    /// Returns the matrix times a factor.
    #[inline(always)]
    pub(super) fn scaled(&self, factor: Real) -> Self {
        let Self { along, across, mixed, electric, magnetic, other, s } = *self;
        Self {
            along: along.scaled(factor),
            across: across.scaled(factor),
            mixed: mixed.scaled(factor),
            electric: electric.scaled(factor),
            magnetic: magnetic.scaled(factor),
            other: other.scaled(factor),
            s: s * factor,
        }
    }

    /// Returns a bound of the norm.
    #[inline(always)]
    fn norm(&self) -> f64 {
        let [along, across, mixed] = [self.along.size(), self.across.size(), self.mixed.size()];
        let first = along + across + self.electric.size();
        let second = along + mixed + self.magnetic.size();
        let last = mixed + across + self.other.size();
        first.larger(second).larger(last).larger(self.s).max()
    }

    /// Returns the characteristic polynomial: the fourth power of the matrix as a polynomial of third degree in it.
    #[inline(always)]
    pub(super) fn characteristic(&self) -> [T; 4] {
        let Self { along: a, across: c, mixed: x, electric: e, magnetic: m, other: o, s } = *self;
        let minor = a * a - e * m;
        let (twice, both) = (a + a, x * c);
        [
            (o * minor + e * (x * x) + m * (c * c) - twice * both).scaled(s),
            (both - a * o).scaled(s + s),
            o.scaled(s) - minor,
            twice,
        ]
    }

    /// Returns the exponential of `-i` (upwards) or `i` times the matrix by terms of the Taylor series up to an odd power.
    #[inline(always)]
    fn exponential(&self, power: [T; 4], terms: usize, up: bool) -> Cubic {
        let value = |value: f64| T::real(Real::splat(value));
        let zero = value(0.0);
        // Even powers and odd powers over i.
        let mut even = [value(1.0), zero, value(-0.5), zero];
        let mut odd = [zero, value(1.0), zero, value(-1.0 / 6.0)];
        let mut next = power;
        let mut factor = 1.0 / 24.0;
        for term in (4..=terms).step_by(2) {
            for (more, sum) in [(1, &mut even), (2, &mut odd)] {
                let scale = Real::splat(factor);
                for k in 0..4 {
                    sum[k] = sum[k] + next[k].scaled(scale);
                }
                let last = next[3];
                next = [
                    last * power[0],
                    next[0] + last * power[1],
                    next[1] + last * power[2],
                    next[2] + last * power[3],
                ];
                factor /= (term + more) as f64;
            }
            factor = -factor;
        }
        let sign = Real::splat(if up { -1.0 } else { 1.0 });
        let term = |k: usize| odd[k].scaled(sign).times_i(even[k]);
        [term(0), term(1), term(2), term(3)]
    }

    /// Returns a polynomial in the matrix times a field.
    #[inline(always)]
    fn polynomial(&self, cubic: &Cubic, field: [Complex; 4]) -> [Complex; 4] {
        let mut sum = scaled(cubic[3], field);
        for k in [2, 1, 0] {
            sum = self.times(sum, scaled(cubic[k], field));
        }
        sum
    }
}

// Methods of arrays that call closures are not compiled for the instruction set of their caller.
#[inline(always)]
fn scaled(factor: Complex, [a, b, c, d]: [Complex; 4]) -> [Complex; 4] {
    [factor * a, factor * b, factor * c, factor * d]
}

/// Returns the square of a polynomial in the matrix of this characteristic polynomial.
#[inline(always)]
fn squared<T: Element>([a, b, c, d]: Cubic, power: &[T; 4]) -> Cubic {
    let twice = |x: Complex, y: Complex| (x + x) * y;
    let mut all = [
        a * a,
        twice(a, b),
        twice(a, c) + b * b,
        twice(a, d) + twice(b, c),
        twice(b, d) + c * c,
        twice(c, d),
        d * d,
    ];
    for degree in [6, 5, 4] {
        let high = all[degree];
        for k in 0..4 {
            all[degree - 4 + k] = power[k].times(high, all[degree - 4 + k]);
        }
    }
    [all[0], all[1], all[2], all[3]]
}

/// Returns the number of terms of the Taylor series of the exponential of a matrix of this norm: an odd power, 3 or more.
#[inline(always)]
fn terms(norm: f64, error: f64) -> usize {
    let (mut size, mut count) = (1.0, 0);
    while size > error && count < 40 {
        count += 1;
        size *= norm / count as f64;
    }
    (count | 1).max(3)
}

/// Waves above some layers, of which a reflection matrix is known below.
pub(super) struct Rising {
    columns: Columns,
    /// Exponent by which they may have grown.
    growth: f64,
    /// Largest norm so far, and the terms of the Taylor series for it.
    norm: f64,
    terms: usize,
}

impl Rising {
    #[inline(always)]
    pub(super) fn new(r: Pair) -> Self {
        let [[pp, ps], [sp, ss]] = r.0;
        let one = Complex::splat(1.0);
        let columns = [[one - pp, one + pp, sp, -sp], [-ps, ps, one + ss, one - ss]];
        Self { columns, growth: 0.0, norm: 0.0, terms: 3 }
    }

    #[inline(always)]
    pub(super) fn reflection(&self) -> Pair {
        let [p, s] = self.columns;
        // Twice the waves down and up.
        let down = Pair([[p[0] + p[1], s[0] + s[1]], [p[2] + p[3], s[2] + s[3]]]);
        let up = Pair([[p[1] - p[0], s[1] - s[0]], [p[2] - p[3], s[2] - s[3]]]);
        up * down.inverse()
    }

    /// Takes the waves up through a slice of k0 d = `depth`, in which they grow by this exponent at most.
    #[inline(always)]
    pub(super) fn raise<T: Element>(&mut self, generator: &Generator<T>, depth: Real, growth: f64) {
        let whole = generator.scaled(depth);
        let norm = whole.norm();
        let steps = (norm / STEP).ceil().max(1.0);
        let step = if steps > 1.0 { whole.scaled(Real::splat(1.0 / steps)) } else { whole };
        let power = step.characteristic();
        if norm / steps > self.norm {
            self.norm = norm / steps;
            self.terms = terms(self.norm, SERIES);
        }
        let cubic = step.exponential(power, self.terms, true);
        for _ in 0..steps as usize {
            self.growth += growth / steps;
            if self.growth > GROWTH {
                self.columns = Self::new(self.reflection()).columns;
                self.growth = growth / steps;
            }
            for column in &mut self.columns {
                *column = step.polynomial(&cubic, *column);
            }
        }
    }
}

/// Returns the scattering matrix of a layer of k0 d = `depth`, in which waves grow by this exponent at most, or of a part of it that is to be doubled
/// as often as said.
#[inline(always)]
pub(super) fn layer<T: Element>(generator: &Generator<T>, depth: Real, growth: f64) -> (Blocks, usize) {
    let whole = generator.scaled(depth);
    let doublings = (whole.norm() / THIN).log2().ceil().max(0.0);
    // As scattering matrices where waves grow, as polynomials before.
    let grown = (growth / GROWTH).log2().ceil().clamp(0.0, doublings);
    let thin = whole.scaled(Real::splat((-doublings).exp2()));
    let power = thin.characteristic();
    let mut cubic = thin.exponential(power, terms(thin.norm(), THIN_SERIES), false);
    for _ in 0..(doublings - grown) as usize {
        cubic = squared(cubic, &power);
    }
    let (zero, half) = (Complex::zero(), Complex::splat(0.5));
    // Columns of the transfer matrix downwards, between waves: p and s down, p and s up.
    let mut columns = [
        [half, half, zero, zero],
        [zero, zero, half, half],
        [-half, half, zero, zero],
        [zero, zero, half, -half],
    ];
    for column in &mut columns {
        let [a, b, c, d] = thin.polynomial(&cubic, *column);
        *column = [a + b, c + d, b - a, c - d];
    }
    let [p, s, p_up, s_up] = columns;
    let down = Pair([[p[0], s[0]], [p[1], s[1]]]);
    let from_down = Pair([[p[2], s[2]], [p[3], s[3]]]);
    let from_up = Pair([[p_up[0], s_up[0]], [p_up[1], s_up[1]]]);
    let t_up = Pair([[p_up[2], s_up[2]], [p_up[3], s_up[3]]]).inverse();
    let none = Pair::diagonal(zero, zero);
    let r = none - t_up * from_down;
    (Blocks { r, t: down + from_up * r, r_below: from_up * t_up, t_up }, grown as usize)
}
