//! `papilio gloss`: what a glossmeter reads of the display.

use std::path::Path;

use papilio_display::gloss::GlossResult;
use papilio_display::metric_label;
use papilio_formats::{write_file, write_gloss};
use papilio_scenario::Resolved;
use serde::Serialize;

use crate::arguments::{SolvedSpatially, Solver};
use crate::numbers::measured;
use crate::spatial::{SpatialOutput, show, with_scenario};
use crate::{Failure, report};

pub(crate) fn gloss(arguments: &SolvedSpatially) -> Result<(), Failure> {
    let SolvedSpatially { spatial: arguments, solver } = arguments;
    let resolved = arguments.resolve(solver.map(Solver::as_override))?;
    show(arguments, &resolved, |control| papilio_display::gloss::gloss(&resolved.scene, control))
}

impl SpatialOutput for GlossResult {
    const JSON: &'static str = "gloss.json";
    const FIGURES: &'static [&'static str] = &[];

    fn content<'a>(&'a self, resolved: &'a Resolved, _: &'a str, notes: &'a [String]) -> impl Serialize + 'a {
        with_scenario(resolved, notes, self)
    }

    fn table(&self, title: &str) -> String {
        let metrics: Vec<&str> = self
            .states
            .iter()
            .next()
            .map(|(_, state)| state.values.named().map(|(name, _)| name).collect())
            .unwrap_or_default();
        let head = metrics
            .iter()
            .map(|name| metric_label(name).map_or((*name).to_owned(), |label| label.to_string()));
        let mut rows = vec![std::iter::once("state".to_owned()).chain(head).collect::<Vec<_>>()];
        for (name, state) in self.states.iter() {
            let both = state.values.named().zip(state.error.named());
            // The haze of weak etches is a fraction of a per cent, and its error is far below the digits of interest.
            let cells = both.map(|((metric, value), (_, error))| match metric {
                "haze_percent" => measured(value, None, 2),
                _ => measured(value, error, 1),
            });
            rows.push(std::iter::once(name.to_owned()).chain(cells).collect());
        }
        format!(
            "{}\n\ngloss in units of polished black glass of index 1.567, in the plane of azimuth {} deg\n{}\n",
            report::plain(title),
            self.phi_deg,
            report::table(&rows)
        )
    }

    fn write_tables(&self, folder: &Path) -> Result<Vec<String>, Failure> {
        write_file(&folder.join("gloss.csv"), |out| write_gloss(out, self))?;
        Ok(vec!["gloss.csv".to_owned()])
    }

    fn figures(&self, _: &str) -> Vec<(String, String)> {
        Vec::new()
    }

    fn warnings(&mut self) -> &mut Vec<String> {
        &mut self.warnings
    }
}
