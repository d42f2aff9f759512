//! What production makes of a design: how metrics scatter, which keys are to blame, where the bad displays lie.

use crate::axis::Axis;
use crate::overlay::legend;
use crate::panel::{Panel, SMALL};
use crate::style::{INK, percent};
use crate::svg::{Anchor, Point, Stroke, Svg, Text, finite, shortened};

/// Displays that meet the limits, and those that do not.
const GOOD: &str = "#4c78a8";
const BAD: &str = "#c8321f";
/// First-order and total indices.
const FIRST: &str = "#2f5d8a";
const TOTAL: &str = "#b7cde3";
/// The panel, px.
const PANEL: (Point, Point) = ((96.0, 24.0), (540.0, 330.0));
/// More marks than this are a blot.
const MOST_MARKS: usize = 3000;

/// What a metric has to meet.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Ends {
    /// No less.
    pub at_least: Option<f64>,
    /// No more.
    pub at_most: Option<f64>,
}

/// How much of a metric's variance comes from a group of keys, each with its standard error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Blame {
    /// By itself.
    pub first: [f64; 2],
    /// With others.
    pub total: [f64; 2],
}

impl Ends {
    /// Whether a value does; what is undefined does not.
    pub fn meets(&self, value: f64) -> bool {
        self.at_least.is_none_or(|least| value >= least) && self.at_most.is_none_or(|most| value <= most)
    }

    fn all(&self) -> impl Iterator<Item = f64> {
        self.at_least.into_iter().chain(self.at_most)
    }
}

/// How a metric scatters, with its limits; `None` if it is nowhere defined.
pub fn histogram(metric: &str, values: &[f64], ends: Ends, title: &str) -> Option<String> {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let (low, high) = (*sorted.first()?, *sorted.last()?);
    let width = bin_width(&sorted);
    let count = (((high - low) / width).ceil() as usize).clamp(1, 200);
    let mut bins = vec![0_usize; count];
    for value in &sorted {
        bins[(((value - low) / width) as usize).min(count - 1)] += 1;
    }
    let shares: Vec<f64> = bins.iter().map(|n| 100.0 * *n as f64 / values.len() as f64).collect();
    let x = Axis::covering([low, high].into_iter().chain(ends.all()), 8, metric);
    let y = Axis::covering(shares.iter().copied().chain([0.0]), 6, "displays, %");
    let panel = Panel { origin: PANEL.0, size: PANEL.1, x, y };
    let mut svg = Svg::new(680.0, 420.0).titled(title);
    panel.draw(&mut svg);
    for (i, share) in shares.iter().enumerate().filter(|(_, share)| **share > 0.0) {
        let from = low + i as f64 * width;
        let to = (from + width).min(high.max(low + width));
        let (left, right) = (panel.at(from, *share), panel.at(to, 0.0));
        let colour = if ends.meets(0.5 * (from + to)) { GOOD } else { BAD };
        let size = ((right.0 - left.0 - 0.6).max(0.4), right.1 - left.1);
        svg.rect(left, size, 0.0, colour, "");
    }
    limits(&mut svg, &panel, ends);
    let failing = values.iter().filter(|value| !ends.meets(**value) || value.is_nan()).count() as f64;
    if ends != Ends::default() {
        let (share, _) = percent(failing / values.len().max(1) as f64, 0.0);
        panel.note(&mut svg, &format!("{share} % beyond the limits"));
    }
    Some(svg.finish())
}

/// The width of bins by the rule of Freedman and Diaconis (1981).
fn bin_width(sorted: &[f64]) -> f64 {
    let last = sorted.len() - 1;
    let spread = sorted[last] - sorted[0];
    let quartiles = sorted[3 * last / 4] - sorted[last / 4];
    let width = 2.0 * quartiles / (sorted.len() as f64).cbrt();
    // Metrics that hardly scatter, or that most displays share, have one bin or a few.
    let width = if width > 0.0 { width.max(spread / 100.0) } else { spread / 20.0 };
    if width > 0.0 { width } else { sorted[0].abs().max(1.0) * 1e-3 }
}

/// Lines where the limits of the x axis are.
fn limits(svg: &mut Svg, panel: &Panel, ends: Ends) {
    let named = [(ends.at_least, "at least", Anchor::Start), (ends.at_most, "at most", Anchor::End)];
    for (value, name, anchor) in named {
        let Some(value) = value else { continue };
        let x = panel.at(value, panel.y.min()).0;
        svg.line((x, panel.origin.1), (x, panel.bottom()), &Stroke::solid(INK, 1.4).dashed("5 3"));
        let away = if matches!(anchor, Anchor::Start) { 5.0 } else { -5.0 };
        let text = format!("{name} {value}");
        svg.text((x + away, panel.origin.1 + 12.0), &text, Text::new(11.0, INK).anchor(anchor).halo());
    }
}

