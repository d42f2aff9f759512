//! `papilio diffuser inspect`.

use std::io::Write;

use papilio_figures::{ScatterCurve, ScatterMap, Scattering, scattering};
use papilio_formats::{AuditFile, write_file, write_json};
use papilio_goniometry::{Audit, Fill, Measurement, Part, Shape};
use papilio_optics::Beta;

use super::{read, report};
use crate::arguments::Inspect;
use crate::{Failure, output};

/// Incidences that the polar maps show, degrees; the nearest ones that the file has.
const MAPS_DEG: [f64; 2] = [0.0, 45.0];

pub(crate) fn inspect(arguments: &Inspect) -> Result<(), Failure> {
    let measurement = read(&arguments.file)?;
    let audits: Vec<(&Part, Vec<Audit>)> = measurement
        .parts
        .iter()
        .map(|part| (part, (0..part.channels.len()).filter_map(|channel| Audit::of(part, channel)).collect()))
        .collect();
    let mut stdout = anstream::stdout().lock();
    if arguments.json {
        write_json(&mut stdout, &AuditFile::new(&measurement, &audits))?;
    } else {
        let name = arguments.file.display().to_string();
        stdout.write_all(report::inspect(&name, &measurement, &audits).as_bytes())?;
    }
    stdout.flush()?;
    let Some(folder) = &arguments.out else { return Ok(()) };
    output::check(folder)?;
    output::make_folder(folder)?;
    let mut names = Vec::new();
    for (name, svg) in figures(&measurement) {
        for (end, bytes) in [("svg", svg.clone().into_bytes()), ("png", papilio_figures::png(&svg, 2.0)?)] {
            let name = format!("{name}.{end}");
            write_file(&folder.join(&name), |out| out.write_all(&bytes))?;
            names.push(name);
        }
    }
    output::announce(folder, &names);
    Ok(())
}

/// A figure for each part: its luminous channel, or the first.
fn figures(measurement: &Measurement) -> Vec<(String, String)> {
    let one = |part: &Part| {
        let shape = Shape::of_part(part, part.luminous(), Fill::None)?;
        let name = format!("{}-{}", report::side(part.way), report::kind(part.way));
        let quantity = if part.way.is_transmission() { "BTDF (1/sr)" } else { "BRDF (1/sr)" };
        let figure = Scattering { quantity: quantity.to_owned(), curves: curves(&shape), maps: maps(&shape) };
        Some((name, scattering(&figure, &measurement.provenance.sample)))
    };
    measurement.parts.iter().filter_map(one).collect()
}

/// Each incidence in the plane of incidence.
fn curves(shape: &Shape) -> Vec<ScatterCurve> {
    let value = |k: usize, from: f64, to: f64| {
        shape.value(k, Beta { x: to.to_radians().sin() - from.to_radians().sin(), y: 0.0 })
    };
    let curve = |(k, from): (usize, f64)| ScatterCurve {
        name: None,
        incidence_deg: from,
        points: false,
        values: (-356..=356).map(|q| 0.25 * f64::from(q)).map(|to| (to, value(k, from, to))).collect(),
    };
    shape.incidences_deg().enumerate().map(curve).collect()
}

/// The hemisphere at the incidences nearest to those wanted.
fn maps(shape: &Shape) -> Vec<ScatterMap> {
    let incidences: Vec<f64> = shape.incidences_deg().collect();
    let nearest = |wanted: f64| {
        let off = |k: &usize| (incidences[*k] - wanted).abs();
        (0..incidences.len()).min_by(|a, b| off(a).total_cmp(&off(b)))
    };
    let mut chosen: Vec<usize> = MAPS_DEG.into_iter().filter_map(nearest).collect();
    chosen.dedup();
    let theta_deg: Vec<f64> = (0..=89).map(f64::from).collect();
    let phi_deg: Vec<f64> = (0..120).map(|k| 3.0 * f64::from(k)).collect();
    let map = |k: usize| {
        let from = Beta { x: incidences[k].to_radians().sin(), y: 0.0 };
        let value = |theta: f64, phi: f64| {
            let to = Beta::towards(theta, phi, 1.0) - from;
            shape.value(k, Beta { x: to.x, y: to.y.abs() })
        };
        let values = theta_deg.iter().flat_map(|theta| phi_deg.iter().map(|phi| value(*theta, *phi)));
        ScatterMap {
            incidence_deg: incidences[k],
            values: values.collect(),
            theta_deg: theta_deg.clone(),
            phi_deg: phi_deg.clone(),
        }
    };
    chosen.into_iter().map(map).collect()
}
