//! Warnings about BSDF tables.

use papilio_display::{BrdfTable, HalfVectorGrid};
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
    /// Directions in steps, with the name of the option: `--step `.
    Step(f64, &'a str),
    /// Half vectors, with their number along each axis.
    Grid(usize),
    /// Rings about the mirror direction.
    Rings,
    /// Patches of the Klems basis.
    Patches,
}

/// Warns if what readers interpolate between the nodes of an export differs by more than [`MOST_MISSED`] from the display.
///
/// The difference is proportional to the square of the distance between nodes.
pub fn between_warning(error: &BetweenError, of: Refinable<'_>) -> Option<String> {
    let BetweenError { relative, state, theta_i_deg, viewer } = error;
    let help = || {
        match of {
        Refinable::Step(step, option) => match finer_step(step, *relative) {
            Some(finer) => format!(
                "{option}{finer} reduces this to about {:.1} %; --format rgl and radiant have rings about the mirror direction, which \
                 follow a lobe with fewer numbers",
                100.0 * relative * (finer / step).powi(2)
            ),
            None => "the lobe is too narrow for equal steps; --format rgl and radiant follow it".to_owned(),
        },
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
             relative to its value or to 1 % of the largest one for this light): state {state}, light from {theta_i_deg:.1} deg, viewer \
             at {:.1} deg, azimuth {:.0} deg from the light\n  = help: {}",
            per_cent(*relative),
            viewer.theta_o_deg,
            viewer.dphi_deg,
            help()
        )
    })
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
        let error =
            |relative| BetweenError { relative, state: "white".to_owned(), theta_i_deg: 62.5, viewer };
        let warning = |relative, of| between_warning(&error(relative), of).unwrap_or_default();
        assert_eq!(warning(0.019, Refinable::Grid(64)), "");
        let text = warning(0.08, Refinable::Grid(64));
        assert!(text.contains("up to 8.0 %") && text.contains("state white, light from 62.5 deg"), "{text}");
        assert!(text.contains("--grid 128"), "{text}");
        assert!(
            warning(0.08, Refinable::Step(5.0, "--step ")).contains("--step 2.5 reduces this to about 2.0 %")
        );
        assert!(warning(9.0, Refinable::Grid(256)).contains("a smaller --step"));
        assert!(warning(3.0, Refinable::Patches).contains("300 %"));
    }

    #[test]
    fn finer_step_is_a_divisor_that_is_sufficient() {
        assert_eq!(finer_step(5.0, 0.06), Some(2.5));
        assert_eq!(finer_step(1.0, 0.021), Some(0.9));
        assert_eq!(finer_step(0.1, 0.5), None);
        assert_eq!(finer_step(5.0, 0.019), None);
    }
}
