//! Warnings about BSDF tables.

use papilio_display::{BrdfGrid, BrdfTable, HalfVectorGrid};
use papilio_formats::BetweenError;

/// Largest accepted deviation of the sum over a table's directions, as a fraction of the light that leaves
/// the display.
pub const MOST_MISSED: f64 = 0.02;

/// Steps in degrees; each divides 90.
const STEPS: [f64; 12] = [4.5, 3.0, 2.5, 2.0, 1.5, 1.0, 0.9, 0.5, 0.4, 0.3, 0.2, 0.1];

/// Warns if adding has not reached the relative error `target`.
pub fn brdf_warnings(table: &BrdfTable, target: Option<f64>) -> Vec<String> {
    let missed = target.filter(|target| table.discretisation_error > *target);
    let warning = missed.map(|target| {
        format!(
            "relative error {:.2e} instead of {target:.2e} in the worst of the sampled directions (which may \
             have a small value): adding's finest level is reached",
            table.discretisation_error
        )
    });
    warning.into_iter().collect()
}

/// Returns a sufficient step where `step_deg` is too large, if there is one for a table.
///
/// The deviation of a sum is proportional to the square of the step.
pub fn finer_step(step_deg: f64, missed: f64) -> Option<f64> {
    if missed <= MOST_MISSED {
        return None;
    }
    let wanted = step_deg * (MOST_MISSED / missed).sqrt();
    STEPS.into_iter().find(|finer| *finer <= wanted && *finer < step_deg)
}

/// Export of a BSDF with what the user can refine in it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Refinable<'a> {
    /// Directions in steps of so many degrees, with the name of the option (`--step `) and the smallest step
    /// of which a table is permitted ([`smallest_step`]).
    Step(f64, &'a str, Option<f64>),
    /// Half vectors, with their number along each axis.
    Grid(usize),
    /// Rings about the mirror direction.
    Rings,
    /// Patches of the Klems basis.
    Patches,
}

/// Warns if what readers interpolate between the nodes of an export differs by more than [`MOST_MISSED`] from
/// the display.
///
/// The difference is proportional to the square of the distance between nodes.
pub fn between_warning(error: &BetweenError, of: Refinable<'_>) -> Option<String> {
    let BetweenError { relative, state, theta_i_deg, phi_i_deg, viewer } = error;
    let azimuth = phi_i_deg.map_or_else(String::new, |phi| format!(", azimuth {phi:.1} deg"));
    let turned =
        if phi_i_deg.is_some() { "; a smaller --phi-step has more azimuths of the light" } else { "" };
    let help = || {
        match of {
        Refinable::Step(step, option, smallest) => finer(step, option, smallest, *relative),
        Refinable::Grid(size) if size < HalfVectorGrid::LARGEST => {
            let wanted = (size as f64 * (relative / MOST_MISSED).sqrt() / 32.0).ceil() as usize * 32;
            let finer = wanted.clamp(size + 1, HalfVectorGrid::LARGEST);
            format!("--grid {finer} and, for oblique light, a smaller --step reduce this")
        }
        Refinable::Grid(_) | Refinable::Rings => "a smaller --step has more directions of the light".to_owned(),
        Refinable::Patches => {
            "the patches of the Klems basis are 5 to 15 deg wide, and readers take their means; --format rgl and radiant follow a lobe"
                .to_owned()
        }
    }
    };
    (*relative > MOST_MISSED).then(|| {
        format!(
            "between the directions of the file, what its readers interpolate differs by up to {} % from the display (luminous BRDF, \
             relative to its value or to 1 % of the largest one for this light): state {state}, light from {theta_i_deg:.1} deg{azimuth}, viewer \
             at {:.1} deg, azimuth {:.0} deg from the light\n  = help: {}{turned}",
            per_cent(*relative),
            viewer.theta_o_deg,
            viewer.dphi_deg,
            help()
        )
    })
}

/// Returns which step reduces a deviation, as far as a table of it is permitted, and what else does.
fn finer(step: f64, option: &str, smallest: Option<f64>, relative: f64) -> String {
    let reduces = |finer: f64| {
        format!("{option}{finer} reduces this to about {:.1} %", 100.0 * relative * (finer / step).powi(2))
    };
    let rings = "--format rgl and radiant have rings about the mirror direction, which follow a lobe with fewer numbers";
    let smallest = smallest.filter(|smallest| *smallest < step);
    match (finer_step(step, relative), smallest) {
        (None, _) => "the lobe is too narrow for equal steps; --format rgl and radiant follow it".to_owned(),
        (Some(finer), Some(smallest)) if finer >= smallest => format!("{}; {rings}", reduces(finer)),
        (Some(_), Some(smallest)) => format!(
            "{}, and is the smallest step of a table with so many states and wavelengths: fewer states or a larger spectrum.step_nm \
             permit a smaller one; {rings}",
            reduces(smallest)
        ),
        (Some(_), None) => format!(
            "{rings}; a smaller step would have more numbers than a table may have, unless it has fewer states or wavelengths \
             (spectrum.step_nm)"
        ),
    }
}

