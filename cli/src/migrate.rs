//! `papilio migrate`: replaces old names of keys and values in a scenario file, and names the mistakes that
//! remain.

use std::io::Write;
use std::path::Path;

use papilio_formats::{DataFile, write_file};
use papilio_scenario::{Migrated, Scenario, ScenarioErrors, SurfaceScenario, migrate};
use serde_json::json;

use crate::arguments::Migrate;
use crate::{Failure, input, print_message};

pub(crate) fn run(arguments: &Migrate) -> Result<(), Failure> {
    let name = arguments.file.display().to_string();
    let file = DataFile::open(&arguments.file, &name).map_err(Failure::Data)?;
    let old = file.text().map_err(Failure::Data)?;
    let Migrated { text, renamed, is_scenario } = migrate(old, &name)?;
    if !is_scenario {
        let message = format!(
            "{name} is not a scenario: it has neither a table [display] nor [microgeometry]\n  = help: nothing was written; `papilio new \
             office FILE` writes a scenario"
        );
        return Err(Failure::Input(message));
    }
    let target = arguments.out.as_ref().unwrap_or(&arguments.file);
    let is_new = text != old || arguments.out.is_some();
    if is_new && !arguments.dry_run {
        write_file(target, |out| out.write_all(text.as_bytes()))?;
    }
    let mut stdout = crate::terminal::stdout();
    if arguments.json {
        let rows = renamed.iter().map(|one| json!({ "line": one.line, "old": one.old, "new": one.new }));
        writeln!(stdout, "{}", json!({ "renamed": rows.collect::<Vec<_>>(), "text": text }))?;
    } else {
        for one in &renamed {
            writeln!(stdout, "{name}:{}: {} -> {}", one.line, one.old, one.new)?;
        }
    }
    stdout.flush()?;
    print_message(&match (is_new, arguments.dry_run) {
        (false, _) => format!("{name} contains no old names; nothing was changed"),
        (true, true) => format!("--dry-run: {name} would be changed: {}", count(renamed.len())),
        (true, false) => format!("wrote {}: {}", target.display(), count(renamed.len())),
    });
    if let Err(errors) = check(&text, &target.display().to_string(), &input::folder(target)) {
        print_message(&format!("warning: other mistakes remain, which are not old names\n{errors}"));
    }
    Ok(())
}

/// Looks for other mistakes in the new text: unknown keys, wrong types, values out of range.
fn check(text: &str, name: &str, folder: &Path) -> Result<(), ScenarioErrors> {
    if text.lines().any(|line| line.trim_start().starts_with("[microgeometry")) {
        SurfaceScenario::from_text(text, name, folder, &[]).map(drop)
    } else {
        Scenario::from_text(text, name, folder, &[]).map(drop)
    }
}

fn count(renamed: usize) -> String {
    match renamed {
        0 => "no name replaced, `format` stated".to_owned(),
        1 => "1 name replaced".to_owned(),
        more => format!("{more} names replaced"),
    }
}
