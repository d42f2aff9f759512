//! Maps of light: pictures of the whole sphere as radiance fields, one for each spectrum. Regions may have
//! spectra of their own.

use std::sync::Arc;

use papilio_colour::Observer;
use papilio_display::environment::{MapField, Panorama, Pose};
use papilio_display::scene::{Environment, EnvironmentPart};
use papilio_formats::{LightMap, MapChannel, MapColour, read_light_map};
use papilio_spectra::{Grid, LightSpectrum, SpectraError, Spectrum, Tabulated, srgb_primaries};
use serde_json::json;

use super::Resolver;
use crate::describe::environment as describe;
use crate::mistake;
use crate::origin::Origin;
use crate::read::Spanned;

/// Luminous efficacy of a picture in red, green and blue, lm/W: the convention of Radiance.
const PICTURE_LM_PER_W: f64 = 179.0;

/// Light of a map on the display.
#[derive(Debug, Clone, Copy)]
pub(super) struct MapLight {
    /// Illuminance by the map's absolute values, lx.
    pub(super) lux: f64,
    /// Share of the scenario's light.
    pub(super) share: f64,
}

impl Resolver<'_> {
    /// Resolves a map; `white` is the spectrum of its white.
    pub(super) fn map(
        &mut self,
        key: &str,
        map: &Spanned<describe::Map>,
        white: Option<LightSpectrum>,
    ) -> Option<Environment> {
        let named = || format!("{key} {} {white:?}", json!(map));
        self.cached(named, |this| this.map_uncached(key, map, white.clone()))
    }

    fn map_uncached(
        &mut self,
        key: &str,
        map: &Spanned<describe::Map>,
        white: Option<LightSpectrum>,
    ) -> Option<Environment> {
        let mut picture = self.data(&map.file.value, map.file.origin, read_light_map)?;
        self.notes.extend(picture.notes.drain(..).map(|note| format!("{key}: {note}")));
        let spectral = matches!(picture.channels.first()?.colour, MapColour::Wavelength(_));
        let spectrum = map.spectrum.value.is_some().then_some(("spectrum", map.spectrum.origin));
        let regions = map.regions.first().map(|first| ("regions", first.origin));
        if let Some((key, at)) = spectrum.or(regions).filter(|_| spectral) {
            self.errors.push(at, mistake::not_with(key, "a map that has spectra of its own"));
            return None;
        }
        let white = white?;
        let lifted = lifted(&picture, &white, &self.grid);
        let mut spectra = self.sampled(&map.file.value, map.file.origin, lifted)?;
        let observer = Observer::new(&self.grid).ok()?;
        let luminance = |spectrum: &LightSpectrum| observer.luminance_of_light(spectrum);
        let in_white = PICTURE_LM_PER_W / luminance(&white);
        let lm_per_w = |spectrum: &LightSpectrum| luminance(spectrum) * if spectral { 1.0 } else { in_white };
        let mut lm_per_w: Vec<f64> = spectra.iter().map(lm_per_w).collect();
        let colours = lm_per_w.len();
        for (i, region) in map.regions.iter().enumerate() {
            let held = self.region(&format!("{key}.regions.{i}"), region, &picture)?;
            let luminance = held.take(&mut picture, &lm_per_w[..colours]);
            picture.channels.push(MapChannel { colour: MapColour::Grey, radiance: luminance });
            spectra.push(held.spectrum);
            lm_per_w.push(PICTURE_LM_PER_W);
        }
        let panorama = Panorama {
            width: picture.width,
            height: picture.height,
            channels: picture.channels.iter().map(|channel| &channel.radiance[..]).collect(),
        };
        let fields = panorama.over(Pose { tilt_deg: map.tilt_deg.0 }, map.rotate_deg.0);
        let mut parts = Vec::new();
        let (mut above, mut everywhere) = (0.0, 0.0);
        for (k, (field, (spectrum, lm_per_w))) in
            fields.into_iter().zip(spectra.into_iter().zip(lm_per_w)).enumerate()
        {
            everywhere += lm_per_w * panorama.light(k);
            if let Some(MapField { field, irradiance, light }) = field {
                above += lm_per_w * light;
                parts.push(EnvironmentPart {
                    field: Arc::new(field),
                    share: irradiance * lm_per_w,
                    spectrum,
                    vibration: None,
                });
            }
        }
        let lux: f64 = parts.iter().map(|part| part.share).sum();
        if !(lux > 0.0 && lux.is_finite()) {
            self.errors.push(map.file.origin, mistake::dark_field());
            return None;
        }
        parts.iter_mut().for_each(|part| part.share *= map.share.0 / lux);
        parts.retain(|part| part.share > 0.0 || map.share.0 == 0.0);
        self.maps.push(MapLight { lux, share: map.share.0 });
        self.notes.push(format!(
            "{key}: the absolute values of the map correspond to {} on the display; `illuminance_lx` and `share` set the \
             level, unless illuminance_lx = \"from-map\". {:.1} % of the map's light comes from below the \
             display's plane and is ignored",
            in_lux(lux),
            100.0 * (1.0 - above / everywhere).max(0.0)
        ));
        Some(Environment { parts })
    }

    /// Resolves a region: its pixels and its spectrum.
    fn region(&mut self, key: &str, region: &describe::Region, picture: &LightMap) -> Option<Region> {
        let spectrum = self.light(&format!("{key}.spectrum"), &region.spectrum);
        let elevation = region.elevation_deg.iter().map(|at| at.0).collect();
        let elevation = self.pair(elevation, region.elevation_deg.origin)?;
        let azimuth = region.azimuth_deg.iter().map(|at| at.0).collect();
        let [from, to] = self.pair(azimuth, region.azimuth_deg.origin)?;
        let (rows, columns) = (picture.height as f64, picture.width as f64);
        let is_held = |pixel: usize| {
            let (row, column) = (pixel / picture.width, pixel % picture.width);
            let up = 90.0 - 180.0 * (row as f64 + 0.5) / rows;
            // To the right in the picture is clockwise; its centre is at -90 deg.
            let around = 90.0 - 360.0 * (column as f64 + 0.5) / columns;
            (elevation[0]..=elevation[1]).contains(&up) && (around - from).rem_euclid(360.0) <= to - from
        };
        let pixels: Vec<usize> =
            (0..picture.width * picture.height).filter(|pixel| is_held(*pixel)).collect();
        if pixels.is_empty() {
            self.warnings.push(format!("{key} is smaller than a pixel of the map, and contains none"));
        }
        Some(Region { pixels, spectrum: spectrum? })
    }

    /// Returns two angles, of which the first must be below the second.
    fn pair(&mut self, angles: Vec<f64>, origin: Origin) -> Option<[f64; 2]> {
        let wrong = match angles[..] {
            [from, to] if from < to => return Some([from, to]),
            [from, to] => mistake::edges("region", from, to, "a region whose end is above its start"),
            _ => mistake::another_length("two angles: the start and the end"),
        };
        self.errors.push(origin, wrong);
        None
    }
}

