//! Maps of heights: files of profilometers, texts, arrays and pictures; meshes of triangles; power spectral
//! densities.
//!
//! The format is detected from the content. [`missing`] has the rule for heights that were not measured,
//! [`table`] reads texts, and each other format has a module of its own.

mod archive;
mod array;
mod bytes;
mod density;
mod foreign;
mod gsf;
mod header;
mod keyence;
mod mesh;
mod missing;
mod opd;
mod openexr;
mod plux;
mod points;
mod sdf;
mod sur;
mod table;
mod text;
mod tiff;
mod units;
mod wyko;
mod x3p;
mod zygo;

use std::io::Cursor;

use papilio_diagnostics::Diagnostic;

use crate::DataFile;
use crate::decoders;
use crate::error::FormatError;

pub use density::read_density;
pub use mesh::{MeshFile, read_mesh};

/// Largest number of heights: 4096 x 4096.
const MOST_HEIGHTS: usize = 1 << 24;

/// A map of heights.
#[derive(Debug, Clone, PartialEq)]
pub struct HeightFile {
    /// Number of heights along x.
    pub columns: usize,
    /// Distance of heights along x and y, um, if the file states it.
    pub pitch_um: Option<[f64; 2]>,
    /// Height of the number 1, um, if the file states it.
    pub unit_um: Option<f64>,
    /// Whether it is a picture, whose numbers are steps of an unknown height.
    pub is_picture: bool,
    /// The numbers of the file, by rows; the first row is that of the lowest y.
    pub numbers: Vec<f64>,
    /// What was assumed, and what the file states and is not used.
    pub warnings: Vec<String>,
}

impl HeightFile {
    /// A map whose file states nothing else, and begins with the lowest y.
    fn plain(columns: usize, numbers: Vec<f64>) -> Self {
        Self { columns, pitch_um: None, unit_um: None, is_picture: false, numbers, warnings: Vec::new() }
    }

    /// The same for a file that begins with the highest y.
    fn upside_down(mut self) -> Self {
        self.numbers = self.numbers.chunks_exact(self.columns).rev().flatten().copied().collect();
        self
    }
}

/// Reads a map of heights.
///
/// # Errors
/// An unknown format, a damaged file, missing heights with their number, points that are not on a grid, units
/// that are not understood, and more than 4096 x 4096 heights, before memory is taken for them.
pub fn read_heights(file: &DataFile) -> Result<HeightFile, FormatError> {
    crate::guard::read(file, of_any_format)
}

fn of_any_format(file: &DataFile) -> Result<HeightFile, FormatError> {
    let error = |problem: Diagnostic| FormatError::whole(&file.name, problem);
    let mut map = match binary(&file.bytes) {
        Some(map) => map.map_err(error)?,
        None => table::read(file)?,
    };
    sized(map.columns, map.numbers.len() / map.columns.max(1)).map_err(error)?;
    missing::check(&map).map_err(error)?;
    let doubt = missing::doubt(&map);
    map.warnings.extend(doubt);
    Ok(map)
}

/// A format that is no text of numbers.
struct Format {
    /// First bytes, one of them.
    magics: &'static [&'static [u8]],
    /// Whether only maps of heights begin with them, and not pictures, which may be something else as well.
    only_heights: bool,
    read: fn(&[u8]) -> Result<HeightFile, Diagnostic>,
}

/// The formats that first bytes identify.
const FORMATS: [Format; 9] = [
    Format { magics: &[array::MAGIC], only_heights: true, read: |bytes| array::read(bytes, ".npy") },
    Format { magics: &[b"\x89PNG"], only_heights: false, read: of_png },
    Format { magics: &tiff::MAGICS, only_heights: true, read: tiff::read },
    Format { magics: &[&openexr::MAGIC], only_heights: false, read: openexr::read },
    Format { magics: &archive::MAGICS, only_heights: true, read: archive::read },
    Format { magics: &[gsf::MAGIC], only_heights: true, read: gsf::read },
    Format { magics: &sur::MAGICS, only_heights: true, read: sur::read },
    Format { magics: &[opd::MAGIC], only_heights: true, read: opd::read },
    Format { magics: &keyence::MAGICS, only_heights: true, read: keyence::read },
];

