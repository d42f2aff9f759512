//! The inner loops of [`GapFilm`](super::GapFilm): wavelengths side by side in SIMD registers.
//!
//! From above, the incidence medium's amplitudes `eta0 U - V` (reflected) and
//! `eta0 U + V` (incident) are linear forms of the fields in the plane below the
//! layers passed so far; from below, the substrate's fields are carried up. Where
//! the two meet around the gap, of phase delta, each form is
//! `P cos(delta) + Q sin(delta)`: the reflectance is |P C + Q S|^2 over the same
//! of the incident form, and only C and S depend on the gap. A transparent gap
//! below its critical angle has real C and S.
//!
//! Any common factor of C and S drops out, and so does any factor common to both
//! forms or to the fields below: see [`harmonic`](super::harmonic).

use std::f64::consts::PI;

use num_complex::Complex64;
use pulp::{Simd, WithSimd};

use super::harmonic::{circular, hyperbolic};
use super::lanes::{Complex, Lanes};
use super::{SpectralLayer, Thickness};

/// q^2 is kept away from 0, where sin(delta)/q would be 0/0; 1e-60 changes nothing.
const TINY: f64 = 1e-60;

/// The indices and thicknesses of a film, as structures of arrays over wavelength.
#[derive(Debug, Clone)]
pub(super) struct Media {
    /// 2 pi/lambda, 1/nm.
    k0: Vec<f64>,
    incidence: Vec<f64>,
    above: Vec<(Medium, f64)>,
    gap: Option<Medium>,
    below: Vec<(Medium, f64)>,
    substrate: Medium,
}

/// A medium over wavelength.
#[derive(Debug, Clone)]
struct Medium {
    /// n^2.
    eps: Parts,
    /// 1/n^2.
    inverse_eps: Parts,
    /// Up to this beta waves travel at every wavelength; 0 if any is absorbed.
    travels_below: f64,
}

#[derive(Debug, Clone)]
struct Parts {
    re: Vec<f64>,
    im: Vec<f64>,
}

impl Media {
    pub(super) fn new(
        wavelengths_nm: &[f64],
        incidence: &[f64],
        layers: &[SpectralLayer],
        substrate: &[Complex64],
    ) -> Self {
        let mut media = Self {
            k0: wavelengths_nm.iter().map(|nm| 2.0 * PI / nm).collect(),
            incidence: incidence.to_vec(),
            above: Vec::new(),
            gap: None,
            below: Vec::new(),
            substrate: Medium::new(substrate),
        };
        for layer in layers {
            let medium = Medium::new(&layer.index);
            match layer.thickness {
                Thickness::Gap => media.gap = Some(medium),
                Thickness::Fixed(nm) if media.gap.is_none() => media.above.push((medium, nm)),
                Thickness::Fixed(nm) => media.below.push((medium, nm)),
            }
        }
        media
    }

    pub(super) fn wavelengths(&self) -> usize {
        self.k0.len()
    }
}

impl Medium {
    fn new(index: &[Complex64]) -> Self {
        let eps: Vec<Complex64> = index.iter().map(|n| n * n).collect();
        let slowest = |limit: f64, n: &Complex64| if n.im == 0.0 { limit.min(n.re) } else { 0.0 };
        Self {
            inverse_eps: Parts::new(eps.iter().map(Complex64::inv)),
            travels_below: index.iter().fold(f64::INFINITY, slowest),
            eps: Parts::new(eps.into_iter()),
        }
    }
}

impl Parts {
    fn new(values: impl Iterator<Item = Complex64>) -> Self {
        let (re, im) = values.map(|z| (z.re, z.im)).unzip();
        Self { re, im }
    }

    #[inline(always)]
    fn load<S: Simd>(&self, simd: S, at: usize) -> Complex<S> {
        Complex::new(load(simd, &self.re, at), load(simd, &self.im, at))
    }
}

/// The registerful of `values` that begins at `at`. Lanes beyond the end hold zeros,
/// which give nonsense there, and are not stored.
#[inline(always)]
fn load<S: Simd>(simd: S, values: &[f64], at: usize) -> Lanes<S> {
    Lanes::load(simd, &values[at..values.len().min(at + S::F64_LANES)])
}

/// One call of [`GapFilm::reflectance`](super::GapFilm::reflectance), arguments checked.
pub(super) struct Sweep<'a> {
    pub(super) media: &'a Media,
    pub(super) beta: &'a [f64],
    pub(super) gaps_nm: &'a [f64],
    /// [beta][gap][wavelength], not empty.
    pub(super) out: &'a mut [f64],
}

