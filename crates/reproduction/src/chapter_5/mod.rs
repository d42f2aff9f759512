//! Chapter 5: the appearance of displays.

mod colour;
mod lighting;
mod panels;
mod readability;

use crate::displays::{Bench, ReproductionError};
use crate::report::Section;

pub(crate) fn sections(bench: &Bench<'_>) -> Result<Vec<Section>, ReproductionError> {
    Ok(vec![
        colour::observer()?,
        colour::table_5_1(bench)?,
        panels::gamuts(bench)?,
        panels::spectra(bench)?,
        panels::gamut_against_angle(bench)?,
        panels::soap_film(),
        panels::shift_at_20(bench)?,
        panels::peak_shift(bench)?,
        panels::table_5_2(bench)?,
        lighting::distributions(),
        lighting::front_reflection(bench)?,
        lighting::lobes(bench)?,
        lighting::haze(bench)?,
        lighting::front_light(bench)?,
        readability::table_5_3(bench)?,
    ])
}
