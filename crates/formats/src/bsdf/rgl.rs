//! Reader of the tensor files of the RGL material database (`.bsdf`, also of Mitsuba).
//!
//! The file begins with `tensor_file`, a zero byte and two bytes of version. For each field follow its name,
//! type, offset in the file and shape; all numbers are little-endian.

use papilio_goniometry::{
    Channel, Geometry, MeasuredPart, Measurement, Provenance, ScatterMode, WarpFields, WarpedGrid,
};

use super::{BsdfProblem, LARGEST_VALUE, MOST_CELLS, VALUE_RANGE, Warned};
use crate::error::{FormatError, Problem};
use crate::file::DataFile;

const MAGIC: &[u8] = b"tensor_file\0";

/// Largest number of fields; files of the database have about a dozen.
const MOST_FIELDS: u32 = 100;

pub(super) fn is_rgl(file: &DataFile) -> bool {
    file.bytes.starts_with(MAGIC)
}

pub(super) fn read(file: &DataFile) -> Result<Warned<Measurement>, FormatError> {
    let tensors = Tensors::new(file)?;
    let (channels, spectra) = tensors.spectra()?;
    let (fields, lights) = tensors.fields(&spectra)?;
    let values = transposed(&tensors.numbers(&spectra)?, lights, channels.len(), fields.shape);
    let unsound = || {
        tensors.error(BsdfProblem::Damaged {
            what: "tensor file",
            message: "its arrays are inconsistent, or a density is negative".to_owned(),
        })
    };
    let grid = WarpedGrid::new(fields).ok_or_else(unsound)?;
    if let Some(&value) = values.iter().find(|value| !(0.0..=LARGEST_VALUE).contains(*value)) {
        let problem = Problem::OutOfRange { what: "a value of the BSDF", value, expected: VALUE_RANGE };
        return Err(tensors.error(problem));
    }
    let part = MeasuredPart {
        way: ScatterMode::FrontReflection,
        channels,
        geometry: Geometry::Warped(Box::new(grid)),
        values,
        tis: Vec::new(),
    };
    let sample = tensors.find("description").map(|field| tensors.text(field)).unwrap_or_default();
    let provenance = Provenance { format: "RGL tensor file".to_owned(), sample, ..Provenance::default() };
    let value = Measurement { provenance, media: [1.0, 1.0], parts: vec![part] };
    Ok(Warned { value, warnings: Vec::new() })
}

/// Transposes values from `[light][channel][cell]` to `[channel][light][cell]`.
fn transposed(values: &[f64], lights: usize, channels: usize, [rows, columns]: [usize; 2]) -> Vec<f64> {
    let cells = rows * columns;
    let block = |channel, light| &values[(light * channels + channel) * cells..][..cells];
    (0..channels).flat_map(|c| (0..lights).flat_map(move |l| block(c, l).iter().copied())).collect()
}

/// Entry of a field in the header.
#[derive(Clone)]
struct Field<'a> {
    name: &'a [u8],
    kind: u8,
    offset: usize,
    shape: Vec<usize>,
    count: usize,
}

struct Tensors<'a> {
    file: &'a DataFile,
    fields: Vec<Field<'a>>,
}

impl<'a> Tensors<'a> {
    fn new(file: &'a DataFile) -> Result<Self, FormatError> {
        let mut tensors = Self { file, fields: Vec::new() };
        let mut bytes = Bytes { bytes: file.bytes.get(MAGIC.len()..).unwrap_or_default() };
        let cut = || tensors_error(file, BsdfProblem::Ends { what: "the end of the header" });
        let version = bytes.take(2).ok_or_else(cut)?;
        if version[0] != 1 {
            let what = format!("version {}.{} of the tensor files", version[0], version[1]);
            return Err(tensors.error(BsdfProblem::Unsupported { what, expected: "version 1.0" }));
        }
        let count = bytes.number(4).ok_or_else(cut)?;
        if count > u64::from(MOST_FIELDS) {
            let what = format!("a header with {count} fields");
            return Err(tensors.error(BsdfProblem::Unsupported { what, expected: "at most 100 fields" }));
        }
        // The arrays together may not exceed the size of the file, so that overlapping arrays cannot exhaust
        // memory.
        let mut rest = file.bytes.len();
        for _ in 0..count {
            let field = bytes.field().ok_or_else(cut)?;
            let bytes_each = match field.kind {
                10 => 4,
                11 => 8,
                _ => 1,
            };
            let size = field.count.checked_mul(bytes_each);
            let end = size.and_then(|size| size.checked_add(field.offset));
            let left = size.and_then(|size| rest.checked_sub(size));
            let (Some(left), true) = (left, end.is_some_and(|end| end <= file.bytes.len())) else {
                return Err(tensors.error(BsdfProblem::Ends { what: "the end of an array" }));
            };
            rest = left;
            tensors.fields.push(field);
        }
        Ok(tensors)
    }

    fn error(&self, problem: impl Into<Problem>) -> FormatError {
        tensors_error(self.file, problem)
    }

