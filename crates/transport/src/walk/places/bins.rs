//! Cells, strips and rings in which light is tallied.

use std::ops::Range;

use super::tally::KernelTally;

/// Equal cells of a rectangle, for a spread. A cell holds all light that falls on it: its area is exact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CellGrid {
    /// Number of columns and rows; columns from the left, rows from the bottom.
    pub count: [usize; 2],
    /// Lower left corner, mm.
    pub corner_mm: [f64; 2],
    /// Width and height of a cell, mm.
    pub cell_mm: [f64; 2],
}

impl CellGrid {
    /// Number of cells.
    pub fn len(&self) -> usize {
        self.count[0] * self.count[1]
    }

    /// True if there is no cell.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The cell of a place; one more than the last for all places beyond.
    fn cell(&self, place_mm: [f64; 2]) -> usize {
        let along = |k: usize| (place_mm[k] - self.corner_mm[k]) / self.cell_mm[k];
        let (column, row) = (along(0), along(1));
        let holds = |at: f64, count: usize| at >= 0.0 && at < count as f64;
        if holds(column, self.count[0]) && holds(row, self.count[1]) {
            row as usize * self.count[0] + column as usize
        } else {
            self.len()
        }
    }
}

/// All bins of a tally, in one row: those of the cells, of the strips along x and y, and of the rings.
#[derive(Debug, Clone, Default)]
pub(super) struct Bins {
    grid: Option<CellGrid>,
    strips_mm: [Vec<f64>; 2],
    rings_mm: Vec<f64>,
    pub(super) cells: Range<usize>,
    pub(super) strips: [Range<usize>; 2],
    pub(super) rings: Range<usize>,
    /// Number of bins.
    pub(super) count: usize,
    /// Number of bins that a place belongs to.
    pub(super) parts: usize,
}

impl Bins {
    pub(super) fn new(tally: &KernelTally) -> Self {
        let KernelTally { cells: grid, strips_mm, rings_mm, .. } = tally;
        let grid = grid.filter(|grid| !grid.is_empty());
        let (mut count, mut parts) = (0, 0);
        let mut next = |borders: usize| {
            let len = if borders > 0 { borders + 1 } else { 0 };
            count += len;
            parts += usize::from(len > 0);
            count - len..count
        };
        let cells = next(grid.map_or(0, |grid| grid.len()));
        let strips = [next(strips_mm[0].len()), next(strips_mm[1].len())];
        let rings = next(rings_mm.len());
        let (strips_mm, rings_mm) = (strips_mm.clone(), rings_mm.clone());
        Self { grid, strips_mm, rings_mm, cells, strips, rings, count, parts }
    }

    /// Adds the bins of a place.
    pub(super) fn locate(&self, place_mm: [f64; 2], bins: &mut Vec<usize>) {
        bins.extend(self.grid.map(|grid| self.cells.start + grid.cell(place_mm)));
        let borders = |borders: &[f64], range: &Range<usize>, at: f64| {
            let bin = range.start + borders.partition_point(|border| *border <= at);
            (!borders.is_empty()).then_some(bin)
        };
        for axis in [0, 1] {
            bins.extend(borders(&self.strips_mm[axis], &self.strips[axis], place_mm[axis]));
        }
        bins.extend(borders(&self.rings_mm, &self.rings, place_mm[0].hypot(place_mm[1])));
    }
}
