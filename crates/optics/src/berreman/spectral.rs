//! Reflectance of many wavelengths, directions and states for unpolarised light: the fast implementation.
//!
//! The equations are those of [`jones`](super::jones), with several wavelengths in the lanes of a register. Fields are
//! relative to a medium of admittances `y` (p and s) close to those of the layers, so that waves down and up are
//! `(1, 1)` and `(-1, 1)` for p, `(1, 1)` and `(1, -1)` for s. What lies below is a 2x2 reflection matrix between them.
//!
//! - Slices of a cell below all thick slabs carry two fields up: the Taylor series of the exponential acts on them, real where
//!   nothing absorbs; after each slice they are a reflection matrix again, so that nothing grows.
//! - Other layers become scattering matrices, by doubling of a thin slice, once for all states.
//! - A thick layer without fringes is the mean over the phase of its waves: of one layer at 16 points, so that the light of 15 round trips
//!   between its faces is exact; of several at the points of a lattice, exact for light that one or two faces return. An anisotropic
//!   layer keeps the phase between its two waves, and has the faces of its mean index.

use std::f64::consts::{FRAC_PI_4, PI};

use num_complex::Complex64;

use super::lanes::{Blocks, Complex, Element, LANES, Pair, Real};
use crate::film::{checked_incidence, checked_index, checked_thickness, checked_wavelength};
use crate::{OpticsError, with_widest_simd};

/// Homogeneous piece of a part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slice {
    /// Principal axes, orthogonal unit vectors as rows, in the frame of the panel ([`axes`](super::axes)).
    pub axes: [[f64; 3]; 3],
    /// Thickness, nm.
    pub thickness_nm: f64,
}

/// Layer of one material, whose axes may change with depth and state.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// Principal indices n + ik, `[axis][wavelength]`.
    pub indices: [Vec<Complex64>; 3],
    /// Slices from the top down: a list for each state, or one list for all states.
    pub slices: Vec<Vec<Slice>>,
    /// False for a thick layer without fringes. It must be one slice, the same in all states, with indices that are close to each other.
    pub coherent: bool,
}

/// Anisotropic layers over a substrate, at many wavelengths and in several states.
#[derive(Debug, Clone, PartialEq)]
pub struct SpectralStack {
    wavelength_nm: Vec<f64>,
    front: Vec<f64>,
    parts: Vec<Part>,
    back: Vec<Complex64>,
    states: usize,
}

/// Largest number of thick layers.
pub const MOST_SLABS: usize = 8;

/// Points of the lattices over the phases of up to 1, 4 and 8 thick layers, and the steps of each layer. The phases of two faces differ by the sum of the
/// steps between them: the sums from the first layer on are a perfect difference set (J. Singer, 1938), so that no difference of two of them
/// occurs twice.
const LATTICES: [(usize, [usize; MOST_SLABS]); 3] =
    [(16, [1, 0, 0, 0, 0, 0, 0, 0]), (21, [1, 3, 10, 2, 0, 0, 0, 0]), (73, [1, 2, 4, 8, 16, 5, 18, 9])];

/// Largest norm of a step of the Taylor series, and of that of a slice that is doubled.
const STEP: f64 = 2.0;
const THIN: f64 = 0.5;

/// Error of the Taylor series.
const SERIES: f64 = 1e-13;

