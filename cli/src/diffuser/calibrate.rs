//! `papilio diffuser calibrate`: corrects a sample with a known white.

use papilio_goniometry::calibrated;

use super::{output_format, read, refuse_overwriting, write};
use crate::arguments::Calibrate;
use crate::{Failure, print_message};

/// A white that scatters into a lobe may exceed a perfect diffuser, but not by much.
const MOST_REFLECTANCE: f64 = 1.5;

pub(crate) fn calibrate(arguments: &Calibrate) -> Result<(), Failure> {
    if !(0.0..=MOST_REFLECTANCE).contains(&arguments.reflectance) || arguments.reflectance == 0.0 {
        return Err(Failure::Input(format!(
            "--reflectance {} is out of range\n  = note: expected a number above 0, at most {MOST_REFLECTANCE}\n  = help: this is a \
             fraction relative to 1, not per cent",
            arguments.reflectance
        )));
    }
    refuse_overwriting(&[&arguments.sample, &arguments.reference], &arguments.output)?;
    let format = output_format(arguments.format, &arguments.output)?;
    let (sample, reference) = (read(&arguments.sample, None)?, read(&arguments.reference, None)?);
    let calibrated = calibrated(&sample, &reference, arguments.reflectance)
        .map_err(|error| Failure::Input(error.to_string()))?;
    for calibration in &calibrated.calibrations {
        let part = format!("{}, {}", calibration.way.name(), calibration.channel);
        let [lowest, highest] = calibration.range;
        print_message(&format!(
            "{part}: {} cells multiplied by {lowest:.4} to {highest:.4}",
            calibration.corrected
        ));
        if calibration.has_transmission_as_white() {
            print_message(&format!(
                "warning: {part}: the reference is a {}, and not the reflection of a white",
                calibration.reference.name()
            ));
        }
        if calibration.uncovered > 0 {
            print_message(&format!(
                "warning: {part}: {} cells have no reference value; they count as not measured",
                calibration.uncovered
            ));
        }
        if let Some(noise) = calibration.noise.filter(|noise| *noise > 0.005) {
            print_message(&format!("warning: {part}: the reference adds {:.1} % of noise", 100.0 * noise));
        }
        if calibration.rough > 0 {
            print_message(&format!(
                "warning: {part}: {} factors differ by more than 5 % from those of neighbouring cells",
                calibration.rough
            ));
        }
    }
    write(&arguments.sample, &calibrated.measurement, format, &arguments.output)
}
