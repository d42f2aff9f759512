//! Direct binary search: the halftone that a reader at this distance sees nearest to the picture.
//!
//! **What.** From error diffusion on, pixels change their states, or exchange them with a neighbour, as long
//! as a change lowers the sum of the squares of the blurred differences in lightness, red-green and
//! blue-yellow; first with narrow filters, then with those of the eye.
//!
//! **The eye.** Of S-CIELAB's filters (Zhang and Wandell 1996, as in `papilio_colour::pictures`), the
//! narrowest Gaussian of each opponent colour: full widths at half maximum of 0.05, 0.0685 and 0.092 degrees.
//! The wider ones pass less than 2 cycles per degree, far below the frequencies of a halftone. What is so coarse is
//! right after error diffusion, and the search keeps it: the means of areas of 32 x 32 pixels have a weight of their own.
//!
//! **The layers.** Below a diffuser, the filters are blurred by the spread of the brightest state: the layers
//! do a part of the halftoning. Light that paper below glass lends to its neighbours is spread too widely to
//! matter.
//!
//! **Range.** From 120 pixels per degree on, the eye sees none of the pattern, and the filters do not grow
//! any more.

use std::ops::ControlFlow;
use std::sync::atomic::Ordering;

use papilio_imaging::halftone::{Filter, SearchControl, SearchPass, direct_binary_search};

use super::halftone::Panel;
use crate::DisplayError;
use crate::run::{Control, Progress};

/// Full widths at half maximum of the filters of lightness, red-green and blue-yellow, degrees.
const WIDTHS_DEG: [f64; 3] = [0.05, 0.0685, 0.092];

/// Weights of red-green, X - Y, and of blue-yellow, Y - Z, relative to the white, over that of Y. For photographs on
/// six inks, weights from 1.3 to 1.7 and from 0.95 to 1.3 have the smallest S-CIELAB differences, within 2 %; for
/// gradients of saturated colours, these have.
const RED_GREEN: f64 = 1.7;
const BLUE_YELLOW: f64 = 0.95;

/// Weights of the mean errors of areas in lightness, red-green and blue-yellow. Without them, flat tones on six inks are
/// off by 4 % of their light, and tones of less than 5 % above the black become black; with these by 0.4 %. With double
/// weights it is 0.25 %, but S-CIELAB differences are 2 % larger.
const OF_MEANS: [f64; 3] = [16.0, 8.0, 8.0];

/// Fine to coarse: widths of the filters, as factors, and passes with them. Coarse filters alone end in patterns
/// with 8 % larger S-CIELAB differences.
pub(super) const TO_THE_END: [(f64, usize); 3] = [(0.6, 3), (0.8, 3), (1.0, usize::MAX)];

/// What removes most of the visible pattern of error diffusion in little time.
pub(super) const REFINED: [(f64, usize); 1] = [(0.9, 3)];

/// Largest number of pixels per degree.
const MOST_PER_DEGREE: f64 = 120.0;

/// Number of standard deviations at which the filters end.
const REACH: f64 = 3.0;

/// Pixels around one over which the layers spread its light; what they spread more widely has no pattern.
pub(super) const REACH_OF_LAYERS: i64 = 6;

/// Searches from a start with filters of these widths, one after the other.
pub(super) fn searched(
    start: &[u8],
    mapped: &[[f32; 3]],
    panel: &Panel<'_>,
    stages: &[(f64, usize)],
    control: &Control<'_>,
) -> Result<Vec<u8>, DisplayError> {
    let mut states = start.to_vec();
    for (number, (width, passes)) in stages.iter().copied().enumerate() {
        let from = number as f64 / stages.len() as f64;
        let range = [from, from + 1.0 / stages.len() as f64];
        states = control
            .within(range, |control| with_filters(&states, mapped, panel, (width, passes), control))?;
    }
    Ok(states)
}

/// Searches with filters of this width, as a factor, in so many passes at most.
pub(super) fn with_filters(
    start: &[u8],
    mapped: &[[f32; 3]],
    panel: &Panel<'_>,
    (width, passes): (f64, usize),
    control: &Control<'_>,
) -> Result<Vec<u8>, DisplayError> {
    let per_degree = panel.pixels_per_degree.ok_or(DisplayError::NoPixelPitch)?;
    let metric = panel.rendering.opponent(RED_GREEN, BLUE_YELLOW);
    let states = &panel.rendering.states;
    let spread = panel.spread.as_deref();
    let [lightness, red_green, blue_yellow] = WIDTHS_DEG.map(|one| filter(width * one, per_degree, spread));
    let [in_lightness, in_red_green, in_blue_yellow] = OF_MEANS;
    let filters = [
        lightness?.keeping_means(in_lightness),
        red_green?.keeping_means(in_red_green),
        blue_yellow?.keeping_means(in_blue_yellow),
    ];
    let mut first = 0;
    let mut watch = |pass: SearchPass| {
        if pass.pass == 1 {
            first = pass.changes.max(1);
        }
        let share = 1.0 - 0.7 * pass.changes as f64 / first as f64;
        (control.progress)(Progress { share_of_view: Some(share), ..Progress::of_views(0, 1) });
        if pass.pass >= passes { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let told = SearchControl {
        fixed: panel.drawn.as_ref().map_or(&[], |drawn| &drawn.is_drawn),
        few: panel.few(),
        allowed: panel.neutral.as_ref().map_or(&[], |neutral| &neutral.allowed),
        threads: control.thread_count(),
        stop: &|| control.stop.load(Ordering::Relaxed),
        watch: &mut watch,
    };
    let found = direct_binary_search(mapped, panel.columns, (states, metric), &filters, start, told)?;
    control.check()?;
    Ok(found.states)
}

/// A Gaussian of this full width at half maximum, with the sum 1, blurred by the spread of the layers.
fn filter(width_deg: f64, per_degree: [f64; 2], spread: Option<&[f64]>) -> Result<Filter, DisplayError> {
    let along = per_degree.map(|per_degree| {
        let sigma = width_deg * per_degree.min(MOST_PER_DEGREE) / (8.0 * std::f64::consts::LN_2).sqrt();
        let reach = (REACH * sigma).ceil() as i32;
        let values: Vec<f64> =
            (-reach..=reach).map(|k| (-0.5 * (f64::from(k) / sigma).powi(2)).exp()).collect();
        let sum: f64 = values.iter().sum();
        values.into_iter().map(|value| value / sum).collect::<Vec<_>>()
    });
    let [across, down] = along;
    let more = if spread.is_some() { 2 * REACH_OF_LAYERS as usize } else { 0 };
    let (columns, rows) = (across.len() + more, down.len() + more);
    let mut values = vec![0.0; columns * rows];
    for (at, light) in spread.unwrap_or(&[1.0]).iter().enumerate() {
        let [column, row] = [at % (more + 1), at / (more + 1)];
        for (y, down) in down.iter().enumerate() {
            let line = &mut values[(row + y) * columns + column..][..across.len()];
            line.iter_mut().zip(&across).for_each(|(value, across)| *value += light * across * down);
        }
    }
    Ok(Filter::new(columns, values)?)
}
