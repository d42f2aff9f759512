//! Which keys the variance comes from.

use crate::axis::Axis;
use crate::overlay::legend;
use crate::panel::{Panel, SMALL};
use crate::style::INK;
use crate::svg::{Anchor, Stroke, Svg, Text, shortened};

/// First-order and total indices.
const FIRST: &str = "#5b8fc4";
const TOTAL: &str = "#c3d7ea";
/// The names of groups, the rows of a group and the panel, px.
const NAME: f64 = 190.0;
const ROW: f64 = 22.0;
const WIDTH: f64 = 420.0;
/// Between the panels of two metrics, px.
const APART: f64 = 54.0;

/// How much of a metric's variance comes from a group of keys, each with its standard error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Blame {
    /// By itself.
    pub first: [f64; 2],
    /// With others.
    pub total: [f64; 2],
}

/// Bars of first-order and total indices with their standard errors, a panel for each metric; `blame[metric][group]`,
/// `None` where a metric does not scatter.
pub fn sensitivities(
    metrics: &[String],
    groups: &[String],
    blame: &[Vec<Option<Blame>>],
    title: &str,
) -> Option<String> {
    let drawn: Vec<(&String, &Vec<Option<Blame>>)> =
        metrics.iter().zip(blame).filter(|(_, of)| of.iter().any(Option::is_some)).collect();
    let block = ROW * groups.len() as f64;
    if drawn.is_empty() {
        return None;
    }
    let height = drawn.len() as f64 * (block + APART) + 90.0;
    let mut svg = Svg::new(NAME + WIDTH + 60.0, height).titled(title);
    for (number, (metric, of)) in drawn.iter().enumerate() {
        let last = number + 1 == drawn.len();
        let x = Axis::exact(0.0, 1.0, 5, if last { "Share of the variance" } else { "" });
        let panel = Panel {
            origin: (NAME, 66.0 + number as f64 * (block + APART)),
            size: (WIDTH, block),
            x,
            y: Axis::marked((0.0, 1.0), vec![], "", false),
        };
        panel.draw(&mut svg);
        svg.text((NAME, panel.origin.1 - 7.0), metric, Text::new(SMALL, INK).strong());
        for (k, (group, blame)) in groups.iter().zip(of.iter()).enumerate() {
            row(&mut svg, &panel, panel.origin.1 + ROW * (k as f64 + 0.5), group, *blame);
        }
    }
    let both = [("by itself", Stroke::solid(FIRST, 8.0)), ("with others", Stroke::solid(TOTAL, 8.0))];
    legend(&mut svg, both.into_iter().chain([("\u{b1} one standard error", Stroke::solid(INK, 1.0))]));
    Some(svg.finish())
}

/// Both bars of a group, one above the other.
fn row(svg: &mut Svg, panel: &Panel, middle: f64, group: &str, blame: Option<Blame>) {
    const BAR: f64 = 8.0;
    let name = Text::new(SMALL, INK).anchor(Anchor::End);
    svg.text((NAME - 8.0, middle + 4.0), &shortened(group, NAME - 16.0, SMALL), name);
    let Some(blame) = blame else { return };
    for (colour, top, [value, error]) in
        [(FIRST, middle - BAR - 0.5, blame.first), (TOTAL, middle + 0.5, blame.total)]
    {
        let end = panel.at(value.clamp(0.0, 1.0), 0.0).0;
        svg.rect((NAME, top), ((end - NAME).max(0.0), BAR), 0.0, colour, "");
        let height = (panel.bottom() - top - 0.5 * BAR) / panel.size.1;
        panel.error_bar_across(svg, (value, height), error, &Stroke::solid(INK, 1.0));
    }
}
