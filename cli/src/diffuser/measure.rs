//! `papilio diffuser measure`: simulates the measurement of a diffuser.

use papilio_scenario::Scenario;

use super::{output_format, write};
use crate::arguments::Measure;
use crate::{Failure, input, print_notes, print_warnings};

pub(crate) fn measure(arguments: &Measure) -> Result<(), Failure> {
    let format = output_format(arguments.format, &arguments.output)?;
    let instrument = input::scenario::<Scenario>(&arguments.scenario, &arguments.set)?.measurement()?;
    let file_stem = arguments.output.file_stem().unwrap_or_default().to_string_lossy();
    let sample = instrument.sample.as_deref().unwrap_or(&file_stem);
    let measurement = instrument.measure(sample).map_err(|error| {
        Failure::Input(format!("{error}\n  = help: specify a blur, for example --set measure.blur=0.01"))
    })?;
    print_notes(&instrument.notes);
    print_warnings(&instrument.warnings);
    write(&arguments.scenario, &measurement, format, &arguments.output)
}
