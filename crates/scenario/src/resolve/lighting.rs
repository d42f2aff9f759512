//! The room's light.

use papilio_display::scene::{DirectedLight, Lighting};
use papilio_spectra::{
    Grid, SpectraError, Spectrum, daylight, illuminant, illuminant_names, ohno_led, planck,
};

use super::Resolver;
use crate::describe::lighting::{self as describe, LightModel, LightSpectrum};
use crate::problem::Problem;
use crate::read::At;

/// Where daylight and black bodies have the value 1, nm.
const UNIT_NM: f64 = 560.0;

impl Resolver<'_> {
    pub(super) fn lighting(&mut self, lighting: &At<describe::Lighting>) -> Option<Lighting> {
        self.limit(&lighting.directed, "sources", lighting.directed.len(), 256)?;
        let diffuse = lighting.diffuse.map_or(0.0, |share| share.0);
        let sum = diffuse + lighting.directed.iter().map(|source| source.share.0).sum::<f64>();
        if (sum - 1.0).abs() > 1e-6 {
            let what = "`diffuse` and the directed shares";
            let origin =
                lighting.directed.last().map_or(lighting.diffuse.origin, |source| source.share.origin);
            self.errors.push(origin, Problem::Sum { what, sum, expected: "1" });
        }
        let general = self.light(&lighting.spectrum);
        let sources = lighting.directed.iter();
        let directed: Vec<_> = sources.map(|source| self.directed(source, general.as_ref())).collect();
        Some(Lighting {
            illuminance_lx: lighting.illuminance_lx.0,
            diffuse,
            diffuse_spectrum: general?,
            directed: directed.into_iter().collect::<Option<_>>()?,
        })
    }

    fn directed(&mut self, source: &describe::Directed, general: Option<&Spectrum>) -> Option<DirectedLight> {
        let radius_deg = source.radius_deg.map(|radius| radius.0);
        let reach = source.theta_deg.0.abs() + radius_deg.unwrap_or(0.0);
        if radius_deg.is_some() && reach >= 90.0 {
            self.err(&source.radius_deg, Problem::BelowHorizon { theta_deg: reach });
        }
        let spectrum = match &source.spectrum.value {
            Some(own) => self.light(&At { value: own.clone(), origin: source.spectrum.origin }),
            None => general.cloned(),
        };
        Some(DirectedLight {
            theta_deg: source.theta_deg.0,
            phi_deg: source.phi_deg.0,
            share: source.share.0,
            spectrum: spectrum?,
            radius_deg,
            normal_to_beam: source.normal_to_beam.value,
        })
    }

    /// A relative spectrum on the grid: nowhere negative, somewhere positive.
    fn light(&mut self, light: &At<LightSpectrum>) -> Option<Spectrum> {
        let spectrum = match &light.value {
            LightSpectrum::Text(name) => self.named_light(name, light)?,
            LightSpectrum::One(model) => self.model(&At { value: model.clone(), origin: light.origin })?,
            LightSpectrum::Sum(models) => {
                self.limit(light, "models", models.len(), 256)?;
                if models.is_empty() {
                    self.err(light, Problem::EmptyList);
                    return None;
                }
                let parts: Vec<_> = models.iter().map(|model| self.model(model)).collect();
                let parts = parts.into_iter().collect::<Option<Vec<_>>>()?;
                let dark = Spectrum::constant(&self.grid, 0.0);
                parts.iter().fold(dark, |sum, part| sum.zip_map(part, |a, b| a + b))
            }
        };
        if spectrum.max() > 0.0 {
            return Some(spectrum);
        }
        let range_nm = (self.grid.start_nm(), self.grid.stop_nm());
        self.err(light, Problem::NoLight { range_nm });
        None
    }

    fn named_light(&mut self, name: &str, light: &At<LightSpectrum>) -> Option<Spectrum> {
        match illuminant(name, &self.grid) {
            Err(SpectraError::UnknownName { .. }) if self.is_file(name) => {
                let table = self.table(name, light.origin)?;
                self.check_values(name, light.origin, &table, |v| v >= 0.0, "0 or more")?;
                let on_grid = table.on(&self.grid);
                self.sampled(name, light.origin, on_grid)
            }
            Err(SpectraError::UnknownName { .. }) => {
                let names = illuminant_names();
                self.err(light, Problem::UnknownName { kind: "light", name: name.to_owned(), names });
                None
            }
            on_grid => self.sampled(name, light.origin, on_grid),
        }
    }

    /// One model of light, times its weight.
    fn model(&mut self, model: &At<LightModel>) -> Option<Spectrum> {
        let grid = self.grid;
        let (name, on_grid) =
            match (model.led_nm.value, model.width_nm.value, model.daylight_K.value, model.planck_K.value) {
                (Some(peak), Some(width), None, None) => ("the LED", ohno_led(&grid, peak.0, width.0)),
                (None, None, Some(cct), None) => ("daylight", unit(|grid| daylight(cct.0, grid), &grid)),
                (None, None, None, Some(t)) => ("the black body", unit(|grid| planck(t.0, grid), &grid)),
                (led, _, daylight, planck) => {
                    let given = [led.is_some(), daylight.is_some(), planck.is_some()];
                    let given = given.into_iter().filter(|given| *given).count();
                    let keys = "`led_nm` with `width_nm`, `daylight_K` and `planck_K`";
                    // An LED without its width, or a width alone, is none of them.
                    self.err(model, Problem::ExactlyOne { keys, given: if given > 1 { given } else { 0 } });
                    return None;
                }
            };
        Some(self.sampled(name, model.origin, on_grid)?.map(|v| v * model.weight.0))
    }
}

/// A spectrum, 1 at 560 nm.
fn unit(
    model: impl Fn(&Grid) -> Result<Spectrum, SpectraError>,
    grid: &Grid,
) -> Result<Spectrum, SpectraError> {
    let one = Grid::new(UNIT_NM, UNIT_NM + 1.0, 1.0)?;
    let scale = model(&one)?[0];
    Ok(model(grid)?.map(|v| v / scale))
}
