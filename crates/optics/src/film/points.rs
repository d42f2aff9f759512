//! Fast implementation for arrays: reflected and transmitted power at many points at once, each of which may
//! have a wavelength, a direction and a stack of its own.
//!
//! Points form rows. A quantity that varies along a row is a slice, a constant one is a number; the points
//! of a row are processed together in SIMD registers. Fields are propagated up from the substrate as in
//! [`coherent`](super::coherent), with the functions of [`harmonic`](super::harmonic) instead of sines and
//! exponentials. These have a common factor, which cancels in the reflectance. It does not in the
//! transmittance, so it is computed: its square is `c^2 + s^2` of a sine and cosine, and `c^2 - s^2` of the
//! hyperbolic functions where these are formed, before they grow. If a layer is deeper than the range of the
//! functions, the excess is one exponential at the end.

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

/// Smallest q^2: at 0, sin(delta)/q would be 0/0; 1e-60 changes nothing.
const TINY: f64 = 1e-60;

/// Largest number of lanes of a register.
const MOST_LANES: usize = 16;

/// A number along a row of points.
#[derive(Debug, Clone, Copy)]
pub enum Along<'a> {
    /// The same at all points.
    Same(f64),
    /// One for each point.
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
    /// n0, the index of the transparent medium of the incident light.
    pub incidence: Along<'a>,
    /// Layers in the order in which the light meets them.
    pub layers: &'a [LayerAlong<'a>],
    /// The semi-infinite medium behind.
    pub substrate: IndexAlong<'a>,
}

impl FilmRow<'_> {
    /// Computes the power reflected, and transmitted into the substrate, at each point of the row: as
    /// [`coherent`](super::coherent) does, within 1e-12 (for a transmittance, a relative error within
    /// 1e-10), in one polarisation or as the mean of both.
    ///
    /// ```
    /// use papilio_optics::film::{Along, FilmRow, IndexAlong, LayerAlong, SimdLevel};
    /// // A quarter wave of sqrt(1.5) on n = 1.5 reflects nothing, half a wave as much as the bare glass.
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
    /// Slices of other lengths than `reflectance`. Values are not checked: see [`check`](Self::check).
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
        level.dispatch(Powers { row: *self, polarisation, reflectance, transmittance });
        Ok(())
    }

    /// Tests whether all numbers are possible for a film.
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

    /// Returns whether waves propagate in a medium at every point, and are not absorbed: its q is real.
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

    /// Returns the largest value of `of`.
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
    polarisation: Option<Polarisation>,
    reflectance: &'a mut [f64],
    transmittance: Option<&'a mut [f64]>,
}

impl WithSimd for Powers<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { row, polarisation, reflectance, mut transmittance } = self;
        // Weights of s and of p.
        let weights = match polarisation {
            Some(Polarisation::S) => [1.0, 0.0],
            Some(Polarisation::P) => [0.0, 1.0],
            None => [0.5, 0.5],
        };
        let [of_s, of_p] = [Lanes::new(simd, weights[0]), Lanes::new(simd, weights[1])];
        let counted = transmittance.is_some();
        let k0_of = Lanes::new(simd, 2.0 * PI);
        let known = Known::new(&Points { row: &row, simd, at: 0, k0: k0_of });
        for at in (0..reflectance.len()).step_by(S::F64_LANES) {
            let k0 = k0_of.div(row.wavelength_nm.load(simd, at));
            let (s, p, beyond) = Points { row: &row, simd, at, k0 }.carried(&known, counted);
            let (s, p) = (s.powers(), p.powers());
            s.reflected.mul_add(of_s, p.reflected * of_p).store(&mut reflectance[at..]);
            if let Some(transmittance) = &mut transmittance {
                let out = &mut transmittance[at..];
                s.transmitted.mul_add(of_s, p.transmitted * of_p).store(out);
                fade(out, beyond);
            }
        }
    }
}

/// As many points of a row as a register has lanes.
struct Points<'a, S: Simd> {
    row: &'a FilmRow<'a>,
    simd: S,
    at: usize,
    k0: Lanes<S>,
}

/// Fields in one polarisation, up to a factor.
#[derive(Clone, Copy)]
struct Wave<S: Simd> {
    u: Complex<S>,
    v: Complex<S>,
    /// Flux down in the substrate, times the square of the factor.
    flux: Lanes<S>,
    /// Admittance of the incident medium.
    eta0: Lanes<S>,
}

/// Fractions of the incident power.
struct Shares<S: Simd> {
    reflected: Lanes<S>,
    transmitted: Lanes<S>,
}

/// A medium: q, n^2 and their inverses.
#[derive(Clone, Copy)]
enum Medium<S: Simd> {
    /// A medium in which waves propagate, and are not absorbed.
    Travels {
        q: Lanes<S>,
        inverse_q: Lanes<S>,
        eps: Lanes<S>,
        inverse_eps: Lanes<S>,
    },
    Any {
        q: Complex<S>,
        inverse_q: Complex<S>,
        eps: Complex<S>,
        inverse_eps: Complex<S>,
    },
}

/// Properties of a row common to its points.
struct Known<S: Simd> {
    /// For each layer, whether waves propagate in it all along the row.
    travels: Vec<bool>,
    /// Media that are the same all along the row.
    layers: Vec<Option<Medium<S>>>,
    substrate: Option<Medium<S>>,
}

