//! Curves and maps of arrays, and names of files for them.

use papilio_figures::{Chart, ChartCurve, Hue, SweepAxis, SweepFigure, chart, sweep_map};
use pyo3::prelude::*;

exports! { functions curves, file_names, map; }

/// A curve: its name, its style ("line", "dashed", "points"), x and y.
type Curve = (String, String, Vec<f64>, Vec<f64>);

/// Draws curves over common axes; returns the SVG text.
#[pyfunction]
pub(crate) fn curves(x: String, y: String, logarithmic: bool, curves: Vec<Curve>, title: &str) -> String {
    let drawn = curves.into_iter().enumerate().map(|(group, (name, how, x, y))| ChartCurve {
        name,
        hue: Hue::Group(group),
        dashed: how == "dashed",
        marks: how == "points",
        points: x.into_iter().zip(y).collect(),
    });
    chart(&Chart { x, y, logarithmic, at_least: vec![], curves: drawn.collect() }, title)
}

/// Draws a map of numbers over two axes with text labels; x is the faster index. `None` if there is no number.
#[pyfunction]
pub(crate) fn map(
    metric: String,
    x: (String, Vec<String>),
    y: (String, Vec<String>),
    values: Vec<f64>,
    title: &str,
) -> Option<String> {
    let axis = |(name, values): (String, Vec<String>)| SweepAxis { name, values };
    let values = values.into_iter().map(|value| (value, 0.0)).collect();
    sweep_map(&SweepFigure { metric, x: axis(x), y: Some(axis(y)), colours: None, values }, title)
}

/// Returns the name of a file for each name of a state: `start`, the name without characters of paths, and `end`.
#[pyfunction]
pub(crate) fn file_names(names: Vec<String>, start: &str, end: &str) -> Vec<String> {
    papilio_figures::file_names(names.iter().map(String::as_str), start, end)
}
