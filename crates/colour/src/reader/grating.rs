//! Contrast sensitivity of the eye to a grating.
//!
//! **What.** The reciprocal of the contrast `(L_max - L_min)/(L_max + L_min)` at which a sinusoidal grating
//! is seen in half of all cases, from the optics of the eye, photon noise, neural noise and lateral
//! inhibition (Barten, *Contrast Sensitivity of the Human Eye and Its Effects on Image Quality*, SPIE (1999),
//! with both eyes and a square field):
//!
//! `S = exp(-2 pi² s² u²)/k / sqrt((2/T)(1/X0² + 1/Xm² + u²/N²)(1/(eta p E) + Phi/(1 - exp(-(u/u0)²))))`
//!
//! with the width s of the point spread function and the retinal illuminance E, which depend on the diameter
//! of the pupil, and that on luminance and field.
//!
//! **Parameters.** Spatial frequency u, cycles per degree; mean luminance, cd/m2; width of the field X0,
//! degrees.
//!
//! **Range.** Daylight vision; here 0.1 to 1e4 cd/m2. Above, the sensitivity at 1e4 cd/m2 is used. A young
//! observer; divide by the [age factor](super::age_factor) for others.
//!
//! **Source.** Constants as in colour-science 0.4.7 (`contrast_sensitivity_function_Barten1999`), with which
//! the values agree to 1e-9. CastleCSF's implementation has 1.240e6 for p, photons of another white; this
//! changes S by less than 0.6 %.

use std::f64::consts::PI;

use super::LUMINANCES_CD_M2;

/// Signal-to-noise ratio k at the threshold.
const SIGNAL_TO_NOISE: f64 = 3.0;
/// Width of the point spread function with a small pupil, degrees.
const OPTICS_DEG: f64 = 0.5 / 60.0;
/// Increase of this width with the pupil, degrees per mm.
const ABERRATION_DEG_PER_MM: f64 = 0.08 / 60.0;
/// Integration time T of the eye, s.
const TIME_S: f64 = 0.1;
/// Largest field Xm over which the eye integrates, degrees.
const LARGEST_FIELD_DEG: f64 = 12.0;
/// Largest number N of cycles over which the eye integrates.
const MOST_CYCLES: f64 = 15.0;
/// Quantum efficiency eta of the eye.
const QUANTUM_EFFICIENCY: f64 = 0.03;
/// Photons p per second, square degree and troland of a white light.
const PHOTONS: f64 = 1.2274e6;
/// Spectral density Phi of the neural noise, s deg².
const NEURAL_NOISE: f64 = 3e-8;
/// Frequency u0 above which lateral inhibition ends, cycles per degree.
const INHIBITION: f64 = 7.0;

/// Computes the contrast sensitivity of a young observer (Barten 1999).
///
/// `cycles_per_degree` and `field_deg` are greater than 0. `None` unless the luminance is positive.
pub fn contrast_sensitivity(cycles_per_degree: f64, luminance_cd_m2: f64, field_deg: f64) -> Option<f64> {
    let [_, brightest] = LUMINANCES_CD_M2;
    (luminance_cd_m2 > 0.0).then(|| sensitivity(cycles_per_degree, luminance_cd_m2.min(brightest), field_deg))
}

fn sensitivity(u: f64, luminance: f64, field_deg: f64) -> f64 {
    let pupil_mm = 5.0 - 3.0 * (0.4 * (luminance * field_deg * field_deg / 1600.0).log10()).tanh();
    // Light at the edge of the pupil is less effective (Stiles and Crawford).
    let apodised = 1.0 - (pupil_mm / 9.7).powi(2) + (pupil_mm / 12.4).powi(4);
    let trolands = 0.25 * PI * pupil_mm * pupil_mm * luminance * apodised;
    let width_deg = OPTICS_DEG.hypot(ABERRATION_DEG_PER_MM * pupil_mm);
    let optics = (-2.0 * (PI * width_deg * u).powi(2)).exp();
    let area = field_deg.powi(-2) + LARGEST_FIELD_DEG.powi(-2) + (u / MOST_CYCLES).powi(2);
    let photon_noise = 1.0 / (QUANTUM_EFFICIENCY * PHOTONS * trolands);
    let neural_noise = NEURAL_NOISE / -(-(u / INHIBITION).powi(2)).exp_m1();
    optics / SIGNAL_TO_NOISE / (2.0 / TIME_S * area * (photon_noise + neural_noise)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values of colour-science 0.4.7 with its pupil, point spread function and retinal illuminance for the
    /// luminance, and a field of 10 deg.
    #[test]
    fn contrast_sensitivity_agrees_with_colour_science() {
        let table: [(f64, [f64; 4]); 6] = [
            (0.1, [138.524_587_077, 68.734_809_916_1, 13.118_358_587_9, 0.630_143_029_605]),
            (1.0, [302.315_680_932, 199.591_578_665, 41.526_205_368_6, 2.595_896_607_53]),
            (10.0, [395.233_501_367, 459.197_133_002, 117.924_319_948, 10.160_146_754_6]),
            (100.0, [413.939_011_73, 668.522_465_044, 240.380_481_069, 27.344_881_127_6]),
            (1000.0, [416.952_590_206, 731.607_671_278, 318.397_865_245, 42.993_407_834_2]),
            (1e4, [417.465_547_234, 744.094_434_974, 342.067_828_915, 50.214_723_893_7]),
        ];
        for (luminance, expected) in table {
            for (u, expected) in [1.0, 4.0, 13.6, 30.0].into_iter().zip(expected) {
                let found = contrast_sensitivity(u, luminance, 10.0).unwrap();
                assert!((found / expected - 1.0).abs() < 1e-9, "{luminance} cd/m2, {u}: {found}");
            }
        }
    }

    #[test]
    fn contrast_sensitivity_increases_with_light_and_decreases_with_fineness() {
        let frequencies = [0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 40.0];
        for step in -20..40 {
            let luminance = 10_f64.powf(0.1 * f64::from(step));
            for u in frequencies {
                let [dim, lit] =
                    [luminance, 1.2 * luminance].map(|l| contrast_sensitivity(u, l, 10.0).unwrap());
                assert!(lit >= dim, "{luminance} cd/m2, {u}");
            }
            let fine =
                [8.0, 10.0, 15.0, 30.0, 60.0].map(|u| contrast_sensitivity(u, luminance, 10.0).unwrap());
            assert!(fine.windows(2).all(|pair| pair[1] < pair[0]), "{luminance} cd/m2: {fine:?}");
        }
    }

    #[test]
    fn contrast_sensitivity_is_held_in_bright_light_and_undefined_without_light() {
        assert_eq!(contrast_sensitivity(5.0, 1e4, 10.0), contrast_sensitivity(5.0, 1e6, 10.0));
        assert_eq!(contrast_sensitivity(5.0, 0.0, 10.0), None);
        assert_eq!(contrast_sensitivity(5.0, f64::NAN, 10.0), None);
        let limits = [1e-9, 1e9].map(|u| contrast_sensitivity(u, 100.0, 10.0).unwrap());
        assert!(limits.iter().all(|limit| limit.is_finite() && *limit < 1e-3), "{limits:?}");
    }
}
