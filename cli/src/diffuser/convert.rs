//! `papilio diffuser convert`: writes a measurement in another format.

use super::{output_format, read, refuse_overwriting, write};
use crate::Failure;
use crate::arguments::Convert;

pub(crate) fn convert(arguments: &Convert) -> Result<(), Failure> {
    refuse_overwriting(&[&arguments.input], &arguments.output)?;
    let format = output_format(arguments.format, &arguments.output)?;
    write(&arguments.input, &read(&arguments.input, arguments.part)?, format, &arguments.output)
}
