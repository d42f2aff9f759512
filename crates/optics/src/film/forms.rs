//! Quantities that the kernel propagates through the layers, in one polarisation: the amplitudes of the
//! incidence medium downwards, the fields of the substrate upwards.

use pulp::Simd;

use super::lanes::{Complex, Lanes};

/// Half of both quotients' sum, by one division.
#[inline(always)]
pub(super) fn mean<S: Simd>(s: [Lanes<S>; 2], p: [Lanes<S>; 2]) -> Lanes<S> {
    let numerator = s[0].mul_add(p[1], p[0] * s[1]);
    (numerator * numerator.splat(0.5)).div(s[1] * p[1])
}

/// What is computed: the mean of s and p, s alone, p alone.
pub(super) const MEAN: u8 = 0;
pub(super) const S_ALONE: u8 = 1;
pub(super) const P_ALONE: u8 = 2;

/// The quotients' mean, or one of them.
#[inline(always)]
pub(super) fn quotient<S: Simd, const OF: u8>(s: [Lanes<S>; 2], p: [Lanes<S>; 2]) -> Lanes<S> {
    match OF {
        S_ALONE => s[0].div(s[1]),
        P_ALONE => p[0].div(p[1]),
        _ => mean(s, p),
    }
}

/// A linear form `x U + y V` of the fields in the plane reached so far.
#[derive(Clone, Copy)]
pub(super) struct Form<S: Simd> {
    pub(super) x: Complex<S>,
    pub(super) y: Complex<S>,
}

impl<S: Simd> Form<S> {
    #[inline(always)]
    pub(super) fn on(self, field: Field<S>) -> Complex<S> {
        self.x.mul_add(field.u, self.y * field.v)
    }

    /// Returns the part of the form proportional to sin(delta) in a gap of these g/q, q/g.
    #[inline(always)]
    pub(super) fn crossed(self, [g_q, q_g]: [Complex<S>; 2]) -> Self {
        Self { x: (self.y * q_g).minus_i(), y: (self.x * g_q).minus_i() }
    }

    /// Returns the same in a gap in which waves propagate.
    #[inline(always)]
    pub(super) fn crossed_real(self, [g_q, q_g]: [Lanes<S>; 2]) -> Self {
        Self { x: self.y.scale(q_g).minus_i(), y: self.x.scale(g_q).minus_i() }
    }

    #[inline(always)]
    fn through(self, m: impl Transfer<S>) -> Self {
        let [x, y] = m.transposed().on([self.x, self.y]);
        Self { x, y }
    }

    #[inline(always)]
    pub(super) fn scale(self, factor: Lanes<S>) -> Self {
        Self { x: self.x.scale(factor), y: self.y.scale(factor) }
    }
}

/// The reflected and the incident wave, in one polarisation.
#[derive(Clone, Copy)]
pub(super) struct Pair<T> {
    pub(super) reflected: T,
    pub(super) incident: T,
}

// Written out instead of using `map`: a closure may become a function of its own, compiled without the
// instruction set.
impl<S: Simd> Pair<Form<S>> {
    #[inline(always)]
    pub(super) fn new(eta0: Lanes<S>) -> Self {
        let x = Complex::real(eta0);
        let one = eta0.splat(1.0);
        Self { reflected: Form { x, y: Complex::real(-one) }, incident: Form { x, y: Complex::real(one) } }
    }

    #[inline(always)]
    pub(super) fn crossed(self, admittances: [Complex<S>; 2]) -> Self {
        Self { reflected: self.reflected.crossed(admittances), incident: self.incident.crossed(admittances) }
    }

    #[inline(always)]
    pub(super) fn crossed_real(self, admittances: [Lanes<S>; 2]) -> Self {
        Self {
            reflected: self.reflected.crossed_real(admittances),
            incident: self.incident.crossed_real(admittances),
        }
    }

    #[inline(always)]
    pub(super) fn on(self, field: Field<S>) -> Pair<Complex<S>> {
        Pair { reflected: self.reflected.on(field), incident: self.incident.on(field) }
    }
}

