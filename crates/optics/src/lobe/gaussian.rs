//! The Gaussian lobe.
//!
//! `exp(-|beta_o - beta_i|²/w²) / (pi w²)`: light behind heights with a Gaussian correlation (P. Beckmann, A.
//! Spizzichino, *The Scattering of Electromagnetic Waves from Rough Surfaces*, 1963).
//!
//! **Parameter.** `width` w, in direction cosines, above 0: the distance at which the density is 1/e of its
//! largest value. A fraction 1 - 1/e of the light lies within it.
//!
//! **Azimuth.** With `x = 2 a b/w²` for directions of `|beta|` a and b, the coefficients of `cos(m phi)` are
//! `exp(-(a - b)²/w²) e^-x I_m(x) / (pi w²)`, I_m being the modified Bessel functions (Abramowitz and Stegun,
//! 9.6.34).

use std::f64::consts::PI;

/// The Gaussian lobe.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gaussian {
    /// w, in direction cosines, above 0.
    pub width: f64,
}

/// Square of the distance over that of the width beyond which the density is left out: below 1e-19 of the
/// largest value.
const FARTHEST: f64 = 45.0;

/// Argument from which on e^-x I_0(x) is its asymptotic series.
const LARGE: f64 = 30.0;

impl Gaussian {
    /// Returns the density at the square of a distance, per unit area of direction cosines.
    #[inline(always)]
    pub fn at_squared_distance(&self, squared: f64) -> f64 {
        let area = self.width * self.width;
        (-squared / area).exp() / (PI * area)
    }

    /// Returns the distance within which a fraction of the lobe lies.
    pub(super) fn distance_of(&self, fraction: f64) -> f64 {
        self.width * (-(-fraction).ln_1p()).max(0.0).sqrt()
    }

    /// Returns the fraction of the lobe within a distance of the regular direction.
    pub fn fraction_within(&self, radius: f64) -> f64 {
        -(-(radius / self.width).powi(2)).exp_m1()
    }

    /// Returns the mean of the density between directions of these `|beta|` over the difference of their
    /// azimuths.
    pub fn mean_over_azimuth(&self, a: f64, b: f64) -> f64 {
        let area = self.width * self.width;
        self.at_squared_distance((a - b) * (a - b)) * scaled_i0(2.0 * a * b / area)
    }

    /// Computes the means of the density times `cos(m phi)`, phi being the difference of azimuths: one for
    /// each m from 0 on.
    pub fn orders(&self, a: f64, b: f64, values: &mut [f64]) {
        values.fill(0.0);
        let area = self.width * self.width;
        let squared = (a - b) * (a - b);
        if squared > FARTHEST * area {
            return;
        }
        scaled_bessel(2.0 * a * b / area, values);
        let density = self.at_squared_distance(squared);
        values.iter_mut().for_each(|value| *value *= density);
    }
}

/// `e^-x I_0(x)`, x >= 0; relative error below 1e-13.
fn scaled_i0(x: f64) -> f64 {
    let (mut sum, mut term) = (1.0, 1.0);
    if x > LARGE {
        for k in 1..=20 {
            let odd = f64::from(2 * k - 1);
            term *= odd * odd / (8.0 * x * f64::from(k));
            sum += term;
        }
        return sum / (2.0 * PI * x).sqrt();
    }
    for k in 1..=80 {
        term *= 0.25 * x * x / f64::from(k * k);
        sum += term;
    }
    sum * (-x).exp()
}

