//! A mirror-like pixel that changes the polarisation of light, such as liquid crystals, below flat parts.
//!
//! Light of one direction is given by its coherency matrix in the frame of p and s, as four numbers: `|p|^2`, `|s|^2`, `sqrt 2 Re(p s*)` and
//! `sqrt 2 Im(p s*)`. A flat part with equal properties in all azimuths multiplies each of them by a factor; the pixel acts by a matrix `C` of 4x4
//! elements. With the transmittances `t` and the reflectances `b` from below of all that is above the pixel, light `l` has the sum of all orders
//! `(1 - C b) y = C t l` at the pixel, and leaves as `t y`. The third and fourth number are parts of the complex `sqrt 2 p s*`, whose factors may be complex,
//! too, where light is totally reflected above the pixel ([`Crossed`]).
//!
//! Frames: p lies in the plane of incidence, s across it, and (p, s, direction of travel) is right-handed before and after reflection. By reciprocity
//! `C(phi + 180 deg) = G C(phi)^T G` with `G = diag(1, 1, -1, 1)`: half of the sum, and half of the difference, of two mirrored elements are functions
//! of twice the azimuth, and of odd multiples of it. The table holds those.
//!
//! Sheets of the front of screen reflect as metal does along the normal, `r_p = -r_s`.

use std::f64::consts::SQRT_2;
use std::fmt::Debug;
use std::sync::Arc;

use num_complex::Complex64;
use papilio_optics::film::Polarisation;
use papilio_optics::{Beta, with_widest_simd};
use papilio_spectra::StateSpectra;

use crate::angular::add_rows;
use crate::front::Flat;
use crate::layers::{Crossed, Incidence, LayerKind, fresnel_of};
use crate::light::polarised::{Frame, Quartet, light_of};
use crate::specular::FlatTop;
use crate::{Cone, CosinePanels, FlatRun, Medium, Panel, ReflectanceFactor, Top, Vibration};

/// Signs by which reciprocity changes the elements of the four numbers.
const RECIPROCAL: Quartet = [1.0, 1.0, -1.0, 1.0];

/// Unpolarised light, and a meter without a polariser.
pub(crate) const LIGHT: Quartet = [0.5, 0.5, 0.0, 0.0];
pub(crate) const METER: Quartet = [1.0, 1.0, 0.0, 0.0];

/// Reflection of polarised light by a pixel.
#[derive(Debug, Clone)]
pub struct Mueller {
    /// Of the active area, by direction.
    pub by_direction: MuellerByDirection,
    /// Number of states.
    pub states: usize,
    /// Active fraction of the area.
    pub active: f64,
    /// Reflectance of the inactive area times its fraction, by wavelength.
    pub inactive: Vec<f64>,
}

/// The matrices of a pixel by direction.
#[derive(Debug, Clone)]
#[allow(clippy::large_enum_variant, reason = "there is one pixel, not many")]
pub enum MuellerByDirection {
    /// Interpolated.
    Table {
        /// Nodes over the cosine in the medium above.
        panels: CosinePanels,
        /// Number of harmonics of each element: 1, cos 2 phi, sin 2 phi, ... of elements on and above the diagonal; cos phi, sin phi, cos 3 phi, ... below it.
        harmonics: usize,
        /// `[node][state][element][harmonic][wavelength]`: the elements as [`Mueller::symmetric`] returns them.
        values: Arc<[f64]>,
    },
    /// Computed for each direction: for few of them.
    Exact(Arc<dyn MuellerAt>),
}

/// What computes the matrices of a pixel.
pub trait MuellerAt: Debug + Send + Sync {
    /// Returns the elements, `[state][element][wavelength]`, for light that leaves with these direction cosines.
    fn at(&self, beta: Beta) -> Arc<[f64]>;
}

impl Mueller {
    /// Number of elements of the matrix, by rows.
    pub const ELEMENTS: usize = 16;

    /// Returns whether an element of the table has odd multiples of the azimuth.
    pub fn is_odd(element: usize) -> bool {
        element / 4 > element % 4
    }