/// A region of a picture with a spectrum of its own.
struct Region {
    pixels: Vec<usize>,
    spectrum: LightSpectrum,
}

impl Region {
    /// Removes its pixels from the colour channels of the picture, which have these lm/W. Returns their
    /// luminances, 1 for white, and 0 for all other pixels.
    fn take(&self, picture: &mut LightMap, lm_per_w: &[f64]) -> Vec<f32> {
        let mut luminance = vec![0.0; picture.width * picture.height];
        for (channel, lm_per_w) in picture.channels.iter_mut().zip(lm_per_w) {
            for &pixel in &self.pixels {
                let radiance = f64::from(std::mem::take(&mut channel.radiance[pixel]));
                luminance[pixel] += (radiance * lm_per_w / PICTURE_LM_PER_W) as f32;
            }
        }
        luminance
    }
}

fn in_lux(lux: f64) -> String {
    if (0.01..1e7).contains(&lux) { format!("{lux:.2} lx") } else { format!("{lux:.2e} lx") }
}

/// Returns the spectrum of each channel.
fn lifted(
    picture: &LightMap,
    white: &LightSpectrum,
    grid: &Grid,
) -> Result<Vec<LightSpectrum>, SpectraError> {
    let wavelengths: Vec<f64> = picture
        .channels
        .iter()
        .filter_map(|channel| match channel.colour {
            MapColour::Wavelength(nm) => Some(nm),
            _ => None,
        })
        .collect();
    let of = |number: usize, colour: MapColour| {
        let primary = |k: usize| {
            if wavelengths.is_empty() {
                white.filtered(grid, |grid| Ok(srgb_primaries(grid)?[k].clone()))
            } else {
                Ok(white.clone())
            }
        };
        match colour {
            MapColour::Red => primary(0),
            MapColour::Green => primary(1),
            MapColour::Blue => primary(2),
            MapColour::Grey => Ok(white.clone()),
            MapColour::Wavelength(_) => LightSpectrum::sampled(grid, |grid| hat(&wavelengths, number, grid)),
        }
    };
    picture.channels.iter().enumerate().map(|(number, channel)| of(number, channel.colour)).collect()
}

/// Returns a spectrum that is 1 at wavelength `k` and decreases linearly to 0 at its neighbours: linear
/// interpolation between channels.
fn hat(wavelengths: &[f64], k: usize, grid: &Grid) -> Result<Spectrum, SpectraError> {
    let values = (0..wavelengths.len()).map(|at| if at == k { 1.0 } else { 0.0 }).collect();
    Tabulated::new(wavelengths.to_vec(), values)?.on(grid)
}
