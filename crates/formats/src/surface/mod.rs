//! Maps of heights: NumPy arrays, tables of numbers, grey PNG and TIFF pictures of 16 bits, OpenEXR, SDF files of ISO 25178-71, and
//! X3P files of ISO 25178-72; meshes of triangles; power spectral densities.
//!
//! The format is detected from the content. A text of numbers is a table: a row of the map in each line.

mod density;
mod mesh;
mod openexr;
mod tiff;
mod x3p;

use std::io::Cursor;

use papilio_diagnostics::{Diagnostic, Place};

use crate::DataFile;
use crate::error::{FormatError, Problem};
use crate::npy::Header;
use crate::picture_format;
use crate::rows::Table;

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
}

/// The errors of a map of heights, in addition to those of any data file.
#[derive(Debug, Clone, PartialEq)]
pub enum SurfaceProblem {
    /// A picture of a format without heights.
    Format {
        /// Its name.
        format: &'static str,
    },
    /// The file has no known format.
    NotAMap,
    /// The file is not the kernel of a face.
    NotAFace,
    /// The file has no triangles that can be read.
    NotAMesh {
        /// Why.
        what: String,
    },
    /// An unsupported size.
    Size {
        /// Heights along x.
        columns: usize,
        /// Heights along y.
        rows: usize,
    },
    /// Heights that are missing.
    Holes {
        /// Their number.
        holes: usize,
        /// Number of all heights.
        of: usize,
    },
    /// The file contradicts its format.
    Damaged {
        /// The format.
        format: &'static str,
        /// What is wrong.
        what: String,
    },
}

impl SurfaceProblem {
    /// Returns what is wrong, what was expected and what to do, in words.
    pub fn diagnostic(&self) -> Diagnostic {
        match self {
            Self::Format { format } => Diagnostic::new(format!("this is a {format} file, which is not supported"))
                .expected("heights as .npy, CSV, .sdf, .x3p, OpenEXR, or a grey picture of 16 bits as PNG or TIFF")
                .hint("export the heights themselves: such pictures hold colours of few levels, often with losses"),
            Self::NotAMap => Diagnostic::new("this is not a map of heights in a supported format")
                .expected(
                    "a .npy array of two dimensions, rows of numbers, a grey PNG or TIFF of 16 bits, an OpenEXR file, an SDF file of ISO 25178-71, or an \
                     X3P file of ISO 25178-72",
                )
                .hint("export the map as SDF or X3P from the program of the instrument"),
            Self::NotAFace => Diagnostic::new("this is not the kernel of a face")
                .expected("face.npz, which `papilio gonio` writes"),
            Self::NotAMesh { what } => Diagnostic::new(format!("this is not a mesh in a supported format: {what}"))
                .expected("a Wavefront OBJ file, or an STL file in text or binary"),
            Self::Size { columns, rows } => Diagnostic::new(format!("this map has {columns} x {rows} heights"))
                .expected(format!("at least 2 x 2, and at most {MOST_HEIGHTS} in all"))
                .hint("cut out a part of the map, or reduce its resolution"),
            Self::Holes { holes, of } => Diagnostic::new(format!("{holes} of {of} heights are missing"))
                .expected("a map without holes")
                .hint("fill them in the program of the instrument, which knows why they are missing, or cut out a part without holes"),
            Self::Damaged { format, what } => Diagnostic::new(format!("this {format} file cannot be used: {what}")),
        }
    }
}

impl From<SurfaceProblem> for Problem {
    fn from(problem: SurfaceProblem) -> Self {
        Self::Surface(Box::new(problem))
    }
}

/// Reads a map of heights.
///
/// # Errors
/// An unknown format, a damaged file, holes, and more than 4096 x 4096 heights, before memory is taken for them.
pub fn read_heights(file: &DataFile) -> Result<HeightFile, FormatError> {
    let bytes = file.bytes.as_slice();
    let other = picture_format(bytes).filter(|format| !["PNG", "TIFF"].contains(format));
    let map = if let Some(format) = other {
        Err(SurfaceProblem::Format { format })
    } else if bytes.starts_with(b"\x93NUMPY") {
        of_npy(bytes)
    } else if bytes.starts_with(b"\x89PNG") {
        of_png(bytes)
    } else if tiff::MAGICS.iter().any(|magic| bytes.starts_with(magic)) {
        tiff::read(bytes)
    } else if bytes.starts_with(&openexr::MAGIC) {
        openexr::read(bytes)
    } else if bytes.starts_with(b"PK\x03\x04") {
        x3p::read(bytes)
    } else if bytes.starts_with(b"aISO-1.0") {
        of_text_sdf(file.text()?)
    } else if bytes.starts_with(b"bISO-1.0") {
        of_binary_sdf(bytes)
    } else {
        return of_rows(file);
    };
    let error =
        |problem: SurfaceProblem| FormatError { place: Place::whole(&file.name), problem: problem.into() };
    checked(map.map_err(error)?).map_err(error)
}

