//! `papilio brdf`: the BRDF of the whole display.

use std::io::Write;
use std::path::Path;

use papilio_design::output::{Refinable, between_warning, brdf_warnings, smallest_step, table_numbers};
use papilio_diagnostics::{number, suggestion};
use papilio_display::pixel::state_names;
use papilio_display::scene::{Scene, Stop};
use papilio_display::{
    BrdfGrid, BrdfTable, Control, DisplayError, HalfVectorGrid, HalfVectorTable, LobeWidths, ProbeGrid,
    RingGrid, RingTable, SavedRows, ViewerGrid, ViewerTable,
};
use papilio_figures::file_names;
use papilio_formats::{
    BetweenError, BsdfSource, Exported, MirrorFile, between_error, klems_numbers, klems_rings, scene_script,
    write_bsdf, write_bsdf_csv, write_bsdf_klems, write_bsdf_radiant, write_file, write_json,
    write_mirror_csv, write_reflection, write_rgl,
};
use papilio_scenario::{Resolved, Scenario};

use crate::arguments::{ALL_STATES, Brdf, BrdfFormat};
use crate::progress::Computation;
use crate::saved::SavedTable;
use crate::{Failure, folder, input, interrupt, output, print_notes, print_warnings, report};

const FILE: &str = "display-bsdf.npz";
const SPLIT: &str = "reflection.csv";
const MIRROR: &str = "display-mirror";
/// Beginning of the names of the files of states.
const START: &str = "display-";
const SCENE: &str = "scene.py";

/// Fractions of the progress that are the dependence on azimuth, the table, and the components of the reflection, about.
const PARTS: [f64; 3] = [0.01, 0.89, 0.1];

/// Step of the azimuths of the light where the display depends on them, degrees.
const PHI_STEP_DEG: f64 = 15.0;

pub(crate) fn brdf(arguments: &Brdf) -> Result<(), Failure> {
    let resolved = input::scenario::<Scenario>(&arguments.scenario.file, &arguments.scenario.set)?
        .resolve_without_light()?;
    let all = state_names(&resolved.scene.display.pixel);
    let states = chosen_states(&arguments.states, &all)?;
    let mut computation = Computation::in_parts(&PARTS);
    let phi_step = phi_step(arguments, &resolved, &mut computation)?;
    check_size(arguments, &resolved.scene, states.len(), phi_step)?;
    let folder = folder::choose(&arguments.scenario, &resolved)?;
    let saved = SavedTable::open(&folder, STEM, &resolved.hash, directions(arguments, phi_step))?;
    let some = (&states[..], all.len());
    let found = compute(arguments, &resolved, (some, phi_step), &mut computation, &saved).and_then(|found| {
        let split = computation.part(&resolved, arguments.workers.threads, |control| {
            papilio_display::reflection(&resolved.scene, &report::SPLIT_AT_DEG, control)
        })?;
        Ok((found, split.ok_or(Failure::Interrupted(NOTHING))?))
    });
    drop(computation);
    let ((table, probes), mut split) = match found {
        Ok(found) => found,
        Err(Failure::Interrupted(_)) => return Err(saved.interrupted(NOTHING, RESUME)),
        Err(other) => {
            saved.discard()?;
            return Err(other);
        }
    };
    let beams = match &table {
        Table::Directions(table) => table,
        Table::HalfVectors(_, beams) | Table::Rings(_, beams) | Table::Patches(_, beams) => beams,
    };
    let is_chosen = |name: &String| beams.states.iter().any(|state| state.name == *name);
    split.iter_mut().for_each(|one| one.states.retain(|state| is_chosen(&state.name)));
    let title = resolved.title.clone().unwrap_or_else(|| report::file_title(&arguments.scenario.file));
    let mut stdout = crate::terminal::output(false);
    stdout.write_all(report::brdf(&title, beams).as_bytes())?;
    stdout.write_all(report::reflection(&split).as_bytes())?;
    stdout.flush()?;
    let source = BsdfSource { papilio: env!("CARGO_PKG_VERSION"), title: &title, hash: &resolved.hash };
    let notes = [&resolved.notes[..], resolved.scene.ignores_polariser().as_slice()].concat();
    let of_table = table_warnings(arguments, &resolved.scene, &table, &probes)?;
    let warnings = [&resolved.warnings[..], &of_table].concat();
    let names = interrupt::uninterrupted(|| {
        folder::make(&folder, &resolved.hash)?;
        let mut names = write_table(&folder, &source, [&notes, &warnings], arguments.format, &table)?;
        write_file(&folder.join(SPLIT), |out| write_reflection(out, &split))?;
        folder::write_about(&folder, [&title, &resolved.hash], [&notes, &warnings])?;
        names.extend([SPLIT, folder::ABOUT].map(str::to_owned));
        saved.discard()?;
        Ok::<_, Failure>(names)
    })?;
    folder.print_written(&names);
    print_notes(&notes);
    print_warnings(&warnings);
    Ok(())
}

