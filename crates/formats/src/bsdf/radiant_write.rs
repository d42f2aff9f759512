//! Writer of the tabular BSDF of Radiant Imaging and Zemax.

use std::io::Write;

use papilio_goniometry::{
    Channel, Fill, Geometry, MeasuredPart, Measurement, ScatterMode, Shape, SpecularGrid, Symmetry,
    is_on_rings, on_specular_grid, patch_count, projected_solid_angle,
};

use super::radiant_read::{AXES, NAME, SAMPLE, block_name};
use super::write::{Number, WriteError, check, lost_media, not_written, one_line};

pub(super) fn write(out: &mut dyn Write, measurement: &Measurement) -> Result<Vec<String>, WriteError> {
    let mut lost = Vec::new();
    lost_media(measurement, &mut lost);
    let part = choose_part(measurement, &mut lost)?;
    let channels = choose_channels(part, &mut lost)?;
    let resampled;
    let (part, channels) = match part.geometry {
        Geometry::Specular(_) => (part, channels),
        _ => {
            resampled = resample(part, &channels, &mut lost)?;
            check(&resampled)?;
            (&resampled, channels.iter().enumerate().map(|(number, (name, _))| (*name, number)).collect())
        }
    };
    let Geometry::Specular(grid) = &part.geometry else {
        return Err(WriteError::CannotHold { format: NAME, what: "this geometry" });
    };
    if grid.cells() == 0 {
        return Err(WriteError::CannotHold { format: NAME, what: "a part without cells" });
    }
    header(out, measurement, part, grid, channels.len())?;
    for (name, channel) in channels {
        writeln!(out, "\n{}\nDataBegin", block_name(name))?;
        block(out, part, grid, channel)?;
        writeln!(out, "DataEnd")?;
    }
    if part.values.iter().any(|value| value.is_nan()) {
        lost.push("cells without a value were written as 0".to_owned());
    }
    if part.tis.is_empty() {
        lost.push("the TIS was written as 0: the measurement has none".to_owned());
    }
    Ok(lost)
}

/// Interpolates a part onto a grid as that of imaging spheres; the TIS are the integrals of the values.
fn resample(
    part: &MeasuredPart,
    channels: &[(Channel, usize)],
    lost: &mut Vec<String>,
) -> Result<MeasuredPart, WriteError> {
    let (names, numbers): (Vec<Channel>, Vec<usize>) = channels.iter().copied().unzip();
    let (grid, values) = on_specular_grid(part, &numbers).ok_or(WriteError::CannotHold {
        format: NAME,
        what: "fewer than 12 different pairs of directions, or no light",
    })?;
    lost.push(
        match part.geometry {
            Geometry::Pairs(_) if is_on_rings(part) => {
                "the pairs are those of a grid about the specular direction, which the file has; the TIS is the integral of the values"
            }
            Geometry::Pairs(_) => {
                "pairs that are on no grid about the specular direction were interpolated, at azimuths in steps of 10 deg and radial \
                 distances in steps of 0.5 to 2 deg; the TIS is the integral of the values"
            }
            _ => {
                "the values were interpolated, with their means over azimuths of the light, at azimuths in steps of 10 deg and radial distances \
                 in steps of 0.5 to 2 deg (and at incidences from 0 to 85 deg in steps of 5 deg, where the cells define none); the TIS \
                 is their integral"
            }
        }
        .to_owned(),
    );
    let mut tis = Vec::new();
    for (channel, number) in values.chunks_exact(grid.cells()).zip(numbers) {
        let shape = Shape::of_grid(&grid, channel, Fill::None);
        let own = part.channel(number);
        tis.extend(
            grid.incidences_deg.iter().enumerate().map(|(k, theta)| {
                sum_over_cells(&part.geometry, own, *theta).unwrap_or_else(|| shape.total(k))
            }),
        );
    }
    Ok(MeasuredPart { way: part.way, channels: names, geometry: Geometry::Specular(grid), values, tis })
}

/// Returns the integral over the hemisphere of values that are constant over cells: their sum, which
/// interpolation would miss.
fn sum_over_cells(geometry: &Geometry, values: &[f64], theta_deg: f64) -> Option<f64> {
    match geometry {
        Geometry::Tree(tree) => Some(tree.mean_total(values, theta_deg)),
        Geometry::Patches { incoming, outgoing } => {
            let omega = projected_solid_angle(outgoing);
            let ring = incoming.iter().rposition(|ring| ring.from_deg <= theta_deg)?;
            let (first, count) = (patch_count(&incoming[..ring]), incoming[ring].patches);
            let columns = values.chunks_exact(omega.len()).skip(first).take(count);
            let light = columns.flat_map(|column| column.iter().zip(&omega));
            Some(light.map(|(f, omega)| f.max(0.0) * omega).sum::<f64>() / count as f64)
        }
        _ => None,
    }
}

