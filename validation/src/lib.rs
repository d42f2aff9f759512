//! Comparison of Papilio with the dissertation's tables, published numbers and other programs.
//!
//! The library contains the tables and helpers of the tests. The comparisons are its tests.

use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

use papilio_display::result::{RunResult, State};
use papilio_display::scene::Scene;
use papilio_display::{Control, DisplayError};
use papilio_scenario::{Resolved, Scenario, ScenarioErrors};

pub mod random_stacks;
pub use papilio_reproduction::{table_5_1, table_5_3};

/// Loads an example scenario of the repository, with overrides `PATH=VALUE`.
///
/// # Errors
/// Those of the scenario.
pub fn scenario(name: &str, overrides: &[&str]) -> Result<Resolved, ScenarioErrors> {
    let file =
        PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../scenarios").join(name).with_extension("toml");
    let overrides: Vec<String> = overrides.iter().map(|text| (*text).to_owned()).collect();
    Scenario::load(&file, &overrides)?.resolve()
}

/// Loads an example scenario with the Monte Carlo solver, with overrides `PATH=VALUE`.
///
/// # Errors
/// Those of the scenario.
pub fn monte_carlo_scenario(name: &str, overrides: &[&str]) -> Result<Resolved, ScenarioErrors> {
    scenario(name, &[&["solver.method=monte-carlo"], overrides].concat())
}

/// Runs a scene on this many threads, without progress messages.
///
/// # Errors
/// Those of [`papilio_display::run`].
pub fn run_on(scene: &Scene, threads: Option<usize>) -> Result<RunResult, DisplayError> {
    papilio_display::run(scene, &Control { threads, progress: &|_| {}, stop: &AtomicBool::new(false) })
}

/// Runs a scene on all threads, without progress messages.
///
/// # Errors
/// Those of [`papilio_display::run`].
pub fn run(scene: &Scene) -> Result<RunResult, DisplayError> {
    run_on(scene, None)
}

/// Returns a function that clones a scene with a larger change each time: by 1, 2, 3, ... For benchmarks, in
/// which nothing may be known already.
pub fn more_and_more(scene: &Scene, change: impl Fn(&mut Scene, f64)) -> impl FnMut() -> Scene {
    let mut times = 0.0;
    move || {
        let mut next = scene.clone();
        times += 1.0;
        change(&mut next, times);
        next
    }
}

/// Returns a state of the first view; `None` if it does not exist.
pub fn state<'a>(result: &'a RunResult, name: &str) -> Option<&'a State> {
    result.views.first()?.states.get(name)
}
