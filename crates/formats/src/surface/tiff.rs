//! Maps of heights in grey TIFF pictures: integers of 16 or 32 bits, whose steps have an unknown height, and
//! floating-point numbers, in um unless the scenario has a unit.

use std::io::Cursor;

use papilio_diagnostics::Diagnostic;
use tiff::ColorType;
use tiff::decoder::{Decoder, DecodingResult};
use tiff::tags::Tag;

use super::{HeightFile, damaged, sized};
use crate::decoders;

/// First bytes of the files: little-endian and big-endian.
pub(super) const MAGICS: [&[u8]; 2] = [b"II*\0", b"MM\0*"];

/// Tag of GDAL: the number for missing heights, as a text; and of GeoTIFF: the size of pixels.
const GDAL_NODATA: u16 = 42113;
const PIXEL_SCALE: u16 = 33550;

/// Reads the first picture of a file.
pub(super) fn read(bytes: &[u8]) -> Result<HeightFile, Diagnostic> {
    let wrong = |error: tiff::TiffError| damaged("TIFF", decoders::of_tiff(&error));
    let mut decoder = Decoder::new(Cursor::new(bytes)).map_err(wrong)?;
    let (columns, rows) = decoder.dimensions().map_err(wrong)?;
    let (columns, rows) = (columns as usize, rows as usize);
    let count = sized(columns, rows)?;
    let colours = decoder.colortype().map_err(wrong)?;
    if !matches!(colours, ColorType::Gray(16 | 32 | 64)) {
        let found = match colours {
            ColorType::Gray(bits) => format!("a grey picture of {bits} bits"),
            ColorType::GrayA(_) => "a grey picture with opacity".to_owned(),
            _ => "a picture in colour".to_owned(),
        };
        let what = format!(
            "it is {found} (expected a grey picture of 16 or 32 bits, whose steps are fine enough for heights)"
        );
        return Err(damaged("TIFF", what));
    }
    if let Ok(Some(turned)) = decoder.find_tag_unsigned::<u16>(Tag::Orientation)
        && turned != 1
    {
        return Err(damaged(
            "TIFF",
            format!("its Orientation is {turned} (expected 1, the first row at the top)"),
        ));
    }
    let missing =
        text(&mut decoder, Tag::Unknown(GDAL_NODATA)).and_then(|text| text.trim().parse::<f64>().ok());
    let mut warnings = warnings(&mut decoder);
    let decoded = decoder.read_image().map_err(wrong)?;
    let (numbers, is_picture): (Vec<f64>, bool) = match decoded {
        DecodingResult::U16(values) => (values.into_iter().map(f64::from).collect(), true),
        DecodingResult::I16(values) => (values.into_iter().map(f64::from).collect(), true),
        DecodingResult::U32(values) => (values.into_iter().map(f64::from).collect(), true),
        DecodingResult::I32(values) => (values.into_iter().map(f64::from).collect(), true),
        DecodingResult::F16(values) => {
            (values.into_iter().map(|value| f64::from(value.to_f32())).collect(), false)
        }
        DecodingResult::F32(values) => (values.into_iter().map(f64::from).collect(), false),
        DecodingResult::F64(values) => (values, false),
        _ => return Err(damaged("TIFF", "its numbers are integers of 8 or 64 bits")),
    };
    if numbers.len() != count {
        return Err(damaged("TIFF", format!("it has {} heights, and its head {count}", numbers.len())));
    }
    if !is_picture {
        warnings.push(
            "a TIFF picture states no unit of its numbers: um are taken unless `height_um_per_unit` is set"
                .to_owned(),
        );
    }
    let mark = |number: f64| if Some(number) == missing { f64::NAN } else { number };
    let mut map = HeightFile::plain(columns, numbers.into_iter().map(mark).collect()).upside_down();
    (map.is_picture, map.warnings) = (is_picture, warnings);
    Ok(map)
}

fn text(decoder: &mut Decoder<Cursor<&[u8]>>, tag: Tag) -> Option<String> {
    decoder.find_tag(tag).ok().flatten()?.into_string().ok()
}

/// What the file states and is not used.
fn warnings(decoder: &mut Decoder<Cursor<&[u8]>>) -> Vec<String> {
    let mut warnings = Vec::new();
    if decoder.more_images() {
        warnings.push("only the first picture of this TIFF file is used".to_owned());
    }
    if let Some(description) = text(decoder, Tag::ImageDescription).filter(|text| !text.trim().is_empty()) {
        let first = super::header::shown(description.trim());
        warnings.push(format!(
            "the description of this TIFF file is not used, nor a scale or a unit in it: `{first}`"
        ));
    }
    let states =
        |decoder: &mut Decoder<Cursor<&[u8]>>, tag: Tag| decoder.find_tag(tag).ok().flatten().is_some();
    // Programs write 72 per inch where they know nothing: without a unit of its own, it is no distance of
    // heights.
    if states(decoder, Tag::XResolution) || states(decoder, Tag::Unknown(PIXEL_SCALE)) {
        warnings.push(
            "the resolution in this TIFF file is not used: `pixel_um` is the distance of its heights"
                .to_owned(),
        );
    }
    warnings
}
