//! Report of a tolerance analysis on the terminal.

use papilio_design::output::tolerance_axis;
use papilio_design::tolerance::{Estimate, Indices, MetricReport, PERCENTILES, Production, Report};
use papilio_formats::sweep_value;
use papilio_scenario::{ScatteredKey, label, variable_label};

use crate::numbers::has_errors;
use crate::{numbers, report};

/// Most rows of the table of the worst displays.
const MOST_WORST: usize = 5;

/// Yield, distributions, sensitivities and worst displays.
pub(super) fn tolerance_report(
    title: &str,
    production: &Production,
    keys: &[ScatteredKey],
    found: &Report,
) -> String {
    let mut text = format!("{title}\n{} displays", found.samples);
    if found.sensitivity_samples > 0 {
        text.push_str(&format!(", and {} more for sensitivities", production.displays() - found.samples));
    }
    text.push('\n');
    if !found.limits.is_empty() {
        text.push_str(&format!("\nyield {}{}\n\n", percent(found.verdict.yield_share), rule_of_three(found)));
        text.push_str(&report::table(&limits(found)));
    }
    text.push('\n');
    text.push_str(&report::table(&spreads(found)));
    if found.sensitivity_samples > 0 {
        let sensitivities = report::table(&sensitivities(found));
        text.push_str("\nfraction of the variance, %: first-order index / total-order index of each key");
        if has_errors(&sensitivities) {
            text.push_str("; 12.3(4) means 12.3 with a standard error of 0.4");
        }
        text.push('\n');
        text.push_str(&sensitivities);
        text.push_str(&constant(found));
    }
    if !found.worst.is_empty() {
        text.push_str(
            "\ndisplays with the largest violation of a limit, in standard deviations of the metric\n",
        );
        text.push_str(&report::table(&worst(keys, found)));
    }
    text
}

/// Upper limit of the fraction of bad (or good) displays if the samples contain none: the rule of three.
fn rule_of_three(found: &Report) -> String {
    let (fraction, samples) = (found.verdict.yield_share.value, found.samples);
    let kind = if fraction >= 1.0 {
        "bad"
    } else if fraction <= 0.0 {
        "good"
    } else {
        return String::new();
    };
    format!(
        ": none of {samples} samples is {kind}, so fewer than {:.2} % of all displays are (95 % confidence)",
        300.0 / samples as f64
    )
}

/// A fraction in % with its standard error.
fn percent(fraction: Estimate) -> String {
    format!("{:.2} +- {:.2} %", 100.0 * fraction.value, 100.0 * fraction.standard_error)
}

fn row(cells: &[&str]) -> Vec<String> {
    cells.iter().map(|cell| (*cell).to_owned()).collect()
}

fn limits(found: &Report) -> Vec<Vec<String>> {
    let mut rows = vec![row(&["limit", "at least", "at most", "fails", "fails alone"])];
    for (limit, failing) in found.limits.iter().zip(&found.verdict.failing) {
        let end = |end: Option<f64>| end.map_or("-".to_owned(), |end| end.to_string());
        let cells = [label(&limit.metric).to_string(), end(limit.at_least), end(limit.at_most)];
        rows.push(cells.into_iter().chain([percent(failing.share), percent(failing.alone)]).collect());
    }
    rows
}

fn spreads(found: &Report) -> Vec<Vec<String>> {
    let titles = ["metric", "mean", "std. dev."].map(str::to_owned).into_iter();
    let mut rows = vec![titles.chain(PERCENTILES.map(|percent| format!("{percent} %"))).collect::<Vec<_>>()];
    let undefined = |metric: &MetricReport| metric.spread.as_ref().map_or(found.samples, |one| one.undefined);
    let some = found.metrics.iter().any(|metric| undefined(metric) > 0);
    rows[0].extend(some.then(|| "undefined".to_owned()));
    for metric in &found.metrics {
        let mut cells = vec![label(&metric.name).to_string()];
        match &metric.spread {
            Some(spread) => {
                // Enough decimals to show a tenth of the standard deviation.
                let decimals = (1.0 - spread.deviation.value.log10().floor()).clamp(0.0, 8.0) as usize;
                let all = [spread.mean, spread.deviation].into_iter().chain(spread.percentiles);
                cells.extend(all.map(|one| numbers::unsigned_zero(format!("{:.decimals$}", one.value))));
            }
            None => cells.extend(vec!["-".to_owned(); 2 + PERCENTILES.len()]),
        }
        cells.extend(some.then(|| undefined(metric).to_string()));
        rows.push(cells);
    }
    rows
}

fn sensitivities(found: &Report) -> Vec<Vec<String>> {
    let quantity = |name: &String| variable_label(name).quantity;
    let groups = found.groups.iter().map(|group| group.iter().map(quantity).collect::<Vec<_>>().join(" + "));
    let titles: Vec<String> = ["metric".to_owned()].into_iter().chain(groups).collect();
    let mut rows = report::headings(&titles);
    for metric in &found.metrics {
        let of = |one: &Indices| {
            let [first, total] = rounded_indices(one);
            format!("{first} / {total}")
        };
        let cells = metric.indices.iter().map(|one| one.as_ref().map_or("-".to_owned(), of));
        rows.push([label(&metric.name).to_string()].into_iter().chain(cells).collect());
    }
    rows
}

/// A line with the metrics that do not vary and have no indices; empty if there is none.
fn constant(found: &Report) -> String {
    let is_constant = |one: &&MetricReport| one.spread.as_ref().is_some_and(|spread| !spread.varies());
    let names: Vec<String> =
        found.metrics.iter().filter(is_constant).map(|one| label(&one.name).to_string()).collect();
    match names.len() {
        0 => String::new(),
        1 => format!("does not vary, so no key has a part in it: {}\n", names[0]),
        _ => format!("do not vary, so no key has a part in them: {}\n", names.join(", ")),
    }
}

/// Both indices in %, each with its standard error in units of the last digit. They have the same number of
/// decimals, so that rounding does not make the first-order index larger than the total-order index.
fn rounded_indices(one: &Indices) -> [String; 2] {
    let errors = [one.first, one.total].map(|one| 100.0 * one.standard_error);
    let decimals = usize::from(errors[0].max(errors[1]) < 5.0);
    [one.first, one.total].map(|one| {
        let units = 10_f64.powi(decimals as i32);
        let last = (100.0 * one.standard_error * units).ceil();
        numbers::unsigned_zero(format!("{:.decimals$}({last})", 100.0 * one.value))
    })
}

fn worst(keys: &[ScatteredKey], found: &Report) -> Vec<Vec<String>> {
    let names = keys.iter().map(tolerance_axis);
    let titles = ["sample", "violates", "by"].map(str::to_owned).into_iter();
    let mut rows = report::headings(&titles.chain(names).collect::<Vec<_>>());
    for one in found.worst.iter().take(MOST_WORST) {
        let by = one.missed_by_sigma.map_or("undefined".to_owned(), |by| format!("{by:.1}"));
        let limit =
            found.limits.get(one.limit).map_or(String::new(), |limit| label(&limit.metric).to_string());
        let keys = one.keys.iter().map(|value| match value.as_f64() {
            Some(number) => format!("{number:.5}").trim_end_matches('0').trim_end_matches('.').to_owned(),
            None => sweep_value(value),
        });
        rows.push([one.row.to_string(), limit, by].into_iter().chain(keys).collect());
    }
    rows
}
