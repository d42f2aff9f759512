//! Errors of the libraries that decode pictures, in words: their own texts contain structures of the libraries.

use std::io::ErrorKind;

use png::DecodingError;
use tiff::tags::CompressionMethod;
use tiff::{TiffError, TiffUnsupportedError};
use zune_jpeg::errors::DecodeErrors;

/// Why a PNG file is not decoded.
pub(crate) fn of_png(error: &DecodingError) -> String {
    match error {
        DecodingError::IoError(error) if error.kind() == ErrorKind::UnexpectedEof => {
            "it ends early".to_owned()
        }
        DecodingError::IoError(error) if error.kind() == ErrorKind::InvalidData => {
            "a chunk has a value that PNG does not permit".to_owned()
        }
        DecodingError::LimitsExceeded => "a chunk needs more than 64 MiB of memory".to_owned(),
        error => png_format(&error.to_string()),
    }
}

/// The same from the text of the library, which contains names of chunks as structures.
fn png_format(text: &str) -> String {
    let text = with_chunk_names(text);
    // The name of the chunk is the last one of a wrong checksum.
    let chunk = || text.trim_end_matches(" chunk.").rsplit(' ').next().unwrap_or_default().to_owned();
    for (start, words) in [
        ("Corrupt deflate stream", "its compressed data are damaged"),
        ("Invalid color/depth", "its header states a number of bits that its kind of colours does not have"),
        ("Transparency chunk found", "it has a chunk tRNS, which pictures with opacity do not have"),
        ("The size of the sBIT", "its chunk sBIT has a wrong length"),
        ("Invalid sBIT", "its chunk sBIT has a wrong number of bits"),
    ] {
        if text.starts_with(start) {
            return words.to_owned();
        }
    }
    if text.starts_with("CRC error") {
        return format!("the checksum of its chunk {} is wrong", chunk());
    }
    sentence(&text)
}

/// A text with the names of chunks instead of the library's structures.
fn with_chunk_names(text: &str) -> String {
    const START: &str = "ChunkType { type: ";
    let mut parts = text.split(START);
    let mut found = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (name, flags) = part.split_once(", ").unwrap_or((part, ""));
        let is_name = name.len() == 4 && name.bytes().all(|letter| letter.is_ascii_alphabetic());
        found.push_str(if is_name { name } else { "unknown" });
        found.push_str(flags.split_once('}').map_or("", |(_, rest)| rest));
    }
    found
}

/// A text as a part of a sentence: it begins with a small letter, unless a name begins it, and has no full stop.
fn sentence(text: &str) -> String {
    let text = text.trim().trim_matches('"').trim_end_matches('.');
    let mut letters = text.chars();
    match (letters.next(), letters.next()) {
        (Some(first), Some(second)) if first.is_uppercase() && second.is_lowercase() => {
            first.to_lowercase().chain(text.chars().skip(1)).collect()
        }
        _ => text.to_owned(),
    }
}

/// Why a JPEG file is not decoded.
pub(crate) fn of_jpeg(error: &DecodeErrors) -> String {
    match error {
        DecodeErrors::Format(text) => sentence(text),
        DecodeErrors::FormatStatic(text) => sentence(text),
        DecodeErrors::HuffmanDecode(why) => format!("its Huffman codes are damaged ({})", sentence(why)),
        DecodeErrors::DqtError(why) => format!("its quantisation tables are damaged ({})", sentence(why)),
        DecodeErrors::SosError(why) => format!("the head of a scan is damaged ({})", sentence(why)),
        DecodeErrors::SofError(why) => format!("its head is damaged ({})", sentence(why)),
        DecodeErrors::MCUError(why) => format!("its blocks are damaged ({})", sentence(why)),
        DecodeErrors::Unsupported(_) => {
            "it is coded without loss, by arithmetic codes or in an extended mode: baseline and progressive files with Huffman codes are read".to_owned()
        }
        DecodeErrors::ExhaustedData | DecodeErrors::IoErrors(_) => "it ends early".to_owned(),
        DecodeErrors::ZeroError => "it has no pixels".to_owned(),
        error => sentence(&error.to_string()),
    }
}

/// Why a TIFF file is not decoded.
pub(crate) fn of_tiff(error: &TiffError) -> String {
    use TiffUnsupportedError as Unsupported;
    match error {
        TiffError::FormatError(error) => sentence(&error.to_string()),
        TiffError::IoError(error) if error.kind() == ErrorKind::UnexpectedEof => "it ends early".to_owned(),
        TiffError::UnsupportedError(error) => match error {
            Unsupported::UnsupportedCompressionMethod(method) => {
                format!("its compression, {}, is not supported", compression(*method))
            }
            Unsupported::UnknownCompressionMethod => "its compression is unknown".to_owned(),
            Unsupported::FloatingPointPredictor(_) | Unsupported::HorizontalPredictor(_) => {
                "its predictor is not supported for its numbers".to_owned()
            }
            Unsupported::InconsistentBitsPerSample(_) => {
                "its channels have unequal numbers of bits".to_owned()
            }
            Unsupported::UnsupportedSampleFormat(_) => "its kind of numbers is not supported".to_owned(),
            Unsupported::InterpretationWithBits(..)
            | Unsupported::UnsupportedColorType(_)
            | Unsupported::UnsupportedInterpretation(_)
            | Unsupported::UnsupportedPlanarConfig(_) => "its kind of colours is not supported".to_owned(),
            other => sentence(&other.to_string()),
        },
        error => sentence(&error.to_string()),
    }
}

/// The name of a compression of TIFF, or its number.
fn compression(method: CompressionMethod) -> String {
    match method {
        CompressionMethod::Unknown(number) => format!("number {number}"),
        known => format!("{known:?}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn structures_of_the_library_become_names() {
        for (text, expected) in [
            (
                "CRC error: expected 0x5 have 0x3cbd while decoding ChunkType { type: IDAT, critical: true, safecopy: false } chunk.",
                "the checksum of its chunk IDAT is wrong",
            ),
            (
                "Chunk ChunkType { type: PLTE, critical: true } is invalid after IDAT chunk.",
                "chunk PLTE is invalid after IDAT chunk",
            ),
            (
                "ChunkType { type: IH\\u{96}, critical: true, safecopy: false } chunk appeared before IHDR chunk",
                "unknown chunk appeared before IHDR chunk",
            ),
            ("Corrupt deflate stream. InvalidDistanceCode", "its compressed data are damaged"),
            ("IDAT or fdAT chunk is missing.", "IDAT or fdAT chunk is missing"),
        ] {
            assert_eq!(png_format(text), expected);
        }
    }
}
