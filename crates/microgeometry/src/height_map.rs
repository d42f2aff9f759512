//! A surface as heights over a periodic rectangle.

use crate::MicrogeometryError;

/// Heights over a rectangle that repeats in x and y.
#[derive(Debug, Clone, PartialEq)]
pub struct HeightMap {
    columns: usize,
    pitch_um: [f64; 2],
    heights_um: Vec<f64>,
}

impl HeightMap {
    /// Heights by rows; the first row is at y = 0, the first column at x = 0. `pitch_um`: distance between heights along x and y.
    ///
    /// # Errors
    /// A number of heights that is not a positive multiple of the columns, a height that is not finite, a distance that is not positive.
    pub fn new(columns: usize, pitch_um: [f64; 2], heights_um: Vec<f64>) -> Result<Self, MicrogeometryError> {
        let rows = heights_um.len().checked_div(columns).unwrap_or(0);
        if rows == 0 || rows * columns != heights_um.len() {
            return Err(MicrogeometryError::NumberOfHeights { columns, rows, heights: heights_um.len() });
        }
        if let Some(value) = pitch_um.into_iter().find(|pitch| !(pitch.is_finite() && *pitch > 0.0)) {
            return Err(MicrogeometryError::NotANumber { what: "pitch (um)", value, wanted: "positive" });
        }
        if let Some(value) = heights_um.iter().copied().find(|height| !height.is_finite()) {
            return Err(MicrogeometryError::NotANumber { what: "height (um)", value, wanted: "finite" });
        }
        Ok(Self { columns, pitch_um, heights_um })
    }

    /// Heights along x.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Heights along y.
    pub fn rows(&self) -> usize {
        self.heights_um.len() / self.columns
    }

    /// Distances between heights along x and y, um.
    pub fn pitch_um(&self) -> [f64; 2] {
        self.pitch_um
    }

    /// All heights by rows, um.
    pub fn heights_um(&self) -> &[f64] {
        &self.heights_um
    }
}
