//! Things in a periodic layer, sorted into the cells of a grid, and the walk of a ray from cell to cell.
//!
//! The layer repeats along x and y, and ends at its lowest and highest height. A thing is known by its number
//! and by the period in which it stands, in whole periods, so that the same place has the same coordinates in
//! all cells, without rounding.

use crate::ray::Ray;

/// Cells that a ray may cross before it counts as lost.
const MOST_CELLS: usize = 1_000_000;

/// Entries and cells per thing, and in addition to these, up to which a grid is made finer.
const PER_THING: usize = 32;
const AT_LEAST: usize = 4096;

/// Margin around things, relative to the size of a cell, against rounding.
const MARGIN: f64 = 1e-6;

/// A box: its lowest and highest corners, um.
pub(crate) type Bounds = [[f64; 3]; 2];

/// A thing in a cell: its number, and the period in which it stands.
pub(crate) type Entry = (u32, [i64; 2]);

/// A grid over a period of a layer.
#[derive(Debug)]
pub(crate) struct Grid {
    period_um: [f64; 2],
    lowest: f64,
    cells: [usize; 3],
    size: [f64; 3],
    /// Of each cell, where its entries begin; and the end of the last.
    starts: Vec<usize>,
    entries: Vec<Entry>,
}

/// How the walk of a ray ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Walked<T> {
    /// At a thing.
    Found(T),
    /// Above or below the layer.
    Left,
    /// After too many cells.
    Unknown,
}

impl Grid {
    /// Sorts things into cells with sides of about `side_um`, or larger ones if these would be too many.
    pub(crate) fn new(
        period_um: [f64; 2],
        [lowest, highest]: [f64; 2],
        boxes: &[Bounds],
        side_um: f64,
    ) -> Self {
        let most = PER_THING * boxes.len() + AT_LEAST;
        let height = (highest - lowest).max(1e-9 * side_um);
        let extent = [period_um[0], period_um[1], height];
        let mut side = side_um;
        loop {
            // At least one cell, also where the quotient is not a number.
            let cells = extent.map(|extent| match (extent / side).floor() {
                count if count >= 1.0 => count.min(most as f64) as usize,
                _ => 1,
            });
            let size = [0, 1, 2].map(|k| extent[k] / cells[k] as f64);
            let all = cells.iter().fold(1, |all: usize, count| all.saturating_mul(*count));
            let mut grid = Self { period_um, lowest, cells, size, starts: Vec::new(), entries: Vec::new() };
            if all == 1
                || all <= most && boxes.iter().map(|one| grid.places(one).count()).sum::<usize>() <= most
            {
                grid.fill(boxes);
                return grid;
            }
            side *= 1.5;
        }
    }

    /// Cells that a box overlaps, and the period in which it then stands.
    fn places(&self, &[low, high]: &Bounds) -> impl Iterator<Item = (usize, [i64; 2])> {
        let origin = [0.0, 0.0, self.lowest];
        let counts = self.cells.map(|count| count as i64);
        let size = self.size;
        let range = move |k: usize| {
            let at = |value: f64, margin: f64| ((value - origin[k]) / size[k] + margin).floor() as i64;
            let (first, last) = (at(low[k], -MARGIN), at(high[k], MARGIN));
            if k == 2 { first.clamp(0, counts[2] - 1)..=last.clamp(0, counts[2] - 1) } else { first..=last }
        };
        range(2).flat_map(move |z| {
            range(1).flat_map(move |y| {
                range(0).map(move |x| {
                    let [column, row] = [x.rem_euclid(counts[0]), y.rem_euclid(counts[1])];
                    let period = [-x.div_euclid(counts[0]), -y.div_euclid(counts[1])];
                    (((z * counts[1] + row) * counts[0] + column) as usize, period)
                })
            })
        })
    }

    fn fill(&mut self, boxes: &[Bounds]) {
        let all = self.cells.iter().product::<usize>();
        let mut counts = vec![0; all + 1];
        for (cell, _) in boxes.iter().flat_map(|one| self.places(one)) {
            counts[cell + 1] += 1;
        }
        for cell in 0..all {
            counts[cell + 1] += counts[cell];
        }
        let mut next = counts.clone();
        let mut entries = vec![(0, [0; 2]); counts[all]];
        for (number, one) in boxes.iter().enumerate() {
            for (cell, period) in self.places(one) {
                entries[next[cell]] = (number as u32, period);
                next[cell] += 1;
            }
        }
        (self.starts, self.entries) = (counts, entries);
    }

    /// Follows a ray from cell to cell. `visit` is given the entries of a cell, the period of the cell, and
    /// the way to its end; it returns what the ray meets before that end.
    pub(crate) fn walk<T>(
        &self,
        ray: &Ray,
        mut visit: impl FnMut(&[Entry], [i64; 2], f64) -> Option<T>,
    ) -> Walked<T> {
        let origin = [0.0, 0.0, self.lowest];
        let counts = self.cells.map(|count| count as i64);
        let mut cell = [0, 1, 2].map(|k| ((ray.at[k] - origin[k]) / self.size[k]).floor() as i64);
        // A ray on the highest or lowest height, or beyond it by rounding.
        cell[2] = cell[2].clamp(0, counts[2] - 1);
        let line = |k: usize, number: i64| {
            if ray.along[k] == 0.0 {
                return f64::INFINITY;
            }
            let next = number + i64::from(ray.along[k] > 0.0);
            (next as f64 * self.size[k] + origin[k] - ray.at[k]) / ray.along[k]
        };
        let mut lines = [0, 1, 2].map(|k| line(k, cell[k]));
        let mut way = 0.0_f64;
        for _ in 0..MOST_CELLS {
            let axis = (0..3).fold(0, |least, k| if lines[k] < lines[least] { k } else { least });
            way = way.max(lines[axis]);
            let [column, row] = [cell[0].rem_euclid(counts[0]), cell[1].rem_euclid(counts[1])];
            let period = [cell[0].div_euclid(counts[0]), cell[1].div_euclid(counts[1])];
            let number = ((cell[2] * counts[1] + row) * counts[0] + column) as usize;
            let entries = &self.entries[self.starts[number]..self.starts[number + 1]];
            if let Some(found) = visit(entries, period, way) {
                return Walked::Found(found);
            }
            cell[axis] += if ray.along[axis] > 0.0 { 1 } else { -1 };
            if axis == 2 && !(0..counts[2]).contains(&cell[2]) {
                return Walked::Left;
            }
            lines[axis] = line(axis, cell[axis]);
        }
        Walked::Unknown
    }

    /// Period along x and y, um.
    pub(crate) fn period_um(&self) -> [f64; 2] {
        self.period_um
    }
}
