//! OpenEXR maps with R, G and B, or one luminance, or a channel for each wavelength.
//!
//! Spectral channels are named as in A. Fichet et al., *An OpenEXR layout for spectral images*, JCGT 10(3), 2021
//! (`S0.550,000000nm`), or by the wavelength alone (`550nm`).

use std::io::Cursor;

use exr::image::FlatSamples;
use exr::meta::MetaData;
use exr::prelude::{ReadChannels, ReadLayers};

use super::map::{LightMap, MapChannel, MapColour, check_size};
use super::primaries::Primaries;
use super::problem::MapProblem;

pub(super) const MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];

/// Largest number of values of all channels.
const MOST_VALUES: usize = 1 << 26;

pub(super) fn read(bytes: &[u8]) -> Result<(LightMap, Option<Primaries>), MapProblem> {
    let refused = |error: exr::error::Error| MapProblem::Exr { message: error.to_string() };
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(refused)?;
    let headers = &meta.headers;
    let names = || {
        let all = headers.iter().flat_map(|header| &header.channels.list);
        all.map(|channel| channel.name.to_string()).collect::<Vec<_>>().join(", ")
    };
    let [header] = &headers[..] else { return Err(MapProblem::Channels { found: names() }) };
    let (width, height) = (header.layer_size.width(), header.layer_size.height());
    check_size(width, height)?;
    let count = header.channels.list.len();
    if header.deep || width.saturating_mul(height).saturating_mul(count) > MOST_VALUES {
        return Err(MapProblem::Channels { found: names() });
    }
    let reader = exr::prelude::read().no_deep_data().largest_resolution_level().all_channels();
    let image =
        reader.first_valid_layer().all_attributes().from_buffered(Cursor::new(bytes)).map_err(refused)?;
    let named: Vec<(String, Vec<f32>)> = image
        .layer_data
        .channel_data
        .list
        .into_iter()
        .filter(|channel| channel.sampling.area() == 1)
        .map(|channel| (channel.name.to_string(), values(&channel.sample_data)))
        .collect();
    let channels = chosen(named).ok_or_else(|| MapProblem::Channels { found: names() })?;
    if channels.iter().any(|channel| channel.radiance.len() != width * height) {
        return Err(MapProblem::Channels { found: names() });
    }
    let pair = |at: exr::math::Vec2<f32>| [f64::from(at.0), f64::from(at.1)];
    let attributes = &header.shared_attributes;
    let primaries = attributes
        .chromaticities
        .map(|all| [pair(all.red), pair(all.green), pair(all.blue), pair(all.white)]);
    let mut notes = Vec::new();
    if header.own_attributes.white_luminance.is_some() {
        notes.push("whiteLuminance is not used: the values are taken as radiances".to_owned());
    }
    let window = attributes.display_window;
    if (window.position, window.size) != (header.own_attributes.layer_position, header.layer_size) {
        notes.push(
            "the display window differs from the data window and is not used: the data window is taken as the whole sphere"
                .to_owned(),
        );
    }
    Ok((LightMap { width, height, channels, notes }, primaries))
}

fn values(samples: &FlatSamples) -> Vec<f32> {
    match samples {
        FlatSamples::F16(values) => values.iter().map(|value| value.to_f32()).collect(),
        FlatSamples::F32(values) => values.clone(),
        FlatSamples::U32(values) => values.iter().map(|value| *value as f32).collect(),
    }
}

/// Selects all wavelengths, or R, G and B, or Y.
fn chosen(mut named: Vec<(String, Vec<f32>)>) -> Option<Vec<MapChannel>> {
    let mut spectral: Vec<(f64, usize)> =
        named.iter().enumerate().filter_map(|(k, (name, _))| Some((wavelength_nm(name)?, k))).collect();
    let mut taken = |k: usize, colour| MapChannel { colour, radiance: std::mem::take(&mut named[k].1) };
    if spectral.len() > 1 {
        spectral.sort_by(|a, b| a.0.total_cmp(&b.0));
        let rises = spectral.windows(2).all(|pair| pair[0].0 < pair[1].0);
        return rises.then(|| spectral.iter().map(|(nm, k)| taken(*k, MapColour::Wavelength(*nm))).collect());
    }
    let find = |name: &str| named.iter().position(|(known, _)| known == name);
    let colours: &[(&str, MapColour)] = if find("R").is_some() {
        &[("R", MapColour::Red), ("G", MapColour::Green), ("B", MapColour::Blue)]
    } else {
        &[("Y", MapColour::Grey)]
    };
    let found: Vec<(usize, MapColour)> =
        colours.iter().filter_map(|(name, colour)| Some((find(name)?, *colour))).collect();
    if found.len() != colours.len() {
        return None;
    }
    Some(
        found
            .into_iter()
            .map(|(k, colour)| MapChannel { colour, radiance: std::mem::take(&mut named[k].1) })
            .collect(),
    )
}

/// Returns the wavelength in the name of a channel, nm; only for emitted light, the first Stokes component.
fn wavelength_nm(name: &str) -> Option<f64> {
    let number = name.strip_suffix("nm")?;
    let number = number.strip_prefix("S0.").unwrap_or(number).replace(',', ".");
    number.parse().ok().filter(|nm| (30.0..=1e6).contains(nm))
}
