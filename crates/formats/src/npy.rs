//! NumPy arrays: the format `.npy`, version 1.0 (numpy.lib.format).
//!
//! A magic word, the length of a header, the header (a Python dictionary of type, order and
//! shape, padded so that the data begin at a multiple of 64 bytes), and the data, little-endian,
//! last index fastest.

use std::io::{self, Write};

use zip::CompressionMethod;
use zip::write::SimpleFileOptions;

/// The items of an array.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Items<'a> {
    /// `<f8`.
    Double(&'a [f64]),
    /// `<f4`, in several slices.
    Single(&'a [&'a [f32]]),
    /// `<U...`: text, padded with zeros to the longest.
    Text(&'a [&'a str]),
}

/// Writes an array of a given shape; an empty shape means a single item.
pub(crate) fn write_npy(out: &mut dyn Write, shape: &[usize], items: Items<'_>) -> io::Result<()> {
    let count: usize = shape.iter().product();
    if items.count() != count {
        let message = format!("an array of shape {shape:?} cannot hold {} items", items.count());
        return Err(io::Error::new(io::ErrorKind::InvalidData, message));
    }
    let shape: String = shape.iter().map(|length| format!("{length}, ")).collect();
    let descr = items.descr();
    let header = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': ({}), }}", shape.trim_end());
    // Magic word, version and length take 10 bytes; a newline ends the header.
    let padded = (10 + header.len() + 1).next_multiple_of(64) - 10;
    let length = u16::try_from(padded).map_err(|error| io::Error::new(io::ErrorKind::InvalidData, error))?;
    out.write_all(b"\x93NUMPY\x01\x00")?;
    out.write_all(&length.to_le_bytes())?;
    writeln!(out, "{header:<0$}", padded - 1)?;
    items.write(out)
}

impl Items<'_> {
    fn count(&self) -> usize {
        match self {
            Self::Double(values) => values.len(),
            Self::Single(pieces) => pieces.iter().map(|piece| piece.len()).sum(),
            Self::Text(texts) => texts.len(),
        }
    }

    fn descr(&self) -> String {
        match self {
            Self::Double(_) => "<f8".to_owned(),
            Self::Single(_) => "<f4".to_owned(),
            Self::Text(texts) => format!("<U{}", longest(texts)),
        }
    }

    fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        match self {
            Self::Double(values) => values.iter().try_for_each(|value| out.write_all(&value.to_le_bytes())),
            Self::Single(pieces) => {
                pieces.iter().copied().flatten().try_for_each(|value| out.write_all(&value.to_le_bytes()))
            }
            Self::Text(texts) => {
                let width = longest(texts);
                let padded = texts
                    .iter()
                    .flat_map(|text| text.chars().map(u32::from).chain(std::iter::repeat(0)).take(width));
                padded.into_iter().try_for_each(|code| out.write_all(&code.to_le_bytes()))
            }
        }
    }
}

/// Returns the number of characters of the longest text, at least 1.
fn longest(texts: &[&str]) -> usize {
    texts.iter().map(|text| text.chars().count()).max().unwrap_or(0).max(1)
}

/// The header of a `.npy`.
pub(crate) struct Header {
    pub(crate) kind: String,
    pub(crate) shape: Vec<usize>,
}

impl Header {
    /// Returns the header and the data after it.
    pub(crate) fn of(bytes: &[u8]) -> Option<(Self, &[u8])> {
        let rest = bytes.strip_prefix(b"\x93NUMPY")?;
        let (length, begins) = match *rest.first()? {
            1 => (usize::from(u16::from_le_bytes([*rest.get(2)?, *rest.get(3)?])), 4),
            2 | 3 => {
                (u32::from_le_bytes([*rest.get(2)?, *rest.get(3)?, *rest.get(4)?, *rest.get(5)?]) as usize, 6)
            }
            _ => return None,
        };
        let end = length.checked_add(begins)?;
        let text = std::str::from_utf8(rest.get(begins..end)?).ok()?;
        let after = |key: &str| text.split_once(key).map(|(_, rest)| rest.trim_start());
        if !after("'fortran_order':")?.starts_with("False") {
            return None;
        }
        let kind = after("'descr':")?.strip_prefix('\'')?.split_once('\'')?.0.to_owned();
        let shape = after("'shape':")?.strip_prefix('(')?.split_once(')')?.0;
        let lengths = shape.split(',').map(str::trim).filter(|length| !length.is_empty());
        let shape = lengths.map(|length| length.parse().ok()).collect::<Option<Vec<usize>>>()?;
        Some((Self { kind, shape }, &rest[end..]))
    }

    /// Number of items; `None` if it is beyond all memory.
    pub(crate) fn count(&self) -> Option<usize> {
        self.shape.iter().try_fold(1_usize, |count, length| count.checked_mul(*length))
    }
}

/// Options of arrays in an archive: not compressed and without a date, so that equal arrays give equal bytes.
pub(crate) fn stored() -> SimpleFileOptions {
    SimpleFileOptions::default().compression_method(CompressionMethod::Stored)
}
