//! The lighting: luminance over the hemisphere above the display, directed sources, and the mirror directions
//! of the views.

use papilio_display::AmbientLight;

use crate::axis::Axis;
use crate::panel::SMALL;
use crate::polar::{Directions, Map, colour_bar, sun};
use crate::style::{INK, SOFT, degrees};
use crate::svg::{Anchor, Point, Stroke, Svg, Text};

/// Radius and centre of the map, px.
const RADIUS: f64 = 190.0;
const CENTRE: Point = (240.0, 256.0);
/// Ratio of the largest to the smallest luminance above which the scale is logarithmic.
const WIDE: f64 = 30.0;
/// Largest number of rows in the list of sources; further sources are summed.
const LISTED: usize = 8;
/// Largest number of views whose mirror directions are drawn; more would cover the map.
const MAX_VIEWS: usize = 12;
/// Position of the list, and horizontal distance to the right edge of its numbers, px.
const LIST: Point = (566.0, 64.0);
const NUMBERS: f64 = 218.0;

/// Draws the luminance of each direction in false colours, directed sources as suns, the mirror directions of
/// the views as rings, and a list of the illuminance of each source.
pub fn light(room: &AmbientLight, title: &str) -> String {
    let mut svg = Svg::new(800.0, 510.0).titled(title);
    let Some(directions) = Directions::new(&room.theta_deg, &room.phi_deg) else { return svg.finish() };
    let values = &room.luminance_cd_m2;
    let is_lit = values.iter().any(|value| *value > 0.0);
    let scale = Axis::logarithmic_beyond(WIDE, values, "Luminance (cd/m\u{b2})")
        .unwrap_or_else(|| Axis::covering(values.iter().copied().chain([0.0]), 6, "Luminance (cd/m\u{b2})"));
    let heading = if is_lit { "Light from each direction" } else { "Directed sources only" };
    svg.text((CENTRE.0, 36.0), heading, Text::new(13.0, INK).strong().anchor(Anchor::Middle));
    let map = Map { centre: CENTRE, radius: RADIUS, scale: &scale, labelled: true, contours: false };
    let columns = room.phi_deg.len();
    let value =
        |i: usize, j: usize| values.get(i * columns + j).copied().filter(|_| is_lit).unwrap_or(f64::NAN);
    directions.draw(&mut svg, &map, &[], value);
    for source in &room.directed {
        sun(&mut svg, directions.at(&map, source.theta_deg, source.phi_deg), 5.0);
    }
    for [theta, phi] in mirrored(room) {
        let at = directions.at(&map, *theta, phi + 180.0);
        svg.circle(at, 5.0, "none", &Stroke::solid("#ffffff", 3.0));
        svg.circle(at, 5.0, "none", &Stroke::solid(INK, 1.4));
    }
    if is_lit {
        svg.text((CENTRE.0 + RADIUS + 48.0, CENTRE.1 - 116.0), "cd/m\u{b2}", Text::new(SMALL, INK));
        colour_bar(&mut svg, &scale, (CENTRE.0 + RADIUS + 48.0, CENTRE.1 - 104.0), 208.0, true);
    }
    list(&mut svg, room);
    legend(&mut svg, room);
    svg.finish()
}

fn mirrored(room: &AmbientLight) -> &[[f64; 2]] {
    if room.views_deg.len() > MAX_VIEWS { &[] } else { &room.views_deg }
}

/// Draws the list of the sources and their illuminances.
fn list(svg: &mut Svg, room: &AmbientLight) {
    let diffuse = (room.diffuse_lx > 0.0).then(|| ("diffuse".to_owned(), room.diffuse_lx));
    // These include luminaires and the suns of skies, so that their numbers differ from those in the
    // scenario.
    let directed = room.directed.iter().map(|source| {
        let azimuth = if source.phi_deg == 0.0 {
            String::new()
        } else {
            format!(", azimuth {}", degrees(source.phi_deg))
        };
        (format!("directed, {}{azimuth}", degrees(source.theta_deg)), source.illuminance_lx)
    });
    let of = room.environment_lx.len();
    let name = |i: usize| if of == 1 { "environment".to_owned() } else { format!("environment {i}") };
    let environments = room.environment_lx.iter().enumerate().map(|(i, lux)| (name(i), *lux));
    let mut rows: Vec<(String, f64)> = diffuse.into_iter().chain(directed).chain(environments).collect();
    let all: f64 = rows.iter().map(|(_, lux)| lux).sum();
    if rows.len() > LISTED {
        let rest = rows.split_off(LISTED - 1);
        rows.push((format!("{} more", rest.len()), rest.iter().map(|(_, lux)| lux).sum()));
    }
    let (x, mut y) = LIST;
    let number = Text::new(SMALL, INK).anchor(Anchor::End);
    svg.text((x, y - 26.0), "Illuminance on the display", Text::new(13.0, INK).strong());
    for (name, lux) in &rows {
        svg.text((x, y), name, Text::new(SMALL, INK));
        svg.text((x + NUMBERS, y), &format!("{} lx", rounded(*lux)), number);
        y += 20.0;
    }
    svg.line((x, y - 12.0), (x + NUMBERS, y - 12.0), &Stroke::solid(SOFT, 1.0));
    svg.text((x, y + 6.0), "total", Text::new(SMALL, INK));
    svg.text((x + NUMBERS, y + 6.0), &format!("{} lx", rounded(all)), number.strong());
}

/// Formats an illuminance with three significant digits, or with all digits before the decimal point if these
/// are more.
fn rounded(lux: f64) -> String {
    let decimals = if lux > 0.0 { (2.0 - lux.log10().floor()).clamp(0.0, 8.0) as usize } else { 0 };
    format!("{lux:.decimals$}")
}

fn legend(svg: &mut Svg, room: &AmbientLight) {
    let style = Text::new(11.0, "#777777");
    let (x, mut y) = (LIST.0, CENTRE.1 + 60.0);
    let lines = [
        "Centre: display normal",
        "Rings: every 20\u{b0} of inclination",
        "Azimuth: 0\u{b0} right, 90\u{b0} up",
    ];
    for line in lines {
        svg.text((x, y), line, style);
        y += 16.0;
    }
    if !room.directed.is_empty() {
        y += 8.0;
        sun(svg, (x + 7.0, y - 4.0), 4.0);
        svg.text((x + 22.0, y), "directed source (not in the colours)", style);
        y += 16.0;
    }
    if !mirrored(room).is_empty() {
        y += 8.0;
        svg.circle((x + 7.0, y - 4.0), 4.5, "none", &Stroke::solid(INK, 1.4));
        svg.text((x + 22.0, y), "mirror direction of a view", style);
    }
}
