//! Exact reading of numbers from journals.
//!
//! The parser of `serde_json` alone may be off by one in the last bit.

use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::value::RawValue;

fn number(raw: &RawValue) -> Result<Option<f64>, String> {
    match raw.get() {
        "null" => Ok(None),
        text => text.parse().map(Some).map_err(|_| format!("{text} is not a number")),
    }
}

fn row(raw: &[Box<RawValue>]) -> Result<Vec<Option<f64>>, String> {
    raw.iter().map(|raw| number(raw)).collect()
}

/// Numbers, some of which may be missing (null).
pub(crate) mod values {
    use super::*;

    pub(crate) fn serialize<S: Serializer>(values: &[Option<f64>], to: S) -> Result<S::Ok, S::Error> {
        values.serialize(to)
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<Option<f64>>, D::Error> {
        row(&Vec::<Box<RawValue>>::deserialize(from)?).map_err(D::Error::custom)
    }
}

/// Numbers, none of which may be missing.
pub(crate) mod numbers {
    use super::*;

    pub(crate) fn serialize<S: Serializer>(numbers: &[f64], to: S) -> Result<S::Ok, S::Error> {
        numbers.serialize(to)
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<f64>, D::Error> {
        let numbers: Option<Vec<f64>> = values::deserialize(from)?.into_iter().collect();
        numbers.ok_or_else(|| D::Error::custom("a number is missing"))
    }
}

/// Rows of numbers, some of which may be missing (null).
pub(crate) mod rows {
    use super::*;

    pub(crate) fn serialize<S: Serializer>(rows: &[Vec<Option<f64>>], to: S) -> Result<S::Ok, S::Error> {
        rows.serialize(to)
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<Vec<Option<f64>>>, D::Error> {
        let rows = Vec::<Vec<Box<RawValue>>>::deserialize(from)?;
        rows.iter().map(|raw| row(raw).map_err(D::Error::custom)).collect()
    }
}

/// Rows of numbers, none of which may be missing.
pub(crate) mod rows_of_numbers {
    use super::*;

    pub(crate) fn serialize<S: Serializer>(rows: &[Vec<f64>], to: S) -> Result<S::Ok, S::Error> {
        rows.serialize(to)
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<Vec<f64>>, D::Error> {
        let rows = rows::deserialize(from)?.into_iter().map(|row| row.into_iter().collect());
        rows.collect::<Option<_>>().ok_or_else(|| D::Error::custom("a number is missing"))
    }
}