    /// Returns the elements for light that leaves towards the opposite azimuth.
    pub fn reversed(elements: [f64; Self::ELEMENTS]) -> [f64; Self::ELEMENTS] {
        std::array::from_fn(|at| RECIPROCAL[at / 4] * RECIPROCAL[at % 4] * elements[at % 4 * 4 + at / 4])
    }

    /// Returns sums of mirrored elements in their place above the diagonal, and differences below.
    pub fn symmetric(elements: [f64; Self::ELEMENTS]) -> [f64; Self::ELEMENTS] {
        let mut out = elements;
        for (row, column) in pairs() {
            let (upper, lower) = (elements[4 * row + column], elements[4 * column + row]);
            let mirrored = RECIPROCAL[row] * RECIPROCAL[column] * lower;
            (out[4 * row + column], out[4 * column + row]) =
                (0.5 * (upper + mirrored), 0.5 * (upper - mirrored));
        }
        out
    }

    /// Returns the elements, `[state][element][wavelength]`, for light that leaves with these direction cosines.
    pub(crate) fn at(&self, beta: Beta, medium: &Medium) -> Vec<f64> {
        let mut all = match &self.by_direction {
            MuellerByDirection::Exact(exact) => exact.at(beta).to_vec(),
            MuellerByDirection::Table { panels, harmonics, values } => {
                self.interpolated((panels, *harmonics, values), beta, medium)
            }
        };
        all.iter_mut().for_each(|value| *value *= self.active);
        let bins = self.inactive.len();
        for of_state in all.chunks_exact_mut(Self::ELEMENTS * bins) {
            // As a mirror of metal.
            for (place, sign) in [1.0, 1.0, -1.0, -1.0].into_iter().enumerate() {
                let diagonal = &mut of_state[5 * place * bins..][..bins];
                diagonal.iter_mut().zip(&self.inactive).for_each(|(value, more)| *value += sign * more);
            }
        }
        all
    }

    /// Computes the reflectance for unpolarised light, `[state][wavelength]`, of light that leaves with these direction cosines.
    pub fn reflectance(&self, beta: Beta, medium: &Medium, out: &mut [f64]) {
        let (bins, all) = (self.inactive.len(), self.at(beta, medium));
        for (of_state, out) in all.chunks_exact(Self::ELEMENTS * bins).zip(out.chunks_exact_mut(bins)) {
            let of = |bin: usize| {
                0.5 * [0, 1, 4, 5].map(|element| of_state[element * bins + bin]).iter().sum::<f64>()
            };
            out.iter_mut().enumerate().for_each(|(bin, out)| *out = of(bin));
        }
    }

    fn interpolated(
        &self,
        (panels, harmonics, values): (&CosinePanels, usize, &[f64]),
        beta: Beta,
        medium: &Medium,
    ) -> Vec<f64> {
        let bins = self.inactive.len();
        let width = self.states * Self::ELEMENTS * harmonics * bins;
        let mut rows = vec![0.0; width];
        let stencil = |index: f64| panels.stencil((1.0 - beta.squared() / (index * index)).max(0.0).sqrt());
        if let Some(index) = medium.constant_index() {
            let stencil = stencil(index);
            with_widest_simd(
                #[inline(always)]
                || add_rows(&mut rows, &values[stencil.first * width..], &stencil.weights),
            );
        } else {
            for bin in 0..bins {
                let stencil = stencil(medium.index()[bin]);
                for at in (bin..width).step_by(bins) {
                    let nodes = stencil.first..panels.count();
                    let of = |(node, weight): (usize, f64)| weight * values[node * width + at];
                    rows[at] = nodes.zip(stencil.weights).map(of).sum();
                }
            }
        }
        let phi = beta.y.atan2(beta.x);
        let wave = |multiple: usize, is_sine: bool| {
            let (sin, cos) = (multiple as f64 * phi).sin_cos();
            if is_sine { sin } else { cos }
        };
        let even: Vec<f64> =
            (0..harmonics).map(|k| wave(2 * k.div_ceil(2), k > 0 && k.is_multiple_of(2))).collect();
        let odd: Vec<f64> = (0..harmonics).map(|k| wave(2 * (k / 2) + 1, !k.is_multiple_of(2))).collect();
        let mut out = vec![0.0; self.states * Self::ELEMENTS * bins];
        let elements = rows.chunks_exact(harmonics * bins).zip(out.chunks_exact_mut(bins));
        for (number, (rows, out)) in elements.enumerate() {
            let waves = if Self::is_odd(number % Self::ELEMENTS) { &odd } else { &even };
            add_rows(out, rows, waves);
        }
        for of_state in out.chunks_exact_mut(Self::ELEMENTS * bins) {
            for (row, column) in pairs() {
                let sign = RECIPROCAL[row] * RECIPROCAL[column];
                for bin in 0..bins {
                    let (upper, lower) = ((4 * row + column) * bins + bin, (4 * column + row) * bins + bin);
                    let (sum, difference) = (of_state[upper], of_state[lower]);
                    (of_state[upper], of_state[lower]) = (sum + difference, sign * (sum - difference));
                }
            }
        }
        out
    }
}

