//! Points in the unit square, as in Feng 2012, fig. 4.2.

use crate::axis::Axis;
use crate::panel::Panel;
use crate::style::INK;
use crate::svg::{Stroke, Svg, Text};

/// Side of a panel, and distance from one panel to the next, px.
const SIDE: f64 = 250.0;
const PITCH: f64 = 320.0;

/// Draws a panel for each named set, side by side. Points that are not finite are omitted.
pub fn point_sets(sets: &[(&str, Vec<[f64; 2]>)], title: &str) -> String {
    let mut svg = Svg::new(PITCH * sets.len().max(1) as f64 + 20.0, SIDE + 110.0).titled(title);
    for (i, (name, points)) in sets.iter().enumerate() {
        let axis = |title| Axis::exact(0.0, 1.0, 4, title);
        let y = if i == 0 { axis("v") } else { axis("").untitled() };
        let panel = Panel { origin: (70.0 + PITCH * i as f64, 40.0), size: (SIDE, SIDE), x: axis("u"), y };
        panel.draw(&mut svg);
        svg.text((panel.origin.0, 28.0), name, Text::new(13.0, INK).strong());
        let none = Stroke::solid(INK, 0.0);
        for [u, v] in points.iter().filter(|point| point.iter().all(|c| c.is_finite())) {
            svg.circle(panel.at(*u, *v), 1.8, "#2b5fc7", &none);
        }
    }
    svg.finish()
}