/// Names of journals begin with this.
const STEM: &str = "brdf";

const NOTHING: &str = "no file was written";
const RESUME: &str = "finished rows are saved; run the same command again to resume";

/// Returns the step of the azimuths of the light; `None` for a display that is isotropic in azimuth.
fn phi_step(
    arguments: &Brdf,
    resolved: &Resolved,
    computation: &mut Computation,
) -> Result<Option<f64>, Failure> {
    let depends = computation.part(resolved, arguments.workers.threads, |control| {
        papilio_display::depends_on_azimuth(&resolved.scene, control)
    })?;
    match depends {
        None => Err(Failure::Interrupted(NOTHING)),
        Some(true) => Ok(Some(arguments.phi_step.unwrap_or(PHI_STEP_DEG))),
        Some(false) if arguments.phi_step.is_some() => Err(Failure::Input(
            "--phi-step is the step of the azimuths of the light, but this display is the same at all azimuths\n  = help: remove --phi-step"
                .to_owned(),
        )),
        Some(false) => Ok(None),
    }
}

/// The options that determine the directions of a table.
fn directions(arguments: &Brdf, phi_step: Option<f64>) -> String {
    let azimuths = phi_step.map_or_else(String::new, |step| format!(", azimuths {step}"));
    format!("{}{azimuths}", inclinations(arguments))
}

fn inclinations(arguments: &Brdf) -> String {
    let step = arguments.step_deg();
    match arguments.format {
        // The same directions in two formats.
        BrdfFormat::Npz | BrdfFormat::Csv => format!("step {step}"),
        BrdfFormat::Rgl => format!("half vectors {}, step {step}", grid_size(arguments)),
        BrdfFormat::Radiant => format!("rings, step {step}"),
        BrdfFormat::Klems => "patches".to_owned(),
    }
}

/// A table of the chosen states.
enum Table {
    Directions(BrdfTable),
    /// With what depends on the light alone.
    HalfVectors(HalfVectorTable, BrdfTable),
    /// The same.
    Rings(RingTable, BrdfTable),
    /// The same, on the rings from which patches are averaged.
    Patches(RingTable, BrdfTable),
}

/// Returns the numbers of the states to write, ascending.
fn chosen_states(chosen: &[String], all: &[String]) -> Result<Vec<usize>, Failure> {
    let mut numbers = Vec::new();
    for name in chosen.iter().map(|name| name.trim()) {
        match all.iter().position(|state| state == name) {
            Some(number) => numbers.push(number),
            None if name == ALL_STATES => numbers.extend(0..all.len()),
            None => {
                let hint = suggestion(name, all.iter().map(String::as_str), "states of this display");
                return Err(Failure::Input(format!(
                    "--states: there is no state `{name}`; expected {ALL_STATES} or names of states, separated by commas\n  = \
                     help: {hint}"
                )));
            }
        }
    }
    numbers.sort_unstable();
    numbers.dedup();
    Ok(numbers)
}

