//! Reader of `face.npz`, the kernel of a surface that `papilio gonio` measured.

use papilio_diagnostics::Diagnostic;
use papilio_microgeometry::{FaceTable, Side};

use crate::DataFile;
use crate::error::FormatError;
use crate::npz::{Npz, is_npz};

/// Name of the format, with its version.
pub(crate) const FORMAT: &str = "papilio-face 1";

/// The array that only the kernel of a coated surface has: what its facets absorb of each band.
pub(crate) const COATED: &str = "absorbed";

/// The array that only a kernel by azimuth has: the azimuths in the middle of its patches.
pub(crate) const AZIMUTHS: &str = "phi_deg";

/// Difference of the edges of bands that counts as rounding.
const ROUNDING: f64 = 1e-9;

/// Reads `face.npz`. Of a kernel by azimuth, this is the mean over all azimuths of the surface, which the
/// file contains as well; then the number of azimuths is returned, too.
///
/// # Errors
/// Files that are no such archive, or whose arrays contradict each other.
pub fn read_face(file: &DataFile) -> Result<(FaceTable, Option<usize>), FormatError> {
    crate::guard::read(file, of_archive)
}

fn of_archive(file: &DataFile) -> Result<(FaceTable, Option<usize>), FormatError> {
    if !is_npz(file) {
        return Err(wrong_kind(file));
    }
    let mut arrays = Npz::new(file)?;
    if !arrays.has("format") || !arrays.has("scattered") {
        return Err(wrong_kind(file));
    }
    let format = arrays.texts("format")?;
    if format != [FORMAT] {
        return Err(arrays.unsound("format", &format!("it is {format:?} (expected \"{FORMAT}\")")));
    }
    if arrays.has(COATED) {
        return Err(arrays.unsound(
            COATED,
            "this is the kernel of a coated surface, at one wavelength; a layer has the same kernel at all wavelengths, and bare facets",
        ));
    }
    let index = arrays.numbers("index")?.values;
    let Ok(index) = <[f64; 2]>::try_from(index) else {
        return Err(arrays.unsound("index", "expected two numbers, above and below"));
    };
    if !index.iter().all(|index| (0.1..=10.0).contains(index)) {
        return Err(arrays.unsound("index", "expected numbers from 0.1 to 10"));
    }
    let table = FaceTable {
        index,
        scattered: arrays.numbers("scattered")?.values,
        regular_reflected: arrays.numbers("regular_reflected")?.values,
        regular_transmitted: arrays.numbers("regular_transmitted")?.values,
    };
    for (side, name) in [(Side::Above, "beta_above"), (Side::Below, "beta_below")] {
        let found = arrays.numbers(name)?.values;
        let expected = table.edges(side);
        let same = |(a, b): (&f64, &f64)| (a - b).abs() <= ROUNDING * b;
        if found.len() != expected.len() || !found.iter().zip(&expected).all(same) {
            return Err(arrays.unsound(name, "these are not the bands of its indices"));
        }
    }
    let azimuths = match arrays.has(AZIMUTHS) {
        true => Some(arrays.numbers(AZIMUTHS)?.values.len()).filter(|count| *count > 0),
        false => None,
    };
    match table.kernels() {
        Ok(_) => Ok((table, azimuths)),
        Err(wrong) => Err(arrays.unsound("scattered", &wrong.to_string())),
    }
}

fn wrong_kind(file: &DataFile) -> FormatError {
    let wrong = Diagnostic::new("this is not the kernel of a face");
    let wrong = wrong.expected("face.npz, which `papilio gonio` writes");
    FormatError::whole(&file.name, wrong)
}
