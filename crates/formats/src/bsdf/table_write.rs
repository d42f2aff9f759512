//! Writer of CSV files: one row per pair of directions and channel.

use std::collections::HashSet;
use std::io::Write;

use papilio_goniometry::{Channel, Direction, Geometry, MeasuredPart, Measurement, Symmetry};

use super::table_read::NAME;
use super::write::{Number, WriteError, lost_media, one_line};

pub(super) fn write(out: &mut dyn Write, measurement: &Measurement) -> Result<Vec<String>, WriteError> {
    let mut lost = Vec::new();
    lost_media(measurement, &mut lost);
    let provenance = &measurement.provenance;
    for (what, text) in [("sample", &provenance.sample), ("source", &provenance.source)] {
        if !text.is_empty() {
            writeln!(out, "# {what}: {}", one_line(text))?;
        }
    }
    for remark in &provenance.remarks {
        writeln!(out, "# {}", one_line(remark))?;
    }
    let monochrome = measurement.parts.iter().all(|part| part.channels == [Channel::Monochrome]);
    let channel = if monochrome { "" } else { "channel," };
    writeln!(out, "way,theta_i,phi_i,theta_o,phi_o,{channel}value")?;
    for part in &measurement.parts {
        if !part.tis.is_empty() {
            lost.push(format!("the TIS of the {} was not written", part.way.name()));
        }
        write_part(out, part, monochrome, &mut lost)?;
    }
    Ok(lost)
}

fn write_part(
    out: &mut dyn Write,
    part: &MeasuredPart,
    monochrome: bool,
    lost: &mut Vec<String>,
) -> Result<(), WriteError> {
    if let Geometry::Warped(_) = part.geometry {
        return Err(WriteError::CannotHold { format: NAME, what: "a warped grid" });
    }
    let rows = rows(&part.geometry);
    if !matches!(part.geometry, Geometry::Spherical(_) | Geometry::Pairs(_)) {
        lost.push("the grid was not written: its cells were written as pairs of directions".to_owned());
    }
    for (k, channel) in part.channels.iter().enumerate() {
        let values = part.channel(k);
        for (cell, [i, o]) in &rows {
            let angles = [i.theta_deg, i.phi_deg, o.theta_deg, o.phi_deg].map(Number);
            let [theta_i, phi_i, theta_o, phi_o] = angles;
            write!(out, "{},{theta_i},{phi_i},{theta_o},{phi_o},", part.way.name())?;
            if !monochrome {
                write!(out, "{channel},")?;
            }
            match values[*cell] {
                value if value.is_nan() => writeln!(out)?,
                value => writeln!(out, "{}", Number(value))?,
            }
        }
    }
    Ok(())
}

/// Returns the cells in the hemisphere with their directions, each pair once, including the mirror images
/// that a symmetry implies.
fn rows(geometry: &Geometry) -> Vec<(usize, [Direction; 2])> {
    let mirrored = matches!(geometry, Geometry::Specular(grid) if grid.symmetry == Symmetry::Plane);
    let mut seen = HashSet::new();
    let mut rows = Vec::new();
    for cell in 0..geometry.cells() {
        let Some([i, o]) = geometry.directions(cell) else { continue };
        // A rotated sample may have azimuths beyond 360 deg, which readers do not expect.
        let within_a_turn = |d: Direction| Direction { phi_deg: d.phi_deg % 360.0, ..d };
        let pair = [within_a_turn(i), within_a_turn(o)];
        let image = [pair[0], Direction { phi_deg: (2.0 * i.phi_deg - o.phi_deg) % 360.0, ..o }];
        let images = if mirrored { vec![pair, image] } else { vec![pair] };
        // Only cells about a specular direction may coincide.
        let may_coincide = matches!(geometry, Geometry::Specular(_));
        rows.extend(
            images
                .into_iter()
                .filter(|pair| !may_coincide || seen.insert(key(pair)))
                .map(|pair| (cell, pair)),
        );
    }
    rows
}

/// Returns a key that is equal for directions that differ only by rounding. The azimuth of the light counts
/// also along the normal, because each rotation of the sample is a separate measurement.
fn key([i, o]: &[Direction; 2]) -> [i64; 6] {
    let azimuth = i.phi_deg.to_radians().sin_cos();
    let [x, y, z] = o.vector();
    [i.theta_deg, azimuth.0, azimuth.1, x, y, z].map(|x| (x * 1e10).round() as i64)
}
