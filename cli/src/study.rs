//! `papilio study sampling`: standard errors of samplers and strategies.

use std::fmt::Write as _;
use std::io::Write;
use std::time::Instant;

use papilio_display::scene::{Sampler, Strategy};
use papilio_display::{StudyCurve, StudyPoint, study};
use papilio_figures::{ErrorCurve, ErrorPanel, accuracy, point_sets};
use papilio_formats::{write_file, write_study};
use papilio_sampling::table_4_1::Estimator;
use papilio_scenario::Scenario;

use crate::arguments::Study;
use crate::progress::with_progress;
use crate::{
    Failure, costs, folder, input, interrupt, numbers, output, print_message, print_notes, print_warnings,
    report,
};

/// Smallest number of paths: 16 for each replicate.
const FIRST: u64 = 512;

/// Paths of all samplers and strategies over those of `--paths`, about.
const CURVES: f64 = 12.0;

/// Points of each set in the figure of point sets.
const POINTS: u64 = 256;

pub(crate) fn sampling(Study::Sampling(arguments): &Study) -> Result<(), Failure> {
    let resolved =
        input::scenario::<Scenario>(&arguments.scenario.file, &arguments.scenario.set)?.resolve()?;
    print_notes(&resolved.notes);
    print_warnings(&resolved.warnings);
    let [first, last] = [FIRST, arguments.paths];
    let range = if last < 4 * first { first.to_string() } else { format!("{first} to {last}") };
    print_message(&format!(
        "note: the study traces {range} paths (--paths) whatever solver.relative_error is"
    ));
    // One thread, and for each sampler and strategy.
    costs::check_paths(&resolved, Some(arguments.paths), (CURVES, "--paths"), Some(1))?;
    let folder = folder::choose(&arguments.scenario, &resolved)?;
    let paths: Vec<u64> =
        std::iter::successors(Some(FIRST), |n| Some(4 * n)).take_while(|n| *n <= arguments.paths).collect();
    let started = Instant::now();
    let clock = || cpu_seconds().unwrap_or_else(|| started.elapsed().as_secs_f64());
    let curves = with_progress(&resolved, None, |control| study(&resolved.scene, &paths, &clock, control))?
        .ok_or(Failure::Interrupted("the study is incomplete; no file was written"))?;
    let title = resolved.title.unwrap_or_else(|| report::file_title(&arguments.scenario.file));
    let mut stdout = crate::terminal::output(false);
    stdout.write_all(format!("{}{}", table_4_1(), table(&title, &curves)).as_bytes())?;
    stdout.flush()?;
    let names = interrupt::uninterrupted(|| {
        folder::make(&folder, &resolved.hash)?;
        let mut names = write(&folder, &curves, &title, arguments.png)?;
        folder::write_about(&folder, [&title, &resolved.hash], [&resolved.notes, &resolved.warnings])?;
        names.push(folder::ABOUT.to_owned());
        Ok::<_, Failure>(names)
    })?;
    folder.print_written(&names);
    Ok(())
}

/// CPU time of this thread, if the system reports it.
#[cfg(unix)]
fn cpu_seconds() -> Option<f64> {
    let time = nix::time::clock_gettime(nix::time::ClockId::CLOCK_THREAD_CPUTIME_ID).ok()?;
    Some(time.tv_sec() as f64 + 1e-9 * time.tv_nsec() as f64)
}

#[cfg(not(unix))]
fn cpu_seconds() -> Option<f64> {
    None
}

/// Variances of estimates of an integral for several densities (Feng 2012, table 4.1).
fn table_4_1() -> String {
    let (samples, experiments) = (16, 20_000);
    let mut text = format!(
        "integral of x from 0 to 4 (Feng 2012, table 4.1); experiment: {experiments} estimates, each from {samples} \
         samples\n  {:<18} {:>12}  {:>12}  {:>24}  {:>16}\n",
        "density", "variance", "at N = 16", "in the experiment", "N for SE 0.08"
    );
    for estimator in Estimator::ALL {
        let (factor, power) = estimator.variance();
        let formula = if power == 1 { format!("{factor:.4}/N") } else { format!("{factor:.4}/N^{power}") };
        let exact = factor / (samples as f64).powi(power);
        let (found, error) = estimator.experiment(samples, experiments, 0);
        let found = format!("{found:.5} +- {error:.5}");
        let _ = writeln!(
            text,
            "  {:<18} {formula:>12}  {exact:>12.5}  {found:>24}  {:>16}",
            estimator.density_in_words(),
            estimator.samples_for(0.08)
        );
    }
    text
}