/// Fails for holes, and turns the rows, which begin at the top in all formats.
fn checked(mut map: HeightFile) -> Result<HeightFile, SurfaceProblem> {
    sized(map.columns, map.numbers.len() / map.columns.max(1))?;
    let holes = map.numbers.iter().filter(|number| !number.is_finite()).count();
    if holes > 0 {
        return Err(SurfaceProblem::Holes { holes, of: map.numbers.len() });
    }
    let rows = map.numbers.chunks_exact(map.columns).rev();
    map.numbers = rows.flatten().copied().collect();
    Ok(map)
}

/// Fails for sizes that are not supported.
fn sized(columns: usize, rows: usize) -> Result<usize, SurfaceProblem> {
    let count = columns.checked_mul(rows).filter(|count| *count <= MOST_HEIGHTS);
    count.filter(|_| columns >= 2 && rows >= 2).ok_or(SurfaceProblem::Size { columns, rows })
}

fn damaged(format: &'static str, what: impl Into<String>) -> SurfaceProblem {
    SurfaceProblem::Damaged { format, what: what.into() }
}

/// A NumPy array of numbers.
fn of_npy(bytes: &[u8]) -> Result<HeightFile, SurfaceProblem> {
    let wrong = |what: &str| damaged(".npy", what);
    let (header, data) =
        Header::of(bytes).ok_or_else(|| wrong("its header is not that of a C-ordered array"))?;
    let [rows, columns] = header.shape[..] else {
        return Err(wrong(&format!("its array has {} dimensions (expected 2)", header.shape.len())));
    };
    let count = sized(columns, rows)?;
    let numbers: Vec<f64> = match header.kind.as_str() {
        "<f8" => data.as_chunks().0.iter().map(|b| f64::from_le_bytes(*b)).collect(),
        "<f4" => data.as_chunks().0.iter().map(|b| f64::from(f32::from_le_bytes(*b))).collect(),
        "<i4" => data.as_chunks().0.iter().map(|b| f64::from(i32::from_le_bytes(*b))).collect(),
        "<i2" => data.as_chunks().0.iter().map(|b| f64::from(i16::from_le_bytes(*b))).collect(),
        "<u2" => data.as_chunks().0.iter().map(|b| f64::from(u16::from_le_bytes(*b))).collect(),
        other => {
            return Err(wrong(&format!(
                "its numbers are {other} (expected float64, float32, int32, int16 or uint16)"
            )));
        }
    };
    if numbers.len() != count {
        return Err(wrong(&format!("it has {} numbers, and its header {count}", numbers.len())));
    }
    Ok(HeightFile { columns, pitch_um: None, unit_um: None, is_picture: false, numbers })
}

/// A grey picture of 16 bits.
fn of_png(bytes: &[u8]) -> Result<HeightFile, SurfaceProblem> {
    let wrong = |what: String| damaged("PNG", what);
    let mut reader =
        png::Decoder::new(Cursor::new(bytes)).read_info().map_err(|error| wrong(error.to_string()))?;
    let info = reader.info();
    let (columns, rows) = (info.width as usize, info.height as usize);
    let count = sized(columns, rows)?;
    if (info.color_type, info.bit_depth) != (png::ColorType::Grayscale, png::BitDepth::Sixteen) {
        return Err(wrong(
            "it is not a grey picture of 16 bits, whose steps are fine enough for heights".to_owned(),
        ));
    }
    let mut data = vec![0; 2 * count];
    reader.next_frame(&mut data).map_err(|error| wrong(error.to_string()))?;
    let numbers = data.as_chunks().0.iter().map(|b| f64::from(u16::from_be_bytes(*b))).collect();
    Ok(HeightFile { columns, pitch_um: None, unit_um: None, is_picture: true, numbers })
}

/// Rows of numbers, all of the same length.
fn of_rows(file: &DataFile) -> Result<HeightFile, FormatError> {
    let no_map = FormatError { place: Place::whole(&file.name), problem: SurfaceProblem::NotAMap.into() };
    if file.text().is_err() {
        return Err(no_map);
    }
    let table = Table::new(file)?;
    let (mut columns, mut numbers) = (0, Vec::new());
    for row in table.rows().filter(|row| !row.begins_with_hash()) {
        if columns == 0 {
            if row.is_header() {
                return Err(no_map);
            }
            columns = row.cells.len();
        }
        row.expect_cells(columns, "as many numbers as the first row")?;
        for cell in 0..columns {
            numbers.push(row.number(cell)?);
        }
        if numbers.len() > MOST_HEIGHTS {
            return Err(table.error(SurfaceProblem::Size { columns, rows: numbers.len() / columns }.into()));
        }
    }
    if columns == 0 {
        return Err(no_map);
    }
    checked(HeightFile { columns, pitch_um: None, unit_um: None, is_picture: false, numbers })
        .map_err(|wrong| table.error(wrong.into()))
}

