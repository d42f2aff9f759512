//! `papilio new`: a commented scenario to start from.

use std::io::Write;
use std::path::{Path, PathBuf};

use papilio_diagnostics::did_you_mean;
use papilio_formats::write_file;
use papilio_scenario::{ExampleDisplay, new_scenario, new_scenario_of, preset_names};

use crate::arguments::New;
use crate::{Failure, input, print_message};

pub(crate) fn run(arguments: &New) -> Result<(), Failure> {
    let (light, file) = light_and_file(arguments)?;
    let text = match arguments.display {
        Some(display) => new_scenario_of(display, &light),
        None => new_scenario(&light),
    };
    let text = text.ok_or_else(|| {
        Failure::Input(format!("unknown preset `{light}`\n  = help: {}", help_on_light(arguments, &light)))
    })?;
    let example = arguments.display.unwrap_or(ExampleDisplay::IMOD);
    let Some(file) = file.filter(|file| !input::is_stdin(file)) else {
        let mut stdout = crate::terminal::stdout();
        stdout.write_all(text.as_bytes())?;
        stdout.flush()?;
        for (name, _) in example.files {
            print_message(&format!(
                "note: the scenario names the file {name}, which is written only together with it: papilio new --display {} \
                 --light {light} FILE",
                example.name
            ));
        }
        return Ok(());
    };
    let folder = input::folder(&file);
    let texts = example.files.iter().map(|(name, content)| (folder.join(name), *content));
    // An example file that is already there, as it was written, is used.
    let is_same =
        |path: &Path, content: &str| std::fs::read(path).is_ok_and(|found| found == content.as_bytes());
    let all: Vec<(PathBuf, &str)> = texts
        .filter(|(path, content)| !is_same(path, content))
        .chain([(file.clone(), text.as_str())])
        .collect();
    if let Some((path, _)) = all.iter().find(|(path, _)| path.exists()) {
        let message =
            format!("{} already exists\n  = help: specify another file, or move this one", path.display());
        return Err(Failure::Input(message));
    }
    for (path, content) in &all {
        write_file(path, |out| out.write_all(content.as_bytes()))?;
    }
    let names: Vec<String> = all.iter().rev().map(|(path, _)| path.display().to_string()).collect();
    print_message(&format!(
        "wrote {}; to compute it: papilio run {}",
        names.join(" and "),
        input::as_argument(&file)
    ));
    Ok(())
}

/// What to write instead of a name that is no preset.
fn help_on_light(arguments: &New, light: &str) -> String {
    if ExampleDisplay::named(light).is_some() {
        let file = arguments.file.as_deref().unwrap_or(Path::new("FILE"));
        let file = input::as_argument(file);
        return format!("{light} is a display: papilio new --display {light} --light office {file}");
    }
    let displays = ExampleDisplay::ALL.into_iter().map(|display| display.name);
    if let Some(near) = did_you_mean(light, preset_names().chain(displays)) {
        return near;
    }
    let is_file = arguments.light.is_none() && Path::new(light).extension().is_some();
    let first = if is_file { "a file comes after the preset of its light; " } else { "" };
    format!("{first}the presets are {}", preset_names().collect::<Vec<_>>().join(", "))
}

/// The preset and the file: `PRESET [FILE]`, or `[FILE]` with `--light`.
fn light_and_file(arguments: &New) -> Result<(String, Option<PathBuf>), Failure> {
    match (&arguments.light, &arguments.preset, &arguments.file) {
        (None, Some(preset), file) => Ok((preset.clone(), file.clone())),
        (Some(light), file, None) => Ok((light.clone(), file.as_ref().map(PathBuf::from))),
        (Some(light), Some(preset), Some(_)) => Err(Failure::Input(format!(
            "the light is specified twice: `{preset}` and --light {light}\n  = help: papilio new --display KIND --light PRESET [FILE]"
        ))),
        (None, None, _) | (Some(_), None, Some(_)) => Err(Failure::Input(format!(
            "the preset of the light is missing\n  = help: the presets are {}",
            preset_names().collect::<Vec<_>>().join(", ")
        ))),
    }
}
