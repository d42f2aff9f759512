//! Measurements of a display: spectra and colours of its states, and metrics by name.

use papilio_diagnostics::{Diagnostic, Warned, did_you_mean};
use papilio_display::compare::{Measured, MeasuredMetric, Measurement};
use papilio_display::scene::Metric;

use crate::error::{FormatError, Problem, too_few};
use crate::file::DataFile;
use crate::measured_panel::read_measured_panel;
use crate::table::quantities::{METRIC, METRIC_DEVIATION, METRIC_VALUE, PHI, THETA};
use crate::table::{Header, Quantity, Row, Table, TableText, body};

static ACCEPTED: [&Quantity; 5] = [&METRIC, &METRIC_VALUE, &METRIC_DEVIATION, &THETA, &PHI];

/// Reads a measurement: a table with the columns `metric` and `value`, optionally `standard_deviation`,
/// `theta_deg` and `phi_deg`, with a row for each metric; or any file of [`read_measured_panel`].
///
/// # Errors
/// With line and column: those of [`read_measured_panel`]; metrics that do not exist, a metric with two values.
pub fn read_measurement(file: &DataFile) -> Result<Warned<Measurement>, FormatError> {
    if let Ok(text) = TableText::new(file)
        && text.table().data().next().is_some_and(|row| is_of_metrics(&row))
    {
        return metrics(text.table());
    }
    let Warned { value: states, warnings } = read_measured_panel(file)?;
    Ok(Warned { value: Measurement { states, metrics: Vec::new() }, warnings })
}

/// Whether the first row of a table names a column of metrics.
fn is_of_metrics(row: &Row<'_>) -> bool {
    row.cells.iter().any(|cell| cell.text.trim().eq_ignore_ascii_case("metric"))
}

fn metrics(table: Table<'_>) -> Result<Warned<Measurement>, FormatError> {
    let is_complete = |header: &Header| header.get(&METRIC).and(header.get(&METRIC_VALUE)).is_some();
    let read = body(table, &ACCEPTED, is_complete, "`metric` or `value`")?;
    let (Some(mut header), Some(head)) = (read.header, read.head) else {
        return Err(table.error(too_few(0).into()));
    };
    header.refuse_others(&head, &ACCEPTED)?;
    let mut metrics: Vec<MeasuredMetric> = Vec::new();
    for row in &read.rows {
        let one = metric(&header, row)?;
        if metrics.iter().any(|other| other.names_the_same_as(&one)) {
            let wrong = Diagnostic::new(format!("`{}` has two values", one.name()));
            return Err(row.error(wrong.hint("remove one of the two").into()));
        }
        metrics.push(one);
    }
    if metrics.is_empty() {
        return Err(table.error(too_few(0).expected("a row for each metric").into()));
    }
    let states: Vec<Measured> = Vec::new();
    Ok(Warned { value: Measurement { states, metrics }, warnings: header.notes })
}

fn metric(header: &Header, row: &Row<'_>) -> Result<MeasuredMetric, FormatError> {
    row.expect_cells(header.count, "as many columns as the header")?;
    let within = |quantity: &'static Quantity, (least, most): (f64, f64), expected| {
        let column = header.get(quantity);
        column.map(|column| column.number_within(row, quantity.what, (least, most), expected)).transpose()
    };
    let name = header.get(&METRIC);
    let text = name.map_or("", |column| column.text(row));
    let (state, metric) = Metric::with_state(text)
        .ok_or_else(|| row.cell_error(name.map_or(0, |column| column.cell), no_such_metric(text)))?;
    let value = within(&METRIC_VALUE, (-1e12, 1e12), "a number")?.unwrap_or_default();
    Ok(MeasuredMetric {
        state: state.map(str::to_owned),
        metric,
        theta_deg: within(&THETA, (-90.0, 90.0), "an angle from -90 to 90 deg")?,
        phi_deg: within(&PHI, (-360.0, 360.0), "an azimuth from -360 to 360 deg")?.unwrap_or(0.0),
        value,
        standard_deviation: within(&METRIC_DEVIATION, (1e-12, 1e12), "a number above 0, from 1e-12 to 1e12")?,
        place: row.place().to_string(),
    })
}

fn no_such_metric(text: &str) -> Problem {
    let (state, name) = text.rsplit_once('.').unwrap_or(("", text));
    let known = Metric::ALL.iter().filter(|metric| metric.is_of_view() == state.is_empty());
    let names: Vec<&str> = known.map(|metric| metric.name()).collect();
    let hint = match Metric::named(name) {
        Some(metric) if !metric.is_of_view() => format!("write the state before it: `white.{name}`"),
        Some(_) => format!("write it without a state: `{name}`"),
        None => did_you_mean(name, names.iter().copied()).unwrap_or_else(|| containing(name, &names)),
    };
    Diagnostic::new(format!("there is no metric `{text}`"))
        .expected("the name of a metric, as `contrast_ratio` or `white.Y`")
        .hint(hint)
        .into()
}