/// Fails if the table would be too large.
fn check_size(arguments: &Brdf, scene: &Scene, states: usize, phi_step: Option<f64>) -> Result<(), Failure> {
    let (step, bins) = (arguments.step_deg(), scene.grid.len());
    if arguments.grid.is_some() && arguments.format != BrdfFormat::Rgl {
        return Err(Failure::Input(
            "--grid is the number of half vectors along each axis of an RGL file; expected it only with --format rgl\n  = \
             help: --step is the step of the directions of the other formats"
                .to_owned(),
        ));
    }
    if arguments.step.is_some() && arguments.format == BrdfFormat::Klems {
        return Err(Failure::Input(
            "--step is the step of directions, but --format klems has the patches of its basis\n  = help: remove --step"
                .to_owned(),
        ));
    }
    let (numbers, axes, smaller) = match arguments.format {
        BrdfFormat::Rgl => {
            let size = grid_size(arguments);
            let numbers = HalfVectorGrid::numbers(step, phi_step, size, states, bins);
            (numbers, "theta_i x grid x grid", "a smaller --grid, ")
        }
        // What is computed at once; a file has X, Y and Z.
        BrdfFormat::Radiant => (RingGrid::numbers(step, phi_step, states, bins), "theta_i x viewers", ""),
        BrdfFormat::Klems => (klems_numbers(phi_step, states, bins), "theta_i x viewers", ""),
        BrdfFormat::Npz | BrdfFormat::Csv => {
            // A large number of steps is refused before the grid takes memory.
            (table_numbers(step, phi_step, states, bins), "theta_i x theta_o x dphi", "")
        }
    };
    if numbers > BrdfGrid::MOST_NUMBERS {
        let is_table = matches!(arguments.format, BrdfFormat::Npz | BrdfFormat::Csv);
        let (axes, phi) = match phi_step {
            Some(_) => (axes.replacen("theta_i", "theta_i x phi_i", 1), "--phi-step, a larger "),
            None => (axes.to_owned(), ""),
        };
        let permitted = match smallest_step(phi_step, states, bins).filter(|_| is_table) {
            Some(step) => format!(
                "--step {step} or more, or --format rgl or radiant, which have rings about the mirror direction and fewer numbers; "
            ),
            None => String::new(),
        };
        return Err(Failure::Input(format!(
            "the table would have {} numbers (states x {axes} x wavelengths); expected at most {}\n  \
             = help: use {permitted}{smaller}a larger {phi}{}spectrum.step_nm or fewer --states",
            number(numbers as f64),
            number(BrdfGrid::MOST_NUMBERS as f64),
            if permitted.is_empty() && arguments.format != BrdfFormat::Klems {
                "--step, a larger "
            } else {
                ""
            }
        )));
    }
    Ok(())
}

/// Number of half vectors along each axis.
fn grid_size(arguments: &Brdf) -> usize {
    arguments.grid.unwrap_or(HalfVectorGrid::USUAL)
}

