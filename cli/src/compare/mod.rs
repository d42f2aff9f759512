//! `papilio compare`: a simulated display against a measured panel.

mod simulated;

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::io::Write;
use std::path::{Path, PathBuf};

use papilio_display::compare::{
    Agreement, Colour, Comparison, IN_PERCENT, Measured, Measurement, Simulated, StateComparison,
    ViewComparison, compare_measurement,
};
use papilio_display::pixel::is_mixture;
use papilio_figures::{compared_gamuts, compared_metrics, compared_spectra};
use papilio_formats::{
    DataFile, LARGEST_FILE, open_input, read_measurement, write_compared_metrics, write_compared_spectra,
    write_comparison, write_file, write_json,
};
use papilio_scenario::nearest;
use serde::Serialize;

use crate::arguments::Compare;
use crate::folder::{self, ResultFolder};
use crate::numbers::digits;
use crate::{Failure, interrupt, numbers, output, print_message, print_notes, print_warnings, report};

pub(crate) fn run(arguments: &Compare) -> Result<(), Failure> {
    let folder = match (&arguments.out, arguments.json) {
        (Some(folder), _) => Some(ResultFolder::stated(folder)?),
        (None, true) => None,
        (None, false) => Some(folder::choose_numbered(&Path::new("out").join("compare"))?),
    };
    let (measured, of_files) = measurement(&arguments.measured)?;
    let (result, mut read, mut notes) = simulated::read(arguments, &measured)?;
    let suggestion = suggestion(&read.simulated, &measured.states);
    let all = compare_measurement(&read.simulated, &measured).map_err(|error| {
        let usual = match measured.states.as_slice() {
            [] => "docs/metric-names.md says what each metric needs; directions must agree to within 1 deg",
            _ => "the names of states must equal those of the result, and angles must agree to within 1 deg",
        };
        let help = suggestion.clone().unwrap_or_else(|| format!("{usual}{}", angles_of(&measured.states)));
        let (result, measured) = (result.display(), names_of(&arguments.measured));
        Failure::Input(format!("{result} and {measured}: {error}\n  = help: {help}"))
    })?;
    let title = read.title.unwrap_or_else(|| report::file_title(&result));
    let heading = heading(&title, read.hash.as_deref(), &result, &arguments.measured);
    notes.extend(of_files.iter().cloned());
    let in_percent = all.looks_like_percent().then(|| IN_PERCENT.to_owned());
    read.warnings.extend(in_percent.clone());
    let file = ComparisonFile { warnings: &read.warnings, notes: &notes, all: &all };
    let written = folder
        .as_deref()
        .map(|folder| interrupt::uninterrupted(|| write(folder, &file, &title, arguments.png)))
        .transpose()?;
    let mut stdout = crate::terminal::output(arguments.json);
    if arguments.json {
        write_json(&mut stdout, &file)?;
    } else {
        stdout.write_all(report_text(&heading, &all).as_bytes())?;
    }
    stdout.flush()?;
    if let (Some(folder), Some(names)) = (folder, written) {
        folder.print_written(&names);
    }
    print_notes(&of_files);
    print_notes(&all.left_out);
    suggestion.iter().for_each(|help| print_message(&format!("  = help: {help}")));
    print_warnings(in_percent.as_slice());
    Ok(())
}

/// Reads a measurement from several files, with the notes on how they were read.
pub(crate) fn measurement(files: &[PathBuf]) -> Result<(Measurement, Vec<String>), Failure> {
    let (mut all, mut notes) = (Measurement::default(), Vec::new());
    let mut seen: Vec<PathBuf> = Vec::new();
    for file in files {
        if let Ok(same) = file.canonicalize() {
            if seen.contains(&same) {
                let reason = "this measurement is given twice\n  = help: every measured number counts once";
                return Err(Failure::Input(format!("{}: {reason}", file.display())));
            }
            seen.push(same);
        }
        let read = read_measurement(&open(file)?).map_err(Failure::Data)?;
        let name = file.display();
        notes.extend(read.warnings.iter().map(|note| format!("{name}: {note}")));
        all.append(read.value);
    }
    Ok((all, notes))
}

/// Most measured angles that a message lists.
const MOST_ANGLES: usize = 12;

