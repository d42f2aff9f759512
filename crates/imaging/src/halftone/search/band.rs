//! Bands of rows that threads search at the same time.
//!
//! A band is changed in its inner rows only, so that what its changes touch is in the band: the result does not
//! depend on the number of threads. In each pass, bands that begin at multiples of a period come first, then
//! those between, which have the other rows inside.

use std::ops::Range;

use pulp::NullaryFnOnce;

use super::correlate::{Correlate, Shown};
use super::costs::{AREA, Alone, Change, Costs, Here, LANES, Lanes, NEIGHBOURS, Scratch};
use super::filter::Correlation;
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
    rows: usize,
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
                let arch = pulp::Arch::new();
                match costs.palette.len() {
                    ..=4 => arch.dispatch(Search::<N, 4> { band, costs, stop }),
                    5..=6 => arch.dispatch(Search::<N, 6> { band, costs, stop }),
                    _ => arch.dispatch(Search::<N, LANES> { band, costs, stop }),
                }
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
                rows,
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

/// The search of a band, with so many states or less, or more than [`LANES`].
struct Search<'a, 'b, const N: usize, const STATES: usize> {
    band: Band<'a, N>,
    costs: &'b Costs<N>,
    stop: &'b (dyn Fn() -> bool + Sync),
}

impl<const N: usize, const STATES: usize> NullaryFnOnce for Search<'_, '_, N, STATES> {
    type Output = Option<Progress>;

    #[inline(always)]
    fn call(mut self) -> Option<Progress> {
        self.band.search::<STATES>(self.costs, self.stop)
    }
}

