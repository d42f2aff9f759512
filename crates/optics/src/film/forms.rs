//! What the kernel carries through the layers, in one polarisation: the incidence
//! medium's amplitudes downwards, the substrate's fields upwards.

use pulp::Simd;

use super::lanes::{Complex, Lanes};

/// Half of both quotients' sum, by one division.
#[inline(always)]
pub(super) fn mean<S: Simd>(s: [Lanes<S>; 2], p: [Lanes<S>; 2]) -> Lanes<S> {
    let numerator = s[0].mul_add(p[1], p[0] * s[1]);
    (numerator * numerator.splat(0.5)).div(s[1] * p[1])
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

    /// The part of the form that goes with sin(delta) in a gap of these g/q, q/g.
    #[inline(always)]
    pub(super) fn crossed(self, [g_q, q_g]: [Complex<S>; 2]) -> Self {
        Self { x: (self.y * q_g).minus_i(), y: (self.x * g_q).minus_i() }
    }

    #[inline(always)]
    pub(super) fn through(self, m: Transfer<S>) -> Self {
        Self { x: self.x.mul_add(m.c, self.y * m.v), y: self.x.mul_add(m.u, self.y * m.c) }
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

// Spelt out rather than mapped: a closure may end up in a function of its own,
// compiled without the instruction set.
impl<S: Simd> Pair<Form<S>> {
    #[inline(always)]
    pub(super) fn new(eta0: Lanes<S>) -> Self {
        let x = Complex::real(eta0);
        let one = eta0.splat(1.0);
        Self { reflected: Form { x, y: Complex::real(-one) }, incident: Form { x, y: Complex::real(one) } }
    }

    #[inline(always)]
    pub(super) fn through(self, m: Transfer<S>) -> Self {
        let (reflected, incident) = (self.reflected.through(m), self.incident.through(m));
        let factor = (incident.x.size() + incident.y.size()).recip();
        Self { reflected: reflected.scale(factor), incident: incident.scale(factor) }
    }

    #[inline(always)]
    pub(super) fn crossed(self, admittances: [Complex<S>; 2]) -> Self {
        Self { reflected: self.reflected.crossed(admittances), incident: self.incident.crossed(admittances) }
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
    pub(super) fn through(self, m: Transfer<S>) -> Self {
        let u = m.c.mul_add(self.u, m.u * self.v);
        let v = m.c.mul_add(self.v, m.v * self.u);
        let factor = (u.size() + v.size()).recip();
        Self { u: u.scale(factor), v: v.scale(factor) }
    }
}

/// A layer's matrix, up to a real factor: U' = c U + u V, V' = c V + v U.
#[derive(Clone, Copy)]
pub(super) struct Transfer<S: Simd> {
    pub(super) c: Complex<S>,
    /// -i (g/q) sin(delta).
    pub(super) u: Complex<S>,
    /// -i (q/g) sin(delta).
    pub(super) v: Complex<S>,
}
