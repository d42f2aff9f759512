//! Reflectance of many wavelengths, directions and states for unpolarised light: the fast implementation.
//!
//! The equations are those of [`jones`](super::jones), with several wavelengths in the lanes of a register. Fields are
//! relative to a medium of admittances `y` (p and s) close to those of the layers, so that waves down and up are
//! `(1, 1)` and `(-1, 1)` for p, `(1, 1)` and `(1, -1)` for s. What lies below is a 2x2 reflection matrix between them.
//!
//! - Slices of a cell below all thick slabs carry two fields up: the Taylor series of the exponential acts on them, real where
//!   nothing absorbs; after each slice they are a reflection matrix again, so that nothing grows.
//! - Other layers become scattering matrices, by doubling of a thin slice, once for all states.
//! - A thick layer without fringes is the mean over the phase of its waves: of one slab at 16 points, so that the light of 15 round trips
//!   between its faces is exact; of several layers at the points of a lattice, exact for light that one or two faces return. An anisotropic
//!   layer keeps the phase between its two waves: the mean is over the phase of a vanishing gap below it, whose index is the mean of its own.

use std::f64::consts::PI;

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
pub const MOST_SLABS: usize = GENERATOR.len();

/// Points of the lattice over the phases of several thick layers, and their steps. No sum of three steps, with any signs, is a multiple of
/// the number of points.
const POINTS: usize = 47;
const GENERATOR: [usize; 8] = [1, 43, 10, 40, 15, 21, 29, 12];

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
            if !part.coherent && !(part.slices.len() == 1 && part.slices[0].len() == 1) {
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
        with_widest_simd(
            #[inline(always)]
            || {
                for first in (0..count).step_by(LANES) {
                    Group::new(self, first, beta).reflectance(azimuth, count, out);
                }
            },
        );
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
    /// Admittances of the reference, their roots and the inverse roots: p, s.
    root: [Real; 2],
    inverse_root: [Real; 2],
}

/// What is above the lowest thick slab.
enum Above {
    /// One scattering matrix for each state, or one for all.
    Coherent(Vec<Blocks>),
    /// Reflection of the face and propagation of the waves, p and s.
    Thick([Complex; 2], [Complex; 2]),
}

impl<'a> Group<'a> {
    #[inline(always)]
    fn new(stack: &'a SpectralStack, first: usize, beta: &[f64]) -> Self {
        let last = stack.wavelength_nm.len() - 1;
        let at = |values: &[f64]| Real(std::array::from_fn(|k| values[(first + k).min(last)]));
        let beta = at(beta);
        let square = beta * beta;
        let index_squared = square.map(|square| (square + 1.0).max(2.4));
        let s = (index_squared - square).map(f64::sqrt);
        let p = index_squared * s.inverse();
        let root = [p, s].map(|y| y.map(f64::sqrt));
        Self {
            stack,
            first,
            k0: at(&stack.wavelength_nm).map(|nm| 2.0 * PI / nm),
            beta,
            root,
            inverse_root: root.map(|root| root.inverse()),
        }
    }

    #[inline(always)]
    fn complex(&self, values: &[Complex64]) -> Complex {
        let at = |k: usize| values[(self.first + k).min(values.len() - 1)];
        Complex { re: Real(std::array::from_fn(|k| at(k).re)), im: Real(std::array::from_fn(|k| at(k).im)) }
    }

    #[inline(always)]
    fn reflectance(&self, azimuth: f64, count: usize, out: &mut [f64]) {
        let parts = &self.stack.parts;
        let below = parts.iter().rposition(|part| !part.coherent).map_or(0, |slab| slab + 1);
        let mut reflection = vec![self.of_medium(&self.stack.back); self.stack.states];
        for part in parts[below..].iter().rev() {
            self.raise(part, azimuth, &mut reflection);
        }
        let above: Vec<Above> =
            parts[..below].iter().rev().flat_map(|part| self.above(part, azimuth)).collect();
        let slabs = above.iter().filter(|above| matches!(above, Above::Thick(..))).count();
        let points: usize = [1, 16, POINTS][slabs.min(2)];
        let face = self.of_front();
        for (state, below) in reflection.into_iter().enumerate() {
            let mut sum = Real::splat(0.0);
            for point in 0..points {
                let mut steps = GENERATOR.iter();
                let mut r = below;
                for above in &above {
                    r = match above {
                        Above::Coherent(all) => {
                            all[if all.len() == 1 { 0 } else { state }].over_reflection(r)
                        }
                        Above::Thick(face, waves) => {
                            let step = steps.next().copied().unwrap_or(1);
                            let turn = PI * (point * step % points) as f64 / points as f64;
                            thick(*face, *waves, turn).over_reflection(r)
                        }
                    };
                }
                sum = sum + unpolarised(face, r);
            }
            let mean = sum * Real::splat(1.0 / points as f64);
            for (k, value) in mean.0.into_iter().enumerate().take(count - self.first) {
                out[state * count + self.first + k] = value;
            }
        }
    }

