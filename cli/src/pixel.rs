//! `papilio pixel`: the reflectance of the pixel alone.

mod json;

use std::io::Write;
use std::path::Path;

use papilio_colour::peak_nm;
use papilio_display::pixel::{PixelAbsorption, PixelScan, absorption, primaries, scan_at, state_names};
use papilio_display::scene::{self, AngleMedium, Scene};
use papilio_figures::{PixelScan as Figure, pixel_scan};
use papilio_formats::{PixelTable, write_absorption, write_file, write_json, write_sub_pixels};
use papilio_scenario::{Resolved, Scenario};

use crate::arguments::{Angles, Pixel};
use crate::{Failure, folder, input, interrupt, output, print_notes, print_warnings, report};

/// Default steps of the angles, in degrees.
const STEP_DEG: f64 = 1.0;
const ABSORPTION_STEP_DEG: f64 = 15.0;

/// Tables of the absorptance of each layer.
const ABSORPTION: [&str; 2] = ["absorption.csv", "sub-pixels.csv"];

/// Largest size of a scan; few programs can open a larger file.
const MOST_NUMBERS: usize = 10_000_000;

/// Angles in the table on the terminal, degrees.
const SHOWN_DEG: [f64; 4] = [0.0, 15.0, 30.0, 45.0];

pub(crate) fn pixel(arguments: &Pixel) -> Result<(), Failure> {
    let resolved = input::scenario::<Scenario>(&arguments.scenario.file, &arguments.scenario.set)?
        .resolve_without_light()?;
    let mut notes = resolved.notes.clone();
    notes.extend(resolved.scene.ignores_polariser());
    print_notes(&notes);
    print_warnings(&resolved.warnings);
    let mut scene = resolved.scene.clone();
    match arguments.angles {
        None => {}
        Some(Angles::Air) => scene.solver.angle_medium = AngleMedium::Air,
        Some(Angles::Glass) => scene.solver.angle_medium = AngleMedium::Glass,
    }
    let phi_deg = azimuths(arguments);
    let theta_deg = angles(arguments.step.unwrap_or(STEP_DEG), phi_deg.len(), &scene)?;
    let absorption =
        if arguments.absorption { Some(absorption_of(arguments, &resolved, &scene)?) } else { None };
    let folder = match (&arguments.scenario.out, arguments.json) {
        (None, true) => None,
        _ => Some(folder::choose(&arguments.scenario, &resolved)?),
    };
    let scan =
        scan_at(&scene, &theta_deg, &phi_deg).map_err(|error| Failure::from_display(&resolved, error))?;
    let is_given = !arguments.phi.is_empty() || arguments.phi_step.is_some();
    if is_given && scan.phi_deg.is_empty() {
        let note = "the reflectance of this pixel is the same at all azimuths: pixel.csv has none".to_owned();
        print_notes(std::slice::from_ref(&note));
        notes.push(note);
    }
    let medium = if scene.solver.angle_medium == AngleMedium::Air { "air" } else { "glass" };
    let title = resolved.title.clone().unwrap_or_else(|| report::file_title(&arguments.scenario.file));
    let mut stdout = crate::terminal::output(arguments.json);
    if arguments.json {
        let (of, said) = ([&title[..], &resolved.hash], [&notes[..], &resolved.warnings]);
        write_json(&mut stdout, &json::PixelJson::new(of, said, medium, &scan, absorption.as_ref()))?;
    } else {
        stdout.write_all(
            report::pixel(&title, medium, &peaks(&scene, &scan), scan.phi_deg.first().copied()).as_bytes(),
        )?;
        if let Some(absorption) = &absorption {
            stdout.write_all(report::absorption(absorption, medium).as_bytes())?;
        }
    }
    stdout.flush()?;
    let Some(folder) = folder else { return Ok(()) };
    interrupt::catch_ctrl_c();
    let names = interrupt::uninterrupted(|| {
        folder::make(&folder, &resolved.hash)?;
        let mut names = write(&folder, scan, &title, medium, arguments.png)?;
        if let Some(absorption) = &absorption {
            names.extend(write_absorbed(&folder, absorption, [&title, medium], arguments.png)?);
        }
        folder::write_about(&folder, [&title, &resolved.hash], [&notes, &resolved.warnings])?;
        names.push(folder::ABOUT.to_owned());
        Ok::<_, Failure>(names)
    })?;
    folder.print_written(&names);
    Ok(())
}

/// Computes the absorptance of each layer; fails if it would be too large.
fn absorption_of(arguments: &Pixel, resolved: &Resolved, scene: &Scene) -> Result<PixelAbsorption, Failure> {
    let theta_deg = angles(arguments.step.unwrap_or(ABSORPTION_STEP_DEG), 1, scene)?;
    if let scene::Pixel::Film(film) = &scene.display.pixel {
        let parts = film.states.len() * film.sub_pixels.len() * (film.layers.len() + 1);
        let numbers = theta_deg.len() * parts * scene.grid.len();
        if numbers > MOST_NUMBERS {
            return Err(Failure::Input(format!(
                "absorption.csv would have {numbers} rows (states x sub-pixels x layers x angles x wavelengths); expected at \
                 most {MOST_NUMBERS}\n  = help: use a larger --step, a larger spectrum.step_nm or fewer states"
            )));
        }
    }
    absorption(scene, &theta_deg).map_err(|error| Failure::from_display(resolved, error))
}

