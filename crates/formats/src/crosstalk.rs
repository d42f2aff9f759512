//! Output files of `papilio crosstalk`: `crosstalk.json`, `crosstalk.csv` and `patterns.csv`.

use std::io::{self, Write};

use papilio_display::spatial::{CrosstalkResult, Shares};

use crate::spatial::SpatialFile;

/// Content of `crosstalk.json`.
pub type CrosstalkFile<'a> = SpatialFile<'a, CrosstalkResult>;

/// Returns the JSON Schema of `crosstalk.json`.
pub fn crosstalk_schema() -> serde_json::Value {
    schemars::schema_for!(CrosstalkFile<'_>).to_value()
}

/// Name of the area without sub-pixels in tables.
const INACTIVE: &str = "inactive";

/// Writes `crosstalk.csv`: one row per view, light, way (`in` or `out`), window and sub-pixel; `all` is all
/// light. On the way out, shares of a window sum to 1; on the way in, shares of a sub-pixel. Light of the
/// inactive area (`out`), and light that entered between the windows (`in`), have rows of their own: their
/// shares are those of all light.
///
/// # Errors
/// Those of `out`.
pub fn write_crosstalk_csv(out: impl Write, result: &CrosstalkResult) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(out);
    csv.write_record(["theta_deg", "phi_deg", "light", "way", "window", "subpixel", "share", "error"])?;
    let names = &result.subpixels;
    for view in &result.views {
        let angles = [view.theta_deg.to_string(), view.phi_deg.to_string()];
        let mut write = |light: &str, shares: &Shares, way: &str, window: &str, from: &str, share: f64| {
            let numbers = [share, shares.error].map(|number| number.to_string());
            let [theta, phi] = &angles;
            csv.write_record([theta.as_str(), phi, light, way, window, from, &numbers[0], &numbers[1]])
        };
        for (light, shares) in [("all", &view.shares)].into_iter().chain(view.by_light.iter()) {
            for ((window, row), inactive) in names.iter().zip(&shares.out).zip(&shares.inactive_out) {
                for (from, share) in names.iter().zip(row) {
                    write(light, shares, "out", window, from, *share)?;
                }
                write(light, shares, "out", window, INACTIVE, *inactive)?;
            }
            let between = shares.between_in.iter().flatten();
            for ((to, row), between) in names.iter().zip(shares.in_.iter().flatten()).zip(between) {
                for (window, share) in names.iter().zip(row) {
                    write(light, shares, "in", window, to, *share)?;
                }
                write(light, shares, "in", INACTIVE, to, *between)?;
            }
        }
    }
    csv.flush()
}

/// Writes `patterns.csv`: one row per view and pattern. Cells of undefined values are empty.
///
/// # Errors
/// Those of `out`.
pub fn write_patterns_csv(out: impl Write, result: &CrosstalkResult) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(out);
    csv.write_record([
        "theta_deg",
        "phi_deg",
        "pattern",
        "gamut_percent_srgb",
        "contrast_ratio",
        "contrast_ratio_via_pixel",
        "gamut_percent_srgb_error",
        "contrast_ratio_error",
        "contrast_ratio_via_pixel_error",
    ])?;
    for view in &result.views {
        for pattern in &view.patterns {
            let mut row =
                vec![view.theta_deg.to_string(), view.phi_deg.to_string(), pattern.name.name().to_owned()];
            for values in [&pattern.values, &pattern.error] {
                let numbers =
                    [values.gamut_percent_srgb, values.contrast_ratio, values.contrast_ratio_via_pixel];
                row.extend(numbers.map(|value| value.map_or(String::new(), |value| value.to_string())));
            }
            csv.write_record(row)?;
        }
    }
    csv.flush()
}
