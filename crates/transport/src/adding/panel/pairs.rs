//! The product of two k-correlation lobes, integrated over the azimuth of a circle in closed form.
//!
//! On a circle of radius r, the squared distance from a lobe's centre at radius a, plus `b²`, is
//! `A - C cos phi` with `A = a² + b² + r²` and `C = 2 a r`. Divided by `S = sqrt(A² - C²)` it is the product,
//! in the metric `(+, -, -)`, of the null vector `(1, cos phi, sin phi)` with the unit vector
//! `X = (A, C, 0)/S`, for a centre at azimuth 0. A Lorentz transformation that brings the middle of two such
//! vectors to rest moves their poles in azimuth symmetrically about the circle:
//!
//! `integral of (X1 N)^(-3/2) (X2 N)^(-3/2) dphi = integral of (M - T1 cos psi - T2 sin psi)² (cosh² - sinh² cos² psi)^(-3/2) dpsi`,
//!
//! with d the distance of X1 and X2 (`X1 X2 = cosh d`), hyperbolic functions of d/2, and `(M, T1, T2)` the
//! transformed vector (1, 0, 0). This is a complete elliptic integral, which Bulirsch's `cel` computes
//! without cancellation (Numer. Math. 13, 305 (1969)).

use std::f64::consts::PI;

use super::first_pass::SAME_RADIUS;
use super::lobes::LANES;
use crate::light::cone_points::Point;

/// Pairs of points of two sets; pairs that differ only by a rotation or a reflection in azimuth are combined.
pub(super) struct Pairs(Vec<Pair>);

/// Two radii, the squared sine of half the azimuth between them, and the product of the weights.
struct Pair {
    radii: [f64; 2],
    turn: f64,
    weight: f64,
}

impl Pairs {
    /// Returns the pairs of two sets; `None` if they are more than the given number.
    pub(super) fn new([one, other]: [&[Point]; 2], most: usize) -> Option<Self> {
        let mut pairs: Vec<Pair> = Vec::new();
        for (p, q) in one.iter().flat_map(|p| other.iter().map(move |q| (p, q))) {
            let radii = [p, q].map(|point| point.beta.length());
            let turn = turn([p, q], radii);
            let same = |pair: &Pair| {
                let near = |(a, b): (f64, f64)| (a - b).abs() <= SAME_RADIUS;
                near((pair.radii[0], radii[0])) && near((pair.radii[1], radii[1])) && near((pair.turn, turn))
            };
            match pairs.iter().position(same) {
                Some(place) => pairs[place].weight += p.weight * q.weight,
                None if pairs.len() == most => return None,
                None => pairs.push(Pair { radii, turn, weight: p.weight * q.weight }),
            }
        }
        Some(Self(pairs))
    }

    pub(super) fn len(&self) -> usize {
        self.0.len()
    }

    /// Returns the sum of the integrals of all pairs at these radii.
    #[inline(always)]
    pub(super) fn at(&self, width: f64, radii: &[f64; LANES]) -> [f64; LANES] {
        let mut sum = [0.0; LANES];
        for pair in &self.0 {
            let integral = pair.integral(width, radii);
            sum.iter_mut().zip(integral).for_each(|(sum, value)| *sum += pair.weight * value);
        }
        let scale = (width / (2.0 * PI)).powi(2);
        sum.map(|sum| scale * sum)
    }
}

/// Returns the squared sine of half the azimuth between two points.
fn turn([p, q]: [&Point; 2], [a, c]: [f64; 2]) -> f64 {
    if a == 0.0 || c == 0.0 {
        return 0.0;
    }
    let (x, y) = (p.beta.x / a - q.beta.x / c, p.beta.y / a - q.beta.y / c);
    0.25 * (x * x + y * y)
}

impl Pair {
    #[inline(always)]
    fn integral(&self, width: f64, radii: &[f64; LANES]) -> [f64; LANES] {
        let square = width * width;
        let mut kc = [0.0; LANES];
        let mut scales = [0.0; LANES];
        let mut factors = [[0.0; LANES]; 2];
        for (k, r) in radii.iter().enumerate() {
            // Squared distances to the nearest and the farthest point of the circle; their sum is 2 A.
            let [near, far] = [-1.0, 1.0].map(|side| self.radii.map(|a| square + (r + side * a).powi(2)));
            let size: [f64; 2] = std::array::from_fn(|i| (near[i] * far[i]).sqrt());
            let x: [f64; 2] = std::array::from_fn(|i| 0.5 * (near[i] + far[i]) / size[i]);
            let both = size[0] * size[1];
            let apart = (near[0] * far[1]).sqrt() - (far[0] * near[1]).sqrt();
            let turned = 8.0 * r * r * self.radii[0] * self.radii[1] * self.turn;
            let sinh = (0.25 * apart * apart + 0.5 * turned) / both;
            let cosh = 1.0 + sinh;
            let middle = (x[0] + x[1]).powi(2) / (4.0 * cosh);
            // Undetermined, and without effect, where the vectors are the same.
            let along = ((x[0] - x[1]).powi(2) / (4.0 * sinh).max(f64::MIN_POSITIVE)).min(middle - 1.0);
            factors[0][k] = 2.0 * middle - 1.0 - along;
            factors[1][k] = middle + along;
            kc[k] = 1.0 / cosh.sqrt();
            let product = both * cosh;
            scales[k] = 4.0 / (product * product.sqrt());
        }
        let integrals = elliptic(kc, factors);
        std::array::from_fn(|k| scales[k] * integrals[k])
    }
}

/// Returns the integrals of `(a cos² + b sin²)/(cos² + kc² sin²)^(3/2)` from 0 to pi/2, `cel(kc, kc², a, b)`.
#[inline(always)]
fn elliptic(kc: [f64; LANES], [mut a, b]: [[f64; LANES]; 2]) -> [f64; LANES] {
    let mut k = kc;
    let (mut e, mut p, mut mean) = (kc, kc, [1.0; LANES]);
    let mut b: [f64; LANES] = std::array::from_fn(|i| b[i] / kc[i]);
    for _ in 0..MOST_STEPS {
        let mut is_done = true;
        for i in 0..LANES {
            let (before, inverse) = (a[i], 1.0 / p[i]);
            a[i] += b[i] * inverse;
            let g = e[i] * inverse;
            b[i] = 2.0 * (b[i] + before * g);
            p[i] += g;
            let last = mean[i];
            mean[i] += k[i];
            is_done &= (last - k[i]).abs() <= PRECISION * last;
            k[i] = 2.0 * e[i].sqrt();
            e[i] = k[i] * mean[i];
        }
        if is_done {
            break;
        }
    }
    std::array::from_fn(|i| 0.5 * PI * (b[i] + a[i] * mean[i]) / (mean[i] * (mean[i] + p[i])))
}

/// Relative difference of the two means at which the iteration ends: its square is the error.
const PRECISION: f64 = 1e-6;

/// Six are enough for lobes as narrow as 1e-6.
const MOST_STEPS: usize = 12;
