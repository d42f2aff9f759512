//! The fast road of arrays: power reflected and transmitted at many points at once, each of which may have a wavelength, a direction
//! and a stack of its own.
//!
//! Points lie in rows. What changes along a row is a slice, what does not is one number; the points of a row stand side by side in
//! SIMD registers. Fields are carried up from the substrate as in [`coherent`](super::coherent), with the
//! functions of [`harmonic`](super::harmonic) in the place of sines and exponentials. These have a factor to spare, of which reflectance
//! knows nothing; transmittance does, so it is kept: its square is `c^2 + s^2` of a sine and cosine, and of their hyperbolic kin
//! `c^2 - s^2` where those were made, before they grow. Of a layer deeper than the functions reach, what is beyond is one
//! exponential at the end.

use std::f64::consts::PI;

use num_complex::Complex64;
use pulp::{Simd, WithSimd};

use super::forms::{Absorbing, Clear, Transfer};
use super::harmonic::{DEEPEST, circular, hyperbolic_and_factor};
use super::lanes::{Complex, Lanes};
use super::{
    Polarisation, SimdLevel, checked_incidence, checked_index, checked_thickness, checked_wavelength,
};
use crate::OpticsError;

/// q^2 is kept away from 0, where sin(delta)/q would be 0/0; 1e-60 changes nothing.
const TINY: f64 = 1e-60;

/// No register holds more numbers.
const MOST_LANES: usize = 16;

/// A number along a row of points.
#[derive(Debug, Clone, Copy)]
pub enum Along<'a> {
    /// The same at all of them.
    Same(f64),
    /// One for each.
    Each(&'a [f64]),
}

/// n + ik along a row of points, k >= 0.
#[derive(Debug, Clone, Copy)]
pub struct IndexAlong<'a> {
    /// n.
    pub n: Along<'a>,
    /// k.
    pub k: Along<'a>,
}

/// A layer along a row of points.
#[derive(Debug, Clone, Copy)]
pub struct LayerAlong<'a> {
    /// Its index.
    pub index: IndexAlong<'a>,
    /// Its thickness, nm.
    pub nm: Along<'a>,
}

/// Stacks along a row of points.
#[derive(Debug, Clone, Copy)]
pub struct FilmRow<'a> {
    /// Vacuum wavelength, nm.
    pub wavelength_nm: Along<'a>,
    /// n0 sin(theta), below n0.
    pub beta: Along<'a>,
    /// n0, the index of the transparent medium that the light comes from.
    pub incidence: Along<'a>,
    /// Layers in the order that the light meets them.
    pub layers: &'a [LayerAlong<'a>],
    /// The semi-infinite medium behind.
    pub substrate: IndexAlong<'a>,
}

