//! Direct binary search: the halftone whose filtered picture is nearest to the wanted one.
//!
//! The error is `E = sum over coordinates and pixels of (h * (shown - wanted))^2` with a filter h for each
//! coordinate: what the eye and the stack pass. In a pass, each pixel tries every other state and every
//! exchange with one of its neighbours, and takes the best one if it lowers E; the search ends when no pixel
//! finds any. Beyond the borders nothing is wrong.
//!
//! **Method.** M. Analoui and J. P. Allebach, Proc. SPIE 1666, 96 (1992): with the autocorrelation c of the
//! filter and the error correlated with it, `r = c * (shown - wanted)`, a change of a pixel by d changes E by
//! `2 d r + d^2 c(0)`, and only an accepted change updates r, in reach of c.
//!
//! **Limits.** The result is a local minimum, which depends on the start; from error diffusion it is reached
//! sooner and is as good as from noise. A few seconds to minutes for a page, by the size of the filter.

use std::ops::ControlFlow;

use super::{check_rows, check_states};
use crate::ImagingError;

/// A sampled filter, symmetric in the sense that its middle is its place: an odd number of columns and rows,
/// by rows from the top.
#[derive(Debug, Clone, PartialEq)]
pub struct Filter {
    columns: usize,
    values: Vec<f64>,
}

impl Filter {
    /// A filter of `columns` columns.
    ///
    /// # Errors
    /// If the number of columns or rows is even, or a value is not finite, or all are 0.
    pub fn new(columns: usize, values: Vec<f64>) -> Result<Self, ImagingError> {
        check_rows(values.len(), columns)?;
        let rows = values.len() / columns;
        let usable = columns % 2 == 1
            && rows % 2 == 1
            && values.iter().all(|value| value.is_finite())
            && values.iter().any(|value| *value != 0.0);
        if usable { Ok(Self { columns, values }) } else { Err(ImagingError::Filter { columns, rows }) }
    }

    /// Autocorrelation: `c(x) = sum of h(y) h(x + y)`.
    fn autocorrelation(&self) -> Self {
        let (columns, rows) = (self.columns, self.values.len() / self.columns);
        let (wide, high) = (2 * columns - 1, 2 * rows - 1);
        let mut values = vec![0.0; wide * high];
        for (a, first) in self.values.iter().enumerate() {
            for (b, second) in self.values.iter().enumerate() {
                let x = columns - 1 + b % columns - a % columns;
                let y = rows - 1 + b / columns - a / columns;
                values[y * wide + x] += first * second;
            }
        }
        Self { columns: wide, values }
    }

    fn middle(&self) -> f64 {
        self.values[self.values.len() / 2]
    }
}

/// State of a direct binary search after a pass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SearchPass {
    /// Number of the pass, from 1.
    pub pass: usize,
    /// Changes in this pass.
    pub changes: usize,
    /// The error E after it.
    pub error: f64,
}

/// Result of a direct binary search.
#[derive(Debug, Clone, PartialEq)]
pub struct Searched {
    /// The state of each pixel.
    pub states: Vec<u8>,
    /// The error E of the start; 0, as `error`, if the search was stopped before it was known.
    pub error_at_start: f64,
    /// The error E of the result.
    pub error: f64,
    /// Number of passes.
    pub passes: usize,
    /// Whether no change lowers the error; false if the search was stopped.
    pub is_complete: bool,
}

