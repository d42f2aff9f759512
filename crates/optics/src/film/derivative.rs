//! Derivatives of the reflectance, the mean of s and p or that of one, with respect to all layers at once.
//!
//! **Model.** The change of R with the thickness of a layer (per nm) and with n or k of a medium (per 1, the
//! same at all wavelengths), exact to rounding.
//!
//! **Method.** Let a and b be the reflected and the incident wave as forms of the fields at the top of a
//! layer, F the field at its bottom, M its matrix: `r = (a M F)/(b M F)`. If M changes by dM, then, by the
//! Cauchy-Binet formula,
//!
//! `dr = det(a, b) det(dM F, M F)/(b M F)^2`.
//!
//! Forms are propagated down once and fields up once; every layer then costs a few products, however many
//! there are. Common factors of forms, fields and matrices cancel between numerator and denominator, so all
//! of these may be scaled at will, as the kernel does. With `q^2 = n^2 - beta^2`, g = 1 (s) or n^2 (p), D =
//! k0 d, `S = sin(q D)/q` and `c = cos(q D)`:
//! - thickness: `dM = -i k0 (0, g; q^2/g, 0) M`;
//! - index: `c' = -n D S` and `S' = 2 n T`, `T = (D c - S)/(2 q^2)`, a series where q D is small. The field
//!   of the substrate is (1, q/g), and its change (0, (q/g)').
//!
//! r is analytic in n + ik: the derivative by k is i times that by n.
//!
//! **Range.** As the reflectance: any passive layers, total reflection, thickness 0. If q of a medium is 0
//! the derivative by the substrate diverges, as it does in theory.
//!
//! Source: M. Born, E. Wolf, "Principles of Optics", 7th ed., section 1.6, differentiated.

use pulp::{Simd, WithSimd};

use super::coherent::Polarisation;
use super::forms::{Absorbing, Carried, Field, Form, Pair, Transfer};
use super::kernel::Direction;
use super::lanes::{Complex, Lanes};
use super::media::{Media, Medium, load};

/// Variable by which a film's reflectance is differentiated. Layers are counted from 0, including the gap,
/// in the order in which the light meets them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Variable {
    /// Thickness of a layer; for the gap layer, the gap. Per nm.
    Thickness(usize),
    /// n of a layer, shifted the same at all wavelengths.
    Index(usize),
    /// k of a layer, shifted the same at all wavelengths.
    Extinction(usize),
    /// n of the substrate, shifted the same at all wavelengths.
    SubstrateIndex,
    /// k of the substrate, shifted the same at all wavelengths.
    SubstrateExtinction,
}

impl Variable {
    /// Returns the layer to which it belongs; `None`: the substrate.
    pub(super) fn layer(self) -> Option<usize> {
        match self {
            Self::Thickness(layer) | Self::Index(layer) | Self::Extinction(layer) => Some(layer),
            Self::SubstrateIndex | Self::SubstrateExtinction => None,
        }
    }
}

/// One call of [`GapFilm::derivatives`](super::GapFilm::derivatives), arguments checked.
pub(super) struct Derivatives<'a> {
    pub(super) media: &'a Media,
    pub(super) beta: &'a [f64],
    pub(super) gaps_nm: &'a [f64],
    pub(super) variables: &'a [Variable],
    /// One polarisation, or the mean of both.
    pub(super) polarisation: Option<Polarisation>,
    /// `[beta][gap][wavelength]`, not empty.
    pub(super) reflectance: &'a mut [f64],
    /// `[variable][beta][gap][wavelength]`.
    pub(super) out: &'a mut [f64],
}

impl WithSimd for Derivatives<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let count = self.media.wavelengths();
        let (values, rows) = (self.reflectance.len(), self.gaps_nm.len() * count);
        let wanted = Wanted::new(self.media, self.variables, self.polarisation);
        let zero = Complex::real(Lanes::new(simd, 0.0));
        let mut found =
            Found { thickness: vec![zero.re; wanted.thickness.len()], index: vec![zero; wanted.index.len()] };
        let mut room = Passes { above: vec![], below: vec![], forms: vec![], fields: vec![] };
        for (number, &beta) in self.beta.iter().enumerate() {
            for at in (0..count).step_by(S::F64_LANES) {
                let k0 = load(simd, &self.media.k0, at);
                let direction = Direction { simd, media: self.media, at, beta, k0 };
                room.pass(&direction, &wanted);
                for (gap, &nm) in self.gaps_nm.iter().enumerate() {
                    let reflectance = room.at_gap(&direction, nm, &wanted, &mut found);
                    let from = number * rows + gap * count;
                    direction.store(reflectance, &mut self.reflectance[from + at..from + count]);
                    for (k, variable) in self.variables.iter().enumerate() {
                        let from = k * values + from;
                        direction.store(found.of(*variable), &mut self.out[from + at..from + count]);
                    }
                }
            }
        }
    }
}

