//! Chebyshev coefficients of functions on the nodes of a panel, and what they tell about the missing ones.

use std::f64::consts::PI;
use std::sync::LazyLock;

use papilio_optics::with_widest_simd;
use papilio_transport::CosinePanels;

use super::Aliases;

/// Number of nodes of a panel.
pub(super) const NODES: usize = CosinePanels::NODES;

/// Number of pairs of coefficients.
pub(super) const PAIRS: usize = NODES / 2;

/// Number of last coefficients that are used.
const LAST: usize = 6;

/// Chebyshev polynomials at the nodes, `[degree][node]`, up to the sign of odd ones.
static POLYNOMIALS: LazyLock<[[f64; NODES]; NODES]> = LazyLock::new(|| {
    std::array::from_fn(|degree| {
        std::array::from_fn(|node| (degree as f64 * (PI - PI * (node as f64 + 0.5) / NODES as f64)).cos())
    })
});

/// Factor of the sum of values times polynomials in a coefficient.
fn scale(degree: usize) -> f64 {
    if degree == 0 { 1.0 / NODES as f64 } else { 2.0 / NODES as f64 }
}

/// Returns the weights on the nodes of light with these moments.
pub(super) fn node_weights(moments: &[f64; NODES]) -> [f64; NODES] {
    let at = |node: usize| {
        let term = |(degree, moment): (usize, &f64)| scale(degree) * moment * POLYNOMIALS[degree][node];
        moments.iter().enumerate().map(term).sum()
    };
    std::array::from_fn(at)
}

/// Returns the last coefficients of a function.
pub(super) fn last(values: &[f64; NODES]) -> [f64; LAST] {
    std::array::from_fn(|k| {
        let degree = NODES - LAST + k;
        let products = values.iter().zip(&POLYNOMIALS[degree]).map(|(value, polynomial)| value * polynomial);
        scale(degree) * products.sum::<f64>()
    })
}

/// Geometric bound of coefficients, by pairs, from the last three of them.
#[derive(Debug, Clone, Copy)]
pub(super) struct Decay {
    /// Bound of the last pair.
    size: f64,
    /// Factor from each pair to the next one.
    ratio: f64,
}

/// Largest ratio of pairs that is extrapolated.
const SLOWEST: f64 = 0.95;

impl Decay {
    pub(super) fn of(last: [f64; LAST]) -> Self {
        let [first, second, third] = [0, 2, 4].map(|k: usize| last[k].abs() + last[k + 1].abs());
        let ratio = if first > 0.0 { (third / first).sqrt().min(SLOWEST) } else { 0.0 };
        // A pair may be small by chance: the bound holds for all three.
        Self { size: third.max(second * ratio).max(first * ratio * ratio), ratio }
    }

    /// Returns the error of light with these factors.
    pub(super) fn error(&self, aliases: &Aliases) -> f64 {
        let (mut pair, mut sum) = (self.size, 0.0);
        for alias in &aliases[..PAIRS] {
            pair *= self.ratio;
            sum += pair * alias;
        }
        sum + pair * self.ratio / (1.0 - self.ratio) * aliases[PAIRS]
    }
}

/// Returns sums over wavelength of values `[node][gap][wavelength]`, weighted by each quantity of a colour, at the nodes:
/// `[quantity][gap]`.
pub(super) fn colour_sums(values: &[f64], colour: &[Vec<f64>], gaps: usize) -> Vec<[f64; NODES]> {
    let bins = values.len() / (NODES * gaps);
    let mut sums = vec![[0.0; NODES]; colour.len() * gaps];
    with_widest_simd(
        #[inline(always)]
        || {
            for (row, spectrum) in values.chunks_exact(bins).enumerate() {
                let (node, gap) = (row / gaps, row % gaps);
                for (quantity, weights) in colour.iter().enumerate() {
                    sums[quantity * gaps + gap][node] = dot(spectrum, weights);
                }
            }
        },
    );
    sums
}

#[inline(always)]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    const LANES: usize = 16;
    let (a, a_rest) = a.as_chunks::<LANES>();
    let (b, b_rest) = b.as_chunks::<LANES>();
    let mut sums = [0.0; LANES];
    for (a, b) in a.iter().zip(b) {
        for k in 0..LANES {
            sums[k] += a[k] * b[k];
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    sums.iter().sum::<f64>() + rest
}

/// Returns the decay of the mean magnitude of the coefficients over wavelength, for each gap.
pub(super) fn roughness(values: &[f64], gaps: usize) -> Vec<Decay> {
    let bins = values.len() / (NODES * gaps);
    let mut all = vec![0.0; LAST * gaps * bins];
    with_widest_simd(
        #[inline(always)]
        || {
            for (k, row) in all.chunks_exact_mut(gaps * bins).enumerate() {
                let polynomial = &POLYNOMIALS[NODES - LAST + k];
                for (values, factor) in values.chunks_exact(gaps * bins).zip(polynomial) {
                    row.iter_mut().zip(values).for_each(|(sum, value)| *sum += factor * value);
                }
            }
        },
    );
    let mean = |k: usize, gap: usize| {
        let row = &all[(k * gaps + gap) * bins..][..bins];
        scale(1) * row.iter().map(|value| value.abs()).sum::<f64>() / bins as f64
    };
    (0..gaps).map(|gap| Decay::of(std::array::from_fn(|k| mean(k, gap)))).collect()
}
