//! Colours, line styles and number formats, alike in all figures.
//!
//! States are drawn in their own hue, darkened to be read on white, and told
//! apart without colour too: primaries solid, secondaries dashed, black dotted,
//! and every curve is labelled where it ends.

use papilio_display::result::View;

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

/// A number, or a dash where there is none.
pub(crate) fn fixed(value: f64, decimals: usize) -> String {
    if value.is_finite() { format!("{value:.decimals$}") } else { "\u{2013}".to_owned() }
}

/// A standard error, where it is seen in so many decimals.
fn seen_error(error: Option<f64>, decimals: usize) -> Option<String> {
    let seen = |error: &f64| error.is_finite() && *error >= 0.5 * 10.0_f64.powi(-(decimals as i32));
    error.filter(seen).map(|error| format!("{error:.decimals$}"))
}

/// A number with its standard error where that is seen in so many decimals.
pub(crate) fn with_error(value: f64, error: Option<f64>, decimals: usize) -> String {
    match seen_error(error, decimals) {
        Some(error) if value.is_finite() => format!("{} \u{b1} {error}", fixed(value, decimals)),
        _ => fixed(value, decimals),
    }
}

/// A share in %, and its standard error where that is seen; whole numbers from 100 % on.
pub(crate) fn percent(value: f64, error: f64) -> (String, Option<String>) {
    let decimals = if value.abs() < 0.9995 { 1 } else { 0 };
    let error = seen_error(Some(100.0 * error), decimals).filter(|_| value.is_finite());
    (fixed(100.0 * value, decimals), error)
}

/// A name with the unit that the name of its key or metric tells, if it tells one: `gaps (nm)` for `gap_nm.red`.
pub fn named_with_unit(name: &str, key: &str) -> String {
    const UNITS: [(&str, &str); 7] = [
        ("nm", "nm"),
        ("mm", "mm"),
        ("m", "m"),
        ("deg", "\u{b0}"),
        ("lx", "lx"),
        ("K", "K"),
        ("cd_m2", "cd/m\u{b2}"),
    ];
    let told = |word: &str| {
        let unit =
            UNITS.iter().find(|(end, _)| word.strip_suffix(end).is_some_and(|rest| rest.ends_with('_')));
        unit.map(|(_, unit)| *unit).or(word.contains("_percent").then_some("%"))
    };
    let unit = key.split([',', ' ']).next().and_then(|key| key.rsplit('.').find_map(told));
    unit.map_or_else(|| name.to_owned(), |unit| format!("{name} ({unit})"))
}

/// An angle in degrees.
pub(crate) fn degrees(angle: f64) -> String {
    format!("{}\u{b0}", (angle * 100.0).round() / 100.0)
}

/// From where a view is seen: `at 8 deg, azimuth 90 deg`.
pub(crate) fn seen_at(view: &View) -> String {
    let azimuth =
        if view.phi_deg == 0.0 { String::new() } else { format!(", azimuth {}", degrees(view.phi_deg)) };
    format!("at {}{azimuth}", degrees(view.theta_deg))
}

/// Parts of a line, those that are not empty.
pub(crate) fn joined(parts: &[&str]) -> String {
    let parts: Vec<&str> = parts.iter().copied().filter(|part| !part.is_empty()).collect();
    parts.join("   \u{b7}   ")
}

/// True if the front light is all the light of a view.
pub(crate) fn is_self_lit(view: &View) -> bool {
    view.states.iter().any(|(_, state)| state.value.reflectance_factor.is_none())
}

/// What stands above the figure of a view.
pub(crate) fn caption(title: &str, view: &View) -> String {
    joined(&[title, &format!("viewed {}", seen_at(view))])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_tell_their_units() {
        for (name, key, expected) in [
            ("gaps", "display.pixel.gap_nm.red", "gaps (nm)"),
            ("haze", "display.diffuser.haze", "haze"),
            (
                "white.luminance_cd_m2, view 1",
                "white.luminance_cd_m2, view 1",
                "white.luminance_cd_m2, view 1 (cd/m\u{b2})",
            ),
            ("gamut_percent_srgb", "gamut_percent_srgb", "gamut_percent_srgb (%)"),
            ("white.Y", "white.Y", "white.Y"),
        ] {
            assert_eq!(named_with_unit(name, key), expected);
        }
    }
}
