//! Ambient light of a scene: its luminance by direction, for figures.

use std::f64::consts::PI;

use papilio_optics::Beta;

use crate::DisplayError;
use crate::scene::Scene;
use crate::setup::angle_index;

/// Ambient light over the display's hemisphere; angles in air.
#[derive(Debug, Clone, PartialEq)]
pub struct AmbientLight {
    /// Inclinations, degrees, ascending to 90.
    pub theta_deg: Vec<f64>,
    /// Azimuths, degrees, ascending from 0.
    pub phi_deg: Vec<f64>,
    /// Luminance of the light from each direction without directed sources, cd/m2; shape `[theta][phi]`.
    pub luminance_cd_m2: Vec<f64>,
    /// Illuminance of the diffuse light, lx.
    pub diffuse_lx: f64,
    /// Illuminance of each environment, lx.
    pub environment_lx: Vec<f64>,
    /// The directed sources.
    pub directed: Vec<AmbientSource>,
    /// Directions of the views, degrees: inclination and azimuth.
    pub views_deg: Vec<[f64; 2]>,
}

/// Directed source of the ambient light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AmbientSource {
    /// Inclination, degrees; negative: towards phi + 180.
    pub theta_deg: f64,
    /// Azimuth, degrees.
    pub phi_deg: f64,
    /// Angular radius, degrees; 0: collimated.
    pub radius_deg: f64,
    /// Illuminance on the display, lx.
    pub illuminance_lx: f64,
}

/// Computes the ambient light by direction; `None` if it is uniform or comes from a single direction, which a
/// figure need not show.
///
/// # Errors
/// As [`ambient_light`].
pub fn ambient_light_by_direction(scene: &Scene) -> Result<Option<AmbientLight>, DisplayError> {
    let is_plain = scene.lighting.environment.is_empty() && scene.lighting.directed.len() < 2;
    if is_plain { Ok(None) } else { ambient_light(scene).map(Some) }
}

/// Computes the ambient light by direction.
///
/// # Errors
/// If the scene's angles are in a glass whose index depends on wavelength.
pub fn ambient_light(scene: &Scene) -> Result<AmbientLight, DisplayError> {
    let index = angle_index(scene)?;
    let in_air = |deg: f64| (index * deg.to_radians().sin()).clamp(-1.0, 1.0).asin().to_degrees();
    let lighting = &scene.lighting;
    let theta_deg: Vec<f64> = (0..=90).map(f64::from).collect();
    let phi_deg: Vec<f64> = (0..180).map(|k| 2.0 * f64::from(k)).collect();
    let parts = || lighting.environment.iter().flat_map(|one| &one.parts);
    let around = |theta: f64, phi: f64| {
        let beta = Beta::from_source(theta, phi, 1.0);
        parts().map(|part| part.share * part.field.radiance(beta)).sum::<f64>()
    };
    // Edges of sources are often at integer degrees: the mean over both sides avoids a dependence on
    // rounding.
    let luminance = |theta: f64, phi: f64| {
        let beside = [-1.0, 1.0].map(|side| (theta + 0.3 * side).clamp(0.05, 89.95));
        let all = beside.into_iter().flat_map(|theta| [-0.6, 0.6].map(|turn| around(theta, phi + turn)));
        lighting.illuminance_lx * (lighting.diffuse / PI + 0.25 * all.sum::<f64>())
    };
    let directions = theta_deg.iter().flat_map(|theta| phi_deg.iter().map(|phi| (*theta, *phi)));
    let luminance_cd_m2 = directions.map(|(theta, phi)| luminance(theta, phi)).collect();
    let lamp = |lamp: &crate::scene::DirectedLight| {
        let cosine = if lamp.normal_to_beam { lamp.theta_deg.to_radians().cos() } else { 1.0 };
        AmbientSource {
            theta_deg: in_air(lamp.theta_deg),
            phi_deg: lamp.phi_deg,
            radius_deg: lamp.radius_deg.unwrap_or(0.0),
            illuminance_lx: lamp.share * cosine * lighting.illuminance_lx,
        }
    };
    let of_environment = |one: &crate::scene::Environment| {
        lighting.illuminance_lx * one.parts.iter().map(|part| part.share).sum::<f64>()
    };
    let viewer = &scene.viewer;
    let views =
        viewer.phi_deg.iter().flat_map(|phi| viewer.theta_deg.iter().map(|theta| [in_air(*theta), *phi]));
    Ok(AmbientLight {
        diffuse_lx: lighting.diffuse * lighting.illuminance_lx,
        environment_lx: lighting.environment.iter().map(of_environment).collect(),
        directed: lighting.directed.iter().map(lamp).collect(),
        views_deg: views.collect(),
        luminance_cd_m2,
        theta_deg,
        phi_deg,
    })
}
