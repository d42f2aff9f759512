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
        if !(first..=last).contains(&nm) {
            return Err(SpectraError::OutsideTable { nm, first, last });
        }
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
