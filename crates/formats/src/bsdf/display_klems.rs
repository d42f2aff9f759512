//! Writer of the display's BSDF as Klems matrices: X, Y and Z of one state in D65, averaged over the patches of the full basis.

use std::io::{self, Write};

use papilio_display::BrdfTable;
use papilio_goniometry::{
    Channel, Geometry, MeasuredPart, Measurement, Provenance, ScatterMode, SphericalGrid,
};

use super::display::BsdfSource;
use super::tristimulus::weights;
use super::write::{BsdfFormat, write_measurement};

/// Writes the scattered part of one state, number `state`, for light with the spectrum of D65.
///
/// # Errors
/// Those of `out`, if the lengths of the table's arrays do not match its grid, or its wavelengths are not equally spaced.
pub fn write_bsdf_klems(
    out: impl Write,
    source: &BsdfSource<'_>,
    table: &BrdfTable,
    state: usize,
) -> io::Result<()> {
    let unsound = |message: &str| io::Error::new(io::ErrorKind::InvalidInput, message.to_owned());
    let (grid, bins) = (&table.grid, table.wavelength_nm.len());
    let found = table.states.get(state).filter(|found| found.brdf.len() == grid.pairs() * bins);
    let found = found.ok_or_else(|| unsound("the BSDF does not match its directions"))?;
    let weights = weights(&table.wavelength_nm).map_err(|message| unsound(&message))?;
    let mut values = Vec::with_capacity(3 * grid.pairs());
    for weights in &weights {
        let sum = |spectrum: &[f32]| spectrum.iter().zip(weights).map(|(f, w)| f64::from(*f) * w).sum();
        values.extend(found.brdf.chunks_exact(bins.max(1)).map(sum).map(|value: f64| value.max(0.0)));
    }
    let part = MeasuredPart {
        way: ScatterMode::FrontReflection,
        channels: vec![Channel::X, Channel::Y, Channel::Z],
        geometry: Geometry::Spherical(SphericalGrid {
            theta_i_deg: grid.theta_i_deg.clone(),
            phi_i_deg: vec![0.0],
            theta_o_deg: grid.theta_o_deg.clone(),
            phi_o_deg: grid.dphi_deg.clone(),
        }),
        values,
        tis: Vec::new(),
    };
    let provenance = Provenance {
        format: "papilio".to_owned(),
        sample: format!("{} ({})", source.title, found.name),
        source: "computed".to_owned(),
        remarks: Vec::new(),
    };
    let measurement = Measurement { provenance, media: [1.0, 1.0], parts: vec![part] };
    // What is lost is the same for all displays; the documentation of the format states it.
    let written = write_measurement(out, BsdfFormat::Klems, &measurement);
    written.map(|_| ()).map_err(|error| unsound(&error.to_string()))
}
