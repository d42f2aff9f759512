//! Figures of a sweep: each metric over the last axis, a curve for each value of the one before; and as a map.

use papilio_formats::{SweepHead, SweepPoint};

use super::axes::{common_views, of_axis, of_views};
use super::{SweepAxis, SweepFigure, sweep_curves, sweep_map};

/// More curves cannot be told apart.
const MOST_CURVES: usize = 8;

/// A map of fewer values than this each way says less than its curves.
const FEWEST_ROWS: usize = 3;

/// What `papilio sweep` draws: names of files, without their ends, and SVG texts. Of more than two axes, the others are
/// at their first value, and the figure says so. Several views are an axis before all others.
pub fn of_sweep(head: &SweepHead, points: &[&SweepPoint]) -> Vec<(String, String)> {
    let mut drawn = Vec::new();
    for metric in &head.figures {
        let Some((figure, title)) = figure(head, points, metric) else { continue };
        let (curves, columns) = (figure.y.as_ref().map_or(1, |y| y.values.len()), figure.x.values.len());
        let few = curves <= MOST_CURVES;
        if few {
            drawn.push((format!("sweep_{metric}"), sweep_curves(&figure, &title)));
        }
        if !few || (curves >= FEWEST_ROWS && columns >= FEWEST_ROWS) {
            drawn.extend(sweep_map(&figure, &title).map(|svg| (format!("sweep_{metric}_map"), svg)));
        }
    }
    drawn
}

/// A metric over the last two axes (of which the views are the first, if there are several), and what stands above
/// it; `None` where it is nowhere defined.
fn figure(head: &SweepHead, points: &[&SweepPoint], metric: &str) -> Option<(SweepFigure, String)> {
    let views = common_views(points);
    let mut axes: Vec<SweepAxis> = of_views(&views).into_iter().collect();
    let over_views = !axes.is_empty();
    axes.extend(head.axes.iter().map(|axis| of_axis(head, axis)));
    let (x, before) = axes.split_last()?;
    let (y, fixed) = before.split_last().map_or((None, before), |(y, fixed)| (Some(y), fixed));
    let rows = y.map_or(1, |y| y.values.len());
    let value = |(j, i): (usize, usize)| {
        // Of one swept axis, the views are the rows; of more, the last axis is the fastest of all.
        let (view, at) =
            if over_views && head.axes.len() == 1 { (j, i) } else { (0, j * x.values.len() + i) };
        points.get(at).and_then(|point| measured(point, views.get(view).copied(), metric))
    };
    let places = (0..rows).flat_map(|j| (0..x.values.len()).map(move |i| (j, i)));
    let values: Vec<(f64, f64)> = places.map(|at| value(at).unwrap_or((f64::NAN, f64::NAN))).collect();
    if values.iter().all(|(value, _)| value.is_nan()) {
        return None;
    }
    let others = fixed.iter().map(|axis| format!("{} = {}", axis.name, axis.values[0]));
    let title = head.title.iter().cloned().chain(others).collect::<Vec<_>>().join(", ");
    let figure =
        SweepFigure { metric: metric.to_owned(), x: x.clone(), y: y.cloned(), colours: None, values };
    Some((figure, title))
}

/// A metric and its error, in a view or in the first.
fn measured(point: &SweepPoint, view: Option<[&str; 2]>, metric: &str) -> Option<(f64, f64)> {
    let view = view.or_else(|| point.views().first().copied())?;
    let error = |end: &str| point.metric(view, &format!("{metric}{end}")).unwrap_or(0.0);
    point.metric(view, metric).map(|value| (value, error("_se").hypot(error("_de"))))
}