impl FilmRow<'_> {
    /// Power reflected, and transmitted into the substrate, at each point of the row: as [`coherent`](super::coherent) has them, within
    /// 1e-12 (a transmittance: of itself within 1e-10), in one polarisation or in the mean of both.
    ///
    /// ```
    /// use papilio_optics::film::{Along, FilmRow, IndexAlong, LayerAlong, SimdLevel};
    /// // A quarter wave of sqrt(1.5) on n = 1.5 reflects nothing, half a wave what the bare glass does.
    /// let of = |n| IndexAlong { n: Along::Same(n), k: Along::Same(0.0) };
    /// let n = 1.5_f64.sqrt();
    /// let layer = LayerAlong { index: of(n), nm: Along::Each(&[550.0 / 4.0 / n, 550.0 / 2.0 / n]) };
    /// let [air, normal, green] = [1.0, 0.0, 550.0].map(Along::Same);
    /// let row = FilmRow { wavelength_nm: green, beta: normal, incidence: air, layers: &[layer], substrate: of(1.5) };
    /// let mut reflectance = [0.0; 2];
    /// row.powers(SimdLevel::best(), None, &mut reflectance, None)?;
    /// assert!(reflectance[0] < 1e-30);
    /// assert!((reflectance[1] - 0.04).abs() < 1e-15);
    /// # Ok::<(), papilio_optics::OpticsError>(())
    /// ```
    ///
    /// # Errors
    /// Slices of other lengths than `reflectance`. Numbers are taken as they are: see [`check`](Self::check).
    pub fn powers(
        &self,
        level: SimdLevel,
        polarisation: Option<Polarisation>,
        reflectance: &mut [f64],
        transmittance: Option<&mut [f64]>,
    ) -> Result<(), OpticsError> {
        let count = reflectance.len();
        let lengths = self.numbers().filter_map(Along::len).chain(transmittance.as_deref().map(<[f64]>::len));
        for found in lengths {
            if found != count {
                return Err(OpticsError::Length { what: "points of a row", expected: count, found });
            }
        }
        let travels = self.layers.iter().map(|layer| self.travels(&layer.index)).collect();
        level.dispatch(Powers { row: *self, travels, polarisation, reflectance, transmittance });
        Ok(())
    }

    /// Whether all numbers can be those of a film.
    ///
    /// # Errors
    /// As of [`coherent`](super::coherent).
    pub fn check(&self) -> Result<(), OpticsError> {
        self.wavelength_nm.each(|nm| checked_wavelength(nm).map(drop))?;
        self.incidence.each(|n| checked_incidence(n).map(drop))?;
        self.layers.iter().try_for_each(|layer| layer.index.check())?;
        self.layers.iter().try_for_each(|layer| layer.nm.each(|nm| checked_thickness(nm).map(drop)))?;
        self.substrate.check()?;
        pairs(self.beta, self.incidence, |beta, limit| {
            if (0.0..limit).contains(&beta) { Ok(()) } else { Err(OpticsError::Beta { beta, limit }) }
        })
    }

    /// Whether waves travel in a medium at every point, and are not absorbed: its q is real.
    fn travels(&self, index: &IndexAlong<'_>) -> bool {
        let beta = self.beta.most();
        index.k.most() == 0.0 && -index.n.map_most(|n| -n) > beta
    }

    fn numbers(&self) -> impl Iterator<Item = Along<'_>> {
        [self.wavelength_nm, self.beta, self.incidence, self.substrate.n, self.substrate.k]
            .into_iter()
            .chain(self.layers.iter().flat_map(|layer| [layer.index.n, layer.index.k, layer.nm]))
    }
}

impl IndexAlong<'_> {
    fn check(&self) -> Result<(), OpticsError> {
        pairs(self.n, self.k, |n, k| checked_index(Complex64::new(n, k)).map(drop))
    }
}

impl Along<'_> {
    fn len(self) -> Option<usize> {
        match self {
            Self::Same(_) => None,
            Self::Each(values) => Some(values.len()),
        }
    }

    fn each(self, check: impl Fn(f64) -> Result<(), OpticsError>) -> Result<(), OpticsError> {
        match self {
            Self::Same(value) => check(value),
            Self::Each(values) => values.iter().try_for_each(|value| check(*value)),
        }
    }

    fn most(self) -> f64 {
        self.map_most(|value| value)
    }

    /// The largest `of` any.
    fn map_most(self, of: impl Fn(f64) -> f64) -> f64 {
        match self {
            Self::Same(value) => of(value),
            Self::Each(values) => values.iter().fold(f64::NEG_INFINITY, |most, value| most.max(of(*value))),
        }
    }

    #[inline(always)]
    fn load<S: Simd>(self, simd: S, at: usize) -> Lanes<S> {
        match self {
            Self::Same(value) => Lanes::new(simd, value),
            Self::Each(values) => Lanes::load(simd, &values[at..values.len().min(at + S::F64_LANES)]),
        }
    }
}

/// Checks two numbers together, at every point.
fn pairs(
    one: Along<'_>,
    other: Along<'_>,
    check: impl Fn(f64, f64) -> Result<(), OpticsError>,
) -> Result<(), OpticsError> {
    match (one, other) {
        (Along::Same(one), other) => other.each(|other| check(one, other)),
        (one, Along::Same(other)) => one.each(|one| check(one, other)),
        (Along::Each(ones), Along::Each(others)) => {
            ones.iter().zip(others).try_for_each(|(one, other)| check(*one, *other))
        }
    }
}