/// The angles of measured states as the key of a scenario; empty if there are none, or too many to list.
fn angles_of(measured: &[Measured]) -> String {
    let mut all: Vec<f64> = measured.iter().filter_map(|one| one.theta_deg).collect();
    all.sort_by(f64::total_cmp);
    all.dedup();
    match all.len() {
        1..=MOST_ANGLES => {
            let all: Vec<String> = all.iter().map(f64::to_string).collect();
            format!("; those of the measurement are viewer.theta_deg = [{}]", all.join(", "))
        }
        _ => String::new(),
    }
}

/// Paths with commas between them.
pub(crate) fn names_of(files: &[PathBuf]) -> String {
    files.iter().map(|file| file.display().to_string()).collect::<Vec<_>>().join(", ")
}

/// A suggestion for measured states whose names are not in the result.
fn suggestion(simulated: &Simulated, measured: &[Measured]) -> Option<String> {
    let all = simulated.views.iter().flat_map(|view| &view.states);
    let known: BTreeSet<&str> = all.map(|one| one.name.as_str()).collect();
    let is_known = |name: &&str| known.iter().any(|known| known.to_lowercase() == name.to_lowercase());
    let unknown: BTreeSet<&str> =
        measured.iter().map(|one| one.state.as_str()).filter(|name| !is_known(name)).collect();
    let close =
        unknown.iter().filter_map(|wrong| nearest(wrong, known.iter().copied()).map(|name| (wrong, name)));
    let close: Vec<String> = close.map(|(wrong, name)| format!("`{name}` for `{wrong}`")).collect();
    (!close.is_empty()).then(|| format!("did you mean {}?", close.join(", ")))
}

fn open(path: &Path) -> Result<DataFile, Failure> {
    open_input(path, &path.display().to_string(), LARGEST_FILE).map_err(Failure::Data)
}

/// Content of `comparison.json`.
#[derive(Debug, Serialize)]
struct ComparisonFile<'a> {
    /// Warnings of the scenario and of its result, and what may be wrong with the measurement.
    warnings: &'a [String],
    /// Notes on the scenario, and on how the measurement was read.
    notes: &'a [String],
    #[serde(flatten)]
    all: &'a Comparison,
}

fn write(folder: &Path, file: &ComparisonFile<'_>, title: &str, png: bool) -> Result<Vec<String>, Failure> {
    let all = file.all;
    output::make_folder(folder)?;
    // Figures of an earlier comparison could be mistaken for those of this one.
    output::remove(folder, |name| {
        name.starts_with("compared-") || ["comparison-spectra.csv", "comparison-metrics.csv"].contains(&name)
    })?;
    let mut names = vec!["comparison.csv".to_owned(), "comparison.json".to_owned()];
    write_file(&folder.join("comparison.csv"), |out| write_comparison(out, all))?;
    write_file(&folder.join("comparison.json"), |out| write_json(out, file))?;
    if all.states.iter().any(|one| one.spectrum.is_some()) {
        write_file(&folder.join("comparison-spectra.csv"), |out| write_compared_spectra(out, all))?;
        names.push("comparison-spectra.csv".to_owned());
    }
    if !all.metrics.is_empty() {
        write_file(&folder.join("comparison-metrics.csv"), |out| write_compared_metrics(out, all))?;
        names.push("comparison-metrics.csv".to_owned());
    }
    for view in &all.views {
        let suffix = if all.views.len() == 1 {
            String::new()
        } else {
            papilio_display::view_in_name(view.theta_deg, view.phi_deg)
        };
        let spectra =
            compared_spectra(all, view, title).map(|svg| (format!("compared-spectra{suffix}"), svg));
        let gamuts = (format!("compared-gamuts{suffix}"), compared_gamuts(all, view, title));
        names.extend(output::write_figures(folder, spectra.into_iter().chain([gamuts]).collect(), png)?);
    }
    let metrics = compared_metrics(&all.metrics, title).map(|svg| ("compared-metrics".to_owned(), svg));
    names.extend(output::write_figures(folder, metrics.into_iter().collect(), png)?);
    Ok(names)
}

/// Lines that identify the two sides: the folder may contain the result of another scenario than the user
/// expects.
fn heading(title: &str, hash: Option<&str>, result: &Path, measured: &[PathBuf]) -> String {
    let hash =
        hash.map_or(String::new(), |hash| format!(" (hash {})", hash.chars().take(12).collect::<String>()));
    let title = report::plain(title);
    format!("{title}\nsimulated: {}{hash}\nmeasured: {}\n", result.display(), names_of(measured))
}

