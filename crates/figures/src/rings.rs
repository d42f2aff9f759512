//! Gamut rings: the gamut volume in CIELAB as areas in a plane (IDMS 1.1).

use std::f64::consts::TAU;

use papilio_colour::{CORNERS, Corners, HUES, RINGS, Xy, Xyz};
use papilio_display::result::{ReferenceWhite, RunResult, View};

use crate::axis::{Axis, range};
use crate::panel::{Panel, SMALL};
use crate::style::{INK, caption, ramp};
use crate::svg::{Anchor, Point, Stroke, Svg, Text};

/// The panel, px.
const ORIGIN: Point = (80.0, 44.0);
const SIDE: f64 = 480.0;
/// Difference of the areas of two rings that coincide, relative to the largest ring.
const SAME: f64 = 0.004;

/// Draws the gamut rings of a view whose gamut volume was requested. The area within each ring, in each hue,
/// is the volume below the lightness of the ring. Returns `None` if the result has no volume.
pub fn gamut_rings(result: &RunResult, view: &View, title: &str) -> Option<String> {
    let volume = view.metrics.gamut_volume_cielab.filter(|volume| volume.is_finite())?;
    let white = match result.reference_white {
        ReferenceWhite::Perfect => {
            Xy { x: result.illuminant.x, y: result.illuminant.y }.with_luminance(1.0)?
        }
        ReferenceWhite::Display => {
            let white = &view.states.get("white")?.value;
            Xyz { x: white.X, y: white.Y, z: white.Z }
        }
    };
    let mut corners = Corners { xyz: [white; 8] };
    for (corner, name) in corners.xyz.iter_mut().zip(CORNERS) {
        let value = &view.states.get(name)?.value;
        *corner = Xyz { x: value.X, y: value.Y, z: value.Z };
    }
    let rings = corners.solid(white)?.rings();
    let outlines: Vec<Vec<Point>> = rings.iter().map(|ring| outline(ring)).collect();
    // A square around the largest ring, which contains the others.
    let along = |of: fn(&Point) -> f64| outlines.iter().flatten().map(of).chain([0.0]);
    let [x, y] = [along(|point| point.0).collect::<Vec<_>>(), along(|point| point.1).collect()]
        .map(|values| range(values.into_iter().filter(|v| v.is_finite())).unwrap_or((-1.0, 1.0)));
    let half = 0.54 * (x.1 - x.0).max(y.1 - y.0).max(1.0);
    let axis = |(low, high): (f64, f64), title| {
        let middle = 0.5 * (low + high);
        Axis::exact(middle - half, middle + half, 6, title)
    };
    let mut svg = Svg::new(ORIGIN.0 + SIDE + 130.0, ORIGIN.1 + SIDE + 70.0).titled(&caption(title, view));
    let panel = Panel {
        origin: ORIGIN,
        size: (SIDE, SIDE),
        x: axis(x, "Ring coordinate towards a*"),
        y: axis(y, "Ring coordinate towards b*"),
    };
    panel.draw(&mut svg);
    let distinct = distinct(&rings);
    for (place, (k, last)) in distinct.iter().rev().enumerate() {
        let position = *k as f64 / distinct.last().map_or(1.0, |(last, _)| *last as f64).max(1.0);
        let stroke = Stroke::solid(&ramp(position), if place == 0 { 2.4 } else { 1.4 });
        svg.outline(&outlines[*k].iter().map(|(x, y)| panel.at(*x, *y)).collect::<Vec<_>>(), &stroke);
        let y = ORIGIN.1 + 14.0 + 18.0 * place as f64;
        let left = panel.right() + 16.0;
        svg.line((left, y - 4.0), (left + 24.0, y - 4.0), &stroke);
        let lightness = |ring: usize| (ring + 1) * 100 / RINGS;
        let name = if last > k {
            format!("L* {} to {}", lightness(*k), lightness(*last))
        } else {
            format!("L* {}", lightness(*k))
        };
        svg.text((left + 30.0, y), &name, Text::new(SMALL, INK));
    }
    let note = format!("gamut volume {volume:.0}; that of sRGB: 819000");
    svg.text((panel.right(), ORIGIN.1 - 8.0), &note, Text::new(SMALL, INK).anchor(Anchor::End));
    Some(svg.finish())
}

/// Returns the points of a ring from its radii.
fn outline(ring: &[f64]) -> Vec<Point> {
    let at = |(hue, radius): (usize, &f64)| {
        let (sin, cos) = (TAU * (hue as f64 + 0.5) / HUES as f64).sin_cos();
        (radius * cos, radius * sin)
    };
    ring.iter().enumerate().map(at).collect()
}

/// Returns the rings that can be distinguished: each with the last of those that coincide with it.
fn distinct<R: AsRef<[f64]>>(rings: &[R]) -> Vec<(usize, usize)> {
    let area = |k: usize| rings[k].as_ref().iter().map(|radius| radius * radius).sum::<f64>();
    let total = rings.len().checked_sub(1).map_or(0.0, area);
    let mut found: Vec<(usize, usize)> = Vec::new();
    for k in 0..rings.len() {
        match found.last_mut() {
            Some((first, last)) if area(k) - area(*first) <= SAME * total => *last = k,
            _ => found.push((k, k)),
        }
    }
    found
}
