//! Wyko and Veeco Vision, `.opd`: a directory of named blocks of 24 bytes each, and their contents in the
//! same order.
//!
//! Lengths of pixels are in mm; heights are numbers times Wavelength (nm) over Mult. Arrays run along y
//! first, from the lowest y on.

use papilio_diagnostics::Diagnostic;

use super::bytes::{Bytes, Kind};
use super::{HeightFile, damaged, sized};

pub(super) const MAGIC: &[u8] = b"\x01\x00Directory\0";

/// Bytes of an entry of the directory, and most entries.
const ENTRY: usize = 24;
const MOST_ENTRIES: usize = 10_000;

/// Names of blocks of heights.
const HEIGHTS: [&str; 5] = ["RAW_DATA", "RAW DATA", "OPD", "Raw", "SAMPLE_DATA"];

fn wrong(what: impl Into<String>) -> Diagnostic {
    damaged("OPD", what)
}

/// A block: its type, its first byte and its length.
struct Block {
    name: String,
    kind: i16,
    at: usize,
    length: usize,
}

/// Reads the heights.
pub(super) fn read(bytes: &[u8]) -> Result<HeightFile, Diagnostic> {
    let file = Bytes { all: bytes, format: "OPD" };
    let blocks = directory(file)?;
    let number = |name: &str| -> Result<Option<f64>, Diagnostic> {
        let Some(block) = blocks.iter().find(|block| block.name == name) else { return Ok(None) };
        let number = match (block.kind, block.length) {
            (6, 2) | (7, 2) => f64::from(file.i16(block.at)?),
            (6 | 12, _) => f64::from(file.i32(block.at)?),
            (7, _) => file.f32(block.at)?,
            (8, _) => file.f64(block.at)?,
            _ => return Err(wrong(format!("the block {name} is not a number"))),
        };
        match number.is_finite() && number > 0.0 {
            true => Ok(Some(number)),
            false => Err(wrong(format!("the block {name} is {number}"))),
        }
    };
    let block =
        HEIGHTS.iter().find_map(|name| blocks.iter().find(|block| block.name == *name && block.kind == 3));
    let block = block.ok_or_else(|| wrong("it has no block of heights (expected RAW_DATA)"))?;
    let (columns, rows) = (file.u16(block.at)?, file.u16(block.at + 2)?);
    let (kind, missing_from) = match file.u16(block.at + 4)? {
        1 => (Kind::U8, f64::INFINITY),
        2 => (Kind::I16, 32_766.0),
        4 => (Kind::F32, 1e38),
        other => return Err(wrong(format!("its heights have {other} bytes (expected 1, 2 or 4)"))),
    };
    let count = sized(columns, rows)?;
    if block.length != 6 + count * kind.size() {
        return Err(wrong(format!("its heights have {} bytes for {columns} x {rows}", block.length)));
    }
    let along_y = file.numbers(block.at + 6, count, kind)?;
    let height = |at: usize| along_y[at % columns * rows + at / columns];
    let numbers = (0..count).map(height).map(|number| if number >= missing_from { f64::NAN } else { number });
    let mut map = HeightFile::plain(columns, numbers.collect());
    let wavelength_nm =
        number("Wavelength")?.ok_or_else(|| wrong("it has no block Wavelength, the scale of its heights"))?;
    map.unit_um = Some(1e-3 * wavelength_nm / number("Mult")?.unwrap_or(1.0));
    let is_other = |other: &&Block| other.kind == 3 && other.name != block.name && other.length > 0;
    let others: Vec<&str> = blocks.iter().filter(is_other).map(|other| other.name.as_str()).collect();
    if !others.is_empty() {
        map.warnings.push(format!("arrays of this OPD file that are not used: {}", others.join(", ")));
    }
    let aspect = number("Aspect")?.unwrap_or(1.0);
    map.pitch_um = number("Pixel_size")?.map(|mm| [1e3 * mm, 1e3 * mm * aspect]);
    if (aspect - 1.0).abs() > 1e-6 {
        map.warnings.push(format!(
            "the pixels of this OPD file are not square: Aspect {aspect} is taken as their length along y over that along x"
        ));
    }
    Ok(map)
}

fn directory(file: Bytes<'_>) -> Result<Vec<Block>, Diagnostic> {
    let length =
        |at: usize| -> Result<usize, Diagnostic> { Ok(file.i32(at + 18)?.max(0).unsigned_abs() as usize) };
    let entries = length(2)? / ENTRY;
    if entries > MOST_ENTRIES {
        return Err(wrong(format!("its directory has {entries} entries")));
    }
    let mut at = 2 + ENTRY * entries;
    let mut blocks = Vec::new();
    for entry in 1..entries {
        let entry = 2 + ENTRY * entry;
        let block =
            Block { name: file.text(entry, 16)?, kind: file.i16(entry + 16)?, at, length: length(entry)? };
        at = at.saturating_add(block.length);
        blocks.push(block);
    }
    Ok(blocks)
}
