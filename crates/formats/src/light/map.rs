//! Light maps: radiance by direction, as an image of the whole sphere in equirectangular projection.

use papilio_diagnostics::Diagnostic;

use super::primaries::Primaries;
use super::{openexr, primaries, radiance};
use crate::error::FormatError;
use crate::file::DataFile;
use crate::picture::{a_file, convert_to};
use crate::picture_format;

/// Largest width of a map, pixels.
pub(super) const MOST_WIDTH: usize = 4096;

/// An image of the whole sphere. The first row is at the zenith, the last one at the nadir; columns run to
/// the right as seen from inside.
#[derive(Debug, Clone, PartialEq)]
pub struct LightMap {
    /// Pixels in a row: twice the number of rows.
    pub width: usize,
    /// Number of rows, a multiple of 2.
    pub height: usize,
    /// The channels.
    pub channels: Vec<MapChannel>,
    /// What of the file is converted, or not used, in words.
    pub notes: Vec<String>,
}

/// Radiances of one colour or wavelength.
#[derive(Debug, Clone, PartialEq)]
pub struct MapChannel {
    /// The colour or wavelength.
    pub colour: MapColour,
    /// Radiances by rows, W/(m2 sr), for a wavelength W/(m2 sr nm); 0 or more, and divided by the exposure
    /// that the file specifies.
    pub radiance: Vec<f32>,
}

/// Colour of a channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MapColour {
    /// Linear sRGB red; a file with other primaries is converted.
    Red,
    /// Linear sRGB green.
    Green,
    /// Linear sRGB blue.
    Blue,
    /// The same value for all colours.
    Grey,
    /// One wavelength, nm.
    Wavelength(f64),
}

/// Reads a light map: a Radiance picture (.hdr) or an OpenEXR file (.exr), detected from the content.
///
/// # Errors
/// If the size or projection is not supported; if a pixel is negative or not finite, with its row and column.
/// Sizes are checked before memory is allocated.
pub fn read_light_map(file: &DataFile) -> Result<LightMap, FormatError> {
    crate::guard::read(file, of_any_format)
}

/// What the pixels of a file of linear light are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Shape {
    /// The whole sphere, equirectangular.
    Sphere,
    /// A picture of any size.
    Picture,
}

impl Shape {
    /// Fails unless it may have this size.
    pub(super) fn check_size(self, width: usize, height: usize) -> Result<(), Diagnostic> {
        match self {
            Self::Sphere => check_size(width, height),
            Self::Picture => crate::picture::check_size(width, height),
        }
    }
}

/// Linear light of a file.
pub(crate) struct LinearLight {
    pub(crate) map: LightMap,
    /// The primaries that it states, of which X, Y and Z are one kind.
    pub(crate) primaries: Option<Primaries>,
    /// Opacity of each pixel, by which its light is multiplied already (OpenEXR); only of a picture.
    pub(crate) opacity: Option<Vec<f32>>,
}

/// Reads a Radiance picture or an OpenEXR file; `None` if it is neither.
pub(crate) fn read_linear(bytes: &[u8], shape: Shape) -> Option<Result<LinearLight, Diagnostic>> {
    if bytes.starts_with(&openexr::MAGIC) {
        Some(openexr::read(bytes, shape))
    } else if bytes.starts_with(b"#?") {
        let read = radiance::read(bytes, shape);
        Some(read.map(|(map, primaries)| LinearLight { map, primaries, opacity: None }))
    } else {
        None
    }
}

fn of_any_format(file: &DataFile) -> Result<LightMap, FormatError> {
    let other = || Err(picture_format(&file.bytes).map_or_else(not_a_map, other_format));
    let light = read_linear(&file.bytes, Shape::Sphere).unwrap_or_else(other);
    let converted = light.and_then(|LinearLight { map, primaries, .. }| {
        let mut map = checked(map)?;
        if let Some(primaries) = primaries {
            primaries::to_srgb(&mut map, primaries)?;
        }
        Ok(map)
    });
    converted.map_err(|problem| FormatError::whole(&file.name, problem))
}

pub(super) fn not_a_map() -> Diagnostic {
    Diagnostic::new("this is neither a Radiance picture (.hdr) nor an OpenEXR file (.exr)")
}

fn other_format(format: &'static str) -> Diagnostic {
    let photograph = "a usual photograph has no radiances, and lamps in it are as bright as paper";
    Diagnostic::new(format!("this is {}, which is not supported", a_file(format)))
        .expected("a Radiance picture (.hdr) or an OpenEXR file (.exr)")
        .hint(format!("{}; {photograph}", convert_to(format, "OpenEXR")))
}

/// Fails unless this is the size of an equirectangular map.
pub(super) fn check_size(width: usize, height: usize) -> Result<(), Diagnostic> {
    let fits = height >= 2
        && height.is_multiple_of(2)
        && width <= MOST_WIDTH
        && height.checked_mul(2) == Some(width);
    let wrong = || {
        Diagnostic::new(format!("this map has {width} x {height} pixels"))
        .expected("an equirectangular map, twice as wide as high, of 4 x 2 to 4096 x 2048 pixels, with an even number of rows")
        .hint("resize or reproject the map: other projections and parts of the sphere are not supported")
    };
    if fits { Ok(()) } else { Err(wrong()) }
}

fn checked(map: LightMap) -> Result<LightMap, Diagnostic> {
    for channel in &map.channels {
        let wrong = channel.radiance.iter().position(|value| !(value.is_finite() && *value >= 0.0));
        if let Some(at) = wrong {
            let (column, row) = (at % map.width + 1, at / map.width + 1);
            let (channel, value) = (channel.colour, channel.radiance[at]);
            let pixel = format!("channel {channel} of pixel {column} in row {row} is {value}");
            return Err(Diagnostic::new(pixel).expected("a radiance of 0 or more"));
        }
    }
    Ok(map)
}

impl std::fmt::Display for MapColour {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Red => f.write_str("R"),
            Self::Green => f.write_str("G"),
            Self::Blue => f.write_str("B"),
            Self::Grey => f.write_str("Y"),
            Self::Wavelength(nm) => write!(f, "{nm} nm"),
        }
    }
}
