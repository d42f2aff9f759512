//! Metrics by name: of a state, and of a view, which combine its states. Definitions and sources: docs/metrics.md.
//!
//! The table at the end of this file is the only list of names. From it come the fields of the results, the enum
//! [`Metric`], all iterations and the [labels](crate::Label) of figures and tables. A new metric needs a line in the table,
//! with its documentation and its label (`= quantity in unit`), and its value: in `meter/metrics.rs`, or where the result that it is
//! from lists its `metrics` and `errors` (`spatial/result.rs`, `spatial/crosstalk/result.rs`, `spatial/sparkle.rs`,
//! `image/mod.rs`, `gloss.rs`).

#[macro_use]
mod declare;

use schemars::JsonSchema;
use serde::Serialize;

use papilio_colour::CORNERS;

use crate::label::KnownLabel;
use crate::meter::PRIMARIES;
use crate::result::StateValues;

/// What computes a metric.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MetricSource {
    /// The colours of a display: [`run`](crate::run()).
    Colours,
    /// Its sharpness: [`spatial::mtf`](crate::spatial::mtf()).
    Mtf,
    /// Which sub-pixel lights which: [`spatial::crosstalk`](crate::spatial::crosstalk()).
    Crosstalk,
    /// Its sparkle: [`spatial::sparkle`](crate::spatial::sparkle()).
    Sparkle,
    /// A picture on it: [`image`](crate::image::image()).
    Image,
    /// Its gloss: [`gloss`](crate::gloss::gloss()).
    Gloss,
}

impl MetricSource {
    /// Command that prints the metrics; `None` for those of a run.
    pub fn command(self) -> Option<&'static str> {
        match self {
            Self::Colours => None,
            Self::Mtf => Some("mtf"),
            Self::Crosstalk => Some("crosstalk"),
            Self::Sparkle => Some("sparkle"),
            Self::Image => Some("image"),
            Self::Gloss => Some("gloss"),
        }
    }
}

numbers! {
    /// Colour appearance of a state (CIECAM16, CIE 248:2022).
    Cam16 {
        /// Lightness J.
        J = "CIECAM16 lightness J",
        /// Chroma C.
        C = "CIECAM16 chroma C",
        /// Lightness J' of CAM16-UCS.
        J_prime = "CAM16-UCS lightness J′",
        /// a' of CAM16-UCS.
        a_prime = "CAM16-UCS a′",
        /// b' of CAM16-UCS; the hue is the angle of (a', b').
        b_prime = "CAM16-UCS b′",
    }
}

numbers! {
    /// Contrast of lines of 1, 2 and 4 pixels across x and y; `white`: white lines on black.
    LineContrast {
        /// White line of one pixel, across x.
        white_1_x = "Contrast of a white line of 1 pixel across x",
        /// Of two pixels.
        white_2_x = "Contrast of a white line of 2 pixels across x",
        /// Of four pixels.
        white_4_x = "Contrast of a white line of 4 pixels across x",
        /// Black line of one pixel on white, across x.
        black_1_x = "Contrast of a black line of 1 pixel across x",
        /// Of two pixels.
        black_2_x = "Contrast of a black line of 2 pixels across x",
        /// Of four pixels.
        black_4_x = "Contrast of a black line of 4 pixels across x",
        /// White line of one pixel, across y.
        white_1_y = "Contrast of a white line of 1 pixel across y",
        /// Of two pixels.
        white_2_y = "Contrast of a white line of 2 pixels across y",
        /// Of four pixels.
        white_4_y = "Contrast of a white line of 4 pixels across y",
        /// Black line of one pixel on white, across y.
        black_1_y = "Contrast of a black line of 1 pixel across y",
        /// Of two pixels.
        black_2_y = "Contrast of a black line of 2 pixels across y",
        /// Of four pixels.
        black_4_y = "Contrast of a black line of 4 pixels across y",
    }
}

