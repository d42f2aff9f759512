//! Light that spreads sideways inside a scattering pixel.
//!
//! **What.** Light enters a Lambertian pixel at one place, through the state that is there, and leaves it at
//! another, again through the state there. With the reflectance `rho(x)` of the states and the point spread P
//! of the scattering between, the radiosity in the irradiance E is
//!
//! `B(x) = sqrt(rho(x)) integral of P(x - x') sqrt(rho(x')) E(x') d2x'`.
//!
//! It is reciprocal, and a uniform area keeps its reflectance. The line spread of P decreases exponentially,
//! `exp(-|x|/s)/(2 s)`; its transform is `1/(1 + (2 pi f s)^2)`, and P itself `K_0(r/s)/(2 pi s^2)`.
//!
//! **Parameter.** `s` (mm): the distance at which the line spread has decreased to 1/e.
//!
//! **Limits.** s = 0: `B = rho E`. Features much smaller than s: the square of the mean of `sqrt(rho)` (Yule
//! and Nielsen's n = 2), below a thin face that returns light Clapper and Yule's formula. A small change of
//! the state has the transfer `(1 + P)/2`: half of the light has passed the change on its way out, where
//! nothing blurs it. A pattern of light on a uniform pixel has the transfer P.
//!
//! **Validity.** The same P in all states and at all wavelengths; directions are lost inside the pixel.
//!
//! **Sources.** J. A. C. Yule, W. J. Nielsen, TAGA Proc. 3, 65 (1951); F. R. Clapper, J. A. C. Yule, J. Opt.
//! Soc. Am. 43, 600 (1953); G. L. Rogers, J. Opt. Soc. Am. A 15, 1813 (1998).

use std::f64::consts::{PI, SQRT_2, TAU};

use papilio_sampling::warp;

use crate::numerics::bessel::{i0_i1, k0, x_k1};
use crate::numerics::quadrature::gauss;

/// P is a mixture of Gaussians, of variance `2 t s^2` along each axis with the density `exp(-t)`, t = u^2:
/// panels of u, and the points on each.
const PANELS: [f64; 9] = [0.0, 0.05, 0.2, 0.6, 1.2, 2.0, 3.0, 4.5, 6.0];
const POINTS: usize = 8;

/// Standard deviations in widths of a cell up to which the light of neighbouring cells is summed by place,
/// not by frequency.
const NARROW: f64 = 0.5;

/// Radii and distances in `s` beyond which the spread is a point.
const LARGEST: f64 = 200.0;

/// Point spread of light inside a pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PixelSpread {
    radius_mm: f64,
}

impl PixelSpread {
    /// Returns the spread with this distance, mm; `None` if light does not spread.
    pub fn new(radius_mm: f64) -> Option<Self> {
        (radius_mm > 0.0).then_some(Self { radius_mm })
    }

    /// The distance at which the line spread has decreased to 1/e, mm.
    pub fn radius_mm(&self) -> f64 {
        self.radius_mm
    }

    /// Transform at a frequency, cycles per mm.
    pub fn at(&self, frequency_per_mm: f64) -> f64 {
        1.0 / (1.0 + (TAU * frequency_per_mm * self.radius_mm).powi(2))
    }

    /// Transfer at a frequency of a small change of the state: half of the light is not blurred.
    pub fn of_state(&self, frequency_per_mm: f64) -> f64 {
        0.5 + 0.5 * self.at(frequency_per_mm)
    }

    /// Light of the point spread below a place along an axis, mm.
    pub fn below(&self, at_mm: f64) -> f64 {
        let rest = 0.5 * (-at_mm.abs() / self.radius_mm).exp();
        if at_mm < 0.0 { rest } else { 1.0 - rest }
    }

    /// Light of the point spread within a radius about a point at a distance from its middle, mm.
    pub fn within(&self, radius_mm: f64, distance_mm: f64) -> f64 {
        let [radius, distance] = [radius_mm, distance_mm].map(|length| length / self.radius_mm);
        // Graf's addition theorem for K_0.
        if radius.min(distance) > LARGEST {
            f64::from(u8::from(radius > distance))
        } else if distance < radius {
            1.0 - x_k1(radius) * i0_i1(distance)[0]
        } else if radius > 0.0 {
            radius * i0_i1(radius)[1] * k0(distance)
        } else {
            0.0
        }
    }

