//! Blur of rotationally symmetric profiles, and its removal, on rings about the specular direction.

use std::f64::consts::PI;

use papilio_optics::Beta;
use papilio_optics::lobe::Lobe;

use super::DeblurOptions;
use super::blur::HALF;
use crate::Shape;

/// Radial nodes: `r = w sinh t`, with w half the blur, in steps of t up to a largest distance.
const STEP: f64 = 0.04;
const FARTHEST: f64 = 4.0;
/// Number of azimuths of a profile's mean, on half a circle.
const AROUND: usize = 24;
/// An iteration that reduces the misfit by less than this fraction is the last.
const MIN_DECREASE: f64 = 3e-4;
/// Smallest misfit that the matrix can resolve.
const RESOLVED: f64 = 2e-5;

/// Rings about the specular direction, and the blur between them.
pub(super) struct Rings {
    width: f64,
    radii: Vec<f64>,
    areas: Vec<f64>,
    /// Blur matrix, row by row.
    matrix: Vec<f64>,
    /// Blur of a constant: less than 1 near the outer end.
    constant_blur: Vec<f64>,
}

impl Rings {
    pub(super) fn new(blur: f64) -> Self {
        let width = 0.5 * blur;
        let count = ((FARTHEST / width).asinh() / STEP).ceil() as usize + 1;
        let radii: Vec<f64> = (0..count).map(|k| width * (STEP * k as f64).sinh()).collect();
        let area = |k: usize| {
            let cosh = width.hypot(radii[k]);
            // Trapezoidal rule in t; the first node, where the integrand is 0, has the Euler-Maclaurin
            // correction.
            match k {
                0 => STEP * STEP * width * width / 12.0,
                k if k + 1 == count => 0.5 * STEP * radii[k] * cosh,
                k => STEP * radii[k] * cosh,
            }
        };
        let areas: Vec<f64> = (0..count).map(area).collect();
        let kernel = Lobe::KCorrelation { width: blur };
        let farthest = radii[count - 1];
        let constant_blur: Vec<f64> = radii.iter().map(|r| kernel.fraction_in_disc(*r, farthest)).collect();
        let mut matrix = Vec::with_capacity(count * count);
        for (k, to) in radii.iter().enumerate() {
            matrix.extend(radii.iter().zip(&areas).map(|(from, area)| area * around(*to, *from, blur)));
            // At large distances the steps are coarser than the kernel; the sum of a row is known, and
            // corrects it.
            let sum: f64 = matrix[k * count..].iter().sum();
            matrix[k * count + k] += constant_blur[k] - sum;
        }
        Self { width, radii, areas, matrix, constant_blur }
    }

    fn blurred(&self, profile: &[f64]) -> Vec<f64> {
        let row = |row: &[f64]| row.iter().zip(profile).map(|(a, p)| a * p).sum();
        self.matrix.chunks_exact(profile.len()).map(row).collect()
    }

    /// Mean of a lobe over azimuth within the hemisphere; of its tail where all azimuths are beyond the
    /// horizon.
    pub(super) fn profile(&self, shape: &Shape, incidence: usize, from: Beta) -> Vec<f64> {
        let mean = |r: &f64| {
            let mut sums = [[0.0; 2]; 2];
            for k in 0..AROUND {
                let (sin, cos) = (PI * (k as f64 + 0.5) / AROUND as f64).sin_cos();
                let delta = Beta { x: r * cos, y: r * sin };
                let beyond = usize::from((from + delta).squared() > 1.0);
                sums[beyond][0] += shape.value(incidence, delta);
                sums[beyond][1] += 1.0;
            }
            let [sum, count] = if sums[0][1] > 0.0 { sums[0] } else { sums[1] };
            sum / count
        };
        self.radii.iter().map(mean).collect()
    }

    /// Integral of a profile over the hemisphere, for light of this |beta|.
    pub(super) fn total(&self, profile: &[f64], beta: f64) -> f64 {
        let inside = |r: f64| {
            let cos = (1.0 - beta * beta - r * r) / (2.0 * beta * r);
            if beta * r > 0.0 {
                1.0 - cos.clamp(-1.0, 1.0).acos() / PI
            } else {
                f64::from(u8::from(r <= 1.0))
            }
        };
        let rings = self.radii.iter().zip(&self.areas).zip(profile);
        2.0 * PI * rings.map(|((r, area), p)| area * inside(*r) * p).sum::<f64>()
    }

