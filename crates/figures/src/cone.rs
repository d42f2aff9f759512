//! Conoscopic maps: polar maps of quantities over all viewing directions.

use papilio_display::{ConeResult, ConeState, ConeView};

use crate::axis::Axis;
use crate::cone_scale::Scale;
use crate::panel::SMALL;
use crate::polar::{BLANK, Directions, Map, colour_bar, sun};
use crate::style::INK;
use crate::svg::{Anchor, Point, Stroke, Svg, Text, shortened};

/// Distance from one large map to the next, px: to the right, and down.
const PITCH: Point = (1300.0 / 3.0, 2.0 * LARGE + 76.0);
/// Radius of a large map, px.
const LARGE: f64 = 138.0;
/// Radius of a small map, px.
const LITTLE: f64 = 62.0;
/// Small maps in a row.
const IN_A_ROW: usize = 8;
/// Distance from one row of small maps to the next, px.
const ROW: f64 = 2.0 * LITTLE + 34.0;
/// Largest number of states for which their maps are large, too.
const FEW: usize = 3;
/// Largest number of views whose directions are marked; more would cover the map.
const MAX_VIEWS: usize = 12;
/// Ratio of the largest to the smallest value above which the scale is logarithmic.
const WIDE: f64 = 30.0;
/// The same for maps of all states on one scale, on which black must be distinguishable next to white.
const WIDE_TOGETHER: f64 = 10.0;
/// Smallest visible u'v' distance. If no state shifts further, colour shifts are not mapped.
const VISIBLE_SHIFT: f64 = 0.005;

/// A quantity over all directions, drawn as a large map.
struct LargeMap<'a> {
    title: String,
    scale: Scale,
    value: Box<dyn Fn(&ConeView) -> f64 + 'a>,
}

/// A quantity over all directions for every state, drawn as small maps on one scale.
struct StateMaps {
    title: &'static str,
    value: fn(&ConeState) -> f64,
    scale: Scale,
}

/// Draws maps over all viewing directions: luminance of white (or the first state), contrast and
/// gamut; reflectance factor and colour shift of every state. Returns `None` if the directions
/// do not span an area.
pub fn cone(result: &ConeResult, title: &str) -> Option<String> {
    let directions = Directions::new(&result.theta_deg, &result.phi_deg)?;
    let mut large = large(result);
    let mut each = each(result);
    if result.states.len() <= FEW {
        large.extend(each.drain(..).flat_map(|each| enlarged(result, &each)));
    }
    // Four maps form two rows of two.
    let columns = if large.len() == 4 { 2 } else { large.len().clamp(2, 3) };
    let rows = result.states.len().div_ceil(IN_A_ROW) as f64;
    let section = rows * ROW + 46.0;
    let top = PITCH.1 * large.len().div_ceil(columns) as f64 + 6.0;
    let width = PITCH.0 * if each.is_empty() { columns } else { 3 } as f64;
    let bottom = top + each.len() as f64 * section;
    let mut svg = Svg::new(width, bottom + if blank(result) { 102.0 } else { 84.0 }).titled(title);
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

fn large(result: &ConeResult) -> Vec<LargeMap<'_>> {
    let mut large = Vec::new();
    let mut add = |title: String, scale: fn(&[f64]) -> Axis, value: Box<dyn Fn(&ConeView) -> f64>| {
        let values: Vec<f64> = result.views.iter().map(&value).collect();
        if any(&values) {
            large.push(LargeMap { title, scale: Scale::of(result, &values, 1, scale), value });
        }
    };
    let white = result.states.iter().position(|name| name == "white").unwrap_or(0);
    if let Some(name) = result.states.get(white) {
        let luminance = move |view: &ConeView| view.states.get(white).map_or(f64::NAN, |s| s.luminance_cd_m2);
        let title = format!("Luminance of {} (cd/m\u{b2})", shortened(name, 120.0, SMALL));
        add(title, logarithmic_if_wide, Box::new(luminance));
    }
    let contrast = |view: &ConeView| view.contrast_ratio.unwrap_or(f64::NAN);
    add("Contrast ratio".to_owned(), logarithmic_if_wide, Box::new(contrast));
    let gamut = |view: &ConeView| view.gamut_percent_srgb.unwrap_or(f64::NAN);
    add("Gamut area in u\u{2032}v\u{2032} (% of sRGB)".to_owned(), linear, Box::new(gamut));
    large
}