/// Bars of first-order and total indices, a row of bars for each metric; `blame[metric][group]`, `None` where a metric
/// does not scatter.
pub fn sensitivities(
    metrics: &[String],
    groups: &[String],
    blame: &[Vec<Option<Blame>>],
    title: &str,
) -> Option<String> {
    const NAME: f64 = 190.0;
    const BAR: f64 = 17.0;
    const WIDTH: f64 = 420.0;
    let drawn: Vec<(&String, &Vec<Option<Blame>>)> =
        metrics.iter().zip(blame).filter(|(_, of)| of.iter().any(Option::is_some)).collect();
    let block = BAR * groups.len() as f64;
    let height = drawn.len() as f64 * (block + 54.0);
    if drawn.is_empty() {
        return None;
    }
    let mut svg = Svg::new(NAME + WIDTH + 60.0, height + 70.0).titled(title);
    for (row, (metric, of)) in drawn.iter().enumerate() {
        let origin = (NAME, 66.0 + row as f64 * (block + 54.0));
        let x = Axis::exact(0.0, 1.0, 5, "");
        let panel = Panel { origin, size: (WIDTH, block), x, y: Axis::marked((0.0, 1.0), vec![], "", false) };
        panel.draw(&mut svg);
        svg.text((NAME, origin.1 - 7.0), metric, Text::new(SMALL, INK).strong());
        for (k, (group, blame)) in groups.iter().zip(of.iter()).enumerate() {
            let middle = origin.1 + BAR * (k as f64 + 0.5);
            let name = Text::new(SMALL, INK).anchor(Anchor::End);
            svg.text((NAME - 8.0, middle + 4.0), &shortened(group, NAME - 16.0, SMALL), name);
            let Some(blame) = blame else { continue };
            for (colour, half, [value, error]) in [(TOTAL, 6.0, blame.total), (FIRST, 3.0, blame.first)] {
                let at = |value: f64| panel.at(value.clamp(0.0, 1.0), 0.0).0;
                svg.rect((NAME, middle - half), ((at(value) - NAME).max(0.0), 2.0 * half), 0.0, colour, "");
                if colour == TOTAL {
                    let height = 1.0 - (middle - origin.1) / block;
                    panel.error_bar_across(&mut svg, (value, height), error, &Stroke::solid(INK, 1.0));
                }
            }
        }
    }
    legend(
        &mut svg,
        [("by itself", Stroke::solid(FIRST, 6.0)), ("with others", Stroke::solid(TOTAL, 12.0))].into_iter(),
    );
    Some(svg.finish())
}

/// Where the good and the bad displays lie on two keys: `points` are the values of both, and whether the display meets
/// all limits.
pub fn good_and_bad(keys: [&str; 2], points: &[([f64; 2], bool)], title: &str) -> String {
    let along = |k: usize| points.iter().map(move |(at, _)| at[k]);
    let x = Axis::covering(along(0), 8, keys[0]);
    let y = Axis::covering(along(1), 6, keys[1]);
    // Below the legend.
    let origin = (PANEL.0.0, PANEL.0.1 + 24.0);
    let panel = Panel { origin, size: PANEL.1, x, y };
    let mut svg = Svg::new(680.0, 444.0).titled(title);
    panel.draw(&mut svg);
    // The bad ones are few, mostly: they come last.
    let shown = &points[..points.len().min(MOST_MARKS)];
    for wanted in [true, false] {
        for (at, _) in shown.iter().filter(|(_, good)| *good == wanted) {
            let at = panel.at(at[0], at[1]);
            if finite(at) {
                let (colour, radius) = if wanted { (GOOD, 1.6) } else { (BAD, 2.2) };
                svg.circle(at, radius, colour, &Stroke::solid("none", 0.0));
            }
        }
    }
    if points.len() > shown.len() {
        panel.note(&mut svg, &format!("the first {MOST_MARKS} of {} displays", points.len()));
    }
    legend(
        &mut svg,
        [("meets all limits", Stroke::solid(GOOD, 5.0)), ("does not", Stroke::solid(BAD, 5.0))].into_iter(),
    );
    svg.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sound(svg: &str) {
        assert!(svg.ends_with("</svg>\n") && !svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    }

    #[test]
    fn anything_can_be_drawn() {
        let ends = Ends { at_least: Some(1.0), at_most: None };
        for values in
            [vec![1.0], vec![1.0; 50], vec![f64::NAN, 2.0, 1e300], (0..500).map(f64::from).collect()]
        {
            sound(&histogram("<Y>", &values, ends, "<t>").unwrap());
        }
        assert!(histogram("Y", &[f64::NAN], ends, "t").is_none());
        let blame = Blame { first: [-0.1, 0.3], total: [1.4, f64::NAN] };
        let groups = ["a".to_owned(), "b".to_owned()];
        sound(&sensitivities(&["Y".to_owned()], &groups, &[vec![Some(blame), None]], "t").unwrap());
        assert!(sensitivities(&["Y".to_owned()], &groups, &[vec![None, None]], "t").is_none());
        sound(&good_and_bad(["a", "b"], &[([1.0, f64::NAN], true), ([1.0, 2.0], false)], "t"));
    }

    /// Every display is in one bar.
    #[test]
    fn bins_hold_all() {
        let values: Vec<f64> = (0..1000).map(|i| (f64::from(i) * 0.7).sin()).collect();
        let width = bin_width(&{
            let mut sorted = values.clone();
            sorted.sort_by(f64::total_cmp);
            sorted
        });
        assert!((0.02..0.4).contains(&width), "{width}");
    }
}
