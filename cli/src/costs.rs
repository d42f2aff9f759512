//! Time and memory that work takes, from its counts, before anything is computed.
//!
//! Each cost is one number, correct to within a factor of ten on machines of these years. Costs of runs are those of
//! [`papilio_display::expected_seconds`].

use std::path::Path;

use papilio_display::scene::{Method, Stop};
use papilio_display::{Control, expected_seconds};
use papilio_scenario::{Resolved, Scenario};

use crate::long_work::Expected;
use crate::{Failure, input, interrupt};

/// A design of which the film alone changes, s: `papilio optimize scenarios/optimize.toml --threads 1 --no-check --set
/// optimize.method=global --set optimize.evaluations=4000` takes 3.0 s.
const FILM_S: f64 = 7.5e-4;

/// A design or a point of which another key changes, besides its light, s: its file is read and resolved again.
const DESIGN_S: f64 = 2e-3;

/// A ray of `papilio gonio` at all inclinations, s: with `--set microgeometry.rays=20000 --threads 1`,
/// `surfaces/etched.toml` takes 2.1 s, `prisms.toml` 23 s, and `spheres.toml` 41 s.
const RAY_S: f64 = 4.8e-4;

/// Numbers of a sample in the memory of `papilio tolerance`, bytes: each number, and what a sample has besides.
const NUMBER_BYTES: f64 = 16.0;
const SAMPLE_BYTES: f64 = 100.0;

/// The scenario of a file with its own values.
pub(crate) fn own(file: &Path, set: &[String]) -> Result<Resolved, Failure> {
    Ok(input::scenario::<Scenario>(file, set)?.resolve()?)
}

/// Checks a number of evaluations of a scenario before they are computed: their number, what they are and the keys
/// that determine it; `is_film` if only films change; `bytes` is the memory of all.
pub(crate) fn check_evaluations(
    resolved: &Resolved,
    (count, unit, keys): (f64, &str, &str),
    is_film: bool,
    bytes: f64,
    threads: Option<u16>,
) -> Result<(), Failure> {
    let control = Control { threads: Some(1), progress: &|_| {}, stop: &interrupt::STOP };
    let found = expected_seconds(&resolved.scene, &control);
    let seconds = match found.map_err(|error| Failure::from_display(resolved, error))? {
        // The light below a film is known from the first design.
        (Method::Adding, _) if is_film => FILM_S,
        (_, seconds) => DESIGN_S + seconds,
    };
    let what = format!("{} {unit}", papilio_diagnostics::number(count));
    Expected { what, keys, seconds: count * seconds, bytes }.check(threads)
}

/// Whether all keys are those of a pixel.
pub(crate) fn are_of_film<'a>(mut keys: impl Iterator<Item = &'a str>) -> bool {
    keys.all(|key| key.starts_with("display.pixel."))
}

/// Checks paths of a scenario before they are traced, `times` times in all its views; a target of an error is none.
pub(crate) fn check_paths(
    resolved: &Resolved,
    paths: Option<u64>,
    (times, keys): (f64, &str),
    threads: Option<u16>,
) -> Result<(), Failure> {
    /// Fewer paths take minutes in any display, and its preparation may take longer than an estimate saves.
    const FEW: u64 = 1 << 24;
    let stop = match resolved.scene.solver.stop {
        Stop::Paths(paths) => Some(paths),
        _ => None,
    };
    let Some(paths) = paths.or(stop).filter(|paths| *paths >= FEW) else { return Ok(()) };
    let mut scene = resolved.scene.clone();
    scene.solver.stop = Stop::Paths(paths);
    let control = Control { threads: Some(1), progress: &|_| {}, stop: &interrupt::STOP };
    let (_, seconds) =
        expected_seconds(&scene, &control).map_err(|error| Failure::from_display(resolved, error))?;
    let what = format!("{} paths of each view", papilio_diagnostics::number(paths as f64));
    Expected { what, keys, seconds: times * seconds, bytes: 0.0 }.check(threads)
}

/// Memory of samples of a tolerance analysis, each of which has so many numbers, bytes.
pub(crate) fn samples_bytes(samples: usize, numbers: usize) -> f64 {
    samples as f64 * (SAMPLE_BYTES + NUMBER_BYTES * numbers as f64)
}

/// Checks the rays of all replicates of a surface before they are followed.
pub(crate) fn check_rays(rays: u64, threads: Option<u16>) -> Result<(), Failure> {
    let rays = rays as f64;
    let what = format!("{} rays at each inclination", papilio_diagnostics::number(rays));
    Expected { what, keys: "microgeometry.rays", seconds: RAY_S * rays, bytes: 0.0 }.check(threads)
}
