//! OpenEXR maps with R, G and B, or X, Y and Z, or luminance with or without chroma, or a channel for each wavelength.
//!
//! Spectral channels are named as in A. Fichet et al., *An OpenEXR layout for spectral images*, JCGT 10(3), 2021
//! (`S0.550,000000nm`), or by the wavelength alone (`550nm`). The attributes are those of the *Technical introduction to OpenEXR*
//! and of *Standard optional attributes*: the map is the display window, of which pixels outside the data window are dark.

use std::io::Cursor;

use exr::image::{AnyChannel, FlatSamples};
use exr::math::Vec2;
use exr::meta::MetaData;
use exr::meta::attribute::{EnvironmentMap, IntegerBounds};
use exr::meta::header::Header;
use exr::prelude::{ReadChannels, ReadLayers};

use super::cube::equirectangular;
use super::map::{LightMap, MapChannel, MapColour, check_size};
use super::primaries::{PICTURE_LM_PER_W, Primaries, XYZ, luminances};
use super::problem::MapProblem;

pub(super) const MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];

/// Largest number of values of all channels.
const MOST_VALUES: usize = 1 << 26;

/// Largest error of a colour from luminance and chroma, relative to the luminance: half precision.
const ROUNDING: f64 = 5e-3;

/// Channels that form a map.
#[derive(Debug, Clone, PartialEq)]
enum ChannelSet {
    Spectral(Vec<(String, f64)>),
    /// Names of red, green and blue, or of X, Y and Z.
    Colours([String; 3]),
    Xyz([String; 3]),
    /// Luminance and (R - Y)/Y, (B - Y)/Y.
    Chroma([String; 3]),
    Grey(String),
}

pub(super) fn read(bytes: &[u8]) -> Result<(LightMap, Option<Primaries>), MapProblem> {
    let refused = |error: exr::error::Error| MapProblem::Exr { message: error.to_string() };
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(refused)?;
    let headers = &meta.headers;
    let (part, set) = checked(headers)?;
    let header = &headers[part];
    let mut notes = Vec::new();
    let reader = exr::prelude::read().no_deep_data().largest_resolution_level().all_channels();
    let image = reader.all_layers().all_attributes().from_buffered(Cursor::new(bytes)).map_err(refused)?;
    let list =
        image.layer_data.into_iter().nth(part).map(|layer| layer.channel_data.list).unwrap_or_default();
    unused(headers, part, &set, &mut notes);
    let sizes = |channel: &AnyChannel<FlatSamples>| channel.sample_data.len() == header.layer_size.area();
    if !list.iter().all(sizes) {
        return Err(MapProblem::Channels { found: names(headers) });
    }
    let named: Vec<(String, Vec<f32>)> =
        list.into_iter().map(|channel| (channel.name.to_string(), values(&channel.sample_data))).collect();
    let primaries = primaries(header, &set, &mut notes);
    let mut channels =
        channels(named, &set, primaries).ok_or_else(|| MapProblem::Channels { found: names(headers) })?;
    let (width, height) = place(header, &mut channels, &mut notes)?;
    meaning(header, &set, &mut channels, &mut notes);
    let primaries = if matches!(set, ChannelSet::Xyz(_)) { Some(XYZ) } else { primaries };
    Ok((LightMap { width, height, channels, notes }, primaries))
}

/// Returns the first part with a map, and its channels. Sizes are checked before memory is allocated.
fn checked(headers: &[Header]) -> Result<(usize, ChannelSet), MapProblem> {
    let all = || headers.iter().flat_map(|header| &header.channels.list);
    if headers.iter().any(|header| header.deep) {
        let message =
            "it has deep data, several values for each pixel; flatten it in the program that created it";
        return Err(MapProblem::Exr { message: message.to_owned() });
    }
    if let Some(coarse) = all().find(|channel| channel.sampling.area() != 1) {
        let message = format!(
            "its channel {} is stored at a lower resolution than the others; convert the colours to R, G and B",
            coarse.name
        );
        return Err(MapProblem::Exr { message });
    }
    let found = |(k, header): (usize, &Header)| {
        let names: Vec<String> =
            header.channels.list.iter().map(|channel| channel.name.to_string()).collect();
        Some((k, chosen(&names)?))
    };
    let found = headers.iter().enumerate().find_map(found);
    let (part, set) = found.ok_or_else(|| MapProblem::Channels { found: names(headers) })?;
    window(&headers[part])?;
    let count = |header: &Header| header.layer_size.area().saturating_mul(header.channels.list.len());
    let most = headers.iter().map(count).fold(0_usize, usize::saturating_add);
    if most > MOST_VALUES {
        return Err(MapProblem::Channels { found: names(headers) });
    }
    Ok((part, set))
}

