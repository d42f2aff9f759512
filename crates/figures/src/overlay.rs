//! Spectra in one panel: reflectance of variants of a display, as in Feng 2012, fig. 3.12, and transmittance
//! of diffusers, as in fig. 3.10.

use papilio_display::result::{RunResult, View};

use crate::axis::Axis;
use crate::labels::{EndLabel, end_labels};
use crate::panel::{Panel, SMALL};
use crate::style::{INK, caption, ramp, state_stroke};
use crate::svg::{Point, Stroke, Svg, Text, text_width};

/// States that are drawn, if the display has any of them.
const STATES: [&str; 5] = ["white", "red", "green", "blue", "black"];
/// Dash patterns of the variants.
const DASHES: [&str; 4] = ["", "6 3", "1.5 2.5", "9 3 2 3"];
/// The panel, px.
const ORIGIN: Point = (70.0, 44.0);
const SIZE: Point = (540.0, 350.0);

/// Draws the reflectance factors of variants of a display: up to five states, in the first view of the first
/// variant. The curves of the first variant are solid and labelled.
pub fn spectra_over(variants: &[(&str, &RunResult)], title: &str) -> String {
    let first = variants.first().and_then(|(_, result)| result.views.first());
    let mut svg = Svg::new(760.0, 460.0).titled(&first.map_or(title.to_owned(), |view| caption(title, view)));
    let Some(view) = first else { return svg.finish() };
    let views: Vec<(&RunResult, &View)> =
        variants.iter().filter_map(|(_, result)| Some((*result, result.views.first()?))).collect();
    let names = names(view);
    let spectrum = |view: &View, name: &str| {
        view.states.get(name).and_then(|state| state.value.reflectance_factor.clone()).unwrap_or_default()
    };
    let all = views.iter().flat_map(|(_, view)| names.iter().flat_map(|name| spectrum(view, name)));
    let y = Axis::covering(all.chain([0.0]), 6, "Reflectance factor");
    let x = Axis::between(&variants[0].1.wavelength_nm, 8, "Wavelength (nm)");
    let panel = Panel { origin: ORIGIN, size: SIZE, x, y };
    panel.draw(&mut svg);
    let mut labels = Vec::new();
    for (k, (result, view)) in views.iter().enumerate() {
        for (i, name) in names.iter().enumerate() {
            let colour = state_stroke(name, i).colour;
            let stroke = Stroke::solid(&colour, 1.8).dashed(DASHES[k % DASHES.len()]);
            let points = panel.points(&result.wavelength_nm, &spectrum(view, name));
            svg.polyline(&points, &stroke);
            if let (0, Some(&end)) = (k, points.iter().rev().find(|point| point.1.is_finite())) {
                labels.push(EndLabel { end, text: (*name).to_owned(), stroke, marks: false });
            }
        }
    }
    end_labels(&mut svg, &panel, labels);
    let strokes = DASHES.into_iter().cycle().map(|dash| Stroke::solid(INK, 1.8).dashed(dash));
    legend(&mut svg, variants.iter().map(|(name, _)| *name).zip(strokes));
    svg.finish()
}

fn names(view: &View) -> Vec<&str> {
    let known: Vec<&str> = STATES.into_iter().filter(|name| view.states.get(name).is_some()).collect();
    if known.is_empty() {
        view.states.iter().map(|(name, _)| name).take(STATES.len()).collect()
    } else {
        known
    }
}

/// Transmittance of a diffuser at normal incidence.
#[derive(Debug, Clone, PartialEq)]
pub struct Transmission {
    /// Name of the diffuser.
    pub name: String,
    /// Wavelengths, ascending, nm.
    pub wavelength_nm: Vec<f64>,
    /// Transmitted fractions of the light.
    pub share: Vec<f64>,
}

/// Draws transmittance spectra, in %.
pub fn transmission(spectra: &[Transmission], title: &str) -> String {
    let mut svg = Svg::new(760.0, 460.0).titled(title);
    let nm = || spectra.iter().flat_map(|one| one.wavelength_nm.iter().copied());
    let ends = [nm().fold(f64::INFINITY, f64::min), nm().fold(f64::NEG_INFINITY, f64::max)];
    let percentages = spectra.iter().flat_map(|one| one.share.iter().map(|fraction| 100.0 * fraction));
    let x = Axis::between(&ends, 8, "Wavelength (nm)");
    let y = Axis::covering(percentages.chain([0.0, 100.0]), 6, "Transmittance (%)");
    let panel = Panel { origin: ORIGIN, size: (640.0, SIZE.1), x, y };
    panel.draw(&mut svg);
    let stroke = |k: usize| {
        let colour = ramp(k as f64 / spectra.len().max(2) as f64);
        // Different dash patterns keep coincident curves visible.
        Stroke::solid(&colour, 2.4 - 0.3 * (k % 4) as f64).dashed(DASHES[k % DASHES.len()])
    };
    for (k, one) in spectra.iter().enumerate() {
        let percent: Vec<f64> = one.share.iter().map(|fraction| 100.0 * fraction).collect();
        svg.polyline(&panel.points(&one.wavelength_nm, &percent), &stroke(k));
    }
    legend(&mut svg, spectra.iter().enumerate().map(|(k, one)| (one.name.as_str(), stroke(k))));
    svg.finish()
}

/// Draws a legend in a line above the panel.
pub(crate) fn legend<'a>(svg: &mut Svg, entries: impl Iterator<Item = (&'a str, Stroke)>) {
    let (mut x, y) = (ORIGIN.0, ORIGIN.1 - 16.0);
    for (name, stroke) in entries {
        svg.line((x, y - 4.0), (x + 28.0, y - 4.0), &stroke);
        svg.text((x + 34.0, y), name, Text::new(SMALL, INK));
        x += 58.0 + text_width(name, SMALL);
    }
}
