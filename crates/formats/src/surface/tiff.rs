//! Maps of heights in grey TIFF pictures of 16 bits.

use std::io::Cursor;

use tiff::ColorType;
use tiff::decoder::{Decoder, DecodingResult};

use super::{HeightFile, SurfaceProblem, damaged, sized};

/// First bytes of the files: little-endian and big-endian.
pub(super) const MAGICS: [&[u8]; 2] = [b"II*\0", b"MM\0*"];

/// Reads the first picture of a file.
pub(super) fn read(bytes: &[u8]) -> Result<HeightFile, SurfaceProblem> {
    let wrong = |error: tiff::TiffError| damaged("TIFF", error.to_string());
    let mut decoder = Decoder::new(Cursor::new(bytes)).map_err(wrong)?;
    let (columns, rows) = decoder.dimensions().map_err(wrong)?;
    let (columns, rows) = (columns as usize, rows as usize);
    let count = sized(columns, rows)?;
    let colours = decoder.colortype().map_err(wrong)?;
    if colours != ColorType::Gray(16) {
        let what = format!(
            "it is {colours:?} (expected a grey picture of 16 bits, whose steps are fine enough for heights)"
        );
        return Err(damaged("TIFF", what));
    }
    let numbers: Vec<f64> = match decoder.read_image().map_err(wrong)? {
        DecodingResult::U16(values) => values.into_iter().map(f64::from).collect(),
        DecodingResult::I16(values) => values.into_iter().map(f64::from).collect(),
        _ => return Err(damaged("TIFF", "its numbers are not integers of 16 bits")),
    };
    if numbers.len() != count {
        return Err(damaged("TIFF", format!("it has {} heights, and its head {count}", numbers.len())));
    }
    Ok(HeightFile { columns, pitch_um: None, unit_um: None, is_picture: true, numbers })
}
