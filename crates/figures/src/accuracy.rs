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

/// Curves that share their axes.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorPanel {
    /// What more accuracy takes, with its unit.
    pub x: String,
    /// Logarithmic: a power is a straight line. Else an exponential is one.
    pub powers: bool,
    /// The curves.
    pub curves: Vec<ErrorCurve>,
}

/// From one panel to the next, px: room for names included.
const PITCH: f64 = 600.0;
/// Of a panel, px.
const SIZE: Point = (380.0, 400.0);

/// Relative errors, on a logarithmic scale, against what they take; panels side by side.
pub fn accuracy(panels: &[ErrorPanel], title: &str) -> String {
    let mut svg = Svg::new(PITCH * panels.len() as f64, SIZE.1 + 80.0).titled(title);
    for (i, panel) in panels.iter().enumerate() {
        draw(&mut svg, panel, PITCH * i as f64 + 80.0);
    }
    svg.finish()
}

fn draw(svg: &mut Svg, panel: &ErrorPanel, left: f64) {
    let points = || panel.curves.iter().flat_map(drawn);
    let logarithmic = |values: Vec<f64>, title: &str| {
        range(values.into_iter()).and_then(|(low, high)| Axis::decades(low, high, title))
    };
    let across: Vec<f64> = points().map(|point| point.0).collect();
    let x = if panel.powers {
        logarithmic(across, &format!("{} (logarithmic)", panel.x))
    } else {
        Some(Axis::covering(across, 6, &panel.x))
    };
    let y = logarithmic(points().map(|point| point.1).collect(), "Relative error (logarithmic)");
    let (Some(x), Some(y)) = (x, y) else { return };
    let axes = Panel { origin: (left, 24.0), size: SIZE, x, y };
    axes.draw(svg);
    let labels = panel.curves.iter().filter_map(|curve| draw_curve(svg, &axes, curve)).collect();
    end_labels(svg, &axes, labels);
}

fn draw_curve(svg: &mut Svg, axes: &Panel, curve: &ErrorCurve) -> Option<EndLabel> {
    let colour = hue(curve.group);
    let stroke = Stroke::solid(colour, 2.0).dashed(if curve.dashed { "6 4" } else { "" });
    let line: Vec<Point> = drawn(curve).map(|(x, y)| axes.at(x, y)).collect();
    svg.polyline(&line, &stroke);
    let fill = if curve.dashed { "#ffffff" } else { colour };
    line.iter().for_each(|point| svg.circle(*point, 3.2, fill, &Stroke::solid(colour, 1.4)));
    line.last().map(|end| EndLabel { end: *end, text: curve.name.clone(), stroke })
}

fn hue(group: usize) -> &'static str {
    const HUES: [&str; 5] = ["#c8321f", "#2b5fc7", "#2c9a57", "#8a6d1c", "#7a5bc0"];
    HUES[group % HUES.len()]
}

fn drawn(curve: &ErrorCurve) -> impl Iterator<Item = (f64, f64)> {
    let positive = |value: f64| (1e-300..1e300).contains(&value);
    curve.points.iter().copied().filter(move |(x, y)| positive(*x) && positive(*y))
}
