//! Slopes of an interface, and their shadowing: Smith's Lambda for heights that are independent of slopes.
//!
//! A ray in a direction of cosine mu over heights that fill (0, 1) uniformly meets microfacets at the rate
//! Lambda if it leaves, 1 + Lambda if it arrives, per logarithm of the height: light at the height C leaves
//! with the probability `C^Lambda`. Everything else here follows from that (E. Heitz et al.,
//! "Multiple-Scattering Microfacet BSDFs with the Smith Model", ACM Trans. Graph. 35 (4), 58 (2016), eq. 4
//! to 12).

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use papilio_sampling::{erfc, erfc_inv, warp};

use super::invert;
use super::student::{self, StudentSlopes};

/// Distribution of the slopes of an interface.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Distribution {
    /// GGX (Trowbridge-Reitz): half of the interface is steeper than `atan alpha`, and few microfacets are
    /// very steep.
    #[default]
    Ggx,
    /// Gaussian slopes of variance `alpha^2/2` along each axis: hardly any microfacet is steeper than 2.5
    /// alpha.
    Beckmann,
    /// Student's t-distribution, between the other two.
    StudentT {
        /// gamma, 2 (GGX) to 1000 (almost Beckmann): the fraction steeper than a slope falls with the power
        /// `2 - 2 gamma` of large slopes.
        tail: f64,
    },
}

impl Distribution {
    /// Returns the density per steradian of normals along a vector with these squares of its tangential part
    /// and of its z component; their sum is not 0.
    pub fn normals(self, alpha: f64, tangential: f64, z_squared: f64) -> f64 {
        let alpha_squared = alpha * alpha;
        match self {
            Self::Ggx => {
                let ratio = (tangential + z_squared) / (alpha_squared * z_squared + tangential);
                alpha_squared * ratio * ratio / PI
            }
            Self::Beckmann if z_squared == 0.0 => 0.0,
            Self::Beckmann => {
                let ratio = (tangential + z_squared) / z_squared;
                (-tangential / (alpha_squared * z_squared)).exp() * ratio * ratio / (PI * alpha_squared)
            }
            Self::StudentT { tail } => {
                let core = (tail - 1.0) * alpha_squared;
                let length = core * z_squared + tangential;
                let ratio = (tail - 1.0) * (tangential + z_squared) / length;
                alpha_squared * ratio * ratio * (core * z_squared / length).powf(tail - 2.0) / PI
            }
        }
    }

    /// Returns the fraction of the area, seen from above, with slope `alpha tan(w)`, per unit of w from 0 to
    /// pi/2.
    pub(super) fn slopes(self, w: f64) -> f64 {
        let (sin, cos) = w.sin_cos();
        match self {
            Self::Ggx => 2.0 * sin * cos,
            Self::Beckmann if w >= FRAC_PI_2 => 0.0,
            Self::Beckmann => {
                let tan = sin / cos;
                2.0 * tan * (-tan * tan).exp() / (cos * cos)
            }
            Self::StudentT { tail } => {
                let core = (tail - 1.0) * cos * cos;
                let ratio = (tail - 1.0) / (core + sin * sin);
                2.0 * sin * cos * ratio * ratio * (core / (core + sin * sin)).powf(tail - 2.0)
            }
        }
    }

    /// Returns `q Lambda` for a wave vector with this component q >= 0 along the normal, and this square of
    /// its length along the interface.
    pub fn hidden(self, alpha: f64, q: f64, beta_squared: f64) -> f64 {
        let across = alpha * alpha * beta_squared;
        match self {
            Self::Ggx => 0.5 * across / (q + (q * q + across).sqrt()),
            Self::Beckmann => {
                let (across, ratio) = (across.sqrt(), q / across.sqrt());
                // Beyond, it is below 1e-32; at normal incidence the ratio is infinite.
                if ratio.is_nan() || ratio > 8.0 {
                    return 0.0;
                }
                let gauss = 0.5 * across * (-ratio * ratio).exp() / PI.sqrt();
                (gauss - 0.5 * q * erfc(ratio)).max(0.0)
            }
            Self::StudentT { tail } => student::hidden_exactly(tail, [alpha, q, beta_squared]),
        }
    }

    /// Samples a normal, of any length, among those of an interface of alpha 1 that are visible to light
    /// from `towards`, a unit vector, weighted by their projected areas.
    pub(super) fn visible(self, towards: [f64; 3], [u, v]: [f64; 2]) -> [f64; 3] {
        match self {
            Self::StudentT { tail } => StudentSlopes::new(tail).visible(towards, [u, v]),
            // Spherical caps: J. Dupuy, A. Benyoub, Comput. Graph. Forum 42 (8), 2023.
            Self::Ggx => {
                let z = 1.0 - v * (1.0 + towards[2]);
                let (x, y) = warp::polar(((1.0 - z) * (1.0 + z)).max(0.0).sqrt(), u);
                [x + towards[0], y + towards[1], z + towards[2]]
            }
            Self::Beckmann => {
                let across = towards[0].hypot(towards[1]);
                let (cos, sin) =
                    if across > 0.0 { (towards[0] / across, towards[1] / across) } else { (1.0, 0.0) };
                let (along, beside) =
                    (visible_slope(across, towards[2], v), erfc_inv(2.0 * u.clamp(1e-16, 1.0)));
                [cos * along - sin * beside, sin * along + cos * beside, 1.0]
            }
        }
    }
}

