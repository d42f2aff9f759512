//! `papilio gonio`: a virtual goniometer measures a surface.

use std::io::Write;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use papilio_figures::of_surface;
use papilio_formats::{
    SurfaceAuditFile, write_cutoffs, write_face, write_file, write_json, write_psd, write_totals, write_waves,
};
use papilio_microgeometry::{
    ByWaves, Coating, Goniometer, Kernel, LEAST_G, MOST_SLOPE, Measured, MicrogeometryError, REPLICATES,
    Side, Statistics, Total, Waves,
};
use papilio_scenario::{ResolvedSurface, SurfaceScenario};

use crate::arguments::Gonio;
use crate::numbers::{digits, measured};
use crate::progress::Progress;
use crate::{Failure, folder, input, interrupt, output, print_notes, report, terminal};

/// All files that a measurement may write, and the names of its figures.
const FILES: [&str; 6] = ["audit.json", "totals.csv", "face.npz", "psd.csv", "cutoff.csv", "waves.csv"];
const FIGURES: [&str; 4] = ["totals", "psd", "cutoff", "waves"];

pub(crate) fn gonio(arguments: &Gonio) -> Result<(), Failure> {
    let mut overrides = arguments.scenario.set.clone();
    overrides.extend(arguments.seed.map(|seed| format!("microgeometry.seed={seed}")));
    let mut resolved = input::scenario::<SurfaceScenario>(&arguments.scenario.file, &overrides)?.resolve()?;
    if arguments.preview {
        resolved = resolved.preview();
    }
    let folder = match (&arguments.scenario.out, arguments.json) {
        (None, true) => None,
        _ => Some(folder::choose(&arguments.scenario, &resolved.hash)?),
    };
    interrupt::catch_ctrl_c();
    let Some(found) = Found::measured(&resolved, arguments.workers.threads)? else {
        return Err(Failure::Interrupted("no file was written"));
    };
    let goniometer = &resolved.goniometer;
    let title = resolved.title.clone().unwrap_or_else(|| report::file_title(&arguments.scenario.file));
    let audit = SurfaceAuditFile::new(
        [env!("CARGO_PKG_VERSION"), &title, &resolved.hash],
        goniometer,
        found.rays.as_ref().map(|rays| (&rays.kernel.audit, &rays.totals[..])),
        found.waves.as_ref(),
        found.statistics.as_ref(),
    );
    let mut stdout = terminal::output(arguments.json);
    if arguments.json {
        write_json(&mut stdout, &audit)?;
    } else {
        stdout.write_all(text(&title, goniometer, &found).as_bytes())?;
    }
    stdout.flush()?;
    if let Some(folder) = &folder {
        let write = || found.write(folder, (&title, &resolved), &audit, arguments.png);
        folder.print_written(&interrupt::uninterrupted(write)?);
    }
    print_notes(&resolved.notes);
    Ok(())
}

/// What was measured.
struct Found {
    rays: Option<Rays>,
    waves: Option<ByWaves>,
    statistics: Option<Statistics>,
}

/// What was measured by rays.
struct Rays {
    totals: Vec<Total>,
    kernel: Kernel,
}

impl Found {
    /// Measures a surface on several threads; `None` if it was interrupted.
    fn measured(resolved: &ResolvedSurface, threads: Option<u16>) -> Result<Option<Self>, Failure> {
        let ResolvedSurface { surface, goniometer, waves_nm, .. } = resolved;
        let stop = || interrupt::STOP.load(Ordering::Relaxed);
        let statistics = surface.statistics().map_err(failure)?;
        let mut found = Self { rays: None, waves: None, statistics };
        if !waves_nm.is_empty() {
            let index = [goniometer.index_above, goniometer.index_below];
            let waves = Waves { index, wavelengths_nm: waves_nm.clone() };
            let screen = |number| waves.screen(surface, number, &stop);
            let Some(screens) = on_threads(Waves::screens(surface), "phase screens", threads, &screen)?
            else {
                return Ok(None);
            };
            found.waves = Some(waves.combined(surface, &screens));
        }
        if resolved.by_rays {
            let replicate = |number| goniometer.replicate(surface, number, &stop);
            let Some(replicates) = on_threads(REPLICATES, "replicates", threads, &replicate)? else {
                return Ok(None);
            };
            let totals = goniometer.totals(&replicates).map_err(failure)?;
            found.rays = Some(Rays { totals, kernel: goniometer.kernel(&replicates).map_err(failure)? });
        }
        Ok(Some(found))
    }

    /// Writes all files and returns their names.
    fn write(
        &self,
        folder: &Path,
        (title, resolved): (&str, &ResolvedSurface),
        audit: &SurfaceAuditFile<'_>,
        png: bool,
    ) -> Result<Vec<String>, Failure> {
        output::make_folder(folder)?;
        // Those of an earlier road would be mistaken for results of this one.
        output::remove(folder, |name| FILES.contains(&name) || output::is_figure_of(&FIGURES, name))?;
        let mut names = Vec::new();
        let mut file = |name: &str| {
            names.push(name.to_owned());
            folder.join(name)
        };
        write_file(&file("audit.json"), |out| write_json(out, audit))?;
        if let Some(Rays { totals, kernel }) = &self.rays {
            write_file(&file("totals.csv"), |out| write_totals(out, totals))?;
            let index = [resolved.goniometer.index_above, resolved.goniometer.index_below];
            let coated = resolved.goniometer.coating != Coating::None;
            write_file(&file("face.npz"), |out| write_face(out, &resolved.hash, index, kernel, coated))?;
        }
        if let Some(statistics) = &self.statistics {
            write_file(&file("psd.csv"), |out| write_psd(out, statistics))?;
            write_file(&file("cutoff.csv"), |out| write_cutoffs(out, statistics))?;
        }
        if let Some(waves) = &self.waves {
            write_file(&file("waves.csv"), |out| write_waves(out, waves))?;
        }
        let totals = self.rays.as_ref().map(|rays| &rays.totals[..]);
        let figures = of_surface(totals, self.statistics.as_ref(), self.waves.as_ref(), title);
        names.extend(output::write_figures(folder, figures, png)?);
        Ok(names)
    }
}

