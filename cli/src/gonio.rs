//! `papilio gonio`: a virtual goniometer measures a surface; an interrupted measurement can be resumed.

use std::io::Write;
use std::path::Path;
use std::sync::atomic::Ordering;

use papilio_figures::of_surface;
use papilio_formats::{
    AzimuthAudit, GonioHead, Holds, JournalRows, SurfaceAuditFile, WaveRow, journal_name, roads_that_hold,
    write_cutoffs, write_face, write_file, write_json, write_psd, write_totals, write_waves,
};
use papilio_microgeometry::{
    ByRays, ByWaves, Coating, Collected, Findings, Goniometer, Measured, Measurement, MicrogeometryError,
    REPLICATES, Side, Statistics,
};
use papilio_scenario::{ResolvedSurface, SurfaceScenario};

use crate::arguments::Gonio;
use crate::journal::open_rows;
use crate::numbers::{digits, measured};
use crate::parallel::compute_parallel;
use crate::{Failure, costs, folder, input, interrupt, output, print_message, print_notes, report, terminal};

/// Names of journals begin with this.
const STEM: &str = "gonio";

/// All files that a measurement may write, and the names of its figures.
const FILES: [&str; 7] =
    ["audit.json", "totals.csv", "totals_by_azimuth.csv", "face.npz", "psd.csv", "cutoff.csv", "waves.csv"];
const FIGURES: [&str; 5] = ["totals", "azimuths", "psd", "cutoff", "waves"];

pub(crate) fn gonio(arguments: &Gonio) -> Result<(), Failure> {
    let mut overrides = arguments.scenario.set.clone();
    overrides.extend(arguments.seed.map(|seed| format!("microgeometry.seed={seed}")));
    let mut resolved = input::scenario::<SurfaceScenario>(&arguments.scenario.file, &overrides)?.resolve()?;
    if arguments.preview {
        resolved = resolved.preview();
    }
    let replicates = if resolved.measurement.by_rays { REPLICATES } else { 0 };
    let rays = resolved.measurement.goniometer.rays.saturating_mul(replicates);
    costs::check_rays(rays, arguments.workers.threads)?;
    let folder = match (&arguments.scenario.out, arguments.json) {
        (None, true) => None,
        _ => Some(folder::choose_for_surface(&arguments.scenario, &resolved.hash)?),
    };
    let mut journal = folder.as_deref().map(|folder| open_journal(folder, &resolved)).transpose()?;
    let measurement = &resolved.measurement;
    let found = measure(measurement, &mut journal, arguments.workers.threads);
    if let (Some(folder), Err(Failure::Input(_))) = (&folder, &found) {
        discard(journal.take(), folder)?;
    }
    let found = found?;
    let goniometer = &measurement.goniometer;
    let title = resolved.title.clone().unwrap_or_else(|| report::file_title(&arguments.scenario.file));
    let head = [env!("CARGO_PKG_VERSION"), &title, &resolved.hash];
    let audit = SurfaceAuditFile::new(head, &resolved.notes, goniometer, &found);
    let mut stdout = terminal::output(arguments.json);
    if arguments.json {
        write_json(&mut stdout, &audit)?;
    } else {
        stdout.write_all(text(&title, goniometer, &found).as_bytes())?;
    }
    stdout.flush()?;
    if let Some(folder) = &folder {
        let write = || {
            let names = write(&found, folder, (&title, &resolved), &audit, arguments.png)?;
            discard(journal, folder)?;
            Ok::<_, Failure>(names)
        };
        folder.print_written(&interrupt::uninterrupted(write)?);
    }
    print_notes(&resolved.notes);
    Ok(())
}

/// Opens the journal of a measurement in a folder.
fn open_journal(folder: &Path, resolved: &ResolvedSurface) -> Result<JournalRows<GonioHead>, Failure> {
    output::make_folder(folder)?;
    let head = GonioHead {
        papilio: env!("CARGO_PKG_VERSION").to_owned(),
        hash: resolved.hash.clone(),
        rays: resolved.measurement.goniometer.rays,
    };
    open_rows(folder, STEM, None, head, &[])
}

/// Removes a journal from which nothing is to be resumed, and its folder, if it is empty.
fn discard(journal: Option<JournalRows<GonioHead>>, folder: &Path) -> Result<(), Failure> {
    drop(journal);
    output::remove(folder, |name| name == journal_name(STEM, None))?;
    // A folder with other files stays.
    let _ = std::fs::remove_dir(folder);
    Ok(())
}

