//! The viewing cone: polar maps of what is seen from every direction.

use papilio_display::{ConeResult, ConeState, ConeView};

use crate::axis::Axis;
use crate::panel::SMALL;
use crate::polar::{Directions, Map, colour_bar, sun};
use crate::style::INK;
use crate::svg::{Anchor, Point, Stroke, Svg, Text, shortened};

const WIDTH: f64 = 1300.0;
/// Radius of a large map, px.
const LARGE: f64 = 138.0;
/// Radius of a small map, px.
const LITTLE: f64 = 62.0;
/// Small maps in a row.
const IN_A_ROW: usize = 8;
/// From one row of small maps to the next, px.
const ROW: f64 = 2.0 * LITTLE + 34.0;
/// Numbers are drawn on a logarithmic scale where the largest is more than so many times the smallest.
const WIDE: f64 = 30.0;
/// The same for states side by side, whose black has to be seen beside white.
const WIDE_TOGETHER: f64 = 10.0;
/// A u'v' distance below this is hardly seen: a display of constant colour is one colour here.
const UNSEEN_SHIFT: f64 = 0.005;

/// A number of every direction and what it is.
struct Large<'a> {
    title: String,
    scale: fn(&[f64]) -> Axis,
    value: Box<dyn Fn(&ConeView) -> f64 + 'a>,
}

/// A number of every direction and state.
struct Each {
    title: &'static str,
    value: fn(&ConeState) -> f64,
    scale: fn(&[f64]) -> Axis,
}

/// Maps over all viewing directions: luminance of white (or the first state), contrast and
/// gamut, reflectance factor and colour shift of every state. `None` where the directions
/// span no area to map.
pub fn cone(result: &ConeResult, title: &str) -> Option<String> {
    let directions = Directions::new(&result.theta_deg, &result.phi_deg)?;
    let large = large(result);
    let each: Vec<Each> = each().into_iter().filter(|each| any(&values_of(result, each.value))).collect();
    let rows = result.states.len().div_ceil(IN_A_ROW) as f64;
    let section = rows * ROW + 46.0;
    let top = if large.is_empty() { 10.0 } else { 2.0 * LARGE + 82.0 };
    let mut svg = Svg::new(WIDTH, top + each.len() as f64 * section + 30.0).titled(title);
    for (i, one) in large.iter().enumerate() {
        draw_large(&mut svg, result, &directions, one, WIDTH / 3.0 * i as f64);
    }
    for (i, one) in each.iter().enumerate() {
        draw_each(&mut svg, result, &directions, one, top + i as f64 * section);
    }
    legend(&mut svg, result, top + each.len() as f64 * section + 12.0);
    Some(svg.finish())
}

fn large(result: &ConeResult) -> Vec<Large<'_>> {
    let mut large = Vec::new();
    let white = result.states.iter().position(|name| name == "white").unwrap_or(0);
    if let Some(name) = result.states.get(white) {
        let luminance = move |view: &ConeView| view.states.get(white).map_or(f64::NAN, |s| s.luminance_cd_m2);
        let title = format!("Luminance of {} (cd/m\u{b2})", shortened(name, 120.0, SMALL));
        large.push(Large { title, scale: over_decades, value: Box::new(luminance) });
    }
    let or_nan = |value: Option<f64>| value.unwrap_or(f64::NAN);
    large.push(Large {
        title: "Contrast ratio".to_owned(),
        scale: over_decades,
        value: Box::new(move |view| or_nan(view.contrast_ratio)),
    });
    large.push(Large {
        title: "Gamut area in u\u{2032}v\u{2032} (% of sRGB)".to_owned(),
        scale: |values| Axis::covering(values.iter().copied(), 6, ""),
        value: Box::new(move |view| or_nan(view.gamut_percent_srgb)),
    });
    large.retain(|one| any(&result.views.iter().map(|view| (one.value)(view)).collect::<Vec<_>>()));
    large
}

