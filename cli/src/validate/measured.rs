//! `papilio validate --measured`: samples that others measured, predicted from their printed inputs.

use std::io::Write;
use std::path::{Path, PathBuf};

use papilio_display::{Control, DisplayError};
use papilio_formats::{write_file, write_json};
use papilio_reproduction::ReproductionError;
use papilio_reproduction::samples::{Prediction, SampleList, SampleReport, predict, report};

use crate::arguments::Validate;
use crate::progress::FractionBar;
use crate::{Failure, interrupt, output, print_message};

/// Predicts the samples of this name, or of a list of one's own; all shipped ones without a name.
pub(super) fn run(arguments: &Validate, name: Option<&str>) -> Result<(), Failure> {
    let folder = match (&arguments.out, arguments.json) {
        (None, true) => None,
        (out, _) => Some(out.clone().unwrap_or_else(|| PathBuf::from("out/measured"))),
    };
    if let Some(folder) = &folder {
        output::check(folder)?;
        output::make_folder(folder)?;
    }
    // Without a folder of results, the shipped files are written to a temporary one.
    let temporary =
        tempfile::tempdir().map_err(|error| Failure::Input(format!("no temporary folder: {error}")))?;
    let shipped = folder.as_deref().unwrap_or(temporary.path()).join("scenarios");
    let (list, files) = match name {
        Some(path) if is_list(path) => {
            let text = std::fs::read_to_string(path)
                .map_err(|error| Failure::Input(format!("cannot read {path}: {error}")))?;
            (SampleList::parse(&text, path)?, Path::new(path).parent().unwrap_or(Path::new("")).to_owned())
        }
        Some(name) => (SampleList::of_program()?.only(name)?, SampleList::folder(&shipped)),
        None => (SampleList::of_program()?, SampleList::folder(&shipped)),
    };
    if !name.is_some_and(is_list) {
        SampleList::shipped(&shipped)?;
    }
    let samples = predicted(arguments, &list, &files)?;
    let mut stdout = crate::terminal::output(arguments.json);
    let result = SampleReport { papilio: env!("CARGO_PKG_VERSION").to_owned(), samples };
    if arguments.json {
        write_json(&mut stdout, &result)?;
    } else {
        stdout.write_all(text(&result.samples).as_bytes())?;
    }
    stdout.flush()?;
    if let Some(folder) = &folder {
        write_file(&folder.join("samples.json"), |out| write_json(out, &result))?;
        write_file(&folder.join("report.html"), |out| {
            out.write_all(report(&result.samples).html().as_bytes())
        })?;
        print_message(&format!("wrote {}: report.html, samples.json", folder.display()));
    }
    Ok(())
}

fn is_list(name: &str) -> bool {
    Path::new(name).extension().is_some_and(|end| end.eq_ignore_ascii_case("toml"))
}

fn predicted(arguments: &Validate, list: &SampleList, files: &Path) -> Result<Vec<Prediction>, Failure> {
    interrupt::catch_ctrl_c();
    let bar = FractionBar::new();
    let log = bar.in_log(String::new);
    let mut samples = Vec::new();
    for (number, sample) in list.samples.iter().enumerate() {
        let whole = list.samples.len() as f64;
        let control = Control {
            threads: arguments.workers.threads.map(usize::from),
            progress: &|now| bar.advance((number as f64 + now.fraction()) / whole, sample.name.clone()),
            stop: &interrupt::STOP,
        };
        match predict(sample, files, &control) {
            Err(ReproductionError::Display(DisplayError::Interrupted)) => {
                return Err(Failure::Interrupted("no report was written"));
            }
            Err(ReproductionError::Design(error)) if papilio_design::search::was_stopped(&error) => {
                return Err(Failure::Interrupted("no report was written"));
            }
            other => samples.push(other?),
        }
    }
    drop((log, bar));
    Ok(samples)
}

/// The table of all samples.
fn text(samples: &[Prediction]) -> String {
    let head = ["sample", "verdict", "rms difference", "of", "rms z", "with unknowns", "mean dE2000"];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    let value = |value: Option<f64>, decimals: usize| {
        value.map_or("-".to_owned(), |value| format!("{value:.decimals$}"))
    };
    rows.extend(samples.iter().map(|sample| {
        vec![
            sample.name.clone(),
            sample.verdict.in_words().to_owned(),
            rounded(sample.rms),
            sample.rms_of.clone(),
            value(sample.z_rms, 2),
            value(sample.z_rms_with_unknowns, 2),
            value(sample.delta_e_2000_mean, 2),
        ]
    }));
    let mut text =
        format!("samples that others measured, predicted without fitting\n{}", crate::report::table(&rows));
    for sample in samples {
        text.push_str(&format!(
            "\n{}: {}\n  {} ({})\n  inputs: {}\n",
            sample.name, sample.title, sample.source, sample.licence, sample.inputs
        ));
        if !sample.unknowns.is_empty() {
            text.push_str(&format!("  not printed: {}\n", sample.unknowns.join("; ")));
        }
        if !sample.remark.is_empty() {
            text.push_str(&format!("  {}\n", sample.remark));
        }
    }
    text
}

/// A number with two significant digits.
fn rounded(value: f64) -> String {
    format!("{value:.1e}").parse().unwrap_or(value).to_string()
}