/// Returns the number of values of a table with steps of `step_deg` degrees, `usize::MAX` if it is too large; `phi_step_deg`: the step of the
/// azimuths of the light, if the display depends on them.
pub fn table_numbers(step_deg: f64, phi_step_deg: Option<f64>, states: usize, wavelengths: usize) -> usize {
    let steps = (90.0 / step_deg).round() as usize;
    let azimuths = match phi_step_deg {
        Some(step) => steps.saturating_mul(4).saturating_mul((180.0 / step).round() as usize),
        None => steps.saturating_mul(2).saturating_add(1),
    };
    [steps, azimuths, states, wavelengths].into_iter().fold(steps, usize::saturating_mul)
}

/// Returns the smallest of the usual steps, degrees, of which a table is permitted.
pub fn smallest_step(phi_step_deg: Option<f64>, states: usize, wavelengths: usize) -> Option<f64> {
    let is_permitted =
        |step: &f64| table_numbers(*step, phi_step_deg, states, wavelengths) <= BrdfGrid::MOST_NUMBERS;
    [15.0, 10.0, 9.0, 5.0].into_iter().chain(STEPS).filter(is_permitted).min_by(f64::total_cmp)
}

/// Returns a fraction in per cent, with two digits below 10.
fn per_cent(fraction: f64) -> String {
    let per_cent = 100.0 * fraction;
    if per_cent < 10.0 { format!("{per_cent:.1}") } else { format!("{per_cent:.0}") }
}

#[cfg(test)]
mod tests {
    use papilio_display::Viewer;

    use super::*;

    #[test]
    fn error_between_nodes_names_what_reduces_it() {
        let viewer = Viewer { cos_theta_o: 0.5, theta_o_deg: 60.0, dphi_deg: 170.0 };
        let error = |relative| BetweenError {
            relative,
            state: "white".to_owned(),
            theta_i_deg: 62.5,
            phi_i_deg: None,
            viewer,
        };
        let warning = |relative, of| between_warning(&error(relative), of).unwrap_or_default();
        assert_eq!(warning(0.019, Refinable::Grid(64)), "");
        let text = warning(0.08, Refinable::Grid(64));
        assert!(text.contains("up to 8.0 %") && text.contains("state white, light from 62.5 deg"), "{text}");
        assert!(text.contains("--grid 128"), "{text}");
        let step = |smallest| warning(0.08, Refinable::Step(5.0, "--step ", smallest));
        assert!(step(Some(2.5)).contains("--step 2.5 reduces this to about 2.0 %"));
        let larger = step(Some(3.0));
        assert!(
            larger.contains("--step 3 reduces this to about 2.9 %, and is the smallest step"),
            "{larger}"
        );
        assert!(!step(None).contains("--step") && step(None).contains("--format rgl"), "{}", step(None));
        assert!(warning(9.0, Refinable::Grid(256)).contains("a smaller --step"));
        assert!(warning(3.0, Refinable::Patches).contains("300 %"));
    }

    /// Eight states with 81 wavelengths: 90 x 90 x 181 directions at 1 deg, 45 x 45 x 91 at 2 deg and 36 x 36
    /// x 73 at 2.5 deg.
    #[test]
    fn smallest_step_is_that_of_a_permitted_table() {
        let numbers = |step| table_numbers(step, None, 8, 81);
        assert_eq!((numbers(1.0), numbers(2.0), numbers(2.5)), (950_032_800, 119_410_200, 61_305_984));
        let smallest = |states, bins| smallest_step(None, states, bins);
        assert_eq!((smallest(8, 81), smallest(1, 1), smallest(8, usize::MAX)), (Some(2.5), Some(0.3), None));
        assert_eq!(numbers(1e-300), usize::MAX);
        // With 12 azimuths of the light and 72 of the viewer.
        assert_eq!(table_numbers(5.0, Some(15.0), 2, 81), 2 * 81 * 18 * 18 * 12 * 72);
        assert_eq!(smallest_step(Some(15.0), 8, 81), Some(9.0));
    }

    #[test]
    fn finer_step_is_a_divisor_that_is_sufficient() {
        assert_eq!(finer_step(5.0, 0.06), Some(2.5));
        assert_eq!(finer_step(1.0, 0.021), Some(0.9));
        assert_eq!(finer_step(0.1, 0.5), None);
        assert_eq!(finer_step(5.0, 0.019), None);
    }
}
