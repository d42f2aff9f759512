//! Reflectance of many wavelengths, directions and states for unpolarised light: the fast implementation.
//!
//! The equations are those of [`jones`](super::jones), with several wavelengths in the lanes of a register. Fields are
//! relative to a medium of admittances `y` (p and s) close to those of the layers, so that waves down and up are
//! `(1, 1)` and `(-1, 1)` for p, `(1, 1)` and `(1, -1)` for s. What lies below is a 2x2 reflection matrix between them.
//!
//! - Slices of a cell below all thick slabs carry two fields up; before waves can have grown much, they become a reflection matrix again.
//! - Other layers become scattering matrices, once for all states that have them in common; turns of a helix by doubling.
//! - A thick layer without fringes is the mean over the phase of its waves: of one layer at 16 points, so that the light of 15 round trips
//!   between its faces is exact; of several at the points of a lattice, exact for light that one or two faces return. An anisotropic
//!   layer keeps the phase between its two waves, and has the faces of its mean index.

use std::f64::consts::{FRAC_PI_4, PI};

use num_complex::Complex64;

use super::generator::{Generator, Rising, layer};
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
    /// How often the slices of a list follow each other: the turns of a helix. 1 for a thick layer.
    pub repeats: usize,
    /// False for a thick layer without fringes. It must be one slice, the same in all states, with indices that are close to each other.
    pub coherent: bool,
}

/// Anisotropic layers over a substrate, at many wavelengths and in several states.
#[derive(Debug, Clone, PartialEq)]
pub struct SpectralStack {
    wavelength_nm: Vec<f64>,
    front: Vec<f64>,
    parts: Vec<Part>,
    /// For each list of slices of a part, the first one that equals it.
    first_equal: Vec<Vec<usize>>,
    back: Vec<Complex64>,
    states: usize,
}

/// Largest number of thick layers.
pub const MOST_SLABS: usize = 8;

/// Points of the lattices over the phases of up to 1, 3, 4 and 8 thick layers, and the steps of each layer. The phases of two faces differ by the sum of the
/// steps between them: the sums from the first layer on are a perfect difference set (J. Singer, 1938), so that no difference of two of them
/// occurs twice.
const LATTICES: [(usize, [usize; MOST_SLABS]); 4] = [
    (16, [1, 0, 0, 0, 0, 0, 0, 0]),
    (13, [1, 2, 6, 0, 0, 0, 0, 0]),
    (21, [1, 3, 10, 2, 0, 0, 0, 0]),
    (73, [1, 2, 4, 8, 16, 5, 18, 9]),
];

/// Reflectance of a face between thick layers that does not matter.
const NO_FACE: f64 = 1e-6;

/// Bound of the rate at which waves grow over that of waves along the principal axes.
const GROWTH: f64 = 1.5;

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
            let is_one_slice = part.slices.len() == 1 && part.slices[0].len() == 1 && part.repeats == 1;
            if !part.coherent && !is_one_slice {
                return Err(OpticsError::Axis { what: "a thick layer", expected: "one slice" });
            }
        }
        if parts.iter().filter(|part| !part.coherent).count() > MOST_SLABS {
            return Err(OpticsError::Axis { what: "thick layers", expected: "eight at most" });
        }
        let first_equal = |part: &Part| -> Vec<usize> {
            let all = &part.slices;
            (0..all.len()).map(|k| (0..k).find(|first| all[*first] == all[k]).unwrap_or(k)).collect()
        };
        let first_equal = parts.iter().map(first_equal).collect();
        let (wavelength_nm, front, back) = (wavelength_nm.to_vec(), front.to_vec(), back.to_vec());
        Ok(Self { wavelength_nm, front, parts: parts.to_vec(), first_equal, back, states })
    }

    /// Returns the number of states.
    pub fn states(&self) -> usize {
        self.states
    }

    /// Computes the reflectance for unpolarised light, `[azimuth][state][wavelength]`, of waves of `beta = n sin(theta)` at each wavelength
    /// that travel at these azimuths.
    ///
    /// # Errors
    /// beta outside 0 <= beta < n of the medium above; arrays of other lengths.
    pub fn reflectance(
        &self,
        beta: &[f64],
        azimuths_deg: &[f64],
        out: &mut [f64],
    ) -> Result<(), OpticsError> {
        let count = self.wavelength_nm.len();
        let all = azimuths_deg.len() * self.states * count;
        for (what, expected, found) in [("beta", count, beta.len()), ("reflectances", all, out.len())] {
            if found != expected {
                return Err(OpticsError::Length { what, expected, found });
            }
        }
        for (beta, n) in beta.iter().zip(&self.front) {
            if !(0.0..*n).contains(beta) {
                return Err(OpticsError::Beta { beta: *beta, limit: *n });
            }
        }
        let phases: Vec<Phases> = (0..=MOST_SLABS).map(Phases::new).collect();
        for first in (0..count).step_by(LANES) {
            let group = Group::new(self, first, beta);
            let materials: Vec<Material> =
                self.parts.iter().map(|part| Material::new(&group, part)).collect();
            for (azimuth_deg, out) in azimuths_deg.iter().zip(out.chunks_exact_mut(self.states * count)) {
                group.reflectance(&materials, &phases, azimuth_deg.to_radians(), out);
            }
        }
        Ok(())
    }
}

