//! `papilio diffuser convert`.

use std::path::Path;

use papilio_formats::{BsdfFormat, write_file, write_measurement};

use super::read;
use crate::arguments::{Convert, Format};
use crate::{Failure, say};

pub(crate) fn convert(arguments: &Convert) -> Result<(), Failure> {
    let measurement = read(&arguments.input)?;
    let format = match arguments.format {
        Some(format) => format,
        None => by_name(&arguments.output)?,
    };
    let mut lost = Ok(Vec::new());
    write_file(&arguments.output, |out| {
        lost = write_measurement(out, of(format), &measurement);
        lost.as_ref().map(|_| ()).map_err(|error| std::io::Error::other(error.to_string()))
    })
    .map_err(Failure::Data)?;
    for lost in lost.unwrap_or_default() {
        say(&format!("note: {lost}"));
    }
    say(&format!("wrote {}", arguments.output.display()));
    Ok(())
}

fn of(format: Format) -> BsdfFormat {
    match format {
        Format::Radiant => BsdfFormat::Radiant,
        Format::Csv => BsdfFormat::Csv,
        Format::Klems => BsdfFormat::Klems,
        Format::Papilio => BsdfFormat::Papilio,
    }
}

/// What the name of the output asks for.
fn by_name(output: &Path) -> Result<Format, Failure> {
    match output.extension().and_then(|end| end.to_str()) {
        Some("bsdf") => Ok(Format::Radiant),
        Some("csv") => Ok(Format::Csv),
        Some("xml") => Ok(Format::Klems),
        Some("npz") => Ok(Format::Papilio),
        _ => Err(Failure::Input(format!(
            "{} does not tell in which format to write\n  = help: name it .bsdf (Radiant/Zemax), .csv, .xml (Klems) or .npz \
             (Papilio), or say --format",
            output.display()
        ))),
    }
}
