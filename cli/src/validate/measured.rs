//! `papilio validate --measured`: samples that others measured, predicted from their printed inputs.

use std::io::Write;
use std::path::{Path, PathBuf};

use papilio_design::DesignError;
use papilio_display::{Control, DisplayError};
use papilio_formats::{DataFile, write_file, write_json};
use papilio_reproduction::ReproductionError;
use papilio_reproduction::samples::{
    Prediction, SampleList, SampleReport, figures, in_numbers, in_words, predict, report,
};

use crate::arguments::Validate;
use crate::progress::FractionBar;
use crate::{Failure, interrupt, output, print_message};

/// Predicts the samples of this name, or of a list of one's own, or one of them; all shipped ones without a name. Samples that
/// cannot be predicted do not stop the others.
pub(super) fn run(arguments: &Validate, names: &[String]) -> Result<(), Failure> {
    let (name, of_list) = (names.first().map(String::as_str), names.get(1));
    if let (Some(name), Some(of_list)) = (name.filter(|name| !is_list(name)), of_list) {
        let reason = format!(
            "`{name}` and `{of_list}`: expected one sample, or a list of samples (.toml) and one of them"
        );
        return Err(Failure::Input(reason));
    }
    let folder = folder(arguments, name);
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
            let text = DataFile::open(Path::new(path), path)?.bytes;
            let text = String::from_utf8_lossy(&text);
            let files = Path::new(path).parent().unwrap_or(Path::new("")).to_owned();
            let list = SampleList::parse(&text, path).map_err(in_list)?;
            let list = of_list.map_or(Ok(list.clone()), |name| list.only(name)).map_err(in_list)?;
            (list, files)
        }
        _ => {
            let all = SampleList::shipped(&shipped)?;
            let list = name.map_or(Ok(all.clone()), |name| all.only(name)).map_err(in_list)?;
            (list, SampleList::folder(&shipped))
        }
    };
    let (samples, wrong) = predicted(arguments, &list, &files)?;
    let mut stdout = crate::terminal::output(arguments.json);
    let result = SampleReport { papilio: env!("CARGO_PKG_VERSION").to_owned(), samples };
    if arguments.json {
        write_json(&mut stdout, &result)?;
    } else if !result.samples.is_empty() {
        stdout.write_all(text(&result.samples).as_bytes())?;
    }
    stdout.flush()?;
    if let Some(folder) = folder.filter(|_| !result.samples.is_empty()) {
        let page = report(&result.samples).html();
        write_file(&folder.join("samples.json"), |out| write_json(out, &result))?;
        write_file(&folder.join("report.html"), |out| out.write_all(page.as_bytes()))?;
        // Figures of an earlier list could be mistaken for those of this one.
        output::remove(&folder, |name| name.starts_with("sample-") && name.ends_with(".svg"))?;
        let figures = result.samples.iter().flat_map(figures).map(|one| (one.name, one.svg));
        let names = output::write_figures(&folder, figures.collect(), false)?;
        let all = [vec!["report.html".to_owned(), "samples.json".to_owned()], names].concat().join(", ");
        print_message(&format!("wrote {}: {all}", folder.display()));
    }
    match wrong.as_slice() {
        [] => Ok(()),
        [one] => Err(Failure::Input(one.clone())),
        [first, others @ ..] => {
            others.iter().for_each(|error| print_message(&format!("error: {error}")));
            Err(Failure::Input(first.clone()))
        }
    }
}

/// Folder of the results; none for JSON alone.
fn folder(arguments: &Validate, name: Option<&str>) -> Option<PathBuf> {
    let stem = name.map(|name| Path::new(name).file_stem().unwrap_or_default());
    let usual = || stem.map_or("out/measured".into(), |stem| Path::new("out/measured").join(stem));
    match (&arguments.out, arguments.json) {
        (None, true) => None,
        (out, _) => Some(out.clone().unwrap_or_else(usual)),
    }
}

fn is_list(name: &str) -> bool {
    Path::new(name).extension().is_some_and(|end| end.eq_ignore_ascii_case("toml"))
}

/// A mistake in a list is one of the input.
fn in_list(error: ReproductionError) -> Failure {
    match error {
        ReproductionError::List(text) => Failure::Input(text),
        other => other.into(),
    }
}

