//! Placement of the names of marks without overlaps.

use crate::style::SOFT;
use crate::svg::{Anchor, Point, Stroke, Svg, Text, finite, text_width};

/// Smallest distance between names on contours, px.
const MARGIN: f64 = 4.0;
/// Distance between names on one line, px, from which on they read as two.
const GAP: f64 = 6.0;

/// Occupied parts of a rectangle of the page: marks, lines, and names already placed.
#[derive(Debug)]
pub(crate) struct Places {
    bounds: Box,
    /// The marks.
    marks: Vec<Point>,
    taken: Vec<Box>,
}

/// Position of a name.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Place {
    at: Point,
    anchor: Anchor,
    /// Leader line from the mark to a name that is not next to it.
    leader: Option<[Point; 2]>,
}

#[derive(Debug, Clone, Copy)]
struct Box {
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
}

impl Box {
    /// Returns the square of side 2 `reach` around a point.
    fn around((x, y): Point, reach: f64) -> Self {
        Self { left: x - reach, right: x + reach, top: y - reach, bottom: y + reach }
    }

    fn of_text((x, y): Point, anchor: Anchor, text: &str, size: f64) -> Self {
        let width = text_width(text, size);
        let left = match anchor {
            Anchor::Start => x,
            Anchor::Middle => x - width / 2.0,
            Anchor::End => x - width,
        };
        Self { left, right: left + width, top: y - size, bottom: y + 2.0 }
    }

    fn widened(&self, by: f64) -> Self {
        let Self { left, right, top, bottom } = *self;
        Self { left: left - by, right: right + by, top: top - by, bottom: bottom + by }
    }

    /// Distance of a point, 0 inside.
    fn distance(&self, (x, y): Point) -> f64 {
        let across = (self.left - x).max(x - self.right).max(0.0);
        across.hypot((self.top - y).max(y - self.bottom).max(0.0))
    }

    fn area(&self) -> f64 {
        (self.right - self.left) * (self.bottom - self.top)
    }

    fn overlap(&self, other: &Self) -> f64 {
        let width = self.right.min(other.right) - self.left.max(other.left);
        let height = self.bottom.min(other.bottom) - self.top.max(other.top);
        width.max(0.0) * height.max(0.0)
    }
}

impl Places {
    /// Returns a rectangle in which only these marks are occupied.
    pub(crate) fn around((left, top): Point, size: Point, marks: impl Iterator<Item = Point>) -> Self {
        let bounds = Box { left, right: left + size.0, top, bottom: top + size.1 };
        let marks: Vec<Point> = marks.filter(|mark| finite(*mark)).collect();
        let taken = marks.iter().map(|mark| Box::around(*mark, 7.0)).collect();
        Self { bounds, marks, taken }
    }

    /// Marks a line as occupied.
    pub(crate) fn avoid(&mut self, line: &[Point]) {
        const STEP: f64 = 4.0;
        for (from, to) in line.iter().zip(line.iter().skip(1)).filter(|(a, b)| finite(**a) && finite(**b)) {
            let (dx, dy) = (to.0 - from.0, to.1 - from.1);
            let steps = (dx.hypot(dy) / STEP).ceil().clamp(1.0, 1e3);
            let fraction = (0..=steps as u32).map(|k| f64::from(k) / steps);
            self.taken.extend(fraction.map(|t| Box::around((from.0 + t * dx, from.1 + t * dy), STEP / 2.0)));
        }
    }

    /// Occupies the place of a text and returns true if the place and a margin around it are free and it lies
    /// within `reach` px of `centre`; otherwise returns false.
    pub(crate) fn take_in_disc(
        &mut self,
        at: Point,
        text: &str,
        size: f64,
        (centre, reach): (Point, f64),
    ) -> bool {
        let wanted = Box::of_text(at, Anchor::Middle, text, size);
        let corner = |x: f64, y: f64| (x - centre.0).hypot(y - centre.1) <= reach;
        let inside = corner(wanted.left, wanted.top)
            && corner(wanted.right, wanted.top)
            && corner(wanted.left, wanted.bottom)
            && corner(wanted.right, wanted.bottom);
        let free = inside && self.taken.iter().all(|taken| taken.overlap(&wanted.widened(MARGIN)) == 0.0);
        if free {
            self.taken.push(wanted);
        }
        free
    }

    /// Finds and occupies the least crowded place for `name` next to its mark or close to it.
    pub(crate) fn find(&mut self, mark: Point, name: &str, size: f64) -> Place {
        let overlap = |wanted: &Box| self.taken.iter().map(|taken| taken.overlap(wanted)).sum::<f64>();
        let crowding = |place: &Place| {
            let wanted = Box::of_text(place.at, place.anchor, name, size);
            let outside = wanted.area() - wanted.overlap(&self.bounds);
            // A name that is slightly too close to another is better than one far from its mark.
            let leader = place.leader.map_or(0.0, |[from, to]| {
                let tip = Box::around(to, 2.0);
                2.0 * (to.0 - from.0).hypot(to.1 - from.1) + 8.0 * overlap(&tip)
            });
            overlap(&wanted) + 4.0 * outside + leader + self.confusion(mark, place, &wanted)
        };
        // Of equal candidates the first is used: they are in order of preference.
        let (mut best, mut least) = (adjacent(mark)[0], f64::INFINITY);
        for place in adjacent(mark)
            .into_iter()
            .chain([26.0, 42.0, 60.0].into_iter().flat_map(|r| around_mark(mark, r)))
        {
            let cost = crowding(&place);
            if cost < least {
                (best, least) = (place, cost);
            }
        }
        let Box { left, right, top, bottom } = Box::of_text(best.at, best.anchor, name, size);
        self.taken.push(Box { left: left - GAP, right: right + GAP, top, bottom });
        best
    }
}

