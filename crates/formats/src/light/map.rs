//! Maps of light: radiance by direction as a picture of the whole sphere, in equirectangular projection.

use papilio_diagnostics::Place;

use super::problem::MapProblem;
use super::{openexr, radiance};
use crate::error::FormatError;
use crate::file::DataFile;

/// The widest map that is read.
pub(super) const MOST_WIDTH: usize = 4096;

/// A picture of the whole sphere: the first row looks at the zenith, the last one at the nadir; columns go to the
/// right as seen from inside.
#[derive(Debug, Clone, PartialEq)]
pub struct LightMap {
    /// Pixels in a row: twice the rows.
    pub width: usize,
    /// Rows; even.
    pub height: usize,
    /// The channels.
    pub channels: Vec<MapChannel>,
}

/// Radiances of one kind.
#[derive(Debug, Clone, PartialEq)]
pub struct MapChannel {
    /// What they are of.
    pub colour: MapColour,
    /// W/(m2 sr), 0 or more, by rows; of a wavelength for each nm. Divided by what the file says of its exposure.
    pub radiance: Vec<f32>,
}

/// What a channel is of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MapColour {
    /// Linear sRGB red.
    Red,
    /// Linear sRGB green.
    Green,
    /// Linear sRGB blue.
    Blue,
    /// All colours alike.
    Grey,
    /// One wavelength, nm.
    Wavelength(f64),
}

/// Reads a map of light, a Radiance picture (.hdr) or an OpenEXR file (.exr); told by content.
///
/// # Errors
/// For another size or projection, and for pixels that are negative or no numbers, with row and column. Sizes are
/// looked at before anything is allocated.
pub fn read_light_map(file: &DataFile) -> Result<LightMap, FormatError> {
    let map = if file.bytes.starts_with(&openexr::MAGIC) {
        openexr::read(&file.bytes)
    } else if file.bytes.starts_with(b"#?") {
        radiance::read(&file.bytes)
    } else {
        Err(MapProblem::NotAMap)
    };
    map.and_then(checked)
        .map_err(|problem| FormatError { place: Place::whole(&file.name), problem: problem.into() })
}

/// Fails if this is no size of a map.
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