/// Direct binary search from a start.
///
/// `wanted` has the coordinates of each pixel by rows, `palette` those of each state: X, Y, Z, or linear
/// combinations of them such as opponent colours, for which the eye's filters differ. `filters` are those of
/// the coordinates. `start` has a state for each pixel, usually from [error
/// diffusion](super::ErrorDiffusion). After each pass, `watch` may stop the search by `ControlFlow::Break`;
/// `stop` is asked after each row.
///
/// # Errors
/// If the pictures do not have the same number of whole rows, the palette is empty, too large or not finite,
/// or a state of the start is not in the palette.
pub fn direct_binary_search<const N: usize>(
    wanted: &[[f32; N]],
    columns: usize,
    palette: &[[f64; N]],
    filters: &[Filter; N],
    start: &[u8],
    stop: &dyn Fn() -> bool,
    watch: &mut dyn FnMut(SearchPass) -> ControlFlow<()>,
) -> Result<Searched, ImagingError> {
    check_rows(wanted.len(), columns)?;
    check_states(palette.len())?;
    if start.len() != wanted.len() {
        return Err(ImagingError::Planes { pixels: start.len(), expected: wanted.len() });
    }
    if let Some(state) = palette.iter().position(|colour| !colour.iter().all(|value| value.is_finite())) {
        return Err(ImagingError::Palette { state });
    }
    if let Some(state) = start.iter().find(|state| usize::from(**state) >= palette.len()) {
        return Err(ImagingError::Order { state: *state, states: palette.len() });
    }
    let mut searched =
        Searched { states: Vec::new(), error_at_start: 0.0, error: 0.0, passes: 0, is_complete: false };
    let Some(mut search) = Search::new(wanted, columns, palette, filters, start, stop) else {
        searched.states = start.to_vec();
        return Ok(searched);
    };
    searched.error_at_start = search.error;
    while let Some(changes) = search.pass(stop) {
        searched.passes += 1;
        let pass = SearchPass { pass: searched.passes, changes, error: search.error.max(0.0) };
        searched.is_complete = changes == 0;
        if watch(pass).is_break() || searched.is_complete {
            break;
        }
    }
    searched.error = search.error.max(0.0);
    searched.states = search.states;
    Ok(searched)
}

/// The neighbours with which a pixel exchanges its state; the other four find this pixel as their neighbour.
const NEIGHBOURS: [(isize, isize); 4] = [(1, 0), (-1, 1), (0, 1), (1, 1)];

/// A change of a pixel.
#[derive(Clone, Copy)]
enum Change {
    To(u8),
    /// Exchange with the pixel at this place.
    With(usize),
}

struct Search<'a, const N: usize> {
    columns: usize,
    rows: usize,
    palette: &'a [[f64; N]],
    correlations: [Filter; N],
    states: Vec<u8>,
    /// The error correlated with the autocorrelation of the filter.
    correlated: Vec<[f64; N]>,
    error: f64,
    /// A change must lower the error by this much, so that rounding cannot go in circles.
    least: f64,
    /// For each row, whether something in reach of it has changed since its last visit.
    touched: Vec<bool>,
}

impl<'a, const N: usize> Search<'a, N> {
    /// Correlates the error of the start; `None` if it was stopped.
    fn new(
        wanted: &[[f32; N]],
        columns: usize,
        palette: &'a [[f64; N]],
        filters: &[Filter; N],
        start: &[u8],
        stop: &dyn Fn() -> bool,
    ) -> Option<Self> {
        let rows = wanted.len() / columns;
        let correlations = filters.each_ref().map(Filter::autocorrelation);
        let mut extent: f64 = 0.0;
        for (k, correlation) in correlations.iter().enumerate() {
            let along = palette.iter().map(|colour| colour[k]);
            let (low, high) = along.fold((f64::MAX, f64::MIN), |(low, high), v| (low.min(v), high.max(v)));
            extent += (high - low).powi(2) * correlation.middle();
        }
        let mut search = Self {
            columns,
            rows,
            palette,
            correlations,
            states: start.to_vec(),
            correlated: vec![[0.0; N]; wanted.len()],
            error: 0.0,
            least: 1e-9 * extent,
            touched: vec![true; rows],
        };
        let errors: Vec<[f64; N]> = wanted
            .iter()
            .zip(start)
            .map(|(wanted, state)| {
                let shown = palette[usize::from(*state)];
                std::array::from_fn(|k| {
                    let wanted = f64::from(wanted[k]);
                    shown[k] - if wanted.is_finite() { wanted } else { 0.0 }
                })
            })
            .collect();
        for (row, errors) in errors.chunks_exact(columns).enumerate() {
            if stop() {
                return None;
            }
            for (column, error) in errors.iter().enumerate() {
                search.spread(row * columns + column, *error);
            }
        }
        let products = errors.iter().zip(&search.correlated);
        search.error = products.map(|(error, r)| error.iter().zip(r).map(|(e, r)| e * r).sum::<f64>()).sum();
        Some(search)
    }

