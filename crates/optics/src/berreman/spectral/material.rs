//! What waves of any azimuth have in common in a part: its dielectric constants at some wavelengths, and its faces as an isotropic thick layer.

use super::super::generator::Generator;
use super::super::lanes::{Complex, Element, Pair, Real};
use super::faces::Faces;
use super::thick::{Crossing, Thick, anisotropic, wave_down};
use super::{Group, Part, Slice, root};
use crate::with_widest_simd;

/// Bound of the rate at which waves grow over that of waves along the principal axes.
const GROWTH: f64 = 1.5;

/// What waves of any azimuth have in common in a part.
pub(super) struct Material {
    /// Square of the principal index along the third axis, and what those along the first and second have in addition.
    pub(super) square: Complex,
    pub(super) more: [Complex; 2],
    pub(super) biaxial: bool,
    pub(super) isotropic: bool,
    pub(super) absorbs: bool,
    /// Bound of the rate at which waves grow, over k0.
    pub(super) rate: Real,
    pub(super) grows: bool,
    /// Faces from the reference to an isotropic medium.
    faces: Faces,
    /// Square of the wave vector along the normal, over k0: of waves in an isotropic medium, and of the ordinary ones in a uniaxial medium.
    normal: Complex,
}

impl Material {
    pub(super) fn new(group: &Group<'_>, part: &Part) -> Self {
        let indices = part.indices.each_ref().map(|index| group.complex(index));
        let [a, b, c] = indices.map(|index| index * index);
        let more = [a - c, b - c];
        let absorbs = indices.iter().any(|index| index.im.size().max() > 0.0);
        let along = [a, b, c].map(|square| root(square - Complex::from(group.beta * group.beta)).im);
        let rate = along[0].larger(along[1]).larger(along[2]) * Real::splat(GROWTH);
        let is_zero = |value: Complex| value.norm_sqr().max() == 0.0;
        let [biaxial, isotropic] = [!is_zero(more[1]), is_zero(more[0]) && is_zero(more[1])];
        let (faces, normal) = (group.faces(indices[2]), c - Complex::from(group.beta * group.beta));
        Self { square: c, more, biaxial, isotropic, absorbs, rate, grows: rate.max() > 0.0, faces, normal }
    }

    /// Returns the part, a thick layer of one slice, as waves of this azimuth meet it.
    pub(super) fn thick(&self, group: &Group<'_>, slice: &Slice, azimuth: f64) -> Thick {
        let depth = group.k0 * Real::splat(slice.thickness_nm);
        if self.isotropic {
            let wave = wave_down(self.normal).scaled(depth).wave();
            let both = Pair::diagonal(wave, wave);
            return Thick { faces: self.faces, crossing: Crossing { down: both, up: both } };
        }
        let ordinary = (!self.biaxial).then_some(self.normal);
        with_widest_simd(
            #[inline(always)]
            || match self.absorbs {
                true => anisotropic(&self.complex(group, slice, azimuth), ordinary, depth),
                false => anisotropic(&self.real(group, slice, azimuth), ordinary, depth),
            },
        )
    }

    #[inline(always)]
    pub(super) fn complex(&self, group: &Group<'_>, slice: &Slice, azimuth: f64) -> Generator<Complex> {
        generator(group, self.square, self.more, self.biaxial, (slice, azimuth))
    }

    #[inline(always)]
    pub(super) fn real(&self, group: &Group<'_>, slice: &Slice, azimuth: f64) -> Generator<Real> {
        generator(group, self.square.re, [self.more[0].re, self.more[1].re], self.biaxial, (slice, azimuth))
    }
}

#[inline(always)]
fn generator<T: Element>(
    group: &Group<'_>,
    square: T,
    more: [T; 2],
    biaxial: bool,
    (slice, azimuth): (&Slice, f64),
) -> Generator<T> {
    let (sin, cos) = azimuth.sin_cos();
    // In the frame of the wave: x along its travel, z down, y = z x x.
    let [a, b] = [slice.axes[0], slice.axes[1]];
    let a = [cos * a[0] + sin * a[1], sin * a[0] - cos * a[1], -a[2]];
    let b = [cos * b[0] + sin * b[1], sin * b[0] - cos * b[1], -b[2]];
    let mut e = [T::real(Real::splat(0.0)); 6];
    for (k, (i, j)) in [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)].into_iter().enumerate() {
        e[k] = more[0].scaled(Real::splat(a[i] * a[j]));
        if biaxial {
            e[k] = e[k] + more[1].scaled(Real::splat(b[i] * b[j]));
        }
        if i == j {
            e[k] = e[k] + square;
        }
    }
    let [xx, yy, zz, xy, xz, yz] = e;
    let (inverse, beta) = (zz.inverse(), group.beta);
    let ([p, s], [over_p, over_s]) = (group.root, group.inverse_root);
    let (x, y) = (xz * inverse, yz * inverse);
    Generator {
        along: x.scaled(-beta),
        across: y.scaled(-(beta * p * over_s)),
        mixed: (xy - xz * y).scaled(over_p * over_s),
        electric: (T::real(Real::splat(1.0)) - inverse.scaled(beta * beta)).scaled(p * p),
        magnetic: (xx - xz * x).scaled(over_p * over_p),
        other: (yy - yz * y - T::real(beta * beta)).scaled(over_s * over_s),
        s: s * s,
    }
}