/// `e^-x I_m(x)` for each m from 0 on, x >= 0: downwards by the recurrence (Miller), scaled so that
/// `I_0 + 2 (I_1 + I_2 + ...) = e^x`.
fn scaled_bessel(x: f64, values: &mut [f64]) {
    // Below this, all but I_0 are less than rounding.
    if x < 1e-17 {
        values.iter_mut().take(1).for_each(|value| *value = 1.0);
        return;
    }
    // I_m(x) is about I_0(x) exp(-m²/2x), and for small x it falls faster.
    let from = (9.0 * x.sqrt()).ceil() as usize + 30;
    let (mut above, mut here, mut sum) = (0.0_f64, 1e-290_f64, 0.0_f64);
    let mut last = from;
    for m in (0..=from).rev() {
        if let Some(value) = values.get_mut(m) {
            *value = here;
            last = last.min(m);
        }
        sum += if m == 0 { here } else { 2.0 * here };
        let below = 2.0 * m as f64 / x * here + above;
        (above, here) = (here, below);
        if here > 1e250 {
            const SMALLER: f64 = 1e-250;
            (above, here, sum) = (above * SMALLER, here * SMALLER, sum * SMALLER);
            values.iter_mut().skip(last).for_each(|value| *value *= SMALLER);
        }
    }
    values.iter_mut().for_each(|value| *value /= sum);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// x, and e^-x I_m(x) for m = 0, 1, 5, 40: `scipy.special.ive` 1.17.
    const IVE: [(f64, [f64; 4]); 7] = [
        (1e-12, [0.999999999999, 4.999999999995004e-13, 2.6041666666640854e-64, 0.0]),
        (0.01, [0.9900745851497074, 0.004950311047118277, 2.5782655181358737e-14, 1.1036018638525017e-140]),
        (1.0, [0.4657596075936404, 0.20791041534970842, 9.9865714112087e-05, 4.1258037690936204e-61]),
        (29.0, [0.07440746822222559, 0.07311311793938838, 0.04803713719344851, 1.141534006732789e-12]),
        (31.0, [0.07194649669698382, 0.07077639283438568, 0.04779458274268949, 4.283516977588207e-12]),
        (700.0, [0.015081295651531358, 0.015070519444716846, 0.014814188973601688, 0.004807093091070755]),
        (
            20000.0,
            [0.0028209655491591625, 0.0028208950241388384, 0.0028192029525027505, 0.0027103512334886765],
        ),
    ];

    #[test]
    fn bessel_functions_have_known_values() {
        for (x, of) in IVE {
            let mut values = [0.0; 41];
            scaled_bessel(x, &mut values);
            for (m, expected) in [0, 1, 5, 40].into_iter().zip(of) {
                assert!(
                    (values[m] - expected).abs() < 1e-13 * expected.abs() + 1e-30,
                    "{x} {m}: {:e}",
                    values[m]
                );
            }
            assert!((scaled_i0(x) / of[0] - 1.0).abs() < 1e-13, "{x}");
        }
    }

    /// Orders are those of the trapezoid rule, and order 0 is the mean.
    #[test]
    fn orders_are_fourier_coefficients() {
        for (width, a, b) in
            [(0.06, 0.3, 0.35), (0.5, 0.9, 0.1), (0.02, 1e-9, 0.02), (0.1, 0.0, 0.3), (0.03, 1.4, 1.39)]
        {
            let lobe = Gaussian { width };
            let mut found = [0.0; 200];
            lobe.orders(a, b, &mut found);
            assert!((found[0] - lobe.mean_over_azimuth(a, b)).abs() <= 1e-12 * found[0]);
            let steps = 2000;
            for m in [0, 1, 7, 60, 199] {
                let mean = (0..steps).map(|step| {
                    let phi = 2.0 * PI * f64::from(step) / f64::from(steps);
                    let squared = a * a + b * b - 2.0 * a * b * phi.cos();
                    lobe.at_squared_distance(squared) * (m as f64 * phi).cos()
                });
                let expected = mean.sum::<f64>() / f64::from(steps);
                let scale = lobe.at_squared_distance((a - b) * (a - b));
                assert!(
                    (found[m] - expected).abs() < 1e-12 * scale,
                    "{width} {a} {b} {m}: {} {expected}",
                    found[m]
                );
            }
        }
    }
}