/// Phases of the waves in thick layers.
struct Phases {
    /// Number of points of the lattice, the steps of each layer, and the phase factors of multiples of a step.
    points: usize,
    steps: [usize; MOST_SLABS],
    turns: Vec<Complex64>,
}

impl Phases {
    fn new(slabs: usize) -> Self {
        let (points, steps) = match slabs {
            0 => (1, LATTICES[0].1),
            1 => LATTICES[0],
            2 | 3 => LATTICES[1],
            4 => LATTICES[2],
            _ => LATTICES[3],
        };
        let turn = |k: usize| Complex64::cis(2.0 * PI * k as f64 / points as f64);
        Self { points, steps, turns: (0..points).map(turn).collect() }
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
    /// Admittances of the medium above over those of the reference.
    front: [Real; 2],
}

/// What is above the lowest thick layer.
#[allow(clippy::large_enum_variant, reason = "there are a few layers")]
enum Above {
    /// One scattering matrix for each state, or one for all.
    Coherent(Vec<Blocks>),
    /// Thick layers whose faces to each other reflect nothing: reflections p and s of a face from the reference to the uppermost and to the
    /// lowest, and their transmission down and up without faces.
    Thick { top: [Complex; 2], bottom: [Complex; 2], down: Pair, up: Pair },
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
        let (inverse_root, front) = ([root[0].inverse(), root[1].inverse()], [s; 2]);
        let mut group = Self { stack, first, k0, beta, root, inverse_root, front };
        group.front = group.admittances(loaded(&stack.front, first).into()).map(|front| front.re);
        group
    }

    fn complex(&self, values: &[Complex64]) -> Complex {
        let mut out = Complex::zero();
        for k in 0..LANES {
            let value = values[(self.first + k).min(values.len() - 1)];
            (out.re.0[k], out.im.0[k]) = (value.re, value.im);
        }
        out
    }

