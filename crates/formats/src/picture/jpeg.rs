//! JPEG files: baseline and progressive, grey, YCbCr, RGB, and CMYK and YCCK as Adobe's programs write them.

use papilio_diagnostics::{Diagnostic, Warned};
use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

use super::colour_space::RgbSpace;
use super::source::{ColourEncoding, Samples, SourcePicture};
use super::{check_size, cut_off, exif, icc, unsupported};
use crate::decoders;

/// First bytes of the file.
pub(super) const MAGIC: [u8; 3] = [0xff, 0xd8, 0xff];

/// Marks of a gain map, by Adobe's XMP and by ISO 21496-1, and the first bytes of a file in which they are.
const GAIN_MAP: [&[u8]; 2] = [b"hdrgm:Version", b"urn:iso:std:iso:ts:21496:-1"];
const HEADERS: usize = 1 << 18;

/// Reads a JPEG file.
pub(super) fn read(bytes: &[u8], untagged: &RgbSpace) -> Result<Warned<SourcePicture>, Diagnostic> {
    let options = DecoderOptions::default()
        .set_max_width(usize::from(u16::MAX))
        .set_max_height(usize::from(u16::MAX))
        .set_strict_mode(false)
        .set_use_unsafe(false);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    let refused = |error: zune_jpeg::errors::DecodeErrors| damaged(&decoders::of_jpeg(&error));
    decoder.decode_headers().map_err(refused)?;
    let info = decoder.info().ok_or_else(|| damaged("it has no header"))?;
    let (columns, rows) = (usize::from(info.width), usize::from(info.height));
    check_size(columns, rows)?;
    // A block of 64 pixels takes one bit at least.
    if !is_complete(bytes) || columns * rows / 512 > bytes.len() {
        return Err(cut_off("JPEG"));
    }
    let mut warnings = Vec::new();
    if GAIN_MAP.iter().any(|mark| bytes.windows(mark.len()).take(HEADERS).any(|part| part == *mark)) {
        warnings.push(
            "its gain map for bright screens is not used: this is the picture for ordinary ones".to_owned(),
        );
    }
    let profile = decoder.icc_profile();
    let of_inks = profile.as_ref().and_then(|profile| icc::read(profile, 4));
    let (channels, output) = match (decoder.input_colorspace(), &of_inks) {
        (Some(ColorSpace::Luma), _) => (1, ColorSpace::Luma),
        (Some(ColorSpace::YCbCr | ColorSpace::RGB), _) => (3, ColorSpace::RGB),
        (Some(inks @ (ColorSpace::CMYK | ColorSpace::YCCK)), Some(_)) => (4, inks),
        (Some(ColorSpace::CMYK | ColorSpace::YCCK), None) => {
            let why = if profile.is_some() { icc::NOT_USED } else { "it has no ICC profile" };
            warnings
                .push(format!("this picture is in CMYK, and {why}; it is converted by R = (1 - C)(1 - K)"));
            (3, ColorSpace::RGB)
        }
        _ => {
            return Err(unsupported("this JPEG file's colours", "grey, YCbCr, RGB, CMYK or YCCK"));
        }
    };
    let encoding = match of_inks.filter(|_| channels == 4) {
        Some(of_inks) => of_inks,
        None => {
            let is_converted = !warnings.is_empty();
            encoding(profile.filter(|_| !is_converted), channels, untagged, &mut warnings)?
        }
    };
    let orientation = decoder.exif().map_or(1, |data| exif::orientation(data));
    decoder.set_options(options.jpeg_set_out_colorspace(output));
    let mut samples = decoder.decode().map_err(refused)?;
    if channels == 4 {
        samples.as_chunks_mut().0.iter_mut().for_each(|pixel| *pixel = inks(*pixel, output));
    }
    let picture = SourcePicture::new([columns, rows], channels, Samples::Eight(samples), &encoding)?;
    Ok(Warned { value: picture.upright(orientation), warnings })
}

/// C, M, Y, K, 255 for full ink, of the numbers in a file: Adobe's programs write inks inverted, and so do
/// all others.
fn inks([a, b, c, k]: [u8; 4], space: ColorSpace) -> [u8; 4] {
    if space != ColorSpace::YCCK {
        return [a, b, c, k].map(|stored| 255 - stored);
    }
    // Inverted inks are stored as Y, Cb, Cr of their complement (JFIF).
    let [y, blue, red] = [f32::from(a), f32::from(b) - 128.0, f32::from(c) - 128.0];
    let byte = |value: f32| value.round().clamp(0.0, 255.0) as u8;
    [byte(y + 1.402 * red), byte(y - 0.344_136 * blue - 0.714_136 * red), byte(y + 1.772 * blue), 255 - k]
}

fn damaged(message: &str) -> Diagnostic {
    super::damaged("JPEG", message)
}

fn encoding(
    profile: Option<Vec<u8>>,
    channels: usize,
    untagged: &RgbSpace,
    warnings: &mut Vec<String>,
) -> Result<ColourEncoding, Diagnostic> {
    if let Some(profile) = profile {
        match icc::read(&profile, channels) {
            Some(encoding) => return Ok(encoding),
            None => warnings.push(format!("{}; it is ignored", icc::NOT_USED)),
        }
    }
    ColourEncoding::needed(untagged)
}

/// Whether the data of the picture have an end: a thumbnail in the header has one of its own, and does not
/// count.
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
