//! Colours, line styles and number formats, alike in all figures.
//!
//! States are drawn in their own hue, darkened to be read on white, and told
//! apart without colour too: primaries solid, secondaries dashed, black dotted,
//! and every curve is labelled where it ends.

use papilio_colour::{Xy, Xyz};
use papilio_display::result::{Illuminant, StateValues};

use crate::svg::{Stroke, hex};

/// Text.
pub(crate) const INK: &str = "#333333";
/// Axes, leaders, what stands back.
pub(crate) const SOFT: &str = "#9a9a9a";
/// Grid lines.
pub(crate) const FAINT: &str = "#ececec";

/// The line of a state; `index` chooses for names that have no hue.
pub(crate) fn state_stroke(name: &str, index: usize) -> Stroke {
    const OTHERS: [&str; 5] = ["#d9822b", "#7a5bc0", "#5f8a3a", "#8c564b", "#4c78a8"];
    let (colour, dash) = match name {
        "white" => ("#777777", ""),
        "black" => ("#111111", "1.5 3"),
        "red" => ("#c8321f", ""),
        "green" => ("#2c9a57", ""),
        "blue" => ("#2b5fc7", ""),
        "cyan" => ("#25a3bb", "7 3"),
        "magenta" => ("#b5408f", "7 3"),
        "yellow" => ("#c79a0a", "7 3"),
        _ => (OTHERS[index % OTHERS.len()], "9 3 2 3"),
    };
    Stroke::solid(colour, 2.0).dashed(dash)
}

/// Part `t` (0 to 1) of a ramp from dark violet over green to yellow (viridis, its end darkened to be seen on white).
pub(crate) fn ramp(t: f64) -> String {
    const STOPS: [[f64; 3]; 5] = [
        [68.0, 1.0, 84.0],
        [59.0, 82.0, 139.0],
        [33.0, 145.0, 140.0],
        [94.0, 190.0, 90.0],
        [224.0, 186.0, 28.0],
    ];
    let position = t.clamp(0.0, 1.0) * (STOPS.len() - 1) as f64;
    let left = (position as usize).min(STOPS.len() - 2);
    let share = position - left as f64;
    hex([0, 1, 2].map(|i| (STOPS[left][i] * (1.0 - share) + STOPS[left + 1][i] * share).round() as u8))
}

/// The colour of a state as it looks in its light, for a screen whose white is the perfect white.
pub(crate) fn painted(state: &StateValues, light: &Illuminant) -> String {
    let seen = Xyz { x: state.X, y: state.Y, z: state.Z };
    let white = Xy { x: light.x, y: light.y }.with_luminance(1.0);
    let adapted = white.and_then(|white| seen.adapted_to_d65(white));
    hex(adapted.unwrap_or(seen).srgb_clipped())
}

/// A number, or a dash where there is none.
pub(crate) fn fixed(value: f64, decimals: usize) -> String {
    if value.is_finite() { format!("{value:.decimals$}") } else { "\u{2013}".to_owned() }
}

/// A number with its standard error where that is seen in so many decimals.
pub(crate) fn with_error(value: f64, error: Option<f64>, decimals: usize) -> String {
    let seen = |error: &f64| error.is_finite() && *error >= 0.5 * 10.0_f64.powi(-(decimals as i32));
    match error.filter(seen) {
        Some(error) if value.is_finite() => format!("{value:.decimals$} \u{b1} {error:.decimals$}"),
        _ => fixed(value, decimals),
    }
}