    fn reflectance(&self, materials: &[Material], phases: &[Phases], azimuth: f64, out: &mut [f64]) {
        let (parts, count) = (&self.stack.parts, self.stack.wavelength_nm.len());
        let below = parts.iter().rposition(|part| !part.coherent).map_or(0, |slab| slab + 1);
        let mut reflection = vec![self.of_medium(&self.stack.back); self.stack.states];
        for (number, material) in materials.iter().enumerate().skip(below).rev() {
            self.raise(number, material, azimuth, &mut reflection);
        }
        let mut above = Vec::new();
        for (number, material) in materials.iter().enumerate().take(below).rev() {
            self.above(number, material, azimuth, &mut above);
        }
        let slabs = above.iter().filter(|part| matches!(part, Above::Thick { .. })).count();
        let Phases { points, steps, turns } = &phases[slabs];
        let last = (count - self.first).min(LANES);
        for (state, reflection) in reflection.iter().enumerate() {
            let mut sum = Real::splat(0.0);
            with_widest_simd(
                #[inline(always)]
                || {
                    for point in 0..*points {
                        let mut slab = 0;
                        let mut r = *reflection;
                        for above in &above {
                            r = match above {
                                Above::Coherent(all) => {
                                    all[if all.len() == 1 { 0 } else { state }].over_reflection(r)
                                }
                                Above::Thick { top, bottom, down, up } => {
                                    slab += 1;
                                    let turn = Complex::of(turns[point * steps[slab - 1] % points]);
                                    let inside = out_of_medium(*bottom, r);
                                    let inside = (*up * inside) * (*down * Pair::diagonal(turn, turn));
                                    medium_over(*top, inside)
                                }
                            };
                        }
                        sum = sum + unpolarised(self.front, r);
                    }
                },
            );
            let mean = sum * Real::splat(1.0 / *points as f64);
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

    /// Replaces the reflection of what is below a part by that of both.
    fn raise(&self, number: usize, material: &Material, azimuth: f64, reflection: &mut [Pair]) {
        let part = &self.stack.parts[number];
        let is_one = part.slices.len() == 1;
        if part.repeats > 1 || material.absorbs || part.slices.iter().all(|slices| slices.len() <= 1) {
            let mut blocks = Vec::with_capacity(part.slices.len());
            self.blocks(number, material, azimuth, &mut blocks);
            for (state, r) in reflection.iter_mut().enumerate() {
                *r = blocks[if is_one { 0 } else { state }].over_reflection(*r);
            }
            return;
        }
        for (state, below) in reflection.iter_mut().enumerate() {
            let slices = &part.slices[if is_one { 0 } else { state }];
            with_widest_simd(
                #[inline(always)]
                || {
                    let mut waves = Rising::new(*below);
                    for slice in slices.iter().rev() {
                        let generator = material.real(self, slice, azimuth);
                        let (depth, growth) = self.depth(material, slice);
                        waves.raise(&generator, depth, growth);
                    }
                    *below = waves.reflection();
                },
            );
        }
    }

    /// Returns k0 d of a slice, and the exponent by which waves grow in it at most.
    #[inline(always)]
    fn depth(&self, material: &Material, slice: &Slice) -> (Real, f64) {
        let depth = self.k0 * Real::splat(slice.thickness_nm);
        (depth, if material.grows { (depth * material.rate).max() } else { 0.0 })
    }

    /// Returns the scattering matrix of a slice.
    fn layer(&self, material: &Material, slice: &Slice, azimuth: f64, more: Real) -> Blocks {
        let (depth, growth) = self.depth(material, slice);
        with_widest_simd(
            #[inline(always)]
            || layer(&material.complex(self, slice, azimuth), depth + more, growth),
        )
    }

    /// Adds the scattering matrices of a part, one for each list of slices. Those of equal lists are computed once, those of many turns by
    /// doubling.
    fn blocks(&self, number: usize, material: &Material, azimuth: f64, out: &mut Vec<Blocks>) {
        let part = &self.stack.parts[number];
        for (slices, first) in part.slices.iter().zip(&self.stack.first_equal[number]) {
            if *first < out.len() {
                out.push(out[*first]);
                continue;
            }
            let mut once = Blocks::nothing();
            for (number, slice) in slices.iter().enumerate() {
                let one = self.layer(material, slice, azimuth, Real::splat(0.0));
                once = if number == 0 { one } else { joined(&once, &one) };
            }
            let (mut all, mut left) = (None, part.repeats);
            loop {
                if left % 2 == 1 {
                    all = Some(all.map_or(once, |all| joined(&all, &once)));
                }
                left /= 2;
                if left == 0 {
                    break;
                }
                once = joined(&once, &once);
            }
            out.push(all.unwrap_or_else(Blocks::nothing));
        }
    }

    /// Adds what a part is above a thick layer or as one, from the bottom up.
    fn above(&self, number: usize, material: &Material, azimuth: f64, out: &mut Vec<Above>) {
        let part = &self.stack.parts[number];
        let Some(slice) = part.slices.first().and_then(|slices| slices.first()).filter(|_| !part.coherent)
        else {
            let mut blocks = Vec::with_capacity(part.slices.len());
            self.blocks(number, material, azimuth, &mut blocks);
            out.push(Above::Coherent(blocks));
            return;
        };
        let Thick { faces, wave, eighth, turn } = material.thick;
        let mut add = |down: Pair, up: Pair| {
            if let Some(Above::Thick { top, down: lower, up: raised, .. }) = out.last_mut()
                && let Some([through, back]) = transparent_face(faces, *top)
            {
                (*top, *lower, *raised) = (faces, *lower * through * down, up * back * *raised);
                return;
            }
            out.push(Above::Thick { top: faces, bottom: faces, down, up });
        };
        let depth = self.k0 * Real::splat(slice.thickness_nm);
        if material.isotropic {
            let wave = wave.scaled(depth).wave();
            let both = Pair::diagonal(wave, wave);
            add(both, both);
            return;
        }
        // The mean of two thicknesses that differ by a quarter wave, whose phase is undone: what the faces of the layer itself reflect to each
        // other has opposite signs in both.
        let zero = Complex::zero();
        let (mut down, mut up) = (Pair::diagonal(zero, zero), Pair::diagonal(zero, zero));
        for sign in [1.0, -1.0] {
            let layer = self.layer(material, slice, azimuth, eighth * Real::splat(sign));
            let inside = joined(&joined(&from_medium(faces), &layer), &into_medium(faces));
            let phase = Complex { re: turn.re, im: turn.im * Real::splat(-sign) };
            let phase = Pair::diagonal(phase, phase);
            (down, up) = (down + inside.t * phase, up + inside.t_up * phase);
        }
        add(down, up);
    }
}

/// Returns two scattering matrices as one.
fn joined(above: &Blocks, below: &Blocks) -> Blocks {
    with_widest_simd(
        #[inline(always)]
        || above.over(below),
    )
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
#[inline(always)]
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
#[inline(always)]
fn from_medium([p, s]: [Complex; 2]) -> Blocks {
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
fn transparent_face(above: [Complex; 2], below: [Complex; 2]) -> Option<[Pair; 2]> {
    let one = Complex::splat(1.0);
    let over = [0, 1].map(|k| (one - above[k] * below[k]).inverse());
    let is_faint = |k: usize| ((above[k] - below[k]) * over[k]).norm_sqr().max() < NO_FACE;
    let passed =
        |by: [Complex; 2]| Pair::diagonal((one - by[0] * by[0]) * over[0], (one - by[1] * by[1]) * over[1]);
    (is_faint(0) && is_faint(1)).then(|| [passed(above), passed(below)])
}

/// Returns `r` as waves of a medium see it, from its reflections to the reference: `-f + r (1 - f r)^-1 (1 - f^2)`.
#[inline(always)]
fn out_of_medium([p, s]: [Complex; 2], r: Pair) -> Pair {
    let [[pp, ps], [sp, ss]] = r.0;
    let one = Complex::splat(1.0);
    let determinant = pp * ss - ps * sp;
    let scale = (one - p * pp - s * ss + p * s * determinant).inverse();
    let (by_p, by_s) = ((one - p * p) * scale, (one - s * s) * scale);
    Pair([[(pp - s * determinant) * by_p - p, ps * by_s], [sp * by_p, (ss - p * determinant) * by_s - s]])
}

/// Returns the reflection of a medium with `r` inside, as waves of the reference see it: `f + (1 - f^2) r (1 + f r)^-1`.
#[inline(always)]
fn medium_over([p, s]: [Complex; 2], r: Pair) -> Pair {
    let [[pp, ps], [sp, ss]] = r.0;
    let one = Complex::splat(1.0);
    let determinant = pp * ss - ps * sp;
    let scale = (one + p * pp + s * ss + p * s * determinant).inverse();
    let (by_p, by_s) = ((one - p * p) * scale, (one - s * s) * scale);
    Pair([[(pp + s * determinant) * by_p + p, ps * by_p], [sp * by_s, (ss + p * determinant) * by_s + s]])
}

/// Returns the reflectance for unpolarised light from a medium of these relative admittances.
#[inline(always)]
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

/// What waves of any azimuth have in common in a part.
struct Material {
    /// Square of the principal index along the third axis, and what those along the first and second have in addition.
    square: Complex,
    more: [Complex; 2],
    biaxial: bool,
    isotropic: bool,
    absorbs: bool,
    /// Bound of the rate at which waves grow, over k0.
    rate: Real,
    grows: bool,
    thick: Thick,
}

/// A part as a thick layer.
#[derive(Clone, Copy)]
struct Thick {
    /// Reflections of a face from the reference to a medium of its mean index, p and s.
    faces: [Complex; 2],
    /// Wave vector along the normal in that medium, over k0.
    wave: Complex,
    /// k0 d of an eighth of a wave, and half of its phase factor.
    eighth: Real,
    turn: Complex,
}

impl Material {
    fn new(group: &Group<'_>, part: &Part) -> Self {
        let indices = part.indices.each_ref().map(|index| group.complex(index));
        let [a, b, c] = indices.map(|index| index * index);
        let more = [a - c, b - c];
        let absorbs = indices.iter().any(|index| index.im.size().max() > 0.0);
        let along = [a, b, c].map(|square| root(square - Complex::from(group.beta * group.beta)).im);
        let rate = along[0].larger(along[1]).larger(along[2]) * Real::splat(GROWTH);
        let is_zero = |value: Complex| value.norm_sqr().max() == 0.0;
        let [biaxial, isotropic] = [!is_zero(more[1]), is_zero(more[0]) && is_zero(more[1])];
        let mean = root(c + (more[0] + more[1]).scaled(Real::splat(1.0 / 3.0)));
        let wave = root(mean * mean - Complex::from(group.beta * group.beta));
        let eighth = wave.re.at_least(0.1).inverse() * Real::splat(FRAC_PI_4);
        let turn = Complex::from(wave.re * eighth).wave().scaled(Real::splat(0.5));
        let thick = Thick { faces: face(group.admittances(mean)), wave, eighth, turn };
        Self { square: c, more, biaxial, isotropic, absorbs, rate, grows: rate.max() > 0.0, thick }
    }

    #[inline(always)]
    fn complex(&self, group: &Group<'_>, slice: &Slice, azimuth: f64) -> Generator<Complex> {
        generator(group, self.square, self.more, self.biaxial, (slice, azimuth))
    }

    #[inline(always)]
    fn real(&self, group: &Group<'_>, slice: &Slice, azimuth: f64) -> Generator<Real> {
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
