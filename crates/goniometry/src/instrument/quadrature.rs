//! Integrals over the plane of direction cosines, about the centre of a lobe.

use std::f64::consts::{FRAC_PI_2, PI};

use papilio_optics::Beta;
use papilio_optics::quadrature::legendre;

/// Largest distance: the contribution of larger ones is negligible, because products of two lobes fall as the
/// sixth power.
const FARTHEST: f64 = 20.0;
/// Numbers of nodes: along a ray inside and outside the hemisphere's disc, in azimuth over half a circle
/// limited by a line, and in azimuth over a full circle.
const INSIDE: usize = 22;
const BEYOND: usize = 18;
const HALF_AROUND: usize = 18;
const AROUND: usize = 56;

/// Nodes of the quadrature; computed once.
#[derive(Debug, Clone)]
pub(super) struct Rule {
    inside: Vec<[f64; 2]>,
    beyond: Vec<[f64; 2]>,
    half: Vec<[f64; 2]>,
    around: usize,
}

impl Rule {
    pub(super) fn new() -> Self {
        Self::times(1)
    }

    /// Rule with `n` times as many nodes along each line.
    pub(super) fn times(n: usize) -> Self {
        Self {
            inside: gauss(n * INSIDE),
            beyond: gauss(n * BEYOND),
            half: gauss(n * HALF_AROUND),
            around: n * AROUND,
        }
    }

    /// Integral of a function with features of size `width` about `middle`, smoother elsewhere, which may end
    /// at the rim of the disc |beta| = 1: over the whole plane, or over the disc.
    pub(super) fn plane(&self, middle: Beta, width: f64, whole: bool, f: impl Fn(Beta) -> f64) -> f64 {
        let step = 2.0 * PI / self.around as f64;
        let farthest = if whole { FARTHEST } else { 0.0 };
        let rays = (0..self.around).map(|k| {
            let (sin, cos) = (step * k as f64).sin_cos();
            self.ray(middle, Beta { x: cos, y: sin }, width, farthest, &f)
        });
        rays.sum::<f64>() * step
    }

    /// The same over the half plane of all points nearer to `middle` than to `other`.
    pub(super) fn half_plane(&self, middle: Beta, other: Beta, width: f64, f: impl Fn(Beta) -> f64) -> f64 {
        let separation = other - middle;
        let distance = separation.length();
        let mut sum = 0.0;
        for [node, weight] in &self.half {
            for (from, towards) in [(-FRAC_PI_2, true), (FRAC_PI_2, false)] {
                let (sin, cos) = (from + PI * node).sin_cos();
                let x = (separation.x * cos - separation.y * sin) / distance;
                let y = (separation.x * sin + separation.y * cos) / distance;
                let end = if towards { (0.5 * distance / cos).min(FARTHEST) } else { FARTHEST };
                sum += PI * weight * self.ray(middle, Beta { x, y }, width, end, &f);
            }
        }
        sum
    }

    /// Integral along a ray, times the distance; an end of 0 means the rim of the disc.
    fn ray(&self, middle: Beta, along: Beta, width: f64, end: f64, f: &impl Fn(Beta) -> f64) -> f64 {
        let ahead = middle.x * along.x + middle.y * along.y;
        let rim = (ahead * ahead + 1.0 - middle.squared()).max(0.0).sqrt() - ahead;
        let rim = if end > 0.0 { rim.min(end) } else { rim };
        let piece = |nodes: &[[f64; 2]], from: f64, to: f64| -> f64 {
            let [from, to] = [from, to].map(|r| (r / width).asinh());
            let node = |[node, weight]: &[f64; 2]| {
                let t = from + (to - from) * node;
                let (sinh, cosh) = (t.sinh(), t.cosh());
                let r = width * sinh;
                weight * r * width * cosh * f(Beta { x: middle.x + r * along.x, y: middle.y + r * along.y })
            };
            (to - from) * nodes.iter().map(node).sum::<f64>()
        };
        let inside = piece(&self.inside, 0.0, rim);
        if end > rim { inside + piece(&self.beyond, rim, end) } else { inside }
    }
}

/// Gauss-Legendre nodes and weights on 0 to 1.
fn gauss(count: usize) -> Vec<[f64; 2]> {
    legendre(count, 0.0).into_iter().rev().map(|(x, weight)| [0.5 * (1.0 - x), 0.5 * weight]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gauss_is_exact_for_polynomials() {
        for power in 0..40 {
            let sum: f64 = gauss(20).iter().map(|[x, weight]| weight * x.powi(power)).sum();
            assert!((sum * f64::from(power + 1) - 1.0).abs() < 1e-13, "{power}");
        }
    }

    #[test]
    fn disc_area_and_half_plane_of_gaussian_equal_closed_forms() {
        let rule = Rule::new();
        for x in [0.0, 0.5, 0.99] {
            let disc = rule.plane(Beta { x, y: 0.0 }, 0.05, false, |_| 1.0);
            assert!((disc / PI - 1.0).abs() < 1e-3, "{x}: {disc}");
        }
        // A Gaussian's fraction nearer to its own centre than to a point two standard deviations away:
        // Phi(1).
        let gaussian = |beta: Beta| (-beta.squared() / 0.02).exp() / (0.02 * PI);
        let half = rule.half_plane(Beta::default(), Beta { x: 0.12, y: -0.16 }, 0.1, gaussian);
        assert!((half - 0.841_344_746).abs() < 1e-5, "{half}");
    }
}
