//! Faces between the reference medium and others, as scattering matrices and reflections of p and s.

use super::super::lanes::{Blocks, Complex, Element as _, Pair, Real};
use crate::with_widest_simd;

/// Reflectance of a face between thick layers that does not matter.
const NO_FACE: f64 = 1e-6;

/// Returns the reflections of a face from the reference to a medium of these relative admittances. The fields of waves of p up are (-1,
/// 1), of s (1, -1).
pub(super) fn face([p, s]: [Complex; 2]) -> [Complex; 2] {
    let one = Complex::splat(1.0);
    [(p - one) * (p + one).inverse(), (one - s) * (one + s).inverse()]
}

/// Returns the face from the reference down into a medium, in waves of it whose transmission down is 1.
#[inline(always)]
pub(super) fn into_medium([p, s]: [Complex; 2]) -> Blocks {
    let one = Complex::splat(1.0);
    Blocks {
        r: Pair::diagonal(p, s),
        t: Pair::one(),
        r_below: Pair::diagonal(-p, -s),
        t_up: Pair::diagonal(one - p * p, one - s * s),
    }
}

/// Returns the face from a medium down into the reference.
#[inline(always)]
pub(super) fn from_medium([p, s]: [Complex; 2]) -> Blocks {
    let one = Complex::splat(1.0);
    Blocks {
        r: Pair::diagonal(-p, -s),
        t: Pair::diagonal(one - p * p, one - s * s),
        r_below: Pair::diagonal(p, s),
        t_up: Pair::one(),
    }
}

/// Returns the transmission down and up of a face from one medium to another, given by their faces from the reference, if it reflects less than
/// [`NO_FACE`].
pub(super) fn transparent_face(above: [Complex; 2], below: [Complex; 2]) -> Option<[Pair; 2]> {
    let one = Complex::splat(1.0);
    let over = [0, 1].map(|k| (one - above[k] * below[k]).inverse());
    let is_faint = |k: usize| ((above[k] - below[k]) * over[k]).norm_sqr().max() < NO_FACE;
    let passed =
        |by: [Complex; 2]| Pair::diagonal((one - by[0] * by[0]) * over[0], (one - by[1] * by[1]) * over[1]);
    (is_faint(0) && is_faint(1)).then(|| [passed(above), passed(below)])
}

/// Returns the face from a medium of these relative admittances, in waves of unit power of it, down into the reference.
#[inline(always)]
pub(super) fn from_front([p, s]: [Real; 2]) -> Blocks {
    let one = Real::splat(1.0);
    // As `face`.
    let (f_p, f_s) = ((p - one) * (p + one).inverse(), (one - s) * (one + s).inverse());
    let root = |f: Real| Complex::from((one - f * f).root());
    let through = Pair::diagonal(root(f_p), root(f_s));
    let r = Pair::diagonal(f_p.into(), f_s.into());
    Blocks { r: Pair::diagonal((-f_p).into(), (-f_s).into()), t: through, r_below: r, t_up: through }
}

/// Returns `r` as waves of a medium see it, from its reflections to the reference: `-f + r (1 - f r)^-1 (1 - f^2)`.
#[inline(always)]
pub(super) fn out_of_medium([p, s]: [Complex; 2], r: Pair) -> Pair {
    let [[pp, ps], [sp, ss]] = r.0;
    let one = Complex::splat(1.0);
    let determinant = pp * ss - ps * sp;
    let scale = (one - p * pp - s * ss + p * s * determinant).inverse();
    let (by_p, by_s) = ((one - p * p) * scale, (one - s * s) * scale);
    Pair([[(pp - s * determinant) * by_p - p, ps * by_s], [sp * by_p, (ss - p * determinant) * by_s - s]])
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