/// Places above the diagonal.
fn pairs() -> impl Iterator<Item = (usize, usize)> {
    (0..4).flat_map(|row| (row + 1..4).map(move |column| (row, column)))
}

/// What is polarised: sources, and a polariser before the eye.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct WholeView {
    /// Angle of the light that a polariser before the eye passes, from the plane of incidence of the axis of a view, radians,
    /// counter-clockwise as seen by the viewer.
    pub polariser: Option<f64>,
    /// Vibration by the number of the source.
    pub vibrations: Vec<Option<Vibration>>,
}

impl WholeView {
    /// Returns whether anything is polarised.
    pub(crate) fn is_polarised(&self) -> bool {
        self.polariser.is_some() || self.vibrations.iter().any(Option::is_some)
    }

    /// Returns what a view sees of light that leaves with these direction cosines, over that of a perfect white seen in the same way. A polariser
    /// is fixed to the view.
    pub(crate) fn meter(&self, view: Option<&Cone>, beta: Beta) -> Quartet {
        let Some(angle) = self.polariser else { return METER };
        let frame = Frame::new(beta, 1.0);
        let [p, s] = match view {
            // From the plane of incidence of the light itself.
            None => [angle.cos(), angle.sin()],
            Some(view) => frame.components(view.polariser(angle).towards(frame.travel())),
        };
        [2.0 * p * p, 2.0 * s * s, 2.0 * SQRT_2 * p * s, 0.0]
    }

    /// Returns the light of a source with these direction cosines, of unit intensity; `centre`: those of the centre of a lamp.
    pub(crate) fn light(&self, number: usize, centre: Option<Beta>, beta: Beta) -> Quartet {
        match self.vibrations.get(number) {
            Some(Some(vibration)) => light_of(vibration, centre, beta),
            _ => LIGHT,
        }
    }

    /// Returns the weights of the reflectances for s and for p, and of the real part of the product of both amplitudes ([`Crossed`]), in what a view sees of
    /// the light of a source with these direction cosines: `[0.5, 0.5, 0]` where nothing is polarised.
    pub(crate) fn products(
        &self,
        view: Option<&Cone>,
        (number, centre): (usize, Option<Beta>),
        beta: Beta,
    ) -> [f64; 3] {
        let (meter, light) = (self.meter(view, beta), self.light(number, centre, beta));
        [1, 0, 2].map(|one| meter[one] * light[one])
    }

