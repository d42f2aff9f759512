//! `papilio diffuser`: files of measured scattering.

mod calibrate;
mod convert;
mod fit;
mod inspect;
mod measure;
mod report;
mod steps;
mod tables;

use std::path::Path;

use papilio_formats::{
    BsdfFile, BsdfFormat, LARGEST_BSDF_FILE, WriteError, open_input, read_bsdf_file, write_file,
    write_measurement,
};
use papilio_goniometry::{Measurement, ScatterMode};

use crate::arguments::Diffuser;
use crate::{Failure, print_message};

pub(crate) fn diffuser(command: &Diffuser) -> Result<(), Failure> {
    match command {
        Diffuser::Inspect(arguments) => inspect::inspect(arguments),
        Diffuser::Convert(arguments) => convert::convert(arguments),
        Diffuser::Fit(arguments) => fit::fit(arguments),
        Diffuser::Calibrate(arguments) => calibrate::calibrate(arguments),
        Diffuser::Measure(arguments) => measure::measure(arguments),
        Diffuser::Steps(arguments) => steps::steps(arguments),
    }
}

/// Reads a file in any format, or one part of it, and prints its notes and warnings.
fn read(path: &Path, part: Option<ScatterMode>) -> Result<Measurement, Failure> {
    Ok(read_file(path, part)?.measurement)
}

/// As [`read`], with the notes and warnings.
fn read_file(path: &Path, part: Option<ScatterMode>) -> Result<BsdfFile, Failure> {
    let name = path.display().to_string();
    let file = open_input(path, &name, LARGEST_BSDF_FILE).map_err(Failure::Data)?;
    let mut read = read_bsdf_file(&file, part).map_err(Failure::Data)?;
    if !read.states_part {
        read.notes.push(
            "the file does not state whether its values are a reflection or a transmission; they are read as front reflection\n  \
             = help: if they are a BTDF: --part front-transmission"
                .to_owned(),
        );
    }
    if let Some(part) = part {
        read = read.only(part, &name).map_err(Failure::Data)?;
    }
    read.notes.iter().for_each(|note| print_message(&format!("note: {name}: {note}")));
    read.warnings.iter().for_each(|warning| print_message(&format!("warning: {name}: {warning}")));
    Ok(read)
}

/// Fails if the output would replace an input: a measurement cannot be recovered.
fn refuse_overwriting(inputs: &[&Path], output: &Path) -> Result<(), Failure> {
    let real = |path: &Path| path.canonicalize().ok();
    if real(output).is_some_and(|output| inputs.iter().any(|input| real(input).as_ref() == Some(&output))) {
        return Err(Failure::Input(format!(
            "the output {} is also an input, and would be overwritten\n  = help: specify another output file",
            output.display()
        )));
    }
    Ok(())
}

/// Writes a measurement that was read from `input`, and prints what the format cannot represent.
fn write(input: &Path, measurement: &Measurement, format: BsdfFormat, output: &Path) -> Result<(), Failure> {
    let mut lost = Ok(Vec::new());
    let written = write_file(output, |out| {
        lost = write_measurement(out, format, measurement);
        lost.as_ref().map(|_| ()).map_err(|error| std::io::Error::other(error.to_string()))
    });
    if let Err(WriteError::CannotHold { format, what }) = &lost {
        return Err(Failure::Input(format!(
            "{} cannot be written as {}: {format} cannot represent {what}\n  = help: .npz (Papilio) can represent every measurement",
            input.display(),
            output.display()
        )));
    }
    // A number that the readers refuse is a mistake of the input, and not of the system.
    if matches!(lost, Err(WriteError::Number { .. })) {
        written.map_err(Failure::Data)?;
    } else {
        written?;
    }
    lost.unwrap_or_default().iter().for_each(|loss| print_message(&format!("note: {loss}")));
    print_message(&format!("wrote {}", output.display()));
    Ok(())
}

/// Format of the output: from `--format`, or from the extension of its name.
fn output_format(format: Option<BsdfFormat>, output: &Path) -> Result<BsdfFormat, Failure> {
    let by_extension = match output.extension().and_then(|end| end.to_str()) {
        Some("bsdf") => Some(BsdfFormat::Radiant),
        Some("csv") => Some(BsdfFormat::Csv),
        Some("xml") => Some(BsdfFormat::Klems),
        Some("npz") => Some(BsdfFormat::Papilio),
        _ => None,
    };
    match format.or(by_extension) {
        Some(format) => Ok(format),
        None => Err(Failure::Input(format!(
            "the format of the output cannot be detected from the name {}\n  = help: use the extension .bsdf (Radiant/Zemax), .csv, \
             .xml (Klems) or .npz (Papilio), or specify --format",
            output.display()
        ))),
    }
}
