//! Inner loops of [`GapFilm`](super::GapFilm): several wavelengths at a time in SIMD registers.
//!
//! From above, the incidence medium's amplitudes `eta0 U - V` (reflected) and
//! `eta0 U + V` (incident) are linear forms of the fields in the plane below the
//! layers passed so far; from below, the substrate's fields are carried up. Where
//! the two meet around the gap, of phase delta, each form is
//! `P cos(delta) + Q sin(delta)`: the reflectance is |P C + Q S|^2 over the same
//! of the incident form, and only C and S depend on the gap. In a transparent gap
//! C and S are real, whether waves propagate there or decay.
//!
//! A common factor of C and S cancels, and so does a common factor of both forms or of the fields below: see
//! [`harmonic`](super::harmonic).

use pulp::{Simd, WithSimd};

use super::coherent::Polarisation;
use super::forms::{
    Absorbing, Carried, Clear, Field, Form, MEAN, P_ALONE, Pair, S_ALONE, Transfer, quotient,
};
use super::harmonic::{circular, hyperbolic, thin, thin_real};
use super::lanes::{Complex, Lanes};
use super::media::{Layer, Media, Medium, load};

/// Smallest q^2: at 0, sin(delta)/q would be 0/0; 1e-60 changes nothing.
const TINY: f64 = 1e-60;

/// Number of thin layers, of up to a factor of 1e4 each, that enlarge the fields no more than one thick layer
/// (1e16). The fields are scaled where they could have grown more than by two thick layers, and at the gap
/// more than by one: the reflectance multiplies fourth powers of the factors above and below the gap and of
/// the gap itself, which is below 1e190.
const GROWTH: u32 = 4;

/// One call of [`GapFilm::reflectance`](super::GapFilm::reflectance), arguments checked.
pub(super) struct Sweep<'a> {
    pub(super) media: &'a Media,
    pub(super) beta: &'a [f64],
    pub(super) gaps_nm: &'a [f64],
    /// One polarisation, or the mean of both.
    pub(super) polarisation: Option<Polarisation>,
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
                let direction = Direction { simd, media: self.media, at, beta, k0 };
                let gaps = self.gaps_nm.iter().copied().zip(spectra);
                match self.polarisation {
                    None => direction.sweep::<MEAN>(gaps),
                    Some(Polarisation::S) => direction.sweep::<S_ALONE>(gaps),
                    Some(Polarisation::P) => direction.sweep::<P_ALONE>(gaps),
                }
            }
        }
    }
}

/// One beta at one register of wavelengths.
pub(super) struct Direction<'a, S: Simd> {
    pub(super) simd: S,
    pub(super) media: &'a Media,
    pub(super) at: usize,
    pub(super) beta: f64,
    pub(super) k0: Lanes<S>,
}

