//! PNG files (W3C Recommendation, third edition): all kinds of colour and depth.

use std::io::Cursor;

use flate2::Crc;
use papilio_diagnostics::{Diagnostic, Warned};
use png::{BitDepth, ColorType, Decoder, DecodingError, Info, Limits, Transformations};

use super::colour_space::RgbSpace;
use super::source::{ColourEncoding, Samples, SourcePicture};
use super::{check_size, cut_off, exif, icc, unsupported};

/// First bytes of the file.
pub(super) const MAGIC: &[u8] = b"\x89PNG\r\n\x1a\n";

/// Most memory for chunks other than pixels, bytes: profiles, and rows while they are decompressed.
const MOST_CHUNKS: usize = 64 << 20;

/// Deflate does not compress more than this.
const MOST_COMPRESSION: usize = 1032;

/// Reads a PNG file.
pub(super) fn read(bytes: &[u8], untagged: &RgbSpace) -> Result<Warned<SourcePicture>, Diagnostic> {
    let mut warnings = checked_chunks(bytes)?;
    let mut decoder = Decoder::new_with_limits(Cursor::new(bytes), Limits { bytes: MOST_CHUNKS });
    decoder.set_ignore_text_chunk(true);
    decoder.set_transformations(Transformations::EXPAND);
    let header = decoder.read_header_info().map_err(refused)?;
    let (columns, rows) = (header.width as usize, header.height as usize);
    check_size(columns, rows)?;
    let bits = header.color_type.samples() * usize::from(header.bit_depth as u8);
    if columns * rows / 8 * bits / MOST_COMPRESSION > bytes.len() {
        return Err(cut_off("PNG"));
    }
    let mut reader = decoder.read_info().map_err(refused)?;
    let (colour, depth) = reader.output_color_type();
    let channels = match colour {
        ColorType::Grayscale => 1,
        ColorType::GrayscaleAlpha => 2,
        ColorType::Rgb | ColorType::Indexed => 3,
        ColorType::Rgba => 4,
    };
    let encoding = encoding(reader.info(), channels > 2, untagged, &mut warnings)?;
    let bytes_each = if depth == BitDepth::Sixteen { 2 } else { 1 };
    let mut data = vec![0; columns * rows * channels * bytes_each];
    if reader.output_buffer_size() != Some(data.len()) {
        return Err(damaged("its size does not match its colours"));
    }
    let frame = reader.next_frame(&mut data).map_err(refused)?;
    if (frame.width as usize, frame.height as usize) != (columns, rows) {
        return Err(damaged("its first picture does not fill it"));
    }
    let info = reader.info();
    if let Some(animation) = info.animation_control {
        warnings.push(format!(
            "this picture is an animation of {} frames; the first picture is used",
            animation.num_frames
        ));
    }
    let orientation = info.exif_metadata.as_ref().map_or(1, |data| exif::orientation(data));
    let samples = if depth == BitDepth::Sixteen {
        Samples::Sixteen(data.as_chunks().0.iter().map(|two| u16::from_be_bytes(*two)).collect())
    } else {
        Samples::Eight(data)
    };
    let picture = SourcePicture::new([columns, rows], channels, samples, &encoding)?;
    if picture.is_transparent() {
        warnings.push(super::TRANSPARENT.to_owned());
    }
    Ok(Warned { value: picture.upright(orientation), warnings })
}

fn refused(error: DecodingError) -> Diagnostic {
    match error {
        DecodingError::IoError(error) if error.kind() == std::io::ErrorKind::UnexpectedEof => cut_off("PNG"),
        error => damaged(&crate::decoders::of_png(&error)),
    }
}

fn damaged(message: &str) -> Diagnostic {
    super::damaged("PNG", message)
}

/// Chunks that change the colours of a picture or its orientation, and that the decoder ignores where their checksum is wrong.
const NOT_CRITICAL: [&[u8; 4]; 7] = [b"cICP", b"iCCP", b"sRGB", b"gAMA", b"cHRM", b"tRNS", b"eXIf"];

