//! Journal (`sweep.jsonl`) and table (`sweep.csv`) of a sweep.
//!
//! The journal holds one JSON value per line: first a description of the sweep ([`SweepHead`]), then each
//! finished point ([`SweepPoint`]). A point is identified by the hash of its scenario and input files, so
//! that the journal is also valid for a sweep that has been edited.

use std::io::{self, Write};

use papilio_display::result::RunResult;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::journal::Journal;
use crate::result::state_table;
use crate::words::text_cell;

/// Description of a sweep: the first line of its journal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SweepHead {
    /// Version of the program.
    pub papilio: String,
    /// Title of the scenario.
    pub title: Option<String>,
    /// The axes, the slowest first.
    pub axes: Vec<SweepHeadAxis>,
    /// Metrics of the figures.
    pub figures: Vec<String>,
    /// For a compact sweep, the quantities that it saves and the hash of its inputs; `None` for an ordinary
    /// sweep, which saves all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub light: Option<LightHead>,
}

/// The quantities that a compact sweep saves.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LightHead {
    /// Metrics, in the order of the numbers of a row: those of the first view precede those of the others.
    pub metrics: Vec<String>,
    /// Angles theta and phi of the views, degrees; empty if they differ between points.
    #[serde(default)]
    pub views: Vec<[f64; 2]>,
    /// SHA-256 of the scenario, all input files and the swept values.
    pub hash: String,
}

/// An axis: keys that vary together.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SweepHeadAxis {
    /// Dotted paths.
    pub keys: Vec<String>,
    /// Values, `[point][key]`.
    pub values: Vec<Vec<Value>>,
}

/// A finished point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SweepPoint {
    /// Index in the sweep of the journal's head; `None` in journals of an earlier format.
    pub point: Option<usize>,
    /// SHA-256 of its scenario and input files.
    pub hash: String,
    /// Version of the program that computed it.
    pub papilio: String,
    /// Warnings of the run.
    pub warnings: Vec<String>,
    /// Column titles, as in `states.csv`.
    pub columns: Vec<String>,
    /// Rows, one per view and state: the cells as they are written.
    pub rows: Vec<Vec<String>>,
}

impl SweepHead {
    /// Returns the number of points.
    pub fn points(&self) -> usize {
        self.axes.iter().map(|axis| axis.values.len()).product()
    }

    /// Returns every key with its value at a point.
    pub fn swept(&self, point: usize) -> impl Iterator<Item = (&str, &Value)> {
        let lengths: Vec<usize> = self.axes.iter().map(|axis| axis.values.len()).collect();
        let at = self.axes.iter().zip(sweep_place(&lengths, point));
        at.flat_map(|(axis, at)| {
            axis.keys.iter().map(String::as_str).zip(axis.values.get(at).into_iter().flatten())
        })
    }
}

/// Returns the index of a point on each axis, given the lengths of the axes. The last axis varies fastest.
pub fn sweep_place(lengths: &[usize], point: usize) -> Vec<usize> {
    let mut rest = point;
    let on = |length: &usize| {
        let at = rest % length.max(&1);
        rest /= length.max(&1);
        at
    };
    let mut place: Vec<usize> = lengths.iter().rev().map(on).collect();
    place.reverse();
    place
}

impl SweepPoint {
    /// Creates the record of a point from its result.
    pub fn new(point: usize, hash: String, papilio: &str, result: &RunResult) -> Self {
        let table = state_table(result);
        let warnings = result.warnings.clone();
        Self {
            point: Some(point),
            hash,
            papilio: papilio.to_owned(),
            warnings,
            columns: table.0,
            rows: table.1,
        }
    }

    /// Returns the names of the point's metrics: each column of numbers, and each column of a state, such as
    /// `white.Y`.
    pub fn metrics(&self) -> Vec<String> {
        const PLACES: [&str; 3] = ["theta_deg", "phi_deg", "state"];
        let columns = || self.columns.iter().filter(|name| !PLACES.contains(&name.as_str()));
        let mut states: Vec<&str> = Vec::new();
        for row in &self.rows {
            if let Some(state) = self.cell(row, "state").filter(|state| !states.contains(state)) {
                states.push(state);
            }
        }
        let of_states = states.iter().flat_map(|state| columns().map(move |name| format!("{state}.{name}")));
        columns().cloned().chain(of_states).collect()
    }

