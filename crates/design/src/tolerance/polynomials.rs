//! Orthonormal polynomials of a number that scatters: what a smooth metric is expanded in.
//!
//! Each key has a *coordinate*, in which metrics are smooth: its value; of a log-normal key the value's logarithm; of a key
//! that is correlated with others the independent standard normal number that it is made of. Of a choice it is the
//! choice's place in its list: as many polynomials as there are choices stand for any function of them.
//!
//! Moments are those of the distribution itself, not of a sample: sums over its quantiles at 1601 even numbers u by the trapezoidal
//! rule in ln(u/(1 - u)), which converges exponentially for smooth distributions and is right to 1e-5 for a triangle's kink.
//!
//! Source: W. Gautschi, *Orthogonal Polynomials* (2004), section 2.2.3 (the discretised Stieltjes procedure).

use papilio_sampling::Distribution;

/// No polynomial is of a higher degree; of choices, there are as many as choices.
const HIGHEST: usize = 12;
/// The most choices that each have their own polynomial.
const MOST_CHOICES: usize = 40;
/// Numbers at which moments are summed, from -`REACH` to `REACH` in ln(u/(1 - u)): what lies beyond has a share of 1e-14.
const NODES: usize = 1601;
const REACH: f64 = 32.0;

/// What a key's coordinate is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Coordinate {
    /// The key's number; of a choice its place.
    Number,
    /// Its logarithm.
    Logarithm,
    /// The standard normal number that it is made of.
    Deviate,
}

impl Coordinate {
    /// Of a key, alone or correlated with others.
    pub(super) fn of(distribution: &Distribution, is_alone: bool) -> Self {
        match distribution {
            _ if !is_alone => Self::Deviate,
            Distribution::LogNormal { .. } => Self::Logarithm,
            _ => Self::Number,
        }
    }

    /// The coordinate at an even number, 0 < u < 1.
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
    /// Whether any order of the coordinate is as good as another: of choices.
    pub(super) is_choice: bool,
}

impl Polynomials {
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

    /// The highest degree that there is.
    pub(super) fn highest(&self) -> usize {
        self.middle.len()
    }

    /// Values of degrees 1 and up at a coordinate, appended to `to`.
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

/// Numbers and their weights that stand for a distribution; whether they are choices.
fn measure(distribution: &Distribution, coordinate: Coordinate) -> (Vec<(f64, f64)>, bool) {
    if let (Distribution::Choices { weights }, Coordinate::Number) = (distribution, coordinate) {
        let points = weights.iter().enumerate().filter(|(_, weight)| **weight > 0.0);
        return (points.map(|(place, weight)| (place as f64, *weight)).collect(), true);
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

    /// Legendre's, Hermite's, and any function of three choices.
    #[test]
    fn polynomials_are_those_of_their_distribution() {
        let even = Distribution::Uniform { from: 2.0, to: 6.0 };
        let mut found = Vec::new();
        Polynomials::of(&even, Coordinate::Number).values(5.0, &mut found);
        let x = 0.5_f64;
        let legendre = [x, 1.5 * x * x - 0.5, 2.5 * x.powi(3) - 1.5 * x];
        for (k, wanted) in legendre.iter().enumerate() {
            let wanted = wanted * f64::sqrt(2.0 * k as f64 + 3.0);
            assert!((found[k] - wanted).abs() < 1e-9, "{found:?} {wanted}");
        }
        let bell = Distribution::Normal { mean: 1.0, sigma: 2.0, within: [f64::NEG_INFINITY, f64::INFINITY] };
        found.clear();
        Polynomials::of(&bell, Coordinate::Number).values(4.0, &mut found);
        let z = 1.5_f64;
        let hermite = [z, (z * z - 1.0) / f64::sqrt(2.0), (z.powi(3) - 3.0 * z) / f64::sqrt(6.0)];
        hermite.iter().zip(&found).for_each(|(a, b)| assert!((a - b).abs() < 1e-6, "{a} {b}"));
        let choices = Distribution::Choices { weights: vec![1.0, 0.0, 2.0, 1.0] };
        let of_choices = Polynomials::of(&choices, Coordinate::Number);
        assert_eq!((of_choices.highest(), of_choices.is_choice), (2, true));
    }

    /// Of a triangle, whose second derivative jumps, moments are those of closed forms: degree 1 is (x - mean)/sigma.
    #[test]
    fn a_kink_is_integrated_closely() {
        let (from, mode, to) = (-1.0, 0.5, 2.0);
        let mut found = Vec::new();
        let triangle = Distribution::Triangular { from, mode, to };
        Polynomials::of(&triangle, Coordinate::Number).values(1.0, &mut found);
        let squares: f64 = [from, mode, to].iter().map(|x| x * x).sum();
        let sigma = f64::sqrt((squares - from * mode - from * to - mode * to) / 18.0);
        assert!((found[0] - (1.0 - (from + mode + to) / 3.0) / sigma).abs() < 1e-5);
    }
}
