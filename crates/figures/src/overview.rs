//! One page that says it all: patches, spectra and the u'v' diagram.

use papilio_display::result::{RunResult, View};

use crate::style::{INK, with_error};
use crate::svg::{Svg, Text};
use crate::{chromaticity, patches, spectra};

/// A view at a glance: what is seen, the colours of the states, their spectra and the gamut.
pub fn overview(result: &RunResult, view: &View) -> String {
    let (diagram, bottom) = (500.0, 556.0);
    let mut svg = Svg::new(1300.0, bottom + 54.0);
    svg.text((28.0, 36.0), &headline(view), Text::new(15.0, INK).strong());
    let shown = view.states.iter().count().clamp(1, 8) as f64;
    let side = (700.0 / shown - 12.0).min(76.0);
    patches::draw(&mut svg, result, view, (28.0, 58.0), side);
    spectra::draw(&mut svg, result, view, (78.0, 232.0), (480.0, bottom - 232.0));
    chromaticity::draw(&mut svg, result, view, (778.0, bottom - chromaticity::height(diagram)), diagram);
    svg.finish()
}

fn headline(view: &View) -> String {
    let mut parts = vec![format!("Viewed at {}\u{b0}", (view.theta_deg * 100.0).round() / 100.0)];
    if let Some(white) = view.states.get("white") {
        let y = with_error(100.0 * white.value.Y, Some(100.0 * white.standard_error.Y), 1);
        parts.push(format!("white Y {y} %"));
    }
    if let Some(contrast) = view.contrast_ratio {
        parts.push(format!("contrast {}", with_error(contrast, view.standard_error.contrast_ratio, 1)));
    }
    if let Some(gamut) = view.gamut_percent_srgb {
        let gamut = with_error(gamut, view.standard_error.gamut_percent_srgb, 1);
        parts.push(format!("gamut {gamut} % of sRGB"));
    }
    parts.join("   \u{b7}   ")
}