struct Powers<'a> {
    row: FilmRow<'a>,
    /// Of each layer, whether its q is real all along the row.
    travels: Vec<bool>,
    polarisation: Option<Polarisation>,
    reflectance: &'a mut [f64],
    transmittance: Option<&'a mut [f64]>,
}

impl WithSimd for Powers<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { row, travels, polarisation, reflectance, mut transmittance } = self;
        let of_s = polarisation != Some(Polarisation::P);
        let of_p = polarisation != Some(Polarisation::S);
        for at in (0..reflectance.len()).step_by(S::F64_LANES) {
            let points = Points { row: &row, travels: &travels, simd, at };
            let counted = transmittance.is_some();
            let (s, p, beyond) = points.carried(counted);
            let (s, p) = (s.powers(), p.powers());
            let half = Lanes::new(simd, 0.5);
            let chosen = |s: Lanes<S>, p: Lanes<S>| match (of_s, of_p) {
                (true, false) => s,
                (false, true) => p,
                _ => (s + p) * half,
            };
            chosen(s.reflected, p.reflected).store(&mut reflectance[at..]);
            if let Some(transmittance) = &mut transmittance {
                let out = &mut transmittance[at..];
                chosen(s.transmitted, p.transmitted).store(out);
                fade(out, beyond);
            }
        }
    }
}

/// As many points of a row as a register holds.
struct Points<'a, S: Simd> {
    row: &'a FilmRow<'a>,
    travels: &'a [bool],
    simd: S,
    at: usize,
}

/// Fields in one polarisation, up to a factor.
#[derive(Clone, Copy)]
struct Wave<S: Simd> {
    u: Complex<S>,
    v: Complex<S>,
    /// What flows down in the substrate, times the square of the factor.
    flux: Lanes<S>,
    /// Admittance of the medium that the light comes from.
    eta0: Lanes<S>,
}

/// Shares of what comes in.
struct Shares<S: Simd> {
    reflected: Lanes<S>,
    transmitted: Lanes<S>,
}

/// What a layer's matrices for s and p are made of: they have one square of their factor.
struct Step<S: Simd, T> {
    s: T,
    p: T,
    factor: Lanes<S>,
}