    /// Returns the weights of the reflectances for s and for p in what a view sees of a lamp through scatterers that keep polarisation: light vibrates as in the
    /// mirror image of the lamp in metal, turned with the ray on the shortest way to the view (without one, in the mirror image). Of the polarisation they
    /// leave this fraction, once on its way in and once on its way out.
    pub(crate) fn kept_weights(
        &self,
        view: Option<&Cone>,
        (number, centre): (usize, Beta),
        left: f64,
    ) -> [f64; 2] {
        let at = view.map_or(centre, Cone::axis_towards);
        let [image, seen] = [centre, at].map(|beta| Frame::new(beta, 1.0));
        let [cos, sin] = seen.components(image.along_p().towards(seen.travel()));
        let [p, s, crossed, _] = self.light(number, Some(centre), centre);
        // Metal reflects s and p with opposite signs.
        let crossed = -crossed / SQRT_2;
        let turned = [
            p * cos * cos + s * sin * sin - 2.0 * crossed * sin * cos,
            p * sin * sin + s * cos * cos + 2.0 * crossed * sin * cos,
            SQRT_2 * ((p - s) * sin * cos + crossed * (cos * cos - sin * sin)),
        ];
        let meter = self.meter(view, at);
        let [p, s, crossed] = std::array::from_fn(|k| {
            (METER[k] + left * (meter[k] - METER[k])) * (LIGHT[k] + left * (turned[k] - LIGHT[k]))
        });
        [s, p].map(|one| one + 0.5 * crossed)
    }

    /// Returns the weights of the reflectances for s and for p where their phase is not known.
    ///
    /// Near the normal the directions of s and p change from ray to ray. The product of both amplitudes counts as the mean of both reflectances, which is exact
    /// along the normal and off by the phase between s and p elsewhere.
    pub(crate) fn weights(
        &self,
        view: Option<&Cone>,
        (number, centre): (usize, Option<Beta>),
        beta: Beta,
    ) -> [f64; 2] {
        let [s, p, product] = self.products(view, (number, centre), beta);
        // Mirrors reflect s and p with opposite signs along the normal.
        [s, p].map(|one| one - 0.5 * product)
    }
}

/// Light of one direction in a panel, all orders of it.
pub(crate) struct Orders<'a> {
    panel: &'a Panel,
    beta: Beta,
    /// By wavelength.
    above: Vec<Above>,
    /// `[state][element][wavelength]`.
    pixel: Vec<f64>,
}

/// All that is above the pixel, at one wavelength: factors of `|p|^2`, of `|s|^2`, and of `p s*`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Above {
    p: Flat,
    s: Flat,
    crossed: Crossed,
}

impl Above {
    /// Returns several flat layers below a medium of this index, with the medium below them.
    pub(crate) fn of_run(
        run: &FlatRun,
        index_above: f64,
        below: &Medium,
        beta_squared: f64,
        bin: usize,
    ) -> Self {
        let at = Incidence {
            bin,
            indices: [index_above, below.index()[bin]],
            beta: beta_squared.sqrt(),
            beta_squared,
        };
        let passes = below.regular(&Incidence::between([below; 2], bin, beta_squared));
        let [s, p] = run.of_each(&at).map(|flat| flat.over(passes));
        Self { p, s, crossed: run.crossed(&at).over(Crossed::of_both(passes, 1.0)) }
    }

    /// Returns the mean over s and p of flat layers in air, without what is crossed.
    pub(crate) fn mean_of_run(run: &FlatRun, below: &Medium, beta_squared: f64, bin: usize) -> Flat {
        let indices = [1.0, below.index()[bin]];
        let at = Incidence { bin, indices, beta: beta_squared.sqrt(), beta_squared };
        let passes = below.regular(&Incidence::between([below; 2], bin, beta_squared));
        let [s, p] = run.of_each(&at).map(|flat| flat.over(passes));
        Flat::mean([p, s])
    }

    /// Returns the mean over s and p.
    pub(crate) fn mean(&self) -> Flat {
        Flat::mean([self.p, self.s])
    }

    pub(crate) fn new(panel: &Panel, beta_squared: f64, bin: usize) -> Self {
        if let Some(run) = &panel.run {
            return Self::of_run(run, 1.0, &panel.medium, beta_squared, bin);
        }
        let front = panel.front.at(bin);
        let crossed = Crossed::of_both(front, -1.0);
        let face = Self::of_face(panel, beta_squared, bin);
        Self { p: front.over(face.p), s: front.over(face.s), crossed: crossed.over(face.crossed) }
    }