/// Micrometres of a metre.
const UM: f64 = 1e6;

/// The head of an SDF file.
struct SdfHead {
    columns: usize,
    rows: usize,
    scale_m: [f64; 3],
}

impl SdfHead {
    fn map(self, numbers: Vec<f64>) -> Result<HeightFile, SurfaceProblem> {
        let count = sized(self.columns, self.rows)?;
        if numbers.len() != count {
            return Err(damaged("SDF", format!("it has {} heights, and its header {count}", numbers.len())));
        }
        let [x, y, z] = self.scale_m;
        if let Some(scale) = self.scale_m.into_iter().find(|scale| !(scale.is_finite() && *scale > 0.0)) {
            return Err(damaged(
                "SDF",
                format!("a scale is {scale} m (expected Xscale, Yscale and Zscale above 0)"),
            ));
        }
        Ok(HeightFile {
            columns: self.columns,
            pitch_um: Some([x * UM, y * UM]),
            unit_um: Some(z * UM),
            is_picture: false,
            numbers,
        })
    }
}

/// SDF in text: lines `Name = value`, a line `*`, the heights, and a line `*`. Missing heights are `BAD`.
fn of_text_sdf(text: &str) -> Result<HeightFile, SurfaceProblem> {
    let wrong = |what: &str| damaged("SDF", what);
    let mut parts = text.split('*');
    let (head, data) = (
        parts.next().unwrap_or(""),
        parts.next().ok_or_else(|| wrong("the line `*` after its header is missing"))?,
    );
    let value = |name: &str| {
        let line = head.lines().filter_map(|line| line.split_once('=')).find(|(key, _)| key.trim() == name);
        let number = line.and_then(|(_, value)| value.trim().parse::<f64>().ok());
        number.ok_or_else(|| wrong(&format!("its header has no number `{name}`")))
    };
    let count = |name: &str| {
        let number = value(name)?;
        let is_count = number.fract() == 0.0 && (0.0..=1e9).contains(&number);
        if is_count { Ok(number as usize) } else { Err(wrong(&format!("`{name}` is {number}"))) }
    };
    let head = SdfHead {
        columns: count("NumPoints")?,
        rows: count("NumProfiles")?,
        scale_m: [value("Xscale")?, value("Yscale")?, value("Zscale")?],
    };
    let most = sized(head.columns, head.rows)?;
    let number = |word: &str| match word {
        "BAD" => Ok(f64::NAN),
        word => word.parse::<f64>().map_err(|_| wrong(&format!("`{}` is not a height", word.escape_debug()))),
    };
    let numbers = data.split_whitespace().take(most + 1).map(number).collect::<Result<Vec<f64>, _>>()?;
    head.map(numbers)
}

/// Bytes of the head of a binary SDF file.
const SDF_HEAD: usize = 81;

/// Binary SDF, little-endian.
fn of_binary_sdf(bytes: &[u8]) -> Result<HeightFile, SurfaceProblem> {
    let wrong = |what: &str| damaged("SDF", what);
    let (head, data) = bytes.split_at_checked(SDF_HEAD).ok_or_else(|| wrong("it ends within its header"))?;
    let short = |at: usize| usize::from(u16::from_le_bytes([head[at], head[at + 1]]));
    let double = |at: usize| {
        let mut all = [0; 8];
        all.copy_from_slice(&head[at..at + 8]);
        f64::from_le_bytes(all)
    };
    let (columns, rows) = (short(42), short(44));
    let head_of_map = SdfHead { columns, rows, scale_m: [double(46), double(54), double(62)] };
    let count = sized(columns, rows)?;
    if head[78] != 0 {
        return Err(wrong("its heights are compressed (expected Compression 0)"));
    }
    let numbers: Vec<f64> = match head[79] {
        3 => data.as_chunks().0.iter().take(count).map(|b| f64::from(f32::from_le_bytes(*b))).collect(),
        5 => {
            let value = |b: &[u8; 2]| match i16::from_le_bytes(*b) {
                i16::MIN => f64::NAN,
                value => f64::from(value),
            };
            data.as_chunks().0.iter().take(count).map(value).collect()
        }
        6 => {
            let value = |b: &[u8; 4]| match i32::from_le_bytes(*b) {
                i32::MIN => f64::NAN,
                value => f64::from(value),
            };
            data.as_chunks().0.iter().take(count).map(value).collect()
        }
        7 => data.as_chunks().0.iter().take(count).map(|b| f64::from_le_bytes(*b)).collect(),
        other => {
            return Err(wrong(&format!(
                "its data type is {other} (expected 3, 5, 6 or 7: float, int16, int32 or double)"
            )));
        }
    };
    head_of_map.map(numbers)
}