impl SpectralStack {
    /// Builds a stack. `front` and `back` are the indices of the transparent medium above and of the one below, by wavelength.
    ///
    /// # Errors
    /// Arrays of different lengths, impossible indices, thicknesses or wavelengths; a thick layer that is not one
    /// slice, or more than [`MOST_SLABS`] of them.
    pub fn new(
        wavelength_nm: &[f64],
        front: &[f64],
        parts: &[Part],
        back: &[Complex64],
    ) -> Result<Self, OpticsError> {
        let count = wavelength_nm.len();
        let length = |what, found| {
            if found == count { Ok(()) } else { Err(OpticsError::Length { what, expected: count, found }) }
        };
        wavelength_nm.iter().try_for_each(|nm| checked_wavelength(*nm).map(|_| ()))?;
        length("front", front.len())?;
        front.iter().try_for_each(|n| checked_incidence(*n).map(|_| ()))?;
        length("back", back.len())?;
        back.iter().try_for_each(|n| checked_index(*n).map(|_| ()))?;
        let states = parts.iter().map(|part| part.slices.len()).max().unwrap_or(1).max(1);
        for part in parts {
            for indices in &part.indices {
                length("indices", indices.len())?;
                indices.iter().try_for_each(|n| checked_index(*n).map(|_| ()))?;
            }
            let slices = part.slices.iter().flatten();
            slices.clone().try_for_each(|slice| checked_thickness(slice.thickness_nm).map(|_| ()))?;
            if part.slices.len() != 1 && part.slices.len() != states {
                let (expected, found) = (states, part.slices.len());
                return Err(OpticsError::Length { what: "states of a part", expected, found });
            }
            let is_one_slice = part.slices.len() == 1 && part.slices[0].len() == 1;
            if !part.coherent && !is_one_slice {
                return Err(OpticsError::Axis { what: "a thick layer", expected: "one slice" });
            }
        }
        if parts.iter().filter(|part| !part.coherent).count() > MOST_SLABS {
            return Err(OpticsError::Axis { what: "thick layers", expected: "eight at most" });
        }
        let (wavelength_nm, front, back) = (wavelength_nm.to_vec(), front.to_vec(), back.to_vec());
        Ok(Self { wavelength_nm, front, parts: parts.to_vec(), back, states })
    }

    /// Returns the number of states.
    pub fn states(&self) -> usize {
        self.states
    }

    /// Computes the reflectance for unpolarised light, `[state][wavelength]`, of a wave of `beta = n sin(theta)` at each wavelength that
    /// travels at this azimuth.
    ///
    /// # Errors
    /// beta outside 0 <= beta < n of the medium above; arrays of other lengths.
    pub fn reflectance(&self, beta: &[f64], azimuth_deg: f64, out: &mut [f64]) -> Result<(), OpticsError> {
        let count = self.wavelength_nm.len();
        for (what, expected, found) in
            [("beta", count, beta.len()), ("reflectances", self.states * count, out.len())]
        {
            if found != expected {
                return Err(OpticsError::Length { what, expected, found });
            }
        }
        for (beta, n) in beta.iter().zip(&self.front) {
            if !(0.0..*n).contains(beta) {
                return Err(OpticsError::Beta { beta: *beta, limit: *n });
            }
        }
        let azimuth = azimuth_deg.to_radians();
        for first in (0..count).step_by(LANES) {
            Group::new(self, first, beta).reflectance(azimuth, count, out);
        }
        Ok(())
    }
}

/// Some wavelengths.
struct Group<'a> {
    stack: &'a SpectralStack,
    first: usize,
    /// 2 pi/lambda.
    k0: Real,
    beta: Real,
    /// Roots of the admittances of the reference and their inverse: p, s.
    root: [Real; 2],
    inverse_root: [Real; 2],
}

/// What is above the lowest thick layer.
#[allow(clippy::large_enum_variant, reason = "there are a few layers")]
enum Above {
    /// One scattering matrix for each state, or one for all.
    Coherent(Vec<Blocks>),
    /// A thick layer: reflections of a face from the reference to a medium of its mean index, p and s, and its transmission down and up
    /// without faces.
    Thick([Complex; 2], Pair, Pair),
}

impl<'a> Group<'a> {
    fn new(stack: &'a SpectralStack, first: usize, beta: &[f64]) -> Self {
        let beta = loaded(beta, first);
        let square = beta * beta;
        let index_squared = (square + Real::splat(1.0)).at_least(2.4);
        let s = (index_squared - square).root();
        let p = index_squared * s.inverse();
        let root = [p.root(), s.root()];
        let k0 = loaded(&stack.wavelength_nm, first).inverse() * Real::splat(2.0 * PI);
        Self { stack, first, k0, beta, root, inverse_root: [root[0].inverse(), root[1].inverse()] }
    }