fn names(headers: &[Header]) -> String {
    let all = headers.iter().flat_map(|header| &header.channels.list);
    all.map(|channel| channel.name.to_string()).collect::<Vec<_>>().join(", ")
}

/// Selects all wavelengths, or R, G and B, X, Y and Z, or Y of the layer without a name, or of the first layer that has them.
fn chosen(names: &[String]) -> Option<ChannelSet> {
    let mut spectral: Vec<(String, f64)> =
        names.iter().filter_map(|name| Some((name.clone(), wavelength_nm(name)?))).collect();
    if spectral.len() > 1 {
        spectral.sort_by(|a, b| a.1.total_cmp(&b.1));
        let rises = spectral.windows(2).all(|pair| pair[0].1 < pair[1].1);
        return rises.then_some(ChannelSet::Spectral(spectral));
    }
    let mut layers: Vec<&str> =
        names.iter().map(|name| name.rsplit_once('.').map_or("", |(layer, _)| layer)).collect();
    layers.sort_unstable();
    layers.dedup();
    let of_layer = |layer: &&str| {
        let full = |name: &str| if layer.is_empty() { name.to_owned() } else { format!("{layer}.{name}") };
        let three = |wanted: [&str; 3]| {
            let wanted = wanted.map(full);
            wanted.iter().all(|name| names.contains(name)).then_some(wanted)
        };
        let colours = three(["R", "G", "B"]).map(ChannelSet::Colours);
        colours
            .or_else(|| three(["X", "Y", "Z"]).map(ChannelSet::Xyz))
            .or_else(|| three(["Y", "RY", "BY"]).map(ChannelSet::Chroma))
            .or_else(|| {
                // Two of three colours are no grey.
                let is_alone = !["R", "G", "B", "RY", "BY"].iter().any(|name| names.contains(&full(name)));
                (is_alone && names.contains(&full("Y"))).then(|| ChannelSet::Grey(full("Y")))
            })
    };
    layers.iter().find_map(of_layer)
}

impl ChannelSet {
    fn names(&self) -> Vec<&str> {
        match self {
            Self::Spectral(all) => all.iter().map(|(name, _)| &**name).collect(),
            Self::Colours(three) | Self::Xyz(three) | Self::Chroma(three) => {
                three.iter().map(|name| &**name).collect()
            }
            Self::Grey(name) => vec![name],
        }
    }
}

/// Returns the wavelength in the name of a channel, nm; only for emitted light, the first Stokes component.
fn wavelength_nm(name: &str) -> Option<f64> {
    let number = name.strip_suffix("nm")?;
    let number = number.strip_prefix("S0.").unwrap_or(number).replace(',', ".");
    number.parse().ok().filter(|nm| (30.0..=1e6).contains(nm))
}

