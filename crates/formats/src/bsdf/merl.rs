//! Reader of the BRDFs of the MERL database: three numbers of cells, then planes of red, green and blue.

use papilio_goniometry::{
    Channel, Geometry, HalfAngleGrid, MeasuredPart, Measurement, Provenance, ScatterMode,
};

use super::{BsdfProblem, LARGEST_VALUE, VALUE_RANGE, Warned};
use crate::error::{FormatError, Problem};
use crate::file::DataFile;

/// Factors of the numbers of each plane (reference code of the database).
const SCALES: [f64; 3] = [1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0];

const HEADER: usize = 12;

/// Returns whether a file begins with the numbers of cells that all files of the database have.
pub(super) fn is_merl(file: &DataFile) -> bool {
    let header = HalfAngleGrid::SHAPE.map(|length| (length as u32).to_le_bytes());
    file.bytes.starts_with(header.as_flattened())
}

pub(super) fn read(file: &DataFile) -> Result<Warned<Measurement>, FormatError> {
    let error = |problem: Problem| FormatError::whole(&file.name, problem);
    let cells = HalfAngleGrid.cells();
    let data = &file.bytes[HEADER.min(file.bytes.len())..];
    if data.len() < 3 * cells * 8 {
        return Err(error(BsdfProblem::Ends { what: "the end of its three planes" }.into()));
    }
    if data.len() > 3 * cells * 8 {
        let problem =
            BsdfProblem::Count { what: "bytes", found: file.bytes.len(), count: HEADER + 3 * cells * 8 };
        return Err(error(problem.into()));
    }
    let mut values = Vec::with_capacity(3 * cells);
    for (number, bytes) in data.as_chunks().0.iter().enumerate() {
        let value = f64::from_le_bytes(*bytes);
        if !value.is_finite() {
            return Err(error(Problem::NotFinite {
                found: format!("{value} (number {number} of the planes)"),
            }));
        }
        if value > LARGEST_VALUE {
            let problem = Problem::OutOfRange { what: "a value of the BSDF", value, expected: VALUE_RANGE };
            return Err(error(problem));
        }
        // In the database, negative numbers mark cells that were not measured, such as those below the
        // horizon.
        values.push(if value < 0.0 { f64::NAN } else { value * SCALES[number / cells] });
    }
    let part = MeasuredPart {
        way: ScatterMode::FrontReflection,
        channels: vec![Channel::Red, Channel::Green, Channel::Blue],
        geometry: Geometry::HalfAngle(HalfAngleGrid),
        values,
        tis: Vec::new(),
    };
    let provenance = Provenance { format: "MERL".to_owned(), ..Provenance::default() };
    let value = Measurement { provenance, media: [1.0, 1.0], parts: vec![part] };
    Ok(Warned { value, warnings: Vec::new() })
}
