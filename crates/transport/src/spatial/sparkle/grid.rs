//! Values on the periodic cells of a face.

use num_complex::Complex64;

use super::super::Cells;

/// Values at the middles of periodic cells, linear between them.
pub(super) struct Grid<T> {
    pub(super) cells: Cells,
    pub(super) values: Vec<T>,
}

impl Cells {
    /// Middle of a cell.
    pub(super) fn middle(&self, cell: usize) -> [f64; 2] {
        let [x, y] = [cell % self.count[0], cell / self.count[0]];
        let size = self.size();
        [(x as f64 + 0.5) * size[0], (y as f64 + 0.5) * size[1]]
    }

    /// Width and height of a cell.
    pub(super) fn size(&self) -> [f64; 2] {
        [0, 1].map(|axis| self.period_mm[axis] / self.count[axis] as f64)
    }

    /// The four cells whose middles surround a place, each with its weight.
    pub(super) fn around(&self, place: [f64; 2]) -> [(usize, f64); 4] {
        let size = self.size();
        let [(x0, x1, u), (y0, y1, v)] = [0, 1].map(|axis| {
            let count = self.count[axis] as i64;
            let at = place[axis] / size[axis] - 0.5;
            let lower = at.floor();
            let cell = (lower as i64).rem_euclid(count) as usize;
            let next = if cell + 1 == self.count[axis] { 0 } else { cell + 1 };
            (cell, next, at - lower)
        });
        let columns = self.count[0];
        [
            (y0 * columns + x0, (1.0 - u) * (1.0 - v)),
            (y0 * columns + x1, u * (1.0 - v)),
            (y1 * columns + x0, (1.0 - u) * v),
            (y1 * columns + x1, u * v),
        ]
    }
}

impl<T: Copy + std::ops::Mul<f64, Output = T> + std::iter::Sum> Grid<T> {
    /// Value at a place.
    pub(super) fn at(&self, place: [f64; 2]) -> T {
        self.cells.around(place).into_iter().map(|(cell, weight)| self.values[cell] * weight).sum()
    }
}

impl Grid<Complex64> {
    /// Half of the difference between the next cell and the one before, along x or y.
    pub(super) fn difference(&self, cell: usize, [x, y]: [usize; 2]) -> Complex64 {
        let [columns, rows] = self.cells.count;
        let (column, row) = (cell % columns, cell / columns);
        let value = |column: usize, row: usize| self.values[row % rows * columns + column % columns];
        0.5 * (value(column + x, row + y) - value(column + columns - x, row + rows - y))
    }
}
