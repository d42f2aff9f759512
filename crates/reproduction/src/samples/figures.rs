//! Figures of a sample: what was predicted, and what was measured.

use papilio_display::compare::{Comparison, StateComparison};
use papilio_figures::{compared_gamuts, compared_metrics, compared_panels, compared_spectra};

use super::{CasePrediction, Prediction};

/// A figure of a sample.
#[derive(Debug, Clone, PartialEq)]
pub struct SampleFigure {
    /// Name of its file, without the ending: `sample-NAME`, with the number of a further figure.
    pub name: String,
    /// The figure.
    pub svg: String,
    /// What it shows.
    pub caption: String,
}

/// Most spectra with bands in one panel.
const OVERLAID: usize = 2;

/// Draws a sample: spectra and colours in one figure if the names of its displays allow it, metrics in another one, a BRDF in
/// a third one.
pub fn figures(sample: &Prediction) -> Vec<SampleFigure> {
    let mut figures: Vec<(String, String)> = Vec::new();
    let title = &sample.title;
    let together = together(sample);
    let (groups, named): (Vec<(&str, &Comparison)>, bool) = match &together {
        Some(all) => (vec![("", all)], false),
        None => (sample.cases.iter().map(|case| (case.name.as_str(), &case.comparison)).collect(), true),
    };
    for (case, all) in groups {
        for view in &all.views {
            let mut words = if named { format!("{title}, {case}") } else { title.clone() };
            let own = |one: &&StateComparison| (one.theta_deg, one.phi_deg) == (view.theta_deg, view.phi_deg);
            if all.views.len() > 1 {
                words = format!("{words}, viewed at {} deg", view.theta_deg);
            }
            let spectra = if all.states.iter().filter(own).count() > OVERLAID {
                compared_panels
            } else {
                compared_spectra
            };
            let gamuts = || all.states.iter().any(|one| own(&one)).then(|| compared_gamuts(all, view, title));
            let svg = spectra(all, view, title).or_else(gamuts);
            figures.extend(svg.map(|svg| (svg, words)));
        }
    }
    let metrics = sample.cases.iter().flat_map(|case| &case.comparison.metrics);
    figures.extend(compared_metrics(metrics, title).map(|svg| (svg, title.clone())));
    for brdf in sample.cases.iter().filter_map(|case| case.brdf.as_ref()) {
        let words = format!("{title}, {}", brdf.state);
        figures.push((brdf.figure(title), words));
    }
    let name = |number: usize| match number {
        0 => format!("sample-{}", sample.name),
        _ => format!("sample-{}-{}", sample.name, number + 1),
    };
    let figure = |(number, (svg, caption))| SampleFigure { name: name(number), svg, caption };
    figures.into_iter().enumerate().map(figure).collect()
}

/// All displays of a sample as one, if no two of them have a state of the same name in the same view.
fn together(sample: &Prediction) -> Option<Comparison> {
    let mut all = Comparison {
        states: Vec::new(),
        views: Vec::new(),
        metrics: Vec::new(),
        agreement: None,
        left_out: Vec::new(),
    };
    for CasePrediction { comparison, .. } in &sample.cases {
        for state in &comparison.states {
            let same = |one: &StateComparison| {
                (&one.state, one.theta_deg, one.phi_deg) == (&state.state, state.theta_deg, state.phi_deg)
            };
            if all.states.iter().any(same) {
                return None;
            }
            all.states.push(state.clone());
        }
        for view in &comparison.views {
            let mut known = all.views.iter();
            if !known.any(|one| (one.theta_deg, one.phi_deg) == (view.theta_deg, view.phi_deg)) {
                all.views.push(view.clone());
            }
        }
    }
    Some(all)
}