    /// Returns the face of a panel without its front.
    fn of_face(panel: &Panel, beta_squared: f64, bin: usize) -> Self {
        let (p, s, crossed) = match &panel.top {
            Top::Fresnel(index) if beta_squared <= 1.0 => {
                let [n, beta] = [index[bin], beta_squared.sqrt()];
                let of = |polarisation| fresnel_of(Some(polarisation), [1.0, n], beta);
                let [p, s] = [of(Polarisation::P), of(Polarisation::S)];
                // Amplitudes have opposite signs below Brewster's angle, and equal ones beyond.
                let sign = if beta < n / 1.0_f64.hypot(n) { -1.0 } else { 1.0 };
                let r = sign * (p * s).sqrt();
                let t = ((1.0 - p) * (1.0 - s)).max(0.0).sqrt();
                let flat = |r: f64| Flat { t: 1.0 - r, above: r, below: r };
                (flat(p), flat(s), Flat { t, above: r, below: r })
            }
            _ if beta_squared <= 1.0 => (Flat::CLEAR, Flat::CLEAR, Flat::CLEAR),
            _ => (Flat::MIRROR, Flat::MIRROR, Flat::MIRROR),
        };
        Self { p, s, crossed: Crossed::of_both(crossed, 1.0) }
    }

    /// What it transmits, in both directions.
    pub(crate) fn transmits(&self) -> Factors {
        Factors { p: self.p.t, s: self.s.t, crossed: self.crossed.t }
    }

    /// What it mirrors from above.
    fn mirrors(&self) -> Factors {
        Factors { p: self.p.above, s: self.s.above, crossed: self.crossed.above }
    }

    /// What it returns from below.
    fn returns(&self) -> Factors {
        Factors { p: self.p.below, s: self.s.below, crossed: self.crossed.below }
    }

    /// Returns what the face of a panel returns from below, and what its front does through the face.
    pub(crate) fn returned_by(panel: &Panel, beta_squared: f64, bin: usize) -> (Factors, ByFront) {
        let (face, front) = (Self::of_face(panel, beta_squared, bin), panel.front.reflectance_below[bin]);
        // As a mirror of metal.
        let front = Factors { p: front, s: front, crossed: Complex64::new(-front, 0.0) };
        (face.returns(), ByFront { passes: face.transmits().powi(2), mirrors: face.mirrors(), front })
    }
}

/// Factors of `|p|^2`, of `|s|^2`, and of `p s*`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Factors {
    pub(crate) p: f64,
    pub(crate) s: f64,
    pub(crate) crossed: Complex64,
}

impl Factors {
    /// Nothing is left.
    pub(crate) const NONE: Self = Self { p: 0.0, s: 0.0, crossed: Complex64::ZERO };

    /// Returns what becomes of light.
    pub(crate) fn of(self, light: Quartet) -> Quartet {
        let crossed = self.crossed * Complex64::new(light[2], light[3]);
        [self.p * light[0], self.s * light[1], crossed.re, crossed.im]
    }

    /// Returns what a meter sees of light before these factors: a row of four numbers times their matrix.
    pub(crate) fn before(self, [p, s, u, v]: Quartet) -> Quartet {
        let Complex64 { re, im } = self.crossed;
        [p * self.p, s * self.s, u * re + v * im, v * re - u * im]
    }

    pub(crate) fn plus(self, other: Self) -> Self {
        Self { p: self.p + other.p, s: self.s + other.s, crossed: self.crossed + other.crossed }
    }

    fn times(self, other: Self) -> Self {
        Self { p: self.p * other.p, s: self.s * other.s, crossed: self.crossed * other.crossed }
    }

    fn powi(self, power: i32) -> Self {
        Self { p: self.p.powi(power), s: self.s.powi(power), crossed: self.crossed.powi(power) }
    }

    /// The largest of light of p or s; what is crossed is never larger.
    pub(crate) fn largest(self) -> f64 {
        self.p.max(self.s)
    }
}

/// Light that a front of screen returns through a face below it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ByFront {
    /// Through the face and back; from above; by the front.
    passes: Factors,
    mirrors: Factors,
    front: Factors,
}

