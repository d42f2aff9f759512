//! `sweep.parquet`: the content of `sweep.csv` in typed columns.
//!
//! Apache Parquet with one row group, not compressed. `point` is a 64-bit integer, `state` a string. A swept
//! key is a double if all its values are numbers, otherwise a string. Every other column is a double, null
//! where the CSV is empty.

use std::sync::Arc;

use parquet::basic::{LogicalType, Repetition, Type as PhysicalType};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;
use serde_json::Value;

use crate::sweep::{SweepHead, SweepPoint, columns, sweep_place, sweep_value};

/// Values of a column.
enum Column {
    Integers(Vec<i64>),
    Numbers(Vec<Option<f64>>),
    Texts(Vec<String>),
}

/// Returns the bytes of `sweep.parquet`. `points` holds all points in order.
///
/// # Errors
/// If the format cannot represent the table, for example one with two columns of the same name.
pub fn sweep_parquet(head: &SweepHead, points: &[&SweepPoint]) -> Result<Vec<u8>, std::io::Error> {
    let table = table(head, points);
    written(&table).map_err(std::io::Error::other)
}

/// Returns the bytes of `sweep.parquet` of a compact sweep. `rows` holds those of all points in order.
///
/// # Errors
/// As [`sweep_parquet`].
pub fn light_parquet(head: &SweepHead, rows: &[&[f64]]) -> Result<Vec<u8>, std::io::Error> {
    let all: Vec<usize> = (0..rows.len()).collect();
    let mut table = swept_columns(head, &all);
    for (k, name) in head.light.iter().flat_map(|light| &light.metrics).enumerate() {
        let values = rows.iter().map(|row| row.get(k).copied().filter(|value| value.is_finite()));
        table.push((name.clone(), Column::Numbers(values.collect())));
    }
    written(&table).map_err(std::io::Error::other)
}

/// Returns the columns of the point numbers and of the swept keys.
fn swept_columns(head: &SweepHead, points: &[usize]) -> Vec<(String, Column)> {
    let numbers = points.iter().map(|point| *point as i64).collect();
    let mut table = vec![("point".to_owned(), Column::Integers(numbers))];
    let lengths: Vec<usize> = head.axes.iter().map(|axis| axis.values.len()).collect();
    for (on, axis) in head.axes.iter().enumerate() {
        for (k, key) in axis.keys.iter().enumerate() {
            let of = |point: &usize| axis.values[sweep_place(&lengths, *point)[on]].get(k);
            let column = if axis.values.iter().all(|values| values.get(k).is_some_and(Value::is_number)) {
                Column::Numbers(points.iter().map(|point| of(point).and_then(Value::as_f64)).collect())
            } else {
                Column::Texts(
                    points.iter().map(|point| of(point).map_or(String::new(), sweep_value)).collect(),
                )
            };
            table.push((key.clone(), column));
        }
    }
    table
}

/// Returns the columns of `sweep.csv`.
fn table(head: &SweepHead, points: &[&SweepPoint]) -> Vec<(String, Column)> {
    let rows = || {
        points.iter().enumerate().flat_map(|(k, point)| point.rows.iter().map(move |row| (k, *point, row)))
    };
    let all: Vec<usize> = rows().map(|(k, ..)| k).collect();
    let mut table = swept_columns(head, &all);
    for name in columns(points) {
        let cells = rows().map(|(_, point, row)| {
            let at = point.columns.iter().position(|own| own == name);
            at.and_then(|at| row.get(at)).map_or("", String::as_str)
        });
        let column = if name == "state" {
            Column::Texts(cells.map(str::to_owned).collect())
        } else {
            Column::Numbers(cells.map(|cell| cell.parse().ok()).collect())
        };
        table.push((name.to_owned(), column));
    }
    table
}

fn written(table: &[(String, Column)]) -> Result<Vec<u8>, ParquetError> {
    let fields: Result<Vec<_>, _> =
        table.iter().map(|(name, column)| column.field(name).map(Arc::new)).collect();
    let schema = Type::group_type_builder("sweep").with_fields(fields?).build()?;
    let properties = Arc::new(WriterProperties::builder().build());
    let mut writer = SerializedFileWriter::new(Vec::new(), Arc::new(schema), properties)?;
    let mut group = writer.next_row_group()?;
    for (_, column) in table {
        let Some(mut out) = group.next_column()? else { break };
        match column {
            Column::Integers(values) => {
                out.typed::<Int64Type>().write_batch(values, None, None)?;
            }
            Column::Texts(values) => {
                let values: Vec<ByteArray> = values.iter().map(|text| text.as_str().into()).collect();
                out.typed::<ByteArrayType>().write_batch(&values, None, None)?;
            }
            Column::Numbers(values) => {
                let present: Vec<f64> = values.iter().copied().flatten().collect();
                let levels: Vec<i16> = values.iter().map(|value| i16::from(value.is_some())).collect();
                out.typed::<DoubleType>().write_batch(&present, Some(&levels), None)?;
            }
        }
        out.close()?;
    }
    group.close()?;
    writer.into_inner()
}

impl Column {
    fn field(&self, name: &str) -> Result<Type, ParquetError> {
        let (kind, logical, repetition) = match self {
            Self::Integers(_) => (PhysicalType::INT64, None, Repetition::REQUIRED),
            Self::Numbers(_) => (PhysicalType::DOUBLE, None, Repetition::OPTIONAL),
            Self::Texts(_) => (PhysicalType::BYTE_ARRAY, Some(LogicalType::String), Repetition::REQUIRED),
        };
        Type::primitive_type_builder(name, kind)
            .with_repetition(repetition)
            .with_logical_type(logical)
            .build()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sweep::tests::{head, point};
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::{Field, RowAccessor};

    /// An independent reader returns the content of the journal.
    #[test]
    fn sweep_written_as_parquet_reads_back() {
        let points: Vec<SweepPoint> = (0..6).map(point).collect();
        let refs: Vec<&SweepPoint> = points.iter().collect();
        let bytes = sweep_parquet(&head(), &refs).unwrap();
        let path = tempfile::tempdir().unwrap();
        let file = path.path().join("s.parquet");
        std::fs::write(&file, bytes).unwrap();
        let reader = SerializedFileReader::new(std::fs::File::open(&file).unwrap()).unwrap();
        let rows: Vec<_> = reader.get_row_iter(None).unwrap().map(Result::unwrap).collect();
        assert_eq!(rows.len(), 12);
        let last = &rows[11];
        let names: Vec<&str> = last.get_column_iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["point", "a", "b", "state", "Y", "contrast_ratio"]);
        assert_eq!(
            (last.get_long(0).unwrap(), last.get_double(1).unwrap(), last.get_double(2).unwrap()),
            (5, 2.0, 0.3)
        );
        assert_eq!((last.get_string(3).unwrap().as_str(), last.get_double(4).unwrap()), ("black", 0.05));
        assert!(matches!(rows[0].get_column_iter().nth(5).unwrap().1, Field::Double(_)));
    }
}
