//! The nearest of points in three dimensions: a tree that halves them along the longest axis of their box.

use std::ops::Range;

/// Number of points below which a node is not divided.
const LEAF: usize = 12;

/// Points in an order in which those of every node are adjacent. The middle of a node divides it, and is that of no other.
#[derive(Debug)]
pub(super) struct Tree {
    places: Vec<[f64; 3]>,
    order: Vec<usize>,
    /// The axis along which the node with this middle is divided, and the coordinate there.
    cuts: Vec<(usize, f64)>,
}

/// The nearest points so far, and their squared distances, ascending.
struct Found<'a> {
    from: [f64; 3],
    count: usize,
    accepts: &'a dyn Fn(usize) -> bool,
    near: Vec<(usize, f64)>,
}

impl Tree {
    pub(super) fn new(places: Vec<[f64; 3]>) -> Self {
        let mut order: Vec<usize> = (0..places.len()).collect();
        let mut cuts = vec![(0, 0.0); places.len()];
        let mut nodes: Vec<Range<usize>> = std::iter::once(0..places.len()).collect();
        while let Some(node) = nodes.pop() {
            if node.len() <= LEAF {
                continue;
            }
            let points = &mut order[node.clone()];
            let axis = longest(points.iter().map(|k| places[*k]));
            let half = points.len() / 2;
            points.select_nth_unstable_by(half, |a, b| places[*a][axis].total_cmp(&places[*b][axis]));
            let middle = node.start + half;
            cuts[middle] = (axis, places[order[middle]][axis]);
            nodes.extend([node.start..middle, middle..node.end]);
        }
        Self { places, order, cuts }
    }

    /// Coordinates of a point.
    pub(super) fn place(&self, point: usize) -> [f64; 3] {
        self.places[point]
    }

    /// Returns the nearest `count` points that are accepted, with their distances, ascending.
    pub(super) fn nearest(
        &self,
        from: [f64; 3],
        count: usize,
        accepts: &dyn Fn(usize) -> bool,
    ) -> Vec<(usize, f64)> {
        let mut found = Found { from, count, accepts, near: Vec::with_capacity(count + 1) };
        self.search(0..self.order.len(), &mut found);
        found.near.into_iter().map(|(point, squared)| (point, squared.sqrt())).collect()
    }

    fn search(&self, node: Range<usize>, found: &mut Found<'_>) {
        if node.len() <= LEAF {
            self.order[node].iter().for_each(|point| found.add(*point, self.places[*point]));
            return;
        }
        let middle = node.start + node.len() / 2;
        let (axis, cut) = self.cuts[middle];
        let off = found.from[axis] - cut;
        let [below, above] = [node.start..middle, middle..node.end];
        let (first, second) = if off < 0.0 { (below, above) } else { (above, below) };
        self.search(first, found);
        if off * off < found.reach() {
            self.search(second, found);
        }
    }
}

impl Found<'_> {
    /// Squared distance beyond which no point is among the nearest.
    fn reach(&self) -> f64 {
        if self.near.len() < self.count {
            f64::INFINITY
        } else {
            self.near.last().map_or(f64::INFINITY, |last| last.1)
        }
    }

    fn add(&mut self, point: usize, place: [f64; 3]) {
        let squared: f64 = (0..3).map(|axis| (place[axis] - self.from[axis]).powi(2)).sum();
        if squared >= self.reach() || !(self.accepts)(point) {
            return;
        }
        let at = self.near.partition_point(|(_, other)| *other <= squared);
        self.near.insert(at, (point, squared));
        self.near.truncate(self.count);
    }
}

/// The axis along which points extend farthest.
fn longest(points: impl Iterator<Item = [f64; 3]>) -> usize {
    let mut box_of = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
    for place in points {
        for (axis, [least, most]) in box_of.iter_mut().enumerate() {
            *least = least.min(place[axis]);
            *most = most.max(place[axis]);
        }
    }
    let extent = |axis: &usize| box_of[*axis][1] - box_of[*axis][0];
    (0..3).max_by(|a, b| extent(a).total_cmp(&extent(b))).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The tree finds the points that a plain search finds.
    #[test]
    fn nearest_points_equal_those_of_plain_search() {
        let part = |k: usize, by: usize| (k * by % 997) as f64 / 997.0;
        let places: Vec<[f64; 3]> = (0..500).map(|k| [part(k, 379), part(k, 611), part(k, 53)]).collect();
        let tree = Tree::new(places.clone());
        for query in 0..40 {
            let from = [part(query, 711), part(query, 17), part(query, 233)];
            let squared = |k: &usize| (0..3).map(|a| (places[*k][a] - from[a]).powi(2)).sum::<f64>();
            let mut plain: Vec<usize> = (0..500).filter(|k| k % 3 != 0).collect();
            plain.sort_by(|a, b| squared(a).total_cmp(&squared(b)));
            let found = tree.nearest(from, 30, &|k| k % 3 != 0);
            let far = |k: usize| squared(&k).sqrt();
            for ((_, distance), expected) in found.iter().zip(&plain) {
                assert!((distance - far(*expected)).abs() < 1e-14, "{query}");
            }
            assert_eq!(found.len(), 30);
        }
    }
}
