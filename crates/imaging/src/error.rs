//! Errors of pictures.

/// Reason why a picture cannot be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ImagingError {
    /// A font that cannot be read.
    #[error("the font cannot be read: {0}")]
    Font(String),
    /// A character without a glyph in the font.
    #[error("the font has no glyph for {0:?}")]
    Glyph(char),
    /// A number out of its range.
    #[error("{what} is {value} (expected a number above 0)")]
    Range {
        /// Name of the number.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// A picture with too many pixels.
    #[error("the text has {pixels:.1e} pixels (expected {most:.1e} at most)")]
    TooLarge {
        /// Number of pixels.
        pixels: f64,
        /// Largest number.
        most: f64,
    },
    /// A picture that does not consist of whole rows.
    #[error("the picture has {pixels} values (expected a multiple of {columns}, above 0)")]
    Rows {
        /// Number of values.
        pixels: usize,
        /// Values in a row.
        columns: usize,
    },
    /// Planes of a picture with unequal numbers of pixels.
    #[error("a plane of the picture has {pixels} pixels (expected {expected}, as the first one)")]
    Planes {
        /// Number of pixels.
        pixels: usize,
        /// Number of pixels of the first plane.
        expected: usize,
    },
    /// A number of states that is not permitted.
    #[error("the halftone has {states} states (expected 1 to 256)")]
    States {
        /// Number of states.
        states: usize,
    },
    /// An order of states that does not contain each state once.
    #[error("state {state} is out of place in the order of {states} states (expected each state once)")]
    Order {
        /// The state.
        state: u8,
        /// Number of states.
        states: usize,
    },
    /// A palette with a coordinate that is not a finite number.
    #[error("state {state} of the palette has a coordinate that is not a finite number")]
    Palette {
        /// The state.
        state: usize,
    },
    /// A filter that cannot be used.
    #[error(
        "the filter has {columns} x {rows} values (expected odd numbers of columns and rows, and finite values, not all 0)"
    )]
    Filter {
        /// Number of columns.
        columns: usize,
        /// Number of rows.
        rows: usize,
    },
    /// A side of a mask that is not permitted.
    #[error("the mask has sides of {side} pixels (expected {expected})")]
    MaskSide {
        /// Number of pixels.
        side: usize,
        /// Permitted numbers.
        expected: &'static str,
    },
}
