//! Gloss and distinctness of image: what a glossmeter reads of a display.
//!
//! # Model
//! A glossmeter compares the luminous flux that a sample sends into a receptor around the mirror direction with that of
//! polished black glass, in the light of illuminant C (ISO 2813:2014):
//! `gloss = 100 F/R`, with the fraction F of the incident light that the receptor accepts, and Fresnel's reflectance R of an
//! index of 1.567 at the same angle. F is the integral of `f_r cos(theta) w` over the directions of the receptor, with the
//! BRDF f_r and the fraction w of the source whose image falls into the receptor ([`MeterWindow`]). By reciprocity it is the
//! reflectance factor of the display, seen in the direction of the lamp in the light of a window of radiance w, times the
//! irradiance of the window over pi.
//!
//! The distinctness of image is `100 (1 - F_0.3/F_0)` with the flux F_0 in the mirror direction, at 30 deg, and F_0.3 in a
//! direction 0.3 deg farther from the normal, both through a slit of 0.14 deg (after ASTM E430, method A: 100 for a flat mirror,
//! 0 for a surface that shows no images).
//!
//! Below a weakly rough surface adding follows the light near the mirror direction alone (`gloss/mirror_lobe.rs`).
//!
//! The haze in transmission is that of the layers above the pixel (`haze.rs`).
//!
//! # Validity
//! The BRDF is that of the middle of the source at the same deviation from the mirror direction; it changes little over the
//! angular size of the source. The light of a gloss meter enters and leaves at the same place: light that spreads sideways by
//! more than the illuminated spot is not lost.

mod mirror_lobe;

use std::f64::consts::PI;
use std::sync::Arc;

use papilio_optics::interface::fresnel_reflectance;
use papilio_spectra::{Spectrum, illuminant};
use papilio_transport::Field;
use schemars::JsonSchema;
use serde::Serialize;

use crate::environment::MeterWindow;
use crate::haze::haze_percent;
pub use crate::metrics::GlossMetrics;
use crate::result::{Named, RunResult, State};
use crate::scene::{AngleMedium, Environment, EnvironmentPart, Lighting, Metrics, Scene, Stop, Viewer};
use crate::{Control, DisplayError, Prepared};

/// Light of a glossmeter, by its name among the CIE's illuminants.
const ILLUMINANT: &str = "C";
/// Refractive index of the glass that has a gloss of 100.
const INDEX_OF_STANDARD: f64 = 1.567;
/// Angles of a glossmeter, degrees, with the sizes of its receptor in the plane of incidence and across, degrees.
const GLOSSMETERS: [(&str, f64, [f64; 2]); 3] =
    [("gloss_20", 20.0, [1.8, 3.6]), ("gloss_60", 60.0, [4.4, 11.7]), ("gloss_85", 85.0, [4.0, 6.0])];
/// Sizes of the source, degrees.
const SOURCE_DEG: [f64; 2] = [0.75, 2.5];
/// Angle of the meter of distinctness of image, and the second direction relative to it, degrees.
const DISTINCTNESS_DEG: [f64; 2] = [30.0, 0.3];
/// Sizes of its source and its slit, degrees.
const SLITS_DEG: [[f64; 2]; 2] = [[0.44, 5.0], [0.14, 3.0]];
/// Relative error of a flux where the scene has no target for it.
const USUAL_TARGET: f64 = 1e-3;

/// Gloss of all states.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct GlossResult {
    /// `adding` or `monte-carlo`, for each computed flux: at 20, 60 and 85 deg, in the mirror direction at 30 deg, and beside it.
    pub solvers: Vec<String>,
    /// Azimuth of the plane of incidence, degrees.
    pub phi_deg: f64,
    /// The states, in the order of the scenario.
    pub states: Named<StateGloss>,
    /// Warnings.
    pub warnings: Vec<String>,
}

/// Gloss of a state.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct StateGloss {
    /// The values.
    #[serde(flatten)]
    pub values: GlossMetrics,
    /// Their errors: standard errors of Monte Carlo, discretisation errors of adding and of the integral for the haze.
    pub error: GlossMetrics,
}

