//! `papilio new`: a commented scenario to begin with.

use std::io::Write;

use papilio_formats::write_file;
use papilio_scenario::{new_scenario, preset_names};

use crate::arguments::New;
use crate::{Failure, say};

pub(crate) fn run(arguments: &New) -> Result<(), Failure> {
    let name = &arguments.preset;
    let text = new_scenario(name).ok_or_else(|| {
        let known = preset_names().collect::<Vec<_>>().join(", ");
        Failure::Input(format!("there is no preset `{name}`\n  = help: the presets are {known}"))
    })?;
    let Some(file) = &arguments.file else {
        let mut stdout = crate::terminal::stdout();
        stdout.write_all(text.as_bytes())?;
        return Ok(stdout.flush()?);
    };
    if file.exists() {
        let message =
            format!("{} is there already\n  = help: name another file, or move it away", file.display());
        return Err(Failure::Input(message));
    }
    write_file(file, |out| out.write_all(text.as_bytes()))?;
    say(&format!("wrote {}; compute it with: papilio run {0}", file.display()));
    Ok(())
}