    /// Adds a change of the shown colour of a pixel to the correlated error.
    fn spread(&mut self, at: usize, by: [f64; N]) {
        let (column, row) = (at % self.columns, at / self.columns);
        for (k, correlation) in self.correlations.iter().enumerate() {
            if by[k] == 0.0 {
                continue;
            }
            let (wide, high) = (correlation.columns, correlation.values.len() / correlation.columns);
            let (left, up) = (wide / 2, high / 2);
            let first = column.saturating_sub(left);
            let last = (column + left + 1).min(self.columns);
            for y in row.saturating_sub(up)..(row + up + 1).min(self.rows) {
                let values = &correlation.values[(y + up - row) * wide + first + left - column..];
                let correlated = &mut self.correlated[y * self.columns + first..y * self.columns + last];
                for (r, c) in correlated.iter_mut().zip(values) {
                    r[k] += by[k] * c;
                }
                self.touched[y] = true;
            }
        }
    }

    /// One pass over all pixels near which something changed; the number of changes, or `None` if it was
    /// stopped.
    fn pass(&mut self, stop: &dyn Fn() -> bool) -> Option<usize> {
        let mut changes = 0;
        for row in 0..self.rows {
            if stop() {
                return None;
            }
            // An exchange with a pixel of the next row depends on that row, too.
            let next = self.touched.get(row + 1).is_some_and(|touched| *touched);
            if !(std::mem::replace(&mut self.touched[row], false) || next) {
                continue;
            }
            for at in row * self.columns..(row + 1) * self.columns {
                if let Some((change, gain)) = self.best(at) {
                    self.make(at, change);
                    self.error -= gain;
                    changes += 1;
                }
            }
        }
        Some(changes)
    }

    /// The change of a pixel that lowers the error most, and by how much.
    fn best(&self, at: usize) -> Option<(Change, f64)> {
        let (mut best, mut most) = (None, self.least);
        let own = self.states[at];
        let r = self.correlated[at];
        for (state, colour) in self.palette.iter().enumerate() {
            let d = difference(*colour, self.palette[usize::from(own)]);
            let gain =
                -(0..N).map(|k| d[k] * (2.0 * r[k] + d[k] * self.correlations[k].middle())).sum::<f64>();
            if gain > most {
                (best, most) = (Some(Change::To(state as u8)), gain);
            }
        }
        let (column, row) = (at % self.columns, at / self.columns);
        for (right, down) in NEIGHBOURS {
            let (x, y) = (column.wrapping_add_signed(right), row.wrapping_add_signed(down));
            if x >= self.columns || y >= self.rows {
                continue;
            }
            let other = y * self.columns + x;
            if self.states[other] == own {
                continue;
            }
            let d = difference(self.palette[usize::from(self.states[other])], self.palette[usize::from(own)]);
            let s = self.correlated[other];
            let one = |k: usize| {
                let correlation = &self.correlations[k];
                let (wide, middle) = (correlation.columns, correlation.values.len() / 2);
                let (left, up) = (wide / 2, correlation.values.len() / wide / 2);
                let reached = right.unsigned_abs() <= left && down.unsigned_abs() <= up;
                let near = if reached {
                    correlation.values[middle.wrapping_add_signed(down * wide as isize + right)]
                } else {
                    0.0
                };
                2.0 * d[k] * (r[k] - s[k] + d[k] * (correlation.middle() - near))
            };
            let gain = -(0..N).map(one).sum::<f64>();
            if gain > most {
                (best, most) = (Some(Change::With(other)), gain);
            }
        }
        best.map(|change| (change, most))
    }

    fn make(&mut self, at: usize, change: Change) {
        let own = self.states[at];
        let (state, other) = match change {
            Change::To(state) => (state, None),
            Change::With(other) => (self.states[other], Some(other)),
        };
        let d = difference(self.palette[usize::from(state)], self.palette[usize::from(own)]);
        self.states[at] = state;
        self.spread(at, d);
        self.touched[at / self.columns] = true;
        if let Some(other) = other {
            self.states[other] = own;
            self.spread(other, d.map(|value| -value));
        }
    }
}

fn difference<const N: usize>(a: [f64; N], b: [f64; N]) -> [f64; N] {
    std::array::from_fn(|k| a[k] - b[k])
}
