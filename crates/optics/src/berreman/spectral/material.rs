//! What waves of any azimuth have in common in a part: its dielectric constants at some wavelengths, and its light as a thick layer.

use std::f64::consts::FRAC_PI_4;

use super::super::generator::Generator;
use super::super::lanes::{Complex, Element, Real};
use super::faces::face;
use super::{Group, Part, Slice, root};

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
    pub(super) thick: Thick,
}

/// A part as a thick layer.
#[derive(Clone, Copy)]
pub(super) struct Thick {
    /// Reflections of a face from the reference to a medium of its mean index and least absorption, p and s.
    pub(super) faces: [Complex; 2],
    /// Wave vector along the normal in that medium, over k0.
    pub(super) wave: Complex,
    /// k0 d of an eighth of a wave, and half of its phase factor.
    pub(super) eighth: Real,
    pub(super) turn: Complex,
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
        // What leaves a polariser is the wave that it transmits: its faces are those of a medium that absorbs as that wave is absorbed.
        let [k, k_b, k_c] = indices.map(|index| -index.im);
        let k = -k.larger(k_b).larger(k_c);
        let [a, b, c_of_wave] = indices.map(|index| {
            let index = Complex { re: index.re, im: k };
            index * index
        });
        let mean = root((a + b + c_of_wave).scaled(Real::splat(1.0 / 3.0)));
        let wave = root(mean * mean - Complex::from(group.beta * group.beta));
        let eighth = wave.re.at_least(0.1).inverse() * Real::splat(FRAC_PI_4);
        let turn = Complex::from(wave.re * eighth).wave().scaled(Real::splat(0.5));
        let thick = Thick { faces: face(group.admittances(mean)), wave, eighth, turn };
        Self { square: c, more, biaxial, isotropic, absorbs, rate, grows: rate.max() > 0.0, thick }
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
