//! Direct binary search: the halftone whose filtered picture is nearest to the wanted one.
//!
//! The error is `E = sum over coordinates and pixels of (h * (shown - wanted))^2` with a filter h for each
//! coordinate: what the eye and the stack pass. This error alone has its minimum beside the wanted mean: a tone whose
//! pattern is less visible gains more than the tone costs, and up to a few per cent of a lighter state vanish in a
//! darker one. Therefore E has a second term, `w C S^2/n` for each area of n = 32 x 32 pixels, with the sum S of its
//! errors and the weight w of [`Filter::keeping_means`] (C is the square of the sum of h); a flat tone is then off by
//! 1/(1 + w) of that. In a pass, each pixel tries every other state, alone
//! and with every other state of one of its neighbours (of more than 8 states, the 8 that are best alone, and the
//! exchange), and takes the best change if it lowers E; the search ends when no pixel finds any. Beyond the
//! borders nothing is wrong.
//!
//! **Method.** M. Analoui and J. P. Allebach, Proc. SPIE 1666, 96 (1992): with the autocorrelation c of the
//! filter and the error correlated with it, `r = c * (shown - wanted)`, a change of a pixel by d changes E by
//! `2 d r + d^2 c(0)`, that of two pixels by the sum of both and `2 d d' c(x)`, x from one to the other, and only
//! an accepted change updates r, in reach of c. The term of an area adds `w C S/n` to r, and `w C/n` to c within it.
//!
//! Values of c below 1 % of its middle are left out, by columns and rows. Bands of rows are searched by several
//! threads, each leaving alone what the others reach: the result has the same bits with any number of them.
//!
//! **Limits.** The result is a local minimum, which depends on the start; from error diffusion it is reached
//! sooner and is as good as from noise. It is better from the result of a narrower filter. A few seconds for a
//! page, by the size of the filter.

mod band;
mod correlate;
mod costs;
mod filter;

use std::ops::ControlFlow;

use band::{Field, Progress};
use correlate::Shown;
use costs::Costs;
pub use filter::Filter;

use super::{check_rows, check_states};
use crate::ImagingError;

/// State of a direct binary search after a pass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SearchPass {
    /// Number of the pass, from 1.
    pub pass: usize,
    /// Changes in this pass.
    pub changes: usize,
    /// The error E after it.
    pub error: f64,
}

/// Result of a direct binary search.
#[derive(Debug, Clone, PartialEq)]
pub struct Searched {
    /// The state of each pixel.
    pub states: Vec<u8>,
    /// The error E of the start; 0, as `error`, if the search was stopped before it was known.
    pub error_at_start: f64,
    /// The error E of the result.
    pub error: f64,
    /// Number of passes.
    pub passes: usize,
    /// Whether no change lowers the error; false if the search was stopped.
    pub is_complete: bool,
}

/// Fixed pixels, threads, and how a search is watched and stopped.
pub struct SearchControl<'a> {
    /// Whether each pixel keeps the state of the start; empty: none does. The light of those that do is seen by the others,
    /// but does not count for the mean of their area.
    pub fixed: &'a [bool],
    /// Whether each pixel takes only states that `allowed` marks; empty: none does.
    pub few: &'a [bool],
    /// Whether these pixels may take each state.
    pub allowed: &'a [bool],
    /// Number of threads.
    pub threads: usize,
    /// Whether to stop; asked often, by all threads.
    pub stop: &'a (dyn Fn() -> bool + Sync),
    /// Stops the search after a pass by `ControlFlow::Break`.
    pub watch: &'a mut dyn FnMut(SearchPass) -> ControlFlow<()>,
}

/// Direct binary search from a start.
///
/// `wanted` has the values of each pixel by rows, `palette` those of each state, such as X, Y, Z. `metric` has the
/// coordinates that are compared, one in each row: linear combinations of them such as opponent colours, for which
/// the eye's filters differ. `filters` are those of the coordinates. `start` has a state for each pixel, usually from [error
/// diffusion](super::ErrorDiffusion).
///
/// # Errors
/// If the pictures do not have the same number of whole rows, the palette is empty, too large or not finite,
/// or a state of the start is not in the palette.
pub fn direct_binary_search<const N: usize>(
    wanted: &[[f32; N]],
    columns: usize,
    (palette, metric): (&[[f64; N]], [[f64; N]; N]),
    filters: &[Filter; N],
    start: &[u8],
    control: SearchControl<'_>,
) -> Result<Searched, ImagingError> {
    check_rows(wanted.len(), columns)?;
    check_states(palette.len())?;
    if start.len() != wanted.len() {
        return Err(ImagingError::Planes { pixels: start.len(), expected: wanted.len() });
    }
    if let Some(state) = palette.iter().position(|colour| !colour.iter().all(|value| value.is_finite())) {
        return Err(ImagingError::Palette { state });
    }
    if let Some(state) = start.iter().find(|state| usize::from(**state) >= palette.len()) {
        return Err(ImagingError::Order { state: *state, states: palette.len() });
    }
    let SearchControl { fixed, few, allowed, threads, stop, watch } = control;
    for marks in [fixed, few] {
        if !marks.is_empty() && marks.len() != wanted.len() {
            return Err(ImagingError::Planes { pixels: marks.len(), expected: wanted.len() });
        }
    }
    let mut searched =
        Searched { states: Vec::new(), error_at_start: 0.0, error: 0.0, passes: 0, is_complete: false };
    let in_metric =
        |colour: &[f64; N]| metric.map(|row| row.iter().zip(colour).map(|(m, value)| m * value).sum::<f64>());
    let costs = Costs::new(&palette.iter().map(in_metric).collect::<Vec<_>>(), allowed, filters);
    let metric = metric.map(|row| row.map(|one| one as f32));
    let shown = Shown { wanted, columns, states: start, fixed, metric };
    let Some((mut field, mut error)) = Field::new(shown, &costs, (threads, stop)) else {
        searched.states = start.to_vec();
        return Ok(searched);
    };
    // Without the small values of the autocorrelations, an error of nearly 0 may be negative.
    (searched.error_at_start, searched.error) = (error.max(0.0), error.max(0.0));
    while let Some(Progress { changes, gain }) = field.pass(&costs, [fixed, few], threads, stop) {
        searched.passes += 1;
        error -= gain;
        searched.error = error.max(0.0);
        searched.is_complete = changes == 0;
        let pass = SearchPass { pass: searched.passes, changes, error: searched.error };
        if watch(pass).is_break() || searched.is_complete {
            break;
        }
    }
    searched.states = field.states;
    Ok(searched)
}
