//! Metrics by name: of a state, and of the states together. Definitions and sources: docs/metrics.md.

use schemars::JsonSchema;
use serde::Serialize;

/// Declares numbers that may be undefined, with their names, and ways through all of them.
macro_rules! metrics {
    (
        $(#[doc = $doc:literal])*
        $name:ident { $( $(#[doc = $field_doc:literal])* $field:ident ),* $(,)? }
    ) => {
        $(#[doc = $doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, JsonSchema)]
        #[allow(non_snake_case, reason = "the letters of the field's own symbols")]
        pub struct $name {
            $( $(#[doc = $field_doc])* pub $field: Option<f64>, )*
        }

        impl $name {
            /// Names and numbers, in order.
            pub fn named(&self) -> impl Iterator<Item = (&'static str, Option<f64>)> + use<> {
                [$((stringify!($field), self.$field)),*].into_iter()
            }

            /// All numbers, in order.
            pub(crate) fn all_mut(&mut self) -> impl Iterator<Item = &mut Option<f64>> {
                [$(&mut self.$field),*].into_iter()
            }
        }
    };
}

metrics! {
    /// What a state's colour is to other colours.
    StateMetrics {
        /// CIELUV u*, against the illuminant's white.
        u_star,
        /// CIELUV v*.
        v_star,
        /// CIEDE2000 difference from the perfect white in the same light.
        delta_E_2000_from_white,
        /// CIEDE2000 difference from the reference state, seen from the same direction.
        delta_E_2000_from_reference,
        /// u'v' distance from the reference state, seen from the same direction.
        distance_from_reference_uv,
        /// CIEDE2000 difference from the same state in the view nearest to the normal.
        delta_E_2000_with_angle,
        /// u'v' distance from the same state in the view nearest to the normal.
        shift_with_angle_uv,
        /// `peak_nm` less that of the pixel alone in the direction of the view (Feng 2012, eq. 5-12).
        peak_shift_nm,
    }
}

metrics! {
    /// What a state looks like in its room (CIECAM16, CIE 248:2022).
    Cam16 {
        /// Lightness.
        J,
        /// Chroma.
        C,
        /// Lightness J' of CAM16-UCS.
        J_prime,
        /// a' of CAM16-UCS.
        a_prime,
        /// b' of CAM16-UCS; the hue is the angle of (a', b').
        b_prime,
    }
}

metrics! {
    /// Metrics of the states together.
    ViewMetrics {
        /// Y of white over Y of black.
        contrast_ratio,
        /// Area of the red, green and blue states in u'v', % of sRGB's.
        gamut_percent_srgb,
        /// The same, % of EBU's.
        gamut_percent_ebu,
        /// The same, % of NTSC's.
        gamut_percent_ntsc,
        /// The same, % of DCI-P3's.
        gamut_percent_dci_p3,
        /// Part of sRGB's triangle in u'v' that the display's covers, %.
        coverage_percent_srgb,
        /// The same of EBU's.
        coverage_percent_ebu,
        /// The same of NTSC's.
        coverage_percent_ntsc,
        /// The same of DCI-P3's.
        coverage_percent_dci_p3,
        /// Volume of the gamut in CIELAB, where `metrics.gamut_volume` asks for it.
        gamut_volume_cielab,
        /// Mean over red, green and blue of `peak_shift_nm` (Feng 2012, eq. 5-12).
        average_peak_shift_nm,
        /// Mean luminance of black text on white, cd/m2 (Feng 2012, eq. 5-13).
        text_luminance_cd_m2,
        /// Contrast of black text on white (Feng 2012, eq. 5-14).
        text_contrast,
        /// Reading performance of a reader of 20 years, 0 to 1: a surrogate calibrated on Feng 2012,
        /// table 5.3, and null beyond its range.
        reading_surrogate_age_20,
        /// The same of 50 years.
        reading_surrogate_age_50,
        /// The same of 75 years.
        reading_surrogate_age_75,
        /// The same of a reader of `viewer.age_years`; null where the scenario gives no age.
        reading_surrogate,
    }
}