impl WithSimd for Sweep<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let count = self.media.wavelengths();
        for (&beta, rows) in self.beta.iter().zip(self.out.chunks_exact_mut(count * self.gaps_nm.len())) {
            for at in (0..count).step_by(S::F64_LANES) {
                let k0 = load(simd, &self.media.k0, at);
                let spectra = rows.chunks_exact_mut(count).map(|row| &mut row[at..]);
                Direction { simd, media: self.media, at, beta, k0 }
                    .sweep(self.gaps_nm.iter().copied().zip(spectra));
            }
        }
    }
}

/// One beta at a registerful of wavelengths.
struct Direction<'a, S: Simd> {
    simd: S,
    media: &'a Media,
    at: usize,
    beta: f64,
    k0: Lanes<S>,
}

impl<S: Simd> Direction<'_, S> {
    /// q and 1/q in a medium.
    #[inline(always)]
    fn q(&self, medium: &Medium) -> (Complex<S>, Complex<S>) {
        let eps = medium.eps.load(self.simd, self.at);
        let tiny = self.k0.splat(TINY);
        let re = eps.re - self.k0.splat(self.beta * self.beta);
        let re = (re.abs() + eps.im - tiny).if_positive(re, tiny);
        let q = Complex::new(re, eps.im).sqrt();
        (q, q.recip())
    }

    /// g/q and q/g of a medium, for s and for p.
    #[inline(always)]
    fn admittances(&self, medium: &Medium, (q, inverse_q): (Complex<S>, Complex<S>)) -> [[Complex<S>; 2]; 2] {
        let eps = medium.eps.load(self.simd, self.at);
        let inverse_eps = medium.inverse_eps.load(self.simd, self.at);
        [[inverse_q, q], [inverse_q * eps, q * inverse_eps]]
    }

    /// cos(delta) and sin(delta) of a layer, times a common real factor.
    #[inline(always)]
    fn phase(&self, q: Complex<S>, thickness_nm: f64) -> (Complex<S>, Complex<S>) {
        let delta = q.scale(self.k0 * self.k0.splat(thickness_nm));
        let (c, s) = circular(delta.re);
        let (cosh, sinh) = hyperbolic(delta.im);
        (Complex::new(c * cosh, -(s * sinh)), Complex::new(s * cosh, c * sinh))
    }

    /// The matrices of a layer, for s and for p.
    #[inline(always)]
    fn transfers(&self, (medium, thickness_nm): &(Medium, f64)) -> [Transfer<S>; 2] {
        let q = self.q(medium);
        let (c, sin) = self.phase(q.0, *thickness_nm);
        let s = sin.minus_i();
        self.admittances(medium, q).map(|[g_q, q_g]| Transfer { c, u: s * g_q, v: s * q_g })
    }

    /// The incidence medium's amplitudes, seen from the top of the gap, for s and for p.
    #[inline(always)]
    fn above(&self) -> [Forms<S>; 2] {
        let n0 = load(self.simd, &self.media.incidence, self.at);
        let q0 = self.q0_squared().max(self.k0.splat(TINY)).sqrt();
        let mut forms = [q0, q0.div(n0 * n0)].map(Forms::new);
        for layer in &self.media.above {
            let transfers = self.transfers(layer);
            forms = [forms[0].through(transfers[0]), forms[1].through(transfers[1])];
        }
        forms
    }

    /// (U, V) of light that comes to rest in the substrate, at the bottom of the gap, for s and for p.
    #[inline(always)]
    fn below(&self) -> [Field<S>; 2] {
        let substrate = &self.media.substrate;
        let one = Complex::real(self.k0.splat(1.0));
        let mut fields =
            self.admittances(substrate, self.q(substrate)).map(|[_, q_g]| Field { u: one, v: q_g });
        for layer in self.media.below.iter().rev() {
            let transfers = self.transfers(layer);
            fields = [fields[0].through(transfers[0]), fields[1].through(transfers[1])];
        }
        fields
    }

    /// n0^2 - beta^2; the light exists where it is positive.
    #[inline(always)]
    fn q0_squared(&self) -> Lanes<S> {
        let n0 = load(self.simd, &self.media.incidence, self.at);
        let beta = self.k0.splat(self.beta);
        (n0 - beta) * (n0 + beta)
    }

    /// The mean reflectance of s and p for each gap.
    #[inline(always)]
    fn sweep<'o>(&self, gaps: impl Iterator<Item = (f64, &'o mut [f64])>) {
        let (above, below) = (self.above(), self.below());
        let exists = self.q0_squared();
        let zero = self.k0.splat(0.0);
        let store = |mean: Lanes<S>, out: &mut [f64]| exists.if_positive(mean, zero).store(out);

        let Some(gap) = &self.media.gap else {
            let p = [0, 1].map(|i| above[i].map(|form| form.on(below[i])).norms());
            gaps.for_each(|(_, out)| store(mean(p), out));
            return;
        };
        let q = self.q(gap);
        let admittances = self.admittances(gap, q);
        let p = [0, 1].map(|i| above[i].map(|form| form.on(below[i])));
        let q_forms = [0, 1].map(|i| above[i].map(|form| form.crossed(admittances[i]).on(below[i])));
        let travels = self.beta < gap.travels_below;
        for (nm, out) in gaps {
            let norms = if travels {
                let (c, s) = circular(q.0.re * (self.k0 * self.k0.splat(nm)));
                [0, 1].map(|i| p[i].zip(q_forms[i], |p, q| p.scale(c) + q.scale(s)).norms())
            } else {
                let (c, s) = self.phase(q.0, nm);
                [0, 1].map(|i| p[i].zip(q_forms[i], |p, q| p.mul_add(c, q * s)).norms())
            };
            store(mean(norms), out);
        }
    }
}

