//! The tolerance analysis that a scenario's `[tolerance]` describes: rows of samples, report, figures and tables.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::{Mutex, MutexGuard, PoisonError};

use numpy::{PyArray1, PyReadonlyArray1};
use papilio_design::output::{tolerance_figures, tolerance_tables};
use papilio_design::tolerance::Report;
use papilio_formats::{FormatError, JournalRows, ToleranceHead};
use papilio_scenario::Tolerance;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::errors;
use crate::pool::Pool;
use crate::scenario::library;
use crate::watch::detached;

exports! { classes Production; }

/// The displays of a tolerance analysis, and the rows computed so far.
#[pyclass(frozen, module = "papilio._papilio")]
pub(crate) struct Production {
    tolerance: Tolerance,
    of: papilio_design::tolerance::Production,
    pool: Pool,
    known: Mutex<Known>,
}

/// Completed rows, in memory or in a journal.
enum Known {
    Memory(BTreeMap<usize, Vec<f64>>),
    Journal(JournalRows<ToleranceHead>),
}

impl Known {
    fn get(&self, row: usize) -> Option<&[f64]> {
        match self {
            Self::Memory(rows) => rows.get(&row).map(Vec::as_slice),
            Self::Journal(rows) => rows.get(row),
        }
    }

    fn add(&mut self, row: usize, values: Vec<f64>) -> Result<(), FormatError> {
        match self {
            Self::Memory(rows) => drop(rows.insert(row, values)),
            Self::Journal(rows) => rows.add(row, values)?,
        }
        Ok(())
    }
}

#[pymethods]
impl Production {
    #[new]
    #[pyo3(signature = (text, name, folder, files=None))]
    fn new(
        py: Python<'_>,
        text: &str,
        name: &str,
        folder: Option<PathBuf>,
        files: Option<BTreeMap<String, Vec<u8>>>,
    ) -> PyResult<Self> {
        let made = detached(py, || {
            let tolerance = Tolerance::from_text(text, name, library(folder, files), &[])?;
            let of = papilio_design::tolerance::Production::new(&tolerance);
            of.check(&tolerance)?;
            Ok((tolerance, of))
        })?;
        let (tolerance, of) = made.map_err(|errors| errors::scenario(py, &errors))?;
        let pool = Pool::new(of.study().clone());
        Ok(Self { tolerance, of, pool, known: Mutex::new(Known::Memory(BTreeMap::new())) })
    }

    /// Number of rows: displays, each with the displays of its sensitivity sample.
    #[getter]
    fn rows(&self) -> usize {
        self.of.rows()
    }

    /// Number of rows that have a sensitivity sample.
    #[getter]
    fn sensitivity_rows(&self) -> usize {
        self.of.sensitivity_rows()
    }

    /// SHA-256 of all inputs of the rows except their index.
    #[getter]
    fn hash(&self) -> &str {
        &self.tolerance.hash
    }

    #[getter]
    fn title(&self) -> Option<&str> {
        self.tolerance.title.as_deref()
    }

    /// Names of keys and of metrics.
    fn names(&self) -> (Vec<&str>, Vec<&str>) {
        let keys = self.tolerance.keys.iter().map(|key| key.name.as_str());
        (keys.collect(), self.tolerance.metrics.iter().map(|metric| metric.name.as_str()).collect())
    }

    /// Number of values of a row; the metrics of its own display are the first.
    fn width(&self, row: usize) -> usize {
        self.of.width(row)
    }

    /// Values of the keys of a row's own display, as JSON.
    fn keys(&self, row: usize) -> String {
        serde_json::Value::from(self.of.values(row)).to_string()
    }

    /// Computes the values of the rows `start..stop`, concatenated.
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

    /// Opens the journal in a folder, or creates it.
    fn open(&self, py: Python<'_>, folder: PathBuf) -> PyResult<()> {
        let head = ToleranceHead {
            papilio: env!("CARGO_PKG_VERSION").to_owned(),
            hash: self.tolerance.hash.clone(),
            metrics: self.tolerance.metrics.iter().map(|metric| metric.name.clone()).collect(),
        };
        let opened = py.detach(|| JournalRows::open(&folder, "tolerance", None, head, &[]));
        *self.known() = Known::Journal(opened.map_err(|error| errors::format(py, &error))?);
        Ok(())
    }

    /// Rows that are not yet computed.
    fn missing(&self) -> Vec<usize> {
        let known = self.known();
        let is_known =
            |row: &usize| known.get(*row).is_some_and(|values| values.len() >= self.of.width(*row));
        (0..self.of.rows()).filter(|row| !is_known(row)).collect()
    }