impl ByFront {
    /// Returns the light that the front has returned once, and the face so many times; `rest`: and any more times.
    pub(crate) fn after(&self, times: i32, rest: bool) -> Factors {
        let between = self.mirrors.times(self.front);
        let own = self.passes.times(self.front).times(between.powi(times));
        if !rest {
            return own;
        }
        let open = |x: f64| 1.0 / (1.0 - x);
        let crossed = (Complex64::ONE - between.crossed).inv();
        own.times(Factors { p: open(between.p), s: open(between.s), crossed })
    }
}

/// Returns what a meter sees, via the pixel of these matrices `[state][element][wavelength]`, of light, `[state][wavelength]`.
fn via_pixel(matrices: &[f64], above: &[Above], meter: Quartet, light: Quartet) -> Vec<f64> {
    let bins = above.len();
    let mut out = Vec::with_capacity(matrices.len() / Mueller::ELEMENTS);
    for of_state in matrices.chunks_exact(Mueller::ELEMENTS * bins) {
        for (bin, above) in above.iter().enumerate() {
            if above.p.t == 0.0 && above.s.t == 0.0 {
                out.push(0.0);
                continue;
            }
            let (passes, returns) = (above.transmits(), above.returns());
            let arrives = passes.of(light);
            let mut open: [[f64; 5]; 4] = [[0.0; 5]; 4];
            for (row, of_row) in open.iter_mut().enumerate() {
                let pixel: Quartet = std::array::from_fn(|column| of_state[(4 * row + column) * bins + bin]);
                let again = returns.before(pixel);
                (0..4).for_each(|column| of_row[column] = f64::from(u8::from(row == column)) - again[column]);
                of_row[4] = dot(pixel, arrives);
            }
            out.push(dot(meter, passes.of(solved(open))));
        }
    }
    out
}

pub(crate) fn dot(meter: Quartet, light: Quartet) -> f64 {
    meter.iter().zip(light).map(|(meter, light)| meter * light).sum()
}

/// Returns the unpolarised light, `[state][wavelength]`, that returns via the pixel through flat layers above it.
pub(crate) fn returned_via(pixel: &Mueller, (beta, medium): (Beta, &Medium), above: &[Above]) -> Vec<f64> {
    via_pixel(&pixel.at(beta, medium), above, METER, LIGHT)
}

impl<'a> Orders<'a> {
    /// `None` for a pixel that is given for unpolarised light alone.
    pub(crate) fn of(panel: &'a Panel, beta: Beta) -> Option<Self> {
        let table = panel.mueller.as_ref()?;
        let above = (0..panel.base.bins()).map(|bin| Above::new(panel, beta.squared(), bin)).collect();
        Some(Self { panel, beta, above, pixel: table.at(beta, &panel.medium) })
    }

    /// Sets the means over s and p of all that is above the pixel.
    pub(crate) fn set(&self, flat: &mut FlatTop) {
        for (bin, above) in self.above.iter().enumerate() {
            let mean = above.mean();
            (flat.t[bin], flat.above[bin], flat.below[bin]) = (mean.t, mean.above, mean.below);
        }
    }

    /// Computes the reflectance of a pixel with which the means over s and p return as much unpolarised light via the pixel.
    pub(crate) fn equivalent(&self, flat: &FlatTop, out: &mut [f64]) {
        let via = via_pixel(&self.pixel, &self.above, METER, LIGHT);
        let bins = flat.t.len();
        for (k, (out, via)) in out.iter_mut().zip(&via).enumerate() {
            let open = flat.t[k % bins].powi(2) + flat.below[k % bins] * via;
            *out = if open > 0.0 { via / open } else { 0.0 };
        }
    }

    /// Returns what a view sees of the source of this number; `centre`: the direction cosines of a lamp's centre.
    pub(crate) fn seen(&self, view: Option<&Cone>, number: usize, centre: Option<Beta>) -> ReflectanceFactor {
        match &self.panel.whole {
            Some(whole) => self.seen_by(whole.meter(view, self.beta), whole.light(number, centre, self.beta)),
            None => self.seen_by(METER, LIGHT),
        }
    }