/// Names of metrics that contain a word, and the page that lists all.
fn containing(word: &str, names: &[&str]) -> String {
    let word = word.to_lowercase();
    let found: Vec<&str> = names
        .iter()
        .copied()
        .filter(|name| !word.is_empty() && name.to_lowercase().contains(&word))
        .collect();
    let all = "docs/metric-names.md lists all metrics";
    match found.len() {
        0 => all.to_owned(),
        count if count <= MOST_NAMED => format!("did you mean {}? {all}", found.join(" or ")),
        count => format!(
            "{} and {} more have this word; {all}",
            found[..MOST_NAMED].join(", "),
            count - MOST_NAMED
        ),
    }
}

/// Most metrics that a hint names.
const MOST_NAMED: usize = 4;

#[cfg(test)]
mod tests {
    use papilio_display::compare::StandardDeviation;

    use super::*;

    fn read(text: &str) -> Result<Warned<Measurement>, FormatError> {
        read_measurement(&DataFile { name: "m.csv".to_owned(), bytes: text.as_bytes().to_vec() })
    }

    #[test]
    fn deviations_have_the_unit_of_their_values() {
        let spectrum = |text: &str| match read(text).unwrap().value.states[0].standard_deviation.clone() {
            Some(StandardDeviation::Spectrum(values)) => values.values().to_vec(),
            other => panic!("{other:?}"),
        };
        let text =
            "state,wavelength_nm,reflectance_factor,standard_deviation\nw,700,0.5,0.01\nw,400,0.3,0.02\n";
        assert_eq!(spectrum(text), [0.02, 0.01]);
        let percent = "state,wavelength_nm,R (%),sd\nw,400,50,1\nw,700,40,2\n";
        assert_eq!(spectrum(percent), [0.01, 0.02]);
        let unstated = "wavelength_nm,white,standard_deviation\n400,50,1\n700,40,2\n";
        assert_eq!(spectrum(unstated), [0.01, 0.02]);
        for (text, expected) in [
            ("state,X,Y,Z,standard_deviation\nw,0.2,0.3,0.2,0.004\n", 0.004),
            ("state,X (%),Y (%),Z (%),sigma\nw,20,30,20,0.4\n", 0.004),
            ("state,L,a,b,standard_deviation\nw,50,1,2,0.4\n", 0.4),
        ] {
            let found = read(text).unwrap().value.states[0].standard_deviation.clone();
            let Some(StandardDeviation::Colour(found)) = found else { panic!("{text}: {found:?}") };
            assert!(found.iter().all(|one| (one - expected).abs() < 1e-15), "{text}: {found:?}");
        }
    }

