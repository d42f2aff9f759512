//! Writer of the display's BSDF as a tabular BSDF of Radiant and Zemax: X, Y and Z of one state in D65, on
//! rings about the mirror direction. A display that depends on azimuth is rotated: light comes from azimuth `180 deg - rotation`.
//!
//! X, Y and Z are relative to those of a perfect white, as an imaging sphere measures them that is calibrated
//! with a white reference: a perfect white has 1/pi and a TIS of 1 in each of them. The mirror part is in
//! neither the values nor the TIS.

use std::io::{self, Write};

use papilio_display::{RingTable, ViewerGrid};
use papilio_goniometry::{
    Channel, Geometry, MeasuredPart, Measurement, Provenance, ScatterMode, SpecularGrid, Symmetry,
};

use super::display::BsdfSource;
use super::tristimulus::weights;
use super::write::{BsdfFormat, write_measurement};

/// Writes the scattered part of one state, number `state`, for light with the spectrum of D65.
///
/// # Errors
/// Those of `out`, if the lengths of the table's arrays do not match its grid, or its wavelengths are not
/// equally spaced.
pub fn write_bsdf_radiant(
    out: impl Write,
    source: &BsdfSource<'_>,
    table: &RingTable,
    state: usize,
) -> io::Result<()> {
    let (part, _) = rings_part(table, state)?;
    let name = table.states.get(state).map_or("", |found| found.name.as_str());
    let measurement = Measurement {
        provenance: Provenance {
            format: "papilio".to_owned(),
            sample: format!("{} ({name})", source.title),
            // The only word that the description of the format knows.
            source: "Measured".to_owned(),
            remarks: vec![
                format!("computed, not measured: papilio {}, scenario {}", source.papilio, source.hash),
                "X, Y, Z in D65, relative to those of a perfect white, which has 1/pi; without the mirror part".to_owned(),
            ],
        },
        media: [1.0, 1.0],
        parts: vec![part],
    };
    let written = write_measurement(out, BsdfFormat::Radiant, &measurement);
    written.map(|_| ()).map_err(|error| unsound(&error.to_string()))
}

/// Returns the values and the TIS of a state as the format holds them, and X, Y and Z of a perfect white,
/// times pi.
pub(super) fn rings_part(table: &RingTable, state: usize) -> io::Result<(MeasuredPart, Vec<f64>)> {
    let (grid, bins) = (&table.grid, table.wavelength_nm.len().max(1));
    let lights: Vec<(usize, Vec<Option<usize>>)> = (0..grid.lights_deg().len())
        .map(|light| {
            let (viewers, numbers) = grid.viewers(light);
            (viewers.len(), numbers)
        })
        .collect();
    let viewers: usize = lights.iter().map(|(count, _)| count).sum();
    let found = table.states.get(state).filter(|found| {
        let beams = [found.specular.len(), found.directional_hemispherical.len()];
        found.brdf.len() == viewers * bins && beams == [lights.len() * bins; 2]
    });
    let found = found.ok_or_else(|| unsound("the BSDF does not match its directions"))?;
    let rotations = rotations(&grid.phi_i_deg);
    // The numbers of the lights in the order of the file, with the numbers of their first viewers.
    let azimuths = grid.phi_i_deg.len().max(1);
    let order: Vec<usize> = rotations
        .iter()
        .flat_map(|(_, azimuth)| (0..grid.theta_i_deg.len()).map(move |theta| theta * azimuths + azimuth))
        .collect();
    let firsts: Vec<usize> = lights
        .iter()
        .scan(0, |next, (count, _)| {
            *next += count;
            Some(*next - count)
        })
        .collect();
    let mut values = Vec::with_capacity(3 * grid.cells());
    let mut tis = Vec::with_capacity(3 * order.len());
    let mut whites = Vec::new();
    for weights in weights(&table.wavelength_nm).map_err(|message| unsound(&message))? {
        let white: f64 = weights.iter().sum();
        whites.push(white);
        let relative = |spectrum: &mut dyn Iterator<Item = f64>| -> f64 {
            // Slightly negative values are discretisation errors.
            (spectrum.zip(&weights).map(|(value, weight)| value * weight).sum::<f64>() / white).max(0.0)
        };
        for light in &order {
            let (count, numbers) = &lights[*light];
            let spectra = &found.brdf[firsts[*light] * bins..][..count * bins];
            let of_viewers: Vec<f64> = spectra
                .chunks_exact(bins)
                .map(|spectrum| relative(&mut spectrum.iter().map(|f| f64::from(*f))))
                .collect();
            values.extend(numbers.iter().map(|number| number.map_or(0.0, |number| of_viewers[number])));
        }
        tis.extend(order.iter().map(|light| {
            let [leaving, mirror] =
                [&found.directional_hemispherical, &found.specular].map(|all| &all[light * bins..][..bins]);
            relative(&mut leaving.iter().zip(mirror).map(|(leaving, mirror)| leaving - mirror))
        }));
    }
    let part = MeasuredPart {
        way: ScatterMode::FrontReflection,
        channels: vec![Channel::X, Channel::Y, Channel::Z],
        geometry: Geometry::Specular(SpecularGrid {
            rotations_deg: rotations.iter().map(|(rotation_deg, _)| *rotation_deg).collect(),
            incidences_deg: grid.theta_i_deg.clone(),
            azimuths_deg: grid.azimuths_deg.clone(),
            radials_deg: grid.radials_deg.clone(),
            symmetry: if grid.phi_i_deg.is_empty() { Symmetry::Plane } else { Symmetry::None },
        }),
        values,
        tis,
    };
    Ok((part, whites))
}

/// Returns the rotations of the display over a whole turn, degrees, ascending, and for each the number of the azimuth from which the light
/// comes then, or from half a turn beside it.
fn rotations(phi_i_deg: &[f64]) -> Vec<(f64, usize)> {
    if phi_i_deg.is_empty() {
        return vec![(0.0, 0)];
    }
    let both = |(number, phi): (usize, &f64)| {
        [180.0, 360.0].map(|turned| ((turned - phi).rem_euclid(360.0), number))
    };
    let mut all: Vec<(f64, usize)> = phi_i_deg.iter().enumerate().flat_map(both).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    all
}

pub(super) fn unsound(message: &str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, message.to_owned())
}