/// Computes the gloss and the distinctness of image of each state, in the plane of incidence of the first view's azimuth. Light
/// and other directions of the scene have no influence.
///
/// # Errors
/// As [`run`](crate::run()).
pub fn gloss(scene: &Scene, control: &Control<'_>) -> Result<GlossResult, DisplayError> {
    gloss_of(scene, &|_| true, control)
}

/// Computes only the metrics of these names; the others are null.
///
/// # Errors
/// As [`run`](crate::run()).
pub fn gloss_of(
    scene: &Scene,
    is_wanted: &dyn Fn(&str) -> bool,
    control: &Control<'_>,
) -> Result<GlossResult, DisplayError> {
    let phi_deg = scene.viewer.phi_deg.first().copied().unwrap_or(0.0);
    let meters = meters();
    let mut prepared = Prepared::empty();
    let mut fluxes = Vec::with_capacity(meters.len());
    for (number, meter) in meters.iter().enumerate() {
        let part = [number, number + 1].map(|done| done as f64 / meters.len() as f64);
        let flux = is_wanted(meter.metric)
            .then(|| control.within(part, |control| Flux::of(scene, phi_deg, meter, &mut prepared, control)));
        fluxes.push(flux.transpose()?);
    }
    let names = scene.display.state_names();
    let haze = haze_percent(scene);
    let states =
        names.into_iter().enumerate().map(|(state, name)| (name, StateGloss::of(&fluxes, state, haze)));
    let mut warnings: Vec<String> = scene.ignores_polariser().into_iter().collect();
    if illuminant(ILLUMINANT, &scene.grid).is_err() {
        warnings.push(format!(
            "illuminant {ILLUMINANT} of a glossmeter does not cover the wavelengths of the scenario: light of equal energy is used"
        ));
    }
    for warning in fluxes.iter().flatten().flat_map(|flux| &flux.warnings) {
        if !warnings.contains(warning) {
            warnings.push(warning.clone());
        }
    }
    Ok(GlossResult {
        solvers: fluxes.iter().flatten().map(|flux| flux.solver.clone()).collect(),
        phi_deg,
        states: Named(states.collect()),
        warnings,
    })
}

/// A beam and a receptor.
struct Meter {
    /// The metric that needs it.
    metric: &'static str,
    /// Inclination of the beam, degrees.
    beam_deg: f64,
    /// Inclination of the receptor, degrees.
    receptor_deg: f64,
    /// Sizes of source and receptor, degrees.
    sizes_deg: [[f64; 2]; 2],
}

/// Those of the glossmeters, then both of the distinctness of image.
fn meters() -> Vec<Meter> {
    let gloss = GLOSSMETERS.map(|(metric, theta, receptor)| Meter {
        metric,
        beam_deg: theta,
        receptor_deg: theta,
        sizes_deg: [SOURCE_DEG, receptor],
    });
    let [beam_deg, beside] = DISTINCTNESS_DEG;
    let metric = "distinctness_of_image";
    let slits = [0.0, beside].map(|off| Meter {
        metric,
        beam_deg,
        receptor_deg: beam_deg + off,
        sizes_deg: SLITS_DEG,
    });
    gloss.into_iter().chain(slits).collect()
}

/// Fraction of the light of a beam that a receptor accepts.
struct Flux {
    solver: String,
    /// Value and error for each state.
    states: Vec<[f64; 2]>,
    warnings: Vec<String>,
}

impl Meter {
    fn window(&self, phi_deg: f64) -> MeterWindow {
        let [source_deg, receptor_deg] = self.sizes_deg;
        MeterWindow { theta_deg: self.receptor_deg, phi_deg: phi_deg + 180.0, source_deg, receptor_deg }
    }
}