fn each() -> [Each; 2] {
    [
        Each {
            title: "Luminous reflectance factor Y",
            value: |state| state.reflectance_factor_y,
            scale: |values| sequential(values, WIDE_TOGETHER),
        },
        Each {
            title: "Colour shift \u{394}u\u{2032}v\u{2032} from the normal",
            value: |state| state.uv_shift.unwrap_or(f64::NAN),
            scale: |values| Axis::covering(values.iter().copied().chain([0.0, UNSEEN_SHIFT]), 5, ""),
        },
    ]
}

fn values_of(result: &ConeResult, value: fn(&ConeState) -> f64) -> Vec<f64> {
    result.views.iter().flat_map(|view| &view.states).map(value).collect()
}

fn any(values: &[f64]) -> bool {
    values.iter().any(|value| value.is_finite())
}

fn over_decades(values: &[f64]) -> Axis {
    sequential(values, WIDE)
}

fn sequential(values: &[f64], wide: f64) -> Axis {
    Axis::logarithmic_beyond(wide, values, "")
        .unwrap_or_else(|| Axis::covering(values.iter().copied(), 6, ""))
}

fn draw_large(svg: &mut Svg, result: &ConeResult, directions: &Directions<'_>, one: &Large<'_>, left: f64) {
    let values: Vec<f64> = result.views.iter().map(|view| (one.value)(view)).collect();
    let scale = (one.scale)(&values);
    let centre = (left + 56.0 + LARGE, 52.0 + LARGE);
    svg.text((centre.0, 20.0), &one.title, Text::new(13.0, INK).strong().anchor(Anchor::Middle));
    let map = Map { centre, radius: LARGE, scale: &scale, labelled: true };
    let number = |theta, phi| result.view(theta, phi).map_or(f64::NAN, |view| (one.value)(view));
    directions.draw(svg, &map, &result.lights, number);
    colour_bar(svg, &scale, (centre.0 + LARGE + 38.0, centre.1 - 100.0), 200.0, true);
}

fn draw_each(svg: &mut Svg, result: &ConeResult, directions: &Directions<'_>, each: &Each, top: f64) {
    let scale = (each.scale)(&values_of(result, each.value));
    let pitch = (WIDTH - 96.0) / IN_A_ROW as f64;
    svg.text((20.0, top + 16.0), each.title, Text::new(13.0, INK).strong());
    for (state, name) in result.states.iter().enumerate() {
        let (column, row) = (state % IN_A_ROW, state / IN_A_ROW);
        let centre: Point = (20.0 + pitch * column as f64 + LITTLE, top + 46.0 + ROW * row as f64 + LITTLE);
        let name = shortened(name, 2.0 * LITTLE, SMALL);
        svg.text((centre.0, centre.1 - LITTLE - 7.0), &name, Text::new(SMALL, INK).anchor(Anchor::Middle));
        let map = Map { centre, radius: LITTLE, scale: &scale, labelled: false };
        let number = |theta, phi| {
            let seen = result.view(theta, phi).and_then(|view| view.states.get(state));
            seen.map_or(f64::NAN, each.value)
        };
        directions.draw(svg, &map, &result.lights, number);
    }
    colour_bar(svg, &scale, (WIDTH - 76.0, top + 46.0), 2.0 * LITTLE, false);
}

/// What the maps do not say themselves.
fn legend(svg: &mut Svg, result: &ConeResult, y: f64) {
    let style = Text::new(11.0, "#777777");
    let text = "The normal in the centre, a ring every 20\u{b0} of inclination, azimuth around (0\u{b0} right, 90\u{b0} up).";
    svg.text((20.0, y), text, style);
    if !result.lights.is_empty() {
        sun(svg, (560.0, y - 4.0), 4.0);
        svg.text((574.0, y), "light comes from here", style);
        svg.circle((712.0, y - 4.0), 4.0, "none", &Stroke::solid(INK, 1.2));
        svg.text((722.0, y), "where its mirror image is seen", style);
    }
}