fn format(bytes: &[u8]) -> Option<&'static Format> {
    FORMATS.iter().find(|format| format.magics.iter().any(|magic| bytes.starts_with(magic)))
}

/// Whether the first bytes are those of a format of height maps: not of texts and pictures, which may be
/// something else as well.
pub fn is_height_file(bytes: &[u8]) -> bool {
    let is_text = [zygo::WORDS, wyko::WORDS].iter().any(|words| bytes.starts_with(words.as_bytes()));
    is_text || sdf::is_sdf(bytes) || format(bytes).is_some_and(|format| format.only_heights)
}

/// Reads a file that is no text of numbers; `None` if it may be one.
fn binary(bytes: &[u8]) -> Option<Result<HeightFile, Diagnostic>> {
    if sdf::is_sdf(bytes) {
        return Some(sdf::read(bytes));
    }
    match format(bytes) {
        Some(format) => Some((format.read)(bytes)),
        None => foreign::recognised(bytes).map(Err),
    }
}

/// Fails for sizes that are not supported.
fn sized(columns: usize, rows: usize) -> Result<usize, Diagnostic> {
    let count = columns.checked_mul(rows).filter(|count| *count <= MOST_HEIGHTS);
    count.filter(|_| columns >= 2 && rows >= 2).ok_or_else(|| wrong_size(columns, rows))
}

fn damaged(format: &'static str, what: impl Into<String>) -> Diagnostic {
    Diagnostic::new(format!("this {format} file cannot be used: {}", what.into()))
}

fn not_a_map() -> Diagnostic {
    Diagnostic::new("this is not a map of heights in a supported format")
        .expected(
            "SDF of ISO 25178-71 or BCR, X3P of ISO 25178-72, .sur, .gsf, .opd, .plux, .vk4, .vk6, rows of numbers, points x, y, z on a grid, \
             a .npy array of two dimensions, a grey PNG or TIFF of 16 bits or more, or OpenEXR",
        )
        .hint("export the map as SDF or X3P from the program of the instrument")
}

/// An error of a known format that is not read; `format` has its article.
fn unsupported(format: &str, export: &str) -> Diagnostic {
    Diagnostic::new(format!("this is {format}, which is not supported")).hint(export)
}

fn wrong_size(columns: usize, rows: usize) -> Diagnostic {
    Diagnostic::new(format!("this map has {columns} x {rows} heights"))
        .expected(format!("at least 2 x 2, and at most {MOST_HEIGHTS} in all"))
        .hint("cut out a part of the map, or reduce its resolution")
}

/// A grey picture of 16 bits.
fn of_png(bytes: &[u8]) -> Result<HeightFile, Diagnostic> {
    let wrong = |what: String| damaged("PNG", what);
    let mut reader =
        png::Decoder::new(Cursor::new(bytes)).read_info().map_err(|error| wrong(decoders::of_png(&error)))?;
    let info = reader.info();
    let (columns, rows) = (info.width as usize, info.height as usize);
    let count = sized(columns, rows)?;
    if (info.color_type, info.bit_depth) != (png::ColorType::Grayscale, png::BitDepth::Sixteen) {
        return Err(wrong(
            "it is not a grey picture of 16 bits, whose steps are fine enough for heights".to_owned(),
        ));
    }
    let mut data = vec![0; 2 * count];
    reader.next_frame(&mut data).map_err(|error| wrong(decoders::of_png(&error)))?;
    let numbers = data.as_chunks().0.iter().map(|b| f64::from(u16::from_be_bytes(*b))).collect();
    let mut map = HeightFile::plain(columns, numbers).upside_down();
    map.is_picture = true;
    Ok(map)
}

/// Micrometres of a metre.
const UM: f64 = 1e6;
