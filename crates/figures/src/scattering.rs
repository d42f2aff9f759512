//! A measured lobe against the angle in the plane of incidence, as in Feng 2012, fig. 3.8, and over the
//! hemisphere.

use crate::axis::Axis;
use crate::panel::{Panel, SMALL};
use crate::polar::{BLANK, Directions, Map, colour_bar};
use crate::style::{INK, degrees, ramp};
use crate::svg::{Anchor, Point, Stroke, Svg, Text};

/// Data of a figure of scattering.
#[derive(Debug, Clone, PartialEq)]
pub struct Scattering {
    /// Title of the axis of values: `BTDF (1/sr)`.
    pub quantity: String,
    /// Curves in the plane of incidence.
    pub curves: Vec<ScatterCurve>,
    /// Maps over the hemisphere.
    pub maps: Vec<ScatterMap>,
}

/// Values in the plane of incidence.
#[derive(Debug, Clone, PartialEq)]
pub struct ScatterCurve {
    /// Name in the legend: curves of one name have the same style, and their angle of incidence is written at
    /// their peak. `None`: the legend has the angle of incidence.
    pub name: Option<String>,
    /// Inclination of the light, degrees.
    pub incidence_deg: f64,
    /// Whether the curve is drawn as points.
    pub points: bool,
    /// Inclinations of the viewer, degrees, positive on the specular side, and values.
    pub values: Vec<(f64, f64)>,
}

/// Values over the hemisphere.
#[derive(Debug, Clone, PartialEq)]
pub struct ScatterMap {
    /// Inclination of the light, degrees.
    pub incidence_deg: f64,
    /// Inclinations, degrees, ascending.
    pub theta_deg: Vec<f64>,
    /// Azimuths, degrees, ascending; 0 is the specular side.
    pub phi_deg: Vec<f64>,
    /// Shape `[theta][phi]`.
    pub values: Vec<f64>,
}

/// Size of the panel of curves, px.
const SIZE: (f64, f64) = (560.0, 400.0);
/// Width of the legend without the names, and width per letter of the longest name, px.
const LEGEND: [f64; 2] = [90.0, 6.6];
/// Radius of a map, px.
const RADIUS: f64 = 150.0;
/// Smallest value drawn, relative to the peak; instruments do not resolve smaller ones.
const REACH: f64 = 1e-5;

/// Draws the curves on a logarithmic scale, and the maps on one scale of colours.
pub fn scattering(figure: &Scattering, title: &str) -> String {
    let values = || {
        let of_curves = figure.curves.iter().flat_map(|curve| curve.values.iter().map(|(_, value)| *value));
        let of_maps = figure.maps.iter().flat_map(|map| map.values.iter().copied());
        of_curves.chain(of_maps).filter(|value| *value > 0.0 && value.is_finite())
    };
    let peak = values().fold(0.0, f64::max);
    let least = values().fold(peak, f64::min).max(REACH * peak);
    let scale = if peak > 0.0 { Axis::decades(least, peak, &figure.quantity) } else { None };
    let scale = scale.unwrap_or_else(|| Axis::exact(0.0, 1.0, 5, &figure.quantity));
    let longest =
        figure.curves.iter().filter_map(|curve| curve.name.as_ref()).map(|name| name.chars().count());
    let maps_left = 80.0 + SIZE.0 + LEGEND[0] + LEGEND[1] * longest.max().unwrap_or(9) as f64;
    let pitch = 2.0 * RADIUS + 90.0;
    let width =
        maps_left + pitch * figure.maps.len() as f64 + if figure.maps.is_empty() { 0.0 } else { 76.0 };
    let mut svg = Svg::new(width, SIZE.1 + 90.0).titled(title);
    let x = Axis::exact(-90.0, 90.0, 9, "Inclination in the plane of incidence (deg)");
    let panel = Panel { origin: (80.0, 24.0), size: SIZE, x, y: scale.clone() };
    panel.draw(&mut svg);
    let mut entries: Vec<(String, Stroke, bool)> = Vec::new();
    // Points are drawn first, so that lines remain visible on them.
    let in_order =
        figure.curves.iter().filter(|c| c.points).chain(figure.curves.iter().filter(|c| !c.points));
    for curve in in_order {
        let name = curve.name.clone().unwrap_or_else(|| degrees(curve.incidence_deg));
        let known = entries.iter().position(|(known, ..)| *known == name);
        let stroke = known.map_or_else(|| style(figure, curve, entries.len()), |k| entries[k].1.clone());
        draw_curve(&mut svg, &panel, curve, &stroke);
        if known.is_none() {
            entries.push((name, stroke, curve.points));
        }
    }
    legend(&mut svg, &panel, &entries);
    let has_names = figure.curves.iter().any(|curve| curve.name.is_some());
    if has_names {
        name_incidences(&mut svg, &panel, figure);
    } else {
        svg.text((panel.right() + 20.0, 32.0), "Light from", Text::new(SMALL, INK).strong());
    }
    for (k, map) in figure.maps.iter().enumerate() {
        let centre = (maps_left + RADIUS + 30.0 + pitch * k as f64, 60.0 + RADIUS);
        draw_map(&mut svg, map, &scale, centre);
    }
    if !figure.maps.is_empty() {
        let left = maps_left + pitch * figure.maps.len() as f64;
        colour_bar(&mut svg, &scale, (left - 10.0, 60.0), 2.0 * RADIUS, true);
        svg.text((left - 12.0, 46.0), &figure.quantity, Text::new(SMALL, INK));
        if figure.maps.iter().flat_map(|map| &map.values).any(|value| value.is_nan()) {
            let (x, y) = (maps_left + 30.0, 2.0 * RADIUS + 110.0);
            svg.rect((x, y - 10.0), (12.0, 12.0), 0.0, BLANK, "#bbbbbb");
            svg.text((x + 20.0, y), "no light measured", Text::new(SMALL, INK));
        }
    }
    svg.finish()
}

