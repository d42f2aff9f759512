//! `papilio new`: a commented scenario to start from.

use std::io::Write;

use papilio_formats::write_file;
use papilio_scenario::{new_scenario, preset_names};

use crate::arguments::New;
use crate::{Failure, print_message};

pub(crate) fn run(arguments: &New) -> Result<(), Failure> {
    let name = &arguments.preset;
    let text = new_scenario(name).ok_or_else(|| {
        let known = preset_names().collect::<Vec<_>>().join(", ");
        Failure::Input(format!("unknown preset `{name}`\n  = help: the presets are {known}"))
    })?;
    let Some(file) = &arguments.file else {
        let mut stdout = crate::terminal::stdout();
        stdout.write_all(text.as_bytes())?;
        return Ok(stdout.flush()?);
    };
    if file.exists() {
        let message =
            format!("{} already exists\n  = help: specify another file, or move this one", file.display());
        return Err(Failure::Input(message));
    }
    write_file(file, |out| out.write_all(text.as_bytes()))?;
    print_message(&format!("wrote {}; to compute it: papilio run {0}", file.display()));
    Ok(())
}