/// Computes the parts of a measurement, `count` of them, on several threads; `None` if it was interrupted.
fn on_threads<T: Send>(
    count: u64,
    unit: &'static str,
    threads: Option<u16>,
    part: &(impl Fn(u64) -> Result<T, MicrogeometryError> + Sync),
) -> Result<Option<Vec<T>>, Failure> {
    let available = std::thread::available_parallelism().map_or(1, usize::from);
    let threads = threads.map_or(available, usize::from).clamp(1, count as usize);
    let next = AtomicU64::new(0);
    let progress = Mutex::new(Progress::new(count as usize, unit));
    let work = || {
        let mut found = Vec::new();
        loop {
            let number = next.fetch_add(1, Ordering::Relaxed);
            if number >= count {
                return Ok(found);
            }
            found.push((number, part(number)?));
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
            let mut all: Vec<(u64, T)> = parts.into_iter().flatten().collect();
            all.sort_by_key(|(number, _)| *number);
            Ok(Some(all.into_iter().map(|(_, part)| part).collect()))
        }
    }
}

fn failure(wrong: MicrogeometryError) -> Failure {
    Failure::Input(wrong.to_string())
}

fn text(title: &str, goniometer: &Goniometer, found: &Found) -> String {
    let mut text = format!(
        "{}\n\nindex {} above, {} below\n",
        report::plain(title),
        goniometer.index_above,
        goniometer.index_below
    );
    if let Some(statistics) = &found.statistics {
        let Statistics { rms_um, slope_rms: [x, y], correlation_um, .. } = statistics;
        let correlation =
            correlation_um.map_or(String::new(), |um| format!(", correlation length {} um", digits(um)));
        text += &format!(
            "heights: rms {} nm, rms slope {x:.4} along x, {y:.4} along y{correlation}\n",
            digits(1e3 * rms_um)
        );
    }
    if let Some(rays) = &found.rays {
        text += &rays_text(rays);
    }
    if let Some(waves) = &found.waves {
        text += &waves_text(waves, found.rays.as_ref());
    }
    text
}

fn rays_text(Rays { totals, kernel }: &Rays) -> String {
    let head = [
        "light from",
        "inclination, deg",
        "reflected, %",
        "beyond, %",
        "transmitted, %",
        "beyond, %",
        "regular, %",
        "facets",
        "absorbed, %",
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
            percent(total.absorbed),
        ]);
    }
    if totals.iter().all(|total| total.absorbed.value == 0.0) {
        rows.iter_mut().for_each(|row| row.truncate(row.len() - 1));
    }
    let audit = &kernel.audit;
    let energy = (audit.energy_z.iter().map(|z| z * z).sum::<f64>() / audit.energy_z.len() as f64).sqrt();
    format!(
        "\nby rays; beyond: directions that do not exist in air; regular: exactly as by a flat face\n{}\n{} rays, {} of \
         them lost; kernel of {} x {} bands, mean error {:.1} % of the patches with 99 % of the light\nreciprocity: {:.2} standard errors (root \
         mean square of {} pairs), energy: {energy:.2}; moved to obey both: {:.2} % of the light\n",
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

/// Waves, and whether they or rays hold.
fn waves_text(waves: &ByWaves, rays: Option<&Rays>) -> String {
    let head =
        ["wavelength, nm", "g", "straight through, %", "as by a mirror, %", "haze, %", "closed form, %"];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    for one in &waves.shares {
        let percent = |one: Measured| measured(Some(100.0 * one.value), Some(100.0 * one.error), 2);
        rows.push(vec![
            one.wavelength_nm.to_string(),
            digits(one.g),
            percent(one.straight),
            percent(one.mirror),
            percent(one.haze),
            measured(one.haze_closed_form.map(|haze| 100.0 * haze), None, 2),
        ]);
    }
    let mut text = format!(
        "\nby waves, along the normal; haze: beyond 2.5 deg in air; g: square of the rms phase; closed form: haze without a cut-off\n{}\n",
        report::table(&rows)
    );
    let rays_hold = waves.shares.iter().all(|one| one.g > LEAST_G);
    let waves_hold = waves.slope_rms < MOST_SLOPE;
    text += match (rays_hold, waves_hold) {
        (true, true) => "rays and waves both hold: g is above 10, and slopes are below 0.3\n",
        (true, false) => "rays hold, waves do not: slopes are above 0.3\n",
        (false, true) => "waves hold, rays do not at all wavelengths: g is below 10\n",
        (false, false) => {
            "neither rays (g is below 10) nor thin phase screens (slopes are above 0.3) hold at all wavelengths\n"
        }
    };
    if let Some(along) = rays.and_then(|rays| rays.totals.iter().find(|total| total.theta_deg == 0.0)) {
        let haze = measured(Some(100.0 * along.haze.value), Some(100.0 * along.haze.error), 2);
        text += &format!("haze by rays, the same at all wavelengths: {haze} %\n");
    }
    text
}
