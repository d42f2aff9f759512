//! Output of compact sweeps: one row of numbers per point.

use std::io::{self, Write};

use serde::{Serialize, Serializer};
use serde_json::{Map, Value};

use crate::json::write_json;
use crate::sweep::{SweepHead, SweepPoint, sweep_value};
use crate::tolerance::write_table;
use crate::words::text_cell;

/// Writes `sweep.csv` of a compact sweep: for each point the swept keys, then its metrics, empty where
/// undefined. `rows` holds those of all points in order.
///
/// # Errors
/// Those of `out`.
pub fn write_light_csv(out: impl Write, head: &SweepHead, rows: &[&[f64]]) -> io::Result<()> {
    let keys = head.axes.iter().flat_map(|axis| &axis.keys).cloned();
    let metrics = head.light.iter().flat_map(|light| &light.metrics).cloned();
    let columns: Vec<String> = ["point".to_owned()].into_iter().chain(keys).chain(metrics).collect();
    let row = |(point, row): (usize, &&[f64])| {
        let swept = head.swept(point).map(|(_, value)| text_cell(sweep_value(value))).collect::<Vec<_>>();
        [point.to_string()].into_iter().chain(swept).chain(row.iter().map(|value| cell(*value))).collect()
    };
    write_table(out, &columns, rows.iter().enumerate().map(row))
}

/// Formats a number as a cell; empty if it is not finite.
fn cell(value: f64) -> String {
    if value.is_finite() { value.to_string() } else { String::new() }
}

/// Returns the points of a compact sweep as points of an ordinary one, for figures and the terminal: with one
/// row per view, or a single row for the first view if the views differ between points.
pub fn light_points(head: &SweepHead, rows: &[&[f64]]) -> Vec<SweepPoint> {
    let Some(light) = &head.light else { return Vec::new() };
    let several = light.views.len() > 1;
    let views = if several { light.views.clone() } else { vec![[0.0; 2]] };
    let own = if several { light.metrics.len() / views.len() } else { light.metrics.len() };
    let angles = |view: &[f64; 2]| view.iter().filter(|_| several).map(f64::to_string).collect::<Vec<_>>();
    let names = ["theta_deg", "phi_deg"].into_iter().filter(|_| several).map(str::to_owned);
    let columns: Vec<String> = names.chain(light.metrics[..own].iter().cloned()).collect();
    let of_view = |(view, values): (&[f64; 2], &[f64])| {
        angles(view).into_iter().chain(values.iter().map(|value| cell(*value))).collect()
    };
    let point = |(number, row): (usize, &&[f64])| SweepPoint {
        point: Some(number),
        hash: String::new(),
        papilio: head.papilio.clone(),
        warnings: Vec::new(),
        columns: columns.clone(),
        rows: views.iter().zip(row.chunks(own.max(1))).map(of_view).collect(),
    };
    rows.iter().enumerate().map(point).collect()
}

/// Writes a compact sweep as JSON, with the notes on its scenario and its warnings. `rows` holds those of all points in order.
///
/// # Errors
/// Those of `out`.
pub fn write_light_json(
    out: impl Write,
    head: &SweepHead,
    [notes, warnings]: [&[String]; 2],
    rows: &[&[f64]],
) -> io::Result<()> {
    write_json(out, &Whole { head, warnings, notes, points: Points { head, rows } })
}

#[derive(Serialize)]
struct Whole<'a> {
    #[serde(flatten)]
    head: &'a SweepHead,
    warnings: &'a [String],
    notes: &'a [String],
    points: Points<'a>,
}

/// All points, serialised one after the other.
struct Points<'a> {
    head: &'a SweepHead,
    rows: &'a [&'a [f64]],
}

#[derive(Serialize)]
struct Point<'a> {
    point: usize,
    /// Every swept key with its value.
    swept: Map<String, Value>,
    /// Metrics in the order of the head; null where undefined.
    values: &'a [f64],
}

impl<'a> Serialize for Points<'a> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let point = |(point, row): (usize, &&'a [f64])| Point {
            point,
            swept: self.head.swept(point).map(|(key, value)| (key.to_owned(), value.clone())).collect(),
            values: row,
        };
        serializer.collect_seq(self.rows.iter().enumerate().map(point))
    }
}
