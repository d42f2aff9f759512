//! `papilio diffuser calibrate`.

use papilio_goniometry::calibrated;

use super::{format_of, read, spare, write};
use crate::arguments::Calibrate;
use crate::{Failure, say};

pub(crate) fn calibrate(arguments: &Calibrate) -> Result<(), Failure> {
    spare(&[&arguments.sample, &arguments.reference], &arguments.output)?;
    let format = format_of(arguments.format, &arguments.output)?;
    let (sample, reference) = (read(&arguments.sample)?, read(&arguments.reference)?);
    let calibrated = calibrated(&sample, &reference, arguments.reflectance)
        .map_err(|error| Failure::Input(error.to_string()))?;
    for found in &calibrated.calibrations {
        let what = format!("{}, {}", found.way.name(), found.channel);
        let [least, most] = found.range;
        say(&format!("{what}: {} cells multiplied by {least:.4} to {most:.4}", found.corrected));
        if found.uncovered > 0 {
            say(&format!(
                "warning: {what}: {} cells have no reference; they count as not measured",
                found.uncovered
            ));
        }
        if let Some(noise) = found.noise.filter(|noise| *noise > 0.005) {
            say(&format!("warning: {what}: the reference adds {:.1} % of noise", 100.0 * noise));
        }
        if found.rough > 0 {
            say(&format!(
                "warning: {what}: {} factors differ from their neighbours by more than 5 %",
                found.rough
            ));
        }
    }
    write(&arguments.sample, &calibrated.measurement, format, &arguments.output)
}
