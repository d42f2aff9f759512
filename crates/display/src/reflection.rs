//! Components of the reflection of a display: mirror, haze and Lambertian.
//!
//! **What.** The luminous fractions of a beam of the scene's light that are reflected
//! - in the mirror direction (*mirror*),
//! - like light from white paint: pi times the smallest BRDF over a set of directions within 60 deg of the
//!   normal (*Lambertian*; a BRDF that decreases at larger angles does not limit it),
//! - and otherwise (*haze*).
//!
//! They sum to the directional-hemispherical reflectance (E. F. Kelley, "Display reflectance model based on
//! the BRDF", Displays 19, 27 (1998); IDMS 1.1, section 11). *Beyond 2.5 deg* is the fraction of the
//! reflected light at more than 2.5 deg from the mirror direction, the analogue for reflection of haze by
//! ASTM D1003. **How.** By reciprocity, the directional-hemispherical reflectance of a beam is the
//! reflectance factor viewed from its direction in diffuse light. In the same way, a disc of 2.5 deg radius
//! gives the light within 2.5 deg, and a beam the light in its direction. One run by adding gives all of
//! them.

use papilio_spectra::Spectrum;

use crate::DisplayError;
use crate::prepared::Prepared;
use crate::result::{RunResult, State};
use crate::run::Control;
use crate::scene::{AngleMedium, DirectedLight, Method, Scene, Stop};
use crate::setup::Setup;

/// Angle within which light counts as not scattered by ASTM D1003, degrees.
const STRAIGHT_DEG: f64 = 2.5;

/// Directions for the smallest BRDF: inclinations, and azimuths relative to the plane of incidence, degrees.
const INCLINATIONS_DEG: [f64; 5] = [0.0, 15.0, 30.0, 45.0, 60.0];
const AZIMUTHS_DEG: [f64; 8] = [0.0, 45.0, 90.0, 135.0, 180.0, 225.0, 270.0, 315.0];

/// How many of them a display has that is isotropic in azimuth, and so symmetric about the plane of incidence.
const ON_ONE_SIDE: usize = 5;

/// Azimuths of the beams where the display depends on azimuth, degrees.
const BEAMS_DEG: [f64; 4] = [0.0, 45.0, 90.0, 135.0];

/// Target of adding for scenes without one.
const DEFAULT_TARGET: f64 = 1e-3;

/// Reflection of a beam from one direction.
#[derive(Debug, Clone, PartialEq)]
pub struct Reflection {
    /// Inclination of the beam, degrees in air.
    pub theta_deg: f64,
    /// Azimuth of the beam, degrees; `None` for a display that is isotropic in azimuth.
    pub phi_deg: Option<f64>,
    /// Components of each drive state.
    pub states: Vec<ReflectionState>,
}

/// Difference of two reflectances, relative to them, that counts as rounding.
const ROUNDING: f64 = 1e-12;

/// Components of the reflection of a beam, as luminous fractions of the beam.
#[derive(Debug, Clone, PartialEq)]
pub struct ReflectionState {
    /// Name of the state.
    pub name: String,
    /// Directional-hemispherical reflectance.
    pub returned: f64,
    /// Mirror component: the light in the mirror direction.
    pub mirror: f64,
    /// Haze component: the light that is neither mirror nor Lambertian.
    pub haze: f64,
    /// Lambertian component.
    pub lambertian: f64,
    /// Fraction of the reflected light at more than 2.5 deg from the mirror direction; `None` without
    /// reflected light.
    pub beyond_straight: Option<f64>,
}

/// Computes the components of the reflection of beams from these inclinations (degrees in air, below 87), by
/// adding independently of the scene's method; of a display that depends on azimuth, for four azimuths of each.
///
/// # Errors
/// If the scene is invalid, or the computation was stopped.
pub fn reflection(
    scene: &Scene,
    theta_deg: &[f64],
    control: &Control<'_>,
) -> Result<Vec<Reflection>, DisplayError> {
    let mut ambient = scene.clone().unpolarised();
    ambient.lighting.front_light = None;
    let setup = Setup::new(&ambient, control)?;
    let light = total_spectrum(&setup);
    let azimuths = if setup.stack.base().is_azimuthal() { BEAMS_DEG.map(Some).to_vec() } else { vec![None] };
    let mut prepared = Prepared::of(setup);
    let beams: Vec<_> =
        theta_deg.iter().flat_map(|theta| azimuths.iter().map(|phi| (*theta, *phi))).collect();
    let one = |(number, (theta_deg, phi_deg)): (usize, &(f64, Option<f64>))| {
        let part = [number, number + 1].map(|done| done as f64 / beams.len() as f64);
        let scene = reflection_scene(scene, (*theta_deg, *phi_deg), &light);
        let result = control.within(part, |control| prepared.run(&scene, control))?;
        Ok(Reflection { theta_deg: *theta_deg, phi_deg: *phi_deg, states: split(&result, *theta_deg) })
    };
    beams.iter().enumerate().map(one).collect()
}

