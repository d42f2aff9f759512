//! The viewing cone: polar maps of what is seen from every direction.

use papilio_display::{ConeResult, ConeState, ConeView};

use crate::axis::Axis;
use crate::panel::SMALL;
use crate::polar::{BLANK, Directions, Map, colour_bar, sun};
use crate::style::INK;
use crate::svg::{Anchor, Point, Stroke, Svg, Text, shortened};

/// From one large map to the next, px: to the right, and down.
const PITCH: Point = (1300.0 / 3.0, 2.0 * LARGE + 76.0);
/// Radius of a large map, px.
const LARGE: f64 = 138.0;
/// Radius of a small map, px.
const LITTLE: f64 = 62.0;
/// Small maps in a row.
const IN_A_ROW: usize = 8;
/// From one row of small maps to the next, px.
const ROW: f64 = 2.0 * LITTLE + 34.0;
/// So few states have large maps, too.
const FEW: usize = 3;
/// Numbers are drawn on a logarithmic scale where the largest is more than so many times the smallest.
const WIDE: f64 = 30.0;
/// The same for states side by side, whose black has to be seen beside white.
const WIDE_TOGETHER: f64 = 10.0;
/// A u'v' distance below this is hardly seen: where no state shifts further, there is nothing to map.
const UNSEEN_SHIFT: f64 = 0.005;

/// A number of every direction and what it is.
struct Large<'a> {
    title: String,
    scale: Axis,
    value: Box<dyn Fn(&ConeView) -> f64 + 'a>,
}

/// A number of every direction and state, on one scale.
struct Each {
    title: &'static str,
    value: fn(&ConeState) -> f64,
    scale: Axis,
}

/// Maps over all viewing directions: luminance of white (or the first state), contrast and
/// gamut, reflectance factor and colour shift of every state. `None` where the directions
/// span no area to map.
pub fn cone(result: &ConeResult, title: &str) -> Option<String> {
    let directions = Directions::new(&result.theta_deg, &result.phi_deg)?;
    let mut large = large(result);
    let mut each = each(result);
    if result.states.len() <= FEW {
        large.extend(each.drain(..).flat_map(|each| enlarged(result, &each)));
    }
    // Four stand best as two and two.
    let columns = if large.len() == 4 { 2 } else { large.len().clamp(2, 3) };
    let rows = result.states.len().div_ceil(IN_A_ROW) as f64;
    let section = rows * ROW + 46.0;
    let top = PITCH.1 * large.len().div_ceil(columns) as f64 + 6.0;
    let width = PITCH.0 * if each.is_empty() { columns } else { 3 } as f64;
    let bottom = top + each.len() as f64 * section;
    let mut svg = Svg::new(width, bottom + if blank(result) { 84.0 } else { 66.0 }).titled(title);
    for (i, one) in large.iter().enumerate() {
        let corner = (PITCH.0 * (i % columns) as f64, PITCH.1 * (i / columns) as f64);
        draw_large(&mut svg, result, &directions, one, corner);
    }
    for (i, one) in each.iter().enumerate() {
        draw_each(&mut svg, result, &directions, one, top + i as f64 * section);
    }
    legend(&mut svg, result, bottom + 12.0);
    Some(svg.finish())
}

fn large(result: &ConeResult) -> Vec<Large<'_>> {
    let mut large = Vec::new();
    let mut add = |title: String, scale: fn(&[f64]) -> Axis, value: Box<dyn Fn(&ConeView) -> f64>| {
        let values: Vec<f64> = result.views.iter().map(&value).collect();
        if any(&values) {
            large.push(Large { title, scale: scale(&values), value });
        }
    };
    let white = result.states.iter().position(|name| name == "white").unwrap_or(0);
    if let Some(name) = result.states.get(white) {
        let luminance = move |view: &ConeView| view.states.get(white).map_or(f64::NAN, |s| s.luminance_cd_m2);
        let title = format!("Luminance of {} (cd/m\u{b2})", shortened(name, 120.0, SMALL));
        add(title, over_decades, Box::new(luminance));
    }
    let contrast = |view: &ConeView| view.contrast_ratio.unwrap_or(f64::NAN);
    add("Contrast ratio".to_owned(), over_decades, Box::new(contrast));
    let gamut = |view: &ConeView| view.gamut_percent_srgb.unwrap_or(f64::NAN);
    add("Gamut area in u\u{2032}v\u{2032} (% of sRGB)".to_owned(), linear, Box::new(gamut));
    large
}

fn each(result: &ConeResult) -> Vec<Each> {
    let y = |state: &ConeState| state.reflectance_factor_y;
    let scale = sequential(&values_of(result, y), WIDE_TOGETHER);
    let mut each = vec![Each { title: "Luminous reflectance factor Y", value: y, scale }];
    let shift = |state: &ConeState| state.uv_shift.unwrap_or(f64::NAN);
    let shifts = values_of(result, shift);
    if seen(&shifts) {
        let scale = Axis::covering(shifts.into_iter().chain([0.0]), 5, "");
        each.push(Each { title: SHIFT, value: shift, scale });
    }
    each
}

