//! A metric over one or two swept keys: curves, and a map.

use crate::axis::{Axis, range};
use crate::colour_map::viridis;
use crate::labels::{EndLabel, end_labels, labels_inside};
use crate::panel::{Panel, SMALL};
use crate::polar::colour_bar;
use crate::style::INK;
use crate::svg::{Anchor, Point, Stroke, Svg, Text, finite, shortened};

/// A swept axis: what it is called, and its values as they are written.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepAxis {
    /// Its key, or its keys.
    pub name: String,
    /// A text for each value; if all are numbers, they are places on a scale.
    pub values: Vec<String>,
}

/// A metric at all points of two axes.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepFigure {
    /// What is drawn.
    pub metric: String,
    /// Left to right.
    pub x: SweepAxis,
    /// One curve for each value, or bottom to top in a map; of one axis alone: `None`.
    pub y: Option<SweepAxis>,
    /// Values and standard errors: those of all x for the first y, and so on; NaN where not defined.
    pub values: Vec<(f64, f64)>,
}

impl SweepAxis {
    /// The values as numbers, if they are; otherwise their places in the list.
    fn places(&self) -> Vec<f64> {
        self.numbers().unwrap_or_else(|| (0..self.values.len()).map(|i| i as f64).collect())
    }

    fn numbers(&self) -> Option<Vec<f64>> {
        let numbers = self.values.iter().map(|text| text.parse::<f64>().ok().filter(|v| v.is_finite()));
        numbers.collect()
    }

    fn axis(&self) -> Axis {
        match self.numbers() {
            Some(numbers) => Axis::covering(numbers, 7, &self.name),
            None => {
                let short: Vec<String> = self.values.iter().map(|v| shortened(v, 84.0, SMALL)).collect();
                Axis::of_names(&short, 6, &self.name)
            }
        }
    }
}

/// Values are drawn on a logarithmic axis where the largest is more than so many times the smallest.
const WIDE: f64 = 30.0;
/// The panel, px.
const PANEL: (Point, Point) = ((76.0, 24.0), (470.0, 330.0));

/// Curves over x, one for each y.
pub fn sweep_curves(figure: &SweepFigure, title: &str) -> String {
    let all: Vec<f64> = figure.values.iter().map(|(value, _)| *value).collect();
    let y = Axis::logarithmic_beyond(WIDE, &all, &figure.metric)
        .unwrap_or_else(|| Axis::covering(all, 6, &figure.metric));
    let panel = Panel { origin: PANEL.0, size: PANEL.1, x: figure.x.axis(), y };
    let mut svg = Svg::new(700.0, 420.0).titled(title);
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
        // The curve's end is where x is largest, whichever way it was swept.
        let end = line.iter().copied().filter(|p| finite(*p)).max_by(|a, b| a.0.total_cmp(&b.0));
        let (Some(end), Some(name), true) = (end, names.get(i), figure.y.is_some()) else { continue };
        let label = EndLabel { end, text: name.clone(), stroke };
        let last = x.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        if (end.0 - panel.at(last, panel.y.min()).0).abs() < 0.5 {
            outside.push(label)
        } else {
            inside.push(label)
        }
    }
    if let Some(y) = &figure.y {
        let heading = Text::new(SMALL - 1.0, "#777777");
        svg.text(
            (panel.right() + 16.0, panel.origin.1 - 12.0),
            &shortened(&y.name, 136.0, SMALL - 1.0),
            heading,
        );
    }
    if barred {
        panel.note(&mut svg, "bars: \u{b1} one standard error");
    }
    end_labels(&mut svg, &panel, outside);
    let borrowed: Vec<&[Point]> = lines.iter().map(Vec::as_slice).collect();
    labels_inside(&mut svg, &panel, &inside, &borrowed);
    svg.finish()
}

