//! Ordered dither: each pixel is compared with a threshold mask.

use super::{Mask, check_rows, check_states};
use crate::ImagingError;

/// Returns the states in their order from light to dark by Y; of equally light states the first one first.
pub fn light_to_dark(palette: &[[f64; 3]]) -> Vec<u8> {
    let mut order: Vec<u8> = (0..palette.len().min(super::MOST_STATES)).map(|state| state as u8).collect();
    order.sort_by(|a, b| palette[usize::from(*b)][1].total_cmp(&palette[usize::from(*a)][1]));
    order
}

/// Ordered dither of coverages by several states.
///
/// `coverages` holds for each pixel the coverage of each state, in the order of the palette; `order` lists
/// all states, usually [`light_to_dark`]. A pixel gets the first state in this order for which the sum of the
/// coverages up to it exceeds the threshold of the [`Mask`]; if none does (rounding), the last one.
/// Neighbouring thresholds therefore select neighbouring states, and a uniform picture has each state in its
/// coverage, to the number of thresholds.
///
/// # Errors
/// If the number of pixels is not a multiple of `columns`, or `order` is not an order of all states.
pub fn ordered(
    coverages: &[f32],
    columns: usize,
    order: &[u8],
    mask: &Mask,
) -> Result<Vec<u8>, ImagingError> {
    let count = order.len();
    check_states(count)?;
    let mut seen = vec![false; count];
    for state in order {
        let new = seen.get_mut(usize::from(*state)).is_some_and(|seen| !std::mem::replace(seen, true));
        if !new {
            return Err(ImagingError::Order { state: *state, states: count });
        }
    }
    if !coverages.len().is_multiple_of(count) {
        return Err(ImagingError::Rows { pixels: coverages.len(), columns: count });
    }
    check_rows(coverages.len() / count, columns)?;
    let thresholds = mask.thresholds();
    let mut states = Vec::with_capacity(coverages.len() / count);
    for (y, row) in coverages.chunks_exact(columns * count).enumerate() {
        let thresholds = row_of(&thresholds, mask, y);
        for (pixel, threshold) in row.chunks_exact(count).zip(thresholds.iter().cycle()) {
            // A count instead of a search: as many steps for every pixel, and no branch to predict.
            let (mut sum, mut passed) = (0.0, 0);
            for state in &order[..count - 1] {
                sum += pixel[usize::from(*state)];
                passed += usize::from(sum <= *threshold);
            }
            states.push(order[passed]);
        }
    }
    Ok(states)
}

/// Ordered dither of independent sub-pixels (a film with red, green and blue ones): bit k of the result is
/// set where the coverage of plane k exceeds its mask. At most eight planes.
///
/// With one mask for all planes, sub-pixels of a pixel switch together, and greys consist of white and black.
/// With [shifted](Mask::shifted) masks they switch apart, and the lightness varies less from pixel to pixel.
///
/// # Errors
/// If there are no planes or more than eight, or the planes do not consist of the same number of whole rows.
pub fn ordered_planes(planes: &[(&[f32], &Mask)], columns: usize) -> Result<Vec<u8>, ImagingError> {
    let first = match planes {
        [(first, _), ..] if planes.len() <= 8 => first,
        _ => return Err(ImagingError::States { states: 1 << planes.len().min(16) }),
    };
    let mut states = vec![0; first.len()];
    for (bit, (coverage, mask)) in planes.iter().enumerate() {
        check_rows(coverage.len(), columns)?;
        if coverage.len() != first.len() {
            return Err(ImagingError::Planes { pixels: coverage.len(), expected: first.len() });
        }
        let thresholds = mask.thresholds();
        let rows = states.chunks_exact_mut(columns).zip(coverage.chunks_exact(columns));
        for (y, (states, coverage)) in rows.enumerate() {
            let thresholds = row_of(&thresholds, mask, y).iter().cycle();
            for ((state, value), threshold) in states.iter_mut().zip(coverage).zip(thresholds) {
                *state |= u8::from(value > threshold) << bit;
            }
        }
    }
    Ok(states)
}

/// The thresholds of row `y`.
fn row_of<'a>(thresholds: &'a [f32], mask: &Mask, y: usize) -> &'a [f32] {
    let start = y % mask.rows() * mask.columns();
    &thresholds[start..start + mask.columns()]
}
