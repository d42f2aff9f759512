//! `papilio brdf`: the BRDF of the whole display.

use std::io::Write;

use papilio_design::output::brdf_warnings;
use papilio_display::BrdfGrid;
use papilio_display::pixel::state_names;
use papilio_display::scene::{Scene, Stop};
use papilio_formats::{BsdfSource, write_bsdf, write_file, write_reflection};
use papilio_scenario::Scenario;

use crate::arguments::Brdf;
use crate::run::with_progress;
use crate::{Failure, folder, input, interrupt, output, print_message, print_notes, report};

const FILE: &str = "display-bsdf.npz";
const SPLIT: &str = "reflection.csv";

pub(crate) fn brdf(arguments: &Brdf) -> Result<(), Failure> {
    let resolved =
        input::scenario::<Scenario>(&arguments.scenario.file, &arguments.scenario.set)?.resolve()?;
    let grid = grid(arguments.step, &resolved.scene)?;
    let folder = folder::choose(&arguments.scenario, &resolved.hash)?;
    let table = with_progress(&resolved, arguments.workers.threads, |control| {
        papilio_display::brdf(&resolved.scene, grid, control)?.allowing(arguments.allow_error)
    })?;
    let table = table.ok_or(Failure::Interrupted("no file was written"))?;
    let split = with_progress(&resolved, arguments.workers.threads, |control| {
        papilio_display::reflection(&resolved.scene, &report::SPLIT_AT_DEG, control)
    })?;
    let split = split.ok_or(Failure::Interrupted("no file was written"))?;
    let title = resolved.title.unwrap_or_else(|| report::file_title(&arguments.scenario.file));
    let mut stdout = crate::terminal::output(false);
    stdout.write_all(report::brdf(&title, &table).as_bytes())?;
    stdout.write_all(report::reflection(&split).as_bytes())?;
    stdout.flush()?;
    let source = BsdfSource { papilio: env!("CARGO_PKG_VERSION"), title: &title, hash: &resolved.hash };
    interrupt::uninterrupted(|| {
        output::make_folder(&folder)?;
        write_file(&folder.join(FILE), |out| write_bsdf(out, &source, &table))?;
        write_file(&folder.join(SPLIT), |out| write_reflection(out, &split))?;
        folder::write_about(&folder, &title, &resolved.hash)
    })?;
    folder.print_written(&[FILE, SPLIT, folder::ABOUT].map(str::to_owned));
    let target = match resolved.scene.solver.stop {
        Stop::RelativeError { target, .. } => Some(target),
        Stop::Paths(_) | Stop::Target(_) => None,
    };
    print_notes(&resolved.notes);
    let table_warnings = brdf_warnings(&table, target, Some(arguments.step), "--step ");
    resolved
        .warnings
        .iter()
        .chain(&table_warnings)
        .for_each(|warning| print_message(&format!("warning: {warning}")));
    Ok(())
}

/// Directions of the table. Fails if the table would be too large.
fn grid(step: f64, scene: &Scene) -> Result<BrdfGrid, Failure> {
    let steps = (90.0 / step).round() as usize;
    let per_direction = state_names(&scene.display.pixel).len() * scene.grid.len();
    let numbers = (steps * steps * (2 * steps + 1)).saturating_mul(per_direction);
    if numbers > BrdfGrid::MOST_NUMBERS {
        return Err(Failure::Input(format!(
            "the table would have {numbers} numbers (states x theta_i x theta_o x dphi x wavelengths); expected at most {}\n  \
             = help: use a larger --step, a larger spectrum.step_nm or fewer states",
            BrdfGrid::MOST_NUMBERS
        )));
    }
    Ok(BrdfGrid::even(step))
}
