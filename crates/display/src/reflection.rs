//! What kind of mirror a display is: its reflection split into mirror, haze and Lambertian parts.
//!
//! **What.** Of a beam of the scene's light, the luminous shares that leave
//! - in the mirror direction (*mirror*),
//! - as from white paint: pi times the least BRDF over a set of directions within 60 deg of the normal
//!   (*Lambertian*; what falls off beyond is no base under anything),
//! - and the rest (*haze*),
//!
//! which sum to all that leaves (E. F. Kelley, "Display reflectance model based on the BRDF", Displays 19, 27
//! (1998); IDMS 1.1, section 11). *Beyond 2.5 deg* is the share of all that leaves more than 2.5 deg off the mirror
//! direction: to reflection what ASTM D1003 is to transmission.
//! **How.** By reciprocity, what leaves in all of a beam is what is seen from its direction in diffuse light; within
//! 2.5 deg, under a disc of that radius; in a direction, under a beam from there. One run by adding tells all.

use papilio_spectra::Spectrum;

use crate::DisplayError;
use crate::result::{RunResult, State};
use crate::run::{Control, run};
use crate::scene::{AngleMedium, DirectedLight, Method, Scene, Stop};
use crate::setup::Setup;

/// What ASTM D1003 calls straight on, degrees.
const STRAIGHT_DEG: f64 = 2.5;

/// Where the least BRDF is looked for: inclinations and azimuths from the plane of incidence, degrees.
const INCLINATIONS_DEG: [f64; 5] = [0.0, 15.0, 30.0, 45.0, 60.0];
const AZIMUTHS_DEG: [f64; 5] = [0.0, 45.0, 90.0, 135.0, 180.0];

/// Adding's target, where the scene has none.
const DEFAULT_TARGET: f64 = 1e-3;

/// The reflection of a beam from one direction.
#[derive(Debug, Clone, PartialEq)]
pub struct Reflection {
    /// Inclination of the beam, degrees in air.
    pub theta_deg: f64,
    /// One for each drive state.
    pub states: Vec<ReflectionState>,
}

/// Luminous shares of a beam.
#[derive(Debug, Clone, PartialEq)]
pub struct ReflectionState {
    /// Name of the state.
    pub name: String,
    /// All that leaves.
    pub returned: f64,
    /// In the mirror direction alone.
    pub mirror: f64,
    /// Neither in the mirror direction nor as from paint.
    pub haze: f64,
    /// As from white paint.
    pub lambertian: f64,
    /// Of all that leaves, what leaves more than 2.5 deg off the mirror direction; `None` if nothing leaves.
    pub beyond_straight: Option<f64>,
}

/// Splits the reflection of beams from these inclinations (degrees in air, below 87); by adding, whatever
/// the scene's method.
///
/// # Errors
/// If the scene cannot be, or was stopped.
pub fn reflection(
    scene: &Scene,
    theta_deg: &[f64],
    control: &Control<'_>,
) -> Result<Vec<Reflection>, DisplayError> {
    let light = mixture(scene)?;
    let one = |theta: &f64| {
        let result = run(&lit(scene, *theta, &light), control)?;
        Ok(Reflection { theta_deg: *theta, states: split(&result, *theta) })
    };
    theta_deg.iter().map(one).collect()
}

/// All of the room's light together, relative; an even spectrum where there is none.
fn mixture(scene: &Scene) -> Result<Spectrum, DisplayError> {
    let mut room = scene.clone();
    room.lighting.front_light = None;
    let setup = Setup::new(&room)?;
    let nothing = Spectrum::constant(&scene.grid, 0.0);
    let sum = setup.lights.iter().fold(nothing, |sum, light| sum.zip_map(&light.irradiance, |a, b| a + b));
    Ok(if sum.max() > 0.0 { sum } else { Spectrum::constant(&scene.grid, 1.0) })
}

/// The display seen from `theta`, in diffuse light, under a disc in the mirror direction, and under beams.
fn lit(scene: &Scene, theta_deg: f64, light: &Spectrum) -> Scene {
    let mut lit = scene.clone();
    lit.viewer.theta_deg = vec![theta_deg];
    lit.viewer.phi_deg = vec![0.0];
    lit.viewer.field_deg = 0.0;
    lit.solver.method = Method::Adding;
    if !matches!(lit.solver.stop, Stop::RelativeError { .. }) {
        lit.solver.stop = Stop::RelativeError { target: DEFAULT_TARGET, every_bin: false };
    }
    if lit.solver.angle_medium == AngleMedium::Glass {
        lit.solver.angle_medium = AngleMedium::Air;
    }
    let source = |theta_deg, phi_deg, radius_deg| DirectedLight {
        theta_deg,
        phi_deg,
        share: 0.0,
        spectrum: light.clone(),
        radius_deg,
        normal_to_beam: false,
    };
    let mut sources = vec![source(-theta_deg, 0.0, Some(STRAIGHT_DEG))];
    let around = INCLINATIONS_DEG.iter().flat_map(|theta| AZIMUTHS_DEG.map(|phi| (*theta, phi)));
    sources
        .extend(around.filter(|at| at.0 > 0.0 || at.1 == 0.0).map(|(theta, phi)| source(theta, phi, None)));
    let share = 1.0 / (sources.len() + 1) as f64;
    sources.iter_mut().for_each(|source| source.share = share);
    lit.lighting.illuminance_lx = 1.0;
    lit.lighting.diffuse = share;
    lit.lighting.diffuse_spectrum = light.clone();
    lit.lighting.directed = sources;
    lit.lighting.environment.clear();
    lit.lighting.front_light = None;
    lit
}

fn split(result: &RunResult, theta_deg: f64) -> Vec<ReflectionState> {
    let Some(view) = result.views.first() else { return Vec::new() };
    let one = |(name, State { value, .. }): (&str, &State)| {
        let returned = value.R_hemi.unwrap_or_default();
        let mirror = value.specular.first().copied().unwrap_or_default();
        let beams = value.R_dir.iter().skip(1).flatten();
        let lambertian = beams.copied().fold(f64::INFINITY, f64::min).clamp(0.0, returned - mirror);
        // What is seen of a disc is the mean over its projected solid angle.
        let disc = theta_deg.to_radians().cos() * STRAIGHT_DEG.to_radians().sin().powi(2);
        let straight = value.R_dir.first().copied().flatten().unwrap_or_default() * disc;
        ReflectionState {
            name: name.to_owned(),
            returned,
            mirror,
            haze: returned - mirror - lambertian,
            lambertian,
            beyond_straight: (returned > 0.0).then(|| (1.0 - straight / returned).max(0.0)),
        }
    };
    view.states.iter().map(one).collect()
}