    fn complex(&self, values: &[Complex64]) -> Complex {
        let mut out = Complex::zero();
        for k in 0..LANES {
            let value = values[(self.first + k).min(values.len() - 1)];
            (out.re.0[k], out.im.0[k]) = (value.re, value.im);
        }
        out
    }

    fn reflectance(&self, azimuth: f64, count: usize, out: &mut [f64]) {
        let parts = &self.stack.parts;
        let below = parts.iter().rposition(|part| !part.coherent).map_or(0, |slab| slab + 1);
        let mut reflection = vec![self.of_medium(&self.stack.back); self.stack.states];
        for part in parts[below..].iter().rev() {
            self.raise(part, azimuth, &mut reflection);
        }
        let mut above = Vec::new();
        for part in parts[..below].iter().rev() {
            self.above(part, azimuth, &mut above);
        }
        let slabs = parts.iter().filter(|part| !part.coherent).count();
        let (points, steps) = match slabs {
            0 => (1, LATTICES[0].1),
            1 => LATTICES[0],
            2..=4 => LATTICES[1],
            _ => LATTICES[2],
        };
        let face = self.of_front();
        let last = (count - self.first).min(LANES);
        for state in 0..self.stack.states {
            let mut sum = Real::splat(0.0);
            for point in 0..points {
                let mut slab = 0;
                let mut r = reflection[state];
                for above in &above {
                    r = match above {
                        Above::Coherent(all) => {
                            all[if all.len() == 1 { 0 } else { state }].over_reflection(r)
                        }
                        Above::Thick(faces, down, up) => {
                            slab += 1;
                            let turn = 2.0 * PI * (point * steps[slab - 1] % points) as f64 / points as f64;
                            thick(*faces, (*down, *up), turn, r)
                        }
                    };
                }
                sum = sum + unpolarised(face, r);
            }
            let mean = sum * Real::splat(1.0 / points as f64);
            out[state * count + self.first..][..last].copy_from_slice(&mean.0[..last]);
        }
    }

    /// Returns the admittances of an isotropic medium over those of the reference.
    fn admittances(&self, index: Complex) -> [Complex; 2] {
        let square = index * index;
        let q = root(square - Complex::from(self.beta * self.beta));
        let p = (square * q.inverse()).scaled(self.inverse_root[0] * self.inverse_root[0]);
        [p, q.scaled(self.inverse_root[1] * self.inverse_root[1])]
    }

    /// Returns the reflection of a medium without anything above it.
    fn of_medium(&self, index: &[Complex64]) -> Pair {
        let [p, s] = face(self.admittances(self.complex(index)));
        Pair::diagonal(p, s)
    }

    /// Returns the admittances of the medium above.
    fn of_front(&self) -> [Real; 2] {
        let [p, s] = self.admittances(loaded(&self.stack.front, self.first).into());
        [p.re, s.re]
    }

    /// Replaces the reflection of what is below a part by that of both.
    fn raise(&self, part: &Part, azimuth: f64, reflection: &mut [Pair]) {
        let material = Material::new(self, part);
        let is_one = part.slices.len() == 1;
        if part.slices.iter().all(|slices| slices.len() <= 1) {
            let mut blocks = Vec::with_capacity(part.slices.len());
            self.blocks(&material, part, azimuth, &mut blocks);
            for (state, r) in reflection.iter_mut().enumerate() {
                *r = blocks[if is_one { 0 } else { state }].over_reflection(*r);
            }
            return;
        }
        for (state, below) in reflection.iter_mut().enumerate() {
            let slices = &part.slices[if is_one { 0 } else { state }];
            let mut r = *below;
            with_widest_simd(
                #[inline(always)]
                || {
                    for slice in slices.iter().rev() {
                        let depth = self.k0 * Real::splat(slice.thickness_nm);
                        if material.absorbs {
                            r = raised(&material.complex(self, slice, azimuth), depth, r);
                        } else {
                            r = raised(&material.real(self, slice, azimuth), depth, r);
                        }
                    }
                },
            );
            *below = r;
        }
    }

