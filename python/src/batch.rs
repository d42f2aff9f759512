//! Evaluation of many designs of one display in one call. Any keys of a scenario can vary.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use numpy::{PyArray1, PyReadonlyArray1};
use papilio_design::search::was_stopped;
use papilio_design::{Condition, Key, NamedQuantity, Quantity, Study, Values, Variable};
use papilio_display::pixel::state_names;
use papilio_display::scene::{Metric, Scene};
use papilio_scenario::ParameterisedScenario;
use pyo3::prelude::*;

use crate::errors;
use crate::pool::{Pool, is_of_a_path, reason};
use crate::scenario::{Resolved, library};
use crate::watch::detached;

exports! { classes Batch; functions metric_names; }

/// A display, its varying keys, and the metrics that are requested of each design.
#[pyclass(frozen, module = "papilio._papilio")]
pub(crate) struct Batch {
    variables: usize,
    metrics: usize,
    pool: Pool,
}

#[pymethods]
impl Batch {
    /// `variables`: the keys of each variable, and its choices as JSON if it has any; `metrics`: names such as "white.Y", or
    /// "white.reflectance_factor" for a number at each wavelength. Every metric is computed in each of the `views`, the metrics of a
    /// view together.
    #[new]
    #[pyo3(signature = (like, text, name, folder, files, variables, metrics, views))]
    #[allow(clippy::too_many_arguments, reason = "all parts of a display and a request")]
    fn new(
        py: Python<'_>,
        like: &Resolved,
        text: &str,
        name: &str,
        folder: Option<PathBuf>,
        files: Option<BTreeMap<String, Vec<u8>>>,
        variables: Vec<(Vec<String>, Option<String>)>,
        metrics: Vec<String>,
        views: Vec<usize>,
    ) -> PyResult<Self> {
        let paths: Vec<String> = variables.iter().flat_map(|(keys, _)| keys.clone()).collect();
        let read = || ParameterisedScenario::from_text(text, name, library(folder, files), &[], &paths);
        let varied = detached(py, read)?;
        let varied = varied.map_err(|errors| errors::scenario(py, &errors))?;
        let variables = variables.into_iter().map(|(keys, choices)| {
            let choices = choices.map(|choices| serde_json::from_str(&choices)).transpose();
            let choices = choices.map_err(|error| errors::internal(&error.to_string()))?;
            Ok(Variable {
                name: keys.join(", "),
                keys: keys.into_iter().map(Key::plain).collect(),
                values: choices.map_or(Values::Number, Values::Choices),
            })
        });
        let of_views = views.iter().flat_map(|view| metrics.iter().map(|name| (*view, name)));
        let mut quantities = Vec::new();
        for (view, name) in of_views {
            let found = requested(name, view, &like.of.scene).map_err(|why| errors::argument(py, &why))?;
            let named = |quantity| NamedQuantity { name: name.clone(), condition: 0, quantity };
            quantities.extend(found.into_iter().map(named));
        }
        let study = Study {
            conditions: vec![Condition { name: String::new(), varied }],
            variables: variables.collect::<PyResult<_>>()?,
            quantities,
        };
        let (variables, metrics) = (study.variables.len(), study.quantities.len());
        Ok(Self { variables, metrics, pool: Pool::new(Arc::new(study)) })
    }

