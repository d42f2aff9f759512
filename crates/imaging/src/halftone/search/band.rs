//! Bands of rows that threads search at the same time.
//!
//! A band is changed in its inner rows only, so that what its changes touch is in the band: the result does not
//! depend on the number of threads. In each pass, bands that begin at multiples of a period come first, then
//! those between, which have the other rows inside.

use std::ops::Range;

use pulp::NullaryFnOnce;

use super::correlate::{Correlate, Shown};
use super::costs::{AREA, Change, Costs, Here, LANES, NEIGHBOURS, Scratch};
use crate::in_turn;

/// Columns and rows of the blocks of pixels that are left out while nothing near them changes.
const BLOCK: usize = 8;

/// Rows of a band at least; the inner half is searched.
const LEAST_ROWS: usize = 64;

/// The states of a picture and their error, correlated with the autocorrelations of the filters.
pub(super) struct Field<const N: usize> {
    pub(super) columns: usize,
    pub(super) states: Vec<u8>,
    /// By rows, then by coordinates, then by columns, between margins.
    correlated: Vec<f32>,
    /// Columns on both sides of a row of `correlated` that changes may reach.
    margin: usize,
    /// For each block, by rows of blocks, whether something in reach has changed since its last visit.
    touched: Vec<bool>,
    /// What each area adds to the correlated errors of its pixels, by rows of areas.
    areas: Vec<[f32; N]>,
}

/// Changes, and how much they lower the error.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Progress {
    pub(super) changes: usize,
    pub(super) gain: f64,
}

/// Rows of a field.
struct Band<'a, const N: usize> {
    columns: usize,
    margin: usize,
    states: &'a mut [u8],
    /// Whether each pixel keeps its state; empty: none does.
    fixed: &'a [bool],
    /// Whether each pixel takes few states; empty: none does.
    few: &'a [bool],
    correlated: &'a mut [f32],
    touched: &'a mut [bool],
    areas: &'a mut [[f32; N]],
    /// Rows that may change.
    inner: Range<usize>,
}

/// Rows that are correlated at once, a multiple of [`AREA`].
const CORRELATED_ROWS: usize = 64;

impl<const N: usize> Field<N> {
    /// Correlates the errors of the states, and returns their error E, too; `None` if it was stopped.
    pub(super) fn new(
        shown: Shown<'_, N>,
        costs: &Costs<N>,
        (threads, stop): (usize, &(dyn Fn() -> bool + Sync)),
    ) -> Option<(Self, f64)> {
        let Shown { columns, states, .. } = shown;
        let rows = states.len() / columns;
        let margin = costs.reach()[0] + LANES;
        let per_row = N * (columns + 2 * margin);
        let mut correlated = vec![0.0; rows * per_row];
        let errors = in_turn(threads, correlated.chunks_mut(per_row * CORRELATED_ROWS), |number, into| {
            let first = number * CORRELATED_ROWS;
            let rows = first..first + into.len() / per_row;
            let work = Correlate { shown, costs, rows, into, margin };
            (!stop()).then(|| pulp::Arch::new().dispatch(work))
        });
        let (mut error, mut areas) = (0.0, Vec::new());
        for found in errors {
            let (part, more) = found?;
            error += part;
            areas.extend(more);
        }
        let blocks = columns.div_ceil(BLOCK) * rows.div_ceil(BLOCK);
        let states = states.to_vec();
        Some((Self { columns, states, correlated, margin, touched: vec![true; blocks], areas }, error))
    }

    /// One pass over all pixels near which something has changed; `None` if it was stopped.
    pub(super) fn pass(
        &mut self,
        costs: &Costs<N>,
        marks: [&[bool]; 2],
        threads: usize,
        stop: &(dyn Fn() -> bool + Sync),
    ) -> Option<Progress> {
        // A change of a pixel and its lower neighbour is felt in a row more than the reach. Bands begin with an area.
        let quarter = (costs.reach()[1] + 1).max(LEAST_ROWS / 4).next_multiple_of(AREA);
        let mut progress = Progress::default();
        for shift in [0, 2 * quarter] {
            let bands = self.bands(quarter, shift, marks);
            let found = in_turn(threads, bands.into_iter(), |_, band| {
                pulp::Arch::new().dispatch(Search { band, costs, stop })
            });
            for found in found {
                let Progress { changes, gain } = found?;
                progress.changes += changes;
                progress.gain += gain;
            }
        }
        Some(progress)
    }

