//! The panel with its two axes.

use crate::axis::Axis;
use crate::style::{FAINT, INK, SOFT};
use crate::svg::{Anchor, Point, Stroke, Svg, Text, text_width};

/// Size of tick labels and titles, px.
pub(crate) const SMALL: f64 = 12.0;

/// A rectangle of the page with a horizontal and a vertical axis.
#[derive(Debug, Clone)]
pub(crate) struct Panel {
    /// Top left corner, px.
    pub(crate) origin: Point,
    /// Width and height, px.
    pub(crate) size: Point,
    /// Horizontal axis.
    pub(crate) x: Axis,
    /// Vertical axis.
    pub(crate) y: Axis,
}

impl Panel {
    /// Returns the position of the right edge, px.
    pub(crate) fn right(&self) -> f64 {
        self.origin.0 + self.size.0
    }

    /// Returns the position of the bottom edge, px.
    pub(crate) fn bottom(&self) -> f64 {
        self.origin.1 + self.size.1
    }

    /// Returns the position of the data point (x, y) on the page.
    pub(crate) fn at(&self, x: f64, y: f64) -> Point {
        (self.origin.0 + self.size.0 * self.x.fraction(x), self.bottom() - self.size.1 * self.y.fraction(y))
    }

    /// Returns the positions of several data points on the page.
    pub(crate) fn points(&self, x: &[f64], y: &[f64]) -> Vec<Point> {
        x.iter().zip(y).map(|(&x, &y)| self.at(x, y)).collect()
    }

    /// Draws grid lines, ticks and titles.
    pub(crate) fn draw(&self, svg: &mut Svg) {
        let (grid, axis) = (Stroke::solid(FAINT, 1.0), Stroke::solid(SOFT, 1.0));
        let label = Text::new(SMALL, INK);
        for (tick, _) in self.x.ticks() {
            let x = self.at(*tick, self.y.min()).0;
            svg.line((x, self.origin.1), (x, self.bottom()), &grid);
            svg.line((x, self.bottom()), (x, self.bottom() + 4.0), &axis);
        }
        for (tick, text) in self.x.labelled(self.size.0, |text| text_width(text, SMALL)) {
            let x = self.at(tick, self.y.min()).0;
            svg.text((x, self.bottom() + 17.0), text, label.anchor(Anchor::Middle));
        }
        for (tick, _) in self.y.ticks() {
            let y = self.at(self.x.min(), *tick).1;
            svg.line((self.origin.0, y), (self.right(), y), &grid);
        }
        for (tick, text) in self.y.labelled(self.size.1, |_| SMALL) {
            let y = self.at(self.x.min(), tick).1;
            svg.text((self.origin.0 - 7.0, y + 4.0), text, label.anchor(Anchor::End));
        }
        svg.line((self.origin.0, self.bottom()), (self.right(), self.bottom()), &axis);
        if self.y.contains(0.0) {
            let zero = self.at(self.x.min(), 0.0).1;
            svg.line((self.origin.0, zero), (self.right(), zero), &axis);
        }
        let title = label.anchor(Anchor::Middle);
        svg.text((self.origin.0 + self.size.0 / 2.0, self.bottom() + 37.0), self.x.title(), title);
        let middle = self.origin.1 + self.size.1 / 2.0;
        let widest = self.y.ticks().iter().map(|(_, text)| text_width(text, SMALL)).fold(0.0, f64::max);
        let away = (widest + 19.0).max(46.0);
        svg.text((self.origin.0 - away, middle), self.y.title(), title.upright());
    }

    /// Writes a note in the upper right corner.
    pub(crate) fn note(&self, svg: &mut Svg, text: &str) {
        let style = Text::new(11.0, "#777777").anchor(Anchor::End).halo();
        svg.text((self.right(), self.origin.1 - 6.0), text, style);
    }

    /// Draws bars of one standard error where they are visible. Returns whether any were drawn.
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

    /// Draws a horizontal error bar at one point.
    pub(crate) fn error_bar_across(&self, svg: &mut Svg, (x, y): Point, error: f64, stroke: &Stroke) {
        let inside = |(x, y): Point| (x.clamp(self.origin.0, self.right()), y);
        let (left, right) = (inside(self.at(x - error, y)), inside(self.at(x + error, y)));
        if right.0 - left.0 > 2.0 {
            svg.line(left, right, stroke);
        }
    }

    /// Draws a triangle.
    pub(crate) fn triangle(&self, svg: &mut Svg, corners: [(f64, f64); 3], stroke: &Stroke) {
        svg.outline(&corners.map(|(x, y)| self.at(x, y)), stroke);
    }

    /// Draws a band of one standard error. Returns false, and draws nothing, if it is not wider than a line
    /// anywhere.
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
