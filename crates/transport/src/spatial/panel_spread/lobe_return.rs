//! Light of a Lambertian pixel that leaves through a diffuser, and that a front of screen sends back through
//! it.
//!
//! **What.** What leaves the diffuser along beta is spread by `B(beta, f)`, the transform of the lobe around
//! beta over the directions in the glass, and again on its way down; of a front that reflects everything
//! `A(f) = 1/(pi n^2) integral of B(beta, f)^2 exp(-2 pi i f.2D_air(beta)) d^2 beta` over the disc of air.
//!
//! **How.** At low frequencies B is the sum over all directions in the glass. At high ones, where little
//! comes back, the shift is taken as linear in the direction over the width of a lobe: B is then the
//! transform of the lobe in the plane, `exp(-b |w|)` of a k-correlation lobe of width b, w being the phase
//! per direction cosine. What a Lambertian diffuser returns there is neglected.

use std::f64::consts::{FRAC_PI_2, PI};

use num_complex::Complex64;
use papilio_optics::Beta;
use papilio_optics::lobe::Lobe;

use super::super::spread::{Bundle, Incoming, Pair, Spread};
use super::super::{Accuracy, Gap, Sample, displacement};
use super::Heights;
use crate::Diffuser;
use crate::numerics::quadrature::{MOST_POINTS, Node, gauss};

/// Places farther than this, in thicknesses of the glass, count as this far: little light goes there. Where
/// the index is so low that light of the air goes farther, its way is resolved up to the second one over
/// `1 + 2 f d`: far light matters at low frequencies alone.
const FARTHEST: f64 = 4.0;
const FARTHEST_OF_AIR: f64 = 30.0;

/// Number of places in addition to the phase, in radians, from the middle to the farthest place at the
/// highest frequency.
const MORE_PLACES: f64 = 10.0;

/// Fewest natural digits, and how many fewer than for other light: little comes back.
const DIGITS: f64 = 4.0;
const DIGITS_LESS: f64 = 4.0;

/// Rings of directions for each digit: grazing light in the air has phases that no rule resolves.
const RINGS: f64 = 5.0;

/// Light that leaves a diffuser in a direction.
#[derive(Debug)]
pub(super) struct Lit {
    weight: f64,
    /// Return trip through the air along x, mm.
    air_mm: f64,
    below: Below,
}

/// Its light on the pixel.
#[derive(Debug)]
enum Below {
    /// Weights and places along x, mm.
    Places(Vec<[f64; 2]>),
    /// Unscattered and scattered fraction about a place along x, and the width of the blur, mm.
    Local { parts: [f64; 2], at_mm: f64, width_mm: f64 },
}

impl Lit {
    /// The real part: that of the opposite direction has the opposite imaginary part.
    fn at(&self, wave: f64) -> f64 {
        let spread: Complex64 = match &self.below {
            Below::Places(all) => {
                all.iter().map(|[weight, x]| Complex64::from_polar(*weight, -wave * x)).sum()
            }
            Below::Local { parts: [straight, scattered], at_mm, width_mm } => {
                Complex64::from_polar(straight + scattered * (-wave * width_mm).exp(), -wave * at_mm)
            }
        };
        self.weight * (spread * spread * Complex64::cis(-wave * self.air_mm)).re
    }
}

/// What comes back at a frequency (cycles per mm) of light in all these directions.
pub(super) fn returned(lit: &[Lit], frequency_per_mm: f64) -> f64 {
    lit.iter().map(|lit| lit.at(2.0 * PI * frequency_per_mm)).sum()
}