/// Layers whose derivatives are requested; the last index is that of the substrate.
struct Wanted {
    thickness: Vec<bool>,
    index: Vec<bool>,
    /// Weights of s and of p, relative to those of their mean.
    weights: [f64; 2],
}

impl Wanted {
    fn new(media: &Media, variables: &[Variable], polarisation: Option<Polarisation>) -> Self {
        let layers = media.layers();
        let (mut thickness, mut index) = (vec![false; layers], vec![false; layers + 1]);
        for variable in variables {
            match *variable {
                Variable::Thickness(layer) => thickness[layer] = true,
                Variable::Index(layer) | Variable::Extinction(layer) => index[layer] = true,
                Variable::SubstrateIndex | Variable::SubstrateExtinction => index[layers] = true,
            }
        }
        let weights = match polarisation {
            None => [1.0, 1.0],
            Some(Polarisation::S) => [2.0, 0.0],
            Some(Polarisation::P) => [0.0, 2.0],
        };
        Self { thickness, index, weights }
    }
}

/// Requested derivatives of the reflectance of one beta and gap. By an index: the real part is the
/// derivative by n, minus the imaginary part that by k.
struct Found<S: Simd> {
    thickness: Vec<Lanes<S>>,
    index: Vec<Complex<S>>,
}

impl<S: Simd> Found<S> {
    #[inline(always)]
    fn of(&self, variable: Variable) -> Lanes<S> {
        let substrate = self.index.len() - 1;
        match variable {
            Variable::Thickness(layer) => self.thickness[layer],
            Variable::Index(layer) => self.index[layer].re,
            Variable::Extinction(layer) => -self.index[layer].im,
            Variable::SubstrateIndex => self.index[substrate].re,
            Variable::SubstrateExtinction => -self.index[substrate].im,
        }
    }
}

/// A layer in one polarisation: its matrix and its change with n (both times a common factor), g and q^2/g.
#[derive(Clone, Copy)]
struct Slab<S: Simd> {
    matrix: Absorbing<S>,
    change: Absorbing<S>,
    g: Complex<S>,
    h: Complex<S>,
}

/// Fields at a layer's bottom and at its top, times a common factor.
#[derive(Clone, Copy)]
struct Around<S: Simd> {
    below: Field<S>,
    above: Field<S>,
}

/// Quantities that do not depend on the gap, for one beta and one register of wavelengths; arrays are
/// `[s, p]`, layers in the order of the light.
struct Passes<S: Simd> {
    above: Vec<[Slab<S>; 2]>,
    below: Vec<[Slab<S>; 2]>,
    /// At the top of each layer above the gap and, last, below all of these.
    forms: Vec<[Pair<Form<S>>; 2]>,
    /// Around each layer below the gap; from the last of them up.
    fields: Vec<[Around<S>; 2]>,
}

impl<S: Simd> Passes<S> {
    #[inline(always)]
    fn pass(&mut self, direction: &Direction<'_, S>, wanted: &Wanted) {
        let media = direction.media;
        self.above.clear();
        self.below.clear();
        self.forms.clear();
        self.fields.clear();
        let mut forms = direction.incident();
        self.forms.push(forms);
        for (number, layer) in media.above.iter().enumerate() {
            let slabs = direction.slabs(&layer.medium, layer.nm, wanted.index[number]);
            self.above.push(slabs);
            forms = down(forms, &slabs);
            self.forms.push(forms);
        }
        let first = media.layers() - media.below.len();
        for (number, layer) in media.below.iter().enumerate() {
            self.below.push(direction.slabs(&layer.medium, layer.nm, wanted.index[first + number]));
        }
        let mut fields = direction.at_rest();
        for slabs in self.below.iter().rev() {
            let around = up(fields, slabs);
            self.fields.push(around);
            fields = above(around);
        }
    }

