//! A metric over one or two swept keys, as curves and as a map.

mod axes;
mod of_sweep;
mod scale;

pub use of_sweep::of_sweep;

use papilio_display::uncapitalised;

use self::scale::{Cells, Side};
use crate::axis::{Axis, range};
use crate::colour_map::viridis;
use crate::labels::{EndLabel, end_labels, labels_inside};
use crate::panel::{Panel, SMALL};
use crate::polar::colour_bar;
use crate::style::INK;
use crate::svg::{Anchor, Point, Stroke, Svg, Text, finite, shortened};

/// A swept axis: its name, and its values as texts.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepAxis {
    /// Quantity and unit in words.
    pub name: String,
    /// A text for each value; if all are numbers, they are drawn on a scale.
    pub values: Vec<String>,
}

/// A metric at all points of two axes.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepFigure {
    /// Metric and unit in words.
    pub metric: String,
    /// Horizontal axis.
    pub x: SweepAxis,
    /// Vertical axis of a map, or one curve for each value; `None` for a sweep of one axis.
    pub y: Option<SweepAxis>,
    /// Range of the colours of a map, if maps are to be compared; otherwise the range of its values.
    pub colours: Option<[f64; 2]>,
    /// Values and standard errors, x fastest; NaN where not defined.
    pub values: Vec<(f64, f64)>,
}

/// Ratio of the largest to the smallest value above which the axis is logarithmic.
const WIDE: f64 = 30.0;
/// Largest width of the heading of the curves, px.
const HEADING: f64 = 600.0;
/// The panel, px.
const PANEL: (Point, Point) = ((96.0, 24.0), (470.0, 330.0));

/// Draws curves over x, one for each y.
pub fn sweep_curves(figure: &SweepFigure, title: &str) -> String {
    let all: Vec<f64> = figure.values.iter().map(|(value, _)| *value).collect();
    let y = Axis::logarithmic_beyond(WIDE, &all, &figure.metric)
        .unwrap_or_else(|| Axis::covering(all, 6, &figure.metric));
    let panel = Panel { origin: PANEL.0, size: PANEL.1, x: figure.x.axis(), y };
    let mut svg = Svg::new(720.0, 420.0).titled(title);
    panel.draw(&mut svg);
    let x = figure.x.places();
    let names: Vec<String> =
        figure.y.as_ref().map_or_else(|| vec![figure.metric.clone()], |y| y.values.clone());
    let curves: Vec<&[(f64, f64)]> = figure.values.chunks(x.len().max(1)).collect();
    let lines: Vec<Vec<Point>> = curves
        .iter()
        .map(|curve| x.iter().zip(*curve).map(|(x, (value, _))| panel.at(*x, *value)).collect())
        .collect();
    let (mut outside, mut inside, mut barred) = (vec![], vec![], false);
    for (i, (curve, line)) in curves.iter().zip(&lines).enumerate() {
        let stroke = Stroke::solid(&hue(i, curves.len()), 2.0);
        for piece in line.split(|point| !finite(*point)) {
            svg.polyline(piece, &stroke);
        }
        if line.len() <= 40 {
            let drawn = line.iter().filter(|point| finite(**point));
            drawn.for_each(|point| svg.circle(*point, 2.6, &stroke.colour, &Stroke::solid("#ffffff", 0.8)));
        }
        let (values, errors): (Vec<f64>, Vec<f64>) = curve.iter().copied().unzip();
        barred |= panel.error_bars(&mut svg, &x, &values, &errors, &stroke);
        // The label is at the largest x, in whatever order it was swept.
        let end = line.iter().copied().filter(|p| finite(*p)).max_by(|a, b| a.0.total_cmp(&b.0));
        let (Some(end), Some(name), true) = (end, names.get(i), figure.y.is_some()) else { continue };
        let label = EndLabel { end, text: name.clone(), stroke, marks: false };
        let last = x.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        if (end.0 - panel.at(last, panel.y.min()).0).abs() < 0.5 {
            outside.push(label)
        } else {
            inside.push(label)
        }
    }
    if let Some(y) = &figure.y {
        let heading = Text::new(SMALL - 1.0, "#777777").anchor(Anchor::End);
        let name = format!("Curves: {}", uncapitalised(&y.name));
        svg.text((704.0, panel.origin.1 - 12.0), &shortened(&name, HEADING, SMALL - 1.0), heading);
    }
    if barred {
        // On the left: the heading of the curves is on the right.
        let style = Text::new(SMALL - 1.0, "#777777").halo();
        svg.text((panel.origin.0 + 4.0, panel.origin.1 + 10.0), "bars: \u{b1} one standard error", style);
    }
    end_labels(&mut svg, &panel, outside);
    let borrowed: Vec<&[Point]> = lines.iter().map(Vec::as_slice).collect();
    labels_inside(&mut svg, &panel, &inside, &borrowed);
    svg.finish()
}

