//! Files of measured scattering: readers, errors with their places, round trips.

mod astm;
mod audit;
mod azimuths;
mod binary;
mod display;
mod exports;
mod mutations;
mod radiant;
mod samples;
mod scan;
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

/// Returns line and column of an error, and the error.
fn refused(bytes: impl AsRef<[u8]>) -> (Option<(usize, usize)>, Problem) {
    let FormatError { place, problem } = read_bsdf(&file(bytes)).unwrap_err();
    (place.line_column(), problem)
}

/// Returns the same for an error of BSDF files.
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