    /// Computes rows; an error has the index within `rows`.
    #[pyo3(signature = (rows, threads, progress=None))]
    fn compute(
        &self,
        py: Python<'_>,
        rows: Vec<usize>,
        threads: usize,
        progress: Option<Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        if rows.iter().any(|row| *row >= self.of.rows()) {
            return Err(errors::internal("row index out of range"));
        }
        let journal_error: Mutex<Option<FormatError>> = Mutex::new(None);
        self.pool.each(py, rows.len(), threads, progress.as_ref(), |evaluator, at| {
            let values = self.of.evaluate(evaluator, rows[at])?;
            if let Err(error) = self.known().add(rows[at], values) {
                journal_error.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
            }
            Ok(())
        })?;
        let journal_error = journal_error.into_inner().unwrap_or_else(PoisonError::into_inner);
        journal_error.map_or(Ok(()), |error| Err(errors::format(py, &error)))
    }

    /// Stores the values of a row; further values after these are ignored.
    fn take(&self, py: Python<'_>, row: usize, numbers: PyReadonlyArray1<'_, f64>) -> PyResult<()> {
        let all = numbers.as_slice().map_err(|error| errors::internal(&error.to_string()))?;
        let own =
            all.get(..self.of.width(row)).ok_or_else(|| errors::internal("values of a row are missing"))?;
        self.known().add(row, own.to_vec()).map_err(|error| errors::format(py, &error))
    }

    /// Values of all rows, concatenated, when all are computed. Sorts and closes the journal.
    fn finish<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let rows = 0..self.of.rows();
        if let Known::Journal(journal) = &mut *self.known() {
            journal.finish(rows.clone()).map_err(|error| errors::format(py, &error))?;
        }
        let mut numbers = Vec::new();
        for row in rows {
            let known = self.known();
            let own = known.get(row).and_then(|values| values.get(..self.of.width(row)));
            numbers.extend(own.ok_or_else(|| errors::internal("a row is missing"))?);
        }
        self.close();
        Ok(PyArray1::from_vec(py, numbers))
    }

    /// Closes the journal.
    fn close(&self) {
        *self.known() = Known::Memory(BTreeMap::new());
    }

    /// The report of all rows, as JSON.
    fn report<'py>(&self, py: Python<'py>, numbers: PyReadonlyArray1<'py, f64>) -> PyResult<String> {
        let rows = self.cut(&numbers)?;
        let report = py.detach(|| Report::new(&self.tolerance, &self.of, &rows));
        serde_json::to_string(&report).map_err(|error| errors::internal(&error.to_string()))
    }

    /// Names and SVG texts of the figures of `papilio tolerance`.
    fn figures<'py>(
        &self,
        py: Python<'py>,
        title: &str,
        numbers: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Vec<(String, String)>> {
        let rows = self.cut(&numbers)?;
        Ok(py.detach(|| {
            let report = Report::new(&self.tolerance, &self.of, &rows);
            tolerance_figures(title, &self.tolerance, &self.of, &rows, &report)
        }))
    }

    /// Names and bytes of the tables of `papilio tolerance`.
    fn tables<'py>(
        &self,
        py: Python<'py>,
        numbers: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Vec<(&'static str, Bound<'py, PyBytes>)>> {
        let rows = self.cut(&numbers)?;
        let tables = py.detach(|| {
            let report = Report::new(&self.tolerance, &self.of, &rows);
            tolerance_tables(&self.tolerance, &self.of, &rows, &report)
        });
        let tables = tables.map_err(|error| errors::internal(&error.to_string()))?;
        Ok(tables.into_iter().map(|(name, bytes)| (name, PyBytes::new(py, &bytes))).collect())
    }
}

impl Production {
    /// Splits the values of all rows into rows.
    fn cut<'a>(&self, numbers: &'a PyReadonlyArray1<'_, f64>) -> PyResult<Vec<&'a [f64]>> {
        let mut left = numbers.as_slice().map_err(|error| errors::internal(&error.to_string()))?;
        let mut rows = Vec::with_capacity(self.of.rows());
        for row in 0..self.of.rows() {
            let (own, others) = left
                .split_at_checked(self.of.width(row))
                .ok_or_else(|| errors::internal("values of rows are missing"))?;
            rows.push(own);
            left = others;
        }
        Ok(rows)
    }

    fn known(&self) -> MutexGuard<'_, Known> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
