//! Reflection of many wavelengths, directions and states: the fast implementation.
//!
//! The equations are those of [`jones`](super::jones), with several wavelengths in the lanes of a register. Fields are
//! relative to a medium of admittances `y` (p and s) close to those of the layers, so that waves down and up are
//! `(1, 1)` and `(-1, 1)` for p, `(1, 1)` and `(1, -1)` for s. What lies below is a 2x2 reflection matrix between them.
//!
//! - Slices of a cell below all thick slabs carry two fields up; before waves can have grown much, they become a reflection matrix again.
//! - Other layers become scattering matrices, once for all states that have them in common, and once for all azimuths where they are isotropic;
//!   turns of a helix by doubling ([`helix`](super::helix)).
//! - Light that crosses a thick layer a different number of times does not interfere: from the lowest thick layer up, reflections are actions on coherency
//!   matrices ([`incoherent`](super::incoherent)). An anisotropic layer keeps the phase between its two waves ([`thick`]).

mod faces;
mod material;
mod thick;

use std::f64::consts::{FRAC_1_SQRT_2, PI, SQRT_2};
use std::ops::Range;

use faces::{Faces, from_front, in_front, transparent};
use material::Material;
use num_complex::Complex64;
use thick::{Crossing, Thick, wave_down};

use super::generator::{Rising, layer};
use super::helix::{self, Turns};
use super::incoherent::{Action, Between, Light, actions, dot};
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
    /// How many of the first slices of a list follow once more: the rest of a turn.
    pub rest: usize,
    /// False for a thick layer without fringes. It must be one slice, the same in all states.
    pub coherent: bool,
}

/// Anisotropic layers over a substrate, at many wavelengths and in several states.
#[derive(Debug, Clone, PartialEq)]
pub struct SpectralStack {
    wavelength_nm: Vec<f64>,
    front: Vec<f64>,
    parts: Vec<Part>,
    lists: Vec<Vec<List>>,
    /// For each part below all thick layers, the combinations of lists of it and of what is below: the number of the latter, and the list.
    below: Vec<Vec<(usize, usize)>>,
    /// The thick layers from the bottom up, with the coherent parts above each.
    slabs: Vec<Slab>,
    /// The combination of each state.
    combination: Vec<usize>,
    back: Vec<Complex64>,
    states: usize,
}

/// What is known of a list of slices.
#[derive(Debug, Clone, Copy, PartialEq)]
struct List {
    /// The first list of the part that equals it.
    first_equal: usize,
    is_nothing: bool,
    /// Angle from each slice to the next, radians, if they are a helix.
    step: Option<f64>,
}

/// Thick layer, and the coherent parts from the next one above it, or from the top, down to it.
#[derive(Debug, Clone, PartialEq)]
struct Slab {
    part: usize,
    above: Range<usize>,
    /// The different choices of a list of each of these parts, and the combinations of one of them with what is below.
    choices: Vec<Vec<usize>>,
    combinations: Vec<(usize, usize)>,
}

