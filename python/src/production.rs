//! The production that a scenario's `[tolerance]` describes, row by row, and what is said of it.

use std::collections::BTreeMap;
use std::path::PathBuf;

use numpy::{PyArray1, PyReadonlyArray1};
use papilio_design::tolerance::Report;
use papilio_scenario::Tolerance;
use pyo3::prelude::*;

use crate::errors;
use crate::pool::Pool;
use crate::scenario::library;

/// The displays of a production.
#[pyclass(frozen, module = "papilio._papilio")]
pub(crate) struct Production {
    tolerance: Tolerance,
    of: papilio_design::tolerance::Production,
    pool: Pool,
}

#[pymethods]
impl Production {
    #[new]
    #[pyo3(signature = (text, name, folder, files=None))]
    fn new(
        py: Python<'_>,
        text: &str,
        name: &str,
        folder: PathBuf,
        files: Option<BTreeMap<String, Vec<u8>>>,
    ) -> PyResult<Self> {
        let made = py.detach(|| {
            let tolerance = Tolerance::from_text(text, name, library(folder, files), &[])?;
            let of = papilio_design::tolerance::Production::new(&tolerance);
            of.check(&tolerance)?;
            Ok((tolerance, of))
        });
        let (tolerance, of) = made.map_err(|errors| errors::scenario(py, &errors))?;
        let pool = Pool::new(of.study().clone());
        Ok(Self { tolerance, of, pool })
    }

    /// How many rows there are: displays, and while sensitivities are sought all that go with them.
    #[getter]
    fn rows(&self) -> usize {
        self.of.rows()
    }

    /// How many of them are for sensitivities, too.
    #[getter]
    fn sensitivity_rows(&self) -> usize {
        self.of.sensitivity_rows()
    }

    /// SHA-256 of all that a row's numbers depend on besides its number.
    #[getter]
    fn hash(&self) -> &str {
        &self.tolerance.hash
    }

    #[getter]
    fn title(&self) -> Option<&str> {
        self.tolerance.title.as_deref()
    }

    /// The names of keys and of metrics.
    fn names(&self) -> (Vec<&str>, Vec<&str>) {
        let keys = self.tolerance.keys.iter().map(|key| key.name.as_str());
        (keys.collect(), self.tolerance.metrics.iter().map(|metric| metric.name.as_str()).collect())
    }

    /// How many numbers a row has; its own display's metrics first.
    fn width(&self, row: usize) -> usize {
        self.of.width(row)
    }

    /// What each key of a row's own display is, as JSON.
    fn keys(&self, row: usize) -> String {
        serde_json::Value::from(self.of.values(row)).to_string()
    }

    /// The numbers of rows from `start` to before `stop`, one after the other.
    #[pyo3(signature = (start, stop, threads, progress=None))]
    fn evaluate<'py>(
        &self,
        py: Python<'py>,
        start: usize,
        stop: usize,
        threads: usize,
        progress: Option<Bound<'_, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let stop = stop.min(self.of.rows());
        let count = stop.saturating_sub(start);
        let rows = self.pool.each(py, count, threads, progress.as_ref(), |evaluator, at| {
            self.of.evaluate(evaluator, start + at)
        })?;
        Ok(PyArray1::from_iter(py, rows.into_iter().flatten()))
    }

    /// What is made of all rows, as JSON.
    fn report<'py>(&self, py: Python<'py>, numbers: PyReadonlyArray1<'py, f64>) -> PyResult<String> {
        let mut left = numbers.as_slice().map_err(|error| errors::internal(&error.to_string()))?;
        let mut rows = Vec::with_capacity(self.of.rows());
        for row in 0..self.of.rows() {
            let (own, others) = left
                .split_at_checked(self.of.width(row))
                .ok_or_else(|| errors::internal("numbers of rows are missing"))?;
            rows.push(own);
            left = others;
        }
        let report = py.detach(|| Report::new(&self.tolerance, &self.of, &rows));
        serde_json::to_string(&report).map_err(|error| errors::internal(&error.to_string()))
    }
}