/// Computes the table of the chosen states, of all `count`, and the display between its directions.
fn compute(
    arguments: &Brdf,
    resolved: &Resolved,
    ((states, count), phi_step): ((&[usize], usize), Option<f64>),
    computation: &mut Computation,
    saved: &SavedTable<'_>,
) -> Result<(Table, ViewerTable<ProbeGrid>), Failure> {
    let (scene, threads, step) = (&resolved.scene, arguments.workers.threads, arguments.step_deg());
    let some = (states, count, arguments.allow_error);
    let [rows, rows_between] = [0, 1].map(|part| saved.part(part, 2));
    let found = computation.part(resolved, threads, |control| {
        let widths = LobeWidths::of_scene(scene, control)?;
        let (table, lights) = match arguments.format {
            BrdfFormat::Npz | BrdfFormat::Csv => {
                let grid = match phi_step {
                    Some(phi_step) => BrdfGrid::around(step, phi_step),
                    None => BrdfGrid::even(step),
                };
                let mut table = papilio_display::brdf_resumed(scene, grid, control, &rows)?;
                if states.len() < count {
                    table = table.with_states(states);
                }
                let lights = table.grid.theta_i_deg.clone();
                (Table::Directions(table.allowing(arguments.allow_error)?), lights)
            }
            BrdfFormat::Rgl => {
                let size = grid_size(arguments);
                let grid = match phi_step {
                    Some(phi_step) => HalfVectorGrid::around(step, phi_step, size, &widths),
                    None => HalfVectorGrid::new(step, size, &widths),
                };
                let (table, beams, lights) = with_beams(scene, grid, (control, &rows), some)?;
                (Table::HalfVectors(table, beams), lights)
            }
            BrdfFormat::Radiant => {
                let rings = RingGrid::new(step, &widths);
                let rings = phi_step.map_or(rings.clone(), |phi_step| rings.around(phi_step));
                let (table, beams, lights) = with_beams(scene, rings, (control, &rows), some)?;
                (Table::Rings(table, beams), lights)
            }
            BrdfFormat::Klems => {
                let rings = klems_rings(&widths, phi_step);
                let (table, beams, lights) = with_beams(scene, rings, (control, &rows), some)?;
                (Table::Patches(table, beams), lights)
            }
        };
        let between = match phi_step {
            Some(phi_step) => ProbeGrid::around(&lights, phi_step, &widths),
            None => ProbeGrid::between(&lights, &widths),
        };
        let probes = papilio_display::brdf_at_viewers_resumed(scene, between, control, &rows_between)?;
        let probes = if states.len() < count { probes.with_states(states) } else { probes };
        Ok((table, probes))
    })?;
    found.ok_or(Failure::Interrupted(NOTHING))
}

