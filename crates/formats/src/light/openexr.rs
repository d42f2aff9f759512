//! OpenEXR maps with R, G and B, or X, Y and Z, or luminance with or without chroma, or a channel for each
//! wavelength.
//!
//! Spectral channels are named as in A. Fichet et al., *An OpenEXR layout for spectral images*, JCGT 10(3),
//! 2021 (`S0.550,000000nm`), or by the wavelength alone (`550nm`). The attributes are those of the *Technical
//! introduction to OpenEXR* and of *Standard optional attributes*: the map is the display window, of which
//! pixels outside the data window are dark.

use std::io::Cursor;

use exr::image::{AnyChannel, FlatSamples};
use exr::math::Vec2;
use exr::meta::MetaData;
use exr::meta::header::Header;
use exr::prelude::{ReadChannels, ReadLayers};
use papilio_diagnostics::Diagnostic;

use super::exr_channels::{ChannelSet, channels, chosen, values};
use super::exr_window::{place, window};
use super::map::{LightMap, LinearLight, MapChannel, MapColour, Shape};
use super::primaries::{PICTURE_LM_PER_W, Primaries, XYZ};

pub(super) const MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];

/// Largest number of values of all channels.
const MOST_VALUES: usize = 1 << 26;

pub(super) fn read(bytes: &[u8], shape: Shape) -> Result<LinearLight, Diagnostic> {
    let refused = |error: exr::error::Error| unreadable(&error.to_string());
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(refused)?;
    let headers = &meta.headers;
    let (part, set) = checked(headers, shape)?;
    let header = &headers[part];
    let mut notes = Vec::new();
    let reader = exr::prelude::read().no_deep_data().largest_resolution_level().all_channels();
    let image = reader.all_layers().all_attributes().from_buffered(Cursor::new(bytes)).map_err(refused)?;
    let list =
        image.layer_data.into_iter().nth(part).map(|layer| layer.channel_data.list).unwrap_or_default();
    let opacity = set.opacity().filter(|_| shape == Shape::Picture);
    let opacity = opacity.filter(|name| list.iter().any(|channel| channel.name == *name.as_str()));
    unused(headers, part, &set, opacity.as_deref(), &mut notes);
    let sizes = |channel: &AnyChannel<FlatSamples>| channel.sample_data.len() == header.layer_size.area();
    if !list.iter().all(sizes) {
        return Err(other_channels(headers));
    }
    let mut named: Vec<(String, Vec<f32>)> =
        list.into_iter().map(|channel| (channel.name.to_string(), values(&channel.sample_data))).collect();
    let opacity = opacity.and_then(|name| named.iter_mut().find(|(known, _)| *known == name));
    let opacity =
        opacity.map(|(_, values)| MapChannel { colour: MapColour::Grey, radiance: std::mem::take(values) });
    let primaries = primaries(header, &set, &mut notes);
    let mut channels = channels(named, &set, primaries).ok_or_else(|| other_channels(headers))?;
    let has_opacity = opacity.is_some();
    channels.extend(opacity);
    let rest = if has_opacity { "transparent" } else { "dark" };
    let (width, height) = place(header, shape, &mut channels, rest, &mut notes)?;
    let opacity = if has_opacity { channels.pop().map(|channel| channel.radiance) } else { None };
    meaning(header, shape, &set, &mut channels, &mut notes);
    let primaries = if matches!(set, ChannelSet::Xyz(_)) { Some(XYZ) } else { primaries };
    Ok(LinearLight { map: LightMap { width, height, channels, notes }, primaries, opacity })
}

/// Returns the first part with a map, and its channels. Sizes are checked before memory is allocated.
fn checked(headers: &[Header], shape: Shape) -> Result<(usize, ChannelSet), Diagnostic> {
    let all = || headers.iter().flat_map(|header| &header.channels.list);
    if headers.iter().any(|header| header.deep) {
        let message =
            "it has deep data, several values for each pixel; flatten it in the program that created it";
        return Err(unreadable(message));
    }
    if let Some(coarse) = all().find(|channel| channel.sampling.area() != 1) {
        let message = format!(
            "its channel {} is stored at a lower resolution than the others; convert the colours to R, G and B",
            coarse.name
        );
        return Err(unreadable(&message));
    }
    let found = |(k, header): (usize, &Header)| {
        let names: Vec<String> =
            header.channels.list.iter().map(|channel| channel.name.to_string()).collect();
        Some((k, chosen(&names)?))
    };
    let found = headers.iter().enumerate().find_map(found);
    let (part, set) = found.ok_or_else(|| other_channels(headers))?;
    window(&headers[part], shape)?;
    let count = |header: &Header| header.layer_size.area().saturating_mul(header.channels.list.len());
    let most = headers.iter().map(count).fold(0_usize, usize::saturating_add);
    if most > MOST_VALUES {
        return Err(other_channels(headers));
    }
    Ok((part, set))
}

