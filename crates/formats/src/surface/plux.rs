//! Sensofar, `.plux`: a zip archive with `index.xml` and the heights of its first layer, single-precision
//! numbers in um by rows from the top.

use papilio_diagnostics::Diagnostic;

use super::archive::{Archive, document};
use super::bytes::{Bytes, Kind};
use super::{HeightFile, damaged, sized};

pub(super) const HEIGHTS: &str = "LAYER_0.raw";
const INDEX: &str = "index.xml";

/// Largest size of `index.xml`, bytes.
const LARGEST_XML: u64 = 16 << 20;

/// Numbers from this on mark missing heights.
const MISSING_FROM: f64 = 1e6;

/// Reads the heights.
pub(super) fn read(archive: &mut Archive<'_>) -> Result<HeightFile, Diagnostic> {
    let wrong = |what: String| damaged("PLUX", what);
    let xml = archive.content(INDEX, LARGEST_XML)?;
    let xml = String::from_utf8(xml).map_err(|_| wrong(format!("{INDEX} is not UTF-8")))?;
    let document = document(&xml).map_err(|error| wrong(format!("{INDEX}: {error}")))?;
    let number = |name: &str| -> Result<f64, Diagnostic> {
        let general = document.root_element().children().find(|node| node.has_tag_name("GENERAL"));
        let node = general.and_then(|general| general.children().find(|node| node.has_tag_name(name)));
        let number = node.and_then(|node| node.text()?.trim().parse::<f64>().ok());
        let number = number.filter(|number| number.is_finite() && *number > 0.0);
        number.ok_or_else(|| wrong(format!("{INDEX} has no number GENERAL/{name} above 0")))
    };
    let (columns, rows) = (number("IMAGE_SIZE_X")? as usize, number("IMAGE_SIZE_Y")? as usize);
    let count = sized(columns, rows)?;
    let data = archive.content(HEIGHTS, 4 * count as u64)?;
    let numbers = Bytes { all: &data, format: "PLUX" }.numbers(0, count, Kind::F32)?;
    let numbers = numbers.into_iter().map(|number| if number >= MISSING_FROM { f64::NAN } else { number });
    let mut map = HeightFile::plain(columns, numbers.collect()).upside_down();
    (map.pitch_um, map.unit_um) = (Some([number("FOV_X")?, number("FOV_Y")?]), Some(1.0));
    Ok(map)
}