    /// Adds the scattering matrices of a part, one for each list of slices.
    fn blocks(&self, material: &Material, part: &Part, azimuth: f64, out: &mut Vec<Blocks>) {
        for slices in &part.slices {
            let nothing = Pair::diagonal(Complex::zero(), Complex::zero());
            let mut all = Blocks { r: nothing, t: Pair::one(), r_below: nothing, t_up: Pair::one() };
            for (number, slice) in slices.iter().enumerate() {
                let depth = self.k0 * Real::splat(slice.thickness_nm);
                let one = doubled(&material.complex(self, slice, azimuth), depth);
                all = if number == 0 { one } else { all.over(&one) };
            }
            out.push(all);
        }
    }

    /// Adds what a part is above a thick layer or as one, from the bottom up.
    fn above(&self, part: &Part, azimuth: f64, out: &mut Vec<Above>) {
        let material = Material::new(self, part);
        let Some(slice) = part.slices.first().and_then(|slices| slices.first()).filter(|_| !part.coherent)
        else {
            let mut blocks = Vec::with_capacity(part.slices.len());
            self.blocks(&material, part, azimuth, &mut blocks);
            out.push(Above::Coherent(blocks));
            return;
        };
        let third = Real::splat(1.0 / 3.0);
        let mean = root(material.square + (material.more[0] + material.more[1]).scaled(third));
        let faces = face(self.admittances(mean));
        let generator = material.complex(self, slice, azimuth);
        // The mean of two thicknesses that differ by a quarter wave, whose phase is undone: what the faces of the layer itself reflect to each
        // other has opposite signs in both.
        let q = root(mean * mean - Complex::from(self.beta * self.beta)).re;
        let eighth = q.at_least(0.1).inverse() * Real::splat(FRAC_PI_4);
        let depth = self.k0 * Real::splat(slice.thickness_nm);
        let zero = Complex::zero();
        let (mut down, mut up) = (Pair::diagonal(zero, zero), Pair::diagonal(zero, zero));
        for sign in [1.0, -1.0] {
            let layer = doubled(&generator, depth + eighth * Real::splat(sign));
            let inside = from_medium(faces).over(&layer).over(&into_medium(faces));
            let (sin, cos) = (q * eighth).sin_cos();
            let phase = Complex { re: cos * Real::splat(0.5), im: sin * Real::splat(-0.5 * sign) };
            let phase = Pair::diagonal(phase, phase);
            (down, up) = (down + inside.t * phase, up + inside.t_up * phase);
        }
        out.push(Above::Thick(faces, down, up));
    }
}

/// Returns the values from number `first` on; the last one is repeated.
fn loaded(values: &[f64], first: usize) -> Real {
    let mut out = Real::splat(0.0);
    for k in 0..LANES {
        out.0[k] = values[(first + k).min(values.len() - 1)];
    }
    out
}

/// Returns the square root with Im >= 0.
fn root(z: Complex) -> Complex {
    let mut out = z;
    for k in 0..LANES {
        let root = Complex64::new(z.re.0[k], z.im.0[k]).sqrt();
        let root = if root.im < 0.0 { -root } else { root };
        (out.re.0[k], out.im.0[k]) = (root.re, root.im);
    }
    out
}

/// Returns the reflections of a face from the reference to a medium of these relative admittances. The fields of waves of p up are (-1,
/// 1), of s (1, -1).
fn face([p, s]: [Complex; 2]) -> [Complex; 2] {
    let one = Complex::splat(1.0);
    [(p - one) * (p + one).inverse(), (one - s) * (one + s).inverse()]
}

/// Returns the face from the reference down into a medium, in waves of it whose transmission down is 1.
fn into_medium([p, s]: [Complex; 2]) -> Blocks {
    let one = Complex::splat(1.0);
    Blocks {
        r: Pair::diagonal(p, s),
        t: Pair::one(),
        r_below: Pair::diagonal(-p, -s),
        t_up: Pair::diagonal(one - p * p, one - s * s),
    }
}

