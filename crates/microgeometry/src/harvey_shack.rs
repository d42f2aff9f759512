//! The generalised Harvey-Shack form: what a random face of small slopes scatters at oblique angles, in
//! closed form.
//!
//! **Model.** Heights are Gaussian, with the rms s and a known correlation. Light from gamma₁ to gamma₂ (see
//! [`wave_way`](crate::wave_way)) has the rms phase g^(1/2) = 2π s |gamma₂ ± gamma₁|/λ, which depends on both
//! directions. The fraction A = exp(-g) keeps the regular direction, with g of this direction. The density of
//! the scattered light per unit of beta² is the sum over m of exp(-g) g^m/m! times the lobe of the order m
//! about the regular direction, with g of the scattered direction. Lobes for the correlation exp(-r²/τ²):
//! `(π τ²/(m λ²)) exp(-(π τ beta/λ)²/m)`; for exp(-r/τ): `m b₁/(2π (m² b₁² + beta²)^(3/2))`, b₁ = λ/(2π τ).
//!
//! **Renormalisation.** Scattered light that propagates is multiplied by K, so that it is 1 - A: the light of
//! directions that do not exist goes to those that do. The form before K is symmetric in both directions,
//! hence reciprocal; K, which depends on the incident light alone, is not.
//!
//! **One angle.** With g of the regular direction for all scattered ones, the sum is that of a phase screen
//! that is tilted with the light (the "modified" Harvey-Shack form): regular, scattered and evanescent light
//! add up to 1.
//!
//! **Validity.** Rms slopes below about 0.3, one pass, no shadows. Unpolarised light, Fresnel's fractions of
//! the mean face.
//!
//! Sources: A. Krywonos, J. E. Harvey, N. Choi, J. Opt. Soc. Am. A 28, 1121 (2011); J. E. Harvey et al., Opt.
//! Eng. 51, 013402 (2012).

use std::f64::consts::PI;

use crate::Spectrum;
use crate::goniometer::haze_beta;
use crate::wave_way::{Way, first_inside};
use crate::waves::poisson;

/// What the closed forms give for a way of light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HarveyShack {
    /// Haze with the phases of both directions: of the light that is seen, the fraction beyond |beta| = sin
    /// 2.5 deg from the regular direction.
    pub haze: f64,
    /// K, by which scattered light is multiplied so that none is lost.
    pub renormalisation: f64,
    /// Haze with the phase of the regular direction alone.
    pub one_angle_haze: f64,
}

/// A random face with a lobe of closed form.
pub(crate) struct Lobes {
    shape: Shape,
    rms_um: f64,
    wavelength_um: f64,
    /// Logarithms of factorials.
    factorials: Vec<f64>,
}

/// Lobe of the first order.
#[derive(Debug, Clone, Copy)]
enum Shape {
    /// exp(-beta²/w²), w = λ/(π τ).
    Gaussian { width: f64 },
    /// k-correlation of the width b₁.
    Exponential { width: f64 },
}

/// Light of a way before renormalisation, as fractions.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Scattered {
    /// Within sin 2.5 deg of the regular direction, and seen.
    pub(crate) near: f64,
    /// Beyond it, and seen.
    pub(crate) far: f64,
    /// All that propagates.
    pub(crate) all: f64,
}

impl Lobes {
    /// Those of a face at a wavelength; `None` for spectra without closed form. `most_path`: the largest path
    /// of all ways.
    pub(crate) fn new(spectrum: &Spectrum, wavelength_um: f64, most_path: f64) -> Option<Self> {
        let (shape, rms_um) = match *spectrum {
            Spectrum::Gaussian { rms_um, correlation_um } => {
                (Shape::Gaussian { width: wavelength_um / (PI * correlation_um) }, rms_um)
            }
            Spectrum::Exponential { rms_um, correlation_um, .. } => {
                (Shape::Exponential { width: wavelength_um / (2.0 * PI * correlation_um) }, rms_um)
            }
            Spectrum::Abc { .. } | Spectrum::Table { .. } => return None,
        };
        let most = last_order((2.0 * PI * most_path * rms_um / wavelength_um).powi(2)) as usize;
        let mut factorials = vec![0.0; most + 1];
        for m in 1..=most {
            factorials[m] = factorials[m - 1] + (m as f64).ln();
        }
        Some(Self { shape, rms_um, wavelength_um, factorials })
    }

    /// Square of the rms phase for a path.
    pub(crate) fn g(&self, path: f64) -> f64 {
        (2.0 * PI * path * self.rms_um / self.wavelength_um).powi(2)
    }

    /// Density of the scattered light per unit of beta², at a distance from the regular direction.
    pub(crate) fn density(&self, g: f64, distance: f64) -> f64 {
        if g <= 0.0 {
            return 0.0;
        }
        let first = first_order(g).max(1.0);
        let last = last_order(g);
        let mut weight = (first * g.ln() - g - self.factorials[first as usize]).exp();
        let (mut m, mut sum) = (first, 0.0);
        while m <= last {
            sum += weight * self.lobe(m, distance);
            m += 1.0;
            weight *= g / m;
        }
        sum
    }

    /// Lobe of an order per unit of beta².
    fn lobe(&self, m: f64, distance: f64) -> f64 {
        match self.shape {
            Shape::Gaussian { width } => {
                let square = m * width * width;
                (-distance * distance / square).exp() / (PI * square)
            }
            Shape::Exponential { width } => {
                let width = m * width;
                let square = width * width + distance * distance;
                width / (2.0 * PI * square * square.sqrt())
            }
        }
    }

