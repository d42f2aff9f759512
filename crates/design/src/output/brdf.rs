//! Warnings about BSDF tables.

use papilio_display::BrdfTable;

/// Largest accepted deviation of the sum over a table's directions, as a fraction of the light that leaves
/// the display.
pub const MOST_MISSED: f64 = 0.02;

/// Steps in degrees; each divides 90.
const STEPS: [f64; 12] = [4.5, 3.0, 2.5, 2.0, 1.5, 1.0, 0.9, 0.5, 0.4, 0.3, 0.2, 0.1];

/// Warns if adding has not reached the relative error `target`, or if directions in steps of `step_deg` are
/// too coarse for the BSDF.
///
/// `option` is the name of the step in the message, such as `--step `.
pub fn brdf_warnings(
    table: &BrdfTable,
    target: Option<f64>,
    step_deg: Option<f64>,
    option: &str,
) -> Vec<String> {
    let mut warnings = Vec::new();
    if let Some(target) = target.filter(|target| table.discretisation_error > *target) {
        warnings.push(format!(
            "relative error {:.2e} instead of {target:.2e} in the worst of the sampled directions (which may \
             have a small value): adding's finest level is reached",
            table.discretisation_error
        ));
    }
    if let Some(step_deg) = step_deg {
        warnings.extend(missed_warning(step_deg, table.missed(), option));
    }
    warnings
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

/// Returns a warning where the rings of a tabular BSDF are too coarse for the lobe; `missed` is from
/// [`RingTable::missed`](papilio_display::RingTable::missed).
pub fn rings_warning(missed: f64) -> Option<String> {
    (missed > MOST_MISSED).then(|| {
        format!(
            "the sum over the directions of the table and the light that leaves differ by {:.1} %: the lobe is too narrow for rings \
             in steps of 0.5 deg and 5 deg of azimuth; --format rgl follows narrower lobes",
            100.0 * missed
        )
    })
}

fn missed_warning(step_deg: f64, missed: f64, option: &str) -> Option<String> {
    let help = || match finer_step(step_deg, missed) {
        Some(finer) => format!(
            "{option}{finer} reduces the deviation to about {:.1} %; a larger spectrum.step_nm keeps the table \
             small",
            100.0 * missed * (finer / step_deg).powi(2)
        ),
        None => {
            let reason = "the lobe is so narrow that it needs a step below 0.1 deg";
            format!("{reason}, which is too many directions for a table")
        }
    };
    (missed > MOST_MISSED).then(|| {
        format!(
            "the sum over the table's directions differs by {:.0} % from the light that leaves the display: \
             the directions are too coarse for the BSDF\n  = help: {}",
            100.0 * missed,
            help()
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coarse_step_warning_names_a_sufficient_step() {
        let warning = |step, missed| missed_warning(step, missed, "--step ").unwrap_or_default();
        assert!(warning(5.0, 0.06).contains("help: --step 2.5 reduces the deviation to about 1.5 %"));
        assert!(warning(1.0, 0.021).contains("--step 0.9 "));
        assert!(warning(0.1, 0.5).contains("too many directions"));
        assert_eq!(warning(5.0, 0.019), "");
    }
}
