//! Orthonormal polynomials of a random variable, in which a smooth metric is expanded.
//!
//! Each key has a *coordinate*, in which metrics are smooth: its value; for a log-normal key, the logarithm
//! of the value; for a key that is correlated with others, the independent standard normal number from which
//! it is computed. The coordinate of a choice is its index. As many polynomials as there are choices
//! represent any function of them.
//!
//! Moments are those of the distribution itself, not of a sample: sums over its quantiles at 1601 numbers u
//! by the trapezoidal rule in ln(u/(1 - u)). The rule converges exponentially for smooth distributions; for
//! the kink of a triangular distribution its error is 1e-5.
//!
//! Source: W. Gautschi, *Orthogonal Polynomials* (2004), section 2.2.3 (the discretised Stieltjes procedure).

use papilio_sampling::Distribution;

/// Highest degree of a polynomial, except for choices, which have as many polynomials as choices.
const HIGHEST: usize = 12;
/// Largest number of polynomials of a choice.
const MOST_CHOICES: usize = 40;
/// Number of nodes for moments, from -`REACH` to `REACH` in ln(u/(1 - u)). The probability beyond is 1e-14.
const NODES: usize = 1601;
const REACH: f64 = 32.0;

/// Coordinate of a key.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Coordinate {
    /// The number of the key; for a choice, its index.
    Number,
    /// The logarithm of the number.
    Logarithm,
    /// The standard normal number from which the key is computed.
    Deviate,
}

impl Coordinate {
    /// Coordinate of a key; `is_alone` is false if the key is correlated with others.
    pub(super) fn of(distribution: &Distribution, is_alone: bool) -> Self {
        match distribution {
            _ if !is_alone => Self::Deviate,
            Distribution::LogNormal { .. } => Self::Logarithm,
            _ => Self::Number,
        }
    }

    /// Coordinate at a uniform number u, 0 < u < 1.
    pub(super) fn at(self, distribution: &Distribution, u: f64) -> f64 {
        match self {
            Self::Number => distribution.quantile(u),
            Self::Logarithm => distribution.quantile(u).ln(),
            Self::Deviate => {
                let within = [f64::NEG_INFINITY, f64::INFINITY];
                Distribution::Normal { mean: 0.0, sigma: 1.0, within }.quantile(u)
            }
        }
    }
}

/// Orthonormal polynomials of one coordinate.
#[derive(Debug, Clone)]
pub(super) struct Polynomials {
    /// Mean and standard deviation.
    centre: f64,
    scale: f64,
    /// The recurrence `root[k+1] p[k+1] = (x - middle[k]) p[k] - root[k] p[k-1]`.
    middle: Vec<f64>,
    root: Vec<f64>,
    /// True for a choice, whose order has no meaning.
    pub(super) is_choice: bool,
}

impl Polynomials {
    /// Polynomials that are orthonormal for a distribution of the key.
    pub(super) fn of(distribution: &Distribution, coordinate: Coordinate) -> Self {
        let (points, is_choice) = measure(distribution, coordinate);
        let all: f64 = points.iter().map(|(_, weight)| weight).sum();
        let mean = |of: &dyn Fn(f64) -> f64| points.iter().map(|(x, w)| w * of(*x)).sum::<f64>() / all;
        let centre = mean(&|x| x);
        let scale = mean(&|x| (x - centre).powi(2)).sqrt();
        let highest = match is_choice {
            true => (points.len() - 1).min(MOST_CHOICES),
            false => HIGHEST,
        };
        let mut one = Self { centre, scale, middle: Vec::new(), root: vec![0.0], is_choice };
        if scale.is_nan() || scale <= 1e-12 * centre.abs() {
            return one;
        }
        let (mut before, mut last) = (vec![0.0; points.len()], vec![1.0; points.len()]);
        for k in 0..highest {
            let x = points.iter().map(|(x, _)| (x - centre) / scale);
            let weights = points.iter().map(|(_, weight)| weight / all);
            let middle: f64 =
                x.clone().zip(&last).zip(weights.clone()).map(|((x, p), w)| w * x * p * p).sum();
            let next: Vec<f64> = x
                .zip(&last)
                .zip(&before)
                .map(|((x, last), before)| (x - middle) * last - one.root[k] * before)
                .collect();
            let root = next.iter().zip(weights).map(|(p, w)| w * p * p).sum::<f64>().sqrt();
            if root.is_nan() || root < 1e-7 {
                break;
            }
            one.middle.push(middle);
            one.root.push(root);
            before = std::mem::replace(&mut last, next.into_iter().map(|p| p / root).collect());
        }
        one
    }

