//! In place of `sweep_parquet`, where the feature `parquet` is off: it says so.

use crate::NO_PARQUET;
use crate::sweep::{SweepHead, SweepPoint};

/// An error that says how to get it.
///
/// # Errors
/// Always.
pub fn sweep_parquet(_: &SweepHead, _: &[&SweepPoint]) -> Result<Vec<u8>, std::io::Error> {
    Err(std::io::Error::other(NO_PARQUET))
}

/// An error that says how to get it.
///
/// # Errors
/// Always.
pub fn light_parquet(_: &SweepHead, _: &[&[f64]]) -> Result<Vec<u8>, std::io::Error> {
    Err(std::io::Error::other(NO_PARQUET))
}