/// A map over both axes; `None` if there is but one, or nothing to map.
pub fn sweep_map(figure: &SweepFigure, title: &str) -> Option<String> {
    let y = figure.y.as_ref()?;
    let values: Vec<f64> = figure.values.iter().map(|(value, _)| *value).collect();
    range(values.iter().copied().filter(|v| v.is_finite()))?;
    let scale = Axis::logarithmic_beyond(WIDE, &values, "")
        .unwrap_or_else(|| Axis::covering(values.iter().copied(), 6, ""));
    let (across, up) = (Cells::of(&figure.x), Cells::of(y));
    let panel = Panel { origin: PANEL.0, size: PANEL.1, x: across.axis.clone(), y: up.axis.clone() };
    let mut svg = Svg::new(700.0, 420.0).titled(title);
    // The cells cover the lines of its grid.
    panel.draw(&mut svg);
    for (k, value) in values.iter().enumerate().filter(|(_, value)| value.is_finite()) {
        let (i, j) = (k % figure.x.values.len(), k / figure.x.values.len());
        let ((left, right), (low, high)) = (across.edges[i], up.edges[j]);
        let (from, to) = (panel.at(left, low), panel.at(right, high));
        // A little larger than it is, so that no seam shows.
        let size = ((to.0 - from.0).abs() + 0.4, (from.1 - to.1).abs() + 0.4);
        svg.rect((from.0.min(to.0), from.1.min(to.1)), size, 0.0, &viridis(scale.share(*value)), "");
    }
    colour_bar(&mut svg, &scale, (panel.right() + 24.0, panel.origin.1), panel.size.1, true);
    let name = Text::new(SMALL, INK).anchor(Anchor::Middle).upright();
    svg.text((panel.right() + 92.0, panel.origin.1 + panel.size.1 / 2.0), &figure.metric, name);
    Some(svg.finish())
}

/// Where the cells of an axis begin and end: halfway between neighbours.
struct Cells {
    axis: Axis,
    edges: Vec<(f64, f64)>,
}

impl Cells {
    fn of(of: &SweepAxis) -> Self {
        let places = of.places();
        let mut order: Vec<usize> = (0..places.len()).collect();
        order.sort_by(|a, b| places[*a].total_cmp(&places[*b]));
        let sorted: Vec<f64> = order.iter().map(|i| places[*i]).collect();
        let half = |i: usize| 0.5 * (sorted[i + 1] - sorted[i]);
        let last = sorted.len().saturating_sub(1);
        let mut edges = vec![(0.0, 0.0); places.len()];
        for (k, place) in order.iter().enumerate() {
            // At the ends as wide outwards as inwards; a cell that is alone has a width of its own.
            let below = if k > 0 {
                half(k - 1)
            } else if last > 0 {
                half(0)
            } else {
                0.5
            };
            let above = if k < last { half(k) } else { below };
            edges[*place] = (sorted[k] - below, sorted[k] + above);
        }
        let ends = range(edges.iter().flat_map(|(low, high)| [*low, *high])).unwrap_or((0.0, 1.0));
        let axis = match of.numbers() {
            Some(_) => Axis::exact(ends.0, ends.1, 7, &of.name),
            None => of.axis(),
        };
        Self { axis, edges }
    }
}

/// Colours along a scale: neighbouring values look alike.
fn hue(i: usize, count: usize) -> String {
    if count == 1 {
        return INK.to_owned();
    }
    // The lightest end is hard to see on white.
    viridis(0.85 * i as f64 / (count - 1) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(name: &str, values: &[&str]) -> SweepAxis {
        SweepAxis { name: name.to_owned(), values: values.iter().map(|&v| v.to_owned()).collect() }
    }

    #[test]
    fn cells_meet_halfway_whichever_way_they_are_swept() {
        let cells = Cells::of(&axis("haze", &["3", "1", "0"]));
        assert_eq!(cells.edges, [(2.0, 4.0), (0.5, 2.0), (-0.5, 0.5)]);
    }

    #[test]
    fn anything_can_be_drawn() {
        let nan = (f64::NAN, f64::NAN);
        for (x, values) in [
            (axis("a", &["1"]), vec![(1.0, 0.0); 2]),
            (axis("a", &["SiO2", "<air>"]), vec![(0.5, 0.1), nan, nan, nan]),
            (axis("a", &["1", "1"]), vec![nan; 4]),
        ] {
            let figure = SweepFigure { metric: "Y".to_owned(), x, y: Some(axis("b", &["2", "3"])), values };
            let curves = sweep_curves(&figure, "<t>");
            let map = sweep_map(&figure, "<t>");
            for svg in std::iter::once(curves).chain(map) {
                assert!(svg.ends_with("</svg>\n") && !svg.contains("NaN") && !svg.contains("<t>"), "{svg}");
            }
        }
    }
}
