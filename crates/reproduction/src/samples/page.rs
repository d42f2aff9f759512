//! The report on samples as a page: a section for each, with its figures.

use super::{Prediction, Verdict, figures};
use crate::report::{Report, Section, Table, number};
use papilio_display::capitalised;

/// Returns the page of these samples.
pub fn report(samples: &[Prediction]) -> Report {
    let mut sections = vec![Section::new("summary", "All samples").table(summary(samples))];
    sections.extend(samples.iter().map(section));
    Report {
        title: "Measured samples".to_owned(),
        about: [
            "Samples that others measured and published, predicted by Papilio from their printed inputs. Nothing was fitted.",
            "z is predicted minus measured, over the root of the sum of the squares of both standard deviations: that of the \
             measurement, and that by the tolerances of the printed inputs. A sample agrees if the root mean square of its z is at \
             most 2. Inputs that were not printed widen the band, and are named.",
        ]
        .map(str::to_owned)
        .to_vec(),
        sections,
    }
}

/// A row for each sample.
fn summary(samples: &[Prediction]) -> Table {
    let mut table = Table::new(&[
        "sample",
        "verdict",
        "rms difference",
        "of",
        "rms z",
        "rms z with unknowns",
        "mean dE2000",
        "peaks, rms nm",
    ]);
    for sample in samples {
        let value = |value: Option<f64>| value.map_or("-".to_owned(), |value| number(value, 2));
        table.row([
            sample.title.clone(),
            in_words(sample.verdict).to_owned(),
            value(sample.rms),
            sample.rms_of.clone(),
            value(sample.z_rms),
            value(sample.z_rms_with_unknowns),
            value(sample.delta_e_2000_mean),
            value(sample.peak_difference_rms_nm),
        ]);
    }
    table
}

/// A verdict in words.
pub fn in_words(verdict: Option<Verdict>) -> &'static str {
    verdict.map_or("not judged: no standard deviation", Verdict::in_words)
}

/// The number of measured numbers behind a verdict, in words.
pub fn in_numbers(sample: &Prediction) -> String {
    match sample.judged {
        0 => String::new(),
        1 => ", of one number".to_owned(),
        count => format!(", of {count} numbers"),
    }
}

fn section(sample: &Prediction) -> Section {
    let unknowns = if sample.unknowns.is_empty() {
        String::new()
    } else {
        format!(" Not printed: {}.", sample.unknowns.join("; "))
    };
    let remark =
        if sample.remark.is_empty() { String::new() } else { format!(" {}.", capitalised(&sample.remark)) };
    let mut section = Section::new(sample.name.clone(), sample.title.clone())
        .say(format!("{} ({}).", sample.source, sample.licence))
        .say(format!("Inputs: {}.{unknowns}", sample.inputs))
        .say(format!("Verdict: {}{}.{remark}", in_words(sample.verdict), in_numbers(sample)));
    if !sample.not_compared.is_empty() {
        section = section.say(format!("Not compared: {}.", sample.not_compared.join("; ")));
    }
    let metrics = sample.cases.iter().flat_map(|case| &case.comparison.metrics);
    let mut table = Table::new(&["metric", "predicted", "measured", "z"]);
    metrics.for_each(|one| {
        let z = one.z.map_or("-".to_owned(), |z| number(z, 2));
        table.row([one.metric.clone(), number(one.simulated, 3), number(one.measured, 3), z]);
    });
    if !table.rows.is_empty() {
        section = section.table(table);
    }
    for brdf in sample.cases.iter().filter_map(|case| case.brdf.as_ref()) {
        let percent = |value: f64| number(100.0 * value, 2);
        let mut table = Table::new(&[
            "BRDF at",
            "mean %",
            "rms %",
            "95 % within %",
            "largest %",
            "rms of a Lambertian reflector %",
        ]);
        let at = format!("{} pairs of directions", brdf.pairs);
        let of = [brdf.mean, brdf.rms, brdf.within_95, brdf.largest, brdf.lambertian_rms].map(percent);
        table.row(std::iter::once(at).chain(of));
        section = section.table(table);
    }
    figures(sample).into_iter().fold(section, |section, one| section.figure(one.svg, one.caption))
}
