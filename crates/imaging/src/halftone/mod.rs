//! Halftones: for each pixel of a picture the state of a display that has only a few of them.
//!
//! | method | input | result |
//! |---|---|---|
//! | [`ordered`] | coverages of the states | a [`Mask`] decides each pixel alone: quick, stable when a picture moves |
//! | [`ordered_planes`] | coverages of independent sub-pixels | the same for each sub-pixel, with a mask of its own |
//! | [`ErrorDiffusion`] | X, Y, Z, or one number | the error of a pixel is passed on to its neighbours: the finest detail |
//! | [`direct_binary_search`] | the same, filters of the eye, a start | the smallest visible error; seconds |
//!
//! A picture is a slice of its pixels by rows, **the first row at the top**, because error diffusion has a
//! direction and files of pictures have this order. All values are linear in light. States are numbers from
//! 0, in the order of the palette.
//!
//! Nothing here depends on threads, on the processor or on earlier calls.
//!
//! **Out of scope.** The coverages and the colours that a display can show (gamut mapping) are decided
//! before: colours outside the hull of the palette are permitted, but what no pixel can show is lost, and
//! counted.

mod diffusion;
mod mask;
mod ordered;
mod search;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod tests_of_masks;
#[cfg(test)]
mod tests_of_search;
mod units;

pub use diffusion::{Diffused, DiffusionKernel, ErrorDiffusion, FewStates, FixedRow, Scan};
pub use mask::Mask;
pub use ordered::{light_to_dark, ordered, ordered_planes};
pub use search::{Filter, SearchControl, SearchPass, Searched, direct_binary_search};

use crate::ImagingError;

/// Largest number of states of a halftone.
pub const MOST_STATES: usize = 256;

/// Fails unless a picture of `pixels` consists of whole rows.
pub(crate) fn check_rows(pixels: usize, columns: usize) -> Result<(), ImagingError> {
    let whole = columns > 0 && pixels.is_multiple_of(columns);
    if whole { Ok(()) } else { Err(ImagingError::Rows { pixels, columns }) }
}

/// Fails unless this is a permitted number of states.
fn check_states(states: usize) -> Result<(), ImagingError> {
    if (1..=MOST_STATES).contains(&states) { Ok(()) } else { Err(ImagingError::States { states }) }
}
