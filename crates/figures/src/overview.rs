//! Overview of a view on one page: patches, spectra and the u'v' diagram.

use papilio_display::result::{RunResult, View};

use crate::diagram::Diagram;
use crate::paint::Paint;
use crate::style::{INK, percent, seen_at, with_error};
use crate::svg::{Svg, Text};
use crate::{chromaticity, patches, spectra};

/// Largest u'v' distance from the light that is called no colour: less than a mark in the diagram.
const COLOURLESS: f64 = 0.003;
/// Largest variation of a spectrum that is called constant, relative to its mean.
const CONSTANT: f64 = 0.01;

/// Draws the overview of a view: main metrics, colours of the states, their spectra and the gamut. For a
/// display without colour, a line of text replaces the diagram, and the spectra if they are constant.
pub fn overview(result: &RunResult, view: &View, title: &str) -> String {
    if let Some(distance) = colourless(view) {
        return grey_overview(result, view, distance, title);
    }
    let shown = view.states.iter().count().clamp(1, 8) as f64;
    let side = (700.0 / shown - 12.0).min(76.0);
    let (diagram, top) = (500.0, 34.0);
    let middle = top + patches::height(view, side) + 24.0;
    let bottom = middle + 332.0;
    let mut svg = Svg::new(1300.0, bottom + 54.0).titled(title);
    svg.text((20.0, 16.0), &headline(result, view), Text::new(14.0, INK));
    patches::draw(&mut svg, result, view, (20.0, top), side);
    spectra::draw(&mut svg, result, view, (78.0, middle), (480.0, bottom - middle));
    let uv = Diagram::Uv;
    chromaticity::draw(&mut svg, result, view, uv, (778.0, bottom - uv.height(diagram)), diagram);
    svg.finish()
}

/// Returns the largest u'v' distance of the states from the light, if none has a visible colour and there is
/// no gamut.
fn colourless(view: &View) -> Option<f64> {
    let distances: Option<Vec<f64>> =
        view.states.iter().map(|(_, state)| state.value.distance_from_white_uv).collect();
    let farthest = distances?.into_iter().fold(0.0, f64::max);
    (view.metrics.gamut_percent_srgb.is_none() && farthest <= COLOURLESS).then_some(farthest)
}

fn grey_overview(result: &RunResult, view: &View, distance: f64, title: &str) -> String {
    let shown = view.states.iter().count().clamp(1, 8) as f64;
    let side = (560.0 / shown - 12.0).min(76.0);
    let top = 34.0;
    let below = top + patches::height(view, side) + 24.0;
    let constant = view.states.iter().all(|(_, state)| {
        state.value.reflectance_factor.as_ref().is_some_and(|spectrum| is_constant(spectrum))
    });
    let height = if constant { -16.0 } else { 360.0 };
    let mut svg = Svg::new(640.0, below + height + 30.0).titled(title);
    svg.text((20.0, 16.0), &headline(result, view), Text::new(14.0, INK));
    patches::draw(&mut svg, result, view, (20.0, top), side);
    let mut note = if distance < 5e-4 {
        "All states have the colour of the light".to_owned()
    } else {
        format!("No state differs from the light by more than {distance:.3} in u\u{2032}v\u{2032}")
    };
    if constant {
        note.push_str("; reflectance factors are the same at all wavelengths");
    } else {
        spectra::draw(&mut svg, result, view, (78.0, below), (440.0, height - 50.0));
    }
    svg.text((20.0, below + height + 12.0), &format!("{note}."), Text::new(12.0, "#777777"));
    svg.finish()
}

fn is_constant(spectrum: &[f64]) -> bool {
    let mean = spectrum.iter().sum::<f64>() / spectrum.len().max(1) as f64;
    spectrum.iter().all(|value| (value - mean).abs() <= CONSTANT * mean.abs())
}

fn headline(result: &RunResult, view: &View) -> String {
    let mut parts = vec![format!("Viewed {}", seen_at(view))];
    if let Some(white) = view.states.get("white") {
        let (y, error) = percent(white.value.Y, white.standard_error.Y);
        let error = error.map(|error| format!(" \u{b1} {error}")).unwrap_or_default();
        parts.push(format!("white Y {y}{error} %"));
    }
    if let Some(contrast) = view.metrics.contrast_ratio {
        parts.push(format!("contrast {}", with_error(contrast, view.standard_error.contrast_ratio, 1)));
    }
    if let Some(gamut) = view.metrics.gamut_percent_srgb {
        let gamut = with_error(gamut, view.standard_error.gamut_percent_srgb, 1);
        parts.push(format!("gamut {gamut} % of sRGB in {}", Diagram::Uv.name()));
    }
    if let Some(dimmed) = Paint::of(result, view).dimmed() {
        parts.push(format!("patches {dimmed}"));
    }
    parts.join("   \u{b7}   ")
}