impl SpectralStack {
    /// Builds a stack. `front` and `back` are the indices of the transparent medium above and of the one below, by wavelength.
    ///
    /// # Errors
    /// Arrays of different lengths, impossible indices, thicknesses or wavelengths; a thick layer that is not one
    /// slice; a rest of more slices than a turn has.
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
            let is_one_slice =
                part.slices.len() == 1 && part.slices[0].len() == 1 && (part.repeats, part.rest) == (1, 0);
            if !part.coherent && !is_one_slice {
                return Err(OpticsError::Axis { what: "a thick layer", expected: "one slice" });
            }
        }
        let lists: Vec<Vec<List>> = parts.iter().map(lists).collect();
        for (part, lists) in parts.iter().zip(&lists) {
            let mut own = part.slices.iter().zip(lists).filter(|(_, list)| !list.is_nothing);
            if let Some((slices, _)) = own.find(|(slices, _)| slices.len() < part.rest) {
                let (expected, found) = (slices.len(), part.rest);
                return Err(OpticsError::Length { what: "rest of a turn", expected, found });
            }
        }
        let lowest = parts.iter().rposition(|part| !part.coherent).map_or(0, |slab| slab + 1);
        let (mut below, mut combination) = (vec![Vec::new(); parts.len()], vec![0; states]);
        let of_state = |lists: &[List], state: usize| -> usize {
            let list = lists[if lists.len() == 1 { 0 } else { state }];
            // Lists of nothing are equal, whatever they are made of.
            lists.iter().position(|other| list.is_nothing && other.is_nothing).unwrap_or(list.first_equal)
        };
        for (number, lists) in lists.iter().enumerate().skip(lowest).rev() {
            for (state, combination) in combination.iter_mut().enumerate() {
                let own = (*combination, of_state(lists, state));
                *combination = number_of(&mut below[number], own);
            }
        }
        let mut slabs: Vec<Slab> = Vec::new();
        for part in (0..lowest).rev().filter(|part| !parts[*part].coherent) {
            let above =
                (0..part).rev().take_while(|above| parts[*above].coherent).last().unwrap_or(part)..part;
            let (mut choices, mut combinations) = (Vec::new(), Vec::new());
            for (state, combination) in combination.iter_mut().enumerate() {
                let choice = lists[above.clone()].iter().map(|lists| of_state(lists, state)).collect();
                let own = (*combination, number_of(&mut choices, choice));
                *combination = number_of(&mut combinations, own);
            }
            slabs.push(Slab { part, above, choices, combinations });
        }
        let (wavelength_nm, front, back) = (wavelength_nm.to_vec(), front.to_vec(), back.to_vec());
        Ok(Self {
            wavelength_nm,
            front,
            parts: parts.to_vec(),
            lists,
            below,
            slabs,
            combination,
            back,
            states,
        })
    }

    /// Returns the number of states.
    pub fn states(&self) -> usize {
        self.states
    }

    /// Prepares waves of `beta = n sin(theta)` at each wavelength.
    ///
    /// # Errors
    /// beta outside 0 <= beta < n of the medium above; another number of them than of wavelengths.
    pub fn at(&self, beta: &[f64]) -> Result<SpectralWaves<'_>, OpticsError> {
        let count = self.wavelength_nm.len();
        if beta.len() != count {
            return Err(OpticsError::Length { what: "beta", expected: count, found: beta.len() });
        }
        for (beta, n) in beta.iter().zip(&self.front) {
            if !(0.0..*n).contains(beta) {
                return Err(OpticsError::Beta { beta: *beta, limit: *n });
            }
        }
        let group = |first: usize| {
            let group = Group::new(self, first, beta);
            let materials = self.parts.iter().map(|part| Material::new(&group, part)).collect();
            let kept = self.parts.iter().map(|part| part.slices.iter().map(|_| Kept::default()).collect());
            (group, materials, kept.collect())
        };
        let groups = (0..count).step_by(LANES).map(group).collect();
        Ok(SpectralWaves { stack: self, groups })
    }

    /// Computes the reflectance for unpolarised light, `[azimuth][state][wavelength]`, of waves of `beta = n sin(theta)` at each wavelength
    /// that travel at these azimuths.
    ///
    /// # Errors
    /// As of [`at`](Self::at), and `out` of another length.
    pub fn reflectance(
        &self,
        beta: &[f64],
        azimuths_deg: &[f64],
        out: &mut [f64],
    ) -> Result<(), OpticsError> {
        self.at(beta)?.reflectance(azimuths_deg, out)
    }
}

/// Returns the number of a value, which is added unless it is known.
fn number_of<T: PartialEq>(known: &mut Vec<T>, value: T) -> usize {
    known.iter().position(|known| *known == value).unwrap_or_else(|| {
        known.push(value);
        known.len() - 1
    })
}

