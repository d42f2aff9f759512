//! The search that a scenario's `[optimize]` describes.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use papilio_design::search::{Chosen, Found, Kept, Record, Search, was_stopped};
use papilio_design::{DesignError, Evaluator, Study};
use papilio_scenario::Optimisation;
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use serde_json::{Value, json};

use crate::errors;
use crate::scenario::library;
use crate::watch::{Told, Watch, watched};

/// What was found, as JSON: the names of variables and quantities, the scenario's own design, and those that are handed
/// on, each with its values.
#[pyfunction]
#[pyo3(signature = (text, name, folder, files, threads, progress=None))]
pub(crate) fn optimise(
    py: Python<'_>,
    text: &str,
    name: &str,
    folder: PathBuf,
    files: Option<BTreeMap<String, Vec<u8>>>,
    threads: usize,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<String> {
    let said = py.detach(|| Optimisation::from_text(text, name, library(folder, files), &[]));
    let said = said.map_err(|errors| errors::scenario(py, &errors))?;
    let found =
        watched(py, &AtomicBool::new(false), progress.as_ref(), |watch| sought(said, watch, threads))?;
    match found {
        Ok(Some(found)) => Ok(found.to_string()),
        Ok(None) => Err(PyKeyboardInterrupt::new_err(())),
        Err(error) if was_stopped(&error) => Err(PyKeyboardInterrupt::new_err(())),
        Err(error) => Err(errors::search(py, &error)),
    }
}

fn sought(said: Optimisation, watch: &Watch<'_>, threads: usize) -> Result<Option<Value>, DesignError> {
    let mut evaluator = Evaluator::new(Arc::new(Study::of(&said)), watch.stop);
    let search = Search::new(said, &mut evaluator)?;
    let mut tell = |_: &Record, (done, of): (usize, usize)| {
        watch.tell(Told::Done(done, of));
        Ok::<(), DesignError>(())
    };
    let found = search.run(&evaluator, threads, &Kept::default(), &mut tell)?;
    let Some(found) = found else { return Ok(None) };
    let chosen = search.chosen(&found, &mut evaluator)?;
    Ok(Some(said_of(&search, &found, &chosen)))
}

fn said_of(search: &Search, found: &[Found], chosen: &[Chosen]) -> Value {
    let study = search.study();
    // What stands at every key: choices by their values, keys that give way to others included.
    let set = |design: &[f64]| -> Value {
        let settings = study.settings(design).unwrap_or_default().into_iter();
        Value::Object(settings.map(|(path, value)| (path.to_owned(), value)).collect())
    };
    let one = |chosen: &Chosen| {
        json!({
            "design": chosen.design, "set": set(&chosen.design), "values": chosen.values,
            "meets_limits": chosen.meets_limits(),
        })
    };
    let (own, own_values) = search.own();
    json!({
        "variables": study.variables.iter().map(|one| &one.name).collect::<Vec<_>>(),
        "quantities": study.quantities.iter().map(|one| &one.name).collect::<Vec<_>>(),
        "own": { "design": own, "set": set(own), "values": own_values },
        "chosen": chosen.iter().map(one).collect::<Vec<_>>(),
        "evaluations": found.iter().map(|one| one.evaluations).sum::<usize>(),
    })
}
