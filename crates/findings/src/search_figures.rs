//! Figures of a search: how its tasks went on, and the front.

use papilio_design::search::{Chosen, Found, Search};
use papilio_figures::{Chart, ChartCurve, Hue, chart, named_with_unit};

/// More curves than these hide each other.
const MOST_CURVES: usize = 60;

/// Names of files, without their ends, and SVG texts: how the tasks went on, and of several objectives the front.
pub fn search_figures(
    title: &str,
    search: &Search,
    found: &[Found],
    chosen: &[Chosen],
) -> Vec<(String, String)> {
    let mut drawn = vec![("trace".to_owned(), trace(title, search, found, chosen))];
    if search.aims().objectives() > 1 {
        drawn.push(("front".to_owned(), front(title, search, found, chosen)));
    }
    drawn
}

/// The first objective of the best design so far, of every task that sought it, against the designs that the task had evaluated.
fn trace(title: &str, search: &Search, found: &[Found], chosen: &[Chosen]) -> String {
    let mut tasks: Vec<&Found> =
        found.iter().filter(|one| one.objective == 0 && !one.trace.is_empty()).collect();
    let count = tasks.len();
    let best = chosen.first().map(|one| one.task);
    // The best one lies over the others.
    tasks.sort_by_key(|one| Some(one.task) == best);
    let curve = |one: &&Found| {
        let is_best = Some(one.task) == best;
        ChartCurve {
            name: if is_best { format!("best: task {}", one.task) } else { String::new() },
            hue: if is_best { Hue::Group(0) } else { Hue::Grey },
            dashed: false,
            marks: false,
            points: steps(one),
        }
    };
    let all = Chart {
        x: "Designs evaluated by a task".to_owned(),
        y: format!("Best {}", axis(search, 0)),
        logarithmic: false,
        at_least: search.aims().value(0, search.own().1).into_iter().collect(),
        curves: tasks[count.saturating_sub(MOST_CURVES)..].iter().map(curve).collect(),
    };
    let lines = match count {
        0 => "nothing that was found meets the limits".to_owned(),
        1 => "the task that met the limits".to_owned(),
        2..=MOST_CURVES => format!("a line for each of the {count} tasks that met the limits"),
        _ => format!("{MOST_CURVES} of the {count} tasks that met the limits"),
    };
    chart(&all, &beside(title, &lines))
}

/// A line that stays until something better is found.
fn steps(one: &Found) -> Vec<(f64, f64)> {
    let mut points = Vec::new();
    for (at, value) in one.trace_at.iter().zip(&one.trace) {
        let last = points.last().map(|(_, value): &(f64, f64)| *value);
        points.extend(last.map(|value| (*at as f64, value)));
        points.push((*at as f64, *value));
    }
    let last = one.trace.last().map(|value| (one.evaluations as f64, *value));
    points.into_iter().chain(last).collect()
}

/// The front's first two objectives against each other, with all that tasks found and the scenario's own design.
fn front(title: &str, search: &Search, found: &[Found], chosen: &[Chosen]) -> String {
    let at = |values: &[Option<f64>]| {
        let of = |objective| search.aims().value(objective, values).unwrap_or(f64::NAN);
        (of(1), of(0))
    };
    let curve = |name: &str, group, marks, points| ChartCurve {
        name: name.to_owned(),
        hue: Hue::Group(group),
        dashed: false,
        marks,
        points,
    };
    let sound = found.iter().filter(|one| !one.design.is_empty());
    let line: Vec<(f64, f64)> = chosen.iter().map(|one| at(&one.values)).collect();
    let all = Chart {
        x: axis(search, 1),
        y: axis(search, 0),
        logarithmic: false,
        at_least: Vec::new(),
        curves: vec![
            curve("", 3, true, sound.map(|one| at(&one.values)).collect()),
            curve("", 0, false, line.clone()),
            curve("front", 0, true, line),
            curve("scenario", 2, true, vec![at(search.own().1)]),
        ],
    };
    chart(&all, &beside(title, "black: all that was found"))
}

/// A title and what the lines are.
fn beside(title: &str, lines: &str) -> String {
    format!("{title}   \u{b7}   {lines}")
}

/// What stands at an axis.
fn axis(search: &Search, objective: usize) -> String {
    let name = &search.said().objectives[objective].name;
    named_with_unit(name, name.trim_start_matches("mean "))
}
