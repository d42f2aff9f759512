//! Light maps: radiance by direction, as an image of the whole sphere in equirectangular projection.

use papilio_diagnostics::Place;

use super::problem::MapProblem;
use super::{openexr, primaries, radiance};
use crate::error::FormatError;
use crate::file::DataFile;
use crate::picture_format;

/// Largest width of a map, pixels.
pub(super) const MOST_WIDTH: usize = 4096;

/// An image of the whole sphere. The first row is at the zenith, the last one at the nadir; columns run to the
/// right as seen from inside.
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
    /// Radiances by rows, W/(m2 sr), for a wavelength W/(m2 sr nm); 0 or more, and divided by the exposure that the file specifies.
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
/// If the size or projection is not supported; if a pixel is negative or not finite, with its row and column. Sizes are
/// checked before memory is allocated.
pub fn read_light_map(file: &DataFile) -> Result<LightMap, FormatError> {
    crate::guard::read(file, of_any_format)
}

fn of_any_format(file: &DataFile) -> Result<LightMap, FormatError> {
    let map = if file.bytes.starts_with(&openexr::MAGIC) {
        openexr::read(&file.bytes)
    } else if file.bytes.starts_with(b"#?") {
        radiance::read(&file.bytes)
    } else {
        Err(picture_format(&file.bytes).map_or(MapProblem::NotAMap, |format| MapProblem::Format { format }))
    };
    let converted = map.and_then(|(map, primaries)| {
        let mut map = checked(map)?;
        if let Some(primaries) = primaries {
            primaries::to_srgb(&mut map, primaries)?;
        }
        Ok(map)
    });
    converted.map_err(|problem| FormatError { place: Place::whole(&file.name), problem: problem.into() })
}

/// Fails unless this is the size of an equirectangular map.
pub(super) fn check_size(width: usize, height: usize) -> Result<(), MapProblem> {
    let fits = height >= 2
        && height.is_multiple_of(2)
        && width <= MOST_WIDTH
        && height.checked_mul(2) == Some(width);
    if fits { Ok(()) } else { Err(MapProblem::Size { width, height }) }
}

fn checked(map: LightMap) -> Result<LightMap, MapProblem> {
    for channel in &map.channels {
        let wrong = channel.radiance.iter().position(|value| !(value.is_finite() && *value >= 0.0));
        if let Some(at) = wrong {
            let (column, row) = (at % map.width + 1, at / map.width + 1);
            return Err(MapProblem::Pixel {
                channel: channel.colour.to_string(),
                column,
                row,
                value: channel.radiance[at],
            });
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
