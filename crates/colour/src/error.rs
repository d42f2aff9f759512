//! What can be wrong with light that is to be seen.

/// Why an observer cannot look, or a light cannot be scaled.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum ColourError {
    /// The grid holds no whole nanometre at which the observer is tabulated.
    #[error("no whole nanometre of {start_nm} to {stop_nm} nm lies within the observer's 380 to 780 nm")]
    NothingVisible {
        /// First wavelength of the grid.
        start_nm: f64,
        /// Last wavelength of the grid.
        stop_nm: f64,
    },
    /// A spectrum without visible light cannot be scaled to an illuminance.
    #[error("a spectrum without visible light cannot be scaled to {lux} lx")]
    Dark {
        /// The illuminance asked for.
        lux: f64,
    },
}
