//! `papilio diffuser`: files of measured scattering.

mod convert;
mod inspect;
mod report;

use std::path::Path;

use papilio_formats::{DataFile, LARGEST_BSDF_FILE, read_bsdf};
use papilio_goniometry::Measurement;

use crate::arguments::Diffuser;
use crate::{Failure, say};

pub(crate) fn diffuser(command: &Diffuser) -> Result<(), Failure> {
    match command {
        Diffuser::Inspect(arguments) => inspect::inspect(arguments),
        Diffuser::Convert(arguments) => convert::convert(arguments),
    }
}

/// Reads a file in any format; its warnings go to standard error.
fn read(path: &Path) -> Result<Measurement, Failure> {
    let name = path.display().to_string();
    let file = DataFile::open_within(path, &name, LARGEST_BSDF_FILE).map_err(Failure::Data)?;
    let read = read_bsdf(&file).map_err(Failure::Data)?;
    read.warnings.iter().for_each(|warning| say(&format!("warning: {name}: {warning}")));
    Ok(read.value)
}