impl Places {
    /// Cost of a place that looks like that of another mark: a name without a leader line that is not closest
    /// to its own, or a line that begins beyond another mark.
    fn confusion(&self, mark: Point, place: &Place, wanted: &Box) -> f64 {
        /// Closer marks cannot be told apart.
        const SAME: f64 = 1.0;
        const COST: f64 = 200.0;
        let apart = |a: Point, b: Point| (a.0 - b.0).hypot(a.1 - b.1);
        let mut others = self.marks.iter().filter(|other| apart(**other, mark) > SAME);
        let is_confused = match place.leader {
            None => others.any(|other| wanted.distance(*other) < wanted.distance(mark) + SAME),
            Some([from, _]) => others.any(|other| apart(*other, from) < apart(mark, from)),
        };
        if is_confused { COST } else { 0.0 }
    }
}

impl Place {
    /// Writes the name, with a leader line if needed.
    pub(crate) fn write(&self, svg: &mut Svg, name: &str, style: Text<'_>) {
        if let Some([from, to]) = self.leader {
            svg.line(from, to, &Stroke::solid(SOFT, 0.8));
        }
        svg.text(self.at, name, style.anchor(self.anchor).halo());
    }
}

/// Returns the candidate places next to a mark.
fn adjacent((x, y): Point) -> [Place; 8] {
    [
        ((x + 10.0, y + 4.0), Anchor::Start),
        ((x - 10.0, y + 4.0), Anchor::End),
        ((x, y - 11.0), Anchor::Middle),
        ((x, y + 20.0), Anchor::Middle),
        ((x + 8.0, y - 8.0), Anchor::Start),
        ((x + 8.0, y + 16.0), Anchor::Start),
        ((x - 8.0, y - 8.0), Anchor::End),
        ((x - 8.0, y + 16.0), Anchor::End),
    ]
    .map(|(at, anchor)| Place { at, anchor, leader: None })
}

/// Returns the candidate places around a mark, `radius` px away, with a leader line.
fn around_mark((x, y): Point, radius: f64) -> impl Iterator<Item = Place> {
    const DIRECTIONS: u32 = 12;
    (0..DIRECTIONS).map(move |k| {
        let (sin, cos) = (std::f64::consts::TAU * f64::from(k) / f64::from(DIRECTIONS)).sin_cos();
        let anchor = match cos {
            c if c > 0.3 => Anchor::Start,
            c if c < -0.3 => Anchor::End,
            _ => Anchor::Middle,
        };
        let step = |r: f64| (x + r * cos, y + r * sin);
        let end = step(radius);
        let at = (end.0 + 2.0 * cos, end.1 + 4.0 + 6.0 * sin);
        Place { at, anchor, leader: Some([step(7.0), end]) }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_coincident_marks_do_not_overlap() {
        let mark = (100.0, 100.0);
        let mut places = Places::around((0.0, 0.0), (200.0, 200.0), std::iter::repeat_n(mark, 9));
        let names = ["white", "black", "red", "green", "blue", "cyan", "magenta", "yellow", "light"];
        let boxes = names.map(|name| {
            let place = places.find(mark, name, 12.0);
            Box::of_text(place.at, place.anchor, name, 12.0)
        });
        for (i, one) in boxes.iter().enumerate() {
            assert!(one.overlap(&places.bounds) > 0.99 * one.area(), "{} leaves the panel", names[i]);
            for (j, other) in boxes.iter().enumerate().skip(i + 1) {
                assert!(one.overlap(other) < 0.2 * one.area(), "{} covers {}", names[i], names[j]);
            }
        }
    }

    /// Two marks closer together than a name is high: each name is next to its own mark, or has a line that
    /// ends there.
    #[test]
    fn names_of_close_marks_belong_to_their_own() {
        for (dx, dy) in [(1.0, 6.0), (6.0, 0.0), (-4.0, 4.0), (0.0, -9.0)] {
            let marks = [(100.0, 100.0), (100.0 + dx, 100.0 + dy)];
            let mut places = Places::around((0.0, 0.0), (200.0, 200.0), marks.into_iter());
            // A line through both, as the side of a triangle.
            places.avoid(&[(90.0, 40.0), marks[0], (160.0, 40.0)]);
            for (own, other, name) in [(0, 1, "black"), (1, 0, "blue")] {
                let place = places.find(marks[own], name, 12.0);
                let wanted = Box::of_text(place.at, place.anchor, name, 12.0);
                let distance = |at: Point, mark: Point| (at.0 - mark.0).hypot(at.1 - mark.1);
                match place.leader {
                    None => assert!(wanted.distance(marks[own]) < wanted.distance(marks[other]), "{name}"),
                    Some([from, _]) => {
                        assert!(
                            distance(from, marks[own]) <= distance(from, marks[other]),
                            "{name} {dx} {dy}"
                        );
                    }
                }
            }
        }
    }
}
