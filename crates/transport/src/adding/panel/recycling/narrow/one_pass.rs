//! One pass through the panel between two directions in air, under a narrow lobe.
//!
//! With P_w the lobe of width w, one pass in which light is scattered is, between directions v and l in air,
//!
//! `S(v, l) = (1-s)^2 P_2b(v - l) rho(v, l) + s (1-s) P_b(v - l) (R_v + R_l)`,
//!
//! where rho is the mean of the base's reflectance over the directions in the glass on the way from v to l.
//! It differs from the mean of R_v and R_l only by the order of b and, unlike the lobe, changes over the disc
//! as slowly as R does. A few |v|, |l| and azimuths between them therefore represent the difference, however
//! narrow the lobe. The reflectance is a sum of polynomials, its terms, as on the grid
//! ([`super::super::forms`]).

use papilio_optics::{Beta, with_widest_simd};

use super::super::profile::chebyshev;
use super::between::{Between, density};
use super::polynomials::Polynomials;
use crate::adding::panel::first_pass::Pass;
use crate::adding::panel::lobes::LANES;
use crate::numerics::quadrature::gauss;

/// One pass through the panel, in terms of the reflectance.
#[derive(Debug, Clone)]
pub(super) struct OnePass {
    pub(super) width: f64,
    pub(super) straight: f64,
    index: f64,
    digits: f64,
    /// Polynomials in the cosine in the glass.
    terms: Polynomials,
    /// The smallest of these cosines; beyond, the reflectance is that at it.
    least: f64,
    /// |beta| and cosines of the azimuth between v and l, between which rho is interpolated.
    radii: Polynomials,
    turns: Polynomials,
    /// Differences of rho from the mean of R_v and R_l, `[|v|][|l|][azimuth][padded term]`.
    differences: Vec<f64>,
}

/// One end of a path: everything that does not depend on the other.
#[derive(Debug, Clone)]
pub(super) struct End {
    pub(super) at: Beta,
    /// Terms at this direction, padded.
    pub(super) terms: Vec<f64>,
    /// Differences `[|a|][azimuth][padded term]`.
    differences: Vec<f64>,
}

/// A direction on the way between two ends, with room for what is computed there.
#[derive(Debug, Clone)]
pub(super) struct Here {
    pub(super) at: Beta,
    pub(super) terms: Vec<f64>,
    radial: Vec<f64>,
    turns: Vec<f64>,
}

/// Range of the polynomials beyond the disc of air, in widths of the lobe: light in the glass that passes
/// between two directions in air hardly leaves that disc, and over all of the glass a film needs many more
/// terms.
const WIDTHS_BEYOND_RIM: f64 = 3.0;

/// Digits of the interpolation of rho for each further node, and terms of the reflectance for each node.
const DIGITS_A_RADIUS: f64 = 3.5;
const TERMS_A_RADIUS: usize = 2;

/// Cosine in the glass.
#[inline(always)]
fn cosine(squared: f64, index: f64) -> f64 {
    (1.0 - squared / (index * index)).max(0.0).sqrt()
}

/// Returns the cosine of the azimuth between two directions.
#[inline(always)]
pub(super) fn cosine_between(one: Beta, other: Beta) -> f64 {
    let size = one.length() * other.length();
    let cosine = if size > 0.0 { (one.x * other.x + one.y * other.y) / size } else { 0.0 };
    cosine.clamp(-1.0, 1.0)
}

impl OnePass {
    /// Prepares this number of terms for errors of `exp(-digits)`.
    pub(super) fn new(pass: &Pass<'_>, width: f64, digits: f64, terms: usize) -> Self {
        let count = ((digits / DIGITS_A_RADIUS).ceil() as usize + 3).max(terms.div_ceil(TERMS_A_RADIUS));
        let least = cosine((1.0 + WIDTHS_BEYOND_RIM * width).powi(2), pass.index);
        let cosines = chebyshev(terms).iter().map(|node| least + (1.0 - least) * node.x).collect();
        let mut all = Self {
            width,
            straight: pass.straight(),
            index: pass.index,
            digits,
            terms: Polynomials::new(cosines),
            least,
            radii: Polynomials::new(gauss(0.0, 1.0, count).map(|node| node.x).collect()),
            turns: Polynomials::new(chebyshev(count - 1).iter().map(|node| 2.0 * node.x - 1.0).collect()),
            differences: Vec::new(),
        };
        all.differences = all.all_differences();
        all
    }

    /// Returns the number of terms.
    pub(super) fn terms(&self) -> usize {
        self.terms.len()
    }

    /// Returns the number of terms with those of padding, which are zero: a multiple of [`LANES`].
    pub(super) fn padded_terms(&self) -> usize {
        self.terms.padded_len()
    }

    /// Returns |beta|² of the directions at which the terms are the reflectance.
    pub(super) fn squares(&self) -> Vec<f64> {
        self.terms.nodes().iter().map(|cosine| self.index * self.index * (1.0 - cosine * cosine)).collect()
    }

    /// Returns the fractions of light that is scattered twice in a pass, or once, and the widths of the
    /// lobes.
    pub(super) fn ways(&self) -> Vec<(f64, f64)> {
        let (s, b) = (self.straight, self.width);
        let all = [((1.0 - s) * (1.0 - s), 2.0 * b), (s * (1.0 - s), b)];
        all.into_iter().filter(|(share, _)| *share > 0.0).collect()
    }