/// Returns what is known of the lists of slices of a part.
fn lists(part: &Part) -> Vec<List> {
    let all = &part.slices;
    let list = |k: usize| List {
        first_equal: (0..k).find(|first| all[*first] == all[k]).unwrap_or(k),
        is_nothing: all[k].iter().all(|slice| slice.thickness_nm == 0.0),
        step: if part.repeats > 0 { helix::step(&all[k]) } else { None },
    };
    (0..all.len()).map(list).collect()
}

/// Waves of one inclination in a stack, and what those of all azimuths have in common.
pub struct SpectralWaves<'a> {
    stack: &'a SpectralStack,
    groups: Vec<(Group<'a>, Vec<Material>, Vec<Vec<Kept>>)>,
}

/// What is kept of a list of slices for waves of other azimuths.
#[derive(Default)]
struct Kept {
    isotropic: Option<Blocks>,
    helix: Vec<Turns>,
}

impl SpectralWaves<'_> {
    /// Computes the reflectance for unpolarised light, `[azimuth][state][wavelength]`, of waves that travel at these azimuths.
    ///
    /// # Errors
    /// If `out` has another length.
    pub fn reflectance(&mut self, azimuths_deg: &[f64], out: &mut [f64]) -> Result<(), OpticsError> {
        let row = self.stack.states * self.stack.wavelength_nm.len();
        let (expected, found) = (azimuths_deg.len() * row, out.len());
        if found != expected {
            return Err(OpticsError::Length { what: "reflectances", expected, found });
        }
        for (group, materials, kept) in &mut self.groups {
            for (azimuth_deg, out) in azimuths_deg.iter().zip(out.chunks_exact_mut(row)) {
                group.reflectance((materials, kept), azimuth_deg.to_radians(), out);
            }
        }
        Ok(())
    }

    /// Computes the reflection of polarised light, `[azimuth][state][element][wavelength]`, of waves that travel at these azimuths: by rows, the
    /// [`ELEMENTS`](Self::ELEMENTS) of the matrix from the light that arrives to the light that leaves, each as `|p|^2`, `|s|^2`, `sqrt 2 Re(p s*)`
    /// and `sqrt 2 Im(p s*)`.
    ///
    /// # Errors
    /// If `out` has another length.
    pub fn actions(&mut self, azimuths_deg: &[f64], out: &mut [f64]) -> Result<(), OpticsError> {
        let row = Self::ELEMENTS * self.stack.states * self.stack.wavelength_nm.len();
        let (expected, found) = (azimuths_deg.len() * row, out.len());
        if found != expected {
            return Err(OpticsError::Length { what: "reflections", expected, found });
        }
        for (group, materials, kept) in &mut self.groups {
            for (azimuth_deg, out) in azimuths_deg.iter().zip(out.chunks_exact_mut(row)) {
                group.actions((materials, kept), azimuth_deg.to_radians(), out);
            }
        }
        Ok(())
    }

    /// Number of elements of the matrix of [`actions`](Self::actions).
    pub const ELEMENTS: usize = 16;
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

/// What is asked of a stack.
trait Asked {
    type Found;
    /// Of a reflection.
    fn of(&self, reflection: &Action) -> Self::Found;
    /// Of layers over a reflection.
    fn of_layers(&self, above: &Between, below: &Action) -> Self::Found;
}

/// What a meter sees of light.
struct Seen {
    light: Light,
    meter: Light,
}

impl Asked for Seen {
    type Found = Real;
    fn of(&self, reflection: &Action) -> Real {
        dot(self.meter, reflection.on(self.light))
    }
    fn of_layers(&self, above: &Between, below: &Action) -> Real {
        above.seen(below, self.light, self.meter)
    }
}

/// The whole reflection.
struct Whole;