    /// Bands of four quarters, whose middle half is searched; with a shift, the first one has its upper half
    /// left away.
    fn bands<'a>(&'a mut self, quarter: usize, shift: usize, mut marks: [&'a [bool]; 2]) -> Vec<Band<'a, N>> {
        let (columns, margin) = (self.columns, self.margin);
        let per_row = N * (columns + 2 * margin);
        let across = [BLOCK, AREA].map(|side| columns.div_ceil(side));
        let mut bands = Vec::new();
        let (mut states, mut correlated, mut touched, mut areas) =
            (&mut self.states[..], &mut self.correlated[..], &mut self.touched[..], &mut self.areas[..]);
        let mut left_away = shift;
        while !states.is_empty() {
            let rows = (4 * quarter - left_away).min(states.len() / columns);
            let band;
            (band, states) = states.split_at_mut(rows * columns);
            let [fixed, few] = marks.map(|marks| &marks[..(rows * columns).min(marks.len())]);
            marks = marks.map(|marks| &marks[(rows * columns).min(marks.len())..]);
            let own;
            (own, correlated) = correlated.split_at_mut(rows * per_row);
            let blocks;
            (blocks, touched) = touched.split_at_mut(rows.div_ceil(BLOCK) * across[0]);
            let own_areas;
            (own_areas, areas) = areas.split_at_mut(rows.div_ceil(AREA) * across[1]);
            let inner = quarter.saturating_sub(left_away)..(3 * quarter - left_away).min(rows);
            bands.push(Band {
                columns,
                margin,
                states: band,
                fixed,
                few,
                correlated: own,
                touched: blocks,
                areas: own_areas,
                inner,
            });
            left_away = 0;
        }
        bands
    }
}

/// The search of a band.
struct Search<'a, 'b, const N: usize> {
    band: Band<'a, N>,
    costs: &'b Costs<N>,
    stop: &'b (dyn Fn() -> bool + Sync),
}

impl<const N: usize> NullaryFnOnce for Search<'_, '_, N> {
    type Output = Option<Progress>;

    #[inline(always)]
    fn call(mut self) -> Option<Progress> {
        self.band.search(self.costs, self.stop)
    }
}

impl<const N: usize> Band<'_, N> {
    #[inline(always)]
    fn search(&mut self, costs: &Costs<N>, stop: &(dyn Fn() -> bool + Sync)) -> Option<Progress> {
        let mut progress = Progress::default();
        let mut scratch = Scratch::default();
        let across = self.columns.div_ceil(BLOCK);
        for block in self.inner.start / BLOCK * across..self.inner.end.div_ceil(BLOCK) * across {
            if block.is_multiple_of(across) && stop() {
                return None;
            }
            if !std::mem::replace(&mut self.touched[block], false) {
                continue;
            }
            let (top, left) = (block / across * BLOCK, block % across * BLOCK);
            for y in top..(top + BLOCK).min(self.inner.end) {
                for x in left..(left + BLOCK).min(self.columns) {
                    if self.is_fixed(x, y) {
                        continue;
                    }
                    let Some((change, gain)) = self.best(costs, x, y, &mut scratch) else { continue };
                    self.make(costs, x, y, change);
                    progress.changes += 1;
                    progress.gain += f64::from(gain);
                }
            }
        }
        Some(progress)
    }

    /// The place of a column in a row of `correlated`.
    #[inline(always)]
    fn place(&self, x: usize, y: usize, k: usize) -> usize {
        (y * N + k) * (self.columns + 2 * self.margin) + self.margin + x
    }

    /// The number of the area of a pixel.
    #[inline(always)]
    fn area(&self, x: usize, y: usize) -> usize {
        y / AREA * self.columns.div_ceil(AREA) + x / AREA
    }