fn write_absorbed(
    folder: &Path,
    absorption: &PixelAbsorption,
    [title, medium]: [&str; 2],
    png: bool,
) -> Result<Vec<String>, Failure> {
    let [rows, sub_pixels] = ABSORPTION.map(|name| folder.join(name));
    write_file(&rows, |out| write_absorption(out, absorption))?;
    write_file(&sub_pixels, |out| write_sub_pixels(out, absorption))?;
    let figure = ("absorption".to_owned(), papilio_figures::absorption(absorption, medium, title));
    let figures = output::write_figures(folder, vec![figure], png)?;
    Ok(ABSORPTION.map(str::to_owned).into_iter().chain(figures).collect())
}

/// Azimuths of the scan, ascending.
fn azimuths(arguments: &Pixel) -> Vec<f64> {
    if let Some(step) = arguments.phi_step {
        let count = (180.0 / step).round() as usize;
        return (0..count).map(|k| 180.0 * k as f64 / count as f64).collect();
    }
    let mut phi_deg = arguments.phi.clone();
    phi_deg.sort_by(f64::total_cmp);
    phi_deg.dedup();
    if phi_deg.is_empty() { vec![0.0] } else { phi_deg }
}

/// Angles from 0 to 90 deg. Fails if the scan, at this number of azimuths, would be too large.
fn angles(step: f64, azimuths: usize, scene: &Scene) -> Result<Vec<f64>, Failure> {
    let steps = (90.0 / step).round() as usize;
    let numbers = (steps + 1) * azimuths * state_names(&scene.display.pixel).len() * scene.grid.len();
    if numbers > MOST_NUMBERS {
        let (by_azimuth, coarser) = match azimuths {
            1 => ("", ""),
            _ => (" x azimuths", " fewer azimuths,"),
        };
        return Err(Failure::Input(format!(
            "the scan would have {numbers} numbers (angles{by_azimuth} x states x wavelengths); expected at most {MOST_NUMBERS}\n  \
             = help: use{coarser} a larger --step, a larger spectrum.step_nm or fewer states"
        )));
    }
    Ok((0..=steps).map(|k| 90.0 * k as f64 / steps as f64).collect())
}

fn write(
    folder: &Path,
    scan: PixelScan,
    title: &str,
    medium: &str,
    png: bool,
) -> Result<Vec<String>, Failure> {
    let names: Vec<String> = scan.states.iter().map(|(name, _)| name.clone()).collect();
    // The figure shows the first azimuth.
    let (bins, azimuths) = (scan.wavelength_nm.len(), scan.phi_deg.len().max(1));
    let rows = scan.states.iter().flat_map(|(_, values)| values.chunks(bins).step_by(azimuths));
    let reflectance: Vec<f64> = rows.flatten().copied().collect();
    let title = match scan.phi_deg.first() {
        Some(phi) => format!("{title}, azimuth {phi} deg"),
        None => title.to_owned(),
    };
    let figure = Figure {
        states: &names,
        medium,
        theta_deg: &scan.theta_deg,
        wavelength_nm: &scan.wavelength_nm,
        reflectance: &reflectance,
    };
    let table = PixelTable {
        theta_deg: scan.theta_deg.clone(),
        phi_deg: scan.phi_deg,
        wavelength_nm: scan.wavelength_nm.clone(),
        states: scan.states,
    };
    write_file(&folder.join("pixel.csv"), |out| table.write(out))?;
    let figures = vec![("pixel".to_owned(), pixel_scan(&figure, &title))];
    let figures = output::write_figures(folder, figures, png)?;
    Ok(std::iter::once("pixel.csv".to_owned()).chain(figures).collect())
}

/// Peak wavelength and largest reflectance from 400 to 700 nm of each state, at the angles of the table and the first azimuth.
fn peaks(scene: &Scene, scan: &PixelScan) -> report::Peaks {
    let (bins, azimuths) = (scan.wavelength_nm.len(), scan.phi_deg.len().max(1));
    let shown: Vec<usize> = SHOWN_DEG
        .iter()
        .filter_map(|deg| scan.theta_deg.iter().position(|theta| (theta - deg).abs() < 1e-9))
        .collect();
    let largest = |row: &[f64]| {
        let inside = scan.wavelength_nm.iter().zip(row).filter(|(nm, _)| (400.0..=700.0).contains(*nm));
        inside.map(|(_, r)| *r).fold(0.0, f64::max)
    };
    let primaries = primaries(&scene.display.pixel);
    let of_state = |name: &String, values: &[f64]| {
        let peak = |row: &[f64]| peak_nm(&scene.grid, row).filter(|_| primaries.contains(name));
        shown
            .iter()
            .map(|at| &values[at * azimuths * bins..][..bins])
            .map(|row| (peak(row), largest(row)))
            .collect()
    };
    report::Peaks {
        theta_deg: shown.iter().map(|at| scan.theta_deg[*at]).collect(),
        states: scan.states.iter().map(|(name, values)| (name.clone(), of_state(name, values))).collect(),
    }
}
