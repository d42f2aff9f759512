//! The frame that a panel shows: `states.png`, written and read.

use std::io::{self, Cursor, Write};

use papilio_diagnostics::Diagnostic;
use png::{BitDepth, ColorType, Decoder, DecodingError, Limits, Transformations};

use crate::error::FormatError;
use crate::file::DataFile;
use crate::picture::{check_size, write_named_png};

/// Keyword of the text with the names of the states, a JSON array.
const STATES: &str = "papilio states";

/// Most memory for chunks other than pixels, bytes.
const MOST_CHUNKS: usize = 16 << 20;

/// The states of the pixels of a frame.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ShownStates {
    /// Number of columns and rows.
    pub size: [usize; 2],
    /// State of each pixel by its number; rows begin at the top.
    pub states: Vec<u8>,
    /// Number of colours of the palette.
    pub colours: usize,
    /// Names of the states; `None` if the file does not state them.
    pub names: Option<Vec<String>>,
}

/// Writes `states.png` as [`write_indexed_png`](crate::write_indexed_png), with the names of the states as a
/// text.
///
/// # Errors
/// As [`write_indexed_png`](crate::write_indexed_png).
pub fn write_states_png(
    out: &mut dyn Write,
    columns: usize,
    states: &[u8],
    palette: &[[u8; 3]],
    names: &[String],
) -> io::Result<()> {
    let names = serde_json::to_string(names)?;
    write_named_png(out, columns, states, palette, Some((STATES, &names)))
}

/// Reads `states.png`: an indexed PNG of any depth.
///
/// # Errors
/// If the file is no indexed PNG, is damaged or cut off, or is larger than a picture may be.
pub fn read_shown_states(file: &DataFile) -> Result<ShownStates, FormatError> {
    crate::guard::read(file, |file| {
        read(&file.bytes).map_err(|problem| FormatError::whole(&file.name, problem))
    })
}

fn read(bytes: &[u8]) -> Result<ShownStates, Diagnostic> {
    if !bytes.starts_with(b"\x89PNG\r\n\x1a\n") {
        return Err(no_states("this is not a PNG file"));
    }
    let mut decoder = Decoder::new_with_limits(Cursor::new(bytes), Limits { bytes: MOST_CHUNKS });
    decoder.set_transformations(Transformations::IDENTITY);
    let header = decoder.read_header_info().map_err(damaged)?;
    let size = [header.width, header.height].map(|side| side as usize);
    check_size(size[0], size[1])?;
    let bits = match (header.color_type, header.bit_depth) {
        (ColorType::Indexed, BitDepth::One) => 1,
        (ColorType::Indexed, BitDepth::Two) => 2,
        (ColorType::Indexed, BitDepth::Four) => 4,
        (ColorType::Indexed, _) => 8,
        _ => return Err(no_states("this picture has colours, not numbers of states")),
    };
    let mut reader = decoder.read_info().map_err(damaged)?;
    let width = super::row_bytes(size[0], bits);
    let mut rows = vec![0; width * size[1]];
    if reader.output_buffer_size() != Some(rows.len()) {
        return Err(no_states("the size of this picture does not match its header"));
    }
    let frame = reader.next_frame(&mut rows).map_err(damaged)?;
    if [frame.width, frame.height].map(|side| side as usize) != size {
        return Err(no_states("the first picture of this file does not fill it"));
    }
    let largest = u8::MAX >> (8 - bits);
    let number = |row: &[u8], at: usize| {
        let bit = at * usize::from(bits);
        row[bit / 8] >> (8 - bits - (bit % 8) as u8) & largest
    };
    let states = rows.chunks(width).flat_map(|row| (0..size[0]).map(move |at| number(row, at))).collect();
    let info = reader.info();
    let colours = info.palette.as_ref().map_or(0, |palette| palette.len() / 3);
    let text = info.utf8_text.iter().find(|text| text.keyword == STATES);
    let names = text.and_then(|text| serde_json::from_str(&text.get_text().ok()?).ok());
    Ok(ShownStates { size, states, colours, names })
}

fn no_states(what: &str) -> Diagnostic {
    Diagnostic::new(what)
        .expected("states.png of the frame that the panel shows, as `papilio image` wrote it")
        .hint("image programs may change an indexed PNG: use the file itself")
}

fn damaged(error: DecodingError) -> Diagnostic {
    no_states(&format!("this PNG file cannot be decoded: {}", crate::decoders::of_png(&error)))
}