    /// Returns the admittances of an isotropic medium over those of the reference.
    #[inline(always)]
    fn admittances(&self, index: Complex) -> [Complex; 2] {
        let square = index * index;
        let q = root(square - Complex::from(self.beta * self.beta));
        let p = (square * q.inverse()).scaled(self.inverse_root[0] * self.inverse_root[0]);
        [p, q.scaled(self.inverse_root[1] * self.inverse_root[1])]
    }

    /// Returns the reflection of a medium without anything above it.
    #[inline(always)]
    fn of_medium(&self, index: &[Complex64]) -> Pair {
        let [p, s] = face(self.admittances(self.complex(index)));
        Pair::diagonal(p, s)
    }

    /// Returns the admittances of the medium above.
    #[inline(always)]
    fn of_front(&self) -> [Real; 2] {
        let front = &self.stack.front;
        let n = Real(std::array::from_fn(|k| front[(self.first + k).min(front.len() - 1)]));
        let [p, s] = self.admittances(n.into());
        [p.re, s.re]
    }

    /// Replaces the reflection of what is below a part by that of both.
    #[inline(always)]
    fn raise(&self, part: &Part, azimuth: f64, reflection: &mut [Pair]) {
        let material = Material::new(self, part);
        let is_cell = part.slices.iter().any(|slices| slices.len() > 1);
        if !is_cell {
            for blocks in self.blocks(&material, part, azimuth).into_iter().enumerate() {
                let (state, blocks) = blocks;
                let own =
                    if part.slices.len() == 1 { &mut *reflection } else { &mut reflection[state..=state] };
                own.iter_mut().for_each(|r| *r = blocks.over_reflection(*r));
            }
            return;
        }
        for (state, r) in reflection.iter_mut().enumerate() {
            let slices = &part.slices[if part.slices.len() == 1 { 0 } else { state }];
            for slice in slices.iter().rev() {
                if material.absorbs {
                    *r = raised(&material.complex(self, slice, azimuth), self.depth(slice), *r);
                } else {
                    *r = raised(&material.real(self, slice, azimuth), self.depth(slice), *r);
                }
            }
        }
    }

    #[inline(always)]
    fn depth(&self, slice: &Slice) -> Real {
        self.k0 * Real::splat(slice.thickness_nm)
    }

    /// Returns the scattering matrices of a part, one for each list of slices.
    #[inline(always)]
    fn blocks(&self, material: &Material, part: &Part, azimuth: f64) -> Vec<Blocks> {
        let of_slices = |slices: &Vec<Slice>| {
            let mut all: Option<Blocks> = None;
            for slice in slices {
                let one = doubled(&material.complex(self, slice, azimuth), self.depth(slice));
                all = Some(all.map_or(one, |all| all.over(&one)));
            }
            let nothing = Pair::diagonal(Complex::zero(), Complex::zero());
            all.unwrap_or(Blocks { r: nothing, t: Pair::one(), r_below: nothing, t_up: Pair::one() })
        };
        part.slices.iter().map(of_slices).collect()
    }

