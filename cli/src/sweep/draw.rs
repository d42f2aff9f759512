//! Figures of a sweep: each metric over the last axis, a curve for each value of the one before; and as a map.

use std::path::Path;

use papilio_figures::{SweepAxis, SweepFigure, sweep_curves, sweep_map};
use papilio_formats::{SweepHead, SweepHeadAxis, SweepPoint, sweep_value, write_file};

use crate::{Failure, output};

/// More curves cannot be told apart.
const MOST_CURVES: usize = 8;

/// A map of fewer values than this each way says less than its curves.
const FEWEST_ROWS: usize = 3;

/// Writes the figures of a finished sweep, and returns their names. Of more than two axes, the others are at their
/// first value, and the figure says so.
pub(super) fn figures(
    folder: &Path,
    head: &SweepHead,
    points: &[&SweepPoint],
    png: bool,
) -> Result<Vec<String>, Failure> {
    let mut names = Vec::new();
    for metric in &head.figures {
        let Some((figure, title)) = figure(head, points, metric) else { continue };
        let (curves, columns) = (figure.y.as_ref().map_or(1, |y| y.values.len()), figure.x.values.len());
        let mut drawn = Vec::new();
        if curves <= MOST_CURVES {
            drawn.push((format!("sweep_{metric}"), sweep_curves(&figure, &title)));
        }
        if curves >= FEWEST_ROWS && columns >= FEWEST_ROWS {
            drawn.extend(sweep_map(&figure, &title).map(|svg| (format!("sweep_{metric}_map"), svg)));
        }
        for (name, svg) in drawn {
            if png {
                names.extend(output::write_figure(folder, &name, &svg)?);
            } else {
                let name = format!("{name}.svg");
                write_file(&folder.join(&name), |out| out.write_all(svg.as_bytes()))?;
                names.push(name);
            }
        }
    }
    Ok(names)
}

/// A metric over the last two axes, and what stands above it; `None` where it is nowhere defined.
fn figure(head: &SweepHead, points: &[&SweepPoint], metric: &str) -> Option<(SweepFigure, String)> {
    let (x, before) = head.axes.split_last()?;
    let y = before.last();
    let drawn = x.values.len() * y.map_or(1, |y| y.values.len());
    let error = |point: &SweepPoint| {
        let errors = ["_se", "_de"].map(|end| point.metric(&format!("{metric}{end}")).unwrap_or(0.0));
        errors[0].hypot(errors[1])
    };
    let values: Vec<(f64, f64)> = points
        .iter()
        .take(drawn)
        .map(|point| point.metric(metric).map_or((f64::NAN, f64::NAN), |value| (value, error(point))))
        .collect();
    if values.iter().all(|(value, _)| value.is_nan()) {
        return None;
    }
    let fixed = before.len().saturating_sub(1);
    let others: Vec<String> =
        head.axes[..fixed].iter().map(|axis| format!("{} = {}", name(head, axis), text(axis, 0))).collect();
    let title = head.title.iter().cloned().chain(others).collect::<Vec<_>>().join(", ");
    let axis = |axis: &SweepHeadAxis| SweepAxis {
        name: name(head, axis),
        values: (0..axis.values.len()).map(|at| text(axis, at)).collect(),
    };
    let figure = SweepFigure { metric: metric.to_owned(), x: axis(x), y: y.map(axis), values };
    Some((figure, title))
}

/// An axis goes by its first key; the others follow it.
fn name(head: &SweepHead, axis: &SweepHeadAxis) -> String {
    axis.keys.first().map(|key| short(head, key)).unwrap_or_default()
}

fn text(axis: &SweepHeadAxis, at: usize) -> String {
    axis.values.get(at).and_then(|values| values.first()).map(sweep_value).unwrap_or_default()
}

/// The end of a path that no other swept path ends in: `haze` for `display.diffuser.haze`.
pub(super) fn short(head: &SweepHead, key: &str) -> String {
    let all = || head.axes.iter().flat_map(|axis| &axis.keys).filter(|other| *other != key);
    let starts = key.match_indices('.').map(|(at, _)| at + 1).rev().chain([0]);
    let is_clear = |end: &&str| {
        !end.starts_with(|c: char| c.is_ascii_digit()) && all().all(|other| !other.ends_with(*end))
    };
    starts.map(|start| &key[start..]).find(is_clear).unwrap_or(key).to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_as_short_as_is_clear() {
        let axis = |key: &str| SweepHeadAxis { keys: vec![key.to_owned()], values: vec![] };
        let keys = ["display.diffuser.haze", "viewer.theta_deg", "lighting.directed.0.theta_deg"];
        let head = SweepHead {
            papilio: String::new(),
            title: None,
            axes: keys.iter().map(|key| axis(key)).collect(),
            figures: vec![],
        };
        let short = keys.map(|key| super::short(&head, key));
        assert_eq!(short, ["haze", "viewer.theta_deg", "directed.0.theta_deg"]);
    }
}
