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
    /// Whether the first index is the fastest.
    is_fortran: bool,
}

/// Converts the bytes of an item, in little-endian order, into a number.
type FromBytes = fn(&[u8]) -> f64;

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
        let after = |key: &str| {
            let (_, rest) =
                text.split_once(&format!("'{key}'")).or_else(|| text.split_once(&format!("\"{key}\"")))?;
            rest.trim_start().strip_prefix(':').map(str::trim_start)
        };
        let is_fortran = after("fortran_order")?.starts_with("True");
        if !is_fortran && !after("fortran_order")?.starts_with("False") {
            return None;
        }
        let quoted = after("descr")?;
        let quote = quoted.chars().next().filter(|c| matches!(c, '\'' | '"'))?;
        let kind = quoted[1..].split_once(quote)?.0.to_owned();
        let shape = after("shape")?.strip_prefix('(')?.split_once(')')?.0;
        let lengths = shape.split(',').map(str::trim).filter(|length| !length.is_empty());
        let shape = lengths.map(|length| length.parse().ok()).collect::<Option<Vec<usize>>>()?;
        Some((Self { kind, shape, is_fortran }, &rest[end..]))
    }

    /// Whether the items are integers or floating-point numbers of a size that is read.
    pub(crate) fn has_numbers(&self) -> bool {
        self.number().is_some()
    }

    /// The reader of an item, from its bytes in little-endian order, and the number of these bytes.
    fn number(&self) -> Option<(usize, FromBytes)> {
        let kind = self.kind.strip_prefix(['<', '>', '|', '='])?;
        Some(match kind {
            "f8" => (8, |b| f64::from_le_bytes(bytes_of(b))),
            "f4" => (4, |b| f64::from(f32::from_le_bytes(bytes_of(b)))),
            "f2" => (2, |b| half(u16::from_le_bytes(bytes_of(b)))),
            "i8" => (8, |b| i64::from_le_bytes(bytes_of(b)) as f64),
            "i4" => (4, |b| f64::from(i32::from_le_bytes(bytes_of(b)))),
            "i2" => (2, |b| f64::from(i16::from_le_bytes(bytes_of(b)))),
            "i1" => (1, |b| f64::from(i8::from_le_bytes(bytes_of(b)))),
            "u8" => (8, |b| u64::from_le_bytes(bytes_of(b)) as f64),
            "u4" => (4, |b| f64::from(u32::from_le_bytes(bytes_of(b)))),
            "u2" => (2, |b| f64::from(u16::from_le_bytes(bytes_of(b)))),
            "u1" => (1, |b| f64::from(u8::from_le_bytes(bytes_of(b)))),
            _ => return None,
        })
    }

    /// The numbers of an array, last index fastest; `None` if the items are no numbers, or not as many as the
    /// shape says.
    pub(crate) fn numbers(&self, data: &[u8]) -> Option<Vec<f64>> {
        let (size, number) = self.number()?;
        if self.count()?.checked_mul(size)? != data.len() {
            return None;
        }
        let is_big = self.kind.starts_with('>');
        let read = |item: &[u8]| {
            let mut little = [0; 8];
            for (at, byte) in item.iter().enumerate() {
                little[if is_big { size - 1 - at } else { at }] = *byte;
            }
            number(&little[..size])
        };
        let numbers: Vec<f64> = data.chunks_exact(size).map(read).collect();
        Some(if self.is_fortran { last_fastest(&numbers, &self.shape) } else { numbers })
    }

    /// Whether texts of this array are in the order in which they are read.
    pub(crate) fn is_flat(&self) -> bool {
        !self.is_fortran || self.shape.len() < 2
    }

    /// Number of items; `None` if it is beyond all memory.
    pub(crate) fn count(&self) -> Option<usize> {
        self.shape.iter().try_fold(1_usize, |count, length| count.checked_mul(*length))
    }
}

/// As many bytes as a number has.
fn bytes_of<const N: usize>(bytes: &[u8]) -> [u8; N] {
    let mut all = [0; N];
    all.copy_from_slice(&bytes[..N]);
    all
}

/// A floating-point number of 16 bits.
fn half(bits: u16) -> f64 {
    let sign = if bits >> 15 == 0 { 1.0 } else { -1.0 };
    let (exponent, fraction) = (i32::from(bits >> 10 & 0x1f), f64::from(bits & 0x3ff));
    match exponent {
        0 => sign * fraction * 2.0_f64.powi(-24),
        31 if fraction == 0.0 => sign * f64::INFINITY,
        31 => f64::NAN,
        _ => sign * (1.0 + fraction / 1024.0) * 2.0_f64.powi(exponent - 15),
    }
}

/// Numbers of an array whose first index is the fastest, with the last one as the fastest.
fn last_fastest(numbers: &[f64], shape: &[usize]) -> Vec<f64> {
    let strides: Vec<usize> = shape
        .iter()
        .scan(1, |stride, length| {
            let own = *stride;
            *stride *= length;
            Some(own)
        })
        .collect();
    let place = |flat: usize| {
        let places = shape.iter().zip(&strides).rev().scan(flat, |rest, (length, stride)| {
            let at = *rest % length;
            *rest /= length;
            Some(at * stride)
        });
        places.sum::<usize>()
    };
    (0..numbers.len()).map(|flat| numbers[place(flat)]).collect()
}

/// Options of arrays in an archive: not compressed and without a date, so that equal arrays give equal bytes.
pub(crate) fn stored() -> SimpleFileOptions {
    SimpleFileOptions::default().compression_method(CompressionMethod::Stored)
}