/// Samples a Gaussian slope towards the light, weighted by `cos + slope sin` where that is positive.
fn visible_slope(sin: f64, cos: f64, u: f64) -> f64 {
    let least = if sin > 0.0 { (-cos / sin).max(-6.0) } else { -6.0 };
    let gauss = |x: f64| (-x * x).exp();
    let steeper = |x: f64| 0.5 * (cos * PI.sqrt() * erfc(x) + sin * gauss(x));
    let all = steeper(least);
    invert([least, 6.0], -u * all, |x| -steeper(x), |x| (cos + x * sin) * gauss(x))
}

/// Returns Euler's `B(1 + x, 1 + y)`, x and y from 0, to 2e-10: the probability that light at a height is
/// shadowed neither from above (Lambda = x) nor from below (y), averaged over heights.
pub(super) fn beta_function(x: f64, y: f64) -> f64 {
    let (x, y) = (x.max(y), x.min(y));
    let t = x + y + G + 1.5;
    // From three gammas, each as sqrt(2 pi) (z + G + 1/2)^(z + 1/2) exp(-z - G - 1/2) P(z)/Q(z).
    let power = (x + 0.5) * (-(y + 1.0) / t).ln_1p() + (y + 0.5) * ((y + G + 0.5) / t).ln() - G + 0.5;
    let [[p_x, q_x], [p_y, q_y], [p, q]] =
        [x, y, x + y + 1.0].map(|z| [polynomial(z, &P), polynomial(z, &Q)]);
    (TAU / t).sqrt() * power.exp() * (p_x * p_y * q) / (q_x * q_y * p)
}

/// Constants of C. Lanczos, SIAM J. Numer. Anal. 1, 86 (1964), with seven terms as given by W. Press et al.
/// (Numerical Recipes, 2nd ed., 6.1), over their common denominator `(z + 1) .. (z + 6)`.
const G: f64 = 5.0;
const P: [f64; 7] = [
    29_969.594_579_836_12,
    32_281.064_054_924_595,
    14_484.914_063_712_14,
    3_465.709_449_213_182,
    466.334_201_454_057_85,
    33.458_333_328_160_23,
    1.000_000_000_190_015,
];
const Q: [f64; 7] = [720.0, 1764.0, 1624.0, 735.0, 175.0, 21.0, 1.0];

fn polynomial(z: f64, coefficients: &[f64; 7]) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, coefficient| sum * z + coefficient)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Computed by mpmath 1.3, 40 digits.
    #[test]
    #[rustfmt::skip]
    fn beta_function_equals_published_values() {
        for (x, all) in [
            (0.0, [1.0, 0.9999000099990001, 0.7142857142857143, 0.3333333333333333, 0.03225806451612903]),
            (1e-9, [0.999999999, 0.9999000089990356, 0.7142857134070594, 0.3333333327222222, 0.032258064386217894]),
            (0.03, [0.970873786407767, 0.9707748479763262, 0.6887500942528862, 0.3156851148312497, 0.028607417997020667]),
            (0.7, [0.5882352941176471, 0.5881544797311541, 0.36685239882855974, 0.1177648236471766, 0.0025992411788967116]),
            (5.0, [0.16666666666666666, 0.16662583957746172, 0.06907750473926944, 0.005952380952380952, 8.556697361251441e-8]),
            (80.0, [0.012345679012345678, 0.012339535179459437, 0.0018822530911863698, 3.6278809909919716e-6, 1.0768300681142643e-29]),
            (3e6, [3.3333322222225924e-7, 3.3281724692723093e-7, 7.587221650818657e-10, 7.407392592613168e-20, 4.293677047560741e-169]),
        ] {
            for (y, exact) in [0.0, 1e-4, 0.4, 2.0, 30.0].into_iter().zip(all) {
                let found = beta_function(x, y);
                assert!((found / exact - 1.0).abs() < 1e-8, "{x} {y}: {found} {exact}");
                assert_eq!(found, beta_function(y, x));
            }
        }
    }

    /// The visible area of an interface from any direction is its projection: the integral of the projected
    /// areas of microfacets is `cos (1 + Lambda)`, by the midpoint rule over slopes.
    #[test]
    fn visible_area_equals_projection() {
        let [heavy, light] = [2.3, 9.0].map(|tail| Distribution::StudentT { tail });
        for distribution in [Distribution::Ggx, Distribution::Beckmann, heavy, light] {
            for (alpha, theta) in [(0.3, 0.2_f64), (0.3, 1.4), (1.0, 1.0)] {
                let (mut seen, steps) = (0.0, 800);
                for i in 0..steps {
                    let w = FRAC_PI_2 * (f64::from(i) + 0.5) / f64::from(steps);
                    let ring = (0..steps).map(|j| {
                        let phi = PI * (f64::from(j) + 0.5) / f64::from(steps);
                        (theta.cos() + alpha * w.tan() * theta.sin() * phi.cos()).max(0.0)
                    });
                    seen += distribution.slopes(w) * ring.sum::<f64>() / f64::from(steps);
                }
                seen *= FRAC_PI_2 / f64::from(steps);
                let expected = theta.cos() + distribution.hidden(alpha, theta.cos(), theta.sin().powi(2));
                assert!(
                    (seen / expected - 1.0).abs() < 2e-5,
                    "{distribution:?} {alpha} {theta}: {seen} {expected}"
                );
            }
        }
    }
}