/// Measures what the journal does not contain.
fn measure(
    measurement: &Measurement,
    journal: &mut Option<JournalRows<GonioHead>>,
    threads: Option<u16>,
) -> Result<Findings, Failure> {
    let parts = compute(measurement, journal, threads)?;
    let all = measurement.parts();
    if parts.parts() == all {
        return measurement.findings(parts).map_err(failure);
    }
    if journal.is_none() {
        return Err(Failure::Interrupted("nothing was written"));
    }
    print_message(&format!("{} of {all} parts are finished and saved", parts.parts()));
    Err(Failure::Interrupted("run the same command again to resume"))
}

/// Computes the parts of a measurement that its journal does not contain, and saves them there. Ends early if
/// interrupted.
fn compute(
    measurement: &Measurement,
    journal: &mut Option<JournalRows<GonioHead>>,
    threads: Option<u16>,
) -> Result<Collected, Failure> {
    let mut parts = measurement.collected().map_err(failure)?;
    let mut missing = Vec::new();
    for number in 0..measurement.parts() {
        let saved = journal.as_mut().and_then(|journal| journal.take(number));
        match saved.and_then(|numbers| measurement.part_of(number, &numbers)) {
            Some(part) => parts.add(number, part),
            None => missing.push(number),
        }
    }
    if parts.parts() > 0 {
        let [known, all] = [parts.parts(), measurement.parts()];
        print_message(&format!("{known} of {all} parts are known from the interrupted measurement"));
    }
    let stop = || interrupt::STOP.load(Ordering::Relaxed);
    let worker = |_| {
        |number| match measurement.part(number, &stop) {
            Ok(part) => Ok(Some((number, part))),
            Err(MicrogeometryError::Interrupted) => Ok(None),
            Err(other) => Err(failure(other)),
        }
    };
    compute_parallel(&missing, "parts", threads, worker, |(number, part)| {
        if let Some(journal) = journal {
            journal.save(number, &part.numbers())?;
        }
        parts.add(number, part);
        Ok(true)
    })?;
    Ok(parts)
}

/// Writes all files and returns their names.
fn write(
    found: &Findings,
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
    if let Some(rays) = &found.rays {
        write_file(&file("totals.csv"), |out| write_totals(out, &rays.totals))?;
        if let Some(by_azimuth) = &rays.by_azimuth {
            write_file(&file("totals_by_azimuth.csv"), |out| write_totals(out, &by_azimuth.totals))?;
        }
        let goniometer = &resolved.measurement.goniometer;
        let index = [goniometer.index_above, goniometer.index_below];
        let coated = goniometer.coating != Coating::None;
        write_file(&file("face.npz"), |out| write_face(out, &resolved.hash, index, rays, coated))?;
    }
    if let Some(statistics) = &found.statistics {
        write_file(&file("psd.csv"), |out| write_psd(out, statistics))?;
        write_file(&file("cutoff.csv"), |out| write_cutoffs(out, statistics))?;
    }
    if let Some(waves) = &found.waves {
        write_file(&file("waves.csv"), |out| write_waves(out, waves, found.rays.as_ref()))?;
    }
    names.extend(output::write_figures(folder, of_surface(found, title), png)?);
    Ok(names)
}

fn failure(wrong: MicrogeometryError) -> Failure {
    Failure::Input(wrong.to_string())
}

