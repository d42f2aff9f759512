//! `papilio completions`: completion scripts for shells.

use std::io::Write;

use clap_complete::generate;

use crate::Failure;
use crate::arguments::Completions;

pub(crate) fn run(arguments: &Completions) -> Result<(), Failure> {
    let mut script = Vec::new();
    generate(arguments.shell, &mut crate::command(), "papilio", &mut script);
    let mut stdout = std::io::stdout().lock();
    stdout.write_all(&script)?;
    Ok(stdout.flush()?)
}
