//! Table of a sweep on the terminal.

use papilio_formats::{SweepHead, SweepPoint, sweep_value};
use papilio_scenario::label;

use crate::numbers::digits_with_error;
use crate::report;

/// Most rows that are printed.
pub(super) const MOST_ROWS: usize = 40;

/// A row for each point and view: the swept values and the metrics of the figures. `points` are the first of
/// `total` points.
pub(super) fn sweep_table(head: &SweepHead, points: &[&SweepPoint], total: usize) -> String {
    let views: Vec<Vec<[&str; 2]>> = points.iter().map(|point| point.views()).collect();
    let several = views.iter().any(|views| views.len() > 1);
    let keys = head.axes.iter().flat_map(|axis| &axis.keys).map(String::as_str);
    let of_views = if several { &["theta_deg", "phi_deg"][..] } else { &[] };
    let names = keys.chain(of_views.iter().copied()).chain(head.figures.iter().map(String::as_str));
    let mut rows = report::headings(&names.map(|name| label(name).to_string()).collect::<Vec<_>>());
    let lines = points.iter().zip(&views).enumerate();
    let lines =
        lines.flat_map(|(number, (point, views))| views.iter().map(move |view| (number, point, *view)));
    for (number, point, view) in lines.take(MOST_ROWS) {
        let swept = head.swept(number).map(|(_, value)| sweep_value(value));
        let angles = view.into_iter().filter(|_| several).map(str::to_owned);
        let error =
            |name: &str| ["_de", "_se"].iter().find_map(|end| point.metric(view, &format!("{name}{end}")));
        let number = |name: &String| match point.metric(view, name) {
            Some(value) => digits_with_error(value, error(name)),
            None => "-".to_owned(),
        };
        let metrics = head.figures.iter().map(number);
        rows.push(swept.chain(angles).chain(metrics).collect());
    }
    let other_lines = (total - points.len()) * views.first().map_or(1, Vec::len);
    let lines = views.iter().map(Vec::len).sum::<usize>() + other_lines;
    let more = lines.saturating_sub(MOST_ROWS);
    let rest = if more > 0 { format!("  ... and {more} more rows in sweep.csv\n") } else { String::new() };
    report::table(&rows) + &rest
}