    /// Returns inclination and azimuth of each view, as they are written.
    pub fn views(&self) -> Vec<[&str; 2]> {
        let mut views = Vec::new();
        for row in &self.rows {
            let view = self.view(row);
            if views.last() != Some(&view) {
                views.push(view);
            }
        }
        views
    }

    /// Returns one of the [`metrics`](Self::metrics) at one of the [`views`](Self::views), if it is defined.
    pub fn metric(&self, view: [&str; 2], name: &str) -> Option<f64> {
        // In a compact sweep, metrics of states are columns of their own.
        let of_state = name.split_once('.').filter(|_| !self.columns.iter().any(|own| own == name));
        let (state, column) = of_state.map_or((None, name), |(state, column)| (Some(state), column));
        let is_it = |row: &&Vec<String>| {
            self.view(row) == view && state.is_none_or(|state| self.cell(row, "state") == Some(state))
        };
        self.cell(self.rows.iter().find(is_it)?, column)?.parse().ok()
    }

    /// Returns whether the point has rows of this state.
    pub(crate) fn has_state(&self, state: &str) -> bool {
        self.rows.iter().any(|row| self.cell(row, "state") == Some(state))
    }

    /// Returns the cell of one of the [`metrics`](Self::metrics) at one of the [`views`](Self::views).
    pub(crate) fn cell_of(&self, view: [&str; 2], name: &str) -> Option<&str> {
        let of_state = name.rsplit_once('.').filter(|(state, _)| self.has_state(state));
        let (state, column) = of_state.map_or((None, name), |(state, column)| (Some(state), column));
        let is_it = |row: &&Vec<String>| {
            self.view(row) == view && state.is_none_or(|state| self.cell(row, "state") == Some(state))
        };
        self.cell(self.rows.iter().find(is_it)?, column)
    }

    fn view<'a>(&self, row: &'a [String]) -> [&'a str; 2] {
        ["theta_deg", "phi_deg"].map(|name| self.cell(row, name).unwrap_or_default())
    }

    pub(crate) fn cell<'a>(&self, row: &'a [String], column: &str) -> Option<&'a str> {
        let at = self.columns.iter().position(|name| name == column)?;
        row.get(at).map(String::as_str)
    }
}

/// Content of a sweep's journal.
pub type SweepJournal = Journal<SweepHead, SweepPoint>;

/// Writes `sweep.csv`: one row per point, view and state, with the swept keys followed by the columns of
/// `states.csv`. `points` holds all points in order. Columns that a point does not have are empty in its
/// rows.
///
/// # Errors
/// Those of `out`.
pub fn write_sweep_csv(out: impl Write, head: &SweepHead, points: &[&SweepPoint]) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(out);
    let columns = columns(points);
    let keys = head.axes.iter().flat_map(|axis| &axis.keys).map(String::as_str);
    csv.write_record(["point"].into_iter().chain(keys).chain(columns.iter().copied()))?;
    for (number, point) in points.iter().enumerate() {
        let places: Vec<Option<usize>> =
            columns.iter().map(|name| point.columns.iter().position(|own| own == name)).collect();
        let start: Vec<String> = std::iter::once(number.to_string())
            .chain(head.swept(number).map(|(_, value)| text_cell(sweep_value(value))))
            .collect();
        for row in &point.rows {
            let cells = places.iter().map(|at| at.and_then(|at| row.get(at)).map_or("", String::as_str));
            csv.write_record(start.iter().map(String::as_str).chain(cells))?;
        }
    }
    csv.flush()
}

/// Returns the columns of all points, in the order of their first occurrence.
pub(crate) fn columns<'a>(points: &[&'a SweepPoint]) -> Vec<&'a str> {
    let mut columns: Vec<&str> = Vec::new();
    for point in points {
        // In most sweeps, all points have the same columns.
        if !point.columns.iter().map(String::as_str).eq(columns.iter().copied()) {
            for name in &point.columns {
                if !columns.contains(&name.as_str()) {
                    columns.push(name);
                }
            }
        }
    }
    columns
}

