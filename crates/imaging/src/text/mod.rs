//! Text on the pixels of a panel.
//!
//! **What.** The outlines of the glyphs are placed one after the other at their advances, without rounding,
//! hinting or kerning. A pixel is black where the outlines cover half of its area or more: what a bistable
//! panel without grey levels shows.
//!
//! A [`Block`] is text in lines on a page, with the fraction of each pixel that is covered.
//!
//! **Contrast of text** is measured in the middles of strokes and of the gaps between them ([`Middles`]).

pub(crate) mod area;
mod block;
mod font;
mod middles;

pub use block::Block;
pub use font::{Font, ROBOTO, ROBOTO_BOLD, Setting};
pub use middles::Middles;

/// Height of the lower-case x of the bundled font over its em.
pub const X_HEIGHT: f64 = 1082.0 / 2048.0;

/// Black and white pixels.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Bitmap {
    /// Number of columns and rows.
    pub count: [usize; 2],
    /// For each pixel, row by row from the bottom: whether it is black.
    pub black: Vec<bool>,
    /// Number of pixels of an em along x and y, rounded up.
    pub em: [usize; 2],
}

impl Bitmap {
    /// Finds the middles of strokes and of gaps.
    pub fn middles(&self) -> Middles {
        Middles::of(self)
    }

    /// Returns the same from this column and row on, on a white page of this many columns and rows, on which it
    /// has room.
    pub fn on_page(&self, at: [usize; 2], count: [usize; 2]) -> Self {
        let mut black = vec![false; count[0] * count[1]];
        for (row, pixels) in self.black.chunks_exact(self.count[0].max(1)).enumerate() {
            let start = (row + at[1]) * count[0] + at[0];
            black[start..][..pixels.len()].copy_from_slice(pixels);
        }
        Self { count, black, em: self.em }
    }
}
