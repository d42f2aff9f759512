//! Axes and the panel between them.

use crate::style::{FAINT, INK, SOFT};
use crate::svg::{Anchor, Point, Stroke, Svg, Text, shortened};

/// Size of tick labels and titles, px.
pub(crate) const SMALL: f64 = 12.0;

/// A linear axis with round ticks.
#[derive(Debug, Clone)]
pub(crate) struct Axis {
    min: f64,
    max: f64,
    ticks: Vec<f64>,
    decimals: usize,
    title: String,
}

impl Axis {
    /// From `min` to `max` as they stand, with about `count` ticks.
    pub(crate) fn exact(min: f64, max: f64, count: usize, title: &str) -> Self {
        let step = round_step((max - min) / count.max(1) as f64);
        let first = (min / step - 1e-9).ceil();
        let ticks = (0..=2 * count).map(|i| (first + i as f64) * step);
        let ticks = ticks.take_while(|tick| *tick <= max + 1e-9 * step).collect();
        let decimals = (-step.log10().floor()).clamp(0.0, 12.0) as usize;
        Self { min, max, ticks, decimals, title: title.to_owned() }
    }

    /// Widened to the ticks around all `values` (those that are finite).
    pub(crate) fn covering(values: impl IntoIterator<Item = f64>, count: usize, title: &str) -> Self {
        let (mut min, mut max) = (f64::INFINITY, f64::NEG_INFINITY);
        for value in values.into_iter().filter(|v| v.is_finite()) {
            (min, max) = (min.min(value), max.max(value));
        }
        if min > max {
            (min, max) = (0.0, 1.0);
        }
        if max - min <= 1e-9 * max.abs().max(min.abs()) {
            let margin = if max == 0.0 { 1.0 } else { 0.1 * max.abs() };
            (min, max) = (min - margin, max + margin);
        }
        let step = round_step((max - min) / count.max(1) as f64);
        let (low, high) = ((min / step + 1e-9).floor() * step, (max / step - 1e-9).ceil() * step);
        Self::exact(low, high, ((high - low) / step).round() as usize, title)
    }

    /// From the first to the last of ascending `values`.
    pub(crate) fn between(values: &[f64], count: usize, title: &str) -> Self {
        match values {
            [first, .., last] if last - first > 0.0 && (last - first).is_finite() => {
                Self::exact(*first, *last, count, title)
            }
            _ => Self::covering(values.iter().copied(), count, title),
        }
    }

    fn label(&self, tick: f64) -> String {
        // Never "-0".
        format!("{:.*}", self.decimals, if tick.abs() < 1e-12 { 0.0 } else { tick })
    }

    fn share(&self, value: f64) -> f64 {
        (value - self.min) / (self.max - self.min)
    }
}

/// 1, 2 or 5 times a power of ten, at least `step`.
fn round_step(step: f64) -> f64 {
    let decade = 10.0_f64.powf(step.log10().floor());
    let mantissa = step / decade;
    let round = [1.0, 2.0, 5.0].into_iter().find(|r| mantissa <= r * (1.0 + 1e-9));
    decade * round.unwrap_or(10.0)
}

/// A rectangle of the page with an axis each way.
#[derive(Debug, Clone)]
pub(crate) struct Panel {
    /// Top left corner, px.
    pub(crate) origin: Point,
    /// Width and height, px.
    pub(crate) size: Point,
    /// Left to right.
    pub(crate) x: Axis,
    /// Bottom to top.
    pub(crate) y: Axis,
}

impl Panel {
    /// Right edge, px.
    pub(crate) fn right(&self) -> f64 {
        self.origin.0 + self.size.0
    }

    /// Bottom edge, px.
    pub(crate) fn bottom(&self) -> f64 {
        self.origin.1 + self.size.1
    }

    /// Where the data point (x, y) lies on the page.
    pub(crate) fn at(&self, x: f64, y: f64) -> Point {
        (self.origin.0 + self.size.0 * self.x.share(x), self.bottom() - self.size.1 * self.y.share(y))
    }

    /// Many data points.
    pub(crate) fn points(&self, x: &[f64], y: &[f64]) -> Vec<Point> {
        x.iter().zip(y).map(|(&x, &y)| self.at(x, y)).collect()
    }

    /// Grid lines, ticks and titles.
    pub(crate) fn draw(&self, svg: &mut Svg) {
        let (grid, axis) = (Stroke::solid(FAINT, 1.0), Stroke::solid(SOFT, 1.0));
        let label = Text::new(SMALL, INK);
        for &tick in &self.x.ticks {
            let x = self.at(tick, self.y.min).0;
            svg.line((x, self.origin.1), (x, self.bottom()), &grid);
            svg.line((x, self.bottom()), (x, self.bottom() + 4.0), &axis);
            let anchored = label.anchor(Anchor::Middle);
            svg.text((x, self.bottom() + 17.0), &self.x.label(tick), anchored);
        }
        for &tick in &self.y.ticks {
            let y = self.at(self.x.min, tick).1;
            svg.line((self.origin.0, y), (self.right(), y), &grid);
            svg.text((self.origin.0 - 7.0, y + 4.0), &self.y.label(tick), label.anchor(Anchor::End));
        }
        svg.line((self.origin.0, self.bottom()), (self.right(), self.bottom()), &axis);
        if self.y.min < 0.0 && self.y.max > 0.0 {
            let zero = self.at(self.x.min, 0.0).1;
            svg.line((self.origin.0, zero), (self.right(), zero), &axis);
        }
        let title = label.anchor(Anchor::Middle);
        svg.text((self.origin.0 + self.size.0 / 2.0, self.bottom() + 37.0), &self.x.title, title);
        let middle = self.origin.1 + self.size.1 / 2.0;
        svg.text((self.origin.0 - 46.0, middle), &self.y.title, title.upright());
    }

