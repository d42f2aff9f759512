//! Absorptance of each layer of a film pixel against wavelength, as stacked areas.

use papilio_display::pixel::{PixelAbsorption, PixelLayer, SubPixelAbsorption};

use crate::axis::Axis;
use crate::panel::{Panel, SMALL};
use crate::style::{INK, degrees, joined};
use crate::svg::{Point, Stroke, Svg, Text, shortened};

/// Panels in a row, and at most.
const COLUMNS: usize = 3;
const PANELS: usize = 9;
/// Width and height of a panel with its labels, px.
const CELL: Point = (318.0, 300.0);
/// Colours of the layers, from the top; the substrate is grey.
const HUES: [&str; 8] =
    ["#4477aa", "#ee6677", "#228833", "#ccbb44", "#66ccee", "#aa3377", "#ee8866", "#44bb99"];
const SUBSTRATE: &str = "#bbbbbb";
/// Smallest absorptance of a layer that is drawn.
const LEAST: f64 = 1e-3;

/// Draws the absorptance of each layer at the smallest angle, stacked from the substrate up; what is left to
/// 1 is reflected. There is a panel for each distinct sub-pixel and drive.
pub fn absorption(all: &PixelAbsorption, medium: &str, title: &str) -> String {
    let angle = (0..all.theta_deg.len()).min_by(|a, b| all.theta_deg[*a].total_cmp(&all.theta_deg[*b]));
    let angle = angle.unwrap_or(0);
    let parts = distinct(all);
    let layers = visible(all, angle);
    let (columns, rows) = (parts.len().clamp(1, COLUMNS) as f64, parts.len().div_ceil(COLUMNS).max(1) as f64);
    let at =
        all.theta_deg.get(angle).map_or(String::new(), |theta| format!("at {} in {medium}", degrees(*theta)));
    let mut svg =
        Svg::new(70.0 + CELL.0 * columns + 150.0, 20.0 + CELL.1 * rows).titled(&joined(&[title, &at]));
    for (k, part) in parts.iter().enumerate() {
        let (column, row) = ((k % COLUMNS) as f64, (k / COLUMNS) as f64);
        let y_title = if column == 0.0 { "Absorptance" } else { "" };
        let panel = Panel {
            origin: (70.0 + CELL.0 * column, 40.0 + CELL.1 * row),
            size: (CELL.0 - 66.0, CELL.1 - 86.0),
            x: Axis::between(&all.wavelength_nm, 5, "Wavelength (nm)"),
            y: Axis::exact(0.0, 1.0, 5, y_title),
        };
        panel.draw(&mut svg);
        let name = format!("{} sub-pixel, state {}", part.sub_pixel, part.state);
        let name = shortened(&name, panel.size.0, 13.0);
        svg.text((panel.origin.0, panel.origin.1 - 12.0), &name, Text::new(13.0, INK).strong());
        stack(&mut svg, &panel, all, part, (&layers, angle));
    }
    legend(&mut svg, all, &layers, 70.0 + CELL.0 * columns - 36.0);
    svg.finish()
}

/// Returns sub-pixels and states with different absorptances: a sub-pixel that is driven in the same way in
/// several states is drawn once.
fn distinct(all: &PixelAbsorption) -> Vec<&SubPixelAbsorption> {
    let mut parts: Vec<&SubPixelAbsorption> = Vec::new();
    for one in &all.sub_pixels {
        if parts.iter().all(|known| known.absorptance != one.absorptance) {
            parts.push(one);
        }
    }
    parts.truncate(PANELS);
    parts
}

/// Returns the spectrum of a layer at an angle; empty if it is missing.
fn spectrum<'a>(
    all: &PixelAbsorption,
    part: &'a SubPixelAbsorption,
    layer: usize,
    angle: usize,
) -> &'a [f64] {
    let bins = all.wavelength_nm.len();
    let start = (layer * all.theta_deg.len() + angle) * bins;
    part.absorptance.get(start..start + bins).unwrap_or(&[])
}

/// Returns the layers that absorb visibly anywhere.
fn visible(all: &PixelAbsorption, angle: usize) -> Vec<usize> {
    let absorbs = |layer: &usize| {
        let spectra = all.sub_pixels.iter().flat_map(|part| spectrum(all, part, *layer, angle));
        spectra.copied().fold(0.0, f64::max) >= LEAST
    };
    (0..all.layers.len()).filter(absorbs).collect()
}

/// Draws the areas of the layers, from the substrate up.
fn stack(
    svg: &mut Svg,
    panel: &Panel,
    all: &PixelAbsorption,
    part: &SubPixelAbsorption,
    (layers, angle): (&[usize], usize),
) {
    let mut below = vec![0.0; all.wavelength_nm.len()];
    for &layer in layers.iter().rev() {
        let own = spectrum(all, part, layer, angle);
        let above: Vec<f64> = below.iter().zip(own).map(|(below, own)| below + own).collect();
        let edge = panel.points(&all.wavelength_nm, &above);
        let around: Vec<Point> =
            edge.iter().copied().chain(panel.points(&all.wavelength_nm, &below).into_iter().rev()).collect();
        svg.polygon(&around, colour(all, layer), 0.85);
        svg.polyline(&edge, &Stroke::solid("#ffffff", 0.8));
        below = above;
    }
    // The upper end of the stack is 1 - reflectance.
    svg.polyline(&panel.points(&all.wavelength_nm, &below), &Stroke::solid(INK, 1.4));
}

fn colour(all: &PixelAbsorption, layer: usize) -> &'static str {
    let is_substrate = all.layers.get(layer).is_some_and(|layer| layer.number.is_none());
    if is_substrate { SUBSTRATE } else { HUES[layer % HUES.len()] }
}

fn legend(svg: &mut Svg, all: &PixelAbsorption, layers: &[usize], left: f64) {
    svg.text((left, 52.0), "Absorbed by", Text::new(SMALL, INK).strong());
    let mut y = 74.0;
    for &layer in layers {
        svg.rect((left, y - 10.0), (14.0, 12.0), 0.0, colour(all, layer), "");
        let name = all.layers.get(layer).map_or(String::new(), name);
        svg.text((left + 22.0, y), &shortened(&name, 160.0, SMALL), Text::new(SMALL, INK));
        y += 19.0;
    }
    svg.line((left, y - 4.0), (left + 14.0, y - 4.0), &Stroke::solid(INK, 1.4));
    svg.text((left + 22.0, y), "1 - reflectance", Text::new(SMALL, INK));
}

fn name(layer: &PixelLayer) -> String {
    match layer.number {
        Some(number) => format!("{number}: {}", layer.material),
        None => format!("substrate: {}", layer.material),
    }
}
