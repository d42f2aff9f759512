//! What can be wrong with a surface.

/// What can be wrong with a surface.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MicrogeometryError {
    /// A map has the wrong number of heights.
    #[error("a height map of {columns} x {rows} has {heights} heights")]
    NumberOfHeights {
        /// Columns of the map.
        columns: usize,
        /// Rows of the map.
        rows: usize,
        /// Heights that were given.
        heights: usize,
    },
    /// A height is not a finite number, or a distance between heights is not positive.
    #[error("the {what} of a height map is {value}, not a {wanted} number")]
    NotANumber {
        /// The quantity, with its unit.
        what: &'static str,
        /// Its value.
        value: f64,
        /// "finite" or "positive".
        wanted: &'static str,
    },
}
