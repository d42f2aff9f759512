//! What a search came to, on the terminal, as JSON and as a table in a file.

use papilio_design::search::{Chosen, FEASIBLE, Found, Search};
use papilio_formats::sweep_value;
use papilio_scenario::{SearchAim, SearchRange};
use serde_json::{Map, Value, json};

use super::check::Checked;
use crate::report::{digits, plain, table};

/// The terminal's text: the best design, or the front.
pub(super) fn text(title: &str, search: &Search, chosen: &[Chosen]) -> String {
    let body = match chosen {
        [best] => one(search, best),
        several => front(search, several),
    };
    format!("{}\n{body}", plain(title))
}

/// A design beside the scenario's own.
fn one(search: &Search, best: &Chosen) -> String {
    let (own, own_values) = search.own();
    let mut rows = vec![["", "scenario", "found", ""].map(str::to_owned).to_vec()];
    for (at, variable) in search.said().variables.iter().enumerate() {
        let range = match &variable.range {
            SearchRange::Bounds(from, to) => format!("{from} to {to}"),
            SearchRange::Choices(choices) => format!("one of {}", choices.len()),
        };
        let own = variable.own.map_or("-".to_owned(), |_| value(search, at, own[at]));
        rows.push(vec![short(&variable.name), own, value(search, at, best.design[at]), range]);
    }
    for (at, asked) in search.study().quantities.iter().enumerate() {
        let cells = [own_values[at], best.values[at]].map(|value| value.map_or("-".to_owned(), digits));
        let [own, found] = cells;
        rows.push(vec![asked.name.clone(), own, found, wanted(search, &asked.name, best.values[at])]);
    }
    table(&rows)
}

/// What is wanted of a quantity, in words, and whether what was found misses it.
fn wanted(search: &Search, name: &str, found: Option<f64>) -> String {
    let aims =
        search.said().objectives.iter().filter(|one| one.parts.iter().any(|(_, part)| part.name == name));
    let aims = aims.map(|one| match one.aim {
        SearchAim::Maximise => "maximise".to_owned(),
        SearchAim::Minimise => "minimise".to_owned(),
        SearchAim::Target(target) => format!("near {target}"),
    });
    let limits = search.said().constraints.iter().filter(|one| one.quantity.name == name);
    let limits = limits.flat_map(|one| {
        let verdict = |short: f64, limit: f64| {
            // As exactly as designs are handed on.
            if short <= 100.0 * FEASIBLE * limit.abs() { "" } else { ": missed" }
        };
        let least = one.at_least.map(|least| {
            format!("at least {least}{}", verdict(found.map_or(f64::INFINITY, |found| least - found), least))
        });
        let most = one.at_most.map(|most| {
            format!("at most {most}{}", verdict(found.map_or(f64::INFINITY, |found| found - most), most))
        });
        least.into_iter().chain(most)
    });
    aims.chain(limits).collect::<Vec<_>>().join(", ")
}

/// A line for each design of the front.
fn front(search: &Search, chosen: &[Chosen]) -> String {
    let quantities = search.study().quantities.iter().map(|one| one.name.clone());
    let variables = search.said().variables.iter().map(|one| short(&one.name));
    let mut rows: Vec<Vec<String>> =
        vec![["".to_owned()].into_iter().chain(quantities).chain(variables).collect()];
    let (own, own_values) = search.own();
    let row = |name: String, values: &[Option<f64>], design: &[f64]| {
        let values = values.iter().map(|value| value.map_or("-".to_owned(), digits));
        let design = design.iter().enumerate().map(|(at, x)| value(search, at, *x));
        [name].into_iter().chain(values).chain(design).collect::<Vec<String>>()
    };
    rows.push(row("scenario".to_owned(), own_values, own));
    rows.extend(
        chosen.iter().enumerate().map(|(at, one)| row((at + 1).to_string(), &one.values, &one.design)),
    );
    table(&rows)
}

/// A variable's value as it is read.
fn value(search: &Search, at: usize, x: f64) -> String {
    match &search.said().variables[at].range {
        SearchRange::Bounds(..) => digits(x),
        SearchRange::Choices(choices) => choices.get(x as usize).map_or_else(|| "-".to_owned(), sweep_value),
    }
}

/// A path without what all paths of pixels begin with.
pub(super) fn short(path: &str) -> String {
    path.strip_prefix("display.pixel.").unwrap_or(path).to_owned()
}

/// Everything as JSON.
pub(super) fn json(
    title: &str,
    search: &Search,
    chosen: &[Chosen],
    found: &[Found],
    checked: &[Checked],
) -> Value {
    let study = search.study();
    let quantities = |values: &[Option<f64>]| -> Map<String, Value> {
        study.quantities.iter().zip(values).map(|(one, value)| (one.name.clone(), json!(value))).collect()
    };
    let settings = |design: &[f64]| -> Map<String, Value> {
        let settings = study.settings(design).unwrap_or_default();
        settings.into_iter().map(|(path, value)| (path.to_owned(), value)).collect()
    };
    let one = |chosen: &Chosen| {
        json!({
            "set": settings(&chosen.design),
            "quantities": quantities(&chosen.values),
            "meets_limits": chosen.meets_limits(),
            "missed": chosen.missed,
        })
    };
    let (own, own_values) = search.own();
    json!({
        "papilio": env!("CARGO_PKG_VERSION"),
        "title": title,
        "search": search.said().hash,
        "evaluations": evaluations(found),
        "objectives": search.said().objectives.iter().map(|one| one.name.clone()).collect::<Vec<_>>(),
        "scenario": { "set": settings(own), "quantities": quantities(own_values) },
        "designs": chosen.iter().map(one).collect::<Vec<_>>(),
        "checked_by_walk": checked.iter().map(Checked::json).collect::<Vec<_>>(),
    })
}

/// Designs that were evaluated in all.
pub(super) fn evaluations(found: &[Found]) -> usize {
    found.iter().map(|one| one.evaluations).sum()
}
