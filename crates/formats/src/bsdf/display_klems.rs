//! Writer of the display's BSDF as Klems matrices: X, Y and Z of one state in D65, averaged over the patches
//! of the full basis, both of the light and of the viewer.

use std::io::{self, Write};

use papilio_display::{LobeWidths, RingGrid, RingTable};
use papilio_goniometry::{
    Geometry, KLEMS_FULL, MeasuredPart, Measurement, Provenance, ring_patch_lights, ring_patch_means,
};

use super::display::BsdfSource;
use super::display_radiant::{rings_part, unsound};
use super::write::{BsdfFormat, write_measurement};

/// Returns the directions from which [`write_bsdf_klems`] averages, for a display with a lobe of these
/// widths: those of the tabular BSDF, with every second azimuth, because a lobe hardly depends on it.
/// `phi_step_deg`: the step of the azimuths of the light, if the display depends on them.
pub fn klems_rings(widths: &LobeWidths, phi_step_deg: Option<f64>) -> RingGrid {
    let rings = RingGrid::about_lights(ring_patch_lights(&KLEMS_FULL), widths);
    if let Some(step) = phi_step_deg {
        return rings.around(step);
    }
    RingGrid { azimuths_deg: rings.azimuths_deg.iter().step_by(2).copied().collect(), ..rings }
}

/// Returns about how many values are computed at the directions of [`klems_rings`].
pub fn klems_numbers(phi_step_deg: Option<f64>, states: usize, wavelengths: usize) -> usize {
    let inclinations = ring_patch_lights(&KLEMS_FULL).len();
    let numbers = RingGrid::numbers_of(inclinations, phi_step_deg, states, wavelengths);
    if phi_step_deg.is_some() { numbers } else { numbers / 2 }
}

/// Writes the scattered part of one state, number `state`, for light with the spectrum of D65; the table has
/// the directions of [`klems_rings`].
///
/// # Errors
/// Those of `out`, if the lengths of the table's arrays do not match its grid, or its wavelengths are not
/// equally spaced.
pub fn write_bsdf_klems(
    out: impl Write,
    source: &BsdfSource<'_>,
    table: &RingTable,
    state: usize,
) -> io::Result<()> {
    let part = patches_part(table, state)?;
    let name = table.states.get(state).map_or("", |found| found.name.as_str());
    let provenance = Provenance {
        format: "papilio".to_owned(),
        sample: format!("{} ({name})", source.title),
        source: "computed".to_owned(),
        remarks: Vec::new(),
    };
    let measurement = Measurement { provenance, media: [1.0, 1.0], parts: vec![part] };
    // What is lost is the same for all displays; the documentation of the format states it.
    let written = write_measurement(out, BsdfFormat::Klems, &measurement);
    written.map(|_| ()).map_err(|error| unsound(&error.to_string()))
}

/// Returns the matrices of a state as the file holds them: X, Y and Z in D65, of which Y of a perfect white
/// is 1/pi.
pub(super) fn patches_part(table: &RingTable, state: usize) -> io::Result<MeasuredPart> {
    let (rings, whites) = rings_part(table, state)?;
    let Geometry::Specular(grid) = &rings.geometry else { return Err(unsound("the BSDF is not on rings")) };
    let lights = grid.rotations_deg.len() * grid.incidences_deg.len();
    let channel = |k: usize| (rings.channel(k), &rings.tis[k * lights..][..lights]);
    let channels: Vec<_> = (0..whites.len()).map(channel).collect();
    let means = ring_patch_means(grid, &channels, &KLEMS_FULL)
        .ok_or_else(|| unsound("the BSDF is not on the directions of the patches"))?;
    let values =
        means.iter().zip(&whites).flat_map(|(means, white)| means.iter().map(move |mean| mean * white));
    let values: Vec<f64> = values.collect();
    let geometry = Geometry::Patches { incoming: KLEMS_FULL.to_vec(), outgoing: KLEMS_FULL.to_vec() };
    Ok(MeasuredPart { geometry, values, tis: Vec::new(), ..rings })
}