    /// Computes the padded terms at a direction.
    #[inline(always)]
    pub(super) fn terms_at(&self, at: Beta, out: &mut [f64]) {
        self.terms.at(cosine(at.squared(), self.index).max(self.least), out);
    }

    fn all_differences(&self) -> Vec<f64> {
        let (radii, turns, terms) = (self.radii.len(), self.turns.len(), self.padded_terms());
        let mut all = vec![0.0; radii * radii * turns * terms];
        for (i, one) in self.radii.nodes().iter().enumerate() {
            for (k, other) in self.radii.nodes().iter().enumerate().skip(i) {
                for (t, cos) in self.turns.nodes().iter().enumerate() {
                    let sin = (1.0 - cos * cos).max(0.0).sqrt();
                    let ends = [Beta { x: *one, y: 0.0 }, Beta { x: other * cos, y: other * sin }];
                    let difference = self.difference(ends);
                    for (i, k) in [(i, k), (k, i)] {
                        let start = ((i * radii + k) * turns + t) * terms;
                        all[start..][..terms].copy_from_slice(&difference);
                    }
                }
            }
        }
        all
    }

    /// Returns the difference of rho from the mean of R_v and R_l, in padded terms.
    fn difference(&self, ends: [Beta; 2]) -> Vec<f64> {
        let mut sum = vec![0.0; self.padded_terms()];
        let mut terms = sum.clone();
        let scale = 1.0 / density(2.0 * self.width, ends[1] - ends[0]);
        let rule = Between::new(ends, self.width, self.index, self.digits);
        with_widest_simd(
            #[inline(always)]
            || {
                for (at, area) in rule.inside() {
                    let product = density(self.width, *at - ends[0]) * density(self.width, *at - ends[1]);
                    self.terms_at(*at, &mut terms);
                    add_padded(&mut sum, &terms, scale * area * product);
                }
                for (end, weight) in ends.into_iter().zip(rule.weights_at_ends([self.width; 2])) {
                    self.terms_at(end, &mut terms);
                    add_padded(&mut sum, &terms, scale * weight - 0.5);
                }
            },
        );
        sum
    }

    pub(super) fn end(&self, at: Beta) -> End {
        let (mut weights, mut terms) = (vec![0.0; self.radii.padded_len()], vec![0.0; self.padded_terms()]);
        self.radii.at(at.length(), &mut weights);
        self.terms_at(at, &mut terms);
        let row = self.differences.len() / self.radii.len();
        let mut differences = vec![0.0; row];
        for (weight, row) in weights.iter().zip(self.differences.chunks_exact(row)) {
            differences.iter_mut().zip(row).for_each(|(sum, value)| *sum += weight * value);
        }
        End { at, terms, differences }
    }

    /// Returns room for a direction on the way.
    pub(super) fn here(&self) -> Here {
        Here {
            at: Beta::default(),
            terms: vec![0.0; self.padded_terms()],
            radial: vec![0.0; self.radii.padded_len()],
            turns: vec![0.0; self.turns.padded_len()],
        }
    }

    /// Moves to a direction on the way.
    #[inline(always)]
    pub(super) fn move_to(&self, at: Beta, here: &mut Here) {
        here.at = at;
        self.terms_at(at, &mut here.terms);
        self.radii.at(at.length(), &mut here.radial);
    }

    /// Adds the light of one pass from an end to here, in padded terms, given the densities of light
    /// scattered twice and once.
    #[inline(always)]
    pub(super) fn add_light(&self, end: &End, here: &mut Here, [twice, once]: [f64; 2], out: &mut [f64]) {
        let scale = 0.5 * twice + once;
        self.turns.at(cosine_between(here.at, end.at), &mut here.turns);
        let row = out.len();
        for (number, out) in out.as_chunks_mut::<LANES>().0.iter_mut().enumerate() {
            // In registers, until all is summed.
            let first = number * LANES;
            let mut sum = [0.0; LANES];
            let mut rows = end.differences.chunks_exact(row);
            for radial in &here.radial[..self.radii.len()] {
                let mut along = [0.0; LANES];
                for (azimuthal, row) in here.turns[..self.turns.len()].iter().zip(&mut rows) {
                    let row = &row[first..][..LANES];
                    along.iter_mut().zip(row).for_each(|(sum, value)| *sum += azimuthal * value);
                }
                sum.iter_mut().zip(along).for_each(|(sum, along)| *sum += radial * along);
            }
            let (there, here) = (&end.terms[first..][..LANES], &here.terms[first..][..LANES]);
            for (((out, sum), there), here) in out.iter_mut().zip(sum).zip(there).zip(here) {
                *out += twice * sum + scale * (there + here);
            }
        }
    }
}

/// `sum += scale * values`, of a multiple of [`LANES`] values.
#[inline(always)]
pub(super) fn add_padded(sum: &mut [f64], values: &[f64], scale: f64) {
    let (sum, values) = (sum.as_chunks_mut::<LANES>().0, values.as_chunks::<LANES>().0);
    for (sum, values) in sum.iter_mut().zip(values) {
        sum.iter_mut().zip(values).for_each(|(sum, value)| *sum += scale * value);
    }
}
