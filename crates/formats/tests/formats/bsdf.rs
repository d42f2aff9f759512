//! Files of measured scattering: what the readers take, what they refuse and where, round trips.

mod astm;
mod audit;
mod binary;
mod mutations;
mod radiant;
mod samples;
mod table;
mod window;

use papilio_formats::{
    BsdfFormat, BsdfProblem, DataFile, FormatError, Problem, read_bsdf, write_measurement,
};
use papilio_goniometry::Measurement;

fn file(bytes: impl AsRef<[u8]>) -> DataFile {
    DataFile { name: "sample".to_owned(), bytes: bytes.as_ref().to_vec() }
}

fn read(bytes: impl AsRef<[u8]>) -> Measurement {
    read_bsdf(&file(bytes)).unwrap().value
}

/// Line and column, and what is wrong there.
fn refused(bytes: impl AsRef<[u8]>) -> (Option<(usize, usize)>, Problem) {
    let FormatError { place, problem } = read_bsdf(&file(bytes)).unwrap_err();
    (place.line_column(), problem)
}

/// The same, of what can be wrong with a BSDF in particular.
fn refused_bsdf(bytes: impl AsRef<[u8]>) -> (Option<(usize, usize)>, BsdfProblem) {
    match refused(bytes) {
        (place, Problem::Bsdf(problem)) => (place, *problem),
        other => panic!("{other:?}"),
    }
}

fn written(format: BsdfFormat, measurement: &Measurement) -> (Vec<u8>, Vec<String>) {
    let mut bytes = Vec::new();
    let lost = write_measurement(&mut bytes, format, measurement).unwrap();
    (bytes, lost)
}
