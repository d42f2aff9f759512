//! Tables and figures of a finished tolerance analysis.

use std::io;

use crate::tolerance::{Estimate, MetricReport, PERCENTILES, Production, Report};
use papilio_display::{Label, uncapitalised};
use papilio_figures::{Ends, SensitivityBar, file_names, histogram, pass_fail_scatter, sensitivities};
use papilio_formats::{sweep_value, words, write_json, write_table};
use papilio_scenario::{ScatteredKey, Tolerance, label, variable_label};

/// Returns names and contents of the files: one table of all displays, one of all metrics, and the full
/// report as JSON.
///
/// # Errors
/// If a number cannot be written; no such number is known.
pub fn tolerance_tables(
    tolerance: &Tolerance,
    production: &Production,
    rows: &[&[f64]],
    report: &Report,
) -> io::Result<[(&'static str, Vec<u8>); 3]> {
    let [mut displays, mut metrics, mut whole] = [Vec::new(), Vec::new(), Vec::new()];
    let (columns, lines) = samples(tolerance, production, rows);
    write_table(&mut displays, &columns, lines)?;
    let (columns, lines) = summary(report);
    write_table(&mut metrics, &columns, lines)?;
    write_json(&mut whole, report)?;
    Ok([("tolerance.csv", displays), ("tolerance-metrics.csv", metrics), ("tolerance.json", whole)])
}

/// Cell of a number; empty if it is not finite.
fn cell(value: f64) -> String {
    if value.is_finite() { value.to_string() } else { String::new() }
}

/// Columns and rows of all displays: keys, metrics, and whether the display meets all limits.
fn samples<'a>(
    tolerance: &'a Tolerance,
    production: &'a Production,
    rows: &'a [&[f64]],
) -> (Vec<String>, impl Iterator<Item = Vec<String>> + 'a) {
    let keys = tolerance.keys.iter().map(|key| key.name.clone());
    let metrics = tolerance.metrics.iter().map(|metric| metric.name.clone());
    let columns = ["sample".to_owned()].into_iter().chain(keys).chain(metrics).chain(["good".to_owned()]);
    let row = |(number, row): (usize, &&[f64])| {
        let keys = production.values(number);
        let keys = keys.iter().map(|value| words::text_cell(sweep_value(value)));
        let metrics = row.iter().take(tolerance.metrics.len()).map(|value| cell(*value));
        let good = u8::from(is_good(tolerance, row)).to_string();
        [number.to_string()].into_iter().chain(keys).chain(metrics).chain([good]).collect()
    };
    (columns.collect(), rows.iter().enumerate().map(row))
}

/// Returns true if a display meets all limits.
fn is_good(tolerance: &Tolerance, row: &[f64]) -> bool {
    tolerance.limits.iter().all(|limit| ends(limit.at_least, limit.at_most).meets(row[limit.metric]))
}

fn ends(at_least: Option<f64>, at_most: Option<f64>) -> Ends {
    Ends { at_least, at_most }
}

/// Columns and rows of all metrics: spread and sensitivities, each number followed by its standard error.
fn summary(report: &Report) -> (Vec<String>, impl Iterator<Item = Vec<String>> + '_) {
    let with_error = |name: String| [name.clone(), format!("{name}_se")];
    let percentiles = PERCENTILES.iter().map(|percent| format!("p{percent}"));
    let spread = ["mean", "deviation"].map(str::to_owned).into_iter().chain(percentiles);
    let indices = report.groups.iter().flat_map(|group| {
        let group = group.join(" + ");
        [format!("first-order {group}"), format!("total {group}")]
    });
    let columns = ["metric", "undefined", "least", "largest"].map(str::to_owned).into_iter();
    let columns = columns.chain(spread.chain(indices).flat_map(with_error)).collect();
    (columns, report.metrics.iter().map(summary_of))
}

fn summary_of(metric: &MetricReport) -> Vec<String> {
    let mut cells = vec![metric.name.clone()];
    let pair = |one: Option<Estimate>| {
        one.map_or([String::new(), String::new()], |one| [cell(one.value), cell(one.standard_error)])
    };
    match &metric.spread {
        Some(spread) => {
            cells.push(spread.undefined.to_string());
            cells.extend(spread.range.map(cell));
            let all = [spread.mean, spread.deviation].into_iter().chain(spread.percentiles);
            cells.extend(all.flat_map(|one| pair(Some(one))));
        }
        None => cells.extend(vec![String::new(); 3 + 2 * (2 + PERCENTILES.len())]),
    }
    for indices in &metric.indices {
        cells.extend(pair(indices.map(|one| one.first)));
        cells.extend(pair(indices.map(|one| one.total)));
    }
    cells
}

