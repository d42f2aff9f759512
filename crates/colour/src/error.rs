//! Errors of colorimetry.

/// Error of preparing an observer or scaling a light.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum ColourError {
    /// The grid contains no wavelength at which the observer is tabulated.
    #[error(
        "the wavelength range {start_nm} to {stop_nm} nm contains no integer nanometre from 380 to 780 nm, where the observer is tabulated"
    )]
    NothingVisible {
        /// First wavelength of the grid.
        start_nm: f64,
        /// Last wavelength of the grid.
        stop_nm: f64,
    },
    /// A spectrum without visible light cannot be scaled to an illuminance.
    #[error("a spectrum without visible light cannot be scaled to {lux} lx")]
    Dark {
        /// The requested illuminance.
        lux: f64,
    },
}