/// Computes a table at viewers that move with the light, with what depends on the light alone, and the
/// inclinations of the light.
fn with_beams<G: ViewerGrid>(
    scene: &Scene,
    grid: G,
    (control, rows): (&Control<'_>, &dyn SavedRows),
    some: (&[usize], usize, Option<f64>),
) -> Result<(ViewerTable<G>, BrdfTable, Vec<f64>), DisplayError> {
    let table = at_viewers(scene, grid, (control, rows), some)?;
    let (beams, lights) = (table.of_beams(), table.grid.theta_i_deg().to_vec());
    Ok((table, beams, lights))
}

/// Computes the table of the chosen states, of all `count`, at viewers that move with the light.
fn at_viewers<G: ViewerGrid>(
    scene: &Scene,
    grid: G,
    (control, rows): (&Control<'_>, &dyn SavedRows),
    (states, count, allowed): (&[usize], usize, Option<f64>),
) -> Result<ViewerTable<G>, DisplayError> {
    let mut table = papilio_display::brdf_at_viewers_resumed(scene, grid, control, rows)?;
    if states.len() < count {
        table = table.with_states(states);
    }
    table.allowing(allowed)
}

/// Writes the files of a table, and returns their names. Files of other states from an earlier command are
/// removed.
fn write_table(
    folder: &Path,
    source: &BsdfSource<'_>,
    said: [&[String]; 2],
    format: BrdfFormat,
    table: &Table,
) -> Result<Vec<String>, Failure> {
    let end = match format {
        BrdfFormat::Npz => "npz",
        BrdfFormat::Csv => "csv",
        BrdfFormat::Rgl | BrdfFormat::Radiant => "bsdf",
        BrdfFormat::Klems => "xml",
    };
    // Files of the other format with this ending are replaced, and so is what belongs to them.
    let of_rgl = [SCENE.to_owned(), format!("{MIRROR}.json")];
    let is_old = |name: &str| {
        let is_table = name.starts_with("display-") && name.ends_with(&format!(".{end}"));
        is_table || end == "bsdf" && of_rgl.iter().any(|other| other == name)
    };
    output::remove(folder, is_old)?;
    let mut names = Vec::new();
    match table {
        Table::Directions(table) if format == BrdfFormat::Npz => {
            names.push(FILE.to_owned());
            write_file(&folder.join(FILE), |out| write_bsdf(out, source, table))?;
        }
        Table::Directions(table) => {
            names.extend(state_files(table, end));
            for (state, name) in names.iter().enumerate() {
                write_file(&folder.join(name), |out| write_bsdf_csv(out, table, state))?;
            }
            names.push(write_mirror(folder, table)?);
        }
        Table::Rings(table, beams) | Table::Patches(table, beams) => {
            names.extend(state_files(beams, end));
            for (state, name) in names.iter().enumerate() {
                write_file(&folder.join(name), |out| match format {
                    BrdfFormat::Klems => write_bsdf_klems(out, source, table, state),
                    _ => write_bsdf_radiant(out, source, table, state),
                })?;
            }
            names.push(write_mirror(folder, beams)?);
        }
        Table::HalfVectors(table, beams) => {
            names.extend(state_files(beams, end));
            for (state, name) in names.iter().enumerate() {
                write_file(&folder.join(name), |out| write_rgl(out, source, table, state))?;
            }
            let mirror = format!("{MIRROR}.json");
            let content = MirrorFile::new(source, said, beams, &names);
            write_file(&folder.join(&mirror), |out| write_json(out, &content))?;
            write_file(&folder.join(SCENE), |out| out.write_all(scene_script(source).as_bytes()))?;
            names.extend([mirror, SCENE.to_owned()]);
        }
    }
    Ok(names)
}

/// Writes what depends on the light alone, and returns the name of the file.
fn write_mirror(folder: &Path, beams: &BrdfTable) -> Result<String, Failure> {
    let mirror = format!("{MIRROR}.csv");
    write_file(&folder.join(&mirror), |out| write_mirror_csv(out, beams))?;
    Ok(mirror)
}

/// Returns the name of the file of each state. That of a state called `mirror` differs from that of the mirror reflection.
fn state_files(table: &BrdfTable, end: &str) -> Vec<String> {
    let mirror = MIRROR.trim_start_matches(START);
    let own = |name: &str| {
        if name.eq_ignore_ascii_case(mirror) { format!("{name}-state") } else { name.to_owned() }
    };
    let names: Vec<String> = table.states.iter().map(|state| own(&state.name)).collect();
    file_names(names.iter().map(String::as_str), START, &format!(".{end}"))
}

fn table_warnings(
    arguments: &Brdf,
    scene: &Scene,
    table: &Table,
    probes: &ViewerTable<ProbeGrid>,
) -> Result<Vec<String>, Failure> {
    let target = match scene.solver.stop {
        Stop::RelativeError { target, .. } => Some(target),
        Stop::Paths(_) | Stop::Target(_) => None,
    };
    let (exported, beams, refinable) = match table {
        Table::Directions(table) => {
            let (states, bins) = (table.states.len(), table.wavelength_nm.len());
            let phi_step =
                (!table.grid.phi_i_deg.is_empty()).then(|| 180.0 / table.grid.phi_i_deg.len() as f64);
            let smallest = smallest_step(phi_step, states, bins);
            (Exported::Directions(table), table, Refinable::Step(arguments.step_deg(), "--step ", smallest))
        }
        Table::HalfVectors(table, beams) => {
            (Exported::HalfVectors(table), beams, Refinable::Grid(grid_size(arguments)))
        }
        Table::Rings(table, beams) => (Exported::Rings(table), beams, Refinable::Rings),
        Table::Patches(table, beams) => (Exported::Patches(table), beams, Refinable::Patches),
    };
    let by_adding = papilio_display::always_by_adding(scene, "the table is");
    let mut warnings: Vec<String> = by_adding.into_iter().chain(brdf_warnings(beams, target)).collect();
    let error: Option<BetweenError> = between_error(exported, probes)?;
    warnings.extend(error.and_then(|error| between_warning(&error, refinable)));
    Ok(warnings)
}
