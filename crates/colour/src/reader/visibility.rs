//! Luminance threshold of a small detail.
//!
//! **What.** The luminance difference dL between a small disc and its background that is just visible
//! (Adrian, Lighting Res. Technol. 21, 181 (1989), a fit to the thresholds of Blackwell, Aulhorn and others):
//!
//! `dL = 2.6 (sqrt(phi)/alpha + sqrt(L))² · (a + t)/t · F · A`
//!
//! with the functions phi (Ricco's law, small discs) and L (Weber's law, large discs) of the background's
//! luminance, the diameter alpha in minutes of arc, the time t in which it must be seen with its function a,
//! a factor F below 1 for details that are darker than their background, and the [age
//! factor](super::age_factor) A. With the factor 2.6, the detail is practically always seen; without it, in
//! half of all cases.
//!
//! **Parameters.** Diameter, minutes of arc; time, s; luminance of the background, cd/m2; age, years.
//!
//! **Range.** 0.1 to 1e4 cd/m2 here (the formulas reach down to starlight); diameters of 0.3 to 60 minutes of
//! arc, between which the function a is defined; 23 to 75 years. Above 1e4 cd/m2, the threshold *contrast* of
//! 1e4 cd/m2 is used.
//!
//! **Accuracy.** For details of 3.6', the formula agrees with the thresholds of Blackwell (J. Opt. Soc. Am.
//! 36, 624 (1946)) within 7 % from 1.7 to 170 cd/m2; for 0.6' to 18', within a factor of 1.8. In brighter
//! light it is too high for small details, by 37 % at 2700 cd/m2 for 3.6': its threshold contrast is lowest
//! near 400 cd/m2 and increases by 17 to 26 % up to 1e4 cd/m2 for 1' to 3', while Blackwell's keeps
//! decreasing. In daylight, visibility levels are therefore somewhat too low. Where two formulas meet, at 0.6
//! cd/m2, dL decreases by 2 to 3 %.
//!
//! **Source.** The constants and branches are those of two independent programs: the visibility level script
//! of Radiance (LBNL), and `calcDeltaL.m` by J. Winter (TU Berlin).

use super::{LUMINANCES_CD_M2, age_factor, is_age_in_range, is_luminance_in_range};

/// Diameters for which the model is defined, minutes of arc.
pub const DIAMETERS_ARCMIN: [f64; 2] = [0.3, 60.0];

/// Factor from the threshold that is seen in half of all cases to the one that is practically always seen.
const CERTAIN: f64 = 2.6;

/// Time for which the contrast polarity was measured, s.
const POLARITY_TIME_S: f64 = 2.0;

/// Whether a detail is darker or brighter than its background.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Polarity {
    /// Darker, like black text on white. Dark details need less contrast.
    Darker,
    /// Brighter.
    Brighter,
}

/// A detail that a reader must see.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VisibilityTask {
    /// Diameter, minutes of arc, greater than 0.
    pub diameter_arcmin: f64,
    /// Time in which it must be seen, s, greater than 0; 0.2 s is a fixation of the eye.
    pub time_s: f64,
    /// Whether it is darker or brighter than its background.
    pub polarity: Polarity,
    /// Age of the reader, years.
    pub age_years: f64,
}

impl VisibilityTask {
    /// Computes the luminance difference that is just visible, cd/m2; `None` unless the background's
    /// luminance is positive.
    pub fn threshold_cd_m2(&self, background_cd_m2: f64) -> Option<f64> {
        let [_, brightest] = LUMINANCES_CD_M2;
        let luminance = background_cd_m2.min(brightest);
        (background_cd_m2 > 0.0).then(|| self.at(luminance) * background_cd_m2 / luminance)
    }

    /// Returns true if the luminance of the background, the diameter and the age are within the range of the
    /// model.
    pub fn in_range(&self, background_cd_m2: f64) -> bool {
        let [least, most] = DIAMETERS_ARCMIN;
        is_luminance_in_range(background_cd_m2)
            && (least..=most).contains(&self.diameter_arcmin)
            && is_age_in_range(self.age_years)
    }

    fn at(&self, luminance: f64) -> f64 {
        let (sqrt_phi, sqrt_l) = (ricco(luminance), weber(luminance));
        let long = CERTAIN * (sqrt_phi / self.diameter_arcmin + sqrt_l).powi(2);
        // The function of time, and with it the polarity, are not defined outside.
        let [least, most] = DIAMETERS_ARCMIN;
        let diameter = self.diameter_arcmin.clamp(least, most);
        let a = time_constant(diameter, luminance);
        let with_time = |time: f64| long * (a + time) / time;
        let polarity = match self.polarity {
            Polarity::Brighter => 1.0,
            Polarity::Darker => polarity_factor(diameter, luminance, with_time(POLARITY_TIME_S)),
        };
        with_time(self.time_s) * polarity * age_factor(self.age_years)
    }
}

/// The function sqrt(phi) of the background's luminance, in cd/m2, which determines the threshold of small
/// details.
fn ricco(luminance: f64) -> f64 {
    let log = luminance.log10();
    if luminance >= 0.6 {
        4.1925_f64.log10() + 0.1556 * log + 0.1684 * luminance.powf(0.5867)
    } else if luminance > 0.00418 {
        10_f64.powf(-0.072 + 0.3372 * log + 0.0866 * log * log)
    } else {
        10_f64.powf(0.028 + 0.173 * log)
    }
}

/// The function sqrt(L) of the background's luminance, in cd/m2, which determines the threshold of large
/// details.
fn weber(luminance: f64) -> f64 {
    let log = luminance.log10();
    if luminance >= 0.6 {
        0.05946 * luminance.powf(0.466)
    } else if luminance > 0.00418 {
        10_f64.powf(-1.256 + 0.319 * log)
    } else {
        10_f64.powf(-0.891 + 0.5275 * log + 0.0227 * log * log)
    }
}

/// The function a of Blondel and Rey's law, s.
fn time_constant(diameter_arcmin: f64, luminance: f64) -> f64 {
    let size = diameter_arcmin.log10() + 0.523;
    let of_size = 0.36 - 0.0972 * size * size / (size * size - 2.513 * size + 2.7895);
    let light = luminance.log10() + 6.0;
    let of_light = 0.355 - 0.1217 * light * light / (light * light - 10.4 * light + 52.28);
    of_size.hypot(of_light) / 2.1
}

/// Threshold of a dark detail relative to that of a bright one, whose threshold after 2 s is `bright`, cd/m2.
fn polarity_factor(diameter_arcmin: f64, luminance: f64, bright: f64) -> f64 {
    if luminance <= 0.004 {
        return 1.0;
    }
    let slope = if luminance >= 0.1 { 0.125 } else { 0.075 };
    let m = 10_f64.powf(-10_f64.powf(-(slope * (luminance.log10() + 1.0).powi(2) + 0.0245)));
    let beta = 0.6 * luminance.powf(-0.1488);
    1.0 - m * diameter_arcmin.powf(-beta) / (2.4 * bright)
}

#[cfg(test)]
mod tests;