    /// Highest degree.
    pub(super) fn highest(&self) -> usize {
        self.middle.len()
    }

    /// Appends the values of all polynomials from degree 1 at a coordinate to `to`.
    pub(super) fn values(&self, x: f64, to: &mut Vec<f64>) {
        let x = (x - self.centre) / self.scale;
        let (mut before, mut last) = (0.0, 1.0);
        for (k, middle) in self.middle.iter().enumerate() {
            let next = ((x - middle) * last - self.root[k] * before) / self.root[k + 1];
            (before, last) = (last, next);
            to.push(next);
        }
    }
}

/// Nodes and weights that represent a distribution, and whether they are choices.
fn measure(distribution: &Distribution, coordinate: Coordinate) -> (Vec<(f64, f64)>, bool) {
    if let (Distribution::Choices { weights }, Coordinate::Number) = (distribution, coordinate) {
        let points = weights.iter().enumerate().filter(|(_, weight)| **weight > 0.0);
        return (points.map(|(index, weight)| (index as f64, *weight)).collect(), true);
    }
    let step = 2.0 * REACH / (NODES - 1) as f64;
    let points = (0..NODES).map(|k| step * k as f64 - REACH).map(|logit| {
        let u = (1.0 + (-logit).exp()).recip();
        (coordinate.at(distribution, u), u / (1.0 + logit.exp()))
    });
    (points.collect(), false)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Legendre and Hermite polynomials, and two polynomials for three choices.
    #[test]
    fn polynomials_of_known_distributions_match_closed_forms() {
        let uniform = Distribution::Uniform { from: 2.0, to: 6.0 };
        let mut found = Vec::new();
        Polynomials::of(&uniform, Coordinate::Number).values(5.0, &mut found);
        let x = 0.5_f64;
        let legendre = [x, 1.5 * x * x - 0.5, 2.5 * x.powi(3) - 1.5 * x];
        for (k, wanted) in legendre.iter().enumerate() {
            let wanted = wanted * f64::sqrt(2.0 * k as f64 + 3.0);
            assert!((found[k] - wanted).abs() < 1e-9, "{found:?} {wanted}");
        }
        let normal =
            Distribution::Normal { mean: 1.0, sigma: 2.0, within: [f64::NEG_INFINITY, f64::INFINITY] };
        found.clear();
        Polynomials::of(&normal, Coordinate::Number).values(4.0, &mut found);
        let z = 1.5_f64;
        let hermite = [z, (z * z - 1.0) / f64::sqrt(2.0), (z.powi(3) - 3.0 * z) / f64::sqrt(6.0)];
        hermite.iter().zip(&found).for_each(|(a, b)| assert!((a - b).abs() < 1e-6, "{a} {b}"));
        let choices = Distribution::Choices { weights: vec![1.0, 0.0, 2.0, 1.0] };
        let of_choices = Polynomials::of(&choices, Coordinate::Number);
        assert_eq!((of_choices.highest(), of_choices.is_choice), (2, true));
    }

    /// Moments of a triangular distribution, whose density has a kink, match closed forms: degree 1 is (x -
    /// mean)/sigma.
    #[test]
    fn moments_of_triangular_distribution_match_closed_form() {
        let (from, mode, to) = (-1.0, 0.5, 2.0);
        let mut found = Vec::new();
        let triangle = Distribution::Triangular { from, mode, to };
        Polynomials::of(&triangle, Coordinate::Number).values(1.0, &mut found);
        let squares: f64 = [from, mode, to].iter().map(|x| x * x).sum();
        let sigma = f64::sqrt((squares - from * mode - from * to - mode * to) / 18.0);
        assert!((found[0] - (1.0 - (from + mode + to) / 3.0) / sigma).abs() < 1e-5);
    }
}
