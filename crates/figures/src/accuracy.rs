//! Errors of the solvers against their cost or their resolution.

use crate::axis::{Axis, range};
use crate::labels::{EndLabel, end_labels};
use crate::panel::Panel;
use crate::svg::{Point, Stroke, Svg};

/// Errors of one method at increasing cost or resolution.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorCurve {
    /// Label at the end of the curve.
    pub name: String,
    /// Curves of one group have the same colour.
    pub group: usize,
    /// Whether the curve is dashed: a reference for comparison.
    pub dashed: bool,
    /// Cost or resolution, and relative error. Values that are not positive are omitted.
    pub points: Vec<(f64, f64)>,
}

/// Curves with common axes.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorPanel {
    /// Title of the x axis (cost or resolution), with its unit.
    pub x: String,
    /// Whether the x axis is logarithmic, so that a power law is a straight line. Otherwise an exponential is
    /// one.
    pub powers: bool,
    /// The curves.
    pub curves: Vec<ErrorCurve>,
}

/// Distance from one panel to the next, px, including space for labels.
const PITCH: f64 = 600.0;
/// Size of a panel, px.
const SIZE: Point = (380.0, 400.0);

/// Draws relative errors, on a logarithmic scale, against cost or resolution, with the panels side by side.
pub fn accuracy(panels: &[ErrorPanel], title: &str) -> String {
    let mut svg = Svg::new(PITCH * panels.len() as f64, SIZE.1 + 80.0).titled(title);
    for (i, panel) in panels.iter().enumerate() {
        draw(&mut svg, panel, PITCH * i as f64 + 80.0);
    }
    svg.finish()
}

fn draw(svg: &mut Svg, panel: &ErrorPanel, left: f64) {
    let points = || panel.curves.iter().flat_map(positive_points);
    let logarithmic = |values: Vec<f64>, title: &str| {
        range(values.into_iter()).and_then(|(low, high)| Axis::decades(low, high, title))
    };
    let across: Vec<f64> = points().map(|point| point.0).collect();
    let x =
        if panel.powers { logarithmic(across, &panel.x) } else { Some(Axis::covering(across, 6, &panel.x)) };
    let y = logarithmic(points().map(|point| point.1).collect(), "Relative error");
    let (Some(x), Some(y)) = (x, y) else { return };
    let axes = Panel { origin: (left, 24.0), size: SIZE, x, y };
    axes.draw(svg);
    let labels = panel.curves.iter().filter_map(|curve| draw_curve(svg, &axes, curve)).collect();
    end_labels(svg, &axes, labels);
}

fn draw_curve(svg: &mut Svg, axes: &Panel, curve: &ErrorCurve) -> Option<EndLabel> {
    let colour = group_colour(curve.group);
    let stroke = Stroke::solid(colour, 2.0).dashed(if curve.dashed { "6 4" } else { "" });
    let line: Vec<Point> = positive_points(curve).map(|(x, y)| axes.at(x, y)).collect();
    svg.polyline(&line, &stroke);
    let fill = if curve.dashed { "#ffffff" } else { colour };
    line.iter().for_each(|point| svg.circle(*point, 3.2, fill, &Stroke::solid(colour, 1.4)));
    line.last().map(|end| EndLabel { end: *end, text: curve.name.clone(), stroke, marks: false })
}

fn group_colour(group: usize) -> &'static str {
    const HUES: [&str; 5] = ["#c8321f", "#2b5fc7", "#2c9a57", "#8a6d1c", "#7a5bc0"];
    HUES[group % HUES.len()]
}

fn positive_points(curve: &ErrorCurve) -> impl Iterator<Item = (f64, f64)> {
    let positive = |value: f64| (1e-300..1e300).contains(&value);
    curve.points.iter().copied().filter(move |(x, y)| positive(*x) && positive(*y))
}
