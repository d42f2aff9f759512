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
}