/// The predictions, and what is wrong with the other samples.
fn predicted(
    arguments: &Validate,
    list: &SampleList,
    files: &Path,
) -> Result<(Vec<Prediction>, Vec<String>), Failure> {
    interrupt::catch_ctrl_c();
    let bar = FractionBar::new();
    let log = bar.in_log(String::new);
    let (mut samples, mut wrong) = (Vec::new(), Vec::new());
    for (number, sample) in list.samples.iter().enumerate() {
        let whole = list.samples.len() as f64;
        let control = Control {
            threads: arguments.workers.threads.map(usize::from),
            // The spread by the inputs follows each run.
            progress: &|now| bar.advance((number as f64 + 0.9 * now.fraction()) / whole, sample.name.clone()),
            stop: &interrupt::STOP,
        };
        match predict(sample, files, &control) {
            Ok(found) => samples.push(found),
            Err(error) if was_stopped(&error) => return Err(Failure::Interrupted("no report was written")),
            Err(error) => wrong.push(of_sample(&sample.name, &error)),
        }
    }
    drop((log, bar));
    Ok((samples, wrong))
}

fn was_stopped(error: &ReproductionError) -> bool {
    match error {
        ReproductionError::Display(DisplayError::Interrupted) => true,
        ReproductionError::Design(error) => papilio_design::search::was_stopped(error),
        _ => false,
    }
}

/// An error of a sample, with its name.
fn of_sample(name: &str, error: &ReproductionError) -> String {
    let of_scenario =
        matches!(error, ReproductionError::Scenario(_) | ReproductionError::Design(DesignError::Scenario(_)));
    let text = error.to_string();
    let text = text.strip_prefix("error: ").unwrap_or(&text).trim_end().to_owned();
    let note = if of_scenario && text.contains("--set") {
        "\n  = note: `set` of a case, `tolerances` and `unknowns` are given to the scenario as by --set"
    } else {
        ""
    };
    format!("the sample `{name}`: {text}{note}")
}

/// The table of all samples.
fn text(samples: &[Prediction]) -> String {
    let head =
        ["sample", "verdict", "rms difference", "of", "rms z", "with unknowns", "mean dE2000", "peaks (nm)"];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    let value = |value: Option<f64>, decimals: usize| {
        value.map_or("-".to_owned(), |value| format!("{value:.decimals$}"))
    };
    rows.extend(samples.iter().map(|sample| {
        vec![
            sample.name.clone(),
            in_words(sample.verdict).to_owned(),
            sample.rms.map_or("-".to_owned(), two_digits),
            sample.rms_of.clone(),
            value(sample.z_rms, 2),
            value(sample.z_rms_with_unknowns, 2),
            value(sample.delta_e_2000_mean, 2),
            value(sample.peak_difference_rms_nm, 1),
        ]
    }));
    let table = crate::report::table(&rows);
    let mut text = format!("samples that others measured, predicted without fitting\n{table}");
    for sample in samples {
        text.push_str(&format!(
            "\n{}: {}\n  {} ({})\n  inputs: {}\n",
            sample.name, sample.title, sample.source, sample.licence, sample.inputs
        ));
        text.push_str(&format!("  verdict: {}{}\n", in_words(sample.verdict), in_numbers(sample)));
        sample.not_compared.iter().for_each(|reason| text.push_str(&format!("  not compared: {reason}\n")));
        if !sample.unknowns.is_empty() {
            text.push_str(&format!("  not printed: {}\n", sample.unknowns.join("; ")));
        }
        if !sample.remark.is_empty() {
            text.push_str(&format!("  {}\n", sample.remark));
        }
        for brdf in sample.cases.iter().filter_map(|case| case.brdf.as_ref()) {
            let [mean, rms, within, lambertian] = [brdf.mean, brdf.rms, brdf.within_95, brdf.lambertian_rms]
                .map(|value| format!("{:.2} %", 100.0 * value));
            text.push_str(&format!(
                "  BRDF at {} pairs of directions: {mean} in the mean, {rms} rms, 95 % within {within}; a Lambertian reflector {lambertian} rms\n",
                brdf.pairs
            ));
        }
    }
    text
}

/// A number with two significant digits.
fn two_digits(value: f64) -> String {
    let decade = if value == 0.0 { 0.0 } else { value.abs().log10().floor() };
    let decimals = (1.0 - decade).clamp(0.0, 12.0) as usize;
    format!("{value:.decimals$}")
}
