//! Maps of light: pictures of the whole sphere as fields, one for each spectrum.

use std::sync::Arc;

use papilio_colour::Observer;
use papilio_display::room::{Panorama, Pose};
use papilio_display::scene::{Environment, EnvironmentPart, Field};
use papilio_formats::{LightMap, MapColour, read_light_map};
use papilio_spectra::{Grid, SpectraError, Spectrum, Tabulated, srgb_primaries};

use super::Resolver;
use crate::describe::environment as describe;
use crate::problem::Problem;
use crate::read::At;

/// Lumens for each watt of a picture in red, green and blue, by Radiance's convention.
const PICTURE_LM_PER_W: f64 = 179.0;

/// Parts of linear sRGB's Y.
const LUMA: [f64; 3] = [0.2126, 0.7152, 0.0722];

impl Resolver<'_> {
    /// The parts of a map; `white` is the spectrum of its white.
    pub(super) fn map(
        &mut self,
        key: &str,
        map: &At<describe::Map>,
        white: Option<Spectrum>,
    ) -> Option<Environment> {
        let picture = self.data(&map.file.value, map.file.origin, read_light_map)?;
        let spectral = matches!(picture.channels.first()?.colour, MapColour::Wavelength(_));
        if spectral && map.spectrum.value.is_some() {
            let problem = Problem::NotWith { key: "spectrum", beside: "a map that has spectra of its own" };
            self.errors.push(map.spectrum.origin, problem);
            return None;
        }
        let lifted = lifted(&picture, &white?, &self.grid);
        let spectra = self.sampled(&map.file.value, map.file.origin, lifted)?;
        let panorama = Panorama {
            width: picture.width,
            height: picture.height,
            channels: picture.channels.iter().map(|channel| &channel.radiance[..]).collect(),
        };
        let cells = panorama.over(Pose { tilt_deg: map.tilt_deg.0 }, map.rotate_deg.0);
        let observer = Observer::new(&self.grid).ok()?;
        let (mut parts, mut lux) = (Vec::new(), 0.0);
        let (mut above, mut everywhere) = (0.0, 0.0);
        for (k, spectrum) in spectra.into_iter().enumerate() {
            let luminous = observer.luminance(&spectrum);
            above += luminous * cells.light(k);
            everywhere += luminous * panorama.light(k);
            let Some((field, irradiance)) =
                Field::new(&cells.edges_deg, cells.columns, cells.channels[k].clone())
            else {
                continue;
            };
            lux += irradiance
                * match picture.channels[k].colour {
                    MapColour::Red => PICTURE_LM_PER_W * LUMA[0],
                    MapColour::Green => PICTURE_LM_PER_W * LUMA[1],
                    MapColour::Blue => PICTURE_LM_PER_W * LUMA[2],
                    MapColour::Grey => PICTURE_LM_PER_W,
                    MapColour::Wavelength(_) => luminous,
                };
            parts.push(EnvironmentPart { field: Arc::new(field), share: irradiance * luminous, spectrum });
        }
        let whole: f64 = parts.iter().map(|part| part.share).sum();
        if !(whole > 0.0 && whole.is_finite()) {
            self.errors.push(map.file.origin, Problem::DarkField);
            return None;
        }
        parts.iter_mut().for_each(|part| part.share *= map.share.0 / whole);
        parts.retain(|part| part.share > 0.0 || map.share.0 == 0.0);
        self.notes.push(format!(
            "{key}: by its own numbers the map makes {} on the display; the share counts, not they. {:.1} % \
             of its light comes from below the display's plane and is left out",
            in_lux(lux),
            100.0 * (1.0 - above / everywhere).max(0.0)
        ));
        Some(Environment { parts })
    }
}

fn in_lux(lux: f64) -> String {
    if (0.01..1e7).contains(&lux) { format!("{lux:.2} lx") } else { format!("{lux:.2e} lx") }
}

/// A spectrum for each channel.
fn lifted(picture: &LightMap, white: &Spectrum, grid: &Grid) -> Result<Vec<Spectrum>, SpectraError> {
    let wavelengths: Vec<f64> = picture
        .channels
        .iter()
        .filter_map(|channel| match channel.colour {
            MapColour::Wavelength(nm) => Some(nm),
            _ => None,
        })
        .collect();
    let primaries =
        if wavelengths.is_empty() { srgb_primaries(grid)?.map(Some) } else { [const { None }; 3] };
    let of = |number: usize, colour: MapColour| {
        let primary = |k: usize| {
            let part: &Option<Spectrum> = &primaries[k];
            Ok(part.as_ref().map_or_else(|| white.clone(), |part| part.zip_map(white, |a, b| a * b)))
        };
        match colour {
            MapColour::Red => primary(0),
            MapColour::Green => primary(1),
            MapColour::Blue => primary(2),
            MapColour::Grey => Ok(white.clone()),
            MapColour::Wavelength(_) => hat(&wavelengths, number, grid),
        }
    };
    picture.channels.iter().enumerate().map(|(number, channel)| of(number, channel.colour)).collect()
}

/// 1 at wavelength number `k`, linear to 0 at its neighbours: spectra that run linearly between channels.
fn hat(wavelengths: &[f64], k: usize, grid: &Grid) -> Result<Spectrum, SpectraError> {
    let values = (0..wavelengths.len()).map(|at| if at == k { 1.0 } else { 0.0 }).collect();
    Tabulated::new(wavelengths.to_vec(), values)?.on(grid)
}
