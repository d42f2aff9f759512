//! Filters and their autocorrelations.

use super::super::check_rows;
use super::costs::LANES;
use crate::ImagingError;

/// A sampled filter, symmetric in the sense that its middle is its place: an odd number of columns and rows,
/// by rows from the top.
#[derive(Debug, Clone, PartialEq)]
pub struct Filter {
    columns: usize,
    values: Vec<f64>,
    mean_weight: f64,
}

/// Values of an autocorrelation, over its middle, below which its outer columns and rows are left out. With 3 %,
/// that of the eye is not positive definite any more, and a search finds patterns that are none.
const SMALLEST: f64 = 0.01;

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
        if usable {
            Ok(Self { columns, values, mean_weight: 0.0 })
        } else {
            Err(ImagingError::Filter { columns, rows })
        }
    }

    /// The same with a weight, 0 or more, of the mean error of areas of 32 x 32 pixels, over that of what the filter
    /// passes. The least error of a pattern is not at its wanted mean: with weight w, a flat tone is off by 1/(1 + w) of
    /// what it is without.
    #[must_use]
    pub fn keeping_means(self, weight: f64) -> Self {
        Self { mean_weight: weight, ..self }
    }

    /// What the square of the sum of the errors of an area adds to the error, for areas of so many pixels.
    pub(super) fn weight_of_area(&self, pixels: usize) -> f64 {
        self.mean_weight * self.values.iter().sum::<f64>().powi(2) / pixels as f64
    }

    /// The values, by rows from the top.
    #[cfg(test)]
    pub(in super::super) fn values(&self) -> &[f64] {
        &self.values
    }

    /// Autocorrelation: `c(x) = sum of h(y) h(x + y)`, without its outer columns and rows of small values.
    pub(super) fn autocorrelation(&self) -> Correlation {
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
        let least = SMALLEST * values[values.len() / 2];
        let large = |at: &usize| values[*at].abs() >= least;
        let away = |at: usize, middle: usize| at.abs_diff(middle);
        let reaches = (0..values.len()).filter(large).fold([0, 0], |[x, y], at| {
            [x.max(away(at % wide, columns - 1)), y.max(away(at / wide, rows - 1))]
        });
        let [along_x, along_y] = reaches;
        let inner = (rows - 1 - along_y..rows + along_y)
            .flat_map(|y| &values[y * wide..][columns - 1 - along_x..columns + along_x]);
        Correlation::new(reaches, inner.copied().collect())
    }
}

/// An autocorrelation about its middle.
#[derive(Debug, Clone)]
pub(super) struct Correlation {
    /// Columns and rows on each side of the middle.
    pub(super) reach: [usize; 2],
    values: Vec<f64>,
    /// The values by rows, between zeros: a row above and below, a column on the left, and on the right so many that rows begin at
    /// multiples of [`LANES`].
    between_zeros: Vec<f32>,
    /// Values along x and along y whose products are the values, if there are such.
    pub(super) factors: Option<[Vec<f32>; 2]>,
}

/// Part of the middle by which products may differ from the values.
const ROUNDING: f64 = 1e-12;

impl Correlation {
    fn new(reach: [usize; 2], values: Vec<f64>) -> Self {
        let columns = 2 * reach[0] + 1;
        let middle = values[values.len() / 2];
        let across = &values[reach[1] * columns..][..columns];
        let down: Vec<f64> = values.iter().skip(reach[0]).step_by(columns).map(|one| one / middle).collect();
        let is_product = values.iter().enumerate().all(|(at, value)| {
            (across[at % columns] * down[at / columns] - value).abs() <= ROUNDING * middle.abs()
        });
        let single = |values: &[f64]| values.iter().map(|one| *one as f32).collect::<Vec<f32>>();
        let factors = is_product.then(|| [single(across), single(&down)]);
        let stride = columns.next_multiple_of(LANES) + LANES;
        let mut between_zeros = vec![0.0; stride * (2 * reach[1] + 3)];
        for (row, values) in between_zeros.chunks_exact_mut(stride).skip(1).zip(values.chunks_exact(columns))
        {
            row[1..].iter_mut().zip(values).for_each(|(to, value)| *to = *value as f32);
        }
        Self { reach, values, between_zeros, factors }
    }

    pub(super) fn middle(&self) -> f64 {
        self.values[self.values.len() / 2]
    }

    /// The value at a step from the middle; 0 beyond the reach.
    pub(super) fn at(&self, right: isize, down: isize) -> f64 {
        let [x, y] = self.reach;
        if right.unsigned_abs() > x || down.unsigned_abs() > y {
            return 0.0;
        }
        self.values[y.wrapping_add_signed(down) * (2 * x + 1) + x.wrapping_add_signed(right)]
    }

    /// How many times [`LANES`] numbers hold a row of values, and one more.
    #[inline(always)]
    pub(super) fn times(&self) -> usize {
        (2 * self.reach[0] + 1).div_ceil(LANES)
    }

    /// The values of a row within the reach, from the left.
    #[inline(always)]
    pub(super) fn row(&self, down: isize) -> &[f32] {
        let row = (self.reach[1] + 1).wrapping_add_signed(down);
        &self.between_zeros[self.place(row) + 1..][..2 * self.reach[0] + 1]
    }

    /// The place of a row in [`between_zeros`](Self::between_zeros), the first of which is a row of zeros.
    #[inline(always)]
    pub(super) fn place(&self, row: usize) -> usize {
        row * (self.times() + 1) * LANES
    }

    /// The values by rows, each row and each column after zeros.
    #[inline(always)]
    pub(super) fn between_zeros(&self) -> &[f32] {
        &self.between_zeros
    }
}