    /// Computes the metrics of designs. A design is a row with one number for each variable; rows are flat. NaN where undefined.
    /// With `skip`, the metrics of invalid designs are NaN; their indices and the reasons are returned as well.
    #[pyo3(signature = (designs, count, threads, progress=None, skip=false))]
    #[allow(clippy::type_complexity, reason = "an array and the skipped designs")]
    fn evaluate<'py>(
        &self,
        py: Python<'py>,
        designs: PyReadonlyArray1<'py, f64>,
        count: usize,
        threads: usize,
        progress: Option<Bound<'_, PyAny>>,
        skip: bool,
    ) -> PyResult<(Bound<'py, PyArray1<f64>>, Vec<(usize, String)>)> {
        let rows = Rows::new(&designs, count, self.variables)?;
        let found = self.pool.each(py, count, threads, progress.as_ref(), |evaluator, at| match evaluator
            .evaluate(rows.row(at))
        {
            Err(error) if skip && !was_stopped(&error) && !is_of_a_path(&error) => Ok(Err(reason(&error))),
            other => other.map(Ok),
        })?;
        let mut skipped = Vec::new();
        let found = found.into_iter().enumerate().map(|(at, row)| {
            row.unwrap_or_else(|why| {
                skipped.push((at, why));
                vec![None; self.metrics]
            })
        });
        let found = numbers(found.collect());
        Ok((PyArray1::from_iter(py, found), skipped))
    }

    /// Computes the metrics and their derivatives: for every design and metric, one for each variable. NaN where undefined.
    #[pyo3(signature = (designs, count, threads, progress=None))]
    #[allow(clippy::type_complexity, reason = "two arrays")]
    fn derivatives<'py>(
        &self,
        py: Python<'py>,
        designs: PyReadonlyArray1<'py, f64>,
        count: usize,
        threads: usize,
        progress: Option<Bound<'_, PyAny>>,
    ) -> PyResult<(Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>)> {
        let rows = Rows::new(&designs, count, self.variables)?;
        let found = self.pool.each(py, count, threads, progress.as_ref(), |evaluator, at| {
            evaluator.derivatives(rows.row(at)).map(|slopes| (slopes.values, slopes.slopes))
        })?;
        let (values, slopes): (Vec<_>, Vec<_>) = found.into_iter().unzip();
        let slopes = slopes.into_iter().flatten();
        Ok((PyArray1::from_iter(py, numbers(values)), PyArray1::from_iter(py, slopes)))
    }
}

/// Rows of designs in a flat array.
struct Rows<'a> {
    all: &'a [f64],
    length: usize,
}

impl<'a> Rows<'a> {
    fn new(all: &'a PyReadonlyArray1<'_, f64>, count: usize, length: usize) -> PyResult<Self> {
        let all = all.as_slice().map_err(|error| errors::internal(&error.to_string()))?;
        if count.checked_mul(length) != Some(all.len()) {
            return Err(errors::internal(
                "the number of values is not a multiple of the length of a row of designs",
            ));
        }
        Ok(Self { all, length })
    }

    fn row(&self, at: usize) -> &[f64] {
        &self.all[at * self.length..][..self.length]
    }
}

fn numbers(rows: Vec<Vec<Option<f64>>>) -> impl Iterator<Item = f64> {
    rows.into_iter().flatten().map(|value| value.unwrap_or(f64::NAN))
}

/// Finds the quantities of a name: those of a spectrum, or a single one.
fn requested(name: &str, view: usize, like: &Scene) -> Result<Vec<Quantity>, String> {
    let Some(state) = name.strip_suffix(".reflectance_factor") else {
        return quantity(name, view, like).map(|one| vec![one]);
    };
    // The state and the view are checked as those of any metric.
    quantity(&format!("{state}.Y"), view, like)?;
    let at = |bin| Quantity::ReflectanceFactor { view, state: state.to_owned(), bin };
    Ok((0..like.grid.len()).map(at).collect())
}

/// Finds a metric by its name, with the state before it for a metric of a state: "white.Y". The error states why the display has
/// none.
fn quantity(name: &str, view: usize, like: &Scene) -> Result<Quantity, String> {
    let (state, metric) = match name.rsplit_once('.') {
        Some((state, metric)) => (Some(state.to_owned()), metric),
        None => (None, name),
    };
    let metric = Metric::named(metric).filter(|metric| metric.is_of_view() == state.is_none());
    let views = like.viewer.theta_deg.len() * like.viewer.phi_deg.len();
    let states = state_names(&like.display.pixel);
    match (metric, &state) {
        _ if view >= views => Err(format!("view: expected 0 to {}, not {view}", views - 1)),
        (None, _) => {
            Err(format!("metrics: there is no metric {name:?}; expected {}", metric_names().join(", ")))
        }
        (_, Some(state)) if !states.contains(state) => {
            Err(format!("metrics: there is no state {state:?}; expected {}", states.join(", ")))
        }
        (Some(metric), _) => Ok(Quantity::Metric { view, state, metric }),
    }
}

/// Names of metrics; those of states for the state `white`.
#[pyfunction]
pub(crate) fn metric_names() -> Vec<String> {
    let name = |metric: &Metric| match metric.is_of_view() {
        true => metric.name().to_owned(),
        false => format!("white.{}", metric.name()),
    };
    Metric::ALL.iter().map(name).collect()
}