/// Returns the face from a medium down into the reference.
fn from_medium([p, s]: [Complex; 2]) -> Blocks {
    let one = Complex::splat(1.0);
    Blocks {
        r: Pair::diagonal(-p, -s),
        t: Pair::diagonal(one - p * p, one - s * s),
        r_below: Pair::diagonal(p, s),
        t_up: Pair::one(),
    }
}

/// Returns the reflection of a thick layer over one that reflects, with another phase of its waves.
fn thick(faces: [Complex; 2], (down, up): (Pair, Pair), turn: f64, r: Pair) -> Pair {
    let (sin, cos) = turn.sin_cos();
    let phase = Complex { re: Real::splat(cos), im: Real::splat(sin) };
    let inside = up * (from_medium(faces).over_reflection(r) * Pair::diagonal(phase, phase)) * down;
    into_medium(faces).over_reflection(inside)
}

/// Returns the reflectance for unpolarised light from a medium of these relative admittances.
fn unpolarised(front: [Real; 2], r: Pair) -> Real {
    // Waves of unit power in the front, down and up: (E root(y) +- H/root(y))/2, with E = (1 - r) or (1 + r) and H the reverse.
    let [[pp, ps], [sp, ss]] = r.0;
    let one = Complex::splat(1.0);
    let (p, s) = (front[0].root(), front[1].root());
    let (over_p, over_s) = (p.inverse(), s.inverse());
    let e = [[(one - pp).scaled(p), (-ps).scaled(p)], [sp.scaled(s), (one + ss).scaled(s)]];
    let h =
        [[(one + pp).scaled(over_p), ps.scaled(over_p)], [(-sp).scaled(over_s), (one - ss).scaled(over_s)]];
    let up = (Pair(e) - Pair(h)) * (Pair(e) + Pair(h)).inverse();
    let [[a, b], [c, d]] = up.0;
    (a.norm_sqr() + b.norm_sqr() + c.norm_sqr() + d.norm_sqr()) * Real::splat(0.5)
}

/// Squares of the principal indices of a part.
struct Material {
    /// That along the third axis, and what the first and second have in addition.
    square: Complex,
    more: [Complex; 2],
    biaxial: bool,
    absorbs: bool,
}

impl Material {
    fn new(group: &Group<'_>, part: &Part) -> Self {
        let [a, b, c] = [&part.indices[0], &part.indices[1], &part.indices[2]];
        let (a, b, c) = (group.complex(a), group.complex(b), group.complex(c));
        let (a, b, c) = (a * a, b * b, c * c);
        let absorbs = part.indices.iter().flatten().any(|index| index.im != 0.0);
        Self { square: c, more: [a - c, b - c], biaxial: part.indices[1] != part.indices[2], absorbs }
    }

    fn complex(&self, group: &Group<'_>, slice: &Slice, azimuth: f64) -> Generator<Complex> {
        generator(group, self.square, self.more, self.biaxial, (slice, azimuth))
    }

    fn real(&self, group: &Group<'_>, slice: &Slice, azimuth: f64) -> Generator<Real> {
        generator(group, self.square.re, [self.more[0].re, self.more[1].re], self.biaxial, (slice, azimuth))
    }
}

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

/// Berreman's matrix relative to the reference, whose elements are these: rows
/// `(along, electric, across, 0)`, `(magnetic, along, mixed, 0)`, `(0, 0, 0, s)`, `(mixed, across, other, 0)`.
#[derive(Clone, Copy)]
struct Generator<T> {
    along: T,
    across: T,
    mixed: T,
    electric: T,
    magnetic: T,
    other: T,
    s: Real,
}

