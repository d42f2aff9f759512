//! Where the name of a mark finds room beside others.

use crate::svg::{Anchor, Point, text_width};

/// What is taken on the page: marks, lines, and names already placed.
#[derive(Debug)]
pub(crate) struct Places {
    taken: Vec<Box>,
}

#[derive(Debug, Clone, Copy)]
struct Box {
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
}

impl Box {
    fn overlap(&self, other: &Self) -> f64 {
        let width = self.right.min(other.right) - self.left.max(other.left);
        let height = self.bottom.min(other.bottom) - self.top.max(other.top);
        width.max(0.0) * height.max(0.0)
    }
}

impl Places {
    /// A page where only these marks are.
    pub(crate) fn around(marks: impl Iterator<Item = Point>) -> Self {
        let mark = |(x, y): Point| Box { left: x - 7.0, right: x + 7.0, top: y - 7.0, bottom: y + 7.0 };
        Self { taken: marks.map(mark).collect() }
    }

    /// Names also keep off the sides of this polygon.
    pub(crate) fn avoid(&mut self, corners: &[Point]) {
        const STEPS: usize = 40;
        for (i, from) in corners.iter().enumerate() {
            let to = corners[(i + 1) % corners.len()];
            for k in 0..STEPS {
                let t = k as f64 / STEPS as f64;
                let (x, y) = (from.0 + t * (to.0 - from.0), from.1 + t * (to.1 - from.1));
                self.taken.push(Box { left: x - 2.0, right: x + 2.0, top: y - 2.0, bottom: y + 2.0 });
            }
        }
    }

    /// The least crowded place for `name` beside its mark, and takes it.
    pub(crate) fn find(&mut self, (x, y): Point, name: &str, size: f64) -> (Point, Anchor) {
        let candidates = [
            ((x + 10.0, y + 4.0), Anchor::Start),
            ((x - 10.0, y + 4.0), Anchor::End),
            ((x, y - 11.0), Anchor::Middle),
            ((x, y + 20.0), Anchor::Middle),
            ((x + 8.0, y - 8.0), Anchor::Start),
            ((x + 8.0, y + 16.0), Anchor::Start),
            ((x - 8.0, y - 8.0), Anchor::End),
            ((x - 8.0, y + 16.0), Anchor::End),
        ];
        let crowding = |(at, anchor): &(Point, Anchor)| -> f64 {
            let wanted = extent(*at, *anchor, name, size);
            self.taken.iter().map(|taken| taken.overlap(&wanted)).sum()
        };
        // `min_by` keeps the first of equals, so the order above is the order of taste.
        let best = candidates.iter().min_by(|a, b| crowding(a).total_cmp(&crowding(b)));
        let (at, anchor) = best.copied().unwrap_or(candidates[0]);
        self.taken.push(extent(at, anchor, name, size));
        (at, anchor)
    }
}

fn extent((x, y): Point, anchor: Anchor, text: &str, size: f64) -> Box {
    let width = text_width(text, size);
    let left = match anchor {
        Anchor::Start => x,
        Anchor::Middle => x - width / 2.0,
        Anchor::End => x - width,
    };
    Box { left, right: left + width, top: y - size, bottom: y + 2.0 }
}