/// Notes parts and channels that are not used.
fn unused(headers: &[Header], part: usize, set: &ChannelSet, notes: &mut Vec<String>) {
    let used = set.names();
    let left = headers[part].channels.list.iter().map(|channel| channel.name.to_string());
    let left: Vec<String> = left.filter(|name| !used.contains(&&**name)).collect();
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

fn values(samples: &FlatSamples) -> Vec<f32> {
    match samples {
        FlatSamples::F16(values) => values.iter().map(|value| value.to_f32()).collect(),
        FlatSamples::F32(values) => values.clone(),
        FlatSamples::U32(values) => values.iter().map(|value| *value as f32).collect(),
    }
}

fn channels(
    mut named: Vec<(String, Vec<f32>)>,
    set: &ChannelSet,
    primaries: Option<Primaries>,
) -> Option<Vec<MapChannel>> {
    let mut taken = |name: &str, colour| {
        let values = named.iter_mut().find(|(known, _)| known == name)?;
        Some(MapChannel { colour, radiance: std::mem::take(&mut values.1) })
    };
    let colours = [MapColour::Red, MapColour::Green, MapColour::Blue];
    match set {
        ChannelSet::Spectral(all) => {
            all.iter().map(|(name, nm)| taken(name, MapColour::Wavelength(*nm))).collect()
        }
        ChannelSet::Colours(three) | ChannelSet::Xyz(three) => {
            three.iter().zip(colours).map(|(name, colour)| taken(name, colour)).collect()
        }
        ChannelSet::Grey(name) => Some(vec![taken(name, MapColour::Grey)?]),
        ChannelSet::Chroma([y, ry, by]) => {
            let [y, ry, by] =
                [taken(y, MapColour::Grey)?, taken(ry, MapColour::Grey)?, taken(by, MapColour::Grey)?];
            let weights = luminances(primaries)?;
            let mut rgb: [Vec<f32>; 3] = Default::default();
            for ((y, ry), by) in y.radiance.iter().zip(&ry.radiance).zip(&by.radiance) {
                let [y, ry, by] = [*y, *ry, *by].map(f64::from);
                let (red, blue) = ((ry + 1.0) * y, (by + 1.0) * y);
                let green = (y - weights[0] * red - weights[2] * blue) / weights[1];
                // Chroma is rounded, so that dark colours may come out slightly negative.
                let rounded = |value: f64| if value > -ROUNDING * y { value.max(0.0) } else { value };
                let values = [red, green, blue].map(rounded);
                rgb.iter_mut().zip(values).for_each(|(all, value)| all.push(value as f32));
            }
            let three = colours.into_iter().zip(rgb);
            Some(three.map(|(colour, radiance)| MapChannel { colour, radiance }).collect())
        }
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

/// Window that is the map.
enum Window {
    /// Six faces of a cube, one below the other.
    Cube,
    Display,
    /// The data window, because the display window is no map.
    Data,
}

fn data_window(header: &Header) -> IntegerBounds {
    IntegerBounds { position: header.own_attributes.layer_position, size: header.layer_size }
}

fn window(header: &Header) -> Result<Window, MapProblem> {
    let (data, display) = (header.layer_size, header.shared_attributes.display_window.size);
    if header.own_attributes.environment_map == Some(EnvironmentMap::Cube) {
        let fits = data.0 >= 2 && data.0 <= 1024 && data.0.checked_mul(6) == Some(data.1);
        return if fits { Ok(Window::Cube) } else { Err(MapProblem::Cube { width: data.0, height: data.1 }) };
    }
    if check_size(display.0, display.1).is_ok() {
        return Ok(Window::Display);
    }
    check_size(data.0, data.1).map(|()| Window::Data)
}

/// Moves the pixels to their places on the sphere; returns width and height of the map.
fn place(
    header: &Header,
    channels: &mut [MapChannel],
    notes: &mut Vec<String>,
) -> Result<(usize, usize), MapProblem> {
    let (data, display) = (data_window(header), header.shared_attributes.display_window);
    match window(header)? {
        Window::Cube => {
            let (width, height) = equirectangular(data.size.0, channels);
            notes.push(format!(
                "its six faces of {} pixels are resampled to {width} x {height} pixels",
                data.size.0
            ));
            Ok((width, height))
        }
        Window::Data => {
            notes.push(
                "the display window is no map of the sphere and is not used: the data window is taken as the whole sphere"
                    .to_owned(),
            );
            Ok((data.size.0, data.size.1))
        }
        Window::Display if data == display => Ok((data.size.0, data.size.1)),
        Window::Display => {
            let outside = moved(data, display, channels);
            notes.push(format!(
                "the data window differs from the display window, which is the whole sphere: {outside}"
            ));
            Ok((display.size.0, display.size.1))
        }
    }
}

/// Moves pixels of the data window to the display window; returns in words what is missing and what is cut off.
fn moved(data: IntegerBounds, display: IntegerBounds, channels: &mut [MapChannel]) -> &'static str {
    let Vec2(width, height) = display.size;
    let off = |at: i32, from: i32| i64::from(at) - i64::from(from);
    let (right, down) = (off(data.position.0, display.position.0), off(data.position.1, display.position.1));
    let mut covered = 0;
    for channel in channels {
        let mut map = vec![0.0; width * height];
        covered = 0;
        for (k, value) in channel.radiance.iter().enumerate() {
            let (row, column) = ((k / data.size.0) as i64 + down, (k % data.size.0) as i64 + right);
            if (0..height as i64).contains(&row) && (0..width as i64).contains(&column) {
                map[row as usize * width + column as usize] = *value;
                covered += 1;
            }
        }
        channel.radiance = map;
    }
    match (covered == width * height, covered == data.size.area()) {
        (false, true) => "the rest is dark",
        (true, _) => "pixels outside are not used",
        (false, false) => "the rest is dark, and pixels outside are not used",
    }
}

/// Applies, or notes, attributes that concern the meaning of the values.
fn meaning(header: &Header, set: &ChannelSet, channels: &mut [MapChannel], notes: &mut Vec<String>) {
    let own = &header.own_attributes;
    if let Some(white) = own.white_luminance {
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
        notes.push(format!("pixelAspectRatio {aspect} is not used: the pixels cover the whole sphere"));
    }
    let other = own.other.iter().chain(&header.shared_attributes.other);
    let space = other.filter(|(name, _)| **name == *"colorInteropID").map(|(_, value)| value);
    for value in space {
        let found = match value {
            exr::meta::attribute::AttributeValue::Text(text) => text.to_string(),
            _ => "of an unknown type".to_owned(),
        };
        if found != "lin_rec709_scene" {
            notes.push(format!(
                "colorInteropID {found} is not used: primaries are those of `chromaticities`, or of sRGB"
            ));
        }
    }
}
