//! Values on the periodic cells of a face.

use num_complex::Complex64;
use papilio_transport::spatial::Cells;

/// Values at the middles of periodic cells, linear between them.
pub(crate) struct Grid<T> {
    pub(crate) cells: Cells,
    pub(crate) values: Vec<T>,
    /// Cells per mm along x and y.
    per_mm: [f64; 2],
}

impl<T> Grid<T> {
    pub(crate) fn new(cells: Cells, values: Vec<T>) -> Self {
        Self { cells, values, per_mm: cells.size().map(f64::recip) }
    }

    /// The four cells whose middles surround a place, each with its weight.
    #[inline]
    pub(crate) fn around(&self, place: [f64; 2]) -> [(usize, f64); 4] {
        let (x0, x1, u) = self.beside(0, place[0]);
        let (y0, y1, v) = self.beside(1, place[1]);
        let columns = self.cells.count[0];
        [
            (y0 * columns + x0, (1.0 - u) * (1.0 - v)),
            (y0 * columns + x1, u * (1.0 - v)),
            (y1 * columns + x0, (1.0 - u) * v),
            (y1 * columns + x1, u * v),
        ]
    }

    /// Numbers of the cells along an axis on both sides of a coordinate, and the weight of the second.
    #[inline]
    fn beside(&self, axis: usize, coordinate: f64) -> (usize, usize, f64) {
        let count = self.cells.count[axis];
        let at = coordinate * self.per_mm[axis] - 0.5;
        let lower = floor(at);
        let cell = lower as i64;
        let cell =
            if (0..count as i64).contains(&cell) { cell } else { cell.rem_euclid(count as i64) } as usize;
        let next = if cell + 1 == count { 0 } else { cell + 1 };
        (cell, next, at - lower)
    }
}

/// The largest whole number that is not above a number of less than 2^63: without the call that `f64::floor`
/// is on old processors.
#[inline]
pub(crate) fn floor(value: f64) -> f64 {
    let whole = value as i64 as f64;
    if whole > value { whole - 1.0 } else { whole }
}

impl<T: Copy + std::ops::Mul<f64, Output = T> + std::iter::Sum> Grid<T> {
    /// Value at a place.
    pub(crate) fn at(&self, place: [f64; 2]) -> T {
        self.around(place).into_iter().map(|(cell, weight)| self.values[cell] * weight).sum()
    }
}

impl Grid<Complex64> {
    /// Value at a place by cubic interpolation (Catmull and Rom), which keeps the mean square of waves of a
    /// few cells.
    #[inline]
    pub(crate) fn smooth_at(&self, place: [f64; 2]) -> Complex64 {
        let (columns, rows) = (self.nearest(0, place[0]), self.nearest(1, place[1]));
        let along = |row: usize| -> Complex64 {
            let values = &self.values[row * self.cells.count[0]..];
            columns.iter().map(|(column, weight)| values[*column] * *weight).sum()
        };
        rows.iter().map(|(row, weight)| along(*row) * *weight).sum()
    }

    /// The four cells along an axis nearest to a coordinate, and their weights.
    #[inline]
    fn nearest(&self, axis: usize, coordinate: f64) -> [(usize, f64); 4] {
        let count = self.cells.count[axis];
        let (cell, next, t) = self.beside(axis, coordinate);
        let before = if cell == 0 { count - 1 } else { cell - 1 };
        let after = if next + 1 == count { 0 } else { next + 1 };
        let (s, half) = (1.0 - t, 0.5 * t * (1.0 - t));
        [
            (before, -half * s),
            (cell, s + half * (2.0 * s - t)),
            (next, t + half * (2.0 * t - s)),
            (after, -half * t),
        ]
    }
}
