//! Overview of a view on one page: patches, spectra and the u'v' diagram.

use papilio_display::result::{RunResult, View};

use crate::diagram::Diagram;
use crate::paint::Paint;
use crate::style::{INK, percent, seen_at, with_error};
use crate::svg::{Svg, Text};
use crate::{chromaticity, patches, spectra};

/// Draws the overview of a view: main metrics, colours of the states, their spectra and the gamut.
pub fn overview(result: &RunResult, view: &View, title: &str) -> String {
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