impl<S: Simd> Pair<Complex<S>> {
    /// self c + other s, for real c and s.
    #[inline(always)]
    pub(super) fn scale_add(self, c: Lanes<S>, other: Self, s: Lanes<S>) -> Self {
        Self {
            reflected: self.reflected.scale_add(c, other.reflected.scale(s)),
            incident: self.incident.scale_add(c, other.incident.scale(s)),
        }
    }

    /// self c + other s.
    #[inline(always)]
    pub(super) fn mul_add(self, c: Complex<S>, other: Self, s: Complex<S>) -> Self {
        Self {
            reflected: self.reflected.mul_add(c, other.reflected * s),
            incident: self.incident.mul_add(c, other.incident * s),
        }
    }

    #[inline(always)]
    pub(super) fn norms(self) -> [Lanes<S>; 2] {
        [self.reflected.norm_sqr(), self.incident.norm_sqr()]
    }
}

/// Tangential fields in a plane, up to a factor.
#[derive(Clone, Copy)]
pub(super) struct Field<S: Simd> {
    pub(super) u: Complex<S>,
    pub(super) v: Complex<S>,
}

impl<S: Simd> Field<S> {
    #[inline(always)]
    pub(super) fn scale(self, factor: Lanes<S>) -> Self {
        Self { u: self.u.scale(factor), v: self.v.scale(factor) }
    }
}

/// Quantity that is propagated through layers, up to a factor.
pub(super) trait Carried<S: Simd>: Copy {
    /// Beyond a layer.
    fn through(self, m: impl Transfer<S>) -> Self;

    /// Scales it to a size of about 1.
    fn scaled(self) -> Self;
}

impl<S: Simd> Carried<S> for Pair<Form<S>> {
    #[inline(always)]
    fn through(self, m: impl Transfer<S>) -> Self {
        Self { reflected: self.reflected.through(m), incident: self.incident.through(m) }
    }

    #[inline(always)]
    fn scaled(self) -> Self {
        let factor = (self.incident.x.size() + self.incident.y.size()).recip();
        Self { reflected: self.reflected.scale(factor), incident: self.incident.scale(factor) }
    }
}

impl<S: Simd> Carried<S> for Field<S> {
    #[inline(always)]
    fn through(self, m: impl Transfer<S>) -> Self {
        let [u, v] = m.on([self.u, self.v]);
        Self { u, v }
    }

    #[inline(always)]
    fn scaled(self) -> Self {
        self.scale((self.u.size() + self.v.size()).recip())
    }
}

/// A layer's matrix, up to a factor: U' = c U + u V, V' = c V + v U.
pub(super) trait Transfer<S: Simd>: Copy {
    /// It times a column.
    fn on(self, column: [Complex<S>; 2]) -> [Complex<S>; 2];

    fn transposed(self) -> Self;
}

/// That of any layer.
#[derive(Clone, Copy)]
pub(super) struct Absorbing<S: Simd> {
    pub(super) c: Complex<S>,
    /// -i (g/q) sin(delta).
    pub(super) u: Complex<S>,
    /// -i (q/g) sin(delta).
    pub(super) v: Complex<S>,
}

impl<S: Simd> Transfer<S> for Absorbing<S> {
    #[inline(always)]
    fn on(self, [a, b]: [Complex<S>; 2]) -> [Complex<S>; 2] {
        [self.c.mul_add(a, self.u * b), self.c.mul_add(b, self.v * a)]
    }

    #[inline(always)]
    fn transposed(self) -> Self {
        Self { u: self.v, v: self.u, ..self }
    }
}

/// That of a layer with c, (g/q) sin(delta) and (q/g) sin(delta) real.
#[derive(Clone, Copy)]
pub(super) struct Clear<S: Simd> {
    pub(super) c: Lanes<S>,
    /// (g/q) sin(delta).
    pub(super) u: Lanes<S>,
    /// (q/g) sin(delta).
    pub(super) v: Lanes<S>,
}

impl<S: Simd> Transfer<S> for Clear<S> {
    #[inline(always)]
    fn on(self, [a, b]: [Complex<S>; 2]) -> [Complex<S>; 2] {
        [b.minus_i().scale_add(self.u, a.scale(self.c)), a.minus_i().scale_add(self.v, b.scale(self.c))]
    }

    #[inline(always)]
    fn transposed(self) -> Self {
        Self { u: self.v, v: self.u, ..self }
    }
}
