//! Report of a fit on the terminal.

use std::fmt::Write as _;

use papilio_design::fit::{FitReport, FittedVariable};
use papilio_scenario::label;

use crate::numbers::{digits, digits_alike};
use crate::report::{plain, table};

/// Standard errors below this have an exponent: five decimals show none of their digits, or one.
const SMALL: f64 = 1e-4;

pub(super) fn text(title: &str, found: &FitReport) -> String {
    let titles = ["variable", "scenario", "fitted", "standard error", "68.3 %", "95 %"];
    let mut rows = vec![titles.map(str::to_owned).to_vec()];
    rows.extend(found.variables.iter().map(row));
    let mut text = format!("{}\n{}", plain(title), table(&rows));
    for group in &found.undetermined {
        let names: Vec<&str> = group.iter().map(String::as_str).collect();
        let _ = match names.as_slice() {
            [only] => writeln!(text, "the data do not determine {only}"),
            several => writeln!(text, "the data cannot tell apart: {}", several.join(", ")),
        };
    }
    let freedom = found.degrees_of_freedom;
    let unit = if freedom == 1 { "degree of freedom" } else { "degrees of freedom" };
    let _ = writeln!(text, "\nchi-square {}, {freedom} {unit}", large(found.chi_square));
    if let Some(rms) = found.residual_rms {
        let _ = writeln!(text, "residuals: rms {}", digits(rms));
    }
    let estimated = found.estimated_deviation;
    for (deviation, of) in [(estimated.reflectance_factor, "reflectances"), (estimated.lab, "L*, a*, b*")] {
        if let Some(deviation) = deviation {
            let _ = writeln!(text, "standard deviation of {of}, from the residuals: {}", digits(deviation));
        }
    }
    if let Some(runs) = found.runs {
        let _ = writeln!(
            text,
            "runs of one sign: {}, of independent errors {:.0} (z = {:.1})",
            runs.count, runs.expected, runs.z
        );
    }
    let starts = found.starts;
    let _ = writeln!(text, "BIC {} ({})", large(found.bic), counted(found.observations, "number"));
    let _ = writeln!(text, "{} of {} starts led to this minimum", starts.best, starts.count);
    text
}

/// A number with one decimal, or with an exponent.
fn large(number: f64) -> String {
    match number.abs() < 1e7 {
        true => format!("{number:.1}"),
        false => format!("{number:.3e}"),
    }
}

/// A number with its noun.
pub(super) fn counted(count: usize, noun: &str) -> String {
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}

/// A standard error; a small one with an exponent.
fn of_error(error: f64) -> String {
    match error > 0.0 && error < SMALL {
        true => format!("{error:.1e}"),
        false => digits(error),
    }
}

/// Both ends of an interval, with so many decimals that they differ.
fn of_ends(ends: [f64; 2]) -> String {
    let both = digits_alike(ends);
    let width = ends[1] - ends[0];
    match both[0] == both[1] && width > 0.0 {
        true => {
            let decimals = (1.0 - width.log10().floor()).clamp(1.0, 12.0) as usize;
            ends.map(|end| format!("{end:.decimals$}")).join(" to ")
        }
        false => both.join(" to "),
    }
}

/// All keys that a variable sets.
fn name(one: &FittedVariable) -> String {
    let keys: Vec<String> = one.keys.iter().map(|key| label(key).to_string()).collect();
    let other = one.compensated_by.as_ref().map(|key| format!(" (compensated by {})", label(key)));
    format!("{}{}", keys.join(", "), other.unwrap_or_default())
}

fn row(one: &FittedVariable) -> Vec<String> {
    let bound = if one.at_bound { " (at its bound)" } else { "" };
    let interval = |ends: Option<[f64; 2]>| ends.map_or("-".to_owned(), of_ends);
    vec![
        name(one),
        one.start.map_or("-".to_owned(), digits),
        one.value.map_or("not determined".to_owned(), |value| format!("{}{bound}", digits(value))),
        one.standard_error.map_or("-".to_owned(), of_error),
        interval(one.interval_68),
        interval(one.interval_95),
    ]
}