/// Report of the study: a row for each sampler and strategy.
fn table(title: &str, curves: &[StudyCurve]) -> String {
    let mut text = format!(
        "\n{}: largest relative standard error of Y among the states, first view, by number of paths\n  {:<16}{:<10}",
        report::plain(title),
        "sampler",
        "strategy"
    );
    let counts: Vec<u64> = curves.first().iter().flat_map(|c| c.points.iter().map(|p| p.paths)).collect();
    for paths in &counts {
        let _ = write!(text, "{:>10}", format!("{paths}"));
    }
    let _ =
        writeln!(text, "{:>16}{:>10}{:>11}{:>14}", "error ~ paths^", "us/path", "setup (ms)", "ms to 0.1 %");
    for curve in curves {
        let _ = write!(text, "  {:<16}{:<10}", curve.sampler.name(), curve.strategy.name());
        for point in &curve.points {
            let _ = write!(text, "{:>10}", format!("{:.4} %", 100.0 * point.relative_error));
        }
        let slope = curve.slope().map_or("-".to_owned(), |(p, error)| {
            format!("{} +- {error:.2}", numbers::unsigned_zero(format!("{:.2}", -p)))
        });
        let each = curve.points.last().map_or(0.0, |p| 1e6 * p.transport_s / p.paths as f64);
        let to = curve.seconds_to(1e-3).map_or("-".to_owned(), |s| format!("{:.2}", 1e3 * s));
        let _ = writeln!(text, "{slope:>16}{each:>10.2}{:>11.2}{to:>14}", 1e3 * curve.setup_s);
    }
    text
}

fn write(
    folder: &std::path::Path,
    curves: &[StudyCurve],
    title: &str,
    png: bool,
) -> Result<Vec<String>, Failure> {
    let mut names = vec!["study.csv".to_owned()];
    write_file(&folder.join("study.csv"), |out| write_study(out, curves))?;
    let mut figures: Vec<(String, String)> = Sampler::ALL
        .into_iter()
        .map(|sampler| {
            let of_sampler: Vec<&StudyCurve> =
                curves.iter().filter(|curve| curve.sampler == sampler).collect();
            let title = format!("{title}   \u{b7}   sampler: {}", sampler.name());
            (
                format!("study_{}", sampler.name()),
                accuracy(&panels(&of_sampler, |c| c.strategy.name()), &title),
            )
        })
        .collect();
    let guided: Vec<&StudyCurve> = curves.iter().filter(|c| c.strategy == Strategy::Kernel).collect();
    let of_samplers = accuracy(
        &panels(&guided, |c| c.sampler.name()),
        &format!("{title}   \u{b7}   samplers compared; directions drawn from the diffuser's kernel"),
    );
    figures.push(("study_samplers".to_owned(), of_samplers));
    figures.push((
        "point_sets".to_owned(),
        point_sets(&point_set_pairs(), &format!("{POINTS} points of each sampler")),
    ));
    names.extend(output::write_figures(folder, figures, png)?);
    Ok(names)
}

/// Panels of the relative error against paths and against CPU time.
fn panels(curves: &[&StudyCurve], name: impl Fn(&StudyCurve) -> &'static str) -> Vec<ErrorPanel> {
    let panel = |x: &str, of: &dyn Fn(&StudyPoint) -> f64| {
        let curve = |(group, curve): (usize, &&StudyCurve)| ErrorCurve {
            name: name(curve).to_owned(),
            group,
            dashed: false,
            points: curve.points.iter().map(|point| (of(point), point.relative_error)).collect(),
        };
        ErrorPanel { x: x.to_owned(), powers: true, curves: curves.iter().enumerate().map(curve).collect() }
    };
    vec![
        panel("Number of paths", &|p| p.paths as f64),
        panel("CPU time of transport (s)", &|p| p.transport_s),
    ]
}

/// Points of each sampler: the first two coordinates of samples 256 to 511.
fn point_set_pairs() -> Vec<(&'static str, Vec<[f64; 2]>)> {
    Sampler::ALL
        .into_iter()
        .map(|sampler| (sampler.name(), sampler.first_pairs(POINTS..2 * POINTS)))
        .collect()
}
