//! Colour differences over all viewing directions: of each state from its own colour in a reference
//! direction.

use papilio_display::{ConeResult, ConeState};

use crate::axis::Axis;
use crate::panel::SMALL;
use crate::polar::{Directions, Map, colour_bar};
use crate::style::{INK, degrees};
use crate::svg::{Anchor, Point, Svg, Text, shortened};

/// Radius of a map, px.
const RADIUS: f64 = 62.0;
/// Distance from one map to the next, px: to the right, and down.
const PITCH: Point = (150.0, 2.0 * RADIUS + 34.0);
/// Maps in a row.
const IN_A_ROW: usize = 8;
/// Fraction of the values up to which the scale extends: a narrow mirror image does not determine it.
const MOST: f64 = 0.995;

/// A difference: its title, the smallest end of its scale (smaller differences are hardly visible), and its
/// value.
type Difference = (&'static str, f64, fn(&ConeState) -> Option<f64>);

const DIFFERENCES: [Difference; 3] = [
    ("CIEDE2000 colour difference", 1.0, |state| state.delta_e_2000),
    ("CIE 1976 colour difference \u{394}E*ab", 1.0, |state| state.delta_e_1976),
    ("Chromaticity difference \u{394}u\u{2032}v\u{2032}", 0.005, |state| state.uv_shift),
];

/// Draws maps of the colour differences of every state from its own colour in the reference direction.
/// Returns `None` if the directions do not span an area, or no difference is defined.
pub fn cone_differences(result: &ConeResult, title: &str) -> Option<String> {
    let directions = Directions::new(&result.theta_deg, &result.phi_deg)?;
    let defined = |(.., value): &&Difference| values(result, *value).next().is_some();
    let drawn: Vec<&Difference> = DIFFERENCES.iter().filter(defined).collect();
    if drawn.is_empty() {
        return None;
    }
    let rows = result.states.len().div_ceil(IN_A_ROW) as f64;
    let columns = result.states.len().clamp(1, IN_A_ROW) as f64;
    let (section, right) = (rows * PITCH.1 + 46.0, 20.0 + PITCH.0 * columns);
    let mut svg = Svg::new((right + 90.0).max(560.0), section * drawn.len() as f64 + 40.0).titled(title);
    for (k, (name, least, value)) in drawn.iter().enumerate() {
        let top = section * k as f64;
        let (scale, beyond) = scale(result, *least, *value);
        let beyond = beyond.map_or(String::new(), |most| format!(" (up to {most:.3})"));
        svg.text((20.0, top + 16.0), &format!("{name}{beyond}"), Text::new(13.0, INK).strong());
        for (state, name) in result.states.iter().enumerate() {
            let place = ((state % IN_A_ROW) as f64, (state / IN_A_ROW) as f64);
            let centre = (20.0 + PITCH.0 * place.0 + RADIUS, top + 46.0 + PITCH.1 * place.1 + RADIUS);
            let name = shortened(name, 2.0 * RADIUS, SMALL);
            let style = Text::new(SMALL, INK).anchor(Anchor::Middle);
            svg.text((centre.0, centre.1 - RADIUS - 7.0), &name, style);
            let map = Map { centre, radius: RADIUS, scale: &scale, labelled: false, contours: true };
            directions.draw(&mut svg, &map, &result.lights, |theta, phi| {
                let seen = result.view(theta, phi).and_then(|view| view.states.get(state));
                seen.and_then(*value).unwrap_or(f64::NAN)
            });
        }
        colour_bar(&mut svg, &scale, (right, top + 46.0), 2.0 * RADIUS, false);
    }
    let bottom = section * drawn.len() as f64 + 12.0;
    svg.text((20.0, bottom), &about(result), Text::new(11.0, "#777777"));
    Some(svg.finish())
}

/// Describes what is compared.
fn about(result: &ConeResult) -> String {
    let [theta, phi] = result.reference_deg;
    let from = match (theta, phi) {
        (0.0, _) => "along the normal".to_owned(),
        (theta, 0.0) => format!("at {}", degrees(theta)),
        (theta, phi) => format!("at {}, azimuth {}", degrees(theta), degrees(phi)),
    };
    format!(
        "Each state is compared with its own colour {from}. Centre: display normal; rings: every 20\u{b0} of inclination."
    )
}

/// Finite values of all directions and states.
fn values(result: &ConeResult, value: fn(&ConeState) -> Option<f64>) -> impl Iterator<Item = f64> + use<'_> {
    let states = result.views.iter().flat_map(|view| &view.states);
    states.filter_map(value).filter(|value| value.is_finite())
}

/// Returns the scale, and the largest value if it lies far beyond.
fn scale(result: &ConeResult, least: f64, value: fn(&ConeState) -> Option<f64>) -> (Axis, Option<f64>) {
    let mut all: Vec<f64> = values(result, value).collect();
    all.sort_by(f64::total_cmp);
    let last = all.len().saturating_sub(1);
    let at = |k: usize| all.get(k).copied().unwrap_or(0.0);
    let (most, end) = (at(last), at((MOST * last as f64) as usize).max(least));
    let is_clipped = most > 2.0 * end;
    let axis = Axis::covering([0.0, if is_clipped { end } else { most.max(least) }], 8, "");
    (axis, is_clipped.then_some(most))
}
