//! `papilio diffuser fit`: analytic lobes of a measurement.

use std::io::Write;

use papilio_figures::{ScatterCurve, Scattering, scattering};
use papilio_formats::{BsdfFile, FitFile, write_json};
use papilio_goniometry::{FitOptions, Geometry, MeasuredPart, Measurement, RankedFit, SpecularGrid, fitted};
use papilio_optics::Beta;

use super::{read_file, report, tables};
use crate::arguments::FitArguments;
use crate::progress::FractionBar;
use crate::{Failure, output};

/// Incidences of the figure, degrees, as in Feng 2012, fig. 4.5; the nearest ones of the file are used.
const SHOWN_DEG: [f64; 2] = [5.0, 20.0];
/// Number of lobes in the figure, in addition to the data.
const SHOWN_LOBES: usize = 3;

pub(crate) fn fit(arguments: &FitArguments) -> Result<(), Failure> {
    arguments.out.as_deref().map_or(Ok(()), output::check)?;
    let BsdfFile { measurement, warnings, notes, .. } = read_file(&arguments.file, arguments.part)?;
    let Some(part) = measurement.parts.first() else {
        return Err(Failure::Input("the file has no data".to_owned()));
    };
    let channel = part.luminous();
    let options = FitOptions { straight_width: arguments.straight_width, ..FitOptions::default() };
    let bar = FractionBar::new();
    bar.advance(0.0, format!("fitting lobes to {} values", part.channel(channel).len()));
    let log = bar.in_log(String::new);
    let fits = fitted(part, channel, arguments.model, &options)
        .map_err(|error| Failure::Input(error.to_string()))?;
    drop((log, bar));
    let mut stdout = crate::terminal::output(arguments.json);
    if arguments.json {
        write_json(&mut stdout, &FitFile::new(part, channel, &fits, [&notes, &warnings]))?;
    } else {
        let file = arguments.file.display().to_string();
        stdout.write_all(report::fit(&file, part, &fits).as_bytes())?;
        stdout.write_all(tables::scenario_tables(&file, part, &fits).as_bytes())?;
    }
    stdout.flush()?;
    let Some(folder) = &arguments.out else { return Ok(()) };
    output::make_folder(folder)?;
    let svg = figure(&measurement, part, channel, &fits);
    let figures = vec![("fit".to_owned(), svg)];
    output::print_written(folder, &output::write_figures(folder, figures, arguments.png)?);
    Ok(())
}

/// Figure of the data and the best lobes in the plane of incidence.
fn figure(measurement: &Measurement, part: &MeasuredPart, channel: usize, fits: &[RankedFit]) -> String {
    let quantity = if part.way.is_transmission() { "BTDF (1/sr)" } else { "BRDF (1/sr)" };
    let mut curves = Vec::new();
    for from in shown_incidences(part) {
        curves.push(ScatterCurve {
            name: Some("data".to_owned()),
            incidence_deg: from,
            points: true,
            values: in_plane(part, channel, from),
        });
        for ranked in fits.iter().take(SHOWN_LOBES) {
            let ray = |theta: f64| Beta { x: theta.to_radians().sin(), y: 0.0 };
            let values =
                (-178..=178).map(|k| 0.5 * f64::from(k)).map(|to| (to, ranked.fit.value(ray(from), ray(to))));
            curves.push(ScatterCurve {
                name: Some(ranked.fit.model.kind.name().to_owned()),
                incidence_deg: from,
                points: false,
                values: values.collect(),
            });
        }
    }
    let figure = Scattering { quantity: quantity.to_owned(), curves, maps: Vec::new() };
    let sample = match measurement.provenance.sample.as_str() {
        "" => "Measured lobe",
        sample => sample,
    };
    scattering(&figure, &format!("{sample}   \u{b7}   data and fitted lobes"))
}

/// The incidences of the file that are nearest to those of the figure.
fn shown_incidences(part: &MeasuredPart) -> Vec<f64> {
    let Geometry::Specular(grid) = &part.geometry else { return SHOWN_DEG.to_vec() };
    let nearest = |requested: f64| {
        let distance = |theta: &&f64| (**theta - requested).abs();
        grid.incidences_deg.iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).copied()
    };
    let mut shown: Vec<f64> = SHOWN_DEG.into_iter().filter_map(nearest).collect();
    shown.dedup();
    shown
}

/// Inclinations and values of the cells in the plane of incidence.
fn in_plane(part: &MeasuredPart, channel: usize, from: f64) -> Vec<(f64, f64)> {
    let Geometry::Specular(grid) = &part.geometry else { return Vec::new() };
    let Some(k) = grid.incidences_deg.iter().position(|theta| *theta == from) else { return Vec::new() };
    let (azimuths, radials) = (grid.azimuths_deg.len(), grid.radials_deg.len());
    let mut cells = Vec::new();
    for (a, azimuth) in grid.azimuths_deg.iter().enumerate().filter(|(_, a)| **a == 0.0 || **a == 180.0) {
        for (r, radial) in grid.radials_deg.iter().enumerate() {
            if let Some(to) = SpecularGrid::direction(from, *azimuth, *radial) {
                let sign = if to.phi_deg.abs() > 90.0 { -1.0 } else { 1.0 };
                let cell = (k * azimuths + a) * radials + r;
                cells.push((sign * to.theta_deg, part.channel(channel)[cell]));
            }
        }
    }
    cells
}