impl<T: Element> Generator<T> {
    /// Returns the product with a field, plus another field.
    #[inline(always)]
    fn times(&self, field: [Complex; 4], sum: [Complex; 4]) -> [Complex; 4] {
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
    fn scaled(&self, factor: Real) -> Self {
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
        let rows = [
            along + across + self.electric.size(),
            along + mixed + self.magnetic.size(),
            self.s.max(),
            mixed + across + self.other.size(),
        ];
        rows[0].max(rows[1]).max(rows[2]).max(rows[3])
    }

    /// Returns the exponential of `-i` (upwards) or `i` times the matrix, times a field.
    #[inline(always)]
    fn exponential(&self, terms: usize, up: bool, field: [Complex; 4]) -> [Complex; 4] {
        let mut sum = field;
        let zero = [Complex::zero(); 4];
        for term in (1..=terms).rev() {
            let over = Real::splat(if up { 1.0 } else { -1.0 } / term as f64);
            let next = self.times(sum, zero);
            for k in 0..4 {
                sum[k] = field[k] + next[k].minus_i().scaled(over);
            }
        }
        sum
    }
}

/// Returns the number of terms of the Taylor series of the exponential of a matrix of this norm.
fn terms(norm: f64) -> usize {
    let (mut size, mut count) = (1.0, 0);
    while size > SERIES && count < 40 {
        count += 1;
        size *= norm / count as f64;
    }
    count
}

/// Returns the reflection of a slice of k0 d = `depth` over one that reflects.
#[inline(always)]
fn raised<T: Element>(generator: &Generator<T>, depth: Real, mut r: Pair) -> Pair {
    let whole = generator.scaled(depth);
    let norm = whole.norm();
    let steps = (norm / STEP).ceil().max(1.0);
    let step = whole.scaled(Real::splat(1.0 / steps));
    let terms = terms(norm / steps);
    for _ in 0..steps as usize {
        let [[pp, ps], [sp, ss]] = r.0;
        let one = Complex::splat(1.0);
        let p = step.exponential(terms, true, [one - pp, one + pp, sp, -sp]);
        let s = step.exponential(terms, true, [-ps, ps, one + ss, one - ss]);
        // Twice the waves down and up.
        let down = Pair([[p[0] + p[1], s[0] + s[1]], [p[2] + p[3], s[2] + s[3]]]);
        let up = Pair([[p[1] - p[0], s[1] - s[0]], [p[2] - p[3], s[2] - s[3]]]);
        r = up * down.inverse();
    }
    r
}

/// Returns the scattering matrix of a layer of k0 d = `depth`, by doubling a thin slice of it.
fn doubled<T: Element>(generator: &Generator<T>, depth: Real) -> Blocks {
    let whole = generator.scaled(depth);
    let doublings = (whole.norm() / THIN).log2().ceil().max(0.0) as i32;
    let thin = whole.scaled(Real::splat(0.5_f64.powi(doublings)));
    let terms = terms(thin.norm());
    let (zero, half) = (Complex::zero(), Complex::splat(0.5));
    // Columns of the transfer matrix downwards, between waves: p and s down, p and s up.
    let mut columns = [
        [half, half, zero, zero],
        [zero, zero, half, half],
        [-half, half, zero, zero],
        [zero, zero, half, -half],
    ];
    for column in &mut columns {
        let [a, b, c, d] = thin.exponential(terms, false, *column);
        *column = [a + b, c + d, b - a, c - d];
    }
    let [p, s, p_up, s_up] = columns;
    let down = Pair([[p[0], s[0]], [p[1], s[1]]]);
    let from_down = Pair([[p[2], s[2]], [p[3], s[3]]]);
    let from_up = Pair([[p_up[0], s_up[0]], [p_up[1], s_up[1]]]);
    let t_up = Pair([[p_up[2], s_up[2]], [p_up[3], s_up[3]]]).inverse();
    let none = Pair::diagonal(zero, zero);
    let r = none - t_up * from_down;
    let mut layer = Blocks { r, t: down + from_up * r, r_below: from_up * t_up, t_up };
    for _ in 0..doublings {
        layer = layer.over(&layer);
    }
    layer
}
