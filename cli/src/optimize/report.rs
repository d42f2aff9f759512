//! Report of a search, on the terminal and as JSON.

use papilio_design::output::{SearchReport, is_at_end};
use papilio_design::search::{FEASIBLE, Search, SearchResult, SelectedDesign};
use papilio_diagnostics::number;
use papilio_formats::sweep_value;
use papilio_scenario::{SearchAim, SearchRange, label, variable_label};
use serde_json::{Value, json};

use super::check::SolverComparison;
use crate::numbers::digits;
use crate::report::{headings, plain, table};

/// Report on the terminal: the best design, or the Pareto front.
pub(super) fn text(title: &str, search: &Search, chosen: &[SelectedDesign]) -> String {
    let body = match chosen {
        [best] => best_design(search, best),
        several => front(search, several),
    };
    format!("{}\n{body}", plain(title))
}

/// The best design next to that of the scenario.
fn best_design(search: &Search, best: &SelectedDesign) -> String {
    let (own, own_values) = search.own();
    let mut rows =
        vec![["variable or metric", "scenario", "result", "range or aim"].map(str::to_owned).to_vec()];
    for (index, variable) in search.spec().variables.iter().enumerate() {
        let range = match &variable.range {
            SearchRange::Bounds(from, to) => {
                format!("{from} to {to}{}", end(search, index, best.design[index]))
            }
            SearchRange::Choices(choices) => format!("one of {}", choices.len()),
        };
        let own = variable.own.map_or("-".to_owned(), |_| value(search, index, own[index]));
        rows.push(vec![
            variable_label(&variable.name).to_string(),
            own,
            value(search, index, best.design[index]),
            range,
        ]);
    }
    for (index, quantity) in search.study().quantities.iter().enumerate() {
        let cells = [own_values[index], best.values[index]].map(|value| value.map_or("-".to_owned(), digits));
        let [own, result] = cells;
        let name = label(&quantity.name).to_string();
        rows.push(vec![name, own, result, aims(search, &quantity.name, best.values[index])]);
    }
    table(&rows)
}

/// Words for a variable at an end of its range.
fn end(search: &Search, index: usize, x: f64) -> &'static str {
    if is_at_end(search, index, x) { " (at its end)" } else { "" }
}

/// Aims and constraints of a quantity in words, and whether the result violates a constraint.
fn aims(search: &Search, name: &str, found: Option<f64>) -> String {
    let objectives =
        search.spec().objectives.iter().filter(|one| one.parts.iter().any(|(_, part)| part.name == name));
    let objectives = objectives.map(|one| match one.aim {
        SearchAim::Maximise => "maximise".to_owned(),
        SearchAim::Minimise => "minimise".to_owned(),
        SearchAim::Target(target) => format!("near {}", number(target)),
    });
    let constraints = search.spec().constraints.iter().filter(|one| one.quantity.name == name);
    let constraints = constraints.flat_map(|one| {
        let verdict = |violation: f64, limit: f64| {
            // The precision with which designs are written.
            if violation <= 100.0 * FEASIBLE * limit.abs() { "" } else { ": violated" }
        };
        let least = one.at_least.map(|least| {
            format!(
                "at least {}{}",
                number(least),
                verdict(found.map_or(f64::INFINITY, |found| least - found), least)
            )
        });
        let most = one.at_most.map(|most| {
            format!(
                "at most {}{}",
                number(most),
                verdict(found.map_or(f64::INFINITY, |found| found - most), most)
            )
        });
        least.into_iter().chain(most)
    });
    objectives.chain(constraints).collect::<Vec<_>>().join(", ")
}

/// A row for each design of the Pareto front.
fn front(search: &Search, chosen: &[SelectedDesign]) -> String {
    let quantities = search.study().quantities.iter().map(|one| label(&one.name).to_string());
    let variables = search.spec().variables.iter().map(|one| variable_label(&one.name).to_string());
    let titles: Vec<String> = ["design".to_owned()].into_iter().chain(quantities).chain(variables).collect();
    let mut rows = headings(&titles);
    let (own, own_values) = search.own();
    let row = |name: String, values: &[Option<f64>], design: Vec<String>| {
        let values = values.iter().map(|value| value.map_or("-".to_owned(), digits));
        [name].into_iter().chain(values).chain(design).collect::<Vec<String>>()
    };
    let own = own.iter().enumerate().map(|(index, x)| value(search, index, *x));
    rows.push(row("scenario".to_owned(), own_values, own.collect()));
    rows.extend(chosen.iter().enumerate().map(|(number, one)| {
        let design = one.design.iter().enumerate();
        let design = design.map(|(index, x)| value(search, index, *x) + end(search, index, *x));
        row((number + 1).to_string(), &one.values, design.collect())
    }));
    table(&rows)
}

/// Value of a variable: a number, or the choice with this index.
fn value(search: &Search, index: usize, x: f64) -> String {
    match &search.spec().variables[index].range {
        SearchRange::Bounds(..) => digits(x),
        SearchRange::Choices(choices) => choices.get(x as usize).map_or_else(|| "-".to_owned(), sweep_value),
    }
}

/// The designs by both solvers; empty if nothing was compared.
pub(super) fn comparison(designs: &str, comparison: &[SolverComparison]) -> String {
    let Some(first) = comparison.first() else { return String::new() };
    let several = comparison.iter().any(|one| one.design != first.design);
    let mut titles =
        vec![if several { "metric" } else { "best design" }, "adding", "Monte Carlo", "standard error"];
    if several {
        titles.insert(0, "design");
    }
    let titles = titles.into_iter().map(str::to_owned).collect();
    let row = |one: &SolverComparison| {
        let number = several.then(|| one.design.to_string());
        number.into_iter().chain(one.row()).collect()
    };
    let rows: Vec<Vec<String>> = std::iter::once(titles).chain(comparison.iter().map(row)).collect();
    format!("\n{designs} by both solvers\n{}", table(&rows))
}

/// The result as JSON.
pub(super) fn json(
    title: &str,
    search: &Search,
    chosen: &[SelectedDesign],
    found: &[SearchResult],
    comparison: &[SolverComparison],
) -> Value {
    let mut all = json!(SearchReport::new(title, search, found, chosen));
    all["checked_by_walk"] = comparison.iter().map(SolverComparison::json).collect();
    all
}

/// Total number of evaluated designs.
pub(super) fn evaluations(found: &[SearchResult]) -> usize {
    found.iter().map(|one| one.evaluations).sum()
}