fn text(title: &str, goniometer: &Goniometer, found: &Findings) -> String {
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

fn rays_text(ByRays { totals, kernel, by_azimuth }: &ByRays) -> String {
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
    let mut text = format!(
        "\nby rays; beyond: directions that do not exist in air; regular: exactly as by a flat face\n{}\n{} rays, {} of \
         them lost; kernel of {} x {} bands, mean error {:.1} % of the patches with 99 % of the light\nreciprocity: {:.2} standard errors (root \
         mean square of {} pairs), energy: {:.2}; moved to obey both: {:.2} % of the light\n",
        report::table(&rows),
        audit.rays,
        audit.dropped_rays,
        kernel.bands.count(),
        kernel.bands.count(),
        100.0 * audit.relative_error,
        audit.reciprocity_z_rms,
        audit.reciprocity_tests,
        audit.energy_z_rms(),
        100.0 * (audit.moved_by_symmetry + audit.moved_by_balance),
    );
    if let Some(by_azimuth) = by_azimuth {
        let AzimuthAudit {
            azimuth_deg,
            patches,
            energy_z,
            reciprocity_z,
            reciprocity_tests,
            moved_by_symmetry,
            moved_by_balance,
            relative_error,
            ..
        } = AzimuthAudit::from(&by_azimuth.kernel);
        let percent = |share: f64| 100.0 * share;
        text += &format!(
            "by azimuth, steps of {azimuth_deg} deg: kernel of {patches} x {patches} patches, mean error {:.0} %\nreciprocity: {reciprocity_z:.2} \
             standard errors ({reciprocity_tests} pairs), energy: {energy_z:.2}; moved to obey both: {:.1} % of the light\n",
            percent(relative_error),
            percent(moved_by_symmetry + moved_by_balance),
        );
    }
    text
}

/// Waves, and whether they or rays hold.
fn waves_text(waves: &ByWaves, rays: Option<&ByRays>) -> String {
    let head =
        ["wavelength, nm", "g", "straight through, %", "as by a mirror, %", "haze, %", "closed form, %"];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    for (one, through) in waves.along_normal() {
        rows.push(vec![
            one.wavelength_nm.to_string(),
            digits(through.g),
            percent(through.regular),
            percent(one.reflected.regular),
            percent(through.haze),
            closed(through.closed_form.map(|form| form.one_angle_haze)),
        ]);
    }
    let mut text = format!(
        "\nby waves, along the normal; haze: beyond 2.5 deg in air; g: square of the rms phase; closed form: haze without a cut-off\n{}\n",
        report::table(&rows)
    );
    text += roads_that_hold(waves);
    text.push('\n');
    if let Some(along) = rays.and_then(|rays| rays.totals.iter().find(|total| total.theta_deg == 0.0)) {
        text += &format!("haze by rays, the same at all wavelengths: {} %\n", percent(along.haze));
    }
    text + &oblique_text(waves, rays)
}

/// Waves at all inclinations, at the wavelength in the middle, and how much rays and waves differ.
fn oblique_text(waves: &ByWaves, rays: Option<&ByRays>) -> String {
    let all = WaveRow::all(waves, rays);
    let wavelengths: Vec<f64> = waves.along_normal().map(|(one, _)| one.wavelength_nm).collect();
    let Some(nm) = wavelengths.get(wavelengths.len() / 2) else { return String::new() };
    let head = [
        "light from",
        "inclination, deg",
        "straight, %",
        "haze, %",
        "two angles, %",
        "rays, %",
        "holds",
        "mirror, %",
        "haze of reflection, %",
        "two angles, %",
        "rays, %",
        "holds",
    ];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    for one in all.iter().filter(|one| one.wavelength_nm == *nm) {
        let pair = |value: Option<f64>, error: Option<f64>| {
            measured(value.map(|value| 100.0 * value), error.map(|error| 100.0 * error), 2)
        };
        rows.push(vec![
            one.from.name().to_owned(),
            one.theta_deg.to_string(),
            pair(one.straight, one.straight_error),
            pair(one.haze, one.haze_error),
            closed(one.haze_two_angles),
            closed(one.haze_rays),
            one.holds.map_or("-", Holds::name).to_owned(),
            pair(Some(one.mirror), Some(one.mirror_error)),
            pair(Some(one.haze_reflected), Some(one.haze_reflected_error)),
            closed(one.haze_reflected_two_angles),
            closed(one.haze_reflected_rays),
            one.holds_reflected.name().to_owned(),
        ]);
    }
    // The normal alone is in the table above.
    if rows.len() < 3 {
        return String::new();
    }
    let mut text = format!(
        "\nby waves of {nm} nm at all inclinations; haze: beyond 2.5 deg from the regular direction; two angles: generalised Harvey-Shack form\n{}\n",
        report::table(&rows)
    );
    let transmitted = |one: &WaveRow| Some((one.holds?, one.haze?, one.haze_rays?));
    let reflected = |one: &WaveRow| Some((one.holds_reflected, one.haze_reflected, one.haze_reflected_rays?));
    let pairs = all.iter().flat_map(|one| [transmitted(one), reflected(one)]).flatten();
    let differences =
        pairs.filter(|(holds, ..)| *holds == Holds::Both).map(|(_, waves, rays)| (waves - rays).abs());
    if let Some(largest) = differences.reduce(f64::max) {
        let digits = measured(Some(100.0 * largest), None, 2);
        text += &format!(
            "where both hold, the haze of rays and of waves differs by up to {digits} % of the light\n"
        );
    }
    text
}

fn percent(one: Measured) -> String {
    measured(Some(100.0 * one.value), Some(100.0 * one.error), 2)
}

/// A fraction without error, in percent.
fn closed(fraction: Option<f64>) -> String {
    measured(fraction.map(|fraction| 100.0 * fraction), None, 2)
}
