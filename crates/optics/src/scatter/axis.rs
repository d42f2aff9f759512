//! Nodes along one coordinate, and interpolation between four of them.

/// Ascending nodes, at least two, with one more beyond either end.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Axis {
    nodes: Vec<f64>,
    cells: Vec<Cell>,
    /// For each of these equal parts of the range the cell in which it begins.
    cell_at: Vec<u32>,
    parts_per_unit: f64,
}

/// Interval between two nodes, with four nodes: the one before, its ends, the one after.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Cell {
    start: f64,
    width: f64,
    inverse: f64,
    /// Inverse widths of the cells before and after.
    around: [f64; 2],
    /// Weight of this cell's secant in the slope at either end.
    own: [f64; 2],
}

/// Position in a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Place {
    pub(super) cell: usize,
    /// From 0 to 1.
    pub(super) t: f64,
    geometry: Cell,
}

/// Parts of the range for each cell: enough that a step or two finds it.
const PARTS_PER_CELL: usize = 4;

/// Largest slope, as a multiple of the smaller adjacent secant: it bounds overshoot to less than the changes
/// nearby (Fritsch and Carlson 1980; Hyman 1983).
pub(super) const STEEPEST: f64 = 3.0;

impl Axis {
    /// Builds the axis from nodes, and the positions of the values before the first and after the last one.
    pub(super) fn new(nodes: Vec<f64>, before: f64, after: f64) -> Self {
        let last = nodes.len() - 1;
        let at = |i: isize| match i {
            -1 => before,
            i if i as usize > last => after,
            i => nodes[i as usize],
        };
        let cell = |c: usize| {
            let i = c as isize;
            let [before, width, after] = [i - 1, i, i + 1].map(|k| at(k + 1) - at(k));
            Cell {
                start: nodes[c],
                width,
                inverse: 1.0 / width,
                around: [1.0 / before, 1.0 / after],
                own: [before / (before + width), after / (after + width)],
            }
        };
        let cells = (0..last).map(cell).collect();
        let (start, range) = (nodes[0], nodes[last] - nodes[0]);
        let parts = PARTS_PER_CELL * last;
        let cell_at = (0..parts).map(|part| {
            let x = start + range * part as f64 / parts as f64;
            (nodes.partition_point(|&node| node <= x).max(1) - 1).min(last - 1) as u32
        });
        Self { cells, cell_at: cell_at.collect(), parts_per_unit: parts as f64 / range, nodes }
    }

    /// Builds the axis of nodes whose values are mirrored at both ends, as those of an angle from 0 to pi.
    pub(super) fn mirrored(nodes: Vec<f64>) -> Self {
        let last = nodes.len() - 1;
        let (before, after) = (2.0 * nodes[0] - nodes[1], 2.0 * nodes[last] - nodes[last - 1]);
        Self::new(nodes, before, after)
    }

    pub(super) fn nodes(&self) -> &[f64] {
        &self.nodes
    }

    pub(super) fn last(&self) -> f64 {
        self.nodes[self.nodes.len() - 1]
    }

    /// Returns the position of `x`; beyond the nodes that of the nearest.
    #[inline]
    pub(super) fn place(&self, x: f64) -> Place {
        let part = ((x - self.nodes[0]) * self.parts_per_unit) as usize;
        let mut cell = self.cell_at[part.min(self.cell_at.len() - 1)] as usize;
        while cell + 1 < self.cells.len() && x >= self.nodes[cell + 1] {
            cell += 1;
        }
        let geometry = self.cells[cell];
        let t = ((x - geometry.start) * geometry.inverse).clamp(0.0, 1.0);
        Place { cell, t, geometry }
    }
}

impl Place {
    /// Returns the width of the cell.
    #[inline]
    pub(super) fn width(&self) -> f64 {
        self.geometry.width
    }

    /// Returns the Hermite basis: of the values at the ends, and of the slopes, times the width of the cell.
    #[inline]
    pub(super) fn hermite(&self) -> [f64; 4] {
        let (t, s) = (self.t, 1.0 - self.t);
        [s * s * (1.0 + 2.0 * t), t * t * (3.0 - 2.0 * t), t * s * s, -t * t * s]
    }

    /// Returns the cubic between the middle two of four values, with the slopes of parabolas through three
    /// of them, limited by [`STEEPEST`].
    #[inline]
    pub(super) fn cubic(&self, values: [f64; 4]) -> f64 {
        let Cell { inverse, around, own, .. } = self.geometry;
        let [before, here, after] = [
            (values[1] - values[0]) * around[0],
            (values[2] - values[1]) * inverse,
            (values[3] - values[2]) * around[1],
        ];
        let slope = |other: f64, own: f64| {
            let most = STEEPEST * smaller(other.abs(), here.abs());
            let slope = own * here + (1.0 - own) * other;
            smaller(larger(slope, -most), most)
        };
        let [a, b, c, d] = self.hermite();
        let width = self.geometry.width;
        a * values[1] + b * values[2] + width * (c * slope(before, own[0]) + d * slope(after, own[1]))
    }
}

/// Comparison without a test for NaN, which takes time.
#[inline]
fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

#[inline]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_are_found_on_nonuniform_axes() {
        let nodes = vec![0.0, 0.01, 0.02, 0.5, 0.9, 2.0];
        let axis = Axis::mirrored(nodes.clone());
        for step in 0..=4000 {
            let x = f64::from(step) * 0.0005;
            let place = axis.place(x);
            let found = nodes[place.cell] + place.t * place.width();
            assert!((found - x).abs() < 1e-15 && (0.0..=1.0).contains(&place.t), "{x}");
        }
        assert_eq!((axis.place(7.0).cell, axis.place(7.0).t, axis.place(-1.0).t), (4, 1.0, 0.0));
    }

    /// Parabolas are reproduced except where slopes are limited near an extremum.
    #[test]
    fn parabola_is_reproduced() {
        let nodes = [0.3, 0.5, 0.8, 1.0];
        let axis = Axis::new(nodes[1..3].to_vec(), nodes[0], nodes[3]);
        let f = |x: f64| 2.0 + x + x * x;
        for step in 0..=10 {
            let x = 0.5 + 0.03 * f64::from(step);
            assert!((axis.place(x).cubic(nodes.map(f)) - f(x)).abs() < 1e-14);
        }
    }

    #[test]
    fn step_does_not_overshoot() {
        let axis = Axis::new(vec![1.0, 2.0], 0.0, 3.0);
        for step in 0..=20 {
            let value = axis.place(1.0 + 0.05 * f64::from(step)).cubic([0.0, 0.0, 1.0, 1.0]);
            assert!((0.0..=1.0).contains(&value), "{value}");
        }
    }
}