    /// Returns what a part is above a thick layer or as one, from the bottom up.
    #[inline(always)]
    fn above(&self, part: &Part, azimuth: f64) -> Vec<Above> {
        let material = Material::new(self, part);
        if part.coherent {
            return vec![Above::Coherent(self.blocks(&material, part, azimuth))];
        }
        if material.biaxial || part.indices[0] != part.indices[1] {
            let one = Complex::splat(1.0);
            let third = Real::splat(1.0 / 3.0);
            let mean = root(material.square + (material.more[0] + material.more[1]).scaled(third));
            let gap = Above::Thick(face(self.admittances(mean)), [one, one]);
            return vec![gap, Above::Coherent(self.blocks(&material, part, azimuth))];
        }
        let index = self.complex(&part.indices[0]);
        let q = root(index * index - Complex::from(self.beta * self.beta));
        let phase = q.scaled(self.k0 * Real::splat(part.slices[0][0].thickness_nm));
        let decay = phase.im.map(|im| (-im).exp());
        // The phase itself is averaged.
        let wave = Complex::from(decay);
        vec![Above::Thick(face(self.admittances(index)), [wave, wave])]
    }
}

/// Returns the square root with Im >= 0.
#[inline(always)]
fn root(z: Complex) -> Complex {
    let values: [Complex64; LANES] = std::array::from_fn(|k| {
        let root = Complex64::new(z.re.0[k], z.im.0[k]).sqrt();
        if root.im < 0.0 { -root } else { root }
    });
    Complex { re: Real(values.map(|z| z.re)), im: Real(values.map(|z| z.im)) }
}

/// Returns the reflections of a face from the reference to a medium of these relative admittances. The fields of waves of p up are (-1,
/// 1), of s (1, -1).
#[inline(always)]
fn face([p, s]: [Complex; 2]) -> [Complex; 2] {
    let one = Complex::splat(1.0);
    [(p - one) * (p + one).inverse(), (one - s) * (one + s).inverse()]
}

/// Returns the scattering matrix of an isotropic slab whose waves have turned by another phase.
#[inline(always)]
fn thick(face: [Complex; 2], waves: [Complex; 2], turn: f64) -> Blocks {
    let one = Complex::splat(1.0);
    let (sin, cos) = turn.sin_cos();
    let turn = Complex { re: Real::splat(cos), im: Real::splat(sin) };
    let of = |face: Complex, wave: Complex| {
        let wave = wave * turn;
        let (r, square) = (face * face, wave * wave);
        let orders = (one - r * square).inverse();
        [face * (one - square) * orders, (one - r) * wave * orders]
    };
    let [p, s] = [of(face[0], waves[0]), of(face[1], waves[1])];
    let (r, t) = (Pair::diagonal(p[0], s[0]), Pair::diagonal(p[1], s[1]));
    Blocks { r, t, r_below: r, t_up: t }
}