/// Prepares a diffuser below a front that reflects everything, up to a frequency; high ones are `local`.
pub(super) fn lit(
    diffuser: &Diffuser,
    index: f64,
    heights: Heights,
    accuracy: Accuracy,
    local: bool,
) -> Vec<Lit> {
    let width = match diffuser.lobe {
        Lobe::KCorrelation { width } => width,
        Lobe::Lambertian if local => return Vec::new(),
        Lobe::Lambertian => 1.0,
    };
    let accuracy = Accuracy { digits: (accuracy.digits - DIGITS_LESS).max(DIGITS), ..accuracy };
    let gap = Gap { index, thickness_mm: heights.glass_mm };
    // Phase of the light at the rim of the disc of air.
    let edge = 1.0 / (index * index - 1.0).max(f64::EPSILON).sqrt();
    let farthest =
        (FARTHEST_OF_AIR / (1.0 + 2.0 * accuracy.most_per_mm * heights.glass_mm)).min(edge).max(FARTHEST);
    let phase = 4.0 * PI * accuracy.most_per_mm * (heights.glass_mm * edge.min(farthest) + heights.front_mm);
    let turns = (accuracy.digits + phase).ceil();
    let mut all = Vec::new();
    // |beta| = sin x: ways through the air grow without limit towards grazing light, of which there is little.
    let rings = RINGS * accuracy.digits + 0.5 * phase;
    for node in gauss_of(0.0, FRAC_PI_2, rings.ceil() as usize) {
        let (beta, cos_out) = node.x.sin_cos();
        let ring = 2.0 * PI * beta * cos_out * node.weight;
        for turn in 0..turns as usize {
            let (sin, cos) = (PI * (turn as f64 + 0.5) / turns).sin_cos();
            let beta = Beta { x: beta * cos, y: beta * sin };
            let below = if local {
                about(diffuser, gap, beta, width)
            } else {
                let pair = Pair::new(diffuser, gap, Bundle::point(beta), Incoming::Pixel, accuracy);
                let wave = 2.0 * PI * accuracy.most_per_mm;
                let own = displacement(beta, gap.thickness_mm, index)[0];
                Below::Places(places(Spread::of(pair).samples(), own, farthest * heights.glass_mm, wave))
            };
            let weight = ring / (turns * PI * index * index);
            all.push(Lit { weight, air_mm: displacement(beta, 2.0 * heights.front_mm, 1.0)[0], below });
        }
    }
    all
}

/// Gauss's rule of many points, in panels.
fn gauss_of(from: f64, to: f64, points: usize) -> Vec<Node> {
    let panels = points.div_ceil(MOST_POINTS);
    let step = (to - from) / panels as f64;
    let panel =
        |k: usize| gauss(from + k as f64 * step, from + (k + 1) as f64 * step, points.div_ceil(panels));
    (0..panels).flat_map(panel).collect()
}

/// Light about a direction, whose shift changes with it as at the direction itself.
fn about(diffuser: &Diffuser, Gap { index, thickness_mm }: Gap, beta: Beta, width: f64) -> Below {
    let square = index * index;
    let cube = (square - beta.squared()).powf(1.5);
    let slope = (square - beta.y * beta.y).hypot(beta.x * beta.y) / cube;
    let straight = diffuser.regular_fraction;
    let inside = diffuser.lobe.fraction_in_disc(beta.length(), index);
    Below::Local {
        parts: [straight, (1.0 - straight) * inside],
        at_mm: displacement(beta, thickness_mm, index)[0],
        width_mm: width * thickness_mm * slope,
    }
}

/// Few places along x from where the light leaves, of samples about the place `own`, none farther than a
/// distance (mm), that have the same transform up to a frequency
/// (radians per mm): by polynomials through Chebyshev's points.
fn places(samples: &[Sample], own: f64, farthest: f64, wave: f64) -> Vec<[f64; 2]> {
    let x = |sample: &Sample| (own + sample.place_mm[0]).clamp(-farthest, farthest);
    let [low, high] = samples
        .iter()
        .map(x)
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)]);
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    let count = (wave * half + MORE_PLACES).ceil() as usize;
    if samples.len() <= count || half <= 0.0 {
        return samples.iter().map(|sample| [sample.weight, x(sample)]).collect();
    }
    let angle = |k: usize| PI * (k as f64 + 0.5) / count as f64;
    let nodes: Vec<f64> = (0..count).map(|k| angle(k).cos()).collect();
    let factors: Vec<f64> =
        (0..count).map(|k| if k % 2 == 0 { angle(k).sin() } else { -angle(k).sin() }).collect();
    let (mut weights, mut terms) = (vec![0.0; count], vec![0.0; count]);
    for sample in samples {
        let t = (x(sample) - middle) / half;
        if let Some(k) = nodes.iter().position(|node| *node == t) {
            weights[k] += sample.weight;
            continue;
        }
        let mut total = 0.0;
        for ((term, node), factor) in terms.iter_mut().zip(&nodes).zip(&factors) {
            *term = factor / (t - node);
            total += *term;
        }
        weights.iter_mut().zip(&terms).for_each(|(sum, term)| *sum += sample.weight * term / total);
    }
    weights.into_iter().zip(nodes).map(|(weight, t)| [weight, middle + half * t]).collect()
}
