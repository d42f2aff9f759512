//! Results of fits as texts: table, figures, and the fitted scenario.

use std::fmt::Write as _;
use std::path::Path;

use papilio_figures::{FittedSpectrum, fit_residuals, fitted_spectra};
use papilio_scenario::{Edit, edit};

use super::moved;
use crate::DesignError;
use crate::fit::{FitReport, FittedVariable, Fitting, Residual};

/// Formats `fit.csv`: each measured number with its prediction.
pub fn fit_table(report: &FitReport) -> String {
    let mut text =
        "name,theta_deg,phi_deg,quantity,wavelength_nm,measured,standard_deviation,fitted,residual,z\n"
            .to_owned();
    for one in &report.residuals {
        let name = match one.name.contains([',', '"']) {
            true => format!("\"{}\"", one.name.replace('"', "\"\"")),
            false => one.name.clone(),
        };
        let nm = one.wavelength_nm.map_or(String::new(), |nm| nm.to_string());
        let residual = one.predicted - one.measured;
        let _ = writeln!(
            text,
            "{name},{},{},{},{nm},{},{},{},{residual},{}",
            one.theta_deg,
            one.phi_deg,
            one.quantity,
            one.measured,
            one.standard_deviation,
            one.predicted,
            residual / one.standard_deviation
        );
    }
    text
}

/// Draws the spectra with their fits, and the residuals: names without extension, and SVG. None without
/// spectra.
pub fn fit_figures(title: &str, report: &FitReport) -> Vec<(String, String)> {
    let factors: Vec<&Residual> = report.residuals.iter().filter(|one| one.wavelength_nm.is_some()).collect();
    let spectra: Vec<&[&Residual]> = factors.chunk_by(|a, b| a.series == b.series).collect();
    let is_of = |one: &[&Residual], other: &[&Residual]| {
        (one[0].theta_deg, one[0].phi_deg) == (other[0].theta_deg, other[0].phi_deg)
    };
    let has_one_view = spectra.windows(2).all(|pair| is_of(pair[0], pair[1]));
    let spectrum = |all: &&[&Residual]| {
        let of = |get: fn(&Residual) -> f64| all.iter().map(|one| get(one)).collect();
        let place = format!("{} at {} deg", all[0].name, all[0].theta_deg);
        FittedSpectrum {
            name: if has_one_view { all[0].name.clone() } else { place },
            wavelength_nm: of(|one| one.wavelength_nm.unwrap_or_default()),
            measured: of(|one| one.measured),
            deviation: of(|one| one.standard_deviation),
            predicted: of(|one| one.predicted),
        }
    };
    let spectra: Vec<FittedSpectrum> = spectra.iter().map(spectrum).collect();
    match spectra.is_empty() {
        true => Vec::new(),
        false => vec![
            ("fit-spectra".to_owned(), fitted_spectra(&spectra, title)),
            ("fit-residuals".to_owned(), fit_residuals(&spectra, title)),
        ],
    }
}

/// Returns the text of the fitted scenario, `fitted.toml`: values replaced, and intervals in comments at its
/// beginning.
///
/// `text` is a file of the folder `from`; paths in it are rewritten for the folder `to`.
///
/// # Errors
/// If `text` is not the scenario of the fit.
pub fn fitted_text(
    text: &str,
    [from, to]: [&Path; 2],
    fitting: &Fitting<'_>,
    report: &FitReport,
) -> Result<String, DesignError> {
    let edits = fitted_edits(fitting, report)?;
    let mut head = HEAD.to_owned();
    for one in &report.variables {
        let _ = writeln!(head, "# {}", in_words(one, report));
    }
    Ok(format!("{head}{}", moved(&edit(without_head(text), &edits)?, from, to)))
}

/// Returns the edits that give a scenario the fitted values.
///
/// # Errors
/// If a value is not finite.
pub fn fitted_edits(fitting: &Fitting<'_>, report: &FitReport) -> Result<Vec<Edit>, DesignError> {
    let values: Vec<f64> = report.variables.iter().map(|one| rounded(one.best)).collect();
    let settings = fitting.settings(&values)?.into_iter();
    Ok(settings.map(|(path, value)| Edit::Set { path, value }).collect())
}

/// First line of a fitted scenario.
const HEAD: &str = "# Fitted to measured data; standard errors, and intervals of 68.3 and 95 % confidence:\n";

/// Returns a text without the comments of an earlier fit.
fn without_head(text: &str) -> &str {
    let Some(mut rest) = text.strip_prefix(HEAD) else { return text };
    let is_of_fit = |line: &str| line.starts_with("# ") && line.contains(" = ");
    while let Some((_, after)) = rest.split_once('\n').filter(|(line, _)| is_of_fit(line)) {
        rest = after;
    }
    rest
}

fn in_words(one: &FittedVariable, report: &FitReport) -> String {
    let (key, value) = (&one.key, rounded(one.best));
    let bound = if one.at_bound { ", at its bound" } else { "" };
    match (one.standard_error, one.interval_68, one.interval_95) {
        (Some(error), Some([a, b]), Some([c, d])) => {
            let [error, a, b, c, d] = [error, a, b, c, d].map(|number| digits(number, 6));
            format!("{key} = {value} +- {error}, {a} to {b}, {c} to {d}{bound}")
        }
        _ => {
            let others = report.undetermined.iter().find(|group| group.contains(key));
            let others: Vec<&str> =
                others.into_iter().flatten().filter(|other| *other != key).map(String::as_str).collect();
            match others.is_empty() {
                true => format!("{key} = {value}, which the data do not determine"),
                false => {
                    format!("{key} = {value}, which the data cannot tell apart from {}", others.join(", "))
                }
            }
        }
    }
}

/// A number with nine significant digits.
fn rounded(value: f64) -> f64 {
    digits(value, 9)
}

fn digits(value: f64, count: usize) -> f64 {
    format!("{value:.*e}", count - 1).parse().unwrap_or(value)
}