impl<S: Simd> Known<S> {
    #[inline(always)]
    fn new(points: &Points<'_, S>) -> Self {
        let row = points.row;
        let mut known = Self { travels: Vec::new(), layers: Vec::new(), substrate: None };
        for layer in row.layers {
            let travels = row.travels(&layer.index);
            known.travels.push(travels);
            known.layers.push(points.same_medium(&layer.index, travels));
        }
        known.substrate = points.same_medium(&row.substrate, false);
        known
    }
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

    /// n^2 - beta^2 of a real n: a product, which keeps its digits where both are close.
    #[inline(always)]
    fn real_q_squared(&self, n: Lanes<S>) -> Lanes<S> {
        let beta = self.load(self.row.beta);
        (n - beta) * (n + beta)
    }

    /// A medium, if it is the same all along the row.
    #[inline(always)]
    fn same_medium(&self, index: &IndexAlong<'_>, travels: bool) -> Option<Medium<S>> {
        match (index.n, index.k, self.row.beta) {
            (Along::Same(_), Along::Same(_), Along::Same(_)) => Some(self.medium(index, travels)),
            _ => None,
        }
    }

    #[inline(always)]
    fn medium(&self, index: &IndexAlong<'_>, travels: bool) -> Medium<S> {
        if travels {
            let n = self.load(index.n);
            let q = self.real_q_squared(n).max(self.splat(TINY)).sqrt();
            let eps = n * n;
            return Medium::Travels { q, inverse_q: q.recip(), eps, inverse_eps: eps.recip() };
        }
        let (n, k) = (self.load(index.n), self.load(index.k));
        let im = (n + n) * k;
        let re = k.neg_mul_add(k, self.real_q_squared(n));
        let re = (re.abs() + im - self.splat(TINY)).if_positive(re, self.splat(TINY));
        let eps = Complex::new(k.neg_mul_add(k, n * n), im);
        let q = Complex::new(re, im).sqrt();
        Medium::Any { q, inverse_q: q.recip(), eps, inverse_eps: eps.recip() }
    }

    /// Returns the waves of s and p above all layers, and the depth of layers beyond the range of the
    /// hyperbolic functions; `counted`: including the transmittance.
    #[inline(always)]
    fn carried(&self, known: &Known<S>, counted: bool) -> (Wave<S>, Wave<S>, Lanes<S>) {
        let n0 = self.load(self.row.incidence);
        let q0 = self.real_q_squared(n0).max(self.splat(TINY)).sqrt();
        let substrate = match known.substrate {
            Some(medium) => medium,
            None => self.medium(&self.row.substrate, false),
        };
        let (below_s, below_p) = match substrate {
            Medium::Travels { q, inverse_eps, .. } => (Complex::real(q), Complex::real(q * inverse_eps)),
            Medium::Any { q, inverse_eps, .. } => (q, q * inverse_eps),
        };
        let one = Complex::real(self.splat(1.0));
        let mut s = Wave { u: one, v: below_s, flux: below_s.re, eta0: q0 };
        let mut p = Wave { u: one, v: below_p, flux: below_p.re, eta0: q0.div(n0 * n0) };
        let mut beyond = self.splat(0.0);
        for at in (0..self.row.layers.len()).rev() {
            let layer = &self.row.layers[at];
            let medium = match known.layers[at] {
                Some(medium) => medium,
                None => self.medium(&layer.index, known.travels[at]),
            };
            let length = self.k0 * self.load(layer.nm);
            // Two layers alone do not overflow.
            let scaled = at.is_multiple_of(2);
            match medium {
                Medium::Travels { q, inverse_q, eps, inverse_eps } => {
                    let (c, sin) = circular(q * length);
                    let (u, v) = (sin * inverse_q, sin * q);
                    let factor = c.mul_add(c, sin * sin);
                    s.pass(Clear { c, u, v }, factor, scaled, counted);
                    p.pass(Clear { c, u: u * eps, v: v * inverse_eps }, factor, scaled, counted);
                }
                Medium::Any { q, inverse_q, eps, inverse_eps } => {
                    let delta = q.scale(length);
                    beyond = beyond + (delta.im - self.splat(DEEPEST)).max(self.splat(0.0));
                    let (cos, sin) = circular(delta.re);
                    let (cosh, sinh, grown) = hyperbolic_and_factor(delta.im);
                    let c = Complex::new(cos * cosh, -(sin * sinh));
                    let factor = cos.mul_add(cos, sin * sin) * grown;
                    let sin = Complex::new(sin * cosh, cos * sinh).minus_i();
                    let (u, v) = (sin * inverse_q, sin * q);
                    s.pass(Absorbing { c, u, v }, factor, scaled, counted);
                    p.pass(Absorbing { c, u: u * eps, v: v * inverse_eps }, factor, scaled, counted);
                }
            }
        }
        (s, p, beyond)
    }
}

impl<S: Simd> Wave<S> {
    /// Propagates beyond a layer; `scaled`: the fields are scaled to size 1.
    #[inline(always)]
    fn pass(&mut self, m: impl Transfer<S>, factor: Lanes<S>, scaled: bool, counted: bool) {
        let [u, v] = m.on([self.u, self.v]);
        (self.u, self.v) = (u, v);
        if counted {
            self.flux = self.flux * factor;
        }
        if scaled {
            let scale = (u.size() + v.size()).recip();
            (self.u, self.v) = (u.scale(scale), v.scale(scale));
            self.flux = self.flux * (scale * scale);
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

/// Applies the decay in layers beyond the range of the hyperbolic functions.
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
