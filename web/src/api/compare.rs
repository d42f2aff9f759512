//! The endpoint `/compare`: a scenario compared with a measured panel, as by `papilio compare`.

use std::collections::BTreeMap;
use std::sync::atomic::AtomicBool;

use axum::http::StatusCode;
use papilio_display::compare::{Comparison, compare_measurement};
use papilio_figures::{compared_gamuts, compared_metrics, compared_spectra};
use papilio_formats::{
    DataFile, read_measurement, read_result_with, write_compared_spectra, write_comparison, write_json,
};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::drawn::Figure;
use super::live::compute_scenario;
use super::written::{bytes, text};
use crate::fault::Fault;
use crate::reading::Given;
use crate::site::Site;

/// A scenario and a measured panel.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct CompareOf {
    /// The scenario: TOML.
    scenario: String,
    /// Ids of uploaded files by their names in the scenario.
    #[serde(default)]
    files: BTreeMap<String, String>,
    /// The id of the uploaded measurement.
    panel: String,
}

/// A simulated display compared with a measured panel.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Compared {
    /// The contents of comparison.json.
    comparison: Comparison,
    /// The text of comparison.csv.
    csv: String,
    /// The text of comparison-spectra.csv; empty if no spectrum was measured.
    spectra_csv: String,
    /// Spectra and gamuts of each view.
    figures: Vec<Figure>,
    /// What may be wrong with the measurement.
    warnings: Vec<String>,
}

pub(super) async fn compare(site: Site, request: CompareOf) -> Result<Compared, Fault> {
    let server = site.clone();
    site.quick().work(move |stop| compared(&server, request, stop)).await
}

fn compared(site: &Site, request: CompareOf, stop: &AtomicBool) -> Result<Compared, Fault> {
    let CompareOf { scenario, files, panel } = request;
    let file = site.store().get(&panel).ok_or_else(|| {
        let mut fault = Fault::new(StatusCode::GONE, "the measurement is no longer stored", "send it again");
        fault.body.missing = Some(vec![panel]);
        fault
    })?;
    let panel = read_measurement(file.file())?;
    let answer = compute_scenario(site, &Given { scenario, files }, stop)?;
    // The simulated side is read from result.json, as on the command line.
    let bytes = bytes(|out| write_json(out, &answer.file()))?;
    let result = DataFile { name: "result.json".to_owned(), bytes };
    let simulated = read_result_with(&result, &panel.value.metrics)?.simulated;
    let all = compare_measurement(&simulated, &panel.value).map_err(|error| {
        let hint =
            "the names of states must equal those of the design, and angles must agree to within 1 deg";
        Fault::too_much(error.to_string(), hint)
    })?;
    let warning = "the measured Y is about a hundred times the simulated Y; expected reflectance factors and Y as \
                   fractions of 1, not in per cent";
    Ok(Compared {
        csv: text(|out| write_comparison(out, &all))?,
        spectra_csv: match all.states.iter().any(|one| one.spectrum.is_some()) {
            true => text(|out| write_compared_spectra(out, &all))?,
            false => String::new(),
        },
        figures: figures(&all, answer.title()),
        warnings: all
            .looks_like_percent()
            .then(|| warning.to_owned())
            .into_iter()
            .chain(panel.warnings)
            .collect(),
        comparison: all,
    })
}

fn figures(all: &Comparison, title: &str) -> Vec<Figure> {
    let mut figures = Vec::new();
    for view in &all.views {
        let suffix = match all.views.len() {
            1 => String::new(),
            _ => papilio_display::view_in_name(view.theta_deg, view.phi_deg),
        };
        if let Some(svg) = compared_spectra(all, view, title) {
            figures.push(Figure { name: format!("compared-spectra{suffix}"), svg });
        }
        let svg = compared_gamuts(all, view, title);
        figures.push(Figure { name: format!("compared-gamuts{suffix}"), svg });
    }
    let metrics = compared_metrics(&all.metrics, title);
    figures.extend(metrics.map(|svg| Figure { name: "compared-metrics".to_owned(), svg }));
    figures
}