    /// CGATS.17 has standard deviations of colours: X, Y, Z are relative to Y = 100, and so are theirs.
    #[test]
    fn deviations_of_cgats_are_those_of_its_colours() {
        let file = |fields: &str, row: &str| {
            format!(
                "CGATS.17\nBEGIN_DATA_FORMAT\nSAMPLE_NAME {fields}\nEND_DATA_FORMAT\nBEGIN_DATA\nwhite {row}\nEND_DATA\n"
            )
        };
        let lab = ("LAB_L LAB_A LAB_B STDEV_L STDEV_A STDEV_B", "65 -3.5 -1.2 0.2 0.05 0.1");
        let xyz = ("XYZ_X XYZ_Y XYZ_Z STDEV_X STDEV_Y STDEV_Z", "32 34 36 0.3 0.4 0.5");
        let both = (
            "XYZ_X XYZ_Y XYZ_Z LAB_L LAB_A LAB_B STDEV_L STDEV_A STDEV_B",
            "32 34 36 65 -3.5 -1.2 0.2 0.05 0.1",
        );
        for ((fields, row), expected) in
            [(lab, [0.2, 0.05, 0.1]), (xyz, [0.003, 0.004, 0.005]), (both, [0.2, 0.05, 0.1])]
        {
            let state = read(&file(fields, row)).unwrap().value.states[0].clone();
            let Some(StandardDeviation::Colour(found)) = state.standard_deviation else { panic!("{fields}") };
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-15), "{fields}: {found:?}");
            let is_lab = matches!(state.quantity, papilio_display::compare::Quantity::Lab(_));
            assert_eq!(is_lab, fields.contains("LAB_L"), "{fields}");
        }
        let wrong = read(&file(lab.0, "65 -3.5 -1.2 0.2 0 0.1")).unwrap_err().to_string();
        assert!(wrong.contains("m.csv:6:24") && wrong.contains("STDEV_A is 0"), "{wrong}");
    }

    /// X, Y, Z up to 1.5 are relative to Y = 1, and so are their standard deviations; fields of standard deviations that cannot be
    /// used are named.
    #[test]
    fn cgats_notes_its_scale_and_unused_deviations() {
        let file = |fields: &str, row: &str| {
            format!(
                "CGATS.17\nBEGIN_DATA_FORMAT\nSAMPLE_NAME {fields}\nEND_DATA_FORMAT\nBEGIN_DATA\nwhite {row}\nEND_DATA\n"
            )
        };
        let all = ("XYZ_X XYZ_Y XYZ_Z STDEV_X STDEV_Y STDEV_Z", "0.32 0.34 0.36 0.003 0.004 0.005");
        let found = read(&file(all.0, all.1)).unwrap();
        let state = &found.value.states[0];
        assert_eq!(
            state.quantity,
            papilio_display::compare::Quantity::Xyz(papilio_colour::Xyz { x: 0.32, y: 0.34, z: 0.36 })
        );
        assert_eq!(state.standard_deviation, Some(StandardDeviation::Colour([0.003, 0.004, 0.005])));
        assert!(
            found.warnings[0].contains("reach 0.36") && found.warnings[0].contains("Y = 1;"),
            "{:?}",
            found.warnings
        );
        for (fields, row, note) in [
            (
                "XYZ_X XYZ_Y XYZ_Z STDEV_X STDEV_Y",
                "32 34 36 0.3 0.4",
                "STDEV_X, STDEV_Y are not used: those of X, Y, Z",
            ),
            (
                "XYZ_X XYZ_Y XYZ_Z STDEV_L STDEV_A STDEV_B",
                "32 34 36 1 1 1",
                "STDEV_L, STDEV_A, STDEV_B are not used",
            ),
            ("LAB_L LAB_A LAB_B STDEV_DE", "65 1 2 0.3", "STDEV_DE is not used: those of L*, a*, b*"),
            (
                "XYZ_X XYZ_Y XYZ_Z STDEV_X STDEV_Y STDEV_Z SPEC_400 SPEC_500",
                "32 34 36 1 1 1 0.3 0.4",
                "STDEV_X, STDEV_Y, STDEV_Z are not used: the spectra are read",
            ),
        ] {
            let found = read(&file(fields, row)).unwrap();
            assert_eq!(found.value.states[0].standard_deviation, None, "{fields}");
            assert!(found.warnings.iter().any(|one| one.contains(note)), "{fields}: {:?}", found.warnings);
        }
    }

    #[test]
    fn metrics_are_read_by_their_names() {
        let text =
            "metric,theta_deg,value,standard_deviation\nwhite.Y,8,0.4,0.01\ncontrast_ratio,8,12.5,0.3\n";
        let metrics = read(text).unwrap().value.metrics;
        assert_eq!(metrics[0].name(), "white.Y");
        assert_eq!((metrics[1].state.as_deref(), metrics[1].metric), (None, Metric::contrast_ratio));
        assert_eq!((metrics[1].theta_deg, metrics[1].standard_deviation), (Some(8.0), Some(0.3)));
        assert_eq!(
            read("metric,value\ncontrast_ratio,12\n").unwrap().value.metrics[0].standard_deviation,
            None
        );
    }

    #[test]
    fn malformed_measurement_is_an_error_with_its_place() {
        for (text, place, words) in [
            ("metric,value\ncontrast_rato,12\n", (2, 1), "did you mean `contrast_ratio`?"),
            ("metric,value\nhue,12\n", (2, 1), "docs/metric-names.md lists all metrics"),
            ("metric,value\nreading,12\n", (2, 1), "did you mean `reading_surrogate_age_20`"),
            (
                "metric,value\ngamut,12\n",
                (2, 1),
                "more have this word; docs/metric-names.md lists all metrics",
            ),
            ("metric,value\nY,12\n", (2, 1), "write the state before it: `white.Y`"),
            ("metric,value\nwhite.contrast_ratio,12\n", (2, 1), "write it without a state: `contrast_ratio`"),
            ("metric,value\nwhite.Y,x\n", (2, 9), "NotANumber"),
            ("metric,value,standard_deviation\nwhite.Y,1,0\n", (2, 11), "a number above 0"),
            ("metric,value,standard_deviation\nwhite.Y,1,1e-300\n", (2, 11), "from 1e-12 to 1e12"),
            ("state,X,Y,Z,standard_deviation\nw,1,1,1,1e-300\n", (2, 9), "from 1e-9 to 10000"),
            ("metric,value\nwhite.Y,1\nwhite.Y,2\n", (3, 1), "has two values"),
            ("metric,value,colour\nwhite.Y,1,2\n", (1, 14), "`colour` is not understood"),
            (
                "state,wavelength_nm,reflectance_factor,standard_deviation\nw,400,1,-1\nw,500,1,1\n",
                (2, 9),
                "above 0",
            ),
            ("wavelength_nm,a,b,standard_deviation\n400,1,1,1\n500,1,1,1\n", (1, 19), "of which state"),
        ] {
            let error = read(text).unwrap_err();
            assert_eq!(error.place.line_column(), Some(place), "{text:?}: {error}");
            assert!(format!("{error:?}").contains(words), "{text:?}: {error:?}");
        }
    }
}