    fn find(&self, name: &str) -> Option<&Field<'a>> {
        self.fields.iter().find(|field| field.name == name.as_bytes())
    }

    /// Returns the field of this name, which must have `dimensions` dimensions.
    fn expect(&self, name: &'static str, dimensions: usize) -> Result<Field<'a>, FormatError> {
        let field = self.find(name).ok_or_else(|| self.error(BsdfProblem::Missing { what: name }))?;
        if field.shape.len() != dimensions {
            let problem = BsdfProblem::Count {
                what: "dimensions of an array",
                found: field.shape.len(),
                count: dimensions,
            };
            return Err(self.error(problem));
        }
        Ok(field.clone())
    }

    /// Returns the text of a field, at most 500 bytes.
    fn text(&self, field: &Field<'_>) -> String {
        let end = (field.offset + field.count.min(500)).min(self.file.bytes.len());
        let text = String::from_utf8_lossy(&self.file.bytes[field.offset.min(end)..end]);
        text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect::<String>().trim().to_owned()
    }

    /// Returns the numbers of a field, which must be finite.
    fn numbers(&self, field: &Field<'_>) -> Result<Vec<f64>, FormatError> {
        if field.count > MOST_CELLS {
            return Err(self.error(BsdfProblem::TooManyCells { limit: MOST_CELLS }));
        }
        let bytes = &self.file.bytes[field.offset..];
        let values: Vec<f64> = match field.kind {
            10 => bytes
                .as_chunks()
                .0
                .iter()
                .take(field.count)
                .map(|b| f64::from(f32::from_le_bytes(*b)))
                .collect(),
            11 => bytes.as_chunks().0.iter().take(field.count).map(|b| f64::from_le_bytes(*b)).collect(),
            kind => {
                let what = format!("the element type {kind} of an array");
                let expected = "floating-point numbers of 32 or 64 bits";
                return Err(self.error(BsdfProblem::Unsupported { what, expected }));
            }
        };
        match values.iter().find(|value| !value.is_finite()) {
            Some(value) => Err(self.error(Problem::NotFinite { found: value.to_string() })),
            None => Ok(values),
        }
    }

    /// Returns the channels and the field of values, `[phi_i][theta_i][channel][row][column]`.
    fn spectra(&self) -> Result<(Vec<Channel>, Field<'a>), FormatError> {
        let (channels, field) = if self.find("spectra").is_some() {
            let wavelengths = self.numbers(&self.expect("wavelengths", 1)?)?;
            if let Some(pair) = wavelengths.windows(2).find(|pair| pair[0] >= pair[1]) {
                let [before, value] = [pair[0], pair[1]];
                return Err(self.error(BsdfProblem::Order { what: "wavelength", value, before }));
            }
            if let Some(&value) = wavelengths.first().filter(|first| **first < super::SHORTEST_NM) {
                let expected = "a wavelength in nm, 30 or more";
                return Err(self.error(Problem::OutOfRange { what: "a wavelength", value, expected }));
            }
            let channels = wavelengths.into_iter().map(Channel::Wavelength).collect();
            (channels, self.expect("spectra", 5)?)
        } else {
            (vec![Channel::Red, Channel::Green, Channel::Blue], self.expect("rgb", 5)?)
        };
        if channels.is_empty() || field.shape[2] != channels.len() || field.shape.contains(&0) {
            let problem =
                BsdfProblem::Count { what: "channels", found: field.shape[2], count: channels.len() };
            return Err(self.error(problem));
        }
        Ok((channels, field))
    }

    /// Returns all fields except the values, and the number of directions of light.
    fn fields(&self, spectra: &Field<'_>) -> Result<(WarpFields, usize), FormatError> {
        let grid = |name, dimensions: usize| {
            let field = self.expect(name, dimensions)?;
            let shape = [field.shape[dimensions - 2], field.shape[dimensions - 1]];
            Ok::<_, FormatError>((self.numbers(&field)?, shape))
        };
        let [phi_i, theta_i] = ["phi_i", "theta_i"].map(|name| self.numbers(&self.expect(name, 1)?));
        let (phi_i, theta_i) = (phi_i?, theta_i?);
        let lights = phi_i.len() * theta_i.len();
        if spectra.shape[..2] != [phi_i.len(), theta_i.len()] {
            let found = spectra.shape[0].saturating_mul(spectra.shape[1]);
            return Err(self.error(BsdfProblem::Count { what: "directions of light", found, count: lights }));
        }
        let jacobian = match self.find("jacobian") {
            Some(field) if field.count == 1 => self.file.bytes.get(field.offset) != Some(&0),
            _ => true,
        };
        let fields = WarpFields {
            phi_i,
            theta_i,
            ndf: grid("ndf", 2)?,
            sigma: grid("sigma", 2)?,
            vndf: grid("vndf", 4)?,
            shape: [spectra.shape[3], spectra.shape[4]],
            jacobian,
        };
        Ok((fields, lights))
    }
}

fn tensors_error(file: &DataFile, problem: impl Into<Problem>) -> FormatError {
    FormatError::whole(&file.name, problem)
}

/// The unread rest of the header.
struct Bytes<'a> {
    bytes: &'a [u8],
}

impl<'a> Bytes<'a> {
    fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let (taken, rest) = self.bytes.split_at_checked(count)?;
        self.bytes = rest;
        Some(taken)
    }

    /// Reads an unsigned integer of `count` bytes, at most 8.
    fn number(&mut self, count: usize) -> Option<u64> {
        self.take(count)
            .map(|bytes| bytes.iter().rev().fold(0, |number, byte| number << 8 | u64::from(*byte)))
    }

    fn field(&mut self) -> Option<Field<'a>> {
        let length = self.number(2)? as usize;
        let name = self.take(length)?;
        let dimensions = self.number(2)?;
        let kind = self.number(1)? as u8;
        let offset = usize::try_from(self.number(8)?).ok()?;
        let shape: Option<Vec<usize>> =
            (0..dimensions).map(|_| self.number(8).and_then(|length| usize::try_from(length).ok())).collect();
        let shape = shape?;
        let count = shape.iter().try_fold(1_usize, |count, length| count.checked_mul(*length))?;
        Some(Field { name, kind, offset, shape, count })
    }
}