impl Flux {
    fn of(
        scene: &Scene,
        phi_deg: f64,
        meter: &Meter,
        prepared: &mut Prepared,
        control: &Control<'_>,
    ) -> Result<Self, DisplayError> {
        let Some((field, irradiance)) = meter.window(phi_deg).light() else {
            return Err(DisplayError::BelowHorizon {
                what: "receptor",
                theta_deg: meter.receptor_deg,
                index: 1.0,
            });
        };
        let lit = in_light_of(scene, field, [meter.beam_deg, phi_deg]);
        if let Some(flux) = mirror_lobe::flux(scene, phi_deg, meter, prepared.setup(&lit, control)?, control)?
        {
            return Ok(flux);
        }
        let result = prepared.run(&lit, control)?;
        if result.solver.interrupted {
            return Err(DisplayError::Interrupted);
        }
        let factor = irradiance / PI;
        Ok(Self {
            states: luminous(&result, factor),
            solver: result.solver.method,
            warnings: result.warnings,
        })
    }
}

/// Luminance factors and their errors, times a factor.
fn luminous(result: &RunResult, factor: f64) -> Vec<[f64; 2]> {
    let Some(view) = result.views.first() else { return Vec::new() };
    let error = |state: &State| match &state.discretisation_error {
        Some(error) => error.Y,
        None => state.standard_error.Y,
    };
    view.states.iter().map(|(_, state)| [factor * state.value.Y, factor * error(state)]).collect()
}

/// The display of a scene in the light of a window, seen along a beam.
fn in_light_of(scene: &Scene, field: Field, [theta_deg, phi_deg]: [f64; 2]) -> Scene {
    let light = illuminant(ILLUMINANT, &scene.grid).unwrap_or_else(|_| Spectrum::constant(&scene.grid, 1.0));
    let part = EnvironmentPart {
        field: Arc::new(field),
        share: 1.0,
        spectrum: light.clone().into(),
        vibration: None,
    };
    let mut lit = scene.clone().unpolarised();
    lit.lighting = Lighting {
        illuminance_lx: 1000.0,
        diffuse: 0.0,
        diffuse_spectrum: light.into(),
        directed: Vec::new(),
        environment: vec![Environment { parts: vec![part] }],
        front_light: None,
        port: None,
    };
    lit.viewer =
        Viewer { theta_deg: vec![theta_deg], phi_deg: vec![phi_deg], field_deg: 0.0, ..scene.viewer };
    lit.metrics = Metrics::default();
    if let Stop::Target(_) = lit.solver.stop {
        lit.solver.stop = Stop::RelativeError { target: USUAL_TARGET, per_wavelength: false };
    }
    if lit.solver.angle_medium == AngleMedium::Glass {
        lit.solver.angle_medium = AngleMedium::Air;
    }
    lit
}

impl StateGloss {
    fn of(fluxes: &[Option<Flux>], state: usize, haze: Option<f64>) -> Self {
        let flux =
            |number: usize| fluxes.get(number)?.as_ref().and_then(|flux| flux.states.get(state)).copied();
        let gloss = |number: usize| {
            let (_, theta_deg, _) = GLOSSMETERS[number];
            let standard = fresnel_reflectance(1.0, INDEX_OF_STANDARD, theta_deg.to_radians().sin());
            flux(number).map(|both| both.map(|value| 100.0 * value / standard))
        };
        let [gloss_20, gloss_60, gloss_85] = [0, 1, 2].map(gloss);
        let slits = flux(GLOSSMETERS.len()).zip(flux(GLOSSMETERS.len() + 1));
        let distinctness = slits.filter(|([mirrored, _], _)| *mirrored > 0.0).map(distinctness);
        let part = |which: usize| GlossMetrics {
            gloss_20: gloss_20.map(|both| both[which]),
            gloss_60: gloss_60.map(|both| both[which]),
            gloss_85: gloss_85.map(|both| both[which]),
            distinctness_of_image: distinctness.map(|both| both[which]),
            haze_percent: haze.map(|haze| if which == 0 { haze } else { 1e-4 * haze }),
        };
        Self { values: part(0), error: part(1) }
    }
}

/// Distinctness of image and its error, from the fluxes in the mirror direction and beside it.
fn distinctness(([mirrored, mirrored_error], [beside, beside_error]): ([f64; 2], [f64; 2])) -> [f64; 2] {
    let ratio = beside / mirrored;
    let error = (beside_error / mirrored).hypot(ratio * mirrored_error / mirrored);
    [100.0 * (1.0 - ratio), 100.0 * error]
}
