//! `papilio mtf`: how sharp the display is.

use std::path::Path;

use papilio_display::spatial::{MtfResult, MtfView, PatternKind};
use papilio_figures::file_names;
use papilio_formats::{write_file, write_kernel_npy, write_mtf_csv, write_spread_csv};
use papilio_scenario::Resolved;
use serde::Serialize;

use crate::arguments::{SolvedSpatially, Solver};
use crate::spatial::{SpatialOutput, show, with_scenario};
use crate::{Failure, output, report};

pub(crate) fn mtf(arguments: &SolvedSpatially) -> Result<(), Failure> {
    let SolvedSpatially { spatial: arguments, solver } = arguments;
    let resolved = arguments.resolve(solver.map(Solver::as_override))?;
    show(arguments, &resolved, |control| {
        papilio_display::spatial::mtf(&resolved.scene, &resolved.patterns, control)
    })
}

impl SpatialOutput for MtfResult {
    const JSON: &'static str = "mtf.json";
    const FIGURES: &'static [&'static str] = &["mtf", "edges", "kernel-", "kernel_"];

    fn content<'a>(&'a self, resolved: &'a Resolved, _: &'a str, notes: &'a [String]) -> impl Serialize + 'a {
        with_scenario(resolved, notes, self)
    }

    fn table(&self, title: &str) -> String {
        text(title, self)
    }

    fn write_tables(&self, folder: &Path) -> Result<Vec<String>, Failure> {
        output::remove(folder, |name| name.starts_with("kernel-") && name.ends_with(".npy"))?;
        write_file(&folder.join("mtf.csv"), |out| write_mtf_csv(out, self))?;
        write_file(&folder.join("spread.csv"), |out| write_spread_csv(out, self))?;
        let mut names = ["mtf.csv", "spread.csv"].map(str::to_owned).to_vec();
        let states = self.views.first().map(|view| &view.states);
        let all = states.into_iter().flat_map(|states| states.iter());
        // Below general layers, adding computes frequencies alone.
        let with_places: Vec<&str> =
            all.filter(|(_, state)| state.kernel.cells > 0).map(|(state, _)| state).collect();
        let files = file_names(with_places.iter().copied(), "kernel-", ".npy");
        for (state, name) in with_places.into_iter().zip(files) {
            write_file(&folder.join(&name), |out| write_kernel_npy(out, self, state))?;
            names.push(name);
        }
        Ok(names)
    }

    fn figures(&self, title: &str) -> Vec<(String, String)> {
        papilio_figures::of_mtf(self, title)
    }

    fn notes(&self, resolved: &Resolved) -> Vec<String> {
        resolved.notes_of_places()
    }

    fn warnings(&mut self) -> &mut Vec<String> {
        &mut self.warnings
    }
}

fn text(title: &str, result: &MtfResult) -> String {
    let mut text = format!("{}\n", report::plain(title));
    if let (Some(pitch), Some(nyquist)) = (result.pitch_um, result.nyquist_per_mm) {
        text += &format!(
            "pixels of {:.2} x {:.2} um, Nyquist frequency {:.3} x {:.3} per mm\n",
            pitch[0], pitch[1], nyquist[0], nyquist[1]
        );
    }
    for view in &result.views {
        text += &format!("\nviewed at theta {} deg, phi {} deg\n", view.theta_deg, view.phi_deg);
        text += &report::table(&rows(view));
        text += &lines(view);
        if ["white", "black"].iter().any(|name| view.states.get(name).is_none()) {
            text += "  the contrast of lines and text is that of the states `white` and `black`, which this display does not have \
                     (display.pixel.states, or the names in display.pixel.reflectance)\n";
        }
        text += &text_and_patterns(view);
    }
    text + &format!("error of the modulation transfer: {:.1e}\n", result.error_reached)
}

fn number(value: Option<f64>, decimals: usize) -> String {
    value.map_or("-".to_owned(), |value| format!("{value:.decimals$}"))
}

fn rows(view: &MtfView) -> Vec<Vec<String>> {
    let head = [
        "state",
        "f50 x, y (1/mm)",
        "MTF at Nyquist x, y",
        "edge 10-90 x, y (um)",
        "r50, r90 (um)",
        "SQRI x, y (JND)",
    ];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    for (name, state) in view.states.iter() {
        let s = &state.scalars;
        let pair = |a, b, decimals| format!("{} {}", number(a, decimals), number(b, decimals));
        rows.push(vec![
            name.to_owned(),
            pair(s.f50_x_per_mm, s.f50_y_per_mm, 3),
            pair(s.mtf_nyquist_x, s.mtf_nyquist_y, 3),
            pair(s.edge_10_90_x_um, s.edge_10_90_y_um, 1),
            pair(s.r50_um, s.r90_um, 1),
            pair(s.sqri_jnd_x, s.sqri_jnd_y, 1),
        ]);
    }
    rows
}

/// Contrast of text and means of patterns, as far as there are any.
fn text_and_patterns(view: &MtfView) -> String {
    let mut text = String::new();
    if let (Some(least), Some(median)) = (view.text_contrast_min, view.text_contrast_median) {
        text += &format!("  contrast of text: {least:.3} at least, {median:.3} median\n");
    }
    if let Some(n) = view.yule_nielsen_n {
        text += &format!("  equivalent Yule-Nielsen n of fine patterns: {n:.3}\n");
    }
    if !view.patterns.is_empty() {
        let mut rows =
            vec![["pattern", "period (mm)", "mean Y", "mean Y via pixel"].map(str::to_owned).to_vec()];
        for pattern in &view.patterns {
            let kind = match pattern.kind {
                PatternKind::Stripes => "stripes",
                PatternKind::Checkerboard => "checkerboard",
            };
            rows.push(vec![
                kind.to_owned(),
                pattern.period_mm.to_string(),
                format!("{:.5}", pattern.mean_Y),
                format!("{:.5}", pattern.mean_Y_via_pixel),
            ]);
        }
        text += &format!("\n{}", report::table(&rows));
    }
    text
}

/// Contrast of lines of 1, 2 and 4 pixels; empty without a matrix.
fn lines(view: &MtfView) -> String {
    let values: Vec<Option<f64>> = view.line_contrast.named().map(|(_, value)| value).collect();
    if values.iter().all(Option::is_none) {
        return String::new();
    }
    let mut rows = vec![
        ["contrast in the middle of lines of 1, 2, 4 pixels", "across x", "across y"]
            .map(str::to_owned)
            .to_vec(),
    ];
    for (k, name) in ["white on black", "black on white"].into_iter().enumerate() {
        let of = |first: usize| {
            values[first..first + 3].iter().map(|value| number(*value, 3)).collect::<Vec<_>>().join(" ")
        };
        rows.push(vec![name.to_owned(), of(3 * k), of(6 + 3 * k)]);
    }
    format!("\n{}", report::table(&rows))
}