    /// Returns the factors that remove the blur from a profile, and the number of iterations.
    pub(super) fn sharpened(
        &self,
        d: &[f64],
        how: &DeblurOptions,
        fixed: Option<usize>,
    ) -> (Vec<f64>, usize) {
        let flat = || (vec![1.0; d.len()], 0);
        let below_half = d.iter().position(|value| *value < 0.5 * d[0]).filter(|k| *k > 0);
        let Some(k) = below_half else { return flat() };
        // The power -2/3 of a k-correlation lobe is linear in r^2.
        let [near, half, far] = [d[k - 1], 0.5 * d[0], d[k]].map(|value| value.max(1e-300).powf(-2.0 / 3.0));
        let [inner, outer] = [self.radii[k - 1], self.radii[k]].map(|r| r * r);
        let seen = (inner + (outer - inner) * (half - near) / (far - near)).sqrt() / HALF;
        let sharp = (seen - how.width).max(0.1 * seen);
        let lobe = |width: f64, r: f64| width / (width * width + r * r).powf(1.5);
        let mut p: Vec<f64> =
            d.iter().zip(&self.radii).map(|(d, r)| d * lobe(sharp, *r) / lobe(seen, *r)).collect();
        let mut blurred = self.blurred(&p);
        let mut misfit = self.misfit(d, &blurred);
        let mut iterations = 0;
        let limit = fixed.unwrap_or(how.iterations);
        while iterations < limit && (fixed.is_some() || misfit > how.noise.max(RESOLVED)) {
            let quotients: Vec<f64> =
                d.iter().zip(&blurred).map(|(d, b)| if *b > 0.0 { d / b } else { 1.0 }).collect();
            let corrections = self.blurred(&quotients);
            p.iter_mut()
                .zip(corrections.iter().zip(&self.constant_blur))
                .for_each(|(p, (c, of_one))| *p *= c / of_one);
            blurred = self.blurred(&p);
            iterations += 1;
            let now = self.misfit(d, &blurred);
            if fixed.is_none() && now > misfit * (1.0 - MIN_DECREASE) {
                break;
            }
            misfit = now;
        }
        let ratio = p.iter().zip(&blurred).map(|(p, b)| if *b > 0.0 { p / b } else { 1.0 });
        (ratio.collect(), iterations)
    }

    /// Relative root mean square difference, weighted by the light of each ring.
    fn misfit(&self, d: &[f64], blurred: &[f64]) -> f64 {
        let rings = d.iter().zip(blurred).zip(&self.areas).filter(|((value, _), _)| **value > 0.0);
        let (sum, light) = rings.fold((0.0, 0.0), |(sum, light), ((value, blurred), area)| {
            (sum + area * value * (blurred / value - 1.0_f64).powi(2), light + area * value)
        });
        if light > 0.0 { f64::sqrt(sum / light) } else { 0.0 }
    }

    /// Interpolates a profile between its nodes, linearly in t.
    pub(super) fn interpolated(&self, profile: &[f64], r: f64) -> f64 {
        let t = (r / self.width).asinh() / STEP;
        let k = (t as usize).min(profile.len() - 2);
        let fraction = (t - k as f64).min(1.0);
        profile[k] + fraction * (profile[k + 1] - profile[k])
    }
}

/// Integral of the kernel between a point at one distance and the ring at another, over its azimuth:
/// `b/(2 pi) int dphi/(b^2 + |r - s|^2)^(3/2) = (2 b/pi) E(m)/(near^2 far)`.
fn around(r: f64, s: f64, blur: f64) -> f64 {
    let (near, far) = (blur.hypot(r - s), blur.hypot(r + s));
    2.0 * blur / PI * elliptic_e(near / far) / (near * near * far)
}

/// Complete elliptic integral of the second kind for a complementary modulus, by the arithmetic-geometric
/// mean (Abramowitz & Stegun 17.6).
fn elliptic_e(complementary: f64) -> f64 {
    let (mut a, mut b) = (1.0, complementary);
    let mut c2 = 1.0 - b * b;
    let (mut sum, mut power) = (0.5 * c2, 0.5);
    while c2 > 1e-32 {
        let c = 0.5 * (a - b);
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
        c2 = c * c;
        power *= 2.0;
        sum += power * c2;
    }
    0.5 * PI / a * (1.0 - sum)
}

#[cfg(test)]
mod tests {
    use papilio_optics::Scatterer;

    use super::*;

    #[test]
    fn elliptic_e_equals_published_values() {
        assert!((elliptic_e(1.0) - 0.5 * PI).abs() < 1e-15);
        // E(m = 1/2), Abramowitz & Stegun 17.6: 1.35064 38810.
        assert!((elliptic_e(0.5_f64.sqrt()) - 1.350_643_881_0).abs() < 1e-10);
    }

    #[test]
    fn ring_blur_equals_closed_form_for_k_correlation_lobes() {
        for blur in [0.0483, 0.01] {
            let rings = Rings::new(blur);
            let lobe = |width: f64| -> Vec<f64> {
                let lobe = Lobe::KCorrelation { width };
                rings.radii.iter().map(|r| lobe.density(Beta::default(), Beta { x: *r, y: 0.0 })).collect()
            };
            for width in [0.05667, 0.12] {
                for ((ours, exact), r) in
                    rings.blurred(&lobe(width)).iter().zip(lobe(width + blur)).zip(&rings.radii)
                {
                    assert!(
                        *r > 1.0 || (ours / exact - 1.0).abs() < 1e-3,
                        "{blur} {width} {r}: {ours} {exact}"
                    );
                }
            }
        }
    }
}
