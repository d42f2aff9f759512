//! `papilio diffuser convert`.

use super::{format_of, read, spare, write};
use crate::Failure;
use crate::arguments::Convert;

pub(crate) fn convert(arguments: &Convert) -> Result<(), Failure> {
    spare(&[&arguments.input], &arguments.output)?;
    let format = format_of(arguments.format, &arguments.output)?;
    write(&arguments.input, &read(&arguments.input)?, format, &arguments.output)
}