    #[inline(always)]
    fn is_fixed(&self, x: usize, y: usize) -> bool {
        !self.fixed.is_empty() && self.fixed[y * self.columns + x]
    }

    #[inline(always)]
    fn at(&self, x: usize, y: usize) -> Here<N> {
        let mut r = [0.0; N];
        let area = self.area(x, y);
        for (k, r) in r.iter_mut().enumerate() {
            *r = self.correlated[self.place(x, y, k)] + self.areas[area][k];
        }
        let at = y * self.columns + x;
        Here { own: self.states[at], r, is_few: !self.few.is_empty() && self.few[at], area }
    }

    #[inline(always)]
    fn best(&self, costs: &Costs<N>, x: usize, y: usize, scratch: &mut Scratch) -> Option<(Change, f32)> {
        let [right, left_below, below, right_below] = NEIGHBOURS;
        // Without a loop, which would keep them in memory.
        let neighbours = [
            self.neighbour(x, y, right),
            self.neighbour(x, y, left_below),
            self.neighbour(x, y, below),
            self.neighbour(x, y, right_below),
        ];
        costs.best(self.at(x, y), neighbours, scratch)
    }

    /// A neighbour of a pixel, if it is inside the picture and may change.
    #[inline(always)]
    fn neighbour(&self, x: usize, y: usize, (right, down): (isize, isize)) -> Option<Here<N>> {
        let (x, y) = (x.wrapping_add_signed(right), y.wrapping_add_signed(down));
        let is_inside = x < self.columns && y < self.states.len() / self.columns;
        if is_inside && !self.is_fixed(x, y) { Some(self.at(x, y)) } else { None }
    }

    #[inline(always)]
    fn make(&mut self, costs: &Costs<N>, x: usize, y: usize, change: Change) {
        self.show(costs, x, y, change.state);
        if let Some((number, state)) = change.other {
            let (right, down) = NEIGHBOURS[number];
            self.show(costs, x.wrapping_add_signed(right), y.wrapping_add_signed(down), state);
        }
    }

    /// Gives a pixel another state, and adds that to the correlated error.
    #[inline(always)]
    fn show(&mut self, costs: &Costs<N>, x: usize, y: usize, state: u8) {
        let columns = self.columns;
        let rows = self.states.len() / columns;
        let before = std::mem::replace(&mut self.states[y * columns + x], state);
        let (shown, before) = (costs.palette[usize::from(state)], costs.palette[usize::from(before)]);
        let area = self.area(x, y);
        for (k, correlation) in costs.correlations.iter().enumerate() {
            let by = shown[k] - before[k];
            self.areas[area][k] += costs.of_areas[k] * by;
            let [across, down] = correlation.reach;
            for to in y.saturating_sub(down)..(y + down + 1).min(rows) {
                let values = correlation.row(to as isize - y as isize);
                let at = self.place(x, to, k) - across;
                // Beyond the borders are margins, and beyond the values are zeros.
                let row = &mut self.correlated[at..at + values.len()];
                for (sums, values) in
                    row.as_chunks_mut::<LANES>().0.iter_mut().zip(values.as_chunks::<LANES>().0)
                {
                    // A copy, which nothing else can change: else no vectors are used.
                    let mut changed = *sums;
                    for lane in 0..LANES {
                        changed[lane] += by * values[lane];
                    }
                    *sums = changed;
                }
            }
        }
        // A pixel depends on the errors of its neighbours, and on those of its area, too.
        let [across, down] = costs.reach().map(|reach| reach + 1);
        let blocks = columns.div_ceil(BLOCK);
        let touched = |at: usize, reach: usize, count: usize| {
            let first = at / AREA * AREA;
            let last = (at + reach).max(first + AREA - 1).min(count - 1);
            at.saturating_sub(reach).min(first) / BLOCK..=last / BLOCK
        };
        let along = touched(x, across, columns);
        for row in touched(y, down, rows) {
            self.touched[row * blocks..][along.clone()].fill(true);
        }
    }
}
