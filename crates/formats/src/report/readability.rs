//! Report on the readability of black text on white, for a reader whom the scenario describes.

use papilio_colour::reader::{AGES_YEARS, DIAMETERS_ARCMIN, LUMINANCES_CD_M2};
use papilio_display::readability::{CONTRAST_RANGE, LUMINANCE_RANGE_CD_M2};
use papilio_display::result::{Reader, View};

use super::numbers::measured;

/// Luminance, contrast and readability of black text on white; nothing without white, black or a described
/// reader.
pub(super) fn of_text(view: &View, reader: &Reader) -> String {
    let (text, error) = (&view.metrics, &view.standard_error);
    let (true, Some(luminance), Some(contrast)) =
        (reader.is_described, text.text_luminance_cd_m2, text.text_contrast)
    else {
        return String::new();
    };
    let Reader { age_years, text_height_mm, distance_mm, detail_arcmin, .. } = reader;
    let light = outside("mean luminance", luminance, LUMINANCES_CD_M2, " cd/m2");
    let age = outside("age", *age_years, AGES_YEARS, " years");
    let details = outside("size of details", *detail_arcmin, DIAMETERS_ARCMIN, " arcmin");
    let of_level =
        note(&[&light, &details, &age]).unwrap_or_else(|| " (Adrian 1989; 1: just visible)".to_owned());
    let of_margin = note(&[&light, &age]).unwrap_or_else(|| " (Barten 1999; 1: just visible)".to_owned());
    format!(
        "  black text on white: mean luminance {} cd/m2, contrast {}\n  reader of {age_years} years, lower-case x of \
         {text_height_mm} mm at {distance_mm} mm (details of {detail_arcmin:.2} arcmin):\n    visibility level \
         {}{of_level}\n    contrast margin {}{of_margin}\n{}",
        measured(Some(luminance), error.text_luminance_cd_m2, 1),
        measured(Some(contrast), error.text_contrast, 3),
        measured(text.visibility_level, error.visibility_level, 2),
        measured(text.contrast_margin, error.contrast_margin, 1),
        surrogate(view, luminance, contrast),
    )
}

/// The reading performance of Feng 2012, table 5.3, or the bounds of its range that are not met; nothing if
/// the reader has no age.
fn surrogate(view: &View, luminance: f64, contrast: f64) -> String {
    let light = outside("mean luminance", luminance, LUMINANCE_RANGE_CD_M2, " cd/m2");
    let contrast = outside("contrast", contrast, CONTRAST_RANGE, "");
    match (view.metrics.reading_surrogate, note(&[&light, &contrast])) {
        (Some(fraction), _) => {
            format!(
                "    reading performance {:.0} % (calibrated on Feng 2012, table 5.3)\n",
                100.0 * fraction
            )
        }
        (None, Some(bounds)) => {
            format!("    reading performance (Feng 2012, table 5.3): no estimate{bounds}\n")
        }
        (None, None) => String::new(),
    }
}

/// Joins the bounds that are not met; `None` if there are none.
fn note(bounds: &[&Option<String>]) -> Option<String> {
    let known: Vec<&str> = bounds.iter().filter_map(|bound| bound.as_deref()).collect();
    (!known.is_empty()).then(|| format!("; {}", known.join("; ")))
}

/// Describes a value outside a range; `None` inside.
fn outside(what: &str, value: f64, [least, most]: [f64; 2], unit: &str) -> Option<String> {
    let digits = |value: f64| {
        let decimals =
            if value == 0.0 { 0 } else { (2.0 - value.abs().log10().floor()).clamp(0.0, 12.0) as usize };
        format!("{value:.decimals$}")
    };
    let side = if value < least { "below" } else { "above" };
    (!(least..=most).contains(&value))
        .then(|| format!("{what} {}{unit} is {side} its range, {least} to {most}{unit}", digits(value)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_that_are_not_met_are_stated() {
        assert_eq!(outside("mean luminance", 10.0, [0.1, 1e4], " cd/m2"), None);
        let dim = outside("mean luminance", 0.0423, [0.1, 1e4], " cd/m2").unwrap();
        assert_eq!(dim, "mean luminance 0.0423 cd/m2 is below its range, 0.1 to 10000 cd/m2");
        let bright = outside("mean luminance", 12345.6, [0.1, 1e4], " cd/m2").unwrap();
        assert_eq!(bright, "mean luminance 12346 cd/m2 is above its range, 0.1 to 10000 cd/m2");
    }
}
