//! Tests of what the project gives to others: packages, their pages, versions, workflows.

#![allow(
    clippy::panic,
    clippy::unwrap_used,
    reason = "helpers of tests, too, say what they expect by unwrapping"
)]

mod manifests;
mod packages;
mod project;
mod readmes;
mod versions;
mod workflows;

use std::fs;
use std::path::Path;

/// Root of the repository.
fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap()
}

/// Text of a file of the repository.
fn read(path: &str) -> String {
    fs::read_to_string(root().join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}