const SHIFT: &str = "Colour shift \u{394}u\u{2032}v\u{2032} from the normal";

/// A large map for each state.
fn enlarged<'a>(result: &'a ConeResult, each: &Each) -> Vec<Large<'a>> {
    let of_state = |(state, name): (usize, &String)| {
        let value = each.value;
        Large {
            title: format!("{}, {}", each.title, shortened(name, 120.0, SMALL)),
            scale: each.scale.clone(),
            value: Box::new(move |view| view.states.get(state).map_or(f64::NAN, value)),
        }
    };
    result.states.iter().enumerate().map(of_state).collect()
}

fn values_of(result: &ConeResult, value: fn(&ConeState) -> f64) -> Vec<f64> {
    result.views.iter().flat_map(|view| &view.states).map(value).collect()
}

fn any(values: &[f64]) -> bool {
    values.iter().any(|value| value.is_finite())
}

/// Whether there are directions without numbers.
fn blank(result: &ConeResult) -> bool {
    values_of(result, |state| state.luminance_cd_m2).iter().any(|value| value.is_nan())
}

/// Whether any colour shifts so far that one sees it.
fn seen(shifts: &[f64]) -> bool {
    shifts.iter().any(|shift| *shift >= UNSEEN_SHIFT)
}

fn linear(values: &[f64]) -> Axis {
    Axis::covering(values.iter().copied(), 6, "")
}

fn over_decades(values: &[f64]) -> Axis {
    sequential(values, WIDE)
}

fn sequential(values: &[f64], wide: f64) -> Axis {
    Axis::logarithmic_beyond(wide, values, "").unwrap_or_else(|| linear(values))
}

fn draw_large(
    svg: &mut Svg,
    result: &ConeResult,
    directions: &Directions<'_>,
    one: &Large<'_>,
    corner: Point,
) {
    let scale = &one.scale;
    let centre = (corner.0 + 56.0 + LARGE, corner.1 + 52.0 + LARGE);
    svg.text((centre.0, corner.1 + 20.0), &one.title, Text::new(13.0, INK).strong().anchor(Anchor::Middle));
    let map = Map { centre, radius: LARGE, scale, labelled: true, contours: true };
    let number = |theta, phi| result.view(theta, phi).map_or(f64::NAN, |view| (one.value)(view));
    directions.draw(svg, &map, &result.lights, number);
    colour_bar(svg, scale, (centre.0 + LARGE + 38.0, centre.1 - 100.0), 200.0, true);
}

fn draw_each(svg: &mut Svg, result: &ConeResult, directions: &Directions<'_>, each: &Each, top: f64) {
    let width = 3.0 * PITCH.0;
    let pitch = (width - 96.0) / IN_A_ROW as f64;
    svg.text((20.0, top + 16.0), each.title, Text::new(13.0, INK).strong());
    for (state, name) in result.states.iter().enumerate() {
        let (column, row) = (state % IN_A_ROW, state / IN_A_ROW);
        let centre: Point = (20.0 + pitch * column as f64 + LITTLE, top + 46.0 + ROW * row as f64 + LITTLE);
        let name = shortened(name, 2.0 * LITTLE, SMALL);
        svg.text((centre.0, centre.1 - LITTLE - 7.0), &name, Text::new(SMALL, INK).anchor(Anchor::Middle));
        let map = Map { centre, radius: LITTLE, scale: &each.scale, labelled: false, contours: true };
        let number = |theta, phi| {
            let seen = result.view(theta, phi).and_then(|view| view.states.get(state));
            seen.map_or(f64::NAN, each.value)
        };
        directions.draw(svg, &map, &result.lights, number);
    }
    colour_bar(svg, &each.scale, (width - 76.0, top + 46.0), 2.0 * LITTLE, false);
}

/// What the maps do not say themselves: up to four lines.
fn legend(svg: &mut Svg, result: &ConeResult, mut y: f64) {
    const LINE: f64 = 18.0;
    let style = Text::new(11.0, "#777777");
    let text = "The normal in the centre, a ring every 20\u{b0} of inclination, azimuth around (0\u{b0} right, 90\u{b0} up).";
    svg.text((20.0, y), text, style);
    if !result.lights.is_empty() {
        y += LINE;
        sun(svg, (27.0, y - 4.0), 4.0);
        svg.text((41.0, y), "light comes from here", style);
        svg.circle((179.0, y - 4.0), 4.0, "none", &Stroke::solid(INK, 1.2));
        svg.text((189.0, y), "where its mirror image is seen", style);
    }
    if blank(result) {
        y += LINE;
        svg.rect((21.0, y - 10.0), (12.0, 12.0), 0.0, BLANK, "#bbbbbb");
        svg.text((41.0, y), "nothing was measured there", style);
    }
    let shifts = values_of(result, |state| state.uv_shift.unwrap_or(f64::NAN));
    if any(&shifts) && !seen(&shifts) {
        y += LINE;
        svg.text((20.0, y), &format!("{SHIFT}: less than {UNSEEN_SHIFT} in every state."), style);
    }
}