impl<const N: usize> Band<'_, N> {
    #[inline(always)]
    fn search<const STATES: usize>(
        &mut self,
        costs: &Costs<N>,
        stop: &(dyn Fn() -> bool + Sync),
    ) -> Option<Progress> {
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
            let along = left..(left + BLOCK).min(self.columns);
            for y in top..(top + BLOCK).min(self.inner.end) {
                match &costs.lanes {
                    Some(lanes) => {
                        self.search_row::<STATES>((costs, lanes), along.clone(), y, &mut progress);
                    }
                    None => self.search_row_of_many(costs, along.clone(), y, &mut scratch, &mut progress),
                }
            }
        }
        Some(progress)
    }

    /// Tries some pixels of a row. From one to the next, three of the five that are looked at stay, unless a change is made.
    #[inline(always)]
    fn search_row<const STATES: usize>(
        &mut self,
        (costs, lanes): (&Costs<N>, &Lanes<N>),
        along: Range<usize>,
        y: usize,
        progress: &mut Progress,
    ) {
        let [row, next] = [self.row(y), self.row(y + 1)];
        let [mut below, mut right_below, mut right] = [Alone::FIXED; 3];
        let mut are_known = false;
        for x in along {
            let (mut here, mut left_below) = (right, below);
            below = right_below;
            if !are_known {
                here = self.alone(lanes, &row, x);
                left_below = self.alone(lanes, &next, x.wrapping_sub(1));
                below = self.alone(lanes, &next, x);
            }
            right = self.alone(lanes, &row, x + 1);
            right_below = self.alone(lanes, &next, x + 1);
            are_known = true;
            let neighbours = [right, left_below, below, right_below];
            if here.is_fixed() {
                continue;
            }
            if let Some((change, gain)) = lanes.best::<STATES>(costs.least, here, neighbours) {
                self.make(costs, x, y, change);
                progress.changes += 1;
                progress.gain += f64::from(gain);
                are_known = false;
            }
        }
    }

    /// The places of a row.
    #[inline(always)]
    fn row(&self, y: usize) -> Row<N> {
        Row {
            columns: if y < self.rows { self.columns } else { 0 },
            first: y * self.columns,
            correlated: std::array::from_fn(|k| self.place(0, y, k)),
            area: self.area(0, y),
        }
    }

    /// The costs of a pixel alone.
    #[inline(always)]
    fn alone(&self, lanes: &Lanes<N>, row: &Row<N>, x: usize) -> Alone {
        if x >= row.columns || (!self.fixed.is_empty() && self.fixed[row.first + x]) {
            return Alone::FIXED;
        }
        let (at, area) = (row.first + x, row.area + x / AREA);
        let r = std::array::from_fn(|k| self.correlated[row.correlated[k] + x] + self.areas[area][k]);
        let is_few = !self.few.is_empty() && self.few[at];
        lanes.alone(Here { own: self.states[at], r, is_few, area })
    }

    /// The same of many states.
    #[inline(always)]
    fn search_row_of_many(
        &mut self,
        costs: &Costs<N>,
        along: Range<usize>,
        y: usize,
        scratch: &mut Scratch,
        progress: &mut Progress,
    ) {
        for x in along {
            if self.is_fixed(x, y) {
                continue;
            }
            let neighbours = NEIGHBOURS.map(|step| self.neighbour(x, y, step));
            let Some((change, gain)) = costs.best_of_many(self.at(x, y), neighbours, scratch) else {
                continue;
            };
            self.make(costs, x, y, change);
            progress.changes += 1;
            progress.gain += f64::from(gain);
        }
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

    /// A neighbour of a pixel, if it is inside the picture and may change.
    #[inline(always)]
    fn neighbour(&self, x: usize, y: usize, (right, down): (isize, isize)) -> Option<Here<N>> {
        let (x, y) = (x.wrapping_add_signed(right), y.wrapping_add_signed(down));
        let is_inside = x < self.columns && y < self.rows;
        if is_inside && !self.is_fixed(x, y) { Some(self.at(x, y)) } else { None }
    }

    /// Makes a change, and adds that to the correlated errors.
    #[inline(always)]
    fn make(&mut self, costs: &Costs<N>, x: usize, y: usize, change: Change) {
        let here = self.show(costs, x, y, change.state);
        if let Some((number, state)) = change.other {
            let (right, down) = NEIGHBOURS[number];
            let there = self.show(costs, x.wrapping_add_signed(right), y.wrapping_add_signed(down), state);
            self.add_all(costs, [here, there]);
        } else {
            self.add_all(costs, [here]);
        }
    }

    /// Gives a pixel another state, and adds that to the errors of its area.
    #[inline(always)]
    fn show(&mut self, costs: &Costs<N>, x: usize, y: usize, state: u8) -> Shift<N> {
        let before = std::mem::replace(&mut self.states[y * self.columns + x], state);
        let (shown, before) = (costs.palette[usize::from(state)], costs.palette[usize::from(before)]);
        let by = std::array::from_fn(|k| shown[k] - before[k]);
        let area = self.area(x, y);
        for (k, sum) in self.areas[area].iter_mut().enumerate() {
            *sum += costs.of_areas[k] * by[k];
        }
        Shift { x, y, by }
    }

    /// Adds shifts of a pixel, or of two neighbours, to the correlated errors.
    #[inline(always)]
    fn add_all<const COUNT: usize>(&mut self, costs: &Costs<N>, shifts: [Shift<N>; COUNT]) {
        for (k, correlation) in costs.correlations.iter().enumerate() {
            match correlation.times() {
                1 => self.add::<1, COUNT>(correlation, k, &shifts),
                2 => self.add::<2, COUNT>(correlation, k, &shifts),
                _ => self.add::<0, COUNT>(correlation, k, &shifts),
            }
        }
        // A pixel depends on the errors of its neighbours, and on those of its area, too.
        let [across, down] = costs.reach().map(|reach| reach + 1);
        let blocks = self.columns.div_ceil(BLOCK);
        let touched = |first: usize, last: usize, reach: usize, count: usize| {
            let end = (last + reach).max(last / AREA * AREA + AREA - 1).min(count - 1);
            first.saturating_sub(reach).min(first / AREA * AREA) / BLOCK..=end / BLOCK
        };
        let (left, right) = ends(shifts.each_ref().map(|shift| shift.x));
        let (top, bottom) = ends(shifts.each_ref().map(|shift| shift.y));
        let along = touched(left, right, across, self.columns);
        for row in touched(top, bottom, down, self.rows) {
            self.touched[row * blocks..][along.clone()].fill(true);
        }
    }

    /// Adds a correlation times shifts to the correlated errors of a coordinate. `TIMES` is that of the correlation, or 0.
    #[inline(always)]
    fn add<const TIMES: usize, const COUNT: usize>(
        &mut self,
        correlation: &Correlation,
        k: usize,
        shifts: &[Shift<N>; COUNT],
    ) {
        let [across, down] = correlation.reach;
        let (left, _) = ends(shifts.each_ref().map(|shift| shift.x));
        let (top, bottom) = ends(shifts.each_ref().map(|shift| shift.y));
        let (first, end) = (top.saturating_sub(down), (bottom + down + 1).min(self.rows));
        let stride = N * (self.columns + 2 * self.margin);
        // Beyond the borders are margins, and about the values are zeros.
        let at = self.place(left, first, k) - across;
        let values = correlation.between_zeros();
        let mut from = shifts
            .each_ref()
            .map(|shift| correlation.place(first + down + 1 - shift.y) + 1 - (shift.x - left));
        let times = if TIMES == 0 { correlation.times() } else { TIMES };
        for row in self.correlated[at..].chunks_mut(stride).take(end - first) {
            let Some(row) = row.as_chunks_mut::<LANES>().0.get_mut(..times) else { return };
            for (number, sums) in row.iter_mut().enumerate() {
                // A copy, which nothing else can change: else no vectors are used.
                let mut changed = *sums;
                for (shift, from) in shifts.iter().zip(&from) {
                    let Some(values) = values[from + number * LANES..].first_chunk::<LANES>() else { return };
                    for lane in 0..LANES {
                        changed[lane] += shift.by[k] * values[lane];
                    }
                }
                *sums = changed;
            }
            from = from.map(|from| from + correlation.place(1));
        }
    }
}

/// Places of a row: number of columns, 0 beyond the band; the first of its states, of each coordinate of its correlated errors, and of its
/// areas.
struct Row<const N: usize> {
    columns: usize,
    first: usize,
    correlated: [usize; N],
    area: usize,
}

/// By how much a change shifts a pixel.
struct Shift<const N: usize> {
    x: usize,
    y: usize,
    by: [f32; N],
}

/// The smallest and the largest of one or two numbers.
#[inline(always)]
fn ends<const COUNT: usize>(numbers: [usize; COUNT]) -> (usize, usize) {
    (numbers.into_iter().fold(usize::MAX, usize::min), numbers.into_iter().fold(0, usize::max))
}