/// Returns a swept value as a cell: a string unchanged, everything else as JSON.
pub fn sweep_value(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Number(number) => {
            number.as_f64().map_or_else(|| number.to_string(), |number| number.to_string())
        }
        other => other.to_string(),
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::{DataFile, read_journal, write_journal_line};
    use serde_json::json;

    pub(crate) fn head() -> SweepHead {
        let axis = |key: &str, values: &[f64]| SweepHeadAxis {
            keys: vec![key.to_owned()],
            values: values.iter().map(|value| vec![json!(value)]).collect(),
        };
        SweepHead {
            papilio: "1".to_owned(),
            title: None,
            axes: vec![axis("a", &[1.0, 2.0]), axis("b", &[0.1, 0.2, 0.3])],
            figures: vec![],
            light: None,
        }
    }

    pub(crate) fn point(number: usize) -> SweepPoint {
        SweepPoint {
            point: Some(number),
            hash: number.to_string(),
            papilio: "1".to_owned(),
            warnings: vec![],
            columns: ["state", "Y", "contrast_ratio"].map(str::to_owned).to_vec(),
            rows: [["white", "0.5", "10"], ["black", "0.05", "10"]]
                .map(|row| row.map(str::to_owned).to_vec())
                .to_vec(),
        }
    }

    /// Wherever a journal is cut off, all complete lines are read, and their length is known.
    #[test]
    fn journal_cut_off_anywhere_keeps_its_complete_lines() {
        let mut bytes = Vec::new();
        write_journal_line(&mut bytes, &head()).unwrap();
        (0..3).for_each(|number| write_journal_line(&mut bytes, &point(number)).unwrap());
        let ends: Vec<usize> = (0..bytes.len()).filter(|at| bytes[*at] == b'\n').map(|at| at + 1).collect();
        for length in 0..=bytes.len() {
            let file = DataFile { name: "j".to_owned(), bytes: bytes[..length].to_vec() };
            let journal: SweepJournal = read_journal(&file, |_| true).unwrap();
            let whole = ends.iter().filter(|end| **end <= length).count();
            assert_eq!(usize::from(journal.head.is_some()) + journal.lines.len(), whole);
            assert_eq!(journal.whole, ends[..whole].last().copied().unwrap_or(0));
        }
    }

    #[test]
    fn malformed_line_is_an_error_with_its_line_number() {
        let mut bytes = Vec::new();
        write_journal_line(&mut bytes, &head()).unwrap();
        bytes.extend(b"{\"point\": 1}\n");
        let error =
            read_journal::<SweepHead, SweepPoint>(&DataFile { name: "j".to_owned(), bytes }, |_| true)
                .unwrap_err();
        assert_eq!(error.place.line_column().map(|at| at.0), Some(2));
    }

    #[test]
    fn last_axis_of_a_sweep_varies_fastest() {
        let swept: Vec<String> = head().swept(4).map(|(key, value)| format!("{key}={value}")).collect();
        assert_eq!(swept, ["a=2.0", "b=0.2"]);
        assert_eq!(head().points(), 6);
    }

    #[test]
    fn metric_of_a_point_is_found_by_name_and_view() {
        let point = point(0);
        let [view] = point.views()[..] else { panic!("one view") };
        assert_eq!(point.metric(view, "contrast_ratio"), Some(10.0));
        assert_eq!(point.metric(view, "black.Y"), Some(0.05));
        assert_eq!(point.metric(view, "red.Y"), None);
        assert_eq!(point.metric(["8", "0"], "black.Y"), None);
        assert!(point.metrics().contains(&"white.Y".to_owned()));
    }

    #[test]
    fn column_that_a_point_lacks_is_empty() {
        let mut other = point(1);
        other.columns[1] = "Z".to_owned();
        let points: Vec<SweepPoint> = [point(0), other].into_iter().collect();
        let mut text = Vec::new();
        let refs: Vec<&SweepPoint> = points.iter().collect();
        write_sweep_csv(&mut text, &head(), &refs).unwrap();
        let text = String::from_utf8(text).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], "point,a,b,state,Y,contrast_ratio,Z");
        assert_eq!(lines[1], "0,1,0.1,white,0.5,10,");
        assert_eq!(lines[3], "1,1,0.2,white,,10,0.5");
    }
}
