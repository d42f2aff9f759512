//! `[pattern]`: patterns of two states, and text, for `papilio mtf`.

use papilio_display::spatial::PatternKind;

use super::Title;
use super::numbers::Millimetres;
use crate::grammar::{choice, table};
use crate::read::Spanned;
use crate::word::Word;

/// Patterns without `kind`.
const BOTH: [PatternKind; 2] = [PatternKind::Stripes, PatternKind::Checkerboard];

table! {
    /// Patterns of two states, for `papilio mtf` only. No matrix is needed: edges are ideal.
    Pattern {
        /// Kinds of patterns, each with half of its area in either state. Stripes repeat along x.
        kind: Vec<Spanned<Word<PatternKind>>> = BOTH.map(|kind| Spanned::without_span(Word(kind))).to_vec(),
        /// State of one half of the area.
        on: Title = Title("white".to_owned()),
        /// State of the other half.
        off: Title = Title("black".to_owned()),
        /// Periods of the patterns.
        period_mm as "Periods of patterns": Vec<Spanned<Millimetres>> = Vec::new(),
        /// Text whose contrast is computed, black on white on the pixels of the matrix; its size is
        /// `viewer.text_height_mm`.
        text: Title = Title("Papilio".to_owned()),
    }
}

choice! {
    for PatternKind {
        /// Along y, half of a period each.
        Stripes = "stripes",
        /// Squares with sides of half a period.
        Checkerboard = "checkerboard",
    }
}
