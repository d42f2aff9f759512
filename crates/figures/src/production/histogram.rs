//! Histogram of a metric, with its limits.

use super::{BAD, Ends, GOOD, PANEL};
use crate::axis::Axis;
use crate::panel::Panel;
use crate::style::{INK, percent};
use crate::svg::{Anchor, Stroke, Svg, Text};

/// Largest number of bins; more would be too narrow to see.
const MAX_BINS: usize = 200;

/// Draws the histogram of a metric (its label) with its limits, which are edges of bins. Returns `None` if no
/// value is defined.
pub fn histogram(metric: &str, values: &[f64], ends: Ends, title: &str) -> Option<String> {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let bins = Bins::of(&sorted, ends)?;
    let percentages: Vec<f64> = bins.counts.iter().map(|n| 100.0 * *n as f64 / values.len() as f64).collect();
    let outer = [bins.edge(0), bins.edge(bins.counts.len())];
    let x = Axis::covering(outer.into_iter().chain(ends.all()), 8, metric);
    let y = Axis::covering(percentages.iter().copied().chain([0.0]), 6, "Displays (%)");
    let panel = Panel { origin: PANEL.0, size: PANEL.1, x, y };
    let mut svg = Svg::new(680.0, 420.0).titled(title);
    panel.draw(&mut svg);
    for (i, percentage) in percentages.iter().enumerate().filter(|(_, percentage)| **percentage > 0.0) {
        let (left, right) = (panel.at(bins.edge(i), *percentage), panel.at(bins.edge(i + 1), 0.0));
        let colour = if ends.meets(bins.middle(i)) { GOOD } else { BAD };
        let size = ((right.0 - left.0 - 0.6).max(0.4), right.1 - left.1);
        svg.rect(left, size, 0.0, colour, "");
    }
    limits(&mut svg, &panel, ends);
    let failing = values.iter().filter(|value| !ends.meets(**value) || value.is_nan()).count() as f64;
    if ends != Ends::default() {
        let (percentage, _) = percent(failing / values.len().max(1) as f64, 0.0);
        panel.note(&mut svg, &format!("{percentage} % outside the limits"));
    }
    Some(svg.finish())
}

/// Bins of equal width.
#[derive(Debug)]
struct Bins {
    first: f64,
    width: f64,
    counts: Vec<usize>,
}

impl Bins {
    /// Sorts ascending values into bins. A bin holds only displays that meet the limits, or only displays
    /// that do not.
    fn of(sorted: &[f64], ends: Ends) -> Option<Self> {
        let (low, high) = (*sorted.first()?, *sorted.last()?);
        let (edge, width) = aligned([low, high], bin_width(sorted), ends);
        let first = edge + ((low - edge) / width).floor() * width;
        let count = (((high - first) / width).ceil() as usize).clamp(1, MAX_BINS + 2);
        let mut bins = Self { first, width, counts: vec![0; count] };
        for value in sorted {
            let at = bins.holding(*value, ends).min(count - 1);
            bins.counts[at] += 1;
        }
        Some(bins)
    }

    fn edge(&self, index: usize) -> f64 {
        self.first + index as f64 * self.width
    }

    fn middle(&self, index: usize) -> f64 {
        self.first + (index as f64 + 0.5) * self.width
    }

    /// Returns the index of the bin of a value. A value that rounding places on the wrong side of a limit is
    /// moved to the right side.
    fn holding(&self, value: f64, ends: Ends) -> usize {
        let index = ((value - self.first) / self.width) as usize;
        match (ends.meets(value) == ends.meets(self.middle(index)), value > self.middle(index)) {
            (true, _) => index,
            (false, true) => index + 1,
            (false, false) => index.saturating_sub(1),
        }
    }
}

/// Returns an edge of the bins and their width, such that limits within the range of the values are edges.
fn aligned([low, high]: [f64; 2], width: f64, ends: Ends) -> (f64, f64) {
    let inside = |end: Option<f64>| end.filter(|end| low < *end && *end < high);
    match (inside(ends.at_least), inside(ends.at_most)) {
        (Some(least), Some(most)) if least < most => {
            let between = (most - least) / ((most - least) / width).round().max(1.0);
            let few = high - low <= MAX_BINS as f64 * between;
            (least, if few { between } else { width })
        }
        (Some(edge), _) | (None, Some(edge)) => (edge, width),
        (None, None) => (low, width),
    }
}

/// Returns the width of the bins by the rule of Freedman and Diaconis (1981).
fn bin_width(sorted: &[f64]) -> f64 {
    let last = sorted.len() - 1;
    let spread = sorted[last] - sorted[0];
    let quartiles = sorted[3 * last / 4] - sorted[last / 4];
    let width = 2.0 * quartiles / (sorted.len() as f64).cbrt();
    // Metrics that hardly vary, or that are equal for most displays, have one bin or a few.
    let width = if width > 0.0 { width.max(spread / 100.0) } else { spread / 20.0 };
    if width > 0.0 { width } else { sorted[0].abs().max(1.0) * 1e-3 }
}

/// Draws lines at the limits on the x axis.
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Every display is in exactly one bin, and the bins outside the limits hold exactly the displays that
    /// miss them.
    #[test]
    fn limits_are_edges_of_bins() {
        let mut values: Vec<f64> = (0..1000).map(|i| (f64::from(i) * 0.7).sin()).collect();
        values.extend([-0.3, 0.1, 0.6, 0.62]);
        values.sort_by(f64::total_cmp);
        for (at_least, at_most) in [
            (None, None),
            (Some(0.1), None),
            (None, Some(0.62)),
            (Some(-0.3), Some(0.6)),
            (Some(-0.3), Some(1.7)),
            (Some(-20.0), Some(0.6)),
            (Some(-9.0), Some(9.0)),
        ] {
            let ends = Ends { at_least, at_most };
            let bins = Bins::of(&values, ends).unwrap();
            assert!((0.02..0.4).contains(&bins.width), "{bins:?}");
            let counted = |good: bool| -> usize {
                let own =
                    bins.counts.iter().enumerate().filter(|(at, _)| ends.meets(bins.middle(*at)) == good);
                own.map(|(_, count)| *count).sum()
            };
            let good = values.iter().filter(|value| ends.meets(**value)).count();
            assert_eq!((counted(true), counted(false)), (good, values.len() - good), "{ends:?}");
            for end in ends.all().filter(|end| end.abs() < 1.0) {
                let place = (end - bins.first) / bins.width;
                assert!((place - place.round()).abs() < 1e-9, "{end} is not an edge of {bins:?}");
            }
        }
    }
}