fn unreadable(message: &str) -> Diagnostic {
    Diagnostic::new(format!("this OpenEXR file cannot be read: {message}"))
}

fn other_channels(headers: &[Header]) -> Diagnostic {
    let all = headers.iter().flat_map(|header| &header.channels.list);
    let found = all.map(|channel| channel.name.to_string()).collect::<Vec<_>>().join(", ");
    Diagnostic::new(format!("this file has the channels {found}")).expected(
        "R, G and B, or X, Y and Z, or Y, or wavelengths such as `S0.550,0nm`, all in one part of the file",
    )
}

/// Notes parts and channels that are not used.
fn unused(headers: &[Header], part: usize, set: &ChannelSet, opacity: Option<&str>, notes: &mut Vec<String>) {
    let used = set.names();
    let left = headers[part].channels.list.iter().map(|channel| channel.name.to_string());
    let left: Vec<String> =
        left.filter(|name| !used.contains(&&**name) && opacity != Some(&**name)).collect();
    if !left.is_empty() {
        notes.push(format!("its channels {} are not used", left.join(", ")));
    }
    let name = |(k, header): (usize, &Header)| {
        let named = header.own_attributes.layer_name.as_ref().map(ToString::to_string);
        (k != part).then(|| named.unwrap_or_else(|| (k + 1).to_string()))
    };
    let others: Vec<String> = headers.iter().enumerate().filter_map(name).collect();
    if !others.is_empty() {
        notes.push(format!("its parts {} are not used", others.join(", ")));
    }
}

fn primaries(header: &Header, set: &ChannelSet, notes: &mut Vec<String>) -> Option<Primaries> {
    let pair = |at: Vec2<f32>| [f64::from(at.0), f64::from(at.1)];
    let all = header.shared_attributes.chromaticities?;
    if matches!(set, ChannelSet::Xyz(_) | ChannelSet::Spectral(_) | ChannelSet::Grey(_)) {
        notes.push("chromaticities are not used: the channels are not red, green and blue".to_owned());
        return None;
    }
    Some([pair(all.red), pair(all.green), pair(all.blue), pair(all.white)])
}

/// Applies, or notes, attributes that concern the meaning of the values.
fn meaning(
    header: &Header,
    shape: Shape,
    set: &ChannelSet,
    channels: &mut [MapChannel],
    notes: &mut Vec<String>,
) {
    let own = &header.own_attributes;
    // A picture is brought to a white of its own.
    if let Some(white) = own.white_luminance.filter(|_| shape == Shape::Sphere) {
        let is_colour = !matches!(set, ChannelSet::Spectral(_));
        if is_colour && white.is_finite() && white > 0.0 {
            let by = f64::from(white) / PICTURE_LM_PER_W;
            let all = channels.iter_mut().flat_map(|channel| &mut channel.radiance);
            all.for_each(|value| *value = (f64::from(*value) * by) as f32);
            notes.push(format!("its values of 1 are {white} cd/m2 (whiteLuminance)"));
        } else {
            notes.push(format!("whiteLuminance {white} is not used"));
        }
    }
    if let Some(Vec2(x, y)) = own.adopted_neutral {
        notes
            .push(format!("adoptedNeutral {x}, {y} is not used: no adaptation to another white takes place"));
    }
    if header.shared_attributes.pixel_aspect != 1.0 {
        let aspect = header.shared_attributes.pixel_aspect;
        let pixels = match shape {
            Shape::Sphere => "cover the whole sphere",
            Shape::Picture => "are taken as square",
        };
        notes.push(format!("pixelAspectRatio {aspect} is not used: the pixels {pixels}"));
    }
    let other = own.other.iter().chain(&header.shared_attributes.other);
    let space = other.filter(|(name, _)| *name == "colorInteropID").map(|(_, value)| value);
    for value in space {
        let found = match value {
            exr::meta::attribute::AttributeValue::Text(text) => text.to_string(),
            _ => "of an unknown type".to_owned(),
        };
        if found != "lin_rec709_scene" {
            let instead = match set {
                ChannelSet::Xyz(_) => "the channels are X, Y and Z",
                ChannelSet::Spectral(_) | ChannelSet::Grey(_) => "the channels are not red, green and blue",
                _ => "primaries are those of `chromaticities`, or of sRGB",
            };
            notes.push(format!("colorInteropID {found} is not used: {instead}"));
        }
    }
}
