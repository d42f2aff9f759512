//! `papilio diffuser measure`.

use papilio_scenario::Scenario;

use super::{format_of, write};
use crate::arguments::Measure;
use crate::{Failure, say};

pub(crate) fn measure(arguments: &Measure) -> Result<(), Failure> {
    let format = format_of(arguments.format, &arguments.output)?;
    let found = Scenario::load(&arguments.scenario, &arguments.set)?.measurement()?;
    let by_name = arguments.output.file_stem().unwrap_or_default().to_string_lossy();
    let sample = found.sample.as_deref().unwrap_or(&by_name);
    let measurement = found.measure(sample).map_err(|error| {
        Failure::Input(format!("{error}\n  = help: give a blur, as in --set measure.blur=0.01"))
    })?;
    found.notes.iter().for_each(|note| say(&format!("note: {note}")));
    found.warnings.iter().for_each(|warning| say(&format!("warning: {warning}")));
    write(&arguments.scenario, &measurement, format, &arguments.output)
}
