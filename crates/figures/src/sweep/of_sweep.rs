//! Figures of a sweep: each metric over the last axis, with a curve for each value of the axis before it, and
//! as a map.

use papilio_formats::{SweepHead, SweepPoint};

use super::axes::{LabelledAxis, Labels, common_views, of_axis, of_views};
use super::{SweepFigure, sweep_curves, sweep_map};
use crate::file_names;

/// Largest number of curves in a figure; more cannot be distinguished.
const MAX_CURVES: usize = 8;

/// Smallest number of values per axis of a map; curves are more informative for fewer.
const MIN_ROWS: usize = 3;

/// Returns the figures of `papilio sweep`: file names without extensions, and SVG texts. With more than two
/// axes, the others are at their first value, which the title states. Several views form an additional first
/// axis. `labels` returns the label of a key or a metric.
pub fn of_sweep(head: &SweepHead, points: &[&SweepPoint], labels: Labels<'_>) -> Vec<(String, String)> {
    let mut drawn = Vec::new();
    let files = file_names(head.figures.iter().map(String::as_str), "sweep_", "");
    for (metric, file) in head.figures.iter().zip(files) {
        let Some((figure, title)) = figure(head, points, metric, labels) else { continue };
        let (curves, columns) = (figure.y.as_ref().map_or(1, |y| y.values.len()), figure.x.values.len());
        let few = curves <= MAX_CURVES;
        if few {
            drawn.push((file.clone(), sweep_curves(&figure, &title)));
        }
        if !few || (curves >= MIN_ROWS && columns >= MIN_ROWS) {
            drawn.extend(sweep_map(&figure, &title).map(|svg| (format!("{file}_map"), svg)));
        }
    }
    drawn
}

/// Returns a metric over the last two axes (several views are the first axis), and the title of its figure;
/// `None` if no value is defined.
fn figure(
    head: &SweepHead,
    points: &[&SweepPoint],
    metric: &str,
    labels: Labels<'_>,
) -> Option<(SweepFigure, String)> {
    let views = common_views(points);
    let mut axes: Vec<LabelledAxis> = of_views(&views).into_iter().collect();
    let over_views = !axes.is_empty();
    axes.extend(head.axes.iter().map(|axis| of_axis(axis, labels)));
    let (x, before) = axes.split_last()?;
    let (y, fixed) = before.split_last().map_or((None, before), |(y, fixed)| (Some(y), fixed));
    let columns = x.axis.values.len();
    let rows = y.map_or(1, |y| y.axis.values.len());
    let value = |(j, i): (usize, usize)| {
        // With one swept axis, the rows are the views; with more, the last axis varies fastest.
        let (view, at) = if over_views && head.axes.len() == 1 { (j, i) } else { (0, j * columns + i) };
        points.get(at).and_then(|point| measured(point, views.get(view).copied(), metric))
    };
    let places = (0..rows).flat_map(|j| (0..columns).map(move |i| (j, i)));
    let values: Vec<(f64, f64)> = places.map(|at| value(at).unwrap_or((f64::NAN, f64::NAN))).collect();
    if values.iter().all(|(value, _)| value.is_nan()) {
        return None;
    }
    let others = fixed.iter().map(|axis| axis.label.with_value(&axis.axis.values[0]));
    let title = head.title.iter().cloned().chain(others).collect::<Vec<_>>().join(", ");
    let figure = SweepFigure {
        metric: labels(metric).to_string(),
        x: x.axis.clone(),
        y: y.map(|y| y.axis.clone()),
        colours: None,
        values,
    };
    Some((figure, title))
}

/// Returns a metric and its error in a view, or in the first view.
fn measured(point: &SweepPoint, view: Option<[&str; 2]>, metric: &str) -> Option<(f64, f64)> {
    let view = view.or_else(|| point.views().first().copied())?;
    let error = |end: &str| point.metric(view, &format!("{metric}{end}")).unwrap_or(0.0);
    point.metric(view, metric).map(|value| (value, error("_se").hypot(error("_de"))))
}