/// Half of both quotients' sum, by one division.
#[inline(always)]
fn mean<S: Simd>([s, p]: [[Lanes<S>; 2]; 2]) -> Lanes<S> {
    let numerator = s[0].mul_add(p[1], p[0] * s[1]);
    (numerator * numerator.splat(0.5)).div(s[1] * p[1])
}

/// A linear form `x U + y V` of the fields in the plane reached so far.
#[derive(Clone, Copy)]
struct Form<S: Simd> {
    x: Complex<S>,
    y: Complex<S>,
}

impl<S: Simd> Form<S> {
    #[inline(always)]
    fn on(self, field: Field<S>) -> Complex<S> {
        self.x.mul_add(field.u, self.y * field.v)
    }

    /// The part of the form that goes with sin(delta) in a gap of these g/q, q/g.
    #[inline(always)]
    fn crossed(self, [g_q, q_g]: [Complex<S>; 2]) -> Self {
        Self { x: (self.y * q_g).minus_i(), y: (self.x * g_q).minus_i() }
    }

    #[inline(always)]
    fn through(self, m: Transfer<S>) -> Self {
        Self { x: self.x.mul_add(m.c, self.y * m.v), y: self.x.mul_add(m.u, self.y * m.c) }
    }

    #[inline(always)]
    fn scale(self, factor: Lanes<S>) -> Self {
        Self { x: self.x.scale(factor), y: self.y.scale(factor) }
    }
}

/// The amplitudes of the reflected and of the incident wave, in one polarisation.
type Forms<S> = Pair<Form<S>>;

#[derive(Clone, Copy)]
struct Pair<T> {
    reflected: T,
    incident: T,
}

impl<T: Copy> Pair<T> {
    #[inline(always)]
    fn map<U>(self, f: impl Fn(T) -> U) -> Pair<U> {
        Pair { reflected: f(self.reflected), incident: f(self.incident) }
    }

    #[inline(always)]
    fn zip<U>(self, other: Self, f: impl Fn(T, T) -> U) -> Pair<U> {
        Pair { reflected: f(self.reflected, other.reflected), incident: f(self.incident, other.incident) }
    }
}

impl<S: Simd> Forms<S> {
    #[inline(always)]
    fn new(eta0: Lanes<S>) -> Self {
        let x = Complex::real(eta0);
        let one = eta0.splat(1.0);
        Self { reflected: Form { x, y: Complex::real(-one) }, incident: Form { x, y: Complex::real(one) } }
    }

    #[inline(always)]
    fn through(self, m: Transfer<S>) -> Self {
        let forms = self.map(|form| form.through(m));
        let size = forms.incident.x.size() + forms.incident.y.size();
        let factor = size.recip();
        forms.map(|form| form.scale(factor))
    }
}

impl<S: Simd> Pair<Complex<S>> {
    #[inline(always)]
    fn norms(self) -> [Lanes<S>; 2] {
        [self.reflected.norm_sqr(), self.incident.norm_sqr()]
    }
}

/// Tangential fields in a plane, up to a factor.
#[derive(Clone, Copy)]
struct Field<S: Simd> {
    u: Complex<S>,
    v: Complex<S>,
}

impl<S: Simd> Field<S> {
    #[inline(always)]
    fn through(self, m: Transfer<S>) -> Self {
        let u = m.c.mul_add(self.u, m.u * self.v);
        let v = m.c.mul_add(self.v, m.v * self.u);
        let factor = (u.size() + v.size()).recip();
        Self { u: u.scale(factor), v: v.scale(factor) }
    }
}

/// A layer's matrix, up to a real factor: U' = c U + u V, V' = c V + v U.
#[derive(Clone, Copy)]
struct Transfer<S: Simd> {
    c: Complex<S>,
    /// -i (g/q) sin(delta).
    u: Complex<S>,
    /// -i (q/g) sin(delta).
    v: Complex<S>,
}
