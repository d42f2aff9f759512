//! Many designs of one display in one call: pixels, lights or anything else that keys of a scenario say.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};

use numpy::{PyArray1, PyReadonlyArray1};
use papilio_design::{Condition, DesignError, Evaluator, Key, Named, Quantity, Study, Values, Variable};
use papilio_display::pixel::state_names;
use papilio_display::scene::{Metric, Scene};
use papilio_display::{Control, DisplayError};
use papilio_scenario::Varied;
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;

use crate::errors;
use crate::scenario::{Resolved, library};
use crate::watch::watched;

/// A display, its keys that vary, and what is asked of each design.
#[pyclass(frozen, module = "papilio._papilio")]
pub(crate) struct Batch {
    study: Arc<Study>,
    stop: &'static AtomicBool,
    /// One for each thread that there was so far.
    kept: Mutex<Vec<Evaluator<'static>>>,
}

#[pymethods]
impl Batch {
    /// `variables`: the keys of each, and its choices as JSON if it has some; `metrics`: as "white.Y".
    #[new]
    #[pyo3(signature = (like, text, name, folder, files, variables, metrics, view))]
    #[allow(clippy::too_many_arguments, reason = "what a display and a question are made of")]
    fn new(
        py: Python<'_>,
        like: &Resolved,
        text: &str,
        name: &str,
        folder: PathBuf,
        files: Option<BTreeMap<String, Vec<u8>>>,
        variables: Vec<(Vec<String>, Option<String>)>,
        metrics: Vec<String>,
        view: usize,
    ) -> PyResult<Self> {
        let paths: Vec<String> = variables.iter().flat_map(|(keys, _)| keys.clone()).collect();
        let varied = Varied::from_text(text, name, library(folder, files), &[], &paths);
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
        let quantities = metrics.into_iter().map(|name| {
            let quantity = quantity(&name, view, &like.of.scene);
            let quantity = quantity.map_err(|why| errors::argument(py, &why))?;
            Ok(Named { name, condition: 0, quantity })
        });
        let study = Study {
            conditions: vec![Condition { name: String::new(), varied }],
            variables: variables.collect::<PyResult<_>>()?,
            quantities: quantities.collect::<PyResult<_>>()?,
        };
        // One byte for each batch that a script makes.
        let stop = Box::leak(Box::new(AtomicBool::new(false)));
        Ok(Self { study: Arc::new(study), stop, kept: Mutex::new(Vec::new()) })
    }

    /// The metrics of designs, which are rows of one number for each variable; rows, flat. NaN where undefined.
    #[pyo3(signature = (designs, count, threads, progress=None))]
    fn evaluate<'py>(
        &self,
        py: Python<'py>,
        designs: PyReadonlyArray1<'py, f64>,
        count: usize,
        threads: usize,
        progress: Option<Bound<'_, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let designs = designs.as_slice().map_err(|error| errors::internal(&error.to_string()))?;
        let variables = self.study.variables.len();
        if count.checked_mul(variables) != Some(designs.len()) {
            return Err(errors::internal("rows of designs are not whole"));
        }
        let threads = threads.clamp(1, count.max(1));
        let rows: Vec<&[f64]> = (0..count).map(|at| &designs[at * variables..][..variables]).collect();
        let outcome = watched(py, Some(threads), progress.as_ref(), |control| {
            let mut kept = self.kept.lock().ok()?;
            self.stop.store(false, Ordering::Relaxed);
            while kept.len() < threads {
                let another = kept.first().map(Evaluator::worker);
                kept.push(another.unwrap_or_else(|| Evaluator::new(Arc::clone(&self.study), self.stop)));
            }
            Some(each(&mut kept[..threads], &rows, control))
        })?;
        let Some(outcome) = outcome else {
            return Err(errors::internal("this display was left half done by an earlier fault"));
        };
        let rows = outcome.map_err(|(design, error)| failed(py, design, &error))?;
        let numbers = rows.into_iter().flatten().map(|value| value.unwrap_or(f64::NAN));
        Ok(PyArray1::from_iter(py, numbers))
    }
}

/// A design's answers.
type Row = Vec<Option<f64>>;

/// Designs that a thread takes at once.
const BLOCK: usize = 8;

/// Every design by one of the evaluators; if some cannot be, the first of them and why.
fn each(
    evaluators: &mut [Evaluator<'static>],
    rows: &[&[f64]],
    control: &Control<'_>,
) -> Result<Vec<Row>, (usize, DesignError)> {
    // Blocks are handed out in order, and all before the first failure are finished: which is the first does not depend on threads.
    let (next, limit) = (AtomicUsize::new(0), AtomicUsize::new(rows.len()));
    let (done, failed) = (Mutex::new(vec![Vec::new(); rows.len()]), Mutex::new(None));
    let one = |evaluator: &mut Evaluator<'static>| loop {
        let start = next.fetch_add(BLOCK, Ordering::Relaxed);
        for (design, x) in rows.iter().enumerate().skip(start).take(BLOCK) {
            if design >= limit.load(Ordering::Relaxed) || control.stop.load(Ordering::Relaxed) {
                return;
            }
            match evaluator.evaluate(x) {
                Ok(row) => {
                    if let Ok(mut done) = done.lock() {
                        done[design] = row;
                    }
                }
                Err(error) => {
                    if limit.fetch_min(design, Ordering::Relaxed) > design
                        && let Ok(mut failed) = failed.lock()
                    {
                        *failed = Some((design, error));
                    }
                }
            }
        }
        if start >= rows.len() {
            return;
        }
    };
    match evaluators {
        [alone] => one(alone),
        several => std::thread::scope(|scope| {
            several.iter_mut().for_each(|evaluator| {
                scope.spawn(|| one(evaluator));
            });
        }),
    }
    let done = done.into_inner().unwrap_or_default();
    failed.into_inner().ok().flatten().map_or(Ok(done), Err)
}

/// A metric by its name, of a state by both: "white.Y"; or why a display like this one has none.
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
        (None, _) => Err(format!("metrics: there is no {name:?}; there are {}", metric_names().join(", "))),
        (_, Some(state)) if !states.contains(state) => {
            Err(format!("metrics: there is no state {state:?}; there are {}", states.join(", ")))
        }
        (Some(metric), _) => Ok(Quantity::Metric { view, state, metric }),
    }
}

/// The names of metrics; those of states for a state `white`.
#[pyfunction]
pub(crate) fn metric_names() -> Vec<String> {
    let name = |metric: &Metric| match metric.is_of_view() {
        true => metric.name().to_owned(),
        false => format!("white.{}", metric.name()),
    };
    Metric::ALL.iter().map(name).collect()
}

/// The number of the design goes first.
fn failed(py: Python<'_>, design: usize, error: &DesignError) -> PyErr {
    match error {
        DesignError::Display(DisplayError::Interrupted) => PyKeyboardInterrupt::new_err(()),
        error => errors::design(py, design, &error.to_string()),
    }
}
