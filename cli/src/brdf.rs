//! `papilio brdf`.

use std::io::Write;

use papilio_display::pixel::state_names;
use papilio_display::scene::{Scene, Stop};
use papilio_display::{BrdfGrid, BrdfTable};
use papilio_formats::{BsdfSource, write_bsdf, write_file, write_reflection};
use papilio_scenario::Scenario;

use crate::arguments::Brdf;
use crate::run::with_progress;
use crate::{Failure, interrupt, output, report, say};

const FILE: &str = "display-bsdf.npz";
const SPLIT: &str = "reflection.csv";

pub(crate) fn brdf(arguments: &Brdf) -> Result<(), Failure> {
    let resolved = Scenario::load(&arguments.scenario.file, &arguments.scenario.set)?.resolve()?;
    let grid = grid(arguments.step, &resolved.scene)?;
    let folder = arguments.scenario.out.clone().unwrap_or_else(|| arguments.scenario.default_out());
    output::check(&folder)?;
    let table = with_progress(arguments.workers.threads, |control| {
        papilio_display::brdf(&resolved.scene, grid, control)?.allowing(arguments.allow_error)
    })?;
    let table = table.ok_or(Failure::Interrupted("nothing is written"))?;
    let split = with_progress(arguments.workers.threads, |control| {
        papilio_display::reflection(&resolved.scene, &report::SPLIT_AT_DEG, control)
    })?;
    let split = split.ok_or(Failure::Interrupted("nothing is written"))?;
    let title = resolved.title.unwrap_or_else(|| report::file_title(&arguments.scenario.file));
    let mut stdout = anstream::stdout().lock();
    stdout.write_all(report::brdf(&title, &table).as_bytes())?;
    stdout.write_all(report::reflection(&split).as_bytes())?;
    stdout.flush()?;
    let source = BsdfSource { papilio: env!("CARGO_PKG_VERSION"), title: &title, hash: &resolved.hash };
    interrupt::whole(|| {
        output::make_folder(&folder)?;
        write_file(&folder.join(FILE), |out| write_bsdf(out, &source, &table))?;
        Ok::<_, Failure>(write_file(&folder.join(SPLIT), |out| write_reflection(out, &split))?)
    })?;
    output::announce(&folder, &[FILE, SPLIT].map(str::to_owned));
    let target = match resolved.scene.solver.stop {
        Stop::RelativeError { target, .. } => Some(target),
        Stop::Paths(_) | Stop::Target(_) => None,
    };
    warn(&table, arguments.step, target);
    Ok(())
}

/// Says so where adding has not reached the scenario's target, and where the table's directions are
/// too few for what the display does between them.
fn warn(table: &BrdfTable, step: f64, target: Option<f64>) {
    if let Some(target) = target.filter(|target| table.discretisation_error > *target) {
        say(&format!(
            "warning: relative error {:.2e} instead of {target:.2e} in the worst of the sampled directions (which may \
             be a faint one): adding's finest level is reached",
            table.discretisation_error
        ));
    }
    let missed = table.missed();
    if missed > MISSED {
        say(&format!(
            "warning: a sum over the table's directions is {:.0} % off the light that leaves: what the display does \
             between them is finer\n  = help: {}",
            100.0 * missed,
            finer(step, missed)
        ));
    }
}

/// What a user may overlook.
const MISSED: f64 = 0.02;

/// The step that would do: what a sum misses falls as the square of the step.
fn finer(step: f64, missed: f64) -> String {
    const STEPS: [f64; 12] = [4.5, 3.0, 2.5, 2.0, 1.5, 1.0, 0.9, 0.5, 0.4, 0.3, 0.2, 0.1];
    let wanted = step * (MISSED / missed).sqrt();
    match STEPS.into_iter().find(|finer| *finer <= wanted) {
        Some(finer) => format!(
            "--step {finer} would miss about {:.1} %; with a larger spectrum.step_nm the table stays small",
            100.0 * missed * (finer / step).powi(2)
        ),
        None => "a lobe so narrow needs a step below .1 deg: too many directions for a table".to_owned(),
    }
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

#[cfg(test)]
mod tests {
    #[test]
    fn a_step_that_would_do() {
        assert!(super::finer(5.0, 0.06).starts_with("--step 2.5 would miss about 1.5 %"));
        assert!(super::finer(1.0, 0.021).starts_with("--step 0.9 "));
        assert!(super::finer(0.1, 0.5).contains("too many directions"));
    }
}