/// Report of a comparison: a table for each view.
fn report_text(heading: &str, all: &Comparison) -> String {
    let mut text = heading.to_owned();
    for view in &all.views {
        let _ = write!(text, "\nseen from {} deg", view.theta_deg);
        if view.phi_deg != 0.0 {
            let _ = write!(text, ", azimuth {} deg", view.phi_deg);
        }
        let _ = write!(text, ": simulated / measured\n{}", report::table(&rows(all, view)));
        text.push_str(&display_metrics(view));
    }
    if !all.metrics.is_empty() {
        let _ = write!(text, "\nmetrics\n{}", report::table(&metric_rows(all)));
    }
    if let Some(Agreement { count, z_rms, within_2 }) = all.agreement {
        let percent = 100.0 * within_2;
        let _ = write!(
            text,
            "\nz of {count} numbers with a standard deviation: rms {z_rms:.2}, {percent:.0} % within 2\n"
        );
    }
    text
}

fn metric_rows(all: &Comparison) -> Vec<Vec<String>> {
    let titles = ["metric", "theta (deg)", "simulated", "measured", "z"];
    let mut rows = vec![titles.map(str::to_owned).to_vec()];
    rows.extend(all.metrics.iter().map(|one| {
        let with = |value: f64, deviation: Option<f64>| match deviation {
            Some(deviation) if deviation > 0.0 => format!("{} +- {}", digits(value), digits(deviation)),
            _ => digits(value),
        };
        vec![
            one.metric.clone(),
            digits(one.theta_deg),
            with(one.simulated, Some(one.simulated_deviation)),
            with(one.measured, one.measured_deviation),
            number(one.z, 2),
        ]
    }));
    rows
}

fn rows(all: &Comparison, view: &ViewComparison) -> Vec<Vec<String>> {
    let titles = ["state", "Y", "contrast", "peak (nm)", "dE2000", "du'v'", "mean dR", "rms dR"];
    let has_z = all.agreement.is_some();
    let of_z = has_z.then_some("rms z");
    let mut rows = vec![titles.into_iter().chain(of_z).map(str::to_owned).collect::<Vec<String>>()];
    let here = |one: &&StateComparison| one.theta_deg == view.theta_deg && one.phi_deg == view.phi_deg;
    for one in all.states.iter().filter(here) {
        let pair = |get: fn(&Colour) -> Option<f64>, decimals: usize| {
            pair_text([get(&one.simulated), get(&one.measured)], decimals)
        };
        let spectrum = one.spectrum.as_ref();
        let mut row = vec![
            one.state.clone(),
            pair(|colour| Some(colour.Y), 4),
            pair(|colour| colour.contrast, 2),
            if is_mixture(&one.state) { "-".to_owned() } else { pair(|colour| colour.peak_nm, 1) },
            number(one.delta_E_2000, 2),
            number(one.distance_uv, 4),
            number(spectrum.map(|spectrum| spectrum.mean_difference), 4),
            number(spectrum.map(|spectrum| spectrum.rms_difference), 4),
        ];
        row.extend(has_z.then(|| number(one.agreement.map(|all| all.z_rms), 2)));
        rows.push(row);
    }
    rows
}

/// Metrics of the display, simulated and measured; undefined ones are omitted.
fn display_metrics(view: &ViewComparison) -> String {
    let pairs = [
        ("contrast ratio", view.contrast_ratio, ""),
        ("gamut area in u'v'", view.gamut_percent_srgb, " % of sRGB"),
        ("", view.gamut_percent_ebu, " % of EBU"),
    ];
    let known = pairs.into_iter().filter(|(_, pair, _)| pair.iter().any(Option::is_some));
    let mut parts: Vec<String> = known
        .map(|(name, pair, unit)| format!("{name} {}{unit}", pair_text(pair, 2)).trim_start().to_owned())
        .collect();
    if let Some((rms, mean)) = view.rms_peak_difference_nm.zip(view.average_peak_difference_nm) {
        let mean = numbers::signed(mean, 1);
        parts.push(format!("rms difference of the peaks {rms:.1} nm (mean with sign {mean} nm)"));
    }
    if parts.is_empty() { String::new() } else { format!("  {}\n", parts.join(", ")) }
}

fn pair_text(pair: [Option<f64>; 2], decimals: usize) -> String {
    match pair {
        [None, None] => "-".to_owned(),
        pair => pair.map(|value| number(value, decimals)).join(" / "),
    }
}

fn number(value: Option<f64>, decimals: usize) -> String {
    value.map_or("-".to_owned(), |value| numbers::unsigned_zero(format!("{value:.decimals$}")))
}
