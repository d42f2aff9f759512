//! Channels of OpenEXR that form a light map.

use exr::image::FlatSamples;

use super::map::{MapChannel, MapColour};
use super::primaries::{Primaries, luminances};

/// Largest error of a colour from luminance and chroma, relative to the luminance: half precision.
const ROUNDING: f64 = 5e-3;

/// Channels that form a map.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum ChannelSet {
    Spectral(Vec<(String, f64)>),
    /// Names of red, green and blue, or of X, Y and Z.
    Colours([String; 3]),
    Xyz([String; 3]),
    /// Luminance and (R - Y)/Y, (B - Y)/Y.
    Chroma([String; 3]),
    Grey(String),
}

/// Selects all wavelengths, or R, G and B, X, Y and Z, or Y of the layer without a name, or of the first
/// layer that has them.
pub(super) fn chosen(names: &[String]) -> Option<ChannelSet> {
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
    pub(super) fn names(&self) -> Vec<&str> {
        match self {
            Self::Spectral(all) => all.iter().map(|(name, _)| &**name).collect(),
            Self::Colours(three) | Self::Xyz(three) | Self::Chroma(three) => {
                three.iter().map(|name| &**name).collect()
            }
            Self::Grey(name) => vec![name],
        }
    }

    /// Name of the channel of opacity in its layer.
    pub(super) fn opacity(&self) -> Option<String> {
        let first = self.names().first().copied()?;
        Some(first.rsplit_once('.').map_or("A".to_owned(), |(layer, _)| format!("{layer}.A")))
    }
}

/// Returns the wavelength in the name of a channel, nm; only for emitted light, the first Stokes component.
fn wavelength_nm(name: &str) -> Option<f64> {
    let number = name.strip_suffix("nm")?;
    let number = number.strip_prefix("S0.").unwrap_or(number).replace(',', ".");
    number.parse().ok().filter(|nm| (30.0..=1e6).contains(nm))
}

pub(super) fn values(samples: &FlatSamples) -> Vec<f32> {
    match samples {
        FlatSamples::F16(values) => values.iter().map(|value| value.to_f32()).collect(),
        FlatSamples::F32(values) => values.clone(),
        FlatSamples::U32(values) => values.iter().map(|value| *value as f32).collect(),
    }
}

pub(super) fn channels(
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
