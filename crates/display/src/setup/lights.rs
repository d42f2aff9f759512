//! Lights of a scene in the plane of the display: spectra, levels, and weights of reflectances in colours.

use papilio_colour::{Between, Observer};
use papilio_spectra::{EveryNm, Grid, LightSpectrum, Spectrum};

use crate::DisplayError;
use crate::scene::{self, Scene};

/// Light of a source in the display plane.
#[derive(Debug, Clone)]
pub(crate) struct Light {
    /// Spectral irradiance, W/(m2 nm).
    pub(crate) irradiance: Spectrum,
    /// Illuminance, lx.
    pub(crate) illuminance_lx: f64,
    /// Number, from 0, of the contribution in the results to which this light belongs.
    pub(crate) term: usize,
    /// Weights of reflectances if it has lines narrower than the step of the grid.
    pub(crate) lines: Option<LineWeights>,
    /// Weights of reflectances at the wavelengths of the grid in X, Y and Z, in the unit of its irradiance times nm, from the light at
    /// every nanometre and reflectances [`between`] the wavelengths; `None` if it is known only on the grid.
    pub(crate) every_nm: Option<[Vec<f64>; 3]>,
    /// Weights of reflectances at every nanometre in X, Y and Z, in the same unit, if the display changes within a step.
    pub(crate) at_each_nm: Option<[Vec<f64>; 3]>,
}

/// Weights with which reflectances at the wavelengths of the grid contribute to what is seen of a light with
/// narrow lines, in the unit of its irradiance times nm.
#[derive(Debug, Clone)]
pub(crate) struct LineWeights {
    /// X, Y and Z of the reported colours, for reflectances that are linear between the wavelengths.
    pub(crate) xyz: [Vec<f64>; 3],
    /// Y of CIE 1931, for luminances.
    pub(crate) y_1931: Vec<f64>,
}

/// Returns how reflectances are estimated to run between the wavelengths of the grid: tables are linear there (the scenario compares
/// those with more points); interference and scattering in volumes make them curved.
pub(super) fn between(scene: &Scene) -> Between {
    let display = &scene.display;
    // Below flat layers, the scenario compares a film pixel with itself within a step.
    let is_coated =
        display.layers.iter().any(|layer| matches!(layer.interface, scene::Interface::Coating(_)));
    let is_film = matches!(display.pixel, scene::Pixel::Film(_));
    if is_film && display.is_flat() && !is_coated && !scene.unresolved.is_empty() {
        return Between::Linear;
    }
    let interferes = matches!(display.pixel, scene::Pixel::Film(_) | scene::Pixel::Crystal(_));
    let is_curved = |layer: &scene::Layer| {
        matches!(layer.interface, scene::Interface::Coating(_) | scene::Interface::OfSurface(_))
            || layer.medium.scattering.is_some()
    };
    match interferes || display.layers.iter().any(is_curved) {
        true => Between::Cubic,
        false => Between::Linear,
    }
}

impl Light {
    /// Light of this illuminance, lx.
    fn new(
        spectrum: &LightSpectrum,
        illuminance_lx: f64,
        term: usize,
        scene: &Scene,
        observer: &Observer,
    ) -> Result<Self, DisplayError> {
        let at_each_nm = |grid: &Grid, values: &[f64]| -> Result<[Vec<f64>; 3], DisplayError> {
            let seen = Observer::of(scene.metrics.observer, grid)?;
            let product = |bar: &[f64]| bar.iter().zip(values).map(|(bar, e)| bar * e).collect();
            Ok(seen.weights().map(product))
        };
        let needs_each_nm = scene.within_step.is_some();
        let Some(own) = spectrum.every_nm() else {
            let irradiance = observer.scale_to_illuminance(spectrum, illuminance_lx)?;
            let at_each_nm = match scene.grid.integers() {
                Ok(every_nm) if needs_each_nm => {
                    let between =
                        |nm: f64| scene.grid.between(nm).map(|(bin, share)| share * irradiance[bin]).sum();
                    let values: Vec<f64> = every_nm.wavelengths_nm().into_iter().map(between).collect();
                    Some(at_each_nm(&every_nm, &values)?)
                }
                _ => None,
            };
            return Ok(Self { irradiance, illuminance_lx, term, lines: None, every_nm: None, at_each_nm });
        };
        let luminous = Observer::new(&own.grid)?;
        let values = luminous.scale_to_illuminance(&own.values, illuminance_lx)?;
        let scale = values.max() / own.values.max();
        let light = EveryNm { grid: own.grid, values };
        let seen = Observer::of(scene.metrics.observer, &own.grid)?;
        let lines = spectrum.lines().map(|_| {
            let [_, y_1931, _] = luminous.of_light(&light, &scene.grid, Between::Linear);
            LineWeights { xyz: seen.of_light(&light, &scene.grid, Between::Linear), y_1931 }
        });
        let irradiance = match lines {
            Some(_) => spectrum.map(|e| e * scale),
            None => observer.scale_to_illuminance(spectrum, illuminance_lx)?,
        };
        let every_nm =
            (scene.grid.step_nm() > 1.0).then(|| seen.of_light(&light, &scene.grid, between(scene)));
        let at_each_nm = match needs_each_nm {
            true => Some(at_each_nm(&light.grid, &light.values)?),
            false => None,
        };
        Ok(Self { irradiance, illuminance_lx, term, lines, every_nm, at_each_nm })
    }
}

/// Returns the lights of a scene, in the order of its sources.
pub(super) fn lights(scene: &Scene, observer: &Observer) -> Result<Vec<Light>, DisplayError> {
    let lighting = &scene.lighting;
    let light = |term: usize, fraction: f64, spectrum: &LightSpectrum| {
        Light::new(spectrum, fraction * lighting.illuminance_lx, term, scene, observer)
    };
    let mut lights = vec![light(0, lighting.diffuse, &lighting.diffuse_spectrum)?];
    for (i, directed) in lighting.directed.iter().enumerate() {
        let cosine = if directed.normal_to_beam { directed.theta_deg.to_radians().cos() } else { 1.0 };
        lights.push(light(1 + i, directed.share * cosine, &directed.spectrum)?);
    }
    for (i, environment) in lighting.environment.iter().enumerate() {
        for part in &environment.parts {
            lights.push(light(1 + lighting.directed.len() + i, part.share, &part.spectrum)?);
        }
    }
    if let Some(guide) = &lighting.front_light {
        let term = 1 + lighting.directed.len() + lighting.environment.len();
        lights.push(Light::new(&guide.spectrum, guide.illuminance_lx, term, scene, observer)?);
    }
    Ok(lights)
}