/// Returns warnings of chunks with a wrong checksum, which are ignored.
///
/// # Errors
/// If cICP states matrix coefficients, of which PNG permits only 0.
fn checked_chunks(bytes: &[u8]) -> Result<Vec<String>, Diagnostic> {
    let mut warnings = Vec::new();
    let mut rest = bytes.get(MAGIC.len()..).unwrap_or_default();
    while let Some((length, after)) = rest.split_first_chunk::<4>() {
        let length = u32::from_be_bytes(*length) as usize;
        let Some((chunk, after)) = length.checked_add(4).and_then(|length| after.split_at_checked(length))
        else {
            break;
        };
        let Some((stated, after)) = after.split_first_chunk::<4>() else { break };
        rest = after;
        let Some((name, data)) = chunk.split_first_chunk::<4>() else { break };
        if !NOT_CRITICAL.contains(&name) {
            continue;
        }
        let mut checksum = Crc::new();
        checksum.update(chunk);
        if checksum.sum().to_be_bytes() != *stated {
            let name = String::from_utf8_lossy(name);
            warnings.push(format!("the checksum of its chunk {name} is wrong: the chunk is ignored"));
        } else if let (b"cICP", [primaries, transfer, matrix, range]) = (name, data)
            && *matrix != 0
        {
            let what = format!("this picture's encoding (cICP {primaries} {transfer} {matrix} {range})");
            let expected = "the matrix coefficients 0: the pixels of PNG files are red, green and blue";
            return Err(
                unsupported(&what, expected).hint("save the picture as PNG with an ICC profile or in sRGB")
            );
        }
    }
    Ok(warnings)
}

/// The colour space: the first one of those that a file may state, in the order of the recommendation.
fn encoding(
    info: &Info<'_>,
    is_coloured: bool,
    untagged: &RgbSpace,
    warnings: &mut Vec<String>,
) -> Result<ColourEncoding, Diagnostic> {
    if let Some(points) = info.coding_independent_code_points {
        let (primaries, transfer) = (points.color_primaries, points.transfer_function);
        if matches!(transfer, 16 | 18) || !points.is_video_full_range_image {
            let what = format!(
                "this picture's encoding (cICP {primaries} {transfer} {} {})",
                points.matrix_coefficients,
                u8::from(points.is_video_full_range_image)
            );
            let expected = "a full range of numbers and a standard dynamic range, in which white is 1";
            return Err(unsupported(&what, expected));
        }
        match RgbSpace::from_code_points(primaries, transfer).and_then(|space| ColourEncoding::of(&space)) {
            Some(encoding) => return Ok(encoding),
            None => warnings
                .push(format!("its colour space (cICP {primaries} {transfer}) is unknown and ignored")),
        }
    }
    if let Some(profile) = &info.icc_profile {
        match icc::read(profile, if is_coloured { 3 } else { 1 }) {
            Some(encoding) => return Ok(encoding),
            None => warnings.push(format!("{}; it is ignored", icc::NOT_USED)),
        }
    }
    if info.srgb.is_some() {
        return ColourEncoding::needed(&RgbSpace::srgb());
    }
    // Without a profile, what is not stated is that of `untagged`.
    let mut stated = untagged.clone();
    if let Some(gamma) = info.gama_chunk.map(|gamma| gamma.into_scaled()).filter(|gamma| *gamma > 0) {
        // The chunk has the exponent of the encoding; 45455 stands for 1/2.2.
        stated.transfer = super::Transfer::Gamma(100_000.0 / f64::from(gamma));
        stated.name = format!("gamma {:.3}", 100_000.0 / f64::from(gamma));
    }
    if let Some(chromaticities) = info.chrm_chunk {
        let xy = |(x, y): (png::ScaledFloat, png::ScaledFloat)| {
            [x, y].map(|value| f64::from(value.into_scaled()) / 100_000.0)
        };
        let primaries = [chromaticities.red, chromaticities.green, chromaticities.blue].map(xy);
        let name = format!("{} with primaries of its own", stated.name);
        let own =
            RgbSpace { name, primaries, white: xy(chromaticities.white), transfer: stated.transfer.clone() };
        match ColourEncoding::of(&own) {
            Some(encoding) => return Ok(encoding),
            None => warnings.push("its primaries (cHRM) are not colours and ignored".to_owned()),
        }
    }
    ColourEncoding::needed(&stated)
}
