//! Spectra of the states of a pixel.

use std::ops::{Deref, DerefMut};
use std::slice::{ChunksExact, ChunksExactMut};

/// A spectrum for each state of a pixel, all at the same wavelengths, in the unit of the quantity.
///
/// As a slice, all values state by state: `[state][wavelength]`.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct StateSpectra {
    values: Vec<f64>,
    wavelengths: usize,
}

impl StateSpectra {
    /// Spectra that are 0.
    pub fn zeros(states: usize, wavelengths: usize) -> Self {
        Self { values: vec![0.0; states * wavelengths], wavelengths }
    }

    /// Spectra of these values, `[state][wavelength]`.
    pub fn new(values: Vec<f64>, wavelengths: usize) -> Self {
        debug_assert!(values.is_empty() || values.len().is_multiple_of(wavelengths));
        Self { values, wavelengths }
    }

    /// Number of states.
    pub fn states(&self) -> usize {
        self.values.len().checked_div(self.wavelengths).unwrap_or(0)
    }

    /// Spectrum of a state.
    pub fn state(&self, state: usize) -> &[f64] {
        &self.values[state * self.wavelengths..][..self.wavelengths]
    }

    /// Spectrum of a state, to be changed.
    pub fn state_mut(&mut self, state: usize) -> &mut [f64] {
        &mut self.values[state * self.wavelengths..][..self.wavelengths]
    }

    /// The spectra, state by state.
    pub fn rows(&self) -> ChunksExact<'_, f64> {
        self.values.chunks_exact(self.wavelengths.max(1))
    }

    /// The spectra, state by state, to be changed.
    pub fn rows_mut(&mut self) -> ChunksExactMut<'_, f64> {
        self.values.chunks_exact_mut(self.wavelengths.max(1))
    }

    /// Adds the values of a state after those of the last one, or of several.
    pub fn extend(&mut self, values: impl IntoIterator<Item = f64>) {
        self.values.extend(values);
    }

    /// Applies `f` to all values.
    pub fn map(&self, f: impl FnMut(f64) -> f64) -> Self {
        Self { values: self.values.iter().copied().map(f).collect(), wavelengths: self.wavelengths }
    }
}

impl Deref for StateSpectra {
    type Target = [f64];
    fn deref(&self) -> &[f64] {
        &self.values
    }
}

impl DerefMut for StateSpectra {
    fn deref_mut(&mut self) -> &mut [f64] {
        &mut self.values
    }
}

impl<'a> IntoIterator for &'a StateSpectra {
    type Item = &'a f64;
    type IntoIter = std::slice::Iter<'a, f64>;
    fn into_iter(self) -> Self::IntoIter {
        self.values.iter()
    }
}

impl<'a> IntoIterator for &'a mut StateSpectra {
    type Item = &'a mut f64;
    type IntoIter = std::slice::IterMut<'a, f64>;
    fn into_iter(self) -> Self::IntoIter {
        self.values.iter_mut()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn states_are_rows_of_wavelengths() {
        let mut spectra = StateSpectra::new(vec![1.0, 2.0, 3.0, 4.0], 2);
        assert_eq!((spectra.states(), spectra.state(1)), (2, &[3.0, 4.0][..]));
        spectra.extend([5.0, 6.0]);
        spectra.state_mut(0)[1] = 0.0;
        assert_eq!(spectra.rows().map(|row| row.iter().sum()).collect::<Vec<f64>>(), [1.0, 7.0, 11.0]);
        assert_eq!(spectra.map(|value| -value).state(2), [-5.0, -6.0]);
        assert_eq!((StateSpectra::default().states(), StateSpectra::zeros(3, 2).len()), (0, 6));
    }
}