/// Returns the style of a curve that has none yet: colours from dark to light for angles of incidence;
/// distinct colours and dashes for fits, which often coincide.
fn style(figure: &Scattering, curve: &ScatterCurve, number: usize) -> Stroke {
    const FITS: [(&str, f64, &str); 4] =
        [("#c8321f", 3.2, ""), ("#2b5fc7", 2.0, "7 4"), ("#2c9a57", 1.8, "2 3"), ("#8a6d1c", 1.6, "9 3 2 3")];
    match (&curve.name, curve.points) {
        (None, _) => {
            let position = number as f64 / (figure.curves.len().max(2) - 1) as f64;
            Stroke::solid(&ramp(position), 1.8)
        }
        (Some(_), true) => Stroke::solid(INK, 1.0),
        (Some(_), false) => {
            let data = usize::from(figure.curves.iter().any(|curve| curve.points));
            let (colour, width, dash) = FITS[(number - data.min(number)) % FITS.len()];
            Stroke::solid(colour, width).dashed(dash)
        }
    }
}

fn draw_curve(svg: &mut Svg, panel: &Panel, curve: &ScatterCurve, stroke: &Stroke) {
    let shown = curve.values.iter().filter(|(_, value)| *value >= panel.y.min());
    let line: Vec<Point> = shown.map(|(x, y)| panel.at(*x, *y)).collect();
    if curve.points {
        line.iter().for_each(|at| svg.circle(*at, 2.8, "#ffffff", stroke));
    } else {
        svg.polyline(&line, stroke);
    }
}

fn legend(svg: &mut Svg, panel: &Panel, entries: &[(String, Stroke, bool)]) {
    for (k, (name, stroke, points)) in entries.iter().enumerate() {
        let at = (panel.right() + 20.0, 54.0 + 19.0 * k as f64);
        if *points {
            svg.circle((at.0 + 11.0, at.1 - 4.0), 2.8, "#ffffff", stroke);
        } else {
            svg.line((at.0, at.1 - 4.0), (at.0 + 22.0, at.1 - 4.0), stroke);
        }
        svg.text((at.0 + 30.0, at.1), name, Text::new(SMALL, INK));
    }
}

/// Writes each angle of incidence above the peak of its curves.
fn name_incidences(svg: &mut Svg, panel: &Panel, figure: &Scattering) {
    let mut incidences: Vec<f64> = figure.curves.iter().map(|curve| curve.incidence_deg).collect();
    incidences.sort_by(f64::total_cmp);
    incidences.dedup();
    for incidence in incidences {
        let of_it = figure.curves.iter().filter(|curve| curve.incidence_deg == incidence);
        let peak = of_it.flat_map(|curve| &curve.values).max_by(|a, b| a.1.total_cmp(&b.1));
        let Some((x, y)) = peak else { continue };
        let at = panel.at(*x, *y);
        let text = format!("light from {}", degrees(incidence));
        let (away, anchor) = if *x > 8.0 { (10.0, Anchor::Start) } else { (-10.0, Anchor::End) };
        svg.text((at.0 + away, at.1 + 4.0), &text, Text::new(SMALL, INK).anchor(anchor).halo());
    }
}

fn draw_map(svg: &mut Svg, map: &ScatterMap, scale: &Axis, centre: (f64, f64)) {
    let heading = Text::new(13.0, INK).strong().anchor(Anchor::Middle);
    svg.text(
        (centre.0, centre.1 - RADIUS - 26.0),
        &format!("Light from {}", degrees(map.incidence_deg)),
        heading,
    );
    let Some(directions) = Directions::new(&map.theta_deg, &map.phi_deg) else { return };
    let at = Map { centre, radius: RADIUS, scale, labelled: true, contours: true };
    let value = |i: usize, j: usize| map.values.get(i * map.phi_deg.len() + j).copied().unwrap_or(f64::NAN);
    directions.draw(svg, &at, &[], value);
}