    /// A random displacement, mm, from three uniform random numbers.
    pub fn displacement(&self, [u, v, w]: [f64; 3]) -> [f64; 2] {
        let (x, y) = warp::polar(2.0 * self.radius_mm * (u.ln() * v.ln()).sqrt(), w);
        [x, y]
    }

    /// Mean in each of some cells along an axis of the light that enters each of them, `[to][from]`. They fill a
    /// period, and have these edges, from 0 to 1.
    pub(crate) fn between_cells(&self, edges: &[f64], period_mm: f64) -> Vec<f64> {
        let period = period_mm / self.radius_mm;
        // The second integral of the line spread of all periods, at distances from 0 to a period, in units of s.
        let twice = |at: f64| 0.5 * ((-at).exp() + (at - period).exp()) / -(-period).exp_m1();
        let cells = || edges.windows(2).map(|ends| [period * ends[0], period * ends[1]]);
        let between = |[a, b]: [f64; 2], [c, d]: [f64; 2]| {
            if a == c {
                b - a + 2.0 * (twice(b - a) - twice(0.0))
            } else {
                let ([a, b], [c, d]) = if a < c { ([a, b], [c, d]) } else { ([c, d], [a, b]) };
                twice(d - a) - twice(d - b) - twice(c - a) + twice(c - b)
            }
        };
        cells().flat_map(|to| cells().map(move |from| between(to, from) / (to[1] - to[0]))).collect()
    }

    /// Factor at each bin of the Fourier transform of the light between the means of cells that repeat: their
    /// number along x and y, and their periods, mm. Columns vary slowest (transposed).
    pub(crate) fn between(&self, count: [usize; 2], period_mm: [f64; 2]) -> Vec<f64> {
        let [columns, rows] = count;
        let mut sum = vec![0.0; columns * rows];
        let mut total = 0.0;
        for panel in PANELS.windows(2) {
            for node in gauss(panel[0], panel[1], POINTS) {
                let weight = node.weight * 2.0 * node.x * (-node.x * node.x).exp();
                total += weight;
                let [x, y] = [0, 1].map(|axis| {
                    let width = period_mm[axis] / count[axis] as f64;
                    between_means(count[axis], SQRT_2 * node.x * self.radius_mm / width)
                });
                for (column, x) in sum.chunks_exact_mut(rows).zip(&x) {
                    column.iter_mut().zip(&y).for_each(|(sum, y)| *sum += weight * x * y);
                }
            }
        }
        sum.iter_mut().for_each(|sum| *sum /= total);
        sum
    }
}