metrics! {
    /// Metrics of a view, which combine its states.
    view ViewMetrics {
        /// Y of white over Y of black.
        contrast_ratio = "Contrast ratio",
        /// Gamut area of the red, green and blue states in u'v', % of sRGB.
        gamut_percent_srgb = "Gamut area, u′v′" in "% of sRGB",
        /// The same, % of EBU.
        gamut_percent_ebu = "Gamut area, u′v′" in "% of EBU",
        /// The same, % of NTSC.
        gamut_percent_ntsc = "Gamut area, u′v′" in "% of NTSC",
        /// The same, % of DCI-P3.
        gamut_percent_dci_p3 = "Gamut area, u′v′" in "% of DCI-P3",
        /// Gamut coverage: fraction of the sRGB triangle in u'v' that the display covers, %.
        coverage_percent_srgb = "Gamut coverage, u′v′" in "% of sRGB",
        /// The same for the EBU triangle.
        coverage_percent_ebu = "Gamut coverage, u′v′" in "% of EBU",
        /// The same for the NTSC triangle.
        coverage_percent_ntsc = "Gamut coverage, u′v′" in "% of NTSC",
        /// The same for the DCI-P3 triangle.
        coverage_percent_dci_p3 = "Gamut coverage, u′v′" in "% of DCI-P3",
        /// Gamut area of the red, green and blue states in CIE 1931 xy, % of sRGB.
        gamut_percent_srgb_xy = "Gamut area, xy" in "% of sRGB",
        /// The same, % of EBU.
        gamut_percent_ebu_xy = "Gamut area, xy" in "% of EBU",
        /// The same, % of NTSC: the "NTSC" of data sheets.
        gamut_percent_ntsc_xy = "Gamut area, xy" in "% of NTSC",
        /// The same, % of DCI-P3.
        gamut_percent_dci_p3_xy = "Gamut area, xy" in "% of DCI-P3",
        /// Gamut coverage in CIE 1931 xy: fraction of the sRGB triangle that the display covers, %.
        coverage_percent_srgb_xy = "Gamut coverage, xy" in "% of sRGB",
        /// The same for the EBU triangle.
        coverage_percent_ebu_xy = "Gamut coverage, xy" in "% of EBU",
        /// The same for the NTSC triangle.
        coverage_percent_ntsc_xy = "Gamut coverage, xy" in "% of NTSC",
        /// The same for the DCI-P3 triangle.
        coverage_percent_dci_p3_xy = "Gamut coverage, xy" in "% of DCI-P3",
        /// Gamut volume in CIELAB, if `metrics.gamut_volume` is set.
        gamut_volume_cielab = "Gamut volume, CIELAB",
        /// Mean over red, green and blue of `peak_shift_nm` (Feng 2012, eq. 5-12).
        average_peak_shift_nm = "Mean peak shift" in "nm",
        /// Mean luminance of black text on white, cd/m2 (Feng 2012, eq. 5-13).
        text_luminance_cd_m2 = "Mean luminance of text" in "cd/m²",
        /// Contrast of black text on white (Feng 2012, eq. 5-14).
        text_contrast = "Contrast of text",
        /// Reading performance of a reader of 20 years, 0 to 1: a surrogate calibrated on Feng 2012,
        /// table 5.3; null outside its range.
        reading_surrogate_age_20 = "Reading performance at 20 years, surrogate",
        /// The same for a reader of 50 years.
        reading_surrogate_age_50 = "Reading performance at 50 years, surrogate",
        /// The same for a reader of 75 years.
        reading_surrogate_age_75 = "Reading performance at 75 years, surrogate",
        /// The same for a reader of `viewer.age_years`; null if the scenario does not specify an age.
        reading_surrogate = "Reading performance, surrogate",
        /// Visibility level of black text on white for the result's reader: the luminance difference over the one that is
        /// just visible (Adrian 1989).
        visibility_level = "Visibility level",
        /// Contrast of black text on white times the eye's contrast sensitivity (Barten 1999), for the result's reader; 1: just
        /// visible.
        contrast_margin = "Contrast margin",
    }
    // Fields of `StateValues` that are metrics, too.
    values {
        X = "Tristimulus value X",
        Y = "Luminance factor Y",
        Z = "Tristimulus value Z",
        x = "Chromaticity x",
        y = "Chromaticity y",
        u_prime = "Chromaticity u′",
        v_prime = "Chromaticity v′",
        L_star = "Lightness L*",
        a_star = "CIELAB a*",
        b_star = "CIELAB b*",
        luminance_cd_m2 = "Luminance" in "cd/m²",
        contrast = "Contrast ratio to black",
        peak_nm = "Peak wavelength" in "nm",
        distance_from_white_uv = "Distance in u′v′ from the white of the light",
        distance_from_d65_uv = "Distance in u′v′ from D65",
        R_hemi = "Luminance factor in diffuse light",
    }
    /// Comparisons of a state's colour with other colours.
    state StateMetrics {
        /// CIELUV u*, relative to the illuminant's white.
        u_star = "CIELUV u*",
        /// CIELUV v*.
        v_star = "CIELUV v*",
        /// CIEDE2000 difference from the perfect white in the same light.
        delta_E_2000_from_white = "Colour difference CIEDE2000 from the perfect white",
        /// CIEDE2000 difference from the reference state in the same view.
        delta_E_2000_from_reference = "Colour difference CIEDE2000 from the reference state",
        /// u'v' distance from the reference state in the same view.
        distance_from_reference_uv = "Distance in u′v′ from the reference state",
    }
    // Fields of `StateMetrics` that compare views: known only after all views, so that they cannot be targets.
    between_views {
        /// CIEDE2000 difference from the same state in the view nearest to the normal.
        delta_E_2000_with_angle = "Colour difference CIEDE2000 with angle",
        /// u'v' distance from the same state in the view nearest to the normal.
        shift_with_angle_uv = "Colour shift in u′v′ with angle",
    }
    // Further fields of `StateMetrics`; the order is that of the results.
    state {
        /// `peak_nm` minus that of the pixel alone in the direction of the view (Feng 2012, eq. 5-12), nm.
        peak_shift_nm = "Peak shift" in "nm",
    }
    /// Sharpness of a view: results of [`spatial::mtf`](crate::spatial::mtf()).
    mtf_view SharpnessMetrics {
        /// White line of one pixel, across x.
        line_contrast_white_1_x = "Contrast of a white line of 1 pixel across x",
        /// Of two pixels.
        line_contrast_white_2_x = "Contrast of a white line of 2 pixels across x",
        /// Of four pixels.
        line_contrast_white_4_x = "Contrast of a white line of 4 pixels across x",
        /// Black line of one pixel on white, across x.
        line_contrast_black_1_x = "Contrast of a black line of 1 pixel across x",
        /// Of two pixels.
        line_contrast_black_2_x = "Contrast of a black line of 2 pixels across x",
        /// Of four pixels.
        line_contrast_black_4_x = "Contrast of a black line of 4 pixels across x",
        /// White line of one pixel, across y.
        line_contrast_white_1_y = "Contrast of a white line of 1 pixel across y",
        /// Of two pixels.
        line_contrast_white_2_y = "Contrast of a white line of 2 pixels across y",
        /// Of four pixels.
        line_contrast_white_4_y = "Contrast of a white line of 4 pixels across y",
        /// Black line of one pixel on white, across y.
        line_contrast_black_1_y = "Contrast of a black line of 1 pixel across y",
        /// Of two pixels.
        line_contrast_black_2_y = "Contrast of a black line of 2 pixels across y",
        /// Of four pixels.
        line_contrast_black_4_y = "Contrast of a black line of 4 pixels across y",
        /// Smallest contrast of the middles of strokes of black text with the white page.
        text_contrast_min = "Smallest contrast of strokes",
        /// Median of the contrasts of the middles of strokes.
        text_contrast_median = "Median contrast of strokes",
        /// Equivalent exponent n of Yule and Nielsen.
        yule_nielsen_n = "Equivalent exponent of Yule and Nielsen",
        /// Mean Y over a period of the first pattern of `[pattern]`, the images of the room in flat faces included: a halftone.
        pattern_mean_Y = "Mean luminance factor Y of the pattern",
    }
    /// Sharpness of a state: results of [`spatial::mtf`](crate::spatial::mtf()). x is to the right, y up.
    mtf_state SpatialScalars {
        /// Spatial frequency along x at which the modulation transfer is first 0.5, cycles per mm.
        f50_x_per_mm = "Frequency of half the modulation along x" in "per mm",
        /// The same along y.
        f50_y_per_mm = "Frequency of half the modulation along y" in "per mm",
        /// Modulation transfer along x at the Nyquist frequency of the pixels.
        mtf_nyquist_x = "Modulation transfer at Nyquist along x",
        /// The same along y.
        mtf_nyquist_y = "Modulation transfer at Nyquist along y",
        /// Width of an edge along x from 10 to 90 %, um.
        edge_10_90_x_um = "Width of an edge along x, 10 to 90 %" in "μm",
        /// The same along y.
        edge_10_90_y_um = "Width of an edge along y, 10 to 90 %" in "μm",
        /// Radius about the view's own ray with half of the light, um.
        r50_um = "Radius with half of the light" in "μm",
        /// The same with 90 % of the light.
        r90_um = "Radius with 90 % of the light" in "μm",
        /// Square-root integral (Barten 1990) along x, just noticeable differences.
        sqri_jnd_x = "Square-root integral along x" in "JND",
        /// The same along y.
        sqri_jnd_y = "Square-root integral along y" in "JND",
    }
    /// Crosstalk of a view: results of [`spatial::crosstalk`](crate::spatial::crosstalk()).
    crosstalk CrosstalkMetrics {
        /// Of the light that is seen through windows, the fraction that left the sub-pixel of its window.
        own_share_out = "Share of the own sub-pixel in what is seen",
        /// Of this light, the fraction that left another sub-pixel.
        neighbours_share_out = "Share of other sub-pixels in what is seen",
        /// Of the light that reaches sub-pixels, the fraction that entered through the window above; with a filter.
        own_share_in = "Share of the own window in the light of a sub-pixel",
        /// Of this light, the fraction that entered through another window; with a filter.
        neighbours_share_in = "Share of other windows in the light of a sub-pixel",
        /// Gamut area of a uniform page in u'v', % of sRGB.
        patch_gamut_percent_srgb = "Gamut area of patches, u′v′" in "% of sRGB",
        /// Y of a white page over Y of a black one.
        patch_contrast_ratio = "Contrast ratio of patches",
        /// The same without the images of the room in flat faces.
        patch_contrast_ratio_via_pixel = "Contrast ratio of patches via the pixel",
        /// Gamut area of stripes of one pixel in u'v', % of sRGB.
        stripe_1_gamut_percent_srgb = "Gamut area of stripes of 1 pixel, u′v′" in "% of sRGB",
        /// Y of the white page over Y of stripes of one pixel in black.
        stripe_1_contrast_ratio = "Contrast ratio of stripes of 1 pixel",
        /// The same without the images of the room in flat faces.
        stripe_1_contrast_ratio_via_pixel = "Contrast ratio of stripes of 1 pixel via the pixel",
        /// Gamut area of a single line of one pixel in u'v', % of sRGB.
        line_1_gamut_percent_srgb = "Gamut area of lines of 1 pixel, u′v′" in "% of sRGB",
        /// Y of the white page over Y of a single line of one pixel in black.
        line_1_contrast_ratio = "Contrast ratio of lines of 1 pixel",
        /// The same without the images of the room in flat faces.
        line_1_contrast_ratio_via_pixel = "Contrast ratio of lines of 1 pixel via the pixel",
        /// Gamut area of text in u'v', % of sRGB.
        text_gamut_percent_srgb = "Gamut area of text, u′v′" in "% of sRGB",
        /// Y of the white page over Y of text in black.
        text_contrast_ratio = "Contrast ratio of text",
        /// The same without the images of the room in flat faces.
        text_contrast_ratio_via_pixel = "Contrast ratio of text via the pixel",
    }
    /// Sparkle of a view: the first row of [`spatial::sparkle`](crate::spatial::sparkle()).
    sparkle SparkleMetrics {
        /// Pixel power deviation.
        ppd = "Pixel power deviation",
        /// Matrix term of `ppd`: in uniform light.
        ppd_matrix = "Pixel power deviation, matrix term",
        /// Source term of `ppd`: of a uniform pixel plane in the light of the room.
        ppd_lamp = "Pixel power deviation, lamp term",
    }
    /// A picture on the display, compared with the picture itself (its white is that of the display, its black is 0) and with the picture
    /// in the display's white and black, before gamut mapping (with `mapped_`: after it): results of [`image`](crate::image::image()).
    image ImageMetrics {
        /// CIEDE2000 of the pixels from the picture itself: the mean.
        photograph_delta_e_2000_mean = "Mean colour difference CIEDE2000 from the photograph",
        /// S-CIELAB from the picture itself: the mean.
        photograph_scielab_mean = "Mean S-CIELAB difference from the photograph",
        /// The same, 95th percentile.
        photograph_scielab_p95 = "S-CIELAB difference from the photograph, 95th percentile",
        /// FLIP from the picture itself: the mean.
        photograph_flip_mean = "Mean FLIP difference from the photograph",
        /// CIEDE2000 of the pixels: the mean.
        delta_e_2000_mean = "Mean colour difference CIEDE2000 of pixels",
        /// The same, 95th percentile.
        delta_e_2000_p95 = "Colour difference CIEDE2000 of pixels, 95th percentile",
        /// S-CIELAB: the mean.
        scielab_mean = "Mean S-CIELAB difference",
        /// The same, 95th percentile.
        scielab_p95 = "S-CIELAB difference, 95th percentile",
        /// FLIP: the mean.
        flip_mean = "Mean FLIP difference",
        /// Root mean square difference of the mean Y of blocks of 64 x 64 pixels from the picture after gamut mapping, per cent: what
        /// halftone and layers do to tones.
        mapped_tone_shift_percent = "Tone shift of halftone and layers" in "%",
        /// Root mean square CIEDE2000 of the mean colours of these blocks.
        mapped_tone_shift_delta_e_2000 = "Tone shift of halftone and layers, CIEDE2000",
        /// Fraction of the pixels whose colour no mixture of states has.
        out_of_gamut_fraction = "Fraction of pixels out of gamut",
        /// Fraction of the pixels that a screen cannot show.
        clipped_fraction = "Fraction of pixels clipped by a screen",
    }
    /// Gloss of a state: results of [`gloss`](crate::gloss::gloss()).
    gloss GlossMetrics {
        /// Gloss at 20 deg (ISO 2813:2014), gloss units: 100 for polished black glass of index 1.567.
        gloss_20 = "Gloss at 20°" in "GU",
        /// The same at 60 deg.
        gloss_60 = "Gloss at 60°" in "GU",
        /// The same at 85 deg.
        gloss_85 = "Gloss at 85°" in "GU",
        /// Distinctness of the image of a slit at 30 deg (after ASTM E430), 100 for a flat mirror.
        distinctness_of_image = "Distinctness of image",
        /// Haze of the front in transmission (after ASTM D1003), per cent: what leaves at more than 2.5 deg, for one scattering
        /// interface among flat ones.
        haze_percent = "Haze" in "%",
    }
}

