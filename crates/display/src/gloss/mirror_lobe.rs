//! Fluxes of a glossmeter below a weakly rough surface, near the mirror direction alone ([`mirror_lobe`]).
//!
//! Over a mirror, every order of inter-reflection is included. Over a Lambertian pixel the light that the pixel scatters is that of
//! the same display with a smooth surface: it changes by a fraction of about alpha^2.

use std::f64::consts::PI;

use papilio_colour::Observer;
use papilio_spectra::{Spectrum, StateSpectra, illuminant};
use papilio_transport::Interface as Ready;
use papilio_transport::adding::mirror_lobe;

use super::{Flux, ILLUMINANT, Meter, USUAL_TARGET, in_light_of};
use crate::scene::{Interface, Method, Scene, Stop};
use crate::setup::Setup;
use crate::{Control, DisplayError};

/// Largest roughness over a mirror, and over a Lambertian pixel: beyond, the directions of the whole hemisphere take little time.
const MOST_ALPHA: f64 = 0.1;
const MOST_ALPHA_OVER_PAPER: f64 = 0.02;
/// Natural digits of the levels.
const LEVELS: [f64; 4] = [5.0, 7.0, 9.0, 11.0];

/// Returns a flux, or `None` where the method does not apply.
pub(super) fn flux(
    scene: &Scene,
    phi_deg: f64,
    meter: &Meter,
    setup: &Setup,
    control: &Control<'_>,
) -> Result<Option<Flux>, DisplayError> {
    let Some(Interface::Rough { alpha, .. }) = scene.display.layers.first().map(|layer| &layer.interface)
    else {
        return Ok(None);
    };
    let is_paper = !setup.stack.base().is_specular();
    let most = if is_paper { MOST_ALPHA_OVER_PAPER } else { MOST_ALPHA };
    if scene.solver.method == Method::MonteCarlo || *alpha > most || !mirror_lobe::applies(&setup.stack) {
        return Ok(None);
    }
    let scattered = if is_paper { Some(of_smooth(scene, phi_deg, meter, control)?) } else { None };
    let window = meter.window(phi_deg);
    let (ends, largest) = window.trapezium();
    let window = mirror_lobe::Window { middle: window.theta_deg.to_radians(), ends, most: largest };
    let target = match scene.solver.stop {
        Stop::RelativeError { target, .. } => target,
        _ => USUAL_TARGET,
    };
    let weights = luminous_weights(scene)?;
    let mut before: Option<Vec<f64>> = None;
    let mut states: Vec<[f64; 2]> = Vec::new();
    for digits in LEVELS {
        let found =
            mirror_lobe::accepted(&setup.stack, meter.beam_deg.to_radians(), &window, digits, control.stop);
        let Some(found) = found else { return Err(DisplayError::Interrupted) };
        let now = luminous(&found, &weights);
        let Some(coarser) = before.replace(now.clone()) else { continue };
        states = now.iter().zip(&coarser).map(|(now, coarser)| [*now, (now - coarser).abs()]).collect();
        if states.iter().all(|[value, error]| *error <= target * value) {
            break;
        }
    }
    if let Some(scattered) = scattered {
        for (state, [value, error]) in states.iter_mut().zip(scattered) {
            *state = [state[0] + value, state[1].hypot(error)];
        }
    }
    Ok(Some(Flux { solver: "adding".to_owned(), states, warnings: Vec::new() }))
}

/// Light of a Lambertian pixel below the surface if it were smooth, by state: value and error.
fn of_smooth(
    scene: &Scene,
    phi_deg: f64,
    meter: &Meter,
    control: &Control<'_>,
) -> Result<Vec<[f64; 2]>, DisplayError> {
    let mut smooth = scene.clone();
    if let Some(layer) = smooth.display.layers.first_mut() {
        layer.interface = Interface::Ready(Ready::Fresnel);
    }
    let Some((field, irradiance)) = meter.window(phi_deg).light() else { return Ok(Vec::new()) };
    let result = crate::run(&in_light_of(&smooth, field, [meter.beam_deg, phi_deg]), control)?;
    if result.solver.interrupted {
        return Err(DisplayError::Interrupted);
    }
    let Some(view) = result.views.first() else { return Ok(Vec::new()) };
    let one = |state: &crate::result::State| {
        let error = state.discretisation_error.as_ref().map_or(0.0, |error| error.Y);
        [state.value.Y - state.value.terms.front_reflection, error].map(|value| irradiance / PI * value)
    };
    Ok(view.states.iter().map(|(_, state)| one(state)).collect())
}

/// Weights of the wavelengths of a luminous mean in the light of a glossmeter; their sum is 1.
fn luminous_weights(scene: &Scene) -> Result<Vec<f64>, DisplayError> {
    let light = illuminant(ILLUMINANT, &scene.grid).unwrap_or_else(|_| Spectrum::constant(&scene.grid, 1.0));
    let observer = Observer::new(&scene.grid)?;
    let weights: Vec<f64> =
        observer.weights()[1].iter().zip(light.iter()).map(|(y, light)| y * light).collect();
    let sum: f64 = weights.iter().sum();
    Ok(weights.iter().map(|weight| weight / sum).collect())
}

fn luminous(found: &StateSpectra, weights: &[f64]) -> Vec<f64> {
    let mean = |row: &[f64]| row.iter().zip(weights).map(|(value, weight)| value * weight).sum();
    found.rows().map(mean).collect()
}
