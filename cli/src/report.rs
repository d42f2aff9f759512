//! The table on the terminal.

use std::fmt::Write;

use papilio_display::result::{RunResult, State, StateValues, View};

/// More views than this are summed up, a line each.
const VIEWS_IN_FULL: usize = 3;

/// What `papilio run` prints.
pub(crate) fn run(title: &str, result: &RunResult, seconds: f64) -> String {
    let mut text = format!("{title}\n");
    if result.views.len() <= VIEWS_IN_FULL {
        result.views.iter().for_each(|view| text.push_str(&in_full(view)));
    } else {
        text.push_str(&line_by_line(result));
    }
    let solver = &result.solver;
    let _ = write!(
        text,
        "\n{}: {} paths, relative error {:.2} %, {seconds:.2} s. 0.123(4) means 0.123 with a standard error of 0.004.\n",
        solver.method,
        solver.paths,
        100.0 * solver.relative_error_reached
    );
    text
}

/// A column of the table of states: its title, its usual decimals, and its number.
type Column = (&'static str, usize, fn(&StateValues) -> Option<f64>);

const COLUMNS: [Column; 9] = [
    ("Y", 4, |s| Some(s.Y)),
    ("cd/m2", 2, |s| Some(s.luminance_cd_m2)),
    ("contrast", 2, |s| s.contrast),
    ("L*", 2, |s| s.L_star),
    ("a*", 2, |s| s.a_star),
    ("b*", 2, |s| s.b_star),
    ("u'", 4, |s| s.u_prime),
    ("v'", 4, |s| s.v_prime),
    ("peak nm", 1, |s| s.peak_nm),
];

fn in_full(view: &View) -> String {
    let mut rows = vec![vec!["state".to_owned()]];
    rows[0].extend(COLUMNS.iter().map(|(title, ..)| (*title).to_owned()));
    for (name, State { value, standard_error }) in view.states.iter() {
        let cells =
            COLUMNS.iter().map(|(_, decimals, get)| measured(get(value), get(standard_error), *decimals));
        rows.push(std::iter::once(name.to_owned()).chain(cells).collect());
    }
    let mut text = format!("\nseen from {} deg", view.theta_deg);
    if view.phi_deg != 0.0 {
        let _ = write!(text, ", azimuth {} deg", view.phi_deg);
    }
    text.push('\n');
    text.push_str(&table(&rows));
    text.push_str(&together(view));
    text.push_str(&ledger(view));
    text
}

/// The metrics of the states together.
fn together(view: &View) -> String {
    let error = &view.standard_error;
    let parts = [
        ("contrast ratio ", view.contrast_ratio, error.contrast_ratio, ""),
        ("gamut ", view.gamut_percent_srgb, error.gamut_percent_srgb, " % of sRGB"),
        ("", view.gamut_percent_ebu, error.gamut_percent_ebu, " % of EBU"),
    ];
    let known = parts.into_iter().filter(|(_, value, ..)| value.is_some());
    let shown: Vec<String> = known
        .map(|(before, value, error, after)| format!("{before}{}{after}", measured(value, error, 2)))
        .collect();
    if shown.is_empty() { String::new() } else { format!("  {}\n", shown.join(", ")) }
}

/// Where the light of the first state goes.
fn ledger(view: &View) -> String {
    let Some((name, ledger)) = view.ledger.iter().next() else { return String::new() };
    let absorbed = &ledger.absorbed;
    let parts = [
        ("front", absorbed.front),
        ("diffuser", absorbed.diffuser),
        ("glass", absorbed.glass),
        ("pixel", absorbed.pixel),
        ("inactive", absorbed.inactive),
    ];
    let parts: Vec<String> = parts
        .iter()
        .filter(|(_, share)| *share > 5e-5)
        .map(|(at, share)| format!("{at} {:.1} %", 100.0 * share))
        .collect();
    format!(
        "  a beam from here, {name}: {:.1} % returns; absorbed: {}\n",
        100.0 * ledger.returned,
        parts.join(", ")
    )
}

/// A line for each view.
fn line_by_line(result: &RunResult) -> String {
    let title = ["theta", "phi", "Y white", "Y black", "contrast", "% sRGB", "% EBU", "white u'", "white v'"];
    let mut rows = vec![title.map(str::to_owned).to_vec()];
    for view in &result.views {
        let of = |state: &str, decimals: usize, get: fn(&StateValues) -> Option<f64>| {
            view.states
                .get(state)
                .map_or("-".to_owned(), |s| measured(get(&s.value), get(&s.standard_error), decimals))
        };
        let error = &view.standard_error;
        rows.push(vec![
            view.theta_deg.to_string(),
            view.phi_deg.to_string(),
            of("white", 4, |s| Some(s.Y)),
            of("black", 4, |s| Some(s.Y)),
            measured(view.contrast_ratio, error.contrast_ratio, 2),
            measured(view.gamut_percent_srgb, error.gamut_percent_srgb, 2),
            measured(view.gamut_percent_ebu, error.gamut_percent_ebu, 2),
            of("white", 4, |s| s.u_prime),
            of("white", 4, |s| s.v_prime),
        ]);
    }
    format!("\n{}", table(&rows))
}

/// Left-aligned first column, right-aligned numbers.
fn table(rows: &[Vec<String>]) -> String {
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..rows[0].len()).map(width).collect();
    let mut text = String::new();
    for row in rows {
        let _ = write!(text, "  {:<1$}", row[0], widths[0]);
        for (cell, width) in row.iter().zip(&widths).skip(1) {
            let _ = write!(text, "  {cell:>width$}");
        }
        text.push('\n');
    }
    text
}

/// `0.1523(2)`: a value and its standard error in units of its last digit (GUM, 7.2.2);
/// without an error worth showing, the value to its usual decimals.
fn measured(value: Option<f64>, error: Option<f64>, decimals: usize) -> String {
    let Some(value) = value else { return "-".to_owned() };
    let error = error.unwrap_or(0.0);
    let unit = 0.1_f64.powi(decimals as i32);
    if error.is_nan() || error < 0.5 * unit {
        return format!("{value:.decimals$}");
    }
    // The error's first digit decides how many decimals are worth printing.
    let worth = (-error.log10().floor()).max(0.0) as usize;
    let decimals = worth.min(decimals);
    let last = (error / 0.1_f64.powi(decimals as i32)).round();
    format!("{value:.decimals$}({last})")
}

#[cfg(test)]
mod tests {
    use super::measured;

    #[test]
    fn errors_stand_in_units_of_the_last_digit() {
        assert_eq!(measured(Some(0.15234), Some(0.00021), 4), "0.1523(2)");
        assert_eq!(measured(Some(0.15234), Some(0.0021), 4), "0.152(2)");
        assert_eq!(measured(Some(0.15234), Some(1e-9), 4), "0.1523");
        assert_eq!(measured(Some(612.34), Some(23.0), 1), "612(23)");
        assert_eq!(measured(Some(9.123), None, 2), "9.12");
        assert_eq!(measured(None, None, 2), "-");
    }
}