/// Draws a map over both axes. Returns `None` if there is only one axis, or no value is defined.
pub fn sweep_map(figure: &SweepFigure, title: &str) -> Option<String> {
    let y = figure.y.as_ref()?;
    let values: Vec<f64> = figure.values.iter().map(|(value, _)| *value).collect();
    range(values.iter().copied().filter(|v| v.is_finite()))?;
    let scale = match figure.colours {
        Some([from, to]) => Axis::exact(from, to, 6, ""),
        None => Axis::logarithmic_beyond(WIDE, &values, "")
            .unwrap_or_else(|| Axis::covering(values.iter().copied(), 6, "")),
    };
    let (across, up) = (Cells::of(&figure.x, Side::Below(PANEL.1.0)), Cells::of(y, Side::Left(PANEL.1.1)));
    let panel = Panel { origin: PANEL.0, size: PANEL.1, x: across.axis.clone(), y: up.axis.clone() };
    let mut svg = Svg::new(720.0, 420.0).titled(title);
    // The cells cover the grid lines.
    panel.draw(&mut svg);
    for (k, value) in values.iter().enumerate().filter(|(_, value)| value.is_finite()) {
        let (i, j) = (k % figure.x.values.len(), k / figure.x.values.len());
        let ((left, right), (low, high)) = (across.edges[i], up.edges[j]);
        let (from, to) = (panel.at(left, low), panel.at(right, high));
        // Slightly larger than the cell, to avoid visible seams.
        let size = ((to.0 - from.0).abs() + 0.4, (from.1 - to.1).abs() + 0.4);
        svg.rect((from.0.min(to.0), from.1.min(to.1)), size, 0.0, &viridis(scale.fraction(*value)), "");
    }
    let mark = Stroke::solid(INK, 0.8);
    for (value, _) in panel.y.ticks() {
        let height = panel.at(panel.x.min(), *value).1;
        svg.line((panel.origin.0 - 4.0, height), (panel.origin.0, height), &mark);
    }
    if values.iter().any(|value| !value.is_finite()) {
        panel.note(&mut svg, "empty: undefined");
    }
    colour_bar(&mut svg, &scale, (panel.right() + 24.0, panel.origin.1), panel.size.1, true);
    let name = Text::new(SMALL, INK).anchor(Anchor::Middle).upright();
    svg.text((panel.right() + 92.0, panel.origin.1 + panel.size.1 / 2.0), &figure.metric, name);
    Some(svg.finish())
}

/// Returns colours along a scale, similar for neighbouring values.
fn hue(i: usize, count: usize) -> String {
    if count == 1 {
        return INK.to_owned();
    }
    // The lightest colours of the map are hard to see on white.
    viridis(0.85 * i as f64 / (count - 1) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(name: &str, values: &[&str]) -> SweepAxis {
        SweepAxis { name: name.to_owned(), values: values.iter().map(|&v| v.to_owned()).collect() }
    }

    #[test]
    fn unusual_data_give_well_formed_figures() {
        let nan = (f64::NAN, f64::NAN);
        for (x, values) in [
            (axis("a", &["1"]), vec![(1.0, 0.0); 2]),
            (axis("a", &["SiO2", "<air>"]), vec![(0.5, 0.1), nan, nan, nan]),
            (axis("a", &["1", "1"]), vec![nan; 4]),
        ] {
            let y = Some(axis("b", &["2", "3"]));
            let figure = SweepFigure { metric: "Y".to_owned(), x, y, colours: None, values };
            let curves = sweep_curves(&figure, "<t>");
            let map = sweep_map(&figure, "<t>");
            for svg in std::iter::once(curves).chain(map) {
                assert!(svg.ends_with("</svg>\n") && !svg.contains("NaN") && !svg.contains("<t>"), "{svg}");
            }
        }
    }
}
