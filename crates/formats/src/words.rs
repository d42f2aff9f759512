//! Numbers and names as lines of text have them.

use std::fmt::Write;

use papilio_goniometry::Channel;

/// Left-aligned first column, right-aligned numbers.
pub fn table(rows: &[Vec<String>]) -> String {
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..rows.first().map_or(0, Vec::len)).map(width).collect();
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

/// A share in per cent: one decimal, or two below 10 %.
pub fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    if percent.abs() >= 10.0 || percent == 0.0 {
        format!("{percent:.1} %")
    } else {
        format!("{percent:.2} %")
    }
}

/// Values that rise: how many, and from where to where.
pub fn span(values: &[f64]) -> String {
    match values {
        [] => "none".to_owned(),
        [one] => format!("{one}"),
        [first, .., last] => format!("{} from {first} to {last}", values.len()),
    }
}

/// A channel's name; of a wavelength, with its unit.
pub fn channel(of: &Channel) -> String {
    if matches!(of, Channel::Wavelength(_)) { format!("{of} nm") } else { of.to_string() }
}
