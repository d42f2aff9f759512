//! Curves in one panel: the general figure, for data without a figure of their own.

use crate::axis::{Axis, range};
use crate::labels::{EndLabel, end_labels, labels_inside};
use crate::panel::Panel;
use crate::style::ramp;
use crate::svg::{Point, Stroke, Svg, finite};

/// Curves with common axes.
#[derive(Debug, Clone, PartialEq)]
pub struct Chart {
    /// Title of the x axis, with its unit.
    pub x: String,
    /// Title of the y axis, with its unit.
    pub y: String,
    /// Whether the y axis is logarithmic; values that are not positive are then omitted.
    pub logarithmic: bool,
    /// Values that the y axis always includes.
    pub at_least: Vec<f64>,
    /// The curves.
    pub curves: Vec<ChartCurve>,
}

/// A curve of a [`Chart`].
#[derive(Debug, Clone, PartialEq)]
pub struct ChartCurve {
    /// Label at the end of the curve; empty: no label.
    pub name: String,
    /// Colour of the curve.
    pub hue: Hue,
    /// Whether the curve is dashed: a reference for comparison.
    pub dashed: bool,
    /// Whether the curve is drawn as points instead of a line.
    pub marks: bool,
    /// Points of the curve; a point that is not finite interrupts it.
    pub points: Vec<(f64, f64)>,
}

/// Colour of a curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Hue {
    /// A position, 0 to 1, on a scale from dark to light.
    Scale(f64),
    /// One of six colours that are easily distinguished.
    Group(usize),
    /// Grey, for curves in the background.
    Grey,
}

/// The panel, px.
const PANEL: (Point, Point) = ((76.0, 24.0), (470.0, 330.0));

impl Hue {
    fn colour(self) -> String {
        const GROUPS: [&str; 6] = ["#c8321f", "#2c9a57", "#2b5fc7", "#333333", "#8a6d1c", "#7a5bc0"];
        match self {
            Self::Scale(position) => ramp(position),
            Self::Grey => "#b8b8b8".to_owned(),
            Self::Group(group) => GROUPS[group % GROUPS.len()].to_owned(),
        }
    }
}

/// Draws a chart.
pub fn chart(chart: &Chart, title: &str) -> String {
    let mut svg = Svg::new(700.0, 420.0).titled(title);
    let points = || chart.curves.iter().flat_map(|curve| curve.points.iter().copied());
    let x = Axis::between(&ends(points().map(|point| point.0)), 7, &chart.x);
    let values = points().map(|point| point.1).chain(chart.at_least.iter().copied());
    let y = if chart.logarithmic {
        let positive = values.filter(|value| (1e-300..1e300).contains(value));
        let decades = range(positive).and_then(|(low, high)| Axis::decades(low, high, &chart.y));
        let Some(axis) = decades else { return svg.finish() };
        axis
    } else {
        Axis::covering(values, 6, &chart.y)
    };
    let panel = Panel { origin: PANEL.0, size: PANEL.1, x, y };
    panel.draw(&mut svg);
    let lines: Vec<Vec<Point>> = chart
        .curves
        .iter()
        .map(|curve| curve.points.iter().map(|(x, y)| panel.at(*x, *y)).collect())
        .collect();
    let (mut outside, mut inside) = (vec![], vec![]);
    for (curve, line) in chart.curves.iter().zip(&lines) {
        let stroke = Stroke::solid(&curve.hue.colour(), 1.8).dashed(if curve.dashed { "6 3" } else { "" });
        for piece in line.split(|point| !finite(*point)) {
            if curve.marks {
                piece.iter().for_each(|point| svg.circle(*point, 2.4, "#ffffff", &stroke));
            } else {
                svg.polyline(piece, &stroke);
            }
        }
        if curve.name.is_empty() {
            continue;
        }
        let Some(end) = line.iter().rev().copied().find(|point| finite(*point)) else { continue };
        let label = EndLabel { end, text: curve.name.clone(), stroke, marks: curve.marks };
        if (end.0 - panel.right()).abs() < 2.0 { outside.push(label) } else { inside.push(label) }
    }
    end_labels(&mut svg, &panel, outside);
    let borrowed: Vec<&[Point]> = lines.iter().map(Vec::as_slice).collect();
    labels_inside(&mut svg, &panel, &inside, &borrowed);
    svg.finish()
}

/// Returns the smallest and the largest value, if there are any.
fn ends(values: impl Iterator<Item = f64>) -> Vec<f64> {
    range(values.filter(|value| value.is_finite())).map_or_else(Vec::new, |(low, high)| vec![low, high])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unusual_data_give_well_formed_figure() {
        for points in [vec![], vec![(f64::NAN, 1.0)], vec![(0.0, -1.0), (1.0, 0.0), (2.0, f64::INFINITY)]] {
            for logarithmic in [false, true] {
                let curve = ChartCurve {
                    name: "<a>".to_owned(),
                    hue: Hue::Group(9),
                    dashed: true,
                    marks: logarithmic,
                    points: points.clone(),
                };
                let text = chart(
                    &Chart {
                        x: "x".to_owned(),
                        y: "y".to_owned(),
                        logarithmic,
                        at_least: vec![],
                        curves: vec![curve],
                    },
                    "t",
                );
                assert!(text.ends_with("</svg>\n") && !text.contains("NaN") && !text.contains("<a>"));
            }
        }
    }
}
