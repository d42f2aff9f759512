//! Finished sweeps as JSON: the output of `papilio sweep --json`.

use std::io::{self, Write};

use serde::Serialize;
use serde_json::{Map, Value};

use crate::json::write_json;
use crate::sweep::{SweepHead, SweepPoint};

/// Description of the sweep and all points in order.
#[derive(Serialize)]
struct Whole<'a> {
    #[serde(flatten)]
    head: &'a SweepHead,
    notes: &'a [String],
    points: Vec<Point<'a>>,
}

#[derive(Serialize)]
struct Point<'a> {
    point: usize,
    hash: &'a str,
    /// Every swept key with its value.
    swept: Map<String, Value>,
    warnings: &'a [String],
    /// One entry per view and state, with the column titles of `states.csv` as keys.
    rows: Vec<Map<String, Value>>,
}

/// Writes a sweep as JSON, with the notes on its scenario. `points` holds all points in order.
///
/// # Errors
/// Those of `out`.
pub fn write_sweep_json(
    out: impl Write,
    head: &SweepHead,
    notes: &[String],
    points: &[&SweepPoint],
) -> io::Result<()> {
    let points = points.iter().enumerate().map(|(number, point)| Point {
        point: number,
        hash: &point.hash,
        swept: head.swept(number).map(|(key, value)| (key.to_owned(), value.clone())).collect(),
        warnings: &point.warnings,
        rows: point.rows.iter().map(|row| named(&point.columns, row)).collect(),
    });
    write_json(out, &Whole { head, notes, points: points.collect() })
}

fn named(columns: &[String], row: &[String]) -> Map<String, Value> {
    columns.iter().zip(row).map(|(name, cell)| (name.clone(), value(name, cell))).collect()
}

/// Returns a cell as a JSON value: numbers as numbers, undefined values as null, names of states as strings.
fn value(name: &str, cell: &str) -> Value {
    if name == "state" {
        return Value::from(cell);
    }
    cell.parse::<f64>().map_or(Value::Null, Value::from)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sweep::tests::{head, point};

    #[test]
    fn sweep_written_as_json_reads_back() {
        let mut points: Vec<SweepPoint> = (0..6).map(point).collect();
        points[1].rows[0][1].clear();
        let refs: Vec<&SweepPoint> = points.iter().collect();
        let mut text = Vec::new();
        write_sweep_json(&mut text, &head(), &["a note".to_owned()], &refs).unwrap();
        let read: Value = serde_json::from_slice(&text).unwrap();
        assert_eq!(read["notes"][0], "a note");
        assert_eq!(read["axes"][1]["keys"][0], "b");
        assert_eq!(read["points"][4]["swept"]["b"], 0.2);
        assert_eq!(read["points"][0]["rows"][1]["state"], "black");
        assert_eq!(read["points"][0]["rows"][1]["Y"], 0.05);
        assert!(read["points"][1]["rows"][0]["Y"].is_null());
    }
}