    /// A remark in the upper right corner.
    pub(crate) fn note(&self, svg: &mut Svg, text: &str) {
        let style = Text::new(11.0, "#777777").anchor(Anchor::End).halo();
        svg.text((self.right(), self.origin.1 - 6.0), text, style);
    }

    /// Bars of one sigma, where they can be seen; true if any.
    pub(crate) fn error_bars(
        &self,
        svg: &mut Svg,
        x: &[f64],
        y: &[f64],
        error: &[f64],
        stroke: &Stroke,
    ) -> bool {
        let mut any = false;
        let bar = Stroke::solid(&stroke.colour, 1.2);
        for ((&x, &y), &error) in x.iter().zip(y).zip(error) {
            let inside = |(x, y): Point| (x, y.clamp(self.origin.1, self.bottom()));
            let (low, high) = (inside(self.at(x, y - error)), inside(self.at(x, y + error)));
            if low.1 - high.1 > 2.0 {
                any = true;
                svg.line(low, high, &bar);
                for end in [low, high] {
                    svg.line((end.0 - 3.0, end.1), (end.0 + 3.0, end.1), &bar);
                }
            }
        }
        any
    }

    /// A band of one sigma; false (and nothing drawn) where it is nowhere wider than a line.
    pub(crate) fn error_band(
        &self,
        svg: &mut Svg,
        x: &[f64],
        y: &[f64],
        error: &[f64],
        stroke: &Stroke,
    ) -> bool {
        let edge = |sign: f64| {
            let shifted: Vec<f64> = y.iter().zip(error).map(|(y, e)| y + sign * e).collect();
            self.points(x, &shifted)
        };
        let (upper, lower) = (edge(1.0), edge(-1.0));
        let widest = upper.iter().zip(&lower).map(|(u, l)| l.1 - u.1).filter(|w| w.is_finite());
        let wide = widest.fold(0.0, f64::max) > 1.0;
        if wide {
            let around: Vec<Point> = upper.into_iter().chain(lower.into_iter().rev()).collect();
            svg.polygon(&around, &stroke.colour, 0.2);
        }
        wide
    }
}

/// A curve's name at its right end.
#[derive(Debug)]
pub(crate) struct EndLabel {
    /// The curve's last point on the page.
    pub(crate) end: Point,
    /// Its name.
    pub(crate) text: String,
    /// How the curve is drawn.
    pub(crate) stroke: Stroke,
}

/// Names the curves to the right of a panel, spread so that none covers another.
pub(crate) fn end_labels(svg: &mut Svg, panel: &Panel, mut labels: Vec<EndLabel>) {
    const SPACING: f64 = 17.0;
    const ROOM: f64 = 106.0;
    labels.retain(|label| label.end.1.is_finite());
    labels.sort_by(|a, b| a.end.1.total_cmp(&b.end.1));
    let wanted: Vec<f64> = labels.iter().map(|label| label.end.1).collect();
    let heights = spread(&wanted, SPACING, panel.origin.1 - 4.0, panel.bottom());
    for (label, height) in labels.iter().zip(heights) {
        let to = panel.right() + 16.0;
        svg.line((label.end.0 + 3.0, label.end.1), (to, height), &Stroke::solid(SOFT, 0.8));
        svg.line((to, height), (to + 22.0, height), &label.stroke);
        svg.text((to + 27.0, height + 4.0), &shortened(&label.text, ROOM, SMALL), Text::new(SMALL, INK));
    }
}

/// Ascending heights at least `spacing` apart, near those wanted and between two bounds where they fit.
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
    fn ticks_are_round() {
        let axis = Axis::covering([0.013, 0.241], 5, "Y");
        assert_eq!((axis.min, axis.max, axis.decimals), (0.0, 0.25, 2));
        let labels: Vec<String> = axis.ticks.iter().map(|t| axis.label(*t)).collect();
        assert_eq!(labels, ["0.00", "0.05", "0.10", "0.15", "0.20", "0.25"]);
    }

    #[test]
    fn any_data_make_an_axis() {
        for values in
            [vec![], vec![f64::NAN], vec![0.0], vec![3.0, 3.0], vec![-1e-9, 1e12], vec![1e300, -1e300]]
        {
            let axis = Axis::covering(values.clone(), 5, "");
            assert!(
                axis.min < axis.max && axis.ticks.len() > 1 && axis.ticks.len() < 20,
                "{values:?} {axis:?}"
            );
        }
    }

    #[test]
    fn labels_do_not_cover_each_other() {
        let heights = spread(&[10.0, 11.0, 95.0, 99.0], 17.0, 0.0, 100.0);
        assert!(heights.windows(2).all(|pair| pair[1] - pair[0] >= 17.0 - 1e-9), "{heights:?}");
        assert!(heights[0] >= 0.0 && heights[3] <= 100.0);
    }
}