/// Returns file names without extension and SVG texts: histograms, sensitivities, and displays that pass or
/// fail.
pub fn tolerance_figures(
    title: &str,
    tolerance: &Tolerance,
    production: &Production,
    rows: &[&[f64]],
    report: &Report,
) -> Vec<(String, String)> {
    let mut drawn = Vec::new();
    // Names of metrics state the view after a comma.
    let names: Vec<String> = tolerance.metrics.iter().map(|metric| metric.name.replace(", ", "_")).collect();
    let files = file_names(names.iter().map(String::as_str), "tolerance_", "");
    for (column, (metric, file)) in tolerance.metrics.iter().zip(files).enumerate() {
        let values: Vec<f64> = rows.iter().map(|row| row[column]).collect();
        let limit = tolerance.limits.iter().find(|limit| limit.metric == column);
        let ends = limit.map_or(Ends::default(), |limit| ends(limit.at_least, limit.at_most));
        let svg = histogram(&label(&metric.name).to_string(), &values, ends, title);
        drawn.extend(svg.map(|svg| (file, svg)));
    }
    let metrics: Vec<String> = report.metrics.iter().map(|metric| label(&metric.name).to_string()).collect();
    let quantity = |name: &String| variable_label(name).quantity;
    let groups: Vec<String> = report
        .groups
        .iter()
        .map(|group| group.iter().map(quantity).collect::<Vec<_>>().join(" + "))
        .collect();
    let bar = |one: &crate::tolerance::Indices| SensitivityBar {
        first: [one.first.value, one.first.standard_error],
        total: [one.total.value, one.total.standard_error],
    };
    let groups_of_bars: Vec<Vec<Option<SensitivityBar>>> = report
        .metrics
        .iter()
        .map(|metric| metric.indices.iter().map(|one| one.as_ref().map(bar)).collect())
        .collect();
    let bars = sensitivities(&metrics, &groups, &groups_of_bars, title);
    drawn.extend(bars.map(|svg| ("tolerance_sensitivities".to_owned(), svg)));
    if let Some([x, y]) = most_important(tolerance, production, report) {
        let number = |row: usize, key: usize| production.values(row)[key].as_f64().unwrap_or(f64::NAN);
        let points = rows.iter().enumerate();
        let points: Vec<([f64; 2], bool)> = points
            .map(|(row, values)| ([number(row, x), number(row, y)], is_good(tolerance, values)))
            .collect();
        let [x, y] = [x, y].map(|key| tolerance_axis(&tolerance.keys[key]));
        drawn.push(("tolerance_keys".to_owned(), pass_fail_scatter([&x, &y], &points, title)));
    }
    drawn
}

/// Label of the values of a key, with their unit. If it has several paths, they are those of the first one.
pub fn tolerance_axis(key: &ScatteredKey) -> String {
    let path = key.paths.first().map_or("", |(path, ..)| path.as_str());
    let own = label(path);
    let quantity = match key.paths.len() {
        _ if key.name == path => own.quantity,
        2.. => format!("{}: {}", variable_label(&key.name).quantity, uncapitalised(&own.quantity)),
        _ => variable_label(&key.name).quantity,
    };
    Label::new(quantity, own.unit).to_string()
}

/// Indices of the two numeric keys with the largest total indices for the metric whose limit fails most
/// often.
fn most_important(tolerance: &Tolerance, production: &Production, report: &Report) -> Option<[usize; 2]> {
    let failing = report.verdict.failing.iter().map(|failing| failing.share.value);
    let limit = failing.enumerate().max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0)))?.0;
    let metric = report.metrics.get(tolerance.limits[limit].metric)?;
    let mut keys: Vec<(usize, f64)> = Vec::new();
    for (group, indices) in production.plan().groups().iter().zip(&metric.indices) {
        let total = indices.map_or(0.0, |one| one.total.value);
        let numbers = group.iter().filter(|key| tolerance.keys[**key].choices.is_empty());
        keys.extend(numbers.map(|key| (*key, total)));
    }
    keys.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    match keys[..] {
        [(x, _), (y, _), ..] => Some([x, y]),
        _ => None,
    }
}