/// Transform of a Gaussian between the means of cells along an axis; `sigma` in widths of a cell.
fn between_means(count: usize, sigma: f64) -> Vec<f64> {
    if count == 1 {
        return vec![1.0];
    }
    let turn = |bin: usize| {
        let wave = if 2 * bin <= count { bin as f64 } else { bin as f64 - count as f64 };
        wave / count as f64
    };
    if sigma > NARROW {
        let at = |f: f64| {
            let wave = |m: i32| {
                let f = f + f64::from(m);
                let sinc = if f == 0.0 { 1.0 } else { (PI * f).sin() / (PI * f) };
                sinc * sinc * (-2.0 * (PI * sigma * f).powi(2)).exp()
            };
            (-5..=5).map(wave).sum()
        };
        return (0..count).map(|bin| at(turn(bin))).collect();
    }
    if sigma == 0.0 {
        return vec![1.0; count];
    }
    // Light of a cell that is found k cells away: second differences of the integral of the normal
    // distribution.
    let tail = |z: f64| (-0.5 * z * z).exp() / TAU.sqrt() - 0.5 * z * libm::erfc(z / SQRT_2);
    let at = |k: usize| tail(k as f64 / sigma);
    let own = 1.0 + 2.0 * sigma * (at(1) - at(0));
    let other = |k: usize| sigma * (at(k + 1) - 2.0 * at(k) + at(k - 1));
    let others: Vec<f64> = (1..=5).map(other).collect();
    let of_bin = |bin: usize| {
        let phase = TAU * turn(bin);
        let terms = others.iter().enumerate().map(|(k, light)| 2.0 * light * (phase * (k + 1) as f64).cos());
        own + terms.sum::<f64>()
    };
    (0..count).map(of_bin).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Along one axis the mean light between cells has a closed form:
    /// `(s/2w) exp(-(k-1) w/s) (1 - exp(-w/s))^2` for cells k apart.
    #[test]
    fn light_between_stripes_has_closed_form() {
        for (width, count) in [(0.01, 512), (0.05, 128), (0.2, 64), (2.0, 32)] {
            let spread = PixelSpread::new(0.05).unwrap();
            let transfer = spread.between([count, 1], [width * count as f64, f64::INFINITY]);
            let ratio = width / 0.05;
            let direct = |k: f64| 0.5 / ratio * (-(k - 1.0) * ratio).exp() * (1.0 - (-ratio).exp()).powi(2);
            for k in [0_usize, 1, 2, 5] {
                let at = |bin: usize| transfer[bin] * (TAU * (bin * k) as f64 / count as f64).cos();
                let found = (0..count).map(at).sum::<f64>() / count as f64;
                let own = 1.0 - (1.0 - (-ratio).exp()) / ratio;
                let others = if k == 0 { own } else { direct(k as f64) };
                // The other side of the period.
                let expected = others + direct((count - k) as f64);
                assert!((found - expected).abs() < 1e-7, "{width} {k}: {found} {expected}");
            }
        }
    }

    /// All light that enters leaves; cells of different widths have the light of the parts that fill them.
    #[test]
    fn light_between_cells_of_a_period_is_conserved() {
        let spread = PixelSpread::new(0.3).unwrap();
        let (fine, coarse) = ([0.0, 0.1, 0.25, 0.4, 0.7, 1.0], [0.0, 0.25, 0.7, 1.0]);
        for period in [0.05, 1.0, 30.0] {
            let [parts, sums] = [&fine[..], &coarse].map(|edges| spread.between_cells(edges, period));
            parts.chunks_exact(5).for_each(|row| assert!((row.iter().sum::<f64>() - 1.0).abs() < 1e-9));
            // To the second coarse cell from the first one.
            let to_third = parts[10] + parts[11];
            let to_fourth = parts[15] + parts[16];
            let mean = (0.15 * to_third + 0.3 * to_fourth) / 0.45;
            assert!((sums[3] - mean).abs() < 1e-9, "{period}: {} {mean}", sums[3]);
        }
    }

    /// Discs about the middle and beside it, strips and random displacements agree.
    #[test]
    fn places_agree_with_random_displacements() {
        let spread = PixelSpread::new(0.3).unwrap();
        let numbers = papilio_sampling::SampleStream::new(papilio_sampling::Sampler::Sobol, 5, 0);
        let count = 1 << 14;
        let places: Vec<[f64; 2]> = (0..count)
            .map(|path| {
                let [u, v, w, _] = numbers.block(path, 0);
                spread.displacement([u, v, w])
            })
            .collect();
        let part = |inside: &dyn Fn(&[f64; 2]) -> bool| {
            places.iter().filter(|place| inside(place)).count() as f64 / count as f64
        };
        for radius in [0.1, 0.4, 1.0] {
            let found = part(&|[x, y]| x.hypot(*y) < radius);
            assert!((found - spread.within(radius, 0.0)).abs() < 0.01, "{radius}: {found}");
            let found = part(&|[x, y]| (x - 0.5).hypot(*y) < radius);
            assert!((found - spread.within(radius, 0.5)).abs() < 0.01, "{radius} beside: {found}");
            let found = part(&|[x, _]| *x < radius);
            assert!((found - spread.below(radius)).abs() < 0.01, "{radius} along: {found}");
        }
        assert!((spread.within(0.4, 0.0) - spread.within(0.4, 1e-9)).abs() < 1e-9);
        assert!((spread.within(0.4, 0.399_999_9) - spread.within(0.4, 0.400_000_1)).abs() < 1e-6);
        assert!((spread.below(0.3) - (1.0 - 0.5 / std::f64::consts::E)).abs() < 1e-15);
        // The transform of the line spread.
        let cosine = places.iter().map(|[x, _]| (TAU * 0.7 * x).cos()).sum::<f64>() / count as f64;
        assert!((cosine - spread.at(0.7)).abs() < 0.01, "{cosine} {}", spread.at(0.7));
    }
}
