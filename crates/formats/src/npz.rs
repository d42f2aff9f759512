//! Reader of NumPy arrays in an uncompressed zip archive: `.npz`.

use std::io::{Cursor, Read};

use zip::CompressionMethod;
use zip::read::ZipArchive;
use zip::result::ZipError;

use crate::bsdf::{BsdfProblem, MOST_CELLS};
use crate::error::{FormatError, Problem};
use crate::file::DataFile;
use crate::npy::Header;

/// Compressed arrays could be far larger than the file.
const COMPRESSED: &str = "it is compressed, which is not supported: save the archive with numpy.savez";

/// Largest number of arrays.
const MOST_ARRAYS: usize = 1000;

/// An archive of arrays.
pub(crate) struct Npz<'a> {
    name: &'a str,
    archive: ZipArchive<Cursor<&'a [u8]>>,
    /// Number of bytes that may still be read: at first the size of the file. Overlapping entries cannot
    /// exceed it.
    budget: usize,
}

/// An array of numbers and its shape.
pub(crate) struct Array {
    pub(crate) shape: Vec<usize>,
    pub(crate) values: Vec<f64>,
}

pub(crate) fn is_npz(file: &DataFile) -> bool {
    file.bytes.starts_with(b"PK\x03\x04")
}

impl<'a> Npz<'a> {
    pub(crate) fn new(file: &'a DataFile) -> Result<Self, FormatError> {
        let error = |problem: BsdfProblem| FormatError::whole(&file.name, problem);
        let archive = ZipArchive::new(Cursor::new(file.bytes.as_slice())).map_err(|problem| {
            error(BsdfProblem::Damaged { what: "archive", message: problem.to_string() })
        })?;
        if archive.len() > MOST_ARRAYS {
            return Err(error(BsdfProblem::TooManyCells { limit: MOST_CELLS }));
        }
        Ok(Self { name: &file.name, archive, budget: file.bytes.len() })
    }

    pub(crate) fn error(&self, problem: impl Into<Problem>) -> FormatError {
        FormatError::whole(self.name, problem)
    }

    /// Returns an error about the content of an array.
    pub(crate) fn unsound(&self, array: &str, what: &str) -> FormatError {
        self.error(BsdfProblem::Damaged { what: "archive", message: format!("array `{array}`: {what}") })
    }

    /// Returns whether the archive has an array of this name.
    pub(crate) fn has(&self, array: &str) -> bool {
        self.archive.index_for_name(&format!("{array}.npy")).is_some()
    }

    fn bytes(&mut self, array: &str) -> Result<Vec<u8>, FormatError> {
        let budget = self.budget;
        let mut bytes = Vec::new();
        let read = match self.archive.by_name(&format!("{array}.npy")) {
            Ok(entry) if entry.compression() != CompressionMethod::Stored => Err(COMPRESSED.to_owned()),
            Ok(entry) => entry.take(budget as u64 + 1).read_to_end(&mut bytes).map_err(|e| e.to_string()),
            Err(ZipError::FileNotFound) => Err("it is missing".to_owned()),
            Err(ZipError::UnsupportedArchive(_)) => Err(COMPRESSED.to_owned()),
            Err(problem) => Err(problem.to_string()),
        };
        let read = read.map_err(|what| self.unsound(array, &what))?;
        self.budget =
            budget.checked_sub(read).ok_or_else(|| self.unsound(array, "it overlaps other entries"))?;
        Ok(bytes)
    }

    /// Reads an array of numbers.
    pub(crate) fn numbers(&mut self, array: &str) -> Result<Array, FormatError> {
        let bytes = self.bytes(array)?;
        let sound = Header::of(&bytes).and_then(|(header, data)| {
            let is_float = header.kind.ends_with("f4") || header.kind.ends_with("f8");
            let values = if is_float { header.numbers(data)? } else { return None };
            Some(Array { shape: header.shape, values })
        });
        let array_values =
            sound.ok_or_else(|| self.unsound(array, "it is not an array of float32 or float64"))?;
        if array_values.values.len() > MOST_CELLS {
            return Err(self.error(BsdfProblem::TooManyCells { limit: MOST_CELLS }));
        }
        Ok(array_values)
    }

    /// Reads an array of strings.
    pub(crate) fn texts(&mut self, array: &str) -> Result<Vec<String>, FormatError> {
        let bytes = self.bytes(array)?;
        let sound = Header::of(&bytes).and_then(|(header, data)| {
            let width: usize = header.kind.strip_prefix("<U")?.parse().ok()?;
            let size = width.checked_mul(4).filter(|size| *size > 0)?;
            if !header.is_flat() || header.count()?.checked_mul(size)? != data.len() {
                return None;
            }
            let text = |item: &[u8]| -> Option<String> {
                let codes = item.as_chunks().0.iter().map(|code| u32::from_le_bytes(*code));
                codes.take_while(|code| *code != 0).map(char::from_u32).collect()
            };
            data.chunks_exact(size).map(text).collect()
        });
        sound.ok_or_else(|| self.unsound(array, "it is not a C-ordered array of strings"))
    }
}
