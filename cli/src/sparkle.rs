//! `papilio sparkle`: random brightness of equal pixels below an antiglare face.

use std::path::Path;

use papilio_display::spatial::{SparkleResult, SparkleRow};
use papilio_formats::{SparkleFile, write_file, write_sparkle};
use papilio_scenario::Resolved;
use serde::Serialize;

use crate::arguments::SpatialCommand;
use crate::numbers::measured;
use crate::spatial::{SpatialOutput, show};
use crate::{Failure, report};

/// Explains the missing face.
const NO_FACE: &str = "the scenario describes no antiglare face: the table [sparkle] is missing\n  \
    = note: expected slope_rms or haze of the face, and its correlation_um; or a rough layer with distribution = \"beckmann\" and \
    correlation_um; or a single layer with surface = \"gaussian\" in the file of its geometry\n  \
    = help: for example --set sparkle.haze=0.05 --set sparkle.correlation_um=[8,15,30]; a gloss number determines neither";

pub(crate) fn sparkle(arguments: &SpatialCommand) -> Result<(), Failure> {
    let resolved = arguments.resolve(None)?;
    let face = resolved.sparkle.as_ref().ok_or_else(|| Failure::Input(NO_FACE.to_owned()))?;
    show(arguments, &resolved, |control| papilio_display::spatial::sparkle(&resolved.scene, face, control))
}

impl SpatialOutput for SparkleResult {
    const JSON: &'static str = "sparkle.json";
    const FIGURES: &'static [&'static str] = &["sparkle", "ppd"];

    fn content<'a>(
        &'a self,
        resolved: &'a Resolved,
        title: &'a str,
        notes: &'a [String],
    ) -> impl Serialize + 'a {
        SparkleFile {
            papilio: env!("CARGO_PKG_VERSION"),
            title,
            hash: &resolved.hash,
            seed: resolved.scene.solver.seed,
            notes,
            result: self,
        }
    }

    fn table(&self, title: &str) -> String {
        text(title, self)
    }

    fn write_tables(&self, folder: &Path) -> Result<Vec<String>, Failure> {
        write_file(&folder.join("sparkle.csv"), |out| write_sparkle(out, self))?;
        Ok(vec!["sparkle.csv".to_owned()])
    }

    fn figures(&self, title: &str) -> Vec<(String, String)> {
        papilio_figures::of_sparkle(self, title)
    }

    fn warnings(&mut self) -> &mut Vec<String> {
        &mut self.warnings
    }
}

fn text(title: &str, result: &SparkleResult) -> String {
    let head = [
        "view, deg",
        "gap, mm",
        "correlation, um",
        "details, um",
        "slope",
        "PPD, %",
        "by the matrix, %",
        "by lamps, %",
        "closed form, %",
        "contrast x sensitivity",
    ];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    rows.extend(result.rows.iter().map(cells));
    let threshold =
        "where contrast x sensitivity is above 1, sparkle is above the eye's threshold at this distance";
    let beyond = result.rows.iter().filter(|row| row.is_beyond_rays());
    let least = beyond.map(|row| row.rays_valid_from_um).fold(0.0, f64::max);
    let limit = if least > 0.0 {
        format!(
            "* details below sqrt(lambda gap/(2 n)), up to {least:.1} um here: rays are no reference, waves differ from them by up to 20 %\n"
        )
    } else {
        String::new()
    };
    format!(
        "{}\n\npixel power deviation (PPD) of the state {}, pixels of {} x {} um, pupil {} mm, {} mm away\n{}\n{threshold}\n{limit}",
        report::plain(title),
        result.state,
        crate::numbers::digits(result.pitch_um[0]),
        crate::numbers::digits(result.pitch_um[1]),
        result.pupil_mm,
        result.distance_mm,
        report::table(&rows),
    )
}

fn cells(row: &SparkleRow) -> Vec<String> {
    let percent = |value: f64, error: f64| measured(Some(100.0 * value), Some(100.0 * error), 3);
    let view = if row.phi_deg == 0.0 {
        format!("{}", row.theta_deg)
    } else {
        format!("{}, {}", row.theta_deg, row.phi_deg)
    };
    vec![
        view,
        format!("{:.4}", row.gap_mm),
        format!("{:.2}", row.correlation_um),
        format!("{:.2}{}", row.detail_um, if row.is_beyond_rays() { "*" } else { "" }),
        format!("{:.4}", row.slope_rms),
        percent(row.ppd, row.standard_error),
        percent(row.ppd_matrix, row.ppd_matrix_error),
        percent(row.ppd_lamp, row.ppd_lamp_error),
        measured(row.ppd_closed_form.map(|ppd| 100.0 * ppd), None, 3),
        measured(row.contrast_times_sensitivity, None, 2),
    ]
}
