//! Bar chart of the Sobol indices of keys.

use crate::axis::Axis;
use crate::overlay::legend;
use crate::panel::{Panel, SMALL};
use crate::style::INK;
use crate::svg::{Anchor, Stroke, Svg, Text, shortened, text_width};

/// Colours of first-order and total-order indices.
const FIRST: &str = "#5b8fc4";
const TOTAL: &str = "#c3d7ea";
/// Least and largest width of the names of groups, which is that of the longest, height of the row of a group
/// and width of the panel, px.
const NAMES: [f64; 2] = [190.0, 480.0];
const ROW: f64 = 22.0;
const WIDTH: f64 = 420.0;
/// Distance between the panels of two metrics, px.
const GAP: f64 = 54.0;

/// Sobol indices of a group of keys: fractions of the variance of a metric, each with its standard error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SensitivityBar {
    /// First-order index: the fraction that the group causes alone.
    pub first: [f64; 2],
    /// Total-order index: the fraction that the group causes alone or together with others.
    pub total: [f64; 2],
}

/// Draws bars of first-order and total-order indices with their standard errors, in a panel for each metric.
/// `indices[metric][group]` is `None` where a metric does not vary. Returns `None` if no metric varies.
pub fn sensitivities(
    metrics: &[String],
    groups: &[String],
    indices: &[Vec<Option<SensitivityBar>>],
    title: &str,
) -> Option<String> {
    let drawn: Vec<(&String, &Vec<Option<SensitivityBar>>)> =
        metrics.iter().zip(indices).filter(|(_, of_metric)| of_metric.iter().any(Option::is_some)).collect();
    let block = ROW * groups.len() as f64;
    if drawn.is_empty() {
        return None;
    }
    let longest = groups.iter().map(|group| text_width(group, SMALL)).fold(0.0, f64::max);
    let names = (longest + 20.0).clamp(NAMES[0], NAMES[1]);
    let height = drawn.len() as f64 * (block + GAP) + 90.0;
    let mut svg = Svg::new(names + WIDTH + 60.0, height).titled(title);
    for (number, (metric, of_metric)) in drawn.iter().enumerate() {
        let last = number + 1 == drawn.len();
        let x = Axis::exact(0.0, 1.0, 5, if last { "Fraction of the variance" } else { "" });
        let panel = Panel {
            origin: (names, 66.0 + number as f64 * (block + GAP)),
            size: (WIDTH, block),
            x,
            y: Axis::marked((0.0, 1.0), vec![], "", false),
        };
        panel.draw(&mut svg);
        svg.text((names, panel.origin.1 - 7.0), metric, Text::new(SMALL, INK).strong());
        for (k, (group, indices)) in groups.iter().zip(of_metric.iter()).enumerate() {
            row(&mut svg, &panel, panel.origin.1 + ROW * (k as f64 + 0.5), group, *indices);
        }
    }
    let entries = [("first-order", Stroke::solid(FIRST, 8.0)), ("total-order", Stroke::solid(TOTAL, 8.0))];
    legend(&mut svg, entries.into_iter().chain([("\u{b1} one standard error", Stroke::solid(INK, 1.0))]));
    Some(svg.finish())
}

/// Draws both bars of a group, one above the other.
fn row(svg: &mut Svg, panel: &Panel, middle: f64, group: &str, indices: Option<SensitivityBar>) {
    const BAR: f64 = 8.0;
    let left = panel.origin.0;
    let name = Text::new(SMALL, INK).anchor(Anchor::End);
    svg.text((left - 8.0, middle + 4.0), &shortened(group, left - 16.0, SMALL), name);
    let Some(indices) = indices else { return };
    for (colour, top, [value, error]) in
        [(FIRST, middle - BAR - 0.5, indices.first), (TOTAL, middle + 0.5, indices.total)]
    {
        let end = panel.at(value.clamp(0.0, 1.0), 0.0).0;
        svg.rect((left, top), ((end - left).max(0.0), BAR), 0.0, colour, "");
        let height = (panel.bottom() - top - 0.5 * BAR) / panel.size.1;
        panel.error_bar_across(svg, (value, height), error, &Stroke::solid(INK, 1.0));
    }
}
