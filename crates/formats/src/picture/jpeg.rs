//! JPEG files: baseline and progressive, grey, YCbCr, RGB, and CMYK and YCCK as Adobe's programs write them.

use papilio_diagnostics::Warned;
use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

use super::colour_space::RgbSpace;
use super::problem::PictureProblem;
use super::source::{ColourEncoding, Samples, SourcePicture};
use super::{check_size, exif, icc};

/// First bytes of the file.
pub(super) const MAGIC: [u8; 3] = [0xff, 0xd8, 0xff];

/// Reads a JPEG file.
pub(super) fn read(bytes: &[u8], untagged: &RgbSpace) -> Result<Warned<SourcePicture>, PictureProblem> {
    let options = DecoderOptions::default()
        .set_max_width(usize::from(u16::MAX))
        .set_max_height(usize::from(u16::MAX))
        .set_strict_mode(false)
        .set_use_unsafe(false);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    let refused = |error: zune_jpeg::errors::DecodeErrors| damaged(&error.to_string());
    decoder.decode_headers().map_err(refused)?;
    let info = decoder.info().ok_or_else(|| damaged("it has no header"))?;
    let (columns, rows) = (usize::from(info.width), usize::from(info.height));
    check_size(columns, rows)?;
    // A block of 64 pixels takes one bit at least.
    if !is_complete(bytes) || columns * rows / 512 > bytes.len() {
        return Err(PictureProblem::CutOff { format: "JPEG" });
    }
    let mut warnings = Vec::new();
    let (channels, output) = match decoder.input_colorspace() {
        Some(ColorSpace::Luma) => (1, ColorSpace::Luma),
        Some(ColorSpace::YCbCr | ColorSpace::RGB) => (3, ColorSpace::RGB),
        Some(ColorSpace::CMYK | ColorSpace::YCCK) => {
            let warning = "this picture is in CMYK; it is converted by R = (1 - C)(1 - K), without a profile";
            warnings.push(warning.to_owned());
            (3, ColorSpace::RGB)
        }
        _ => {
            return Err(PictureProblem::Unsupported {
                what: "this JPEG file's colours".to_owned(),
                expected: "grey, YCbCr, RGB, CMYK or YCCK",
            });
        }
    };
    let is_converted = !warnings.is_empty();
    let encoding = encoding(decoder.icc_profile(), is_converted, channels > 1, untagged, &mut warnings)?;
    let orientation = decoder.exif().map_or(1, |data| exif::orientation(data));
    decoder.set_options(options.jpeg_set_out_colorspace(output));
    let samples = decoder.decode().map_err(refused)?;
    let picture = SourcePicture::new([columns, rows], channels, Samples::Eight(samples), &encoding)?;
    Ok(Warned { value: picture.upright(orientation), warnings })
}

fn damaged(message: &str) -> PictureProblem {
    PictureProblem::Damaged { format: "JPEG", message: message.to_owned() }
}

fn encoding(
    profile: Option<Vec<u8>>,
    is_converted: bool,
    is_coloured: bool,
    untagged: &RgbSpace,
    warnings: &mut Vec<String>,
) -> Result<ColourEncoding, PictureProblem> {
    if let Some(profile) = profile.filter(|_| !is_converted) {
        match icc::read(&profile, is_coloured) {
            Some(encoding) => return Ok(encoding),
            None => warnings.push(format!("{}; it is ignored", icc::NOT_USED)),
        }
    }
    ColourEncoding::of(untagged).ok_or_else(|| PictureProblem::Unsupported {
        what: format!("the colour space {}", untagged.name),
        expected: "primaries that are not on a line, and a white",
    })
}

/// Whether the data of the picture have an end: a thumbnail in the header has one of its own, and does not count.
fn is_complete(bytes: &[u8]) -> bool {
    let mut at = 2;
    while let Some([0xff, marker, rest @ ..]) = bytes.get(at..) {
        match *marker {
            0xff => at += 1,
            0xda => return rest.windows(2).any(|two| two == [0xff, 0xd9]),
            0x01 | 0xd0..=0xd8 => at += 2,
            _ => match rest {
                [high, low, ..] => at += 2 + usize::from(u16::from_be_bytes([*high, *low])).max(2),
                _ => return false,
            },
        }
    }
    // What is between segments is left to the decoder.
    bytes.windows(2).rev().take(1 << 16).any(|two| two == [0xff, 0xd9])
}
