//! `papilio diffuser steps`: a display without each processing step of its measured diffuser, one at a time.

use std::io::Write;

use papilio_display::Control;
use papilio_display::result::RunResult;
use papilio_figures::spectra_over;
use papilio_formats::{StepRow, StepsFile, write_file, write_json, write_steps};
use papilio_scenario::{Resolved, Scenario};

use crate::arguments::Steps;
use crate::progress::Computation;
use crate::{Failure, folder, input, numbers, output, print_notes, print_warnings, report};

/// The file of the table.
const TABLE: &str = "steps.csv";

/// A key of `[display.diffuser]`, the value that disables the step, and the name of the display without it.
const STEPS: [(&str, &str, &str); 6] = [
    ("normalise", "none", "not normalised"),
    ("spectral_mean", "uniform", "uniform spectral mean"),
    ("transmission", "1.0", "without transmission spectrum"),
    ("instrument_blur", "0", "instrument blur not removed"),
    ("extrapolate_tails", "false", "tails not extrapolated"),
    ("extrapolate", "none", "nothing beyond the last incidence"),
];

/// A result and its name.
struct Variant {
    name: String,
    /// The changed key; `None` for the scenario itself and for the reference scenario.
    key: Option<&'static str>,
    result: RunResult,
}

pub(crate) fn steps(arguments: &Steps) -> Result<(), Failure> {
    let scenario = &arguments.scenario;
    let base = input::scenario::<Scenario>(&scenario.file, &scenario.set)?.resolve()?;
    let out = match (&scenario.out, arguments.json) {
        (None, true) => None,
        _ => Some(folder::choose(scenario, &base)?),
    };
    let mut displays = vec![("as specified".to_owned(), None, base.clone())];
    for (key, off, name) in active_steps(&base)? {
        let set = [scenario.set.clone(), vec![format!("display.diffuser.{key}={off}")]].concat();
        let resolved = input::scenario::<Scenario>(&scenario.file, &set)?.resolve()?;
        displays.push((name.to_owned(), Some(key), resolved));
    }
    if let Some(reference) = &arguments.beside {
        let resolved = input::scenario::<Scenario>(reference, &[])?.resolve()?;
        let name = resolved.title.clone().unwrap_or_else(|| report::file_title(reference));
        displays.push((name, None, resolved));
    }
    let mut computation = Computation::in_parts(&vec![1.0; displays.len()]);
    let mut variants = Vec::with_capacity(displays.len());
    for (name, key, resolved) in displays {
        let run = |control: &Control<'_>| papilio_display::run(&resolved.scene, control);
        let result = computation.part(&resolved, arguments.workers.threads, run)?;
        let result = result.ok_or(Failure::Interrupted("no file was written"))?;
        variants.push(Variant { name, key, result });
    }
    drop(computation);
    print_notes(&base.notes);
    print_warnings(&base.warnings);
    let title = base.title.clone().unwrap_or_else(|| report::file_title(&scenario.file));
    let rows = StepRow::all(variants.iter().map(|one| (one.name.as_str(), one.key, &one.result)));
    let mut stdout = crate::terminal::output(arguments.json);
    if arguments.json {
        let (notes, warnings, hash) = (&base.notes, &base.warnings, &base.hash);
        let displays = rows.clone();
        write_json(&mut stdout, &StepsFile { title: &title, hash, notes, warnings, displays })?;
    } else {
        stdout.write_all(report_text(&title, &rows).as_bytes())?;
    }
    stdout.flush()?;
    let Some(out) = out else { return Ok(()) };
    folder::make(&out, &base.hash)?;
    output::remove(&out, |name| output::is_figure_of(&["step-"], name))?;
    write_file(&out.join(TABLE), |file| write_steps(file, &rows))?;
    let mut names = vec![TABLE.to_owned()];
    let references: Vec<&Variant> = variants.iter().skip(1).filter(|variant| variant.key.is_none()).collect();
    let mut figures = Vec::new();
    for variant in &variants {
        let Some(key) = variant.key else { continue };
        let shown: Vec<(&str, &RunResult)> = [&variants[0], variant]
            .into_iter()
            .chain(references.iter().copied())
            .map(|variant| (variant.name.as_str(), &variant.result))
            .collect();
        figures.push((format!("step-{key}"), spectra_over(&shown, &title)));
    }
    names.extend(output::write_figures(&out, figures, arguments.png)?);
    folder::write_about(&out, [&title, &base.hash], [&base.notes, &base.warnings])?;
    names.push(folder::ABOUT.to_owned());
    out.print_written(&names);
    Ok(())
}

/// The steps that the scenario specifies.
fn active_steps(base: &Resolved) -> Result<Vec<(&'static str, &'static str, &'static str)>, Failure> {
    let diffuser = &base.canonical["display"]["diffuser"];
    if diffuser["model"] != "measured" {
        return Err(Failure::Input(
            "[display.diffuser] is not a measured diffuser; only a measured diffuser has processing steps\n  = help: set model = \"measured\" \
             and a file"
                .to_owned(),
        ));
    }
    let has_spectrum = diffuser["transmission"].is_string();
    let is_active = |(key, off, _): &(&str, &str, &str)| match *key {
        "transmission" => has_spectrum,
        "spectral_mean" if !has_spectrum => false,
        key => match &diffuser[key] {
            serde_json::Value::String(value) => value != off,
            serde_json::Value::Bool(value) => *value,
            value => value.as_f64().is_some_and(|value| value > 0.0),
        },
    };
    Ok(STEPS.into_iter().filter(is_active).collect())
}

/// Report of the steps: a row for each display.
fn report_text(title: &str, displays: &[StepRow<'_>]) -> String {
    let number = |value: Option<f64>, decimals: usize| {
        value.map_or("-".to_owned(), |value| format!("{value:.decimals$}"))
    };
    let mut rows = vec![
        ["display", "Y of white", "change", "contrast", "gamut (% of sRGB)"].map(str::to_owned).to_vec(),
    ];
    rows.extend(displays.iter().map(|row| {
        vec![
            row.display.to_owned(),
            number(row.Y, 4),
            row.change.map_or("-".to_owned(), |change| format!("{} %", numbers::signed(100.0 * change, 1))),
            number(row.contrast_ratio, 2),
            number(row.gamut_percent_srgb, 2),
        ]
    }));
    format!("{title}\n\n{}", report::table(&rows))
}