    /// Returns the reflectance at this gap and stores the derivatives in `found`.
    #[inline(always)]
    fn at_gap(
        &self,
        direction: &Direction<'_, S>,
        gap_nm: f64,
        wanted: &Wanted,
        found: &mut Found<S>,
    ) -> Lanes<S> {
        let media = direction.media;
        let mut forms = self.forms[media.above.len()];
        let mut fields = self.fields.last().map_or(direction.at_rest(), |around| above(*around));
        let mut layer = media.above.len();
        let r;
        if let Some(medium) = &media.gap {
            let slabs = direction.slabs(medium, gap_nm, wanted.index[layer]);
            let around = up(fields, &slabs);
            fields = above(around);
            r = amplitudes(forms, fields);
            found.meet(direction, (layer, &slabs), (forms, around), r, wanted);
            forms = down(forms, &slabs);
            layer += 1;
        } else {
            r = amplitudes(forms, fields);
        }
        for (slabs, around) in self.below.iter().zip(self.fields.iter().rev()) {
            found.meet(direction, (layer, slabs), (forms, *around), r, wanted);
            forms = down(forms, slabs);
            layer += 1;
        }
        if wanted.index[layer] {
            found.rest(direction, forms, r, wanted);
        }
        for (layer, slabs) in self.above.iter().enumerate().rev() {
            let around = up(fields, slabs);
            fields = above(around);
            found.meet(direction, (layer, slabs), (self.forms[layer], around), r, wanted);
        }
        let [s, p] = wanted.weights.map(|weight| direction.k0.splat(weight));
        (r[0].norm_sqr() * s + r[1].norm_sqr() * p) * direction.k0.splat(0.5)
    }
}

impl<S: Simd> Found<S> {
    /// Stores the derivatives by a layer's thickness and index.
    #[inline(always)]
    fn meet(
        &mut self,
        direction: &Direction<'_, S>,
        (layer, slabs): (usize, &[Slab<S>; 2]),
        (forms, around): ([Pair<Form<S>>; 2], [Around<S>; 2]),
        r: [Complex<S>; 2],
        wanted: &Wanted,
    ) {
        let zero = Complex::real(direction.k0.splat(0.0));
        let (mut thickness, mut index) = (zero, zero);
        for k in 0..2 {
            let (slab, Around { below, above }) = (&slabs[k], around[k]);
            let weight = direction.k0.splat(wanted.weights[k]);
            let factor = factor(forms[k], above, r[k]).scale(weight);
            if wanted.thickness[layer] {
                let size = slab.g * above.v * above.v - slab.h * above.u * above.u;
                thickness = thickness + factor * size.minus_i();
            }
            if wanted.index[layer] {
                let [u, v] = slab.change.on([below.u, below.v]);
                index = index + factor * (u * above.v - v * above.u);
            }
        }
        self.thickness[layer] = thickness.re * direction.k0;
        self.index[layer] = index;
    }

    /// Stores the derivative by the index of the substrate.
    #[inline(always)]
    fn rest(
        &mut self,
        direction: &Direction<'_, S>,
        forms: [Pair<Form<S>>; 2],
        r: [Complex<S>; 2],
        wanted: &Wanted,
    ) {
        let fields = direction.at_rest();
        let [s, p] = direction.change_of_rest();
        let [of_s, of_p] = wanted.weights.map(|weight| direction.k0.splat(weight));
        let (s, p) = (
            factor(forms[0], fields[0], r[0]).scale(of_s) * s,
            factor(forms[1], fields[1], r[1]).scale(of_p) * p,
        );
        let substrate = self.index.len() - 1;
        self.index[substrate] = Complex::real(direction.k0.splat(0.0)) - (s + p);
    }
}

