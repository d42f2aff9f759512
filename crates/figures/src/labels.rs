//! Labels at the ends of curves.

use crate::panel::{Panel, SMALL};
use crate::place::Places;
use crate::style::{INK, SOFT};
use crate::svg::{Point, Stroke, Svg, Text, shortened};

/// Height of a line, px.
const SPACING: f64 = 17.0;
/// Largest width of a label, px.
const MAX_WIDTH: f64 = 106.0;
/// Largest vertical extent of a leader line, px; a steeper leader does not help the reader.
const MAX_RISE: f64 = 30.0;

/// The label of a curve, at its end.
#[derive(Debug)]
pub(crate) struct EndLabel {
    /// Last point of the curve on the page.
    pub(crate) end: Point,
    /// Name of the curve.
    pub(crate) text: String,
    /// Line style of the curve.
    pub(crate) stroke: Stroke,
    /// Whether the curve is drawn as points.
    pub(crate) marks: bool,
}

/// Draws the labels to the right of a panel, at heights such that they do not overlap.
///
/// If many curves end close together, the leader lines would be too steep. The labels then form
/// a legend in the order of `labels`.
pub(crate) fn end_labels(svg: &mut Svg, panel: &Panel, mut labels: Vec<EndLabel>) {
    labels.retain(|label| label.end.1.is_finite());
    let mut sorted: Vec<usize> = (0..labels.len()).collect();
    sorted.sort_by(|a, b| labels[*a].end.1.total_cmp(&labels[*b].end.1));
    let wanted: Vec<f64> = sorted.iter().map(|label| labels[*label].end.1).collect();
    let spread = spread(&wanted, SPACING, panel.origin.1 - 4.0, panel.bottom());
    let crowded = wanted.iter().zip(&spread).any(|(wanted, height)| (wanted - height).abs() > MAX_RISE);
    let mut heights = vec![0.0; labels.len()];
    sorted.iter().zip(spread).for_each(|(label, height)| heights[*label] = height);
    for (i, (label, height)) in labels.iter().zip(heights).enumerate() {
        let to = panel.right() + 16.0;
        let height = if crowded { panel.origin.1 + 8.0 + SPACING * i as f64 } else { height };
        if !crowded {
            svg.line((label.end.0 + 3.0, label.end.1), (to, height), &Stroke::solid(SOFT, 0.8));
        }
        if label.marks {
            svg.circle((to + 11.0, height), 2.4, "#ffffff", &label.stroke);
        } else {
            svg.line((to, height), (to + 22.0, height), &label.stroke);
        }
        svg.text((to + 27.0, height + 4.0), &shortened(&label.text, MAX_WIDTH, SMALL), Text::new(SMALL, INK));
    }
}

/// Draws the labels of curves that end inside a panel next to these ends, in the colours of the curves and
/// clear of all `lines`.
pub(crate) fn labels_inside(svg: &mut Svg, panel: &Panel, labels: &[EndLabel], lines: &[&[Point]]) {
    let ends = labels.iter().map(|label| label.end);
    let mut places = Places::around(panel.origin, panel.size, ends);
    lines.iter().for_each(|line| places.avoid(line));
    for label in labels {
        let name = shortened(&label.text, MAX_WIDTH, SMALL);
        let place = places.find(label.end, &name, SMALL);
        place.write(svg, &name, Text::new(SMALL, &label.stroke.colour));
    }
}

/// Returns ascending heights at least `spacing` apart, close to those wanted, and between two bounds if they
/// fit.
fn spread(wanted: &[f64], spacing: f64, top: f64, bottom: f64) -> Vec<f64> {
    let mut heights: Vec<f64> = wanted.to_vec();
    for i in 1..heights.len() {
        heights[i] = heights[i].max(heights[i - 1] + spacing);
    }
    let mut limit = bottom;
    for height in heights.iter_mut().rev() {
        *height = height.min(limit);
        limit = *height - spacing;
    }
    let overflow = heights.first().map_or(0.0, |first| (top - first).max(0.0));
    heights.iter().map(|height| height + overflow).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn close_labels_are_spread_without_overlap() {
        let heights = spread(&[10.0, 11.0, 95.0, 99.0], 17.0, 0.0, 100.0);
        assert!(heights.windows(2).all(|pair| pair[1] - pair[0] >= 17.0 - 1e-9), "{heights:?}");
        assert!(heights[0] >= 0.0 && heights[3] <= 100.0);
    }
}
