//! `papilio gonio`: a virtual goniometer measures a surface.

use std::io::Write;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use papilio_figures::{Chart, ChartCurve, Hue, chart};
use papilio_formats::{SurfaceAuditFile, write_face, write_file, write_json, write_totals};
use papilio_microgeometry::{
    Goniometer, Kernel, Measured, MicrogeometryError, REPLICATES, Replicate, Side, Total,
};
use papilio_scenario::{ResolvedSurface, SurfaceScenario};

use crate::arguments::Gonio;
use crate::numbers::measured;
use crate::progress::Progress;
use crate::{Failure, folder, input, interrupt, output, print_notes, report, terminal};

/// A preview has this many times fewer rays, and three times the error.
const PREVIEW: u64 = 9;

pub(crate) fn gonio(arguments: &Gonio) -> Result<(), Failure> {
    let mut overrides = arguments.scenario.set.clone();
    overrides.extend(arguments.seed.map(|seed| format!("microgeometry.seed={seed}")));
    let mut resolved = input::scenario::<SurfaceScenario>(&arguments.scenario.file, &overrides)?.resolve()?;
    if arguments.preview {
        resolved.goniometer.rays = resolved.goniometer.rays.div_ceil(PREVIEW);
    }
    let folder = match (&arguments.scenario.out, arguments.json) {
        (None, true) => None,
        _ => Some(folder::choose(&arguments.scenario, &resolved.hash)?),
    };
    interrupt::catch_ctrl_c();
    let Some(replicates) = followed(&resolved, arguments.workers.threads)? else {
        return Err(Failure::Interrupted("no file was written"));
    };
    let goniometer = &resolved.goniometer;
    let totals = goniometer.totals(&replicates).map_err(failure)?;
    let kernel = goniometer.kernel(&replicates).map_err(failure)?;
    let title = resolved.title.clone().unwrap_or_else(|| report::file_title(&arguments.scenario.file));
    let audit = SurfaceAuditFile::new(
        [env!("CARGO_PKG_VERSION"), &title, &resolved.hash],
        [goniometer.index_above, goniometer.index_below],
        goniometer.seed,
        &kernel.audit,
    );
    let mut stdout = terminal::output(arguments.json);
    if arguments.json {
        write_json(&mut stdout, &audit)?;
    } else {
        stdout.write_all(text(&title, goniometer, &totals, &kernel).as_bytes())?;
    }
    stdout.flush()?;
    if let Some(folder) = &folder {
        let write = || -> Result<Vec<String>, Failure> {
            output::make_folder(folder)?;
            let file = |name: &str| -> Box<Path> { folder.join(name).into() };
            write_file(&file("audit.json"), |out| write_json(out, &audit))?;
            write_file(&file("totals.csv"), |out| write_totals(out, &totals))?;
            let index = [goniometer.index_above, goniometer.index_below];
            write_file(&file("face.npz"), |out| write_face(out, &resolved.hash, index, &kernel))?;
            let mut names = ["audit.json", "totals.csv", "face.npz"].map(str::to_owned).to_vec();
            let figures = vec![("totals".to_owned(), figure(&title, &totals))];
            names.extend(output::write_figures(folder, figures, arguments.png)?);
            Ok(names)
        };
        folder.print_written(&interrupt::uninterrupted(write)?);
    }
    print_notes(&resolved.notes);
    Ok(())
}

/// Follows the rays of all replicates on several threads; `None` if it was interrupted.
fn followed(resolved: &ResolvedSurface, threads: Option<u16>) -> Result<Option<Vec<Replicate>>, Failure> {
    let available = std::thread::available_parallelism().map_or(1, usize::from);
    let threads = threads.map_or(available, usize::from).clamp(1, REPLICATES as usize);
    let next = AtomicU64::new(0);
    let progress = Mutex::new(Progress::new(REPLICATES as usize, "replicates"));
    let stop = || interrupt::STOP.load(Ordering::Relaxed);
    let work = || {
        let mut found = Vec::new();
        loop {
            let number = next.fetch_add(1, Ordering::Relaxed);
            if number >= REPLICATES {
                return Ok(found);
            }
            found.push((number, resolved.goniometer.replicate(&resolved.surface, number, &stop)?));
            if let Ok(mut progress) = progress.lock() {
                progress.done(true);
            }
        }
    };
    let parts = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        let parts =
            workers.into_iter().map(|worker| worker.join().unwrap_or(Err(MicrogeometryError::Interrupted)));
        parts.collect::<Result<Vec<_>, MicrogeometryError>>()
    });
    match parts {
        Err(MicrogeometryError::Interrupted) => Ok(None),
        Err(other) => Err(failure(other)),
        Ok(parts) => {
            // The result does not depend on the threads.
            let mut all: Vec<(u64, Replicate)> = parts.into_iter().flatten().collect();
            all.sort_by_key(|(number, _)| *number);
            Ok(Some(all.into_iter().map(|(_, replicate)| replicate).collect()))
        }
    }
}