impl<S: Simd> Direction<'_, S> {
    /// A layer for s and for p.
    #[inline(always)]
    fn slabs(&self, medium: &Medium, nm: f64, by_index: bool) -> [Slab<S>; 2] {
        let (eps, inverse_eps) =
            (medium.eps.load(self.simd, self.at), medium.inverse_eps.load(self.simd, self.at));
        let depth = self.k0 * self.k0.splat(nm);
        let q2 = self.q_squared(medium);
        let q = q2.sqrt();
        let (mut c, sin) = self.phase(q, nm);
        let mut s = sin * q.recip();
        let one = Complex::real(self.k0.splat(1.0));
        let mut changes = [Absorbing { c, u: s, v: s }; 2];
        if by_index {
            let x = q2.scale(depth * depth);
            let small = x.size() - depth.splat(SMALL);
            let minus_x = Complex::real(depth.splat(0.0)) - x;
            let half = depth.splat(0.5);
            let t = (c.scale(depth) - s) * q2.recip().scale(half);
            let t_of_small = minus_x.polynomial(&DIFFERENCE).scale(-(depth * depth * depth * half));
            let t = Complex::if_positive(small, t, t_of_small);
            c = Complex::if_positive(small, c, minus_x.polynomial(&COSINE));
            s = Complex::if_positive(small, s, minus_x.polynomial(&SINE).scale(depth));
            changes = self.changes(medium, q2, depth, (c, s, t));
        }
        let h = q2 * inverse_eps;
        let (u, v) = (s.minus_i(), (q2 * s).minus_i());
        [
            Slab { matrix: Absorbing { c, u, v }, change: changes[0], g: one, h: q2 },
            Slab { matrix: Absorbing { c, u: eps * u, v: inverse_eps * v }, change: changes[1], g: eps, h },
        ]
    }

    /// Returns the derivatives by n of a layer's matrices, of c, S and T.
    #[inline(always)]
    fn changes(
        &self,
        medium: &Medium,
        q2: Complex<S>,
        depth: Lanes<S>,
        (c, s, t): (Complex<S>, Complex<S>, Complex<S>),
    ) -> [Absorbing<S>; 2] {
        let n = medium.index.load(self.simd, self.at);
        let (eps, inverse_eps) =
            (medium.eps.load(self.simd, self.at), medium.inverse_eps.load(self.simd, self.at));
        let two = depth.splat(2.0);
        let twice_n = n.scale(two);
        let change_of_c = (n * s).scale(-depth);
        let by_s =
            Absorbing { c: change_of_c, u: (twice_n * t).minus_i(), v: (n * (s + c.scale(depth))).minus_i() };
        let twice_beta_squared = depth.splat(2.0 * self.beta * self.beta);
        let change_of_h = (n * inverse_eps * inverse_eps).scale(twice_beta_squared);
        let by_p = Absorbing {
            c: change_of_c,
            u: (twice_n * (s + eps * t)).minus_i(),
            v: (change_of_h * s + q2 * inverse_eps * twice_n * t).minus_i(),
        };
        [by_s, by_p]
    }

    /// Returns the derivatives by n of the substrate's V/U, for s and for p.
    #[inline(always)]
    fn change_of_rest(&self) -> [Complex<S>; 2] {
        let medium = &self.media.substrate;
        let n = medium.index.load(self.simd, self.at);
        let inverse_eps = medium.inverse_eps.load(self.simd, self.at);
        let q = self.q_squared(medium).sqrt();
        let s = n * q.recip();
        let twice = (q * n * inverse_eps).scale(self.k0.splat(2.0));
        [s, (s - twice) * inverse_eps]
    }
}

/// `conj(r) det(a, b)/(b F)^2`: times `det(dM F, M F)`, the change of half |r|^2 (real part).
#[inline(always)]
fn factor<S: Simd>(forms: Pair<Form<S>>, field: Field<S>, r: Complex<S>) -> Complex<S> {
    let (a, b) = (forms.reflected, forms.incident);
    let size = b.on(field).recip();
    r.conj() * (a.x * b.y - a.y * b.x) * size * size
}

#[inline(always)]
fn amplitudes<S: Simd>(forms: [Pair<Form<S>>; 2], fields: [Field<S>; 2]) -> [Complex<S>; 2] {
    let (s, p) = (forms[0].on(fields[0]), forms[1].on(fields[1]));
    [s.reflected * s.incident.recip(), p.reflected * p.incident.recip()]
}

/// Beyond a layer, scaled.
#[inline(always)]
fn down<S: Simd>([s, p]: [Pair<Form<S>>; 2], slabs: &[Slab<S>; 2]) -> [Pair<Form<S>>; 2] {
    [s.through(slabs[0].matrix).scaled(), p.through(slabs[1].matrix).scaled()]
}

#[inline(always)]
fn up<S: Simd>([s, p]: [Field<S>; 2], slabs: &[Slab<S>; 2]) -> [Around<S>; 2] {
    [Around::new(s, &slabs[0]), Around::new(p, &slabs[1])]
}

#[inline(always)]
fn above<S: Simd>([s, p]: [Around<S>; 2]) -> [Field<S>; 2] {
    [s.above, p.above]
}

impl<S: Simd> Around<S> {
    #[inline(always)]
    fn new(below: Field<S>, slab: &Slab<S>) -> Self {
        let above = below.through(slab.matrix);
        let factor = (above.u.size() + above.v.size()).recip();
        Self { below: below.scale(factor), above: above.scale(factor) }
    }
}

/// Value of |x|, x = (q D)^2, below which series are used: of cos, of sin/(q D), and of T over -D^3/2, in
/// powers of -x.
const SMALL: f64 = 0.5;
const COSINE: [f64; 8] = series(0);
const SINE: [f64; 8] = series(1);
const DIFFERENCE: [f64; 8] = {
    let mut all = series(3);
    let mut m = 0;
    while m < all.len() {
        all[m] *= 2.0 * (m + 1) as f64;
        m += 1;
    }
    all
};

/// 1/(2 m + first)! for m = 0, 1, ...
const fn series(first: usize) -> [f64; 8] {
    let mut all = [0.0; 8];
    let mut m = 0;
    while m < all.len() {
        let mut factor = 1;
        all[m] = 1.0;
        while factor <= 2 * m + first {
            all[m] /= factor as f64;
            factor += 1;
        }
        m += 1;
    }
    all
}