impl<S: Simd> Direction<'_, S> {
    /// Returns whether waves propagate in a medium at every wavelength: q is then real.
    #[inline(always)]
    fn travels(&self, medium: &Medium) -> bool {
        self.beta < medium.travels_below
    }

    /// Returns n^2 - beta^2 of the real n. As a product, it keeps its digits where beta is close to n.
    #[inline(always)]
    fn real_q_squared(&self, n: Lanes<S>) -> Lanes<S> {
        let beta = self.k0.splat(self.beta);
        (n - beta) * (n + beta)
    }

    /// Returns q in a medium where waves propagate.
    #[inline(always)]
    fn real_q(&self, medium: &Medium) -> Lanes<S> {
        let n = medium.index.load_real(self.simd, self.at);
        self.real_q_squared(n).max(self.k0.splat(TINY)).sqrt()
    }

    /// Returns q/i in a medium where waves decay without being absorbed.
    #[inline(always)]
    fn kappa(&self, medium: &Medium) -> Lanes<S> {
        let n = medium.index.load_real(self.simd, self.at);
        (-self.real_q_squared(n)).max(self.k0.splat(TINY)).sqrt()
    }

    /// g/q and q/g for a real q, for s and for p.
    #[inline(always)]
    fn real_admittances(&self, medium: &Medium, q: Lanes<S>) -> [[Lanes<S>; 2]; 2] {
        let eps = medium.eps.load_real(self.simd, self.at);
        let inverse_eps = medium.inverse_eps.load_real(self.simd, self.at);
        let inverse_q = q.recip();
        [[inverse_q, q], [inverse_q * eps, q * inverse_eps]]
    }

    /// q^2 in a medium; not 0.
    #[inline(always)]
    pub(super) fn q_squared(&self, medium: &Medium) -> Complex<S> {
        let n = medium.index.load(self.simd, self.at);
        let tiny = self.k0.splat(TINY);
        let re = n.im.neg_mul_add(n.im, self.real_q_squared(n.re));
        let im = (n.re + n.re) * n.im;
        let re = (re.abs() + im - tiny).if_positive(re, tiny);
        Complex::new(re, im)
    }

    /// q and 1/q in a medium.
    #[inline(always)]
    fn q(&self, medium: &Medium) -> (Complex<S>, Complex<S>) {
        let q = self.q_squared(medium).sqrt();
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
    pub(super) fn phase(&self, q: Complex<S>, thickness_nm: f64) -> (Complex<S>, Complex<S>) {
        let delta = q.scale(self.k0 * self.k0.splat(thickness_nm));
        let (c, s) = circular(delta.re);
        let (cosh, sinh) = hyperbolic(delta.im);
        (Complex::new(c * cosh, -(s * sinh)), Complex::new(s * cosh, c * sinh))
    }

    /// `[s, p]` beyond these layers.
    #[inline(always)]
    fn carried<'l, T: Carried<S>>(
        &self,
        mut both: [T; 2],
        layers: impl ExactSizeIterator<Item = &'l Layer>,
    ) -> [T; 2] {
        let (mut left, mut growth) = (layers.len(), 0);
        for layer in layers {
            both = match (layer.medium.is_clear(), layer.thin) {
                (true, true) => through(both, self.thin_and_clear(layer)),
                (false, true) => through(both, self.thin(layer)),
                (true, false) if self.travels(&layer.medium) => through(both, self.travelling(layer)),
                _ => through(both, self.any(layer)),
            };
            left -= 1;
            growth += if layer.thin { 1 } else { GROWTH };
            if growth >= 2 * GROWTH || (left == 0 && growth > GROWTH) {
                both = scaled(both);
                growth = 0;
            }
        }
        both
    }

    /// The matrices of a layer, for s and for p.
    #[inline(always)]
    fn any(&self, layer: &Layer) -> [Absorbing<S>; 2] {
        let q = self.q(&layer.medium);
        let (c, sin) = self.phase(q.0, layer.nm);
        let sin = sin.minus_i();
        let [s, p] = self.admittances(&layer.medium, q);
        [Absorbing { c, u: sin * s[0], v: sin * s[1] }, Absorbing { c, u: sin * p[0], v: sin * p[1] }]
    }

    /// The same where waves propagate.
    #[inline(always)]
    fn travelling(&self, layer: &Layer) -> [Clear<S>; 2] {
        let q = self.real_q(&layer.medium);
        let (c, sin) = circular(q * (self.k0 * self.k0.splat(layer.nm)));
        let [s, p] = self.real_admittances(&layer.medium, q);
        [Clear { c, u: sin * s[0], v: sin * s[1] }, Clear { c, u: sin * p[0], v: sin * p[1] }]
    }

    /// The same of a thin layer.
    #[inline(always)]
    fn thin(&self, layer: &Layer) -> [Absorbing<S>; 2] {
        let eps = layer.medium.eps.load(self.simd, self.at);
        let inverse_eps = layer.medium.inverse_eps.load(self.simd, self.at);
        let (beta, length) = (self.k0.splat(self.beta), self.k0 * self.k0.splat(layer.nm));
        let q2 = Complex::new(beta.neg_mul_add(beta, eps.re), eps.im);
        let (c, sin) = thin(q2.scale(length * length));
        let sin_q = sin.scale(length).minus_i();
        let q_sin = q2 * sin_q;
        [Absorbing { c, u: sin_q, v: q_sin }, Absorbing { c, u: sin_q * eps, v: q_sin * inverse_eps }]
    }

    /// The same of a thin layer that does not absorb, whether or not waves propagate in it.
    #[inline(always)]
    fn thin_and_clear(&self, layer: &Layer) -> [Clear<S>; 2] {
        let eps = layer.medium.eps.load_real(self.simd, self.at);
        let inverse_eps = layer.medium.inverse_eps.load_real(self.simd, self.at);
        let (beta, length) = (self.k0.splat(self.beta), self.k0 * self.k0.splat(layer.nm));
        let q2 = beta.neg_mul_add(beta, eps);
        let (c, sin) = thin_real(q2 * (length * length));
        let sin_q = sin * length;
        let q_sin = q2 * sin_q;
        [Clear { c, u: sin_q, v: q_sin }, Clear { c, u: sin_q * eps, v: q_sin * inverse_eps }]
    }

    /// The incidence medium's amplitudes, for s and for p.
    #[inline(always)]
    pub(super) fn incident(&self) -> [Pair<Form<S>>; 2] {
        let n0 = load(self.simd, &self.media.incidence, self.at);
        let q0 = self.q0_squared().max(self.k0.splat(TINY)).sqrt();
        [Pair::new(q0), Pair::new(q0.div(n0 * n0))]
    }

    /// The same, at the top of the gap.
    #[inline(always)]
    fn above(&self) -> [Pair<Form<S>>; 2] {
        self.carried(self.incident(), self.media.above.iter())
    }

    /// Returns (U, V) of light that is transmitted into the substrate, at its top, for s and for p.
    #[inline(always)]
    pub(super) fn at_rest(&self) -> [Field<S>; 2] {
        let substrate = &self.media.substrate;
        let u = Complex::real(self.k0.splat(1.0));
        let [s, p] = self.admittances(substrate, self.q(substrate));
        [Field { u, v: s[1] }, Field { u, v: p[1] }]
    }

    /// The same, at the bottom of the gap.
    #[inline(always)]
    fn below(&self) -> [Field<S>; 2] {
        self.carried(self.at_rest(), self.media.below.iter().rev())
    }

    /// n0^2 - beta^2; the light exists where it is positive.
    #[inline(always)]
    fn q0_squared(&self) -> Lanes<S> {
        self.real_q_squared(load(self.simd, &self.media.incidence, self.at))
    }

    /// The reflectance for each gap: the mean of s and p, or one of them.
    #[inline(always)]
    fn sweep<'o, const OF: u8>(&self, gaps: impl Iterator<Item = (f64, &'o mut [f64])>) {
        let ([above_s, above_p], [below_s, below_p]) = (self.above(), self.below());
        let cos = [above_s.on(below_s), above_p.on(below_p)];
        let Some(gap) = &self.media.gap else {
            let reflectance = quotient::<S, OF>(cos[0].norms(), cos[1].norms());
            for (_, out) in gaps {
                self.store(reflectance, out);
            }
            return;
        };
        let decays = gap.is_clear() && self.beta > gap.decays_above;
        if decays || self.travels(gap) {
            // Where the wave decays, q = i kappa: sin(delta)/q and q sin(delta) are
            // sinh(kappa k0 d)/kappa and -kappa sinh(kappa k0 d).
            let q = if decays { self.kappa(gap) } else { self.real_q(gap) };
            let [s, p] = self.real_admittances(gap, q);
            let sign = q.splat(if decays { -1.0 } else { 1.0 });
            let (s, p) = ([s[0], s[1] * sign], [p[0], p[1] * sign]);
            let sin = [above_s.crossed_real(s).on(below_s), above_p.crossed_real(p).on(below_p)];
            for (nm, out) in gaps {
                let delta = q * (self.k0 * self.k0.splat(nm));
                let (c, s) = if decays { hyperbolic(delta) } else { circular(delta) };
                let forms = [cos[0].scale_add(c, sin[0], s), cos[1].scale_add(c, sin[1], s)];
                self.store(quotient::<S, OF>(forms[0].norms(), forms[1].norms()), out);
            }
        } else {
            let q = self.q(gap);
            let [s, p] = self.admittances(gap, q);
            let sin = [above_s.crossed(s).on(below_s), above_p.crossed(p).on(below_p)];
            for (nm, out) in gaps {
                let (c, s) = self.phase(q.0, nm);
                let forms = [cos[0].mul_add(c, sin[0], s), cos[1].mul_add(c, sin[1], s)];
                self.store(quotient::<S, OF>(forms[0].norms(), forms[1].norms()), out);
            }
        }
    }

    #[inline(always)]
    pub(super) fn store(&self, reflectance: Lanes<S>, out: &mut [f64]) {
        self.q0_squared().if_positive(reflectance, self.k0.splat(0.0)).store(out);
    }
}

/// `[s, p]` beyond a layer of these matrices.
#[inline(always)]
fn through<S: Simd, T: Carried<S>>([s, p]: [T; 2], [m_s, m_p]: [impl Transfer<S>; 2]) -> [T; 2] {
    [s.through(m_s), p.through(m_p)]
}

#[inline(always)]
fn scaled<S: Simd, T: Carried<S>>([s, p]: [T; 2]) -> [T; 2] {
    [s.scaled(), p.scaled()]
}