fn failure(wrong: MicrogeometryError) -> Failure {
    Failure::Input(wrong.to_string())
}

fn text(title: &str, goniometer: &Goniometer, totals: &[Total], kernel: &Kernel) -> String {
    let head = [
        "light from",
        "inclination, deg",
        "reflected, %",
        "beyond, %",
        "transmitted, %",
        "beyond, %",
        "regular, %",
        "facets",
    ];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    for total in totals {
        let percent = |one: Measured| measured(Some(100.0 * one.value), Some(100.0 * one.error), 2);
        let regular = Measured {
            value: total.regular_reflected.value + total.regular_transmitted.value,
            error: total.regular_reflected.error.hypot(total.regular_transmitted.error),
        };
        rows.push(vec![
            if total.from == Side::Above { "above" } else { "below" }.to_owned(),
            total.theta_deg.to_string(),
            percent(total.reflected),
            percent(total.reflected_beyond),
            percent(total.transmitted),
            percent(total.transmitted_beyond),
            percent(regular),
            measured(Some(total.mean_facets.value), Some(total.mean_facets.error), 2),
        ]);
    }
    let audit = &kernel.audit;
    let energy = (audit.energy_z.iter().map(|z| z * z).sum::<f64>() / audit.energy_z.len() as f64).sqrt();
    format!(
        "{}\n\nindex {} above, {} below; beyond: directions that do not exist in air; regular: exactly as by a flat face\n{}\n{} rays, {} of \
         them lost; kernel of {} x {} bands, mean error {:.1} % of the patches with 99 % of the light\nreciprocity: {:.2} standard errors (root \
         mean square of {} pairs), energy: {energy:.2}; moved to obey both: {:.2} % of the light\n",
        report::plain(title),
        goniometer.index_above,
        goniometer.index_below,
        report::table(&rows),
        audit.rays,
        audit.dropped_rays,
        kernel.bands.count(),
        kernel.bands.count(),
        100.0 * audit.relative_error,
        audit.reciprocity_z_rms,
        audit.reciprocity_tests,
        100.0 * (audit.moved_by_symmetry + audit.moved_by_balance),
    )
}

/// Reflected and transmitted light against inclination, from both sides.
fn figure(title: &str, totals: &[Total]) -> String {
    let curve = |side: Side, name: &str, hue: usize, dashed: bool, of: fn(&Total) -> f64| ChartCurve {
        name: name.to_owned(),
        hue: Hue::Group(hue),
        dashed,
        marks: false,
        points: totals
            .iter()
            .filter(|total| total.from == side)
            .map(|total| (total.theta_deg, 100.0 * of(total)))
            .collect(),
    };
    let reflected = |total: &Total| total.reflected.value;
    let seen = |total: &Total| total.transmitted.value - total.transmitted_beyond.value;
    let beyond = |total: &Total| total.transmitted_beyond.value;
    let all = Chart {
        x: "inclination of the light in its medium (deg)".to_owned(),
        y: "light (%)".to_owned(),
        logarithmic: false,
        at_least: vec![0.0, 100.0],
        curves: vec![
            curve(Side::Above, "above: reflected", 0, false, reflected),
            curve(Side::Above, "above: to |beta| < 1", 1, false, seen),
            curve(Side::Above, "above: beyond", 2, false, beyond),
            curve(Side::Below, "below: reflected", 0, true, reflected),
            curve(Side::Below, "below: transmitted", 1, true, seen),
        ],
    };
    chart(&all, title)
}