impl Asked for Whole {
    type Found = Action;
    fn of(&self, reflection: &Action) -> Action {
        *reflection
    }
    fn of_layers(&self, above: &Between, below: &Action) -> Action {
        above.over(below)
    }
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
        let inverse_root = [root[0].inverse(), root[1].inverse()];
        let n = loaded(&stack.front, first);
        let of_front = (n * n - square).root();
        let admittances = [n * n * of_front.inverse(), of_front];
        let front = [0, 1].map(|k| admittances[k] * inverse_root[k] * inverse_root[k]);
        Self { stack, first, k0, beta, root, inverse_root, front }
    }

    fn complex(&self, values: &[Complex64]) -> Complex {
        let mut out = Complex::zero();
        for k in 0..LANES {
            let value = values[(self.first + k).min(values.len() - 1)];
            (out.re.0[k], out.im.0[k]) = (value.re, value.im);
        }
        out
    }

    fn reflectance(&self, parts: (&[Material], &mut [Vec<Kept>]), azimuth: f64, out: &mut [f64]) {
        let [half, one, none] = [0.5, 1.0, 0.0].map(Real::splat);
        let (light, meter) = ([half, half, none, none], [one, one, none, none]);
        let seen = self.reflections(parts, azimuth, &Seen { light, meter });
        let count = self.stack.wavelength_nm.len();
        let last = (count - self.first).min(LANES);
        for (state, combination) in self.stack.combination.iter().enumerate() {
            out[state * count + self.first..][..last].copy_from_slice(&seen[*combination].0[..last]);
        }
    }

    fn actions(&self, parts: (&[Material], &mut [Vec<Kept>]), azimuth: f64, out: &mut [f64]) {
        let whole = self.reflections(parts, azimuth, &Whole);
        let count = self.stack.wavelength_nm.len();
        let last = (count - self.first).min(LANES);
        for (state, combination) in self.stack.combination.iter().enumerate() {
            for (element, value) in whole[*combination].0.iter().flatten().enumerate() {
                // From Re and Im to sqrt 2 of them.
                let factor = match (element / 4 < 2, element % 4 < 2) {
                    (true, false) => FRAC_1_SQRT_2,
                    (false, true) => SQRT_2,
                    _ => 1.0,
                };
                let place = (state * SpectralWaves::ELEMENTS + element) * count + self.first;
                let row = out[place..][..last].iter_mut().zip(value.0);
                row.for_each(|(out, value)| *out = factor * value);
            }
        }
    }

    /// Returns what is asked of the whole stack, for each combination.
    fn reflections<A: Asked>(
        &self,
        (materials, kept): (&[Material], &mut [Vec<Kept>]),
        azimuth: f64,
        asked: &A,
    ) -> Vec<A::Found> {
        let slabs = &self.stack.slabs;
        let below = slabs.first().map_or(0, |slab| slab.part + 1);
        let mut amplitudes = vec![self.faces(self.complex(&self.stack.back)).r];
        for (number, material) in materials.iter().enumerate().skip(below).rev() {
            amplitudes = self.raised(number, (material, &mut kept[number]), azimuth, &amplitudes);
        }
        match slabs.is_empty() {
            true => amplitudes.iter().map(|r| asked.of(&actions([in_front(self.front, *r)])[0])).collect(),
            false => self.through_slabs((materials, kept), azimuth, &amplitudes, asked),
        }
    }

    /// Returns what is asked of thick layers above these reflections, for each combination.
    fn through_slabs<A: Asked>(
        &self,
        (materials, kept): (&[Material], &mut [Vec<Kept>]),
        azimuth: f64,
        amplitudes: &[Pair],
        asked: &A,
    ) -> Vec<A::Found> {
        let slabs = &self.stack.slabs;
        let thick = |slab: &Slab| {
            let slice = self.stack.parts[slab.part].slices[0][0];
            materials[slab.part].thick(self, &slice, azimuth)
        };
        let mut own = thick(&slabs[0]);
        // What is below as the light inside the thick layer above it sees it: amplitudes down to the lowest one.
        let mut seen = Vec::with_capacity(amplitudes.len());
        with_widest_simd(
            #[inline(always)]
            || {
                let face = own.faces.left();
                for r in amplitudes {
                    seen.push(face.over_reflection(*r));
                }
            },
        );
        let mut below: Vec<Action> = Vec::new();
        let mut joined_below: Option<Crossing> = None;
        for (number, slab) in slabs.iter().enumerate() {
            let Thick { faces, mut crossing } = own;
            if let Some(lower) = joined_below.take() {
                crossing = Crossing { down: lower.down * crossing.down, up: crossing.up * lower.up };
            }
            let next = slabs.get(number + 1).map(thick);
            let all = match next {
                Some(next) if slab.above.is_empty() => {
                    let face = next.faces.left().over(&faces.entered());
                    own = next;
                    if let Some([through, back]) = transparent(&face) {
                        let (down, up) = (crossing.down * through, back * crossing.up);
                        joined_below = Some(Crossing { down, up });
                        continue;
                    }
                    vec![Between::new(&face); slab.choices.len()]
                }
                next => {
                    let top = next.map_or_else(|| from_front(self.front), |next| next.faces.left());
                    own = next.unwrap_or(own);
                    self.between(slab, (top, faces.entered()), (materials, kept), azimuth)
                }
            };
            let Crossing { down, up } = crossing;
            let inside: Vec<Action> = if below.is_empty() {
                seen.iter().map(|r| actions([up * (*r * down)])[0]).collect()
            } else {
                let [down, up] = actions([down, up]);
                below.iter().map(|r| up.times(&r.times(&down))).collect()
            };
            let combinations = slab.combinations.iter();
            if number + 1 == slabs.len() {
                return combinations
                    .map(|(below, own)| asked.of_layers(&all[*own], &inside[*below]))
                    .collect();
            }
            below = combinations.map(|(below, own)| all[*own].over(&inside[*below])).collect();
        }
        Vec::new()
    }

    /// Returns the coherent layers above a thick layer, between faces above and below them, for each choice of their lists.
    fn between(
        &self,
        slab: &Slab,
        (top, bottom): (Blocks, Blocks),
        (materials, kept): (&[Material], &mut [Vec<Kept>]),
        azimuth: f64,
    ) -> Vec<Between> {
        let parts: Vec<Vec<Blocks>> = slab
            .above
            .clone()
            .map(|number| {
                let mut blocks = Vec::with_capacity(self.stack.parts[number].slices.len());
                self.blocks(number, (&materials[number], &mut kept[number]), azimuth, &mut blocks);
                blocks
            })
            .collect();
        let of_choice = |choice: &Vec<usize>| {
            let mut all = top;
            for ((list, blocks), number) in choice.iter().zip(&parts).zip(slab.above.clone()) {
                if !self.stack.lists[number][*list].is_nothing {
                    all = all.over(&blocks[*list]);
                }
            }
            Between::new(&all.over(&bottom))
        };
        slab.choices.iter().map(of_choice).collect()
    }

    /// Returns the faces of an isotropic medium.
    fn faces(&self, index: Complex) -> Faces {
        // The admittance of p, n^2/q, is infinite for waves along the face.
        let square = index * index;
        let q = wave_down(square - Complex::from(self.beta * self.beta));
        let (p, s) = (q.scaled(self.root[0] * self.root[0]), Complex::from(self.root[1] * self.root[1]));
        Faces::isotropic([(square - p) * (square + p).inverse(), (s - q) * (s + q).inverse()])
    }

    /// Returns the reflections of a part over each combination of what is below it.
    fn raised(
        &self,
        number: usize,
        (material, kept): (&Material, &mut [Kept]),
        azimuth: f64,
        below: &[Pair],
    ) -> Vec<Pair> {
        let (part, lists) = (&self.stack.parts[number], &self.stack.lists[number]);
        let combinations = &self.stack.below[number];
        let mut raised = Vec::with_capacity(combinations.len());
        let as_blocks = part.repeats != 1
            || part.rest > 0
            || material.absorbs
            || part.slices.iter().all(|slices| slices.len() <= 1);
        if as_blocks {
            let mut blocks = Vec::with_capacity(part.slices.len());
            self.blocks(number, (material, kept), azimuth, &mut blocks);
            with_widest_simd(
                #[inline(always)]
                || {
                    for (of_below, list) in combinations {
                        raised.push(match lists[*list].is_nothing {
                            true => below[*of_below],
                            false => blocks[*list].over_reflection(below[*of_below]),
                        });
                    }
                },
            );
            return raised;
        }
        with_widest_simd(
            #[inline(always)]
            || {
                for (of_below, list) in combinations {
                    let mut waves = Rising::new(below[*of_below]);
                    for slice in part.slices[*list].iter().rev() {
                        let generator = material.real(self, slice, azimuth);
                        let (depth, growth) = self.depth(material, slice);
                        waves.raise(&generator, depth, growth);
                    }
                    raised.push(waves.reflection());
                }
            },
        );
        raised
    }

    /// Returns k0 d of a slice, and the exponent by which waves grow in it at most.
    #[inline(always)]
    fn depth(&self, material: &Material, slice: &Slice) -> (Real, f64) {
        let depth = self.k0 * Real::splat(slice.thickness_nm);
        (depth, if material.grows { (depth * material.rate).max() } else { 0.0 })
    }

    /// Returns the scattering matrix of a slice.
    fn layer(&self, material: &Material, slice: &Slice, azimuth: f64) -> Blocks {
        let (depth, growth) = self.depth(material, slice);
        let (mut whole, doublings) = with_widest_simd(
            #[inline(always)]
            || match material.absorbs {
                true => layer(&material.complex(self, slice, azimuth), depth, growth),
                false => layer(&material.real(self, slice, azimuth), depth, growth),
            },
        );
        for _ in 0..doublings {
            whole = whole.over(&whole);
        }
        whole
    }

    /// Adds the scattering matrices of a part, one for each list of slices. Those of equal lists are computed once.
    fn blocks(
        &self,
        number: usize,
        (material, kept): (&Material, &mut [Kept]),
        azimuth: f64,
        out: &mut Vec<Blocks>,
    ) {
        let (part, lists) = (&self.stack.parts[number], &self.stack.lists[number]);
        for (slices, (list, kept)) in part.slices.iter().zip(lists.iter().zip(kept)) {
            if list.first_equal < out.len() {
                out.push(out[list.first_equal]);
                continue;
            }
            let of_slices =
                |azimuth: f64| slices.iter().map(move |slice| self.layer(material, slice, azimuth));
            out.push(if list.is_nothing {
                Blocks::nothing()
            } else if material.isotropic {
                let once = || helix::repeated(of_slices(azimuth), part.repeats, part.rest);
                *kept.isotropic.get_or_insert_with(once)
            } else if let Some(step) = list.step {
                let count = slices.len();
                let known = kept.helix.iter().position(|turns| turns.start(azimuth, step).is_some());
                let known = known.unwrap_or_else(|| {
                    kept.helix.push(Turns::new(azimuth, of_slices(azimuth)));
                    kept.helix.len() - 1
                });
                let turns = &mut kept.helix[known];
                turns.blocks(turns.start(azimuth, step).unwrap_or(0), count * part.repeats + part.rest)
            } else {
                helix::repeated(of_slices(azimuth), part.repeats, part.rest)
            });
        }
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

/// Returns the square root of a wave down, or of one that decays downwards: Re + Im >= 0.
fn root(z: Complex) -> Complex {
    let mut out = z;
    for k in 0..LANES {
        let root = Complex64::new(z.re.0[k], z.im.0[k]).sqrt();
        let root = if root.re + root.im < 0.0 { -root } else { root };
        (out.re.0[k], out.im.0[k]) = (root.re, root.im);
    }
    out
}