/// Selects the part that the file will hold.
fn choose_part<'a>(
    measurement: &'a Measurement,
    lost: &mut Vec<String>,
) -> Result<&'a MeasuredPart, WriteError> {
    let order = [
        ScatterMode::FrontTransmission,
        ScatterMode::FrontReflection,
        ScatterMode::BackTransmission,
        ScatterMode::BackReflection,
    ];
    let part = order.iter().find_map(|way| measurement.parts.iter().find(|part| part.way == *way));
    let part = part.ok_or(WriteError::CannotHold { format: NAME, what: "a measurement without values" })?;
    for other in measurement.parts.iter().filter(|other| other.way != part.way) {
        lost.push(format!("the {} was not written: the format holds a single part", other.way.name()));
    }
    if matches!(part.way, ScatterMode::BackTransmission | ScatterMode::BackReflection) {
        lost.push(format!("the format cannot state that the values are of {}", part.way.name()));
    }
    Ok(part)
}

/// Selects the channels that the file will hold: their names in the file, and their indices in the part.
fn choose_channels(part: &MeasuredPart, lost: &mut Vec<String>) -> Result<Vec<(Channel, usize)>, WriteError> {
    let at = |channel| part.channels.iter().position(|c| *c == channel).map(|k| (channel, k));
    let xyz: Option<Vec<_>> = [Channel::X, Channel::Y, Channel::Z].into_iter().map(at).collect();
    if part.channels.is_empty() {
        return Err(WriteError::CannotHold { format: NAME, what: "a part without channels" });
    }
    let chosen = xyz.unwrap_or_else(|| vec![(Channel::Monochrome, part.luminous())]);
    let is_chosen = |k: usize| chosen.iter().any(|(_, number)| *number == k);
    let others = part.channels.iter().enumerate().filter(|(k, _)| !is_chosen(*k));
    lost.extend(not_written(&others.map(|(_, channel)| *channel).collect::<Vec<_>>()));
    if let [(_, only)] = chosen[..]
        && part.channels[only] != Channel::Monochrome
    {
        let channel = &part.channels[only];
        lost.push(format!("the format cannot state that the values are of the channel {channel}"));
    }
    Ok(chosen)
}

fn header(
    out: &mut dyn Write,
    measurement: &Measurement,
    part: &MeasuredPart,
    grid: &SpecularGrid,
    channels: usize,
) -> Result<(), WriteError> {
    let provenance = &measurement.provenance;
    if !provenance.sample.is_empty() {
        writeln!(out, "# {SAMPLE}{}", one_line(&provenance.sample))?;
    }
    for remark in &provenance.remarks {
        writeln!(out, "# {}", one_line(remark))?;
    }
    let source = match one_line(&provenance.source) {
        source if source.is_empty() => "Measured".to_owned(),
        source => source,
    };
    let symmetry = match grid.symmetry {
        Symmetry::Plane => "PlaneSymmetrical",
        Symmetry::None if grid.rotations_deg.len() > 1 => "Asymmetrical4D",
        Symmetry::None => "Asymmetrical",
    };
    let content = if channels == 1 { "Monochrome" } else { "XYZ" };
    let scatter = if part.way.is_transmission() { "BTDF" } else { "BRDF" };
    writeln!(
        out,
        "Source  {source}\nSymmetry  {symmetry}\nSpectralContent  {content}\nScatterType  {scatter}"
    )?;
    let axes = [&grid.rotations_deg, &grid.incidences_deg, &grid.azimuths_deg, &grid.radials_deg];
    for ((keyword, ..), axis) in AXES.iter().zip(axes) {
        writeln!(out, "{keyword}  {}", axis.len())?;
        row(out, axis)?;
    }
    Ok(())
}

fn block(
    out: &mut dyn Write,
    part: &MeasuredPart,
    grid: &SpecularGrid,
    channel: usize,
) -> Result<(), WriteError> {
    let incidences = grid.rotations_deg.len() * grid.incidences_deg.len();
    let radials = grid.radials_deg.len();
    let rows = part.channel(channel).chunks(radials);
    for (k, row_values) in rows.enumerate() {
        if k % grid.azimuths_deg.len() == 0 {
            let incidence = channel * incidences + k / grid.azimuths_deg.len();
            writeln!(out, "TIS  {}", Number(part.tis.get(incidence).copied().unwrap_or(0.0)))?;
        }
        row(out, row_values)?;
    }
    Ok(())
}

/// Writes a line of numbers, with 0 for missing values.
fn row(out: &mut dyn Write, values: &[f64]) -> Result<(), WriteError> {
    for (k, value) in values.iter().enumerate() {
        let value = if value.is_nan() { 0.0 } else { *value };
        write!(out, "{}{}", if k == 0 { "" } else { "\t" }, Number(value))?;
    }
    Ok(writeln!(out)?)
}
