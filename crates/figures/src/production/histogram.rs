//! How a metric scatters, with its limits.

use super::{BAD, Ends, GOOD, PANEL};
use crate::axis::Axis;
use crate::panel::Panel;
use crate::style::{INK, named_with_unit, percent};
use crate::svg::{Anchor, Stroke, Svg, Text};

/// More bins than this are lines.
const MOST_BINS: usize = 200;

/// How a metric scatters, with its limits, which are edges of bins; `None` if it is nowhere defined.
pub fn histogram(metric: &str, values: &[f64], ends: Ends, title: &str) -> Option<String> {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let bins = Bins::of(&sorted, ends)?;
    let shares: Vec<f64> = bins.counts.iter().map(|n| 100.0 * *n as f64 / values.len() as f64).collect();
    let outer = [bins.edge(0), bins.edge(bins.counts.len())];
    let x = Axis::covering(outer.into_iter().chain(ends.all()), 8, &named_with_unit(metric, metric));
    let y = Axis::covering(shares.iter().copied().chain([0.0]), 6, "Displays (%)");
    let panel = Panel { origin: PANEL.0, size: PANEL.1, x, y };
    let mut svg = Svg::new(680.0, 420.0).titled(title);
    panel.draw(&mut svg);
    for (i, share) in shares.iter().enumerate().filter(|(_, share)| **share > 0.0) {
        let (left, right) = (panel.at(bins.edge(i), *share), panel.at(bins.edge(i + 1), 0.0));
        let colour = if ends.meets(bins.middle(i)) { GOOD } else { BAD };
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

/// Bins of one width.
#[derive(Debug)]
struct Bins {
    first: f64,
    width: f64,
    counts: Vec<usize>,
}

impl Bins {
    /// Of ascending values: a bin has good displays or bad ones.
    fn of(sorted: &[f64], ends: Ends) -> Option<Self> {
        let (low, high) = (*sorted.first()?, *sorted.last()?);
        let (edge, width) = aligned([low, high], bin_width(sorted), ends);
        let first = edge + ((low - edge) / width).floor() * width;
        let count = (((high - first) / width).ceil() as usize).clamp(1, MOST_BINS + 2);
        let mut bins = Self { first, width, counts: vec![0; count] };
        for value in sorted {
            let at = bins.holding(*value, ends).min(count - 1);
            bins.counts[at] += 1;
        }
        Some(bins)
    }

    fn edge(&self, at: usize) -> f64 {
        self.first + at as f64 * self.width
    }

    fn middle(&self, at: usize) -> f64 {
        self.first + (at as f64 + 0.5) * self.width
    }

    /// Which bin holds a value: what lies on an edge, or beside it by rounding, is on the side of the limit that it is on.
    fn holding(&self, value: f64, ends: Ends) -> usize {
        let at = ((value - self.first) / self.width) as usize;
        match (ends.meets(value) == ends.meets(self.middle(at)), value > self.middle(at)) {
            (true, _) => at,
            (false, true) => at + 1,
            (false, false) => at.saturating_sub(1),
        }
    }
}

/// An edge of bins and their width, such that limits among the values are edges.
fn aligned([low, high]: [f64; 2], width: f64, ends: Ends) -> (f64, f64) {
    let inside = |end: Option<f64>| end.filter(|end| low < *end && *end < high);
    match (inside(ends.at_least), inside(ends.at_most)) {
        (Some(least), Some(most)) if least < most => {
            let between = (most - least) / ((most - least) / width).round().max(1.0);
            let few = high - low <= MOST_BINS as f64 * between;
            (least, if few { between } else { width })
        }
        (Some(edge), _) | (None, Some(edge)) => (edge, width),
        (None, None) => (low, width),
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Every display is in one bin, and the bins beyond the limits hold those that miss them and no others.
    #[test]
    fn bins_end_at_the_limits() {
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
            let held = |good: bool| -> usize {
                let own =
                    bins.counts.iter().enumerate().filter(|(at, _)| ends.meets(bins.middle(*at)) == good);
                own.map(|(_, count)| *count).sum()
            };
            let good = values.iter().filter(|value| ends.meets(**value)).count();
            assert_eq!((held(true), held(false)), (good, values.len() - good), "{ends:?}");
            for end in ends.all().filter(|end| end.abs() < 1.0) {
                let place = (end - bins.first) / bins.width;
                assert!((place - place.round()).abs() < 1e-9, "{end} is no edge of {bins:?}");
            }
        }
    }
}
