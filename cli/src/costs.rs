//! Time and memory that work takes, from its counts, before anything is computed.
//!
//! Each cost is one number, correct to within a factor of ten on machines of these years. Costs of runs are those of
//! [`papilio_display::expected_seconds`].

use std::path::Path;

use papilio_display::scene::{Method, Pixel, Stop};
use papilio_display::{Control, expected_bytes, expected_map_bytes, expected_seconds, expected_view_bytes};
use papilio_scenario::{Fit, FitTarget, Resolved, Scenario};

use crate::long_work::{Expected, thread_count};
use crate::{Failure, input, interrupt, print_warnings};

/// A design of which the film alone changes, s: `papilio optimize scenarios/optimize.toml --threads 1 --no-check --set
/// optimize.method=global --set optimize.evaluations=4000` takes 3.0 s.
const FILM_S: f64 = 7.5e-4;

/// A design or a point of which another key changes, besides its light, s: its file is read and resolved again.
const DESIGN_S: f64 = 2e-3;

/// A ray of `papilio gonio` at all inclinations, s: with `--set microgeometry.rays=20000 --threads 1`,
/// `surfaces/etched.toml` takes 1.2 to 2.1 s, `prisms.toml` 6 to 23 s, and `spheres.toml` 11 to 41 s.
const RAY_S: f64 = 3.5e-4;

/// Numbers of a sample in the memory of `papilio tolerance`, bytes: each number, and what a sample has besides.
const NUMBER_BYTES: f64 = 16.0;
const SAMPLE_BYTES: f64 = 100.0;

/// A pixel of a picture, and one with sub-pixels, and each of several samples of it, bytes. Of 4 and of 16 million pixels,
/// `papilio image scenarios/six-ink.toml` takes 0.3 and 1.1 GB, `matrix.toml` 1.0 and more than 4.1 GB, and `six-ink.toml`
/// with 16 samples of each of 4 million pixels 1.9 GB.
const PIXEL_BYTES: f64 = 64.0;
const PIXEL_OF_PARTS_BYTES: f64 = 260.0;
const SAMPLE_OF_PIXEL_BYTES: f64 = 30.0;

/// Displays in memory of each thread of a fit, which has derivatives, and besides: of `papilio fit scenarios/fit.toml
/// scenarios/data/synthetic-film.csv --set spectrum.step_nm=0.1`, 0.8 GB on one thread and 1.1 GB on two, where a display takes
/// 0.12 GB.
const DISPLAYS_OF_FIT: f64 = 3.0;

/// Displays that a fit computes: in the descent from a start, for each derivative of it, and for each variable's intervals.
/// `scenarios/fit.toml` with its 8 variables takes 0.15 s for each start, and 0.4 s for the rest.
const OF_START: f64 = 8.0;
const OF_DERIVATIVE: f64 = 24.0;
const OF_INTERVALS: f64 = 140.0;

/// Memory of the table by direction of a liquid crystal for each state and wavelength, bytes: `papilio run scenarios/cholesteric.toml --cone`, with 5
/// states and 41 wavelengths, takes 550 MB.
const CRYSTAL_BYTES: f64 = 2.5e6;

/// The scenario of a file with its own values, whose warnings are printed: those of the studies of a scenario.
pub(crate) fn own(file: &Path, set: &[String]) -> Result<Resolved, Failure> {
    let own = input::scenario::<Scenario>(file, set)?.resolve()?;
    print_warnings(&own.warnings);
    Ok(own)
}

/// Checks a number of evaluations of a scenario before they are computed: their number, what they are and the keys
/// that determine it; `is_film` if only films change; `bytes` is the memory of their results.
pub(crate) fn check_evaluations(
    resolved: &Resolved,
    (count, unit, keys): (f64, &str, &str),
    is_film: bool,
    bytes: f64,
    threads: Option<u16>,
) -> Result<(), Failure> {
    // Below a colour filter, light has places, whose cost is not estimated.
    if resolved.scene.display.filter().is_some() {
        return check_displays_at_once(resolved, 1.0, threads);
    }
    let control = Control { threads: Some(1), progress: &|_| {}, stop: &interrupt::STOP };
    let found = expected_seconds(&resolved.scene, &control);
    let seconds = match found.map_err(|error| Failure::from_display(resolved, error))? {
        // The light below a film is known from the first design.
        (Method::Adding, _) if is_film => FILM_S,
        (_, seconds) => DESIGN_S + seconds,
    };
    let what = format!("{} {unit}", papilio_diagnostics::number(count));
    Expected { what, keys, seconds: count * seconds, bytes }.check(threads)?;
    check_displays_at_once(resolved, 1.0, threads)
}