    fn seen_by(&self, meter: Quartet, light: Quartet) -> ReflectanceFactor {
        let via = via_pixel(&self.pixel, &self.above, meter, light);
        let front = self.above.iter().map(|above| dot(meter, above.mirrors().of(light)));
        ReflectanceFactor { via_pixel: StateSpectra::new(via, self.above.len()), front: front.collect() }
    }
}

/// Solves four equations, the right-hand sides in the last column. Their matrix is 1 less a round trip, which preserves less than all light:
/// leading elements do not vanish.
pub(crate) fn solved(mut rows: [[f64; 5]; 4]) -> Quartet {
    for pivot in 0..4 {
        let own = rows[pivot].map(|value| value / rows[pivot][pivot]);
        rows[pivot] = own;
        for (_, row) in rows.iter_mut().enumerate().filter(|(row, _)| *row != pivot) {
            let factor = row[pivot];
            row.iter_mut().zip(own).for_each(|(value, own)| *value -= factor * own);
        }
    }
    rows.map(|row| row[4])
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_4;

    use super::*;

    fn close(found: f64, expected: f64) {
        assert!((found - expected).abs() < 1e-12, "{found} {expected}");
    }

    #[test]
    fn four_equations_are_solved() {
        let rows = [
            [1.0, 0.2, 0.0, -0.3, 1.0],
            [0.1, 0.9, 0.2, 0.0, 2.0],
            [0.0, 0.3, 1.1, 0.1, 3.0],
            [0.2, 0.0, 0.1, 1.0, 4.0],
        ];
        let x = solved(rows);
        rows.iter().for_each(|row| close((0..4).map(|k| row[k] * x[k]).sum(), row[4]));
    }

    /// A polariser is fixed to the view: around the normal the plane of incidence turns, and it does not.
    #[test]
    fn polariser_does_not_turn_with_the_plane_of_incidence() {
        let whole = WholeView { polariser: Some(FRAC_PI_4), ..WholeView::default() };
        let view = Cone::new(0.0, 20.0, 2.0, 1.0);
        // 65 deg from x.
        let along = |phi_deg: f64| {
            let phi = phi_deg.to_radians();
            let tiny = 1e-6;
            whole.meter(Some(&view), Beta { x: tiny * phi.cos(), y: tiny * phi.sin() })
        };
        for phi_deg in [0.0, 65.0, 155.0, 200.0] {
            let [p, s, cross, _] = along(phi_deg);
            let angle = (65.0 - phi_deg).to_radians();
            close(p, 2.0 * angle.cos().powi(2));
            close(s, 2.0 * angle.sin().powi(2));
            close(cross, SQRT_2 * (2.0 * angle).sin());
        }
        // Of an oblique view it is the angle from its plane of incidence.
        let oblique = Cone::new(50.0, 20.0, 2.0, 1.0);
        let [p, s, cross, _] = whole.meter(Some(&oblique), oblique.axis_towards());
        [(p, 1.0), (s, 1.0), (cross, SQRT_2)]
            .into_iter()
            .for_each(|(found, expected)| close(found, expected));
    }

    /// Lamp and viewer may be exchanged, each with its polariser at the same angle as seen from there.
    #[test]
    fn vibration_of_a_lamp_is_that_of_a_polariser_before_a_viewer_there() {
        for (theta_deg, phi_deg, angle) in [(30.0, 10.0, 0.3), (70.0, 200.0, -1.1)] {
            let there = Cone::new(theta_deg, phi_deg, 0.0, 1.0).axis_towards();
            let whole = WholeView { polariser: Some(angle), ..WholeView::default() };
            let meter = whole.meter(None, there);
            let light = light_of(&Vibration::Fixed { degree: 1.0, angle }, Some(-there), -there);
            // The frames of both directions have opposite s.
            for k in 0..4 {
                close(meter[k], 2.0 * RECIPROCAL[k] * light[k]);
            }
        }
    }
}
