//! Maps of heights in NumPy arrays: `.npy`, and the single array of an `.npz`.

use papilio_diagnostics::Diagnostic;

use super::{HeightFile, damaged, sized};
use crate::npy::Header;

pub(super) const MAGIC: &[u8] = b"\x93NUMPY";

/// Reads an array of numbers, in any order and byte order. `format` is the one that errors name.
pub(super) fn read(bytes: &[u8], format: &'static str) -> Result<HeightFile, Diagnostic> {
    let wrong = |what: String| damaged(format, what);
    let (header, data) =
        Header::of(bytes).ok_or_else(|| wrong("its header is not that of an array".to_owned()))?;
    // Lengths of 1 are no dimensions of a map.
    let lengths: Vec<usize> = match header.shape.len() {
        0..=2 => header.shape.clone(),
        _ => header.shape.iter().copied().filter(|length| *length != 1).collect(),
    };
    let [rows, columns] = lengths[..] else {
        return Err(wrong(format!("its array has {} dimensions (expected 2)", header.shape.len())));
    };
    let count = sized(columns, rows)?;
    if !header.has_numbers() {
        return Err(wrong(format!(
            "its numbers are {} (expected integers of 8 to 64 bits or floating-point numbers of 16 to 64 bits)",
            header.kind.escape_debug()
        )));
    }
    let numbers = header.numbers(data).ok_or_else(|| {
        wrong(format!(
            "it has {} bytes of numbers, too few or too many for {rows} x {columns} of {}",
            data.len(),
            header.kind.escape_debug()
        ))
    })?;
    debug_assert_eq!(numbers.len(), count);
    Ok(HeightFile::plain(columns, numbers).upside_down())
}