impl Metric {
    /// States without which a metric of [`MetricSource::Colours`] is not defined, besides the state of a metric of a state. Metrics of
    /// other sources have none here.
    pub fn needed_states(self) -> &'static [&'static str] {
        match self {
            Self::contrast => &["black"],
            Self::contrast_ratio
            | Self::text_luminance_cd_m2
            | Self::text_contrast
            | Self::reading_surrogate
            | Self::reading_surrogate_age_20
            | Self::reading_surrogate_age_50
            | Self::reading_surrogate_age_75
            | Self::visibility_level
            | Self::contrast_margin => &["white", "black"],
            Self::gamut_volume_cielab => &CORNERS,
            _ if self.is_of_view() && self.source() == MetricSource::Colours => &PRIMARIES,
            _ => &[],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Names are unique, and those of sharpness, crosstalk and sparkle are of their commands.
    #[test]
    fn metrics_of_pixels_have_their_sources() {
        for metric in Metric::ALL {
            assert_eq!(Metric::ALL.iter().filter(|other| other.name() == metric.name()).count(), 1);
        }
        let source = |name: &str| Metric::named(name).map(Metric::source);
        assert_eq!(source("line_contrast_white_1_x"), Some(MetricSource::Mtf));
        assert_eq!(source("f50_x_per_mm"), Some(MetricSource::Mtf));
        assert_eq!(source("ppd"), Some(MetricSource::Sparkle));
        assert_eq!(source("flip_mean"), Some(MetricSource::Image));
        assert_eq!(source("stripe_1_gamut_percent_srgb"), Some(MetricSource::Crosstalk));
        assert_eq!(source("contrast_ratio"), Some(MetricSource::Colours));
        assert!(Metric::ppd.is_of_view() && !Metric::f50_x_per_mm.is_of_view());
    }

    /// Every field of `ViewMetrics` and `StateMetrics` can be a target, except for those that compare views.
    #[test]
    fn every_field_of_a_result_is_a_metric() {
        for (name, _) in ViewMetrics::default().named() {
            assert!(Metric::named(name).is_some_and(Metric::is_of_view), "{name}");
        }
        let names = SharpnessMetrics::default().named().chain(CrosstalkMetrics::default().named());
        for (name, _) in names.chain(SparkleMetrics::default().named()).chain(ImageMetrics::default().named())
        {
            assert!(Metric::named(name).is_some_and(Metric::is_of_view), "{name}");
        }
        for (name, _) in SpatialScalars::default().named().chain(GlossMetrics::default().named()) {
            assert!(Metric::named(name).is_some_and(|metric| !metric.is_of_view()), "{name}");
        }
        let comparing_views = ["delta_E_2000_with_angle", "shift_with_angle_uv"];
        for (name, _) in StateMetrics::default().named() {
            assert_eq!(Metric::named(name).is_some(), !comparing_views.contains(&name), "{name}");
        }
    }
}