    /// What a face does with the light of a way.
    pub(crate) fn of(&self, way: &Way) -> HarveyShack {
        let regular = (-self.g(way.path(way.beta))).exp();
        let sees_regular = if way.beta <= way.seen() { regular } else { 0.0 };
        let haze = |far: f64, near: f64| far / (sees_regular + near + far);
        let two = self.scattered(way, true);
        let one = self.scattered(way, false);
        let renormalisation = if two.all > 0.0 { (1.0 - regular) / two.all } else { 1.0 };
        HarveyShack {
            haze: haze(renormalisation * two.far, renormalisation * two.near),
            renormalisation,
            // Along the normal no quadrature is needed.
            one_angle_haze: match way.beta == 0.0 && way.seen() == 1.0 {
                true => self.normal_haze(self.g(way.path(0.0))),
                false => haze(one.far, one.near),
            },
        }
    }

    /// Haze of light along the normal with the rms phase g^(1/2): of the light with |beta| up to 1, the
    /// fraction beyond sin 2.5 deg.
    pub(crate) fn normal_haze(&self, g: f64) -> f64 {
        let beyond = |beta: f64| -> f64 {
            let term = |m: f64| match self.shape {
                Shape::Gaussian { width } => (-(beta / width).powi(2) / m).exp(),
                Shape::Exponential { width } => m * width / (m * width).hypot(beta),
            };
            poisson(g).map(|(m, weight)| weight * term(m)).sum()
        };
        let trapped = beyond(1.0);
        (beyond(haze_beta()) - trapped) / (1.0 - trapped)
    }

    /// Scattered light of a way, with the phases of both directions or of the regular one.
    pub(crate) fn scattered(&self, way: &Way, has_two_angles: bool) -> Scattered {
        let regular = self.g(way.path(way.beta));
        let mut sum = Scattered::default();
        for (distance, weight) in self.distances(way) {
            // Azimuths from the rim of each disc to the middle; those of the smaller disc belong to both.
            let all = first_inside(distance, way.beta, way.disc());
            let seen = first_inside(distance, way.beta, way.seen());
            let of = |from: f64, to: f64| match has_two_angles {
                _ if to <= from => 0.0,
                false => self.density(regular, distance) * (to - from) / PI,
                true => self.around(way, distance, [from, to]) / PI,
            };
            let [hidden, visible] = [of(all, seen), of(seen, PI)].map(|part| weight * part);
            sum.all += hidden + visible;
            *(if distance > haze_beta() { &mut sum.far } else { &mut sum.near }) += visible;
        }
        sum
    }

    /// Integral of the density over azimuths about the regular direction.
    fn around(&self, way: &Way, distance: f64, [from, to]: [f64; 2]) -> f64 {
        let step = (to - from) / AZIMUTHS as f64;
        let at = |k: usize| {
            let cosine = (from + step * (k as f64 + 0.5)).cos();
            let square = way.beta * way.beta + distance * distance + 2.0 * way.beta * distance * cosine;
            self.density(self.g(way.path(square.max(0.0).sqrt())), distance)
        };
        // Along the normal all azimuths are the same.
        if way.beta == 0.0 { (to - from) * at(0) } else { step * (0..AZIMUTHS).map(at).sum::<f64>() }
    }

    /// Distances from the regular direction with their weights, 2π distance times the step: products with the
    /// density are shares of the light.
    fn distances(&self, way: &Way) -> Vec<(f64, f64)> {
        let width = match self.shape {
            Shape::Gaussian { width } | Shape::Exponential { width } => width,
        };
        let last = way.disc() + way.beta;
        let mut edges = vec![0.0];
        let mut edge = 0.1 * width;
        while edge < last {
            edges.push(edge);
            edge *= GROWTH;
        }
        // Where light begins to be haze, and where circles leave the discs.
        let rims = [way.disc(), way.seen()].map(|disc| [disc - way.beta, disc + way.beta]);
        edges.extend(rims.as_flattened().iter().map(|edge| edge.abs()).chain([haze_beta()]));
        edges.retain(|edge| *edge <= last);
        edges.sort_by(f64::total_cmp);
        let of = |pair: &[f64]| {
            let (middle, half) = (0.5 * (pair[0] + pair[1]), 0.5 * (pair[1] - pair[0]));
            GAUSS.map(|(at, weight)| {
                let distance = middle + half * at;
                (distance, 2.0 * PI * distance * half * weight)
            })
        };
        edges.windows(2).filter(|pair| pair[1] > pair[0]).flat_map(of).collect()
    }
}

/// Azimuths of a half circle.
const AZIMUTHS: usize = 12;

/// Ratio of neighbouring edges of the quadrature.
const GROWTH: f64 = 1.6;

/// Gauss-Legendre rule of four points, -1 to 1.
const GAUSS: [(f64, f64); 4] = [
    (-0.861_136_311_594_052_6, 0.347_854_845_137_453_9),
    (-0.339_981_043_584_856_3, 0.652_145_154_862_546_1),
    (0.339_981_043_584_856_3, 0.652_145_154_862_546_1),
    (0.861_136_311_594_052_6, 0.347_854_845_137_453_9),
];

/// First and last order that matter: all but 1e-12 of the light.
fn first_order(g: f64) -> f64 {
    (g - 8.0 * g.sqrt()).floor()
}

fn last_order(g: f64) -> f64 {
    (g + 8.0 * g.sqrt() + 12.0).ceil()
}
