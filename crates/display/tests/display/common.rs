//! Runs of the repository's scenarios without progress reports.
//!
//! The tests use the crate that reads scenarios, so that displays are described as users describe them.

use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

use papilio_display::result::RunResult;
use papilio_display::scene::Scene;
use papilio_display::{Control, DisplayError, Prepared};
use papilio_scenario::{Resolved, Scenario, ScenarioErrors};

/// Returns the folder of the example scenarios.
pub(crate) fn scenarios() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../scenarios")
}

/// Reads an example scenario, with overrides `PATH=VALUE`.
pub(crate) fn scenario(name: &str, overrides: &[&str]) -> Result<Resolved, ScenarioErrors> {
    let overrides: Vec<String> = overrides.iter().map(|text| (*text).to_owned()).collect();
    Scenario::load(&scenarios().join(name).with_extension("toml"), &overrides)?.resolve()
}

/// Reads an example scenario for the Monte Carlo solver, with overrides `PATH=VALUE`.
pub(crate) fn walked(name: &str, overrides: &[&str]) -> Result<Resolved, ScenarioErrors> {
    scenario(name, &[&["solver.method=monte-carlo"], overrides].concat())
}

/// Prepares a series of scenes.
pub(crate) fn prepared_for(scene: &Scene) -> Result<Prepared, DisplayError> {
    Prepared::new(scene, &Control { threads: None, progress: &|_| {}, stop: &AtomicBool::new(false) })
}

/// Runs a scene on this many threads.
pub(crate) fn run_on(scene: &Scene, threads: Option<usize>) -> Result<RunResult, DisplayError> {
    papilio_display::run(scene, &Control { threads, progress: &|_| {}, stop: &AtomicBool::new(false) })
}

/// Runs a scene on all threads.
pub(crate) fn run(scene: &Scene) -> Result<RunResult, DisplayError> {
    run_on(scene, None)
}
