//! `papilio brdf`.

use std::io::Write;

use papilio_display::BrdfGrid;
use papilio_display::pixel::state_names;
use papilio_display::scene::{Scene, Stop};
use papilio_findings::brdf_warnings;
use papilio_formats::{BsdfSource, write_bsdf, write_file, write_reflection};
use papilio_scenario::Scenario;

use crate::arguments::Brdf;
use crate::run::with_progress;
use crate::{Failure, folder, interrupt, output, report, say};

const FILE: &str = "display-bsdf.npz";
const SPLIT: &str = "reflection.csv";

pub(crate) fn brdf(arguments: &Brdf) -> Result<(), Failure> {
    let resolved = Scenario::load(&arguments.scenario.file, &arguments.scenario.set)?.resolve()?;
    let grid = grid(arguments.step, &resolved.scene)?;
    let folder = folder::choose(&arguments.scenario, &resolved.hash)?;
    let table = with_progress(&resolved, arguments.workers.threads, |control| {
        papilio_display::brdf(&resolved.scene, grid, control)?.allowing(arguments.allow_error)
    })?;
    let table = table.ok_or(Failure::Interrupted("nothing is written"))?;
    let split = with_progress(&resolved, arguments.workers.threads, |control| {
        papilio_display::reflection(&resolved.scene, &report::SPLIT_AT_DEG, control)
    })?;
    let split = split.ok_or(Failure::Interrupted("nothing is written"))?;
    let title = resolved.title.unwrap_or_else(|| report::file_title(&arguments.scenario.file));
    let mut stdout = crate::terminal::stdout();
    stdout.write_all(report::brdf(&title, &table).as_bytes())?;
    stdout.write_all(report::reflection(&split).as_bytes())?;
    stdout.flush()?;
    let source = BsdfSource { papilio: env!("CARGO_PKG_VERSION"), title: &title, hash: &resolved.hash };
    interrupt::whole(|| {
        output::make_folder(&folder)?;
        write_file(&folder.join(FILE), |out| write_bsdf(out, &source, &table))?;
        write_file(&folder.join(SPLIT), |out| write_reflection(out, &split))?;
        folder::sign(&folder, &title, &resolved.hash)
    })?;
    output::announce(&folder, &[FILE, SPLIT, folder::ABOUT].map(str::to_owned));
    let target = match resolved.scene.solver.stop {
        Stop::RelativeError { target, .. } => Some(target),
        Stop::Paths(_) | Stop::Target(_) => None,
    };
    let of_table = brdf_warnings(&table, target, Some(arguments.step), "--step ");
    resolved.warnings.iter().chain(&of_table).for_each(|warning| say(&format!("warning: {warning}")));
    Ok(())
}

/// The directions, if the table is of a size that can be held.
fn grid(step: f64, scene: &Scene) -> Result<BrdfGrid, Failure> {
    let steps = (90.0 / step).round() as usize;
    let others = state_names(&scene.display.pixel).len() * scene.grid.len();
    let numbers = (steps * steps * (2 * steps + 1)).saturating_mul(others);
    if numbers > BrdfGrid::MOST_NUMBERS {
        return Err(Failure::Input(format!(
            "the table would have {numbers} numbers (states x theta_i x theta_o x dphi x wavelengths)\n  = help: take a \
             larger --step, a larger spectrum.step_nm or fewer states, at most {} numbers",
            BrdfGrid::MOST_NUMBERS
        )));
    }
    Ok(BrdfGrid::even(step))
}
