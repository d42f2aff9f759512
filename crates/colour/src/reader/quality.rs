//! How good a picture's sharpness is for a reader: integrals over the modulation transfer and the eye's
//! sensitivity.
//!
//! **What.** Barten's square-root integral: a just noticeable difference of sharpness is 1 JND,
//!
//! `J = 1/ln 2 · integral of sqrt(M(u) S(u)) du/u`
//!
//! with the modulation transfer M of the display and the contrast sensitivity S of the eye at u cycles per
//! degree.
//!
//! **Range.** From one cycle in the field to the highest frequency that the display shows, which is a
//! parameter. Since the integral is over the logarithm of u, its value depends on both limits: compare
//! displays at the same ones.
//!
//! **Source.** Barten, *Contrast Sensitivity of the Human Eye and Its Effects on Image Quality*, SPIE (1999),
//! chapter 8.

use super::contrast_sensitivity;

/// Number of steps per octave. The trapezoidal rule is then correct to 1e-6 for the transfer of optics.
const STEPS_PER_OCTAVE: f64 = 64.0;

/// Computes Barten's square-root integral (SQRI), in just noticeable differences.
///
/// - `transfer`: modulation transfer of the display at a frequency in cycles per degree, 0 to 1; values below
///   0 (noise) count as 0.
/// - `luminance_cd_m2`: mean luminance of the picture.
/// - `field_deg`: width of the field of view, degrees; the integral begins at one cycle in it.
/// - `most_cycles_per_degree`: the end of the integral, such as the Nyquist frequency of the pixels.
///
/// `None` unless the luminance is positive and the range of frequencies is not empty.
pub fn square_root_integral(
    transfer: impl Fn(f64) -> f64,
    luminance_cd_m2: f64,
    field_deg: f64,
    most_cycles_per_degree: f64,
) -> Option<f64> {
    let octaves = (most_cycles_per_degree * field_deg).log2();
    if !(octaves > 0.0 && octaves.is_finite()) {
        return None;
    }
    let steps = (octaves * STEPS_PER_OCTAVE).ceil() as usize;
    let value = |step: usize| {
        let u = 2.0_f64.powf(octaves * step as f64 / steps as f64) / field_deg;
        let sensitivity = contrast_sensitivity(u, luminance_cd_m2, field_deg)?;
        Some((transfer(u).max(0.0) * sensitivity).sqrt())
    };
    let mut sum = (value(0)? + value(steps)?) / 2.0;
    for step in 1..steps {
        sum += value(step)?;
    }
    // du/(u ln 2) is the step in octaves.
    Some(sum * octaves / steps as f64)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    /// Blur of width c under 300 ppi, seen from 400 mm. Values of a separate program.
    #[test]
    fn integral_has_known_values() {
        let per_mm = |u: f64| u / (400.0 * 1.0_f64.to_radians().tan());
        for (blur_um, expected) in
            [(0.0, 142.11), (5.0, 140.57), (10.0, 139.08), (18.89, 136.53), (40.0, 130.95), (80.0, 121.91)]
        {
            let transfer = |u: f64| (-2.0 * PI * per_mm(u) * 1e-3 * blur_um).exp();
            let found = square_root_integral(transfer, 93.0, 10.0, 41.23).unwrap();
            assert!((found - expected).abs() < 0.006, "{blur_um} um: {found}");
        }
    }

    /// A constant product of transfer and sensitivity: its root times the number of octaves.
    #[test]
    fn integral_of_a_constant_is_its_octaves() {
        let transfer = |u: f64| 1.0 / contrast_sensitivity(u, 50.0, 10.0).unwrap();
        let found = square_root_integral(transfer, 50.0, 10.0, 0.1 * 2.0_f64.powf(5.5)).unwrap();
        assert!((found - 5.5).abs() < 1e-12, "{found}");
    }

    #[test]
    fn nothing_is_seen_without_light_or_frequencies() {
        assert_eq!(square_root_integral(|_| 1.0, 0.0, 10.0, 40.0), None);
        assert_eq!(square_root_integral(|_| 1.0, 100.0, 10.0, 0.1), None);
        assert_eq!(square_root_integral(|_| 1.0, 100.0, 10.0, f64::NAN), None);
        assert_eq!(square_root_integral(|_| -0.1, 100.0, 10.0, 40.0), Some(0.0));
    }
}
