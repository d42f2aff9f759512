//! The table of a sweep on the terminal.

use papilio_figures::short_key;
use papilio_formats::{SweepHead, SweepPoint, sweep_value};

use crate::report::{self, digits};

/// More lines are not printed.
pub(super) const MOST_LISTED: usize = 40;

/// A line for each point and view: what is swept, and the metrics that are drawn. `points` are the first of so many
/// `in_all`.
pub(super) fn listed(head: &SweepHead, points: &[&SweepPoint], in_all: usize) -> String {
    let views: Vec<Vec<[&str; 2]>> = points.iter().map(|point| point.views()).collect();
    let several = views.iter().any(|views| views.len() > 1);
    let keys = head.axes.iter().flat_map(|axis| &axis.keys).map(|key| short_key(head, key));
    let of_views = if several { &["theta_deg", "phi_deg"][..] } else { &[] };
    let titles = keys.chain(of_views.iter().map(|name| (*name).to_owned()));
    let mut rows: Vec<Vec<String>> = vec![titles.chain(head.figures.iter().cloned()).collect()];
    let lines = points.iter().zip(&views).enumerate();
    let lines = lines.flat_map(|(at, (point, views))| views.iter().map(move |view| (at, point, *view)));
    for (number, point, view) in lines.take(MOST_LISTED) {
        let swept = head.swept(number).map(|(_, value)| sweep_value(value));
        let angles = view.into_iter().filter(|_| several).map(str::to_owned);
        let metrics = head.figures.iter().map(|name| point.metric(view, name).map_or("-".to_owned(), digits));
        rows.push(swept.chain(angles).chain(metrics).collect());
    }
    let of_rest = (in_all - points.len()) * views.first().map_or(1, Vec::len);
    let lines = views.iter().map(Vec::len).sum::<usize>() + of_rest;
    let more = lines.saturating_sub(MOST_LISTED);
    let rest = if more > 0 { format!("  ... and {more} more lines in sweep.csv\n") } else { String::new() };
    report::table(&rows) + &rest
}