/// Relative spectrum of all light; an equal-energy spectrum if there is none.
fn total_spectrum(setup: &Setup) -> Spectrum {
    let grid = &setup.scene.grid;
    let zero = Spectrum::constant(grid, 0.0);
    let sum = setup.lights.iter().fold(zero, |sum, light| sum.zip_map(&light.irradiance, |a, b| a + b));
    if sum.max() > 0.0 { sum } else { Spectrum::constant(grid, 1.0) }
}

/// Scene of the display viewed from a direction in diffuse light, under a disc in the mirror direction, and
/// under beams.
fn reflection_scene(scene: &Scene, (theta_deg, azimuth): (f64, Option<f64>), light: &Spectrum) -> Scene {
    let mut lit = scene.clone().unpolarised();
    let view_deg = azimuth.unwrap_or(0.0);
    lit.viewer.theta_deg = vec![theta_deg];
    lit.viewer.phi_deg = vec![view_deg];
    lit.viewer.field_deg = 0.0;
    lit.viewer.numerical_aperture = None;
    lit.solver.method = Method::Adding;
    if !matches!(lit.solver.stop, Stop::RelativeError { .. }) {
        lit.solver.stop = Stop::RelativeError { target: DEFAULT_TARGET, per_wavelength: false };
    }
    if lit.solver.angle_medium == AngleMedium::Glass {
        lit.solver.angle_medium = AngleMedium::Air;
    }
    let source = |theta_deg, phi_deg: f64, radius_deg| DirectedLight {
        theta_deg,
        phi_deg: phi_deg + view_deg,
        share: 0.0,
        spectrum: light.clone().into(),
        radius_deg,
        normal_to_beam: false,
        vibration: None,
    };
    let mut sources = vec![source(-theta_deg, 0.0, Some(STRAIGHT_DEG))];
    let azimuths = if azimuth.is_some() { &AZIMUTHS_DEG[..] } else { &AZIMUTHS_DEG[..ON_ONE_SIDE] };
    let around = INCLINATIONS_DEG.iter().flat_map(|theta| azimuths.iter().map(|phi| (*theta, *phi)));
    sources
        .extend(around.filter(|at| at.0 > 0.0 || at.1 == 0.0).map(|(theta, phi)| source(theta, phi, None)));
    let share = 1.0 / (sources.len() + 1) as f64;
    sources.iter_mut().for_each(|source| source.share = share);
    lit.lighting.illuminance_lx = 1.0;
    lit.lighting.diffuse = share;
    lit.lighting.diffuse_spectrum = light.clone().into();
    lit.lighting.directed = sources;
    lit.lighting.environment.clear();
    lit.lighting.front_light = None;
    lit
}

/// Computes the components from the result of [`reflection_scene`].
fn split(result: &RunResult, theta_deg: f64) -> Vec<ReflectionState> {
    let Some(view) = result.views.first() else { return Vec::new() };
    let one = |(name, State { value, .. }): (&str, &State)| {
        let returned = value.R_hemi.unwrap_or_default();
        let mirror = value.specular.first().copied().unwrap_or_default();
        // A display without scattering has the mirror component alone, up to rounding.
        let scattered = returned - mirror;
        let scattered = if scattered.abs() <= ROUNDING * returned { 0.0 } else { scattered };
        let beams = value.R_dir.iter().skip(1).flatten();
        let lambertian = beams.copied().fold(f64::INFINITY, f64::min).clamp(0.0, scattered.max(0.0));
        // The reflectance factor under a disc is the mean over its projected solid angle.
        let disc = theta_deg.to_radians().cos() * STRAIGHT_DEG.to_radians().sin().powi(2);
        let straight = value.R_dir.first().copied().flatten().unwrap_or_default() * disc;
        ReflectionState {
            name: name.to_owned(),
            returned,
            mirror,
            haze: scattered - lambertian,
            lambertian,
            beyond_straight: (returned > 0.0).then(|| (1.0 - straight / returned).max(0.0)),
        }
    };
    view.states.iter().map(one).collect()
}
