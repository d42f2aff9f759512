//! Figures of a search: the progress of its tasks, and the Pareto front.

use crate::search::{Search, SearchResult, SelectedDesign};
use papilio_display::uncapitalised;
use papilio_figures::{Chart, ChartCurve, Hue, chart};
use papilio_scenario::label;

/// Relative difference below which two results are called equal: less than an axis shows.
const EQUAL: f64 = 1e-3;

/// Largest number of curves in a figure; more would hide each other.
const MOST_CURVES: usize = 60;

/// Returns file names without extension and SVG texts: the progress of the tasks and, for several objectives,
/// the front.
pub fn search_figures(
    title: &str,
    search: &Search,
    results: &[SearchResult],
    selected: &[SelectedDesign],
) -> Vec<(String, String)> {
    let mut drawn = vec![("trace".to_owned(), trace(title, search, results, selected))];
    if search.aims().objectives() > 1 {
        drawn.push(("front".to_owned(), front(title, search, results, selected)));
    }
    drawn
}

/// Plots the first objective of the best design so far against the number of evaluated designs, for every
/// task that optimised this objective.
fn trace(title: &str, search: &Search, results: &[SearchResult], selected: &[SelectedDesign]) -> String {
    let mut tasks: Vec<&SearchResult> =
        results.iter().filter(|one| one.objective == 0 && !one.trace.is_empty()).collect();
    let count = tasks.len();
    let best = selected.first().map(|one| one.task);
    // The best task is drawn last, on top of the others.
    tasks.sort_by_key(|one| Some(one.task) == best);
    let last = |result: &SearchResult| result.trace.last().copied().unwrap_or(f64::NAN);
    let highest = tasks.last().map_or(f64::NAN, |result| last(result));
    let equal = tasks.iter().filter(|one| (last(one) - highest).abs() <= EQUAL * highest.abs()).count();
    let curve = |result: &&SearchResult| {
        let is_best = Some(result.task) == best;
        ChartCurve {
            name: if is_best { format!("best: task {}", result.task) } else { String::new() },
            hue: if is_best { Hue::Group(0) } else { Hue::Grey },
            dashed: false,
            marks: false,
            points: steps(result),
        }
    };
    // The ends of the lines are marked, so that a task with a single result is visible; the axis begins at 0.
    let end = |result: &&SearchResult| steps(result).last().copied();
    let ends = |hue, points: Vec<(f64, f64)>| ChartCurve {
        name: String::new(),
        hue,
        dashed: false,
        marks: true,
        points,
    };
    let drawn = &tasks[count.saturating_sub(MOST_CURVES)..];
    let origin = ChartCurve { points: vec![(0.0, highest)], marks: false, ..ends(Hue::Grey, Vec::new()) };
    let (others, last_task) = drawn.split_at(drawn.len().saturating_sub(1));
    let all = Chart {
        x: "Designs evaluated by a task".to_owned(),
        y: format!("Best {}", uncapitalised(&axis(search, 0))),
        logarithmic: false,
        at_least: search.aims().value(0, search.own().1).into_iter().collect(),
        curves: std::iter::once(origin)
            .chain([ends(Hue::Grey, others.iter().filter_map(end).collect())])
            .chain(drawn.iter().map(curve))
            .chain([ends(Hue::Group(0), last_task.iter().filter_map(end).collect())])
            .collect(),
    };
    let lines = match count {
        0 => "no task met the constraints".to_owned(),
        1 => "the task that met the constraints".to_owned(),
        2..=MOST_CURVES => format!("{count} tasks that met the constraints"),
        _ => format!("{MOST_CURVES} of the {count} tasks that met the constraints"),
    };
    let lines = if equal > 1 { format!("{lines}; {equal} reach the best value") } else { lines };
    chart(&all, &titled(title, &lines))
}

/// Step function of a trace: the value holds until a better design is found.
fn steps(result: &SearchResult) -> Vec<(f64, f64)> {
    let mut points = Vec::new();
    for (evaluation, value) in result.trace_at.iter().zip(&result.trace) {
        let last = points.last().map(|(_, value): &(f64, f64)| *value);
        points.extend(last.map(|value| (*evaluation as f64, value)));
        points.push((*evaluation as f64, *value));
    }
    let last = result.trace.last().map(|value| (result.evaluations as f64, *value));
    points.into_iter().chain(last).collect()
}

/// Plots the first two objectives of the front against each other, with the results of all tasks and the
/// scenario's own design.
fn front(title: &str, search: &Search, results: &[SearchResult], selected: &[SelectedDesign]) -> String {
    let point = |values: &[Option<f64>]| {
        let value = |objective| search.aims().value(objective, values).unwrap_or(f64::NAN);
        (value(1), value(0))
    };
    let curve = |name: &str, group, marks, points| ChartCurve {
        name: name.to_owned(),
        hue: Hue::Group(group),
        dashed: false,
        marks,
        points,
    };
    let valid = results.iter().filter(|one| !one.design.is_empty());
    let line: Vec<(f64, f64)> = selected.iter().map(|design| point(&design.values)).collect();
    let all = Chart {
        x: axis(search, 1),
        y: axis(search, 0),
        logarithmic: false,
        at_least: Vec::new(),
        curves: vec![
            curve("", 3, true, valid.map(|result| point(&result.values)).collect()),
            curve("", 0, false, line.clone()),
            curve("front", 0, true, line),
            curve("scenario", 2, true, vec![point(search.own().1)]),
        ],
    };
    chart(&all, &titled(title, "black: results of all tasks"))
}

/// Title of a figure with a description of its lines.
fn titled(title: &str, lines: &str) -> String {
    format!("{title}   \u{b7}   {lines}")
}

/// Label of the axis of an objective.
fn axis(search: &Search, objective: usize) -> String {
    label(&search.spec().objectives[objective].name).to_string()
}