/// Checks the memory of displays that threads compute at once, each with so many of them.
fn check_displays_at_once(resolved: &Resolved, each: f64, threads: Option<u16>) -> Result<(), Failure> {
    let count = thread_count(threads);
    let what = format!("displays on {count} threads at once");
    let keys = "--threads, or of wavelengths: a larger spectrum.step_nm";
    let bytes = each * (count + 1) as f64 * expected_bytes(&resolved.scene);
    Expected { what, keys, seconds: 0.0, bytes }.check(threads)
}

/// Checks the memory of views that threads compute at once, or, with none, of maps.
pub(crate) fn check_views(
    resolved: &Resolved,
    views: Option<usize>,
    threads: Option<u16>,
) -> Result<(), Failure> {
    let control = Control { threads: Some(1), progress: &|_| {}, stop: &interrupt::STOP };
    let scene = &resolved.scene;
    let count = thread_count(threads).min(views.unwrap_or(usize::MAX));
    let (views, keys, each) = match views {
        Some(_) => ("views", "--threads", expected_view_bytes(scene, &control)),
        None => {
            let keys = "views of viewer.theta_deg and phi_deg instead of --cone";
            ("maps", keys, expected_map_bytes(scene, &control))
        }
    };
    let each = each.map_err(|error| Failure::from_display(resolved, error))?;
    let what = format!(
        "{views} on {count} threads at once, with display.diffuser.regular_fraction in light that depends on azimuth,"
    );
    Expected { what, keys, seconds: 0.0, bytes: each * count as f64 }.check(threads)
}

/// Checks the memory of a picture before it is computed.
pub(crate) fn check_picture(resolved: &Resolved, threads: Option<u16>) -> Result<(), Failure> {
    let Some(image) = &resolved.image else { return Ok(()) };
    let pixels = image.source.pixels.len() as f64;
    let samples = image.settings.samples_per_pixel.max(1).pow(2) as f64;
    let sub_pixels = resolved.scene.display.matrix.as_ref().map_or(0, |matrix| matrix.sub_pixels.len());
    let bytes = if sub_pixels > 1 { PIXEL_OF_PARTS_BYTES } else { PIXEL_BYTES };
    let bytes = pixels * (bytes + if samples > 1.0 { SAMPLE_OF_PIXEL_BYTES * samples } else { 0.0 });
    let number = papilio_diagnostics::number;
    let what = format!("a picture of {} pixels with {} samples of each", number(pixels), number(samples));
    let keys = "the size of the picture, display.matrix.pixels, image.samples_per_pixel";
    Expected { what, keys, seconds: 0.0, bytes }.check(threads)
}

/// Checks a fit before it is computed.
pub(crate) fn check_fit(resolved: &Resolved, fit: &Fit, threads: Option<u16>) -> Result<(), Failure> {
    let variables = fit.variables.len() as f64;
    let of_start = OF_START + OF_DERIVATIVE * (variables + 1.0);
    let count = fit.starts as f64 * of_start + OF_INTERVALS * variables;
    let keys = fit.variables.iter().filter_map(|one| match &one.target {
        FitTarget::Keys(keys) => Some(keys.iter().map(|key| key.path.as_str())),
        _ => None,
    });
    let work = (count, "displays", "fit.starts, fit.variables");
    check_evaluations(resolved, work, are_of_film(keys.flatten()), 0.0, threads)?;
    check_displays_at_once(resolved, DISPLAYS_OF_FIT, threads)
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

/// Checks the memory of the maps of all directions before they are computed.
pub(crate) fn check_map(resolved: &Resolved, threads: Option<u16>) -> Result<(), Failure> {
    let scene = &resolved.scene;
    if !matches!(scene.display.pixel, Pixel::Crystal(_)) {
        return Ok(());
    }
    let (states, wavelengths) = (scene.display.state_names().len(), scene.grid.len());
    let what =
        format!("the liquid crystal in all directions, in {states} states at {wavelengths} wavelengths");
    let bytes = CRYSTAL_BYTES * (states * wavelengths) as f64;
    Expected { what, keys: "a larger spectrum.step_nm, or fewer states", seconds: 0.0, bytes }.check(threads)
}

/// Checks the rays of all replicates of a surface before they are followed.
pub(crate) fn check_rays(rays: u64, threads: Option<u16>) -> Result<(), Failure> {
    let rays = rays as f64;
    let what = format!("{} rays at each inclination", papilio_diagnostics::number(rays));
    Expected { what, keys: "microgeometry.rays", seconds: RAY_S * rays, bytes: 0.0 }.check(threads)
}
