//! The program `papilio`, as the command of the wheel.

use std::ffi::OsString;

use pyo3::prelude::*;

exports! { functions program; }

/// Runs the program with its arguments, the first of which is its own name; returns the exit code.
#[pyfunction]
pub(crate) fn program(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| papilio_cli::main(&arguments))
}
