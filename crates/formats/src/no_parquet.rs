//! Replacement of `sweep_parquet` in builds without the feature `parquet`: every function returns an error.

use crate::NO_PARQUET;
use crate::sweep::{SweepHead, SweepPoint};

/// Returns an error that explains how to build with Parquet.
///
/// # Errors
/// Always.
pub fn sweep_parquet(_: &SweepHead, _: &[&SweepPoint]) -> Result<Vec<u8>, std::io::Error> {
    Err(std::io::Error::other(NO_PARQUET))
}

/// Returns an error that explains how to build with Parquet.
///
/// # Errors
/// Always.
pub fn light_parquet(_: &SweepHead, _: &[&[f64]]) -> Result<Vec<u8>, std::io::Error> {
    Err(std::io::Error::other(NO_PARQUET))
}