/// Returns the reflectance for unpolarised light from a medium of these relative admittances.
#[inline(always)]
fn unpolarised(front: [Real; 2], r: Pair) -> Real {
    // Admittance below: H = Y E, with E' = (1 -+ r) rows.
    let [[pp, ps], [sp, ss]] = r.0;
    let one = Complex::splat(1.0);
    let e = [[one - pp, -ps], [sp, one + ss]];
    let h = [[one + pp, ps], [-sp, one - ss]];
    // Waves of unit power in the front, down and up: (E root(y) +- H/root(y))/2.
    let root = front.map(|y| y.map(f64::sqrt));
    let inverse = root.map(|root| root.inverse());
    let wave = |row: usize, sign: f64| {
        let of = |column: usize| {
            e[row][column].scaled(root[row]) + h[row][column].scaled(inverse[row] * Real::splat(sign))
        };
        [of(0), of(1)]
    };
    let down = Pair([wave(0, 1.0), wave(1, 1.0)]);
    let up = Pair([wave(0, -1.0), wave(1, -1.0)]) * down.inverse();
    let powers =
        up.0[0][0].norm_sqr() + up.0[0][1].norm_sqr() + up.0[1][0].norm_sqr() + up.0[1][1].norm_sqr();
    powers * Real::splat(0.5)
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
    #[inline(always)]
    fn new(group: &Group<'_>, part: &Part) -> Self {
        let [a, b, c] = part.indices.each_ref().map(|indices| {
            let index = group.complex(indices);
            index * index
        });
        let absorbs = part.indices.iter().flatten().any(|index| index.im != 0.0);
        Self { square: c, more: [a - c, b - c], biaxial: part.indices[1] != part.indices[2], absorbs }
    }

    #[inline(always)]
    fn complex(&self, group: &Group<'_>, slice: &Slice, azimuth: f64) -> Generator<Complex> {
        self.generator(group, (self.square, self.more), slice, azimuth)
    }

    #[inline(always)]
    fn real(&self, group: &Group<'_>, slice: &Slice, azimuth: f64) -> Generator<Real> {
        self.generator(group, (self.square.re, self.more.map(|more| more.re)), slice, azimuth)
    }

    #[inline(always)]
    fn generator<T: Element>(
        &self,
        group: &Group<'_>,
        (square, more): (T, [T; 2]),
        slice: &Slice,
        azimuth: f64,
    ) -> Generator<T> {
        let (sin, cos) = azimuth.sin_cos();
        // In the frame of the wave: x along its travel, z down, y = z x x.
        let turned =
            |axis: [f64; 3]| [cos * axis[0] + sin * axis[1], sin * axis[0] - cos * axis[1], -axis[2]];
        let (a, b) = (turned(slice.axes[0]), turned(slice.axes[1]));
        let element = |i: usize, k: usize| {
            let value = more[0].scaled(Real::splat(a[i] * a[k]));
            let value = if i == k { value + square } else { value };
            if self.biaxial { value + more[1].scaled(Real::splat(b[i] * b[k])) } else { value }
        };
        let [xx, yy, zz] = [element(0, 0), element(1, 1), element(2, 2)];
        let [xy, xz, yz] = [element(0, 1), element(0, 2), element(1, 2)];
        let (inverse, beta) = (zz.inverse(), group.beta);
        let ([p, s], [over_p, over_s]) = (group.root, group.inverse_root);
        let (x, y) = (xz * inverse, yz * inverse);
        let along = (T::real(Real::splat(0.0)) - x).scaled(beta);
        let across = (T::real(Real::splat(0.0)) - y).scaled(beta * p * over_s);
        let mixed = (xy - xz * y).scaled(over_p * over_s);
        Generator {
            along,
            across,
            mixed,
            electric: (T::real(Real::splat(1.0)) - inverse.scaled(beta * beta)).scaled(p * p),
            magnetic: (xx - xz * x).scaled(over_p * over_p),
            other: (yy - yz * y - T::real(beta * beta)).scaled(over_s * over_s),
            s: s * s,
        }
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
        let [along, across, mixed, electric, magnetic, other] =
            [along, across, mixed, electric, magnetic, other].map(|element| element.scaled(factor));
        Self { along, across, mixed, electric, magnetic, other, s: s * factor }
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
        rows.into_iter().fold(0.0, f64::max)
    }

    /// Returns the exponential of `-i` (upwards) or `i` times the matrix, times a field.
    #[inline(always)]
    fn exponential(&self, terms: usize, up: bool, field: [Complex; 4]) -> [Complex; 4] {
        let mut sum = field;
        let zero = [Complex::zero(); 4];
        for term in (1..=terms).rev() {
            let over = Real::splat(if up { 1.0 } else { -1.0 } / term as f64);
            let next = self.times(sum, zero);
            sum = std::array::from_fn(|k| field[k] + next[k].minus_i().scaled(over));
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
#[inline(always)]
fn doubled<T: Element>(generator: &Generator<T>, depth: Real) -> Blocks {
    let whole = generator.scaled(depth);
    let doublings = (whole.norm() / THIN).log2().ceil().max(0.0) as i32;
    let thin = whole.scaled(Real::splat(0.5_f64.powi(doublings)));
    let terms = terms(thin.norm());
    let (zero, half) = (Complex::zero(), Complex::splat(0.5));
    // Columns of the transfer matrix downwards, between waves: p and s down, p and s up.
    let columns = [
        [half, half, zero, zero],
        [zero, zero, half, half],
        [-half, half, zero, zero],
        [zero, zero, half, -half],
    ]
    .map(|wave| {
        let [a, b, c, d] = thin.exponential(terms, false, wave);
        [a + b, c + d, b - a, c - d]
    });
    let block = |row: usize, column: usize| {
        Pair([
            [columns[column][row], columns[column + 1][row]],
            [columns[column][row + 1], columns[column + 1][row + 1]],
        ])
    };
    let (down, from_up, from_down, t_up) = (block(0, 0), block(0, 2), block(2, 0), block(2, 2).inverse());
    let none = Pair::diagonal(zero, zero);
    let r = none - t_up * from_down;
    let mut layer = Blocks { r, t: down + from_up * r, r_below: from_up * t_up, t_up };
    for _ in 0..doublings {
        layer = layer.over(&layer);
    }
    layer
}
