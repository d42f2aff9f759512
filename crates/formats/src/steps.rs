//! A display without each processing step of its measured diffuser: `steps.csv`, and `papilio diffuser steps --json`.

use std::io::{self, Write};

use papilio_display::result::{RunResult, View};
use serde::Serialize;

/// The displays, as specified first.
#[derive(Debug, Serialize)]
pub struct StepsFile<'a> {
    /// Title of the scenario.
    pub title: &'a str,
    /// Hash of the scenario.
    pub hash: &'a str,
    /// Notes on the scenario.
    pub notes: &'a [String],
    /// Warnings on the scenario.
    pub warnings: &'a [String],
    /// A row for each display.
    pub displays: Vec<StepRow<'a>>,
}

/// A display in its first view.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[allow(non_snake_case, reason = "as in `states.csv`")]
pub struct StepRow<'a> {
    /// What distinguishes it.
    pub display: &'a str,
    /// Key of `[display.diffuser]` that is changed; `None` for the scenario itself, and for a reference.
    pub key: Option<&'a str>,
    /// Y of the state `white`, or of the first.
    pub Y: Option<f64>,
    /// Standard error of Y.
    pub Y_se: Option<f64>,
    /// Discretisation error of Y, of adding.
    pub Y_de: Option<f64>,
    /// Change of Y relative to that of the scenario itself.
    pub change: Option<f64>,
    /// Contrast.
    pub contrast_ratio: Option<f64>,
    /// Area of the gamut in u'v', per cent of that of sRGB.
    pub gamut_percent_srgb: Option<f64>,
}

impl<'a> StepRow<'a> {
    /// The rows of displays: of each, what distinguishes it, the key and the result.
    pub fn all(displays: impl IntoIterator<Item = (&'a str, Option<&'a str>, &'a RunResult)>) -> Vec<Self> {
        let mut first = None;
        let mut rows = Vec::new();
        for (display, key, result) in displays {
            let Some(view) = result.views.first() else { continue };
            let state = white(view);
            let y = state.map(|state| state.value.Y);
            let of_all = *first.get_or_insert(y);
            let change = y.zip(of_all).map(|(y, first)| y / first - 1.0);
            rows.push(Self {
                display,
                key,
                Y: y,
                Y_se: state.map(|state| state.standard_error.Y),
                Y_de: state.and_then(|state| Some(state.discretisation_error.as_ref()?.Y)),
                change: change.filter(|change| change.is_finite()),
                contrast_ratio: view.metrics.contrast_ratio,
                gamut_percent_srgb: view.metrics.gamut_percent_srgb,
            });
        }
        rows
    }
}

fn white(view: &View) -> Option<&papilio_display::result::State> {
    view.states.get("white").or_else(|| view.states.iter().next().map(|(_, state)| state))
}

/// Writes `steps.csv`: a row for each display. Cells of undefined values are empty.
///
/// # Errors
/// Those of `out`.
pub fn write_steps(out: impl Write, rows: &[StepRow<'_>]) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(out);
    csv.write_record([
        "display",
        "key",
        "Y",
        "Y_se",
        "Y_de",
        "change",
        "contrast_ratio",
        "gamut_percent_srgb",
    ])?;
    for row in rows {
        let numbers = [row.Y, row.Y_se, row.Y_de, row.change, row.contrast_ratio, row.gamut_percent_srgb];
        let numbers = numbers.map(|value| value.map_or(String::new(), |value| value.to_string()));
        let words = [row.display, row.key.unwrap_or_default()].map(str::to_owned);
        csv.write_record(words.iter().chain(&numbers))?;
    }
    csv.flush()
}
