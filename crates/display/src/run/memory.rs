//! Memory of a run, from its counts.

use papilio_transport::Top;

use super::Control;
use super::refine::is_turned;
use crate::DisplayError;
use crate::scene::{Method, Pixel, Scene};
use crate::setup::Setup;

/// Bytes for each state and wavelength: the spectra of a view with their errors; the table of a pixel that depends on
/// angle; the light of each source; and all replicates of Monte Carlo, with the light of each source.
///
/// Measured of `indoor.toml`, `six-ink.toml` and `rough-glass.toml` with steps of 0.02 to 1 nm, up to 60 lamps and up to 60
/// views: `papilio run FILE --json --set spectrum.step_nm=0.1` under `/usr/bin/time -v`.
const OF_VIEW: f64 = 250.0;
const OF_TABLE: f64 = 2.5e3;
const OF_SOURCE: f64 = 1e3;
const OF_REPLICATES: f64 = 6e3;
const OF_SOURCE_IN_REPLICATES: f64 = 1.5e3;

/// Estimates the memory of a run that grows with the numbers of states, wavelengths, views and sources, in bytes, to
/// within a factor of ten, before it begins.
pub fn expected_bytes(scene: &Scene) -> f64 {
    let spectra = scene.display.state_names().len() as f64 * scene.grid.len() as f64;
    let views = scene.viewer.theta_deg.len() as f64 * scene.viewer.phi_deg.len() as f64;
    let sources = scene.lighting.source_count() as f64;
    let table = match scene.display.pixel {
        Pixel::Film(_) | Pixel::Crystal(_) => OF_TABLE,
        _ => 0.0,
    };
    let solver = match scene.solver.method {
        Method::Adding => table + OF_SOURCE * sources,
        Method::MonteCarlo | Method::Auto => table + OF_REPLICATES + OF_SOURCE_IN_REPLICATES * sources,
    };
    spectra * (OF_VIEW * views + solver)
}

/// Bytes of one view by adding in an environment that depends on azimuth, where a part of the light passes the diffuser
/// unscattered: the light of each ring of the environment is then apart. `scenarios/map.toml` with
/// `display.diffuser.regular_fraction = 0.1` takes 0.18 to 0.44 GB at a haze from 0.2 to 0.78.
const OF_RINGS_APART: f64 = 4.5e8;

/// Views of maps, which have the rings of all inclinations: the same takes 2.4 GB on one thread at a haze of 0.78, and more than 4.7 GB at 0.3.
const OF_MAPS: f64 = 10.0;

/// Estimates the memory that each thread takes for a view by adding, in bytes, where it is much.
///
/// # Errors
/// If the scene is invalid, or its preparation was stopped.
pub fn expected_view_bytes(scene: &Scene, control: &Control<'_>) -> Result<f64, DisplayError> {
    let is_large = scene.solver.method == Method::Adding && are_rings_apart(scene, control)?;
    Ok(if is_large { OF_RINGS_APART } else { 0.0 })
}

/// Estimates the same for a map of all directions ([`cone`](crate::cone)), which is always by adding.
///
/// # Errors
/// If the scene is invalid, or its preparation was stopped.
pub fn expected_map_bytes(scene: &Scene, control: &Control<'_>) -> Result<f64, DisplayError> {
    Ok(if are_rings_apart(scene, control)? { OF_MAPS * OF_RINGS_APART } else { 0.0 })
}

fn are_rings_apart(scene: &Scene, control: &Control<'_>) -> Result<bool, DisplayError> {
    let mut parts = scene.lighting.environment.iter().flat_map(|one| &one.parts);
    let is_turned = parts.any(|part| !part.field.is_ring());
    Ok(is_turned && scene.display.filter().is_none() && has_rings_apart(&Setup::of_map(scene, control)?))
}

/// Returns whether the light of each ring of an environment is apart from the others.
pub(super) fn has_rings_apart(setup: &Setup) -> bool {
    let diffuser = setup.stack.panel().map(|panel| &panel.top);
    let is_clear = matches!(diffuser, Some(Top::Diffuser(diffuser)) if diffuser.regular_fraction > 0.0);
    is_clear && setup.sources.iter().any(is_turned)
}
