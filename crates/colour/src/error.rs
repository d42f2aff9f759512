//! Errors of colorimetry.

/// Error of preparing an observer, scaling a light or comparing pictures.
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
    /// The planes of a picture are not the same whole rows.
    #[error("the planes of a picture have {values:?} values, which are not the same rows of {columns}")]
    PictureShape {
        /// The stated number of pixels in a row.
        columns: usize,
        /// The number of values of each plane.
        values: [usize; 3],
    },
    /// Two pictures cannot be compared.
    #[error("the pictures have {one:?} and {other:?} columns and rows; they must be the same")]
    PictureSizes {
        /// Columns and rows of the first picture.
        one: [usize; 2],
        /// Columns and rows of the second picture.
        other: [usize; 2],
    },
    /// Colour differences are relative to a white.
    #[error("the white of a picture has a tristimulus value that is not positive")]
    NoWhite,
    /// A hull has 2 to 64 states with finite X, Y and Z.
    #[error(
        "a picture needs 2 to 64 states with finite X, Y and Z; there are {states}, or some without a finite colour"
    )]
    States {
        /// The number of states.
        states: usize,
    },
    /// Black, red, green and blue are in a plane.
    #[error(
        "black, red, green and blue are mixtures of each other, so that the coverages of the sub-pixels are not unique"
    )]
    Dependent,
    /// White and black of a display are mixtures of its states, and white is brighter.
    #[error(
        "no picture is seen in this light and view: white (Y = {white:.4}) must be brighter than black (Y = {black:.4}) in X, Y and Z, and both be \
         mixtures of the states of the display"
    )]
    WhiteAndBlack {
        /// Y of the white.
        white: f64,
        /// Y of the black.
        black: f64,
    },
}
