//! `papilio diffuser inspect`: the quality of a measurement.

use std::io::Write;
use std::path::Path;

use papilio_figures::{Transmission, lobes, transmission};
use papilio_formats::words::percent;
use papilio_formats::{AuditFile, DataFile, audit_text, read_fractions, write_json};
use papilio_goniometry::{Audit, Geometry, MeasuredPart, Measurement, SpecularGrid, Unblur, deblurred};

use super::{read, report};
use crate::arguments::Inspect;
use crate::{Failure, output};

pub(crate) fn inspect(arguments: &Inspect) -> Result<(), Failure> {
    let measurement = read(&arguments.file, arguments.part)?;
    let spectra: Vec<Transmission> =
        arguments.transmission.iter().map(|path| spectrum(path)).collect::<Result<_, _>>()?;
    // The printed report has the luminous channel of each part; JSON has all channels.
    let audits: Vec<Option<Audit>> =
        measurement.parts.iter().map(|part| Audit::of(part, part.luminous())).collect();
    let mut stdout = crate::terminal::output(arguments.json);
    if arguments.json {
        let all_channels =
            |part: &MeasuredPart| (0..part.channels.len()).filter_map(|k| Audit::of(part, k)).collect();
        let all: Vec<(&MeasuredPart, Vec<Audit>)> =
            measurement.parts.iter().map(|part| (part, all_channels(part))).collect();
        write_json(&mut stdout, &AuditFile::new(&measurement, &all))?;
    } else {
        let name = arguments.file.display().to_string();
        stdout.write_all(audit_text(&name, &measurement, &audits).as_bytes())?;
        stdout.write_all(sharp_haze(&measurement).as_bytes())?;
        stdout.write_all(report::spectra(&spectra).as_bytes())?;
    }
    stdout.flush()?;
    let Some(folder) = &arguments.out else { return Ok(()) };
    output::check(folder)?;
    output::make_folder(folder)?;
    let mut names = Vec::new();
    for (name, svg) in lobes(&measurement, &audits) {
        names.extend(output::write_figure(folder, &name, &svg)?);
    }
    if !spectra.is_empty() {
        let svg = transmission(&spectra, "Transmission along the normal");
        names.extend(output::write_figure(folder, "transmission", &svg)?);
    }
    output::print_written(folder, &names);
    Ok(())
}

/// Haze of the transmissions without the instrument blur that the file states; empty if it states none.
fn sharp_haze(measurement: &Measurement) -> String {
    let remarks = measurement.provenance.remarks.iter();
    let stated = remarks.filter(|remark| remark.contains("in direction cosines"));
    let width = stated
        .filter_map(|remark| remark.strip_prefix("blur ")?.split(' ').next()?.parse::<f64>().ok())
        .next();
    let Some(width) = width.filter(|width| *width > 0.0) else { return String::new() };
    let hazes: Vec<String> = measurement
        .parts
        .iter()
        .filter_map(|part| {
            Some(format!("{} of the {}", percent(haze_without(part, width)?), part.way.name()))
        })
        .collect();
    match hazes.is_empty() {
        true => String::new(),
        false => format!(
            "\nhaze without the instrument blur of {width} (direction cosines) that the file states: {}\n  `instrument_blur = {width}` \
             removes it in a display\n",
            hazes.join(", ")
        ),
    }
}

/// Haze of a transmission at its smallest incidence, with the blur removed.
fn haze_without(part: &MeasuredPart, width: f64) -> Option<f64> {
    let Geometry::Specular(grid) = &part.geometry else { return None };
    let cells = grid.azimuths_deg.len() * grid.radials_deg.len();
    let channel = part.luminous();
    // One rotation and incidence is enough.
    let first = SpecularGrid {
        rotations_deg: grid.rotations_deg.first().copied().into_iter().collect(),
        incidences_deg: grid.incidences_deg.first().copied().into_iter().collect(),
        ..grid.clone()
    };
    let mut part = MeasuredPart {
        way: part.way,
        channels: vec![part.channels[channel]],
        geometry: Geometry::Specular(first),
        values: part.channel(channel).get(..cells)?.to_vec(),
        tis: Vec::new(),
    };
    part.values = deblurred(&part, 0, &Unblur::of_width(width)).ok()?.values;
    Audit::of(&part, 0)?.haze
}

/// Reads a transmission spectrum from a file.
fn spectrum(path: &Path) -> Result<Transmission, Failure> {
    let file = DataFile::open(path, &path.display().to_string()).map_err(Failure::Data)?;
    let spectrum = read_fractions(&file).map_err(Failure::Data)?;
    Ok(Transmission {
        name: path.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
        wavelength_nm: spectrum.wavelengths_nm().to_vec(),
        share: spectrum.values().to_vec(),
    })
}
