//! `papilio sparkle`: random brightness of equal pixels below an antiglare face.

use std::io::Write;

use papilio_display::spatial::{SparkleResult, SparkleRow};
use papilio_figures::{sparkle_curves, sparkle_maps};
use papilio_formats::{SparkleFile, write_file, write_json, write_sparkle};
use papilio_scenario::Scenario;

use crate::arguments::SpatialCommand;
use crate::numbers::measured;
use crate::run::with_progress;
use crate::{Failure, folder, input, interrupt, output, print_message, print_notes, report};

const FILES: [&str; 2] = ["sparkle.json", "sparkle.csv"];

/// Explains the missing face.
const NO_FACE: &str = "the scenario describes no antiglare face: the table [sparkle] is missing\n  \
    = note: expected slope_rms or haze of the face, and its correlation_um; or a rough layer with distribution = \"beckmann\" and \
    correlation_um\n  \
    = help: for example --set sparkle.haze=0.05 --set sparkle.correlation_um=[8,15,30]; a gloss number determines neither";

pub(crate) fn sparkle(arguments: &SpatialCommand) -> Result<(), Failure> {
    let resolved = arguments.resolve()?;
    let face = resolved.sparkle.as_ref().ok_or_else(|| Failure::Input(NO_FACE.to_owned()))?;
    let folder = arguments.folder(&resolved.hash)?;
    let result = with_progress(&resolved, arguments.workers.threads, |control| {
        papilio_display::spatial::sparkle(&resolved.scene, face, control)
    })?;
    let result = result.ok_or(Failure::Interrupted("no file was written"))?;
    let title = resolved.title.clone().unwrap_or_else(|| report::file_title(&arguments.scenario.file));
    let seed = resolved.scene.solver.seed;
    let file = SparkleFile {
        papilio: env!("CARGO_PKG_VERSION"),
        title: &title,
        hash: &resolved.hash,
        seed,
        result: &result,
    };
    let mut stdout = crate::terminal::output(arguments.json);
    if arguments.json {
        write_json(&mut stdout, &file)?;
    } else {
        stdout.write_all(table(&title, &result).as_bytes())?;
    }
    stdout.flush()?;
    if let Some(folder) = folder {
        let mut names = FILES.map(str::to_owned).to_vec();
        interrupt::uninterrupted(|| {
            output::make_folder(&folder)?;
            write_file(&folder.join(FILES[0]), |out| write_json(out, &file))?;
            write_file(&folder.join(FILES[1]), |out| write_sparkle(out, &result))?;
            let mut figures = vec![("sparkle".to_owned(), sparkle_maps(&result, &title))];
            figures.extend(sparkle_curves(&result, &title).map(|svg| ("ppd".to_owned(), svg)));
            names.extend(output::write_figures(&folder, figures, arguments.png)?);
            Ok::<(), Failure>(())
        })?;
        output::print_written(&folder, &names);
    }
    print_notes(&resolved.notes);
    resolved.warnings.iter().for_each(|warning| print_message(&format!("warning: {warning}")));
    Ok(())
}

/// The table on the terminal.
fn table(title: &str, result: &SparkleResult) -> String {
    let head = [
        "view, deg",
        "gap, mm",
        "correlation, um",
        "slope",
        "PPD, %",
        "by the matrix, %",
        "by lamps, %",
        "closed form, %",
        "contrast x sensitivity",
    ];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    rows.extend(result.rows.iter().map(cells));
    let threshold = "contrast x sensitivity above 1: sparkle is above the eye's threshold at this distance";
    format!(
        "{}\n\npixel power deviation (PPD) of the state {}, pixels of {} x {} um, pupil {} mm, {} mm away\n{}\n{threshold}\n",
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
        format!("{:.4}", row.slope_rms),
        percent(row.ppd, row.standard_error),
        percent(row.ppd_matrix, row.ppd_matrix_error),
        percent(row.ppd_lamp, row.ppd_lamp_error),
        measured(row.ppd_closed_form.map(|ppd| 100.0 * ppd), None, 3),
        measured(row.contrast_times_sensitivity, None, 2),
    ]
}

impl SpatialCommand {
    /// Reads and resolves the scenario, with the seed.
    pub(crate) fn resolve(&self) -> Result<papilio_scenario::Resolved, Failure> {
        self.resolve_with(None)
    }

    /// The same with a further override.
    pub(crate) fn resolve_with(&self, more: Option<String>) -> Result<papilio_scenario::Resolved, Failure> {
        let mut overrides = self.scenario.set.clone();
        overrides.extend(more);
        overrides.extend(self.seed.map(|seed| format!("solver.seed={seed}")));
        Ok(input::scenario::<Scenario>(&self.scenario.file, &overrides)?.resolve()?)
    }

    /// Returns the folder for files; `None` if only JSON is printed.
    pub(crate) fn folder(&self, hash: &str) -> Result<Option<std::path::PathBuf>, Failure> {
        match (&self.scenario.out, self.json) {
            (None, true) => Ok(None),
            _ => folder::choose(&self.scenario, hash).map(Some),
        }
    }
}
