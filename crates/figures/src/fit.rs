//! Fits of a scenario to measured data: spectra, and residuals over their standard deviations.

use crate::axis::Axis;
use crate::labels::{EndLabel, end_labels};
use crate::overlay::legend;
use crate::panel::Panel;
use crate::style::{INK, state_stroke};
use crate::svg::{Point, Stroke, Svg};

/// The panel, px.
const ORIGIN: Point = (70.0, 44.0);
const SIZE: Point = (540.0, 350.0);
/// Dash pattern of measured curves.
const MEASURED: &str = "6 3";
/// Half the width of a band, standard deviations.
const BAND: f64 = 2.0;

/// A measured spectrum with its fit.
#[derive(Debug, Clone, PartialEq)]
pub struct FittedSpectrum {
    /// State, with its direction if there are several.
    pub name: String,
    /// Wavelengths, nm.
    pub wavelength_nm: Vec<f64>,
    /// Measured reflectance factors.
    pub measured: Vec<f64>,
    /// Their standard deviations.
    pub deviation: Vec<f64>,
    /// Predicted reflectance factors.
    pub predicted: Vec<f64>,
}

/// Draws the measured spectra with bands of two standard deviations, and their fits.
pub fn fitted_spectra(all: &[FittedSpectrum], title: &str) -> String {
    let predicted = all.iter().flat_map(|one| one.predicted.iter().copied());
    let highest = all
        .iter()
        .flat_map(|one| one.measured.iter().zip(&one.deviation).map(|(value, by)| value + BAND * by));
    let y = Axis::covering(predicted.chain(highest).chain([0.0]), 6, "Reflectance factor");
    // Measured values near 0 have bands that reach below it.
    let lowest = y.min();
    drawn(all, title, (y, ["fitted", "measured, with 2 standard deviations"]), |svg, panel, one, stroke| {
        let band = |times: f64| -> Vec<f64> {
            one.measured
                .iter()
                .zip(&one.deviation)
                .map(|(value, by)| (value + times * by).max(lowest))
                .collect()
        };
        let edges = [BAND, -BAND].map(|times| panel.points(&one.wavelength_nm, &band(times)));
        let [upper, lower] = edges;
        let outline: Vec<Point> = upper.into_iter().chain(lower.into_iter().rev()).collect();
        svg.polygon(&outline, &stroke.colour, 0.2);
        svg.polyline(&panel.points(&one.wavelength_nm, &one.measured), &stroke.clone().dashed(MEASURED));
        one.predicted.clone()
    })
}

/// Draws the residuals, fitted minus measured, over their standard deviations.
pub fn fit_residuals(all: &[FittedSpectrum], title: &str) -> String {
    let z = |one: &FittedSpectrum| -> Vec<f64> {
        let both = one.predicted.iter().zip(&one.measured).zip(&one.deviation);
        both.map(|((predicted, measured), deviation)| (predicted - measured) / deviation).collect()
    };
    let values = all.iter().flat_map(z);
    let y = Axis::covering(values.chain([-BAND, BAND]), 6, "Residual over standard deviation");
    drawn(all, title, (y, ["fitted minus measured", "2 standard deviations"]), |svg, panel, one, _| {
        for times in [-BAND, BAND] {
            let ends = [panel.at(panel.x.min(), times), (panel.right(), panel.at(panel.x.min(), times).1)];
            svg.line(ends[0], ends[1], &Stroke::solid(INK, 1.0).dashed(MEASURED));
        }
        z(one)
    })
}

/// Draws a curve of each spectrum, with words for solid and dashed lines, which `values` returns after it has drawn what is below the curve.
fn drawn(
    all: &[FittedSpectrum],
    title: &str,
    (y, [solid, dashed]): (Axis, [&str; 2]),
    values: impl Fn(&mut Svg, &Panel, &FittedSpectrum, &Stroke) -> Vec<f64>,
) -> String {
    let nm = all.iter().flat_map(|one| one.wavelength_nm.iter().copied());
    let ends = [nm.clone().fold(f64::INFINITY, f64::min), nm.fold(f64::NEG_INFINITY, f64::max)];
    let mut svg = Svg::new(760.0, 460.0).titled(title);
    let panel = Panel { origin: ORIGIN, size: SIZE, x: Axis::between(&ends, 8, "Wavelength (nm)"), y };
    panel.draw(&mut svg);
    let mut labels = Vec::new();
    for (i, one) in all.iter().enumerate() {
        let stroke = Stroke::solid(&state_stroke(&one.name, i).colour, 1.8);
        let values = values(&mut svg, &panel, one, &stroke);
        let points = panel.points(&one.wavelength_nm, &values);
        svg.polyline(&points, &stroke);
        if let Some(&end) = points.iter().rev().find(|point| point.1.is_finite()) {
            labels.push(EndLabel { end, text: one.name.clone(), stroke, marks: false });
        }
    }
    end_labels(&mut svg, &panel, labels);
    let entries = [(solid, ""), (dashed, MEASURED)];
    legend(&mut svg, entries.into_iter().map(|(name, dash)| (name, Stroke::solid(INK, 1.8).dashed(dash))));
    svg.finish()
}