fn each(result: &ConeResult) -> Vec<StateMaps> {
    let y = |state: &ConeState| state.reflectance_factor_y;
    let states = result.states.len();
    let scale = Scale::of(result, &values_of(result, y), states, |values| sequential(values, WIDE_TOGETHER));
    let mut each = vec![StateMaps { title: "Luminance factor Y", value: y, scale }];
    let shift = |state: &ConeState| state.uv_shift.unwrap_or(f64::NAN);
    let shifts = values_of(result, shift);
    if any_visible(&shifts) {
        let covering = |shifts: &[f64]| Axis::covering(shifts.iter().copied().chain([0.0]), 5, "");
        let scale = Scale::of(result, &shifts, states, covering);
        each.push(StateMaps { title: SHIFT, value: shift, scale });
    }
    each
}

const SHIFT: &str = "Colour shift \u{394}u\u{2032}v\u{2032} from the normal";

/// Returns a large map for each state.
fn enlarged<'a>(result: &'a ConeResult, each: &StateMaps) -> Vec<LargeMap<'a>> {
    let of_state = |(state, name): (usize, &String)| {
        let value = each.value;
        LargeMap {
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

/// Returns whether some directions have no values.
fn blank(result: &ConeResult) -> bool {
    values_of(result, |state| state.luminance_cd_m2).iter().any(|value| value.is_nan())
}

/// Returns whether any colour shift is visible.
fn any_visible(shifts: &[f64]) -> bool {
    shifts.iter().any(|shift| *shift >= VISIBLE_SHIFT)
}

fn linear(values: &[f64]) -> Axis {
    Axis::covering(values.iter().copied(), 6, "")
}

fn logarithmic_if_wide(values: &[f64]) -> Axis {
    sequential(values, WIDE)
}

fn sequential(values: &[f64], wide: f64) -> Axis {
    Axis::logarithmic_beyond(wide, values, "").unwrap_or_else(|| linear(values))
}

fn draw_large(
    svg: &mut Svg,
    result: &ConeResult,
    directions: &Directions<'_>,
    one: &LargeMap<'_>,
    corner: Point,
) {
    let scale = &one.scale.axis;
    let centre = (corner.0 + 56.0 + LARGE, corner.1 + 52.0 + LARGE);
    svg.text((centre.0, corner.1 + 20.0), &one.title, Text::new(13.0, INK).strong().anchor(Anchor::Middle));
    let map = Map { centre, radius: LARGE, scale, labelled: true, contours: true };
    let number = |theta, phi| result.view(theta, phi).map_or(f64::NAN, |view| (one.value)(view));
    directions.draw(svg, &map, &result.lights, number);
    mark_views(svg, result, directions, &map);
    let bar = (centre.0 + LARGE + 38.0, centre.1 - 100.0);
    colour_bar(svg, scale, bar, 200.0, true);
    if let Some(beyond) = &one.scale.beyond {
        let style = Text::new(SMALL - 1.0, INK).anchor(Anchor::End);
        svg.text((bar.0 + 56.0, bar.1 - 26.0), &beyond.up_to(), style);
        svg.text((bar.0 + 56.0, bar.1 - 12.0), &beyond.place(), style);
    }
}

/// Marks the directions of the scenario's views.
fn mark_views(svg: &mut Svg, result: &ConeResult, directions: &Directions<'_>, map: &Map<'_>) {
    if result.views_deg.len() > MAX_VIEWS {
        return;
    }
    for [theta, phi] in &result.views_deg {
        if let Some(at) = directions.inside(map, *theta, *phi) {
            view_mark(svg, at, if map.labelled { 4.5 } else { 3.0 });
        }
    }
}

/// Draws the mark of a view: a cross.
fn view_mark(svg: &mut Svg, (x, y): Point, size: f64) {
    for stroke in [Stroke::solid("#ffffff", 3.4), Stroke::solid(INK, 1.5)] {
        svg.line((x - size, y - size), (x + size, y + size), &stroke);
        svg.line((x - size, y + size), (x + size, y - size), &stroke);
    }
}

fn draw_each(svg: &mut Svg, result: &ConeResult, directions: &Directions<'_>, each: &StateMaps, top: f64) {
    let width = 3.0 * PITCH.0;
    let pitch = (width - 96.0) / IN_A_ROW as f64;
    let beyond = each.scale.beyond.as_ref();
    let beyond = beyond.map_or(String::new(), |beyond| format!(" ({} {})", beyond.up_to(), beyond.place()));
    svg.text((20.0, top + 16.0), &format!("{}{beyond}", each.title), Text::new(13.0, INK).strong());
    for (state, name) in result.states.iter().enumerate() {
        let (column, row) = (state % IN_A_ROW, state / IN_A_ROW);
        let centre: Point = (20.0 + pitch * column as f64 + LITTLE, top + 46.0 + ROW * row as f64 + LITTLE);
        let name = shortened(name, 2.0 * LITTLE, SMALL);
        svg.text((centre.0, centre.1 - LITTLE - 7.0), &name, Text::new(SMALL, INK).anchor(Anchor::Middle));
        let map = Map { centre, radius: LITTLE, scale: &each.scale.axis, labelled: false, contours: true };
        let number = |theta, phi| {
            let state = result.view(theta, phi).and_then(|view| view.states.get(state));
            state.map_or(f64::NAN, each.value)
        };
        directions.draw(svg, &map, &result.lights, number);
        mark_views(svg, result, directions, &map);
    }
    colour_bar(svg, &each.scale.axis, (width - 76.0, top + 46.0), 2.0 * LITTLE, false);
}

/// Draws the legend below the maps: up to five lines.
fn legend(svg: &mut Svg, result: &ConeResult, mut y: f64) {
    const LINE: f64 = 18.0;
    let style = Text::new(11.0, "#777777");
    let text =
        "Centre: display normal; rings: every 20\u{b0} of inclination; azimuth: 0\u{b0} right, 90\u{b0} up.";
    svg.text((20.0, y), text, style);
    if (1..=MAX_VIEWS).contains(&result.views_deg.len()) {
        y += LINE;
        view_mark(svg, (27.0, y - 4.0), 4.0);
        let several =
            if result.views_deg.len() > 1 { "directions of the views" } else { "direction of the view" };
        svg.text((41.0, y), several, style);
    }
    if !result.lights.is_empty() {
        y += LINE;
        sun(svg, (27.0, y - 4.0), 4.0);
        svg.text((41.0, y), "direction of the light", style);
        svg.circle((179.0, y - 4.0), 4.0, "none", &Stroke::solid(INK, 1.2));
        svg.text((189.0, y), "direction of its mirror image", style);
    }
    if blank(result) {
        y += LINE;
        svg.rect((21.0, y - 10.0), (12.0, 12.0), 0.0, BLANK, "#bbbbbb");
        svg.text((41.0, y), "no data", style);
    }
    let shifts = values_of(result, |state| state.uv_shift.unwrap_or(f64::NAN));
    if any(&shifts) && !any_visible(&shifts) {
        y += LINE;
        svg.text((20.0, y), &format!("{SHIFT}: less than {VISIBLE_SHIFT} for every state."), style);
    }
}
