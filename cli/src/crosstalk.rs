//! `papilio crosstalk`: which sub-pixel lights which, and the colours and contrast of fine figures.

use std::path::Path;

use papilio_display::spatial::{CrosstalkResult, CrosstalkView};
use papilio_formats::{write_crosstalk_csv, write_file, write_patterns_csv};
use papilio_scenario::Resolved;
use serde::Serialize;

use crate::arguments::{SolvedSpatially, Solver};
use crate::numbers::measured;
use crate::spatial::{SpatialOutput, show, with_scenario};
use crate::{Failure, report};

pub(crate) fn crosstalk(arguments: &SolvedSpatially) -> Result<(), Failure> {
    let SolvedSpatially { spatial: arguments, solver } = arguments;
    let resolved = arguments.resolve(solver.map(Solver::as_override))?;
    show(arguments, &resolved, |control| {
        papilio_display::spatial::crosstalk(&resolved.scene, &resolved.patterns.text, control)
    })
}

impl SpatialOutput for CrosstalkResult {
    const JSON: &'static str = "crosstalk.json";
    const FIGURES: &'static [&'static str] = &["crosstalk"];

    fn content<'a>(&'a self, resolved: &'a Resolved, _: &'a str, notes: &'a [String]) -> impl Serialize + 'a {
        with_scenario(resolved, notes, self)
    }

    fn table(&self, title: &str) -> String {
        text(title, self)
    }

    fn write_tables(&self, folder: &Path) -> Result<Vec<String>, Failure> {
        write_file(&folder.join("crosstalk.csv"), |out| write_crosstalk_csv(out, self))?;
        write_file(&folder.join("patterns.csv"), |out| write_patterns_csv(out, self))?;
        Ok(["crosstalk.csv", "patterns.csv"].map(str::to_owned).to_vec())
    }

    fn figures(&self, title: &str) -> Vec<(String, String)> {
        papilio_figures::crosstalk(self, title)
    }

    fn notes(&self, resolved: &Resolved) -> Vec<String> {
        resolved.notes_of_places()
    }

    fn warnings(&mut self) -> &mut Vec<String> {
        &mut self.warnings
    }
}

fn text(title: &str, result: &CrosstalkResult) -> String {
    let [x, y] = result.pitch_um;
    let mut text =
        format!("{}\npixels of {x:.2} x {y:.2} um, uniform page: {}\n", report::plain(title), result.page);
    for view in &result.views {
        text += &format!("\nviewed at theta {} deg, phi {} deg\n", view.theta_deg, view.phi_deg);
        text += &of_view(result, view);
    }
    if result.subpixels.len() > 1 {
        text += &format!("\nlargest error of a share: {:.1e}\n", result.error_reached);
    }
    text
}

fn of_view(result: &CrosstalkResult, view: &CrosstalkView) -> String {
    let shares = &view.shares;
    let has_shares = result.subpixels.len() > 1;
    let mut text = if has_shares {
        matrix("seen through, from", &result.subpixels, &shares.out, "inactive", &shares.inactive_out)
    } else {
        "  pixels without sub-pixels: there are no shares, see the contrast of figures".to_owned()
    };
    if let (true, Some(entered), Some(between)) = (has_shares, &shares.in_, &shares.between_in) {
        text += "\n";
        text += &matrix("reaches, entered through", &result.subpixels, entered, "between", between);
    }
    let percent = |share: Option<f64>, error: Option<f64>| {
        format!("{} %", measured(share.map(|share| 100.0 * share), error.map(|error| 100.0 * error), 2))
    };
    if has_shares {
        let [out, entered] = shares.own_share_errors;
        text += &format!("  own share on the way out {}", percent(shares.own_share_out, out));
        if shares.own_share_in.is_some() {
            text += &format!(", on the way in {}", percent(shares.own_share_in, entered));
        }
    }
    text += "\n\n";
    let head = ["mean of, on a page", "gamut, % of sRGB", "contrast ratio", "contrast ratio via pixel"];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    for pattern in &view.patterns {
        let (values, error) = (&pattern.values, &pattern.error);
        rows.push(vec![
            pattern.name.name().to_owned(),
            measured(values.gamut_percent_srgb, error.gamut_percent_srgb, 4),
            measured(values.contrast_ratio, error.contrast_ratio, 4),
            measured(values.contrast_ratio_via_pixel, error.contrast_ratio_via_pixel, 4),
        ]);
    }
    text += &report::table(&rows);
    let mut reasons: Vec<(&str, Vec<&str>)> = Vec::new();
    for (why, name) in view.patterns.iter().filter_map(|one| Some((one.why_null?, one.name.name()))) {
        match reasons.iter_mut().find(|(known, _)| *known == why) {
            Some((_, names)) => names.push(name),
            None => reasons.push((why, vec![name])),
        }
    }
    for (why, names) in reasons {
        text += &format!("  {}: {why}\n", names.join(", "));
    }
    text
}

/// Shares in per cent, with the light of the area without sub-pixels in the last column if there is any.
fn matrix(head: &str, names: &[String], shares: &[Vec<f64>], rest: &str, others: &[f64]) -> String {
    let has_rest = others.iter().any(|share| *share > 0.0);
    let mut first = vec![head.to_owned()];
    first.extend(names.iter().cloned());
    first.extend(has_rest.then(|| format!("({rest})")));
    let mut rows = vec![first];
    for ((name, row), other) in names.iter().zip(shares).zip(others) {
        let percent = |share: f64| format!("{:.2} %", 100.0 * share);
        let mut cells = vec![name.clone()];
        cells.extend(row.iter().map(|share| percent(*share)));
        cells.extend(has_rest.then(|| percent(*other)));
        rows.push(cells);
    }
    report::table(&rows)
}