impl<S: Simd> Points<'_, S> {
    #[inline(always)]
    fn load(&self, values: Along<'_>) -> Lanes<S> {
        values.load(self.simd, self.at)
    }

    #[inline(always)]
    fn splat(&self, value: f64) -> Lanes<S> {
        Lanes::new(self.simd, value)
    }

    #[inline(always)]
    fn k0(&self) -> Lanes<S> {
        self.splat(2.0 * PI).div(self.load(self.row.wavelength_nm))
    }

    /// n^2 - beta^2 of a real n: a product, which keeps its digits where both are close.
    #[inline(always)]
    fn real_q_squared(&self, n: Lanes<S>) -> Lanes<S> {
        let beta = self.load(self.row.beta);
        (n - beta) * (n + beta)
    }

    /// q of a medium, n^2 and 1/n^2.
    #[inline(always)]
    fn medium(&self, index: &IndexAlong<'_>) -> [Complex<S>; 3] {
        let (n, k) = (self.load(index.n), self.load(index.k));
        let im = (n + n) * k;
        let re = k.neg_mul_add(k, self.real_q_squared(n));
        let re = (re.abs() + im - self.splat(TINY)).if_positive(re, self.splat(TINY));
        let eps = Complex::new(k.neg_mul_add(k, n * n), im);
        [Complex::new(re, im).sqrt(), eps, eps.recip()]
    }

    /// The waves of s and p above all layers, and by how much layers are deeper than the hyperbolic functions reach; `counted`: with
    /// what is transmitted.
    #[inline(always)]
    fn carried(&self, counted: bool) -> (Wave<S>, Wave<S>, Lanes<S>) {
        let n0 = self.load(self.row.incidence);
        let q0 = self.real_q_squared(n0).max(self.splat(TINY)).sqrt();
        let [q, _, inverse_eps] = self.medium(&self.row.substrate);
        let one = Complex::real(self.splat(1.0));
        let below_p = q * inverse_eps;
        let mut s = Wave { u: one, v: q, flux: q.re, eta0: q0 };
        let mut p = Wave { u: one, v: below_p, flux: below_p.re, eta0: q0.div(n0 * n0) };
        let mut beyond = self.splat(0.0);
        for (layer, travels) in self.row.layers.iter().zip(self.travels).rev() {
            if *travels {
                let step = self.travelling(layer);
                s.pass(step.s, step.factor, counted);
                p.pass(step.p, step.factor, counted);
            } else {
                let (step, depth) = self.any(layer);
                beyond = beyond + (depth - self.splat(DEEPEST)).max(self.splat(0.0));
                s.pass(step.s, step.factor, counted);
                p.pass(step.p, step.factor, counted);
            }
        }
        (s, p, beyond)
    }

    /// A layer in which waves travel, and are not absorbed.
    #[inline(always)]
    fn travelling(&self, layer: &LayerAlong<'_>) -> Step<S, Clear<S>> {
        let n = self.load(layer.index.n);
        let q = self.real_q_squared(n).max(self.splat(TINY)).sqrt();
        let (c, sin) = circular(q * (self.k0() * self.load(layer.nm)));
        let eps = n * n;
        let (s_u, s_v) = (sin.div(q), sin * q);
        let (p_u, p_v) = (s_u * eps, s_v.div(eps));
        let factor = c.mul_add(c, sin * sin);
        Step { s: Clear { c, u: s_u, v: s_v }, p: Clear { c, u: p_u, v: p_v }, factor }
    }

    /// Any layer, and its depth: the imaginary part of its phase.
    #[inline(always)]
    fn any(&self, layer: &LayerAlong<'_>) -> (Step<S, Absorbing<S>>, Lanes<S>) {
        let [q, eps, inverse_eps] = self.medium(&layer.index);
        let delta = q.scale(self.k0() * self.load(layer.nm));
        let (c, s) = circular(delta.re);
        let (cosh, sinh, grown) = hyperbolic_and_factor(delta.im);
        let cos = Complex::new(c * cosh, -(s * sinh));
        let sin = Complex::new(s * cosh, c * sinh).minus_i();
        let (s_u, s_v) = (sin * q.recip(), sin * q);
        let (p_u, p_v) = (s_u * eps, s_v * inverse_eps);
        let factor = c.mul_add(c, s * s) * grown;
        let s = Absorbing { c: cos, u: s_u, v: s_v };
        (Step { s, p: Absorbing { c: cos, u: p_u, v: p_v }, factor }, delta.im)
    }
}

impl<S: Simd> Wave<S> {
    /// Beyond a layer; the fields become of size 1.
    #[inline(always)]
    fn pass(&mut self, m: impl Transfer<S>, factor: Lanes<S>, counted: bool) {
        let [u, v] = m.on([self.u, self.v]);
        let scale = (u.size() + v.size()).recip();
        (self.u, self.v) = (u.scale(scale), v.scale(scale));
        if counted {
            self.flux = self.flux * (factor * (scale * scale));
        }
    }

    #[inline(always)]
    fn powers(self) -> Shares<S> {
        let (x, y) = (self.u.scale(self.eta0), self.v);
        let incident = (x + y).norm_sqr().recip();
        let four = self.flux.splat(4.0);
        Shares {
            reflected: (x - y).norm_sqr() * incident,
            transmitted: four * self.eta0 * self.flux * incident,
        }
    }
}

/// Takes off what fades in layers beyond the depth that the hyperbolic functions reach.
#[inline(always)]
fn fade<S: Simd>(transmittance: &mut [f64], beyond: Lanes<S>) {
    let mut depths = [0.0; MOST_LANES];
    beyond.store(&mut depths);
    for (share, depth) in transmittance.iter_mut().zip(&depths[..S::F64_LANES.min(MOST_LANES)]) {
        if *depth > 0.0 {
            *share *= (-2.0 * depth).exp();
        }
    }
}
