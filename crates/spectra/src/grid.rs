//! The wavelength grid of all spectra of one computation.

use crate::SpectraError;

/// Uniformly spaced wavelengths in nm.
///
/// ```
/// let grid = papilio_spectra::Grid::new(380.0, 780.0, 5.0).unwrap();
/// assert_eq!(grid.len(), 81);
/// assert_eq!(grid.wavelength_nm(80), 780.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid {
    start_nm: f64,
    step_nm: f64,
    len: usize,
}

impl Grid {
    /// Largest number of wavelengths of a grid.
    pub const MAX_LEN: usize = 20_001;

    /// Grid from `start_nm` to `stop_nm` inclusive in steps of `step_nm`.
    ///
    /// # Errors
    /// Unless 0 < start < stop, the step is positive, and an integer number of
    /// steps (to 1e-6 of one) fits between start and stop.
    pub fn new(start_nm: f64, stop_nm: f64, step_nm: f64) -> Result<Self, SpectraError> {
        let bad = || SpectraError::Grid { start_nm, stop_nm, step_nm };
        let in_order = start_nm > 0.0 && stop_nm > start_nm && step_nm > 0.0 && stop_nm.is_finite();
        if !in_order {
            return Err(bad());
        }
        let steps = (stop_nm - start_nm) / step_nm;
        if (steps - steps.round()).abs() > 1e-6 || steps.round() + 1.0 > Self::MAX_LEN as f64 {
            return Err(bad());
        }
        Ok(Self { start_nm, step_nm, len: steps.round() as usize + 1 })
    }

    /// Number of wavelengths, at least 2.
    #[allow(clippy::len_without_is_empty, reason = "a grid is never empty")]
    pub fn len(&self) -> usize {
        self.len
    }

    /// Wavelength of bin `i`, nm.
    pub fn wavelength_nm(&self, i: usize) -> f64 {
        self.start_nm + self.step_nm * i as f64
    }

    /// First wavelength, nm.
    pub fn start_nm(&self) -> f64 {
        self.start_nm
    }

    /// Last wavelength, nm.
    pub fn stop_nm(&self) -> f64 {
        self.wavelength_nm(self.len - 1)
    }

    /// Distance between neighbours, nm.
    pub fn step_nm(&self) -> f64 {
        self.step_nm
    }

    /// All wavelengths, ascending, nm.
    pub fn wavelengths_nm(&self) -> Vec<f64> {
        (0..self.len).map(|i| self.wavelength_nm(i)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_and_step_are_those_of_the_range() {
        let grid = Grid::new(380.0, 780.0, 5.0).unwrap();
        assert_eq!((grid.start_nm(), grid.stop_nm(), grid.step_nm(), grid.len()), (380.0, 780.0, 5.0, 81));
    }
}
