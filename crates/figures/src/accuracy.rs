//! Errors of solvers: against what they cost, and against how finely they resolve.

use crate::axis::{Axis, range};
use crate::labels::{EndLabel, end_labels};
use crate::panel::Panel;
use crate::svg::{Point, Stroke, Svg};

/// Errors along one road to more accuracy.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorCurve {
    /// What stands at its end.
    pub name: String,
    /// Curves of one group share their colour.
    pub group: usize,
    /// Dashed: what is compared with.
    pub dashed: bool,
    /// Cost or fineness, and relative error: what is not positive is left out.
    pub points: Vec<(f64, f64)>,
}

/// Room to the right of a panel for names, px.
const NAMES: f64 = 160.0;
/// Of a panel, px.
const SIZE: Point = (470.0, 400.0);

/// Two panels of relative errors: against seconds, both logarithmic, where a power of the cost
/// is a straight line; and against nodes, where an exponential is one.
pub fn accuracy(against_seconds: &[ErrorCurve], against_nodes: &[ErrorCurve], title: &str) -> String {
    let pitch = SIZE.0 + NAMES + 90.0;
    let mut svg = Svg::new(2.0 * pitch, SIZE.1 + 90.0).titled(title);
    if let Some((low, high)) = range(points(against_seconds).map(|point| point.0))
        && let Some(x) = Axis::decades(low, high, "Seconds on one core (logarithmic)")
    {
        draw(&mut svg, against_seconds, x, 80.0);
    }
    let nodes = Axis::covering(points(against_nodes).map(|point| point.0).chain([0.0]), 6, "Nodes");
    draw(&mut svg, against_nodes, nodes, 80.0 + pitch);
    svg.finish()
}

fn draw(svg: &mut Svg, curves: &[ErrorCurve], x: Axis, left: f64) {
    let Some((low, high)) = range(points(curves).map(|point| point.1)) else { return };
    let Some(y) = Axis::decades(low, high, "Relative error (logarithmic)") else { return };
    let panel = Panel { origin: (left, 24.0), size: SIZE, x, y };
    panel.draw(svg);
    let mut labels = Vec::new();
    for curve in curves {
        let stroke = Stroke::solid(hue(curve.group), 2.0).dashed(if curve.dashed { "6 4" } else { "" });
        let line: Vec<Point> = drawn(curve).map(|(x, y)| panel.at(x, y)).collect();
        svg.polyline(&line, &stroke);
        let fill = if curve.dashed { "#ffffff" } else { hue(curve.group) };
        line.iter().for_each(|point| svg.circle(*point, 3.2, fill, &Stroke::solid(hue(curve.group), 1.4)));
        if let Some(&end) = line.last() {
            labels.push(EndLabel { end, text: curve.name.clone(), stroke });
        }
    }
    end_labels(svg, &panel, labels);
}

fn hue(group: usize) -> &'static str {
    const HUES: [&str; 5] = ["#c8321f", "#2b5fc7", "#2c9a57", "#8a6d1c", "#7a5bc0"];
    HUES[group % HUES.len()]
}

fn drawn(curve: &ErrorCurve) -> impl Iterator<Item = (f64, f64)> {
    let positive = |value: f64| (1e-300..1e300).contains(&value);
    curve.points.iter().copied().filter(move |(x, y)| positive(*x) && positive(*y))
}

fn points(curves: &[ErrorCurve]) -> impl Iterator<Item = (f64, f64)> {
    curves.iter().flat_map(drawn)
}
