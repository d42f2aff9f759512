//! What the user of a BSDF's table should know.

use papilio_display::BrdfTable;

/// A sum over a table's directions that is off by more than this share of what leaves has to be said.
pub const MOST_MISSED: f64 = 0.02;

/// Steps, degrees, of which each is a divisor of 90.
const STEPS: [f64; 12] = [4.5, 3.0, 2.5, 2.0, 1.5, 1.0, 0.9, 0.5, 0.4, 0.3, 0.2, 0.1];

/// Warnings where adding has not reached `target`, and where directions in steps of `step_deg` are too few for what the display does
/// between them; `option` is how the step is written: `--step `.
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
             be a faint one): adding's finest level is reached",
            table.discretisation_error
        ));
    }
    if let Some(step_deg) = step_deg {
        warnings.extend(missed_warning(step_deg, table.missed(), option));
    }
    warnings
}

/// The step that would do where this one does not, if one of a table does: what a sum misses falls as the square of the step.
pub fn finer_step(step_deg: f64, missed: f64) -> Option<f64> {
    if missed <= MOST_MISSED {
        return None;
    }
    let wanted = step_deg * (MOST_MISSED / missed).sqrt();
    STEPS.into_iter().find(|finer| *finer <= wanted && *finer < step_deg)
}

fn missed_warning(step_deg: f64, missed: f64, option: &str) -> Option<String> {
    let help = || match finer_step(step_deg, missed) {
        Some(finer) => format!(
            "{option}{finer} would miss about {:.1} %; with a larger spectrum.step_nm the table stays small",
            100.0 * missed * (finer / step_deg).powi(2)
        ),
        None => "a lobe so narrow needs a step below 0.1 deg: too many directions for a table".to_owned(),
    };
    (missed > MOST_MISSED).then(|| {
        format!(
            "a sum over the table's directions is {:.0} % off the light that leaves: what the display does \
             between them is finer\n  = help: {}",
            100.0 * missed,
            help()
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_that_would_do() {
        let said = |step, missed| missed_warning(step, missed, "--step ").unwrap_or_default();
        assert!(said(5.0, 0.06).contains("help: --step 2.5 would miss about 1.5 %"));
        assert!(said(1.0, 0.021).contains("--step 0.9 "));
        assert!(said(0.1, 0.5).contains("too many directions"));
        assert_eq!(said(5.0, 0.019), "");
    }
}
