//! Faces between the reference medium and others, as scattering matrices and reflections of p and s.

use super::super::lanes::{Blocks, Complex, Element as _, Pair, Real};
use crate::with_widest_simd;

/// Reflectance of a face between thick layers that does not matter.
const NO_FACE: f64 = 1e-6;

/// What half-spaces of a medium reflect to the reference: below it, and above it. The fields of waves of p up are (-1, 1), of s (1, -1).
#[derive(Clone, Copy)]
pub(super) struct Faces {
    pub(super) r: Pair,
    pub(super) r_below: Pair,
}

impl Faces {
    /// Of an isotropic medium, by what it reflects of p and of s.
    pub(super) fn isotropic([p, s]: [Complex; 2]) -> Self {
        let r = Pair::diagonal(p, s);
        Self { r, r_below: r }
    }

    /// Returns the face from the reference down into the medium, in waves of it whose transmission down is 1.
    #[inline(always)]
    pub(super) fn entered(&self) -> Blocks {
        let Self { r, r_below } = *self;
        Blocks { r, t: Pair::one(), r_below: -r_below, t_up: Pair::one() - r * r_below }
    }

    /// Returns the face from the medium down into the reference.
    #[inline(always)]
    pub(super) fn left(&self) -> Blocks {
        let Self { r, r_below } = *self;
        Blocks { r: -r, t: Pair::one() - r_below * r, r_below, t_up: Pair::one() }
    }
}

/// Returns the transmission down and up of a face, if it reflects less than [`NO_FACE`].
pub(super) fn transparent(face: &Blocks) -> Option<[Pair; 2]> {
    let elements = [face.r, face.r_below].map(|r| r.0);
    let is_faint = elements.iter().flatten().flatten().all(|r| r.norm_sqr().max() < NO_FACE);
    is_faint.then_some([face.t, face.t_up])
}

/// Returns the face from a medium of these relative admittances, in waves of unit power of it, down into the reference.
#[inline(always)]
pub(super) fn from_front([p, s]: [Real; 2]) -> Blocks {
    let one = Real::splat(1.0);
    let (f_p, f_s) = ((p - one) * (p + one).inverse(), (one - s) * (one + s).inverse());
    let root = |f: Real| Complex::from((one - f * f).root());
    let through = Pair::diagonal(root(f_p), root(f_s));
    let r = Pair::diagonal(f_p.into(), f_s.into());
    Blocks { r: Pair::diagonal((-f_p).into(), (-f_s).into()), t: through, r_below: r, t_up: through }
}

/// Returns the reflection as waves of unit power see it from a medium of these relative admittances.
pub(super) fn in_front(front: [Real; 2], r: Pair) -> Pair {
    with_widest_simd(
        #[inline(always)]
        || {
            // Waves down and up: (E root(y) +- H/root(y))/2, with E = (1 - r) or (1 + r) and H the reverse; p up is the opposite of that difference.
            let [[pp, ps], [sp, ss]] = r.0;
            let one = Complex::splat(1.0);
            let (p, s) = (front[0].root(), front[1].root());
            let (over_p, over_s) = (p.inverse(), s.inverse());
            let e = [[(one - pp).scaled(p), (-ps).scaled(p)], [sp.scaled(s), (one + ss).scaled(s)]];
            let h = [
                [(one + pp).scaled(over_p), ps.scaled(over_p)],
                [(-sp).scaled(over_s), (one - ss).scaled(over_s)],
            ];
            let ([e_p, e_s], [h_p, h_s]) = (e, h);
            let up = Pair([[h_p[0] - e_p[0], h_p[1] - e_p[1]], [e_s[0] - h_s[0], e_s[1] - h_s[1]]]);
            up * (Pair(e) + Pair(h)).inverse()
        },
    )
}
