//! `papilio diffuser convert`.

use super::{format_of, read, write};
use crate::Failure;
use crate::arguments::Convert;

pub(crate) fn convert(arguments: &Convert) -> Result<(), Failure> {
    let format = format_of(arguments.format, &arguments.output)?;
    write(&read(&arguments.input)?, format, &arguments.output)
}
