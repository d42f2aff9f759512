//! Spectra on a grid, and tables from which they are interpolated.

use std::ops::{Deref, DerefMut};

use crate::{Grid, SpectraError};

/// Values of a quantity at the wavelengths of a [`Grid`], in the unit of the quantity.
///
/// The spectrum does not store its grid; the owner of the computation does.
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrum(Vec<f64>);

impl Spectrum {
    /// Spectrum with the same value at every wavelength.
    pub fn constant(grid: &Grid, value: f64) -> Self {
        Self(vec![value; grid.len()])
    }

    /// Spectrum of the values of `f` at each wavelength in nm.
    pub fn from_fn(grid: &Grid, f: impl FnMut(f64) -> f64) -> Self {
        Self(grid.wavelengths_nm().into_iter().map(f).collect())
    }

    /// Spectrum from values in the order of the grid's wavelengths.
    pub fn from_values(values: Vec<f64>) -> Self {
        Self(values)
    }

    /// Applies `f` element-wise to this spectrum and another on the same grid.
    pub fn zip_map(&self, other: &Self, f: impl Fn(f64, f64) -> f64) -> Self {
        debug_assert_eq!(self.len(), other.len());
        Self(self.iter().zip(other.iter()).map(|(&a, &b)| f(a, b)).collect())
    }

    /// Applies `f` element-wise.
    pub fn map(&self, f: impl Fn(f64) -> f64) -> Self {
        Self(self.iter().map(|&a| f(a)).collect())
    }

    /// Returns true if the value is the same at all wavelengths.
    pub fn is_constant(&self) -> bool {
        self.windows(2).all(|pair| pair[0] == pair[1])
    }

    /// Largest value.
    pub fn max(&self) -> f64 {
        self.iter().copied().fold(f64::NEG_INFINITY, f64::max)
    }

    /// Smallest value.
    pub fn min(&self) -> f64 {
        self.iter().copied().fold(f64::INFINITY, f64::min)
    }
}

impl Deref for Spectrum {
    type Target = [f64];
    fn deref(&self) -> &[f64] {
        &self.0
    }
}

impl DerefMut for Spectrum {
    fn deref_mut(&mut self) -> &mut [f64] {
        &mut self.0
    }
}

impl From<Vec<f64>> for Spectrum {
    fn from(values: Vec<f64>) -> Self {
        Self(values)
    }
}

/// Quantity tabulated against wavelength, linear between its points.
#[derive(Debug, Clone, PartialEq)]
pub struct Tabulated {
    wavelength_nm: Vec<f64>,
    value: Vec<f64>,
}

impl Tabulated {
    /// Table of points in strictly ascending order of wavelength (nm), all finite.
    ///
    /// # Errors
    /// If the two lengths differ, there are fewer than two points, a number is
    /// not finite, or the wavelengths do not ascend; the error names the point.
    pub fn new(wavelength_nm: Vec<f64>, value: Vec<f64>) -> Result<Self, SpectraError> {
        if wavelength_nm.len() != value.len() || wavelength_nm.len() < 2 {
            return Err(SpectraError::TooFewPoints { points: wavelength_nm.len().min(value.len()) });
        }
        for i in 0..value.len() {
            if !wavelength_nm[i].is_finite() || !value[i].is_finite() {
                return Err(SpectraError::NotFinite { point: i });
            }
            if i > 0 && wavelength_nm[i] <= wavelength_nm[i - 1] {
                return Err(SpectraError::NotAscending { point: i });
            }
        }
        Ok(Self { wavelength_nm, value })
    }

    /// First and last wavelength of the table, nm.
    pub fn range_nm(&self) -> (f64, f64) {
        (self.wavelength_nm[0], self.wavelength_nm[self.wavelength_nm.len() - 1])
    }

    /// The tabulated values.
    pub fn values(&self) -> &[f64] {
        &self.value
    }

    /// The tabulated wavelengths, nm.
    pub fn wavelengths_nm(&self) -> &[f64] {
        &self.wavelength_nm
    }

    /// Interpolates the value at `nm` linearly between neighbours.
    ///
    /// # Errors
    /// If `nm` is outside the table.
    pub fn at(&self, nm: f64) -> Result<f64, SpectraError> {
        let (first, last) = self.range_nm();
        let nm = within(nm, (first, last)).ok_or(SpectraError::OutsideTable { nm, first, last })?;
        let right = self.wavelength_nm.partition_point(|&w| w < nm).max(1);
        let (x0, x1) = (self.wavelength_nm[right - 1], self.wavelength_nm[right]);
        let t = (nm - x0) / (x1 - x0);
        Ok(self.value[right - 1] * (1.0 - t) + self.value[right] * t)
    }

    /// Interpolates the table at every wavelength of `grid`.
    ///
    /// # Errors
    /// If the table does not cover the grid.
    pub fn on(&self, grid: &Grid) -> Result<Spectrum, SpectraError> {
        let values: Result<Vec<f64>, _> = grid.wavelengths_nm().into_iter().map(|nm| self.at(nm)).collect();
        values.map(Spectrum)
    }
}

/// Largest distance from the end of a range, nm, that is taken for the rounding of another unit: 3.2627421 eV
/// are 380 nm. It is much less than the resolution of instruments.
const ROUNDED_NM: f64 = 1e-3;

/// Returns a wavelength that is within a range, or outside it by no more than the rounding of its ends: then
/// it is the end.
pub(crate) fn within(nm: f64, (first, last): (f64, f64)) -> Option<f64> {
    (first - ROUNDED_NM..=last + ROUNDED_NM).contains(&nm).then(|| nm.clamp(first, last))
}

/// Returns the scalar product of two spectra, up to the length of the shorter one.
///
/// Eight partial sums allow SIMD; a single sum would wait for each addition.
///
/// ```
/// let (a, b) = ([1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0], [1.0; 10]);
/// assert_eq!(papilio_spectra::sum_of_products(&a, &b), 45.0);
/// ```
pub fn sum_of_products(a: &[f64], b: &[f64]) -> f64 {
    const LANES: usize = 8;
    let count = a.len().min(b.len());
    let (a, a_rest) = a[..count].as_chunks::<LANES>();
    let (b, b_rest) = b[..count].as_chunks::<LANES>();
    let mut sums = [0.0; LANES];
    for (a, b) in a.iter().zip(b) {
        (0..LANES).for_each(|k| sums[k] += a[k] * b[k]);
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    sums.iter().sum::<f64>() + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ends of a table that were converted from another unit.
    #[test]
    fn rounded_end_of_a_table_covers_the_wavelength_that_was_meant() {
        let table = Tabulated::new(vec![380.000_000_12, 779.999_7], vec![1.0, 2.0]).unwrap();
        assert_eq!((table.at(380.0), table.at(780.0)), (Ok(1.0), Ok(2.0)));
        assert!(matches!(table.at(379.99), Err(SpectraError::OutsideTable { .. })));
        assert!(matches!(table.at(780.01), Err(SpectraError::OutsideTable { .. })));
    }
}
