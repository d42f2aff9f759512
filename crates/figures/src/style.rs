//! Colours, line styles and number formats of all figures.
//!
//! States are drawn in their own hue, darkened to be visible on white. They can also be
//! distinguished without colour: primaries are solid, secondaries dashed, black is dotted,
//! and every curve has a label at its end.

use papilio_display::result::View;

use crate::svg::{Stroke, hex};

/// Colour of text.
pub(crate) const INK: &str = "#333333";
/// Colour of axes, leader lines and background elements.
pub(crate) const SOFT: &str = "#9a9a9a";
/// Colour of grid lines.
pub(crate) const FAINT: &str = "#ececec";

/// Returns the line style of a state; `index` selects the colour of states whose name has no hue.
pub(crate) fn state_stroke(name: &str, index: usize) -> Stroke {
    // The first has no hue: that of the curve of a single state would contradict its patch.
    const OTHERS: [&str; 6] = ["#55606b", "#d9822b", "#7a5bc0", "#5f8a3a", "#8c564b", "#4c78a8"];
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

/// Returns the colour at `t` (0 to 1) of a ramp from dark violet through green to yellow (viridis, with its
/// end darkened to be visible on white).
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
    let fraction = position - left as f64;
    hex([0, 1, 2].map(|i| (STOPS[left][i] * (1.0 - fraction) + STOPS[left + 1][i] * fraction).round() as u8))
}

/// Formats a number, or a dash if it is not finite.
pub(crate) fn fixed(value: f64, decimals: usize) -> String {
    if value.is_finite() { format!("{value:.decimals$}") } else { "\u{2013}".to_owned() }
}

/// Formats a standard error if it is not zero in so many decimals.
fn visible_error(error: Option<f64>, decimals: usize) -> Option<String> {
    let visible = |error: &f64| error.is_finite() && *error >= 0.5 * 10.0_f64.powi(-(decimals as i32));
    error.filter(visible).map(|error| format!("{error:.decimals$}"))
}

/// Formats a number, with its standard error if that is not zero in so many decimals.
pub(crate) fn with_error(value: f64, error: Option<f64>, decimals: usize) -> String {
    match visible_error(error, decimals) {
        Some(error) if value.is_finite() => format!("{} \u{b1} {error}", fixed(value, decimals)),
        _ => fixed(value, decimals),
    }
}

/// Formats a fraction in %, and its standard error if that is not zero; integers from 100 % on.
pub(crate) fn percent(value: f64, error: f64) -> (String, Option<String>) {
    let decimals = if value.abs() < 0.9995 { 1 } else { 0 };
    let error = visible_error(Some(100.0 * error), decimals).filter(|_| value.is_finite());
    (fixed(100.0 * value, decimals), error)
}

/// Formats an angle in degrees.
pub(crate) fn degrees(angle: f64) -> String {
    format!("{}\u{b0}", (angle * 100.0).round() / 100.0)
}

/// Formats the direction of a view: `at 8°, azimuth 90°`.
pub(crate) fn seen_at(view: &View) -> String {
    let azimuth =
        if view.phi_deg == 0.0 { String::new() } else { format!(", azimuth {}", degrees(view.phi_deg)) };
    format!("at {}{azimuth}", degrees(view.theta_deg))
}

/// Joins the parts of a line that are not empty.
pub(crate) fn joined(parts: &[&str]) -> String {
    let parts: Vec<&str> = parts.iter().copied().filter(|part| !part.is_empty()).collect();
    parts.join("   \u{b7}   ")
}

/// Returns whether the front light is the only light of a view.
pub(crate) fn is_self_lit(view: &View) -> bool {
    view.states.iter().any(|(_, state)| state.value.reflectance_factor.is_none())
}

/// Returns the caption above the figure of a view.
pub(crate) fn caption(title: &str, view: &View) -> String {
    joined(&[title, &format!("viewed {}", seen_at(view))])
}
