//! The u'v' diagram: spectral locus, sRGB and EBU, the display's gamut, its states and its light.

use papilio_colour::{GamutReference, UvPrime, spectral_locus};
use papilio_display::result::{RunResult, View};

use crate::panel::{Axis, Panel, SMALL};
use crate::place::Places;
use crate::style::{INK, SOFT, painted, with_error};
use crate::svg::{Anchor, Point, Stroke, Svg, Text, hex};

/// Wavelengths that are written along the locus, nm.
const NAMED_NM: [f64; 12] =
    [440.0, 460.0, 470.0, 480.0, 490.0, 500.0, 520.0, 550.0, 580.0, 600.0, 620.0, 650.0];
/// The part of the diagram that is drawn: u' and v', from and to.
const DRAWN: [(f64, f64); 2] = [(-0.05, 0.65), (0.0, 0.63)];
/// What is left of the screen's colours inside the locus.
const TINT: f64 = 0.30;

/// The states of a view in the u'v' diagram, each a disc in the colour that it
/// shows, with crosses of one standard error where they can be seen.
pub fn chromaticity(result: &RunResult, view: &View) -> String {
    let width = 560.0;
    let mut svg = Svg::new(width + 90.0, height(width) + 72.0);
    draw(&mut svg, result, view, (70.0, 20.0), width);
    svg.finish()
}

/// The same in a page, `width` px wide and [`height`] px high.
pub(crate) fn draw(svg: &mut Svg, result: &RunResult, view: &View, origin: Point, width: f64) {
    let panel = Panel {
        origin,
        size: (width, height(width)),
        x: Axis::exact(DRAWN[0].0, DRAWN[0].1, 7, "u\u{2032}"),
        y: Axis::exact(DRAWN[1].0, DRAWN[1].1, 7, "v\u{2032}"),
    };
    panel.draw(svg);
    locus(svg, &panel);
    let at = |uv: UvPrime| panel.at(uv.u, uv.v);
    let srgb = GamutReference::Srgb.primaries_uv().map(at);
    svg.outline(&srgb, &srgb_stroke());
    svg.outline(&GamutReference::Ebu.primaries_uv().map(at), &ebu_stroke());
    let mut triangles = vec![srgb];
    if let [Some(red), Some(green), Some(blue)] = ["red", "green", "blue"].map(|name| state_uv(view, name)) {
        let display = [red, green, blue].map(at);
        svg.outline(&display, &display_stroke());
        triangles.push(display);
    }
    states(svg, &panel, result, view, &triangles);
    legend(svg, &panel, view, triangles.len() > 1);
}

/// Height of a diagram of this width, so that u' and v' have one scale.
pub(crate) fn height(width: f64) -> f64 {
    let [u, v] = DRAWN.map(|(from, to)| to - from);
    width * v / u
}

fn display_stroke() -> Stroke {
    Stroke::solid(INK, 1.8)
}

fn srgb_stroke() -> Stroke {
    Stroke::solid("#666666", 1.2).dashed("6 4")
}

fn ebu_stroke() -> Stroke {
    Stroke::solid("#666666", 1.2).dashed("1.5 3")
}

fn state_uv(view: &View, name: &str) -> Option<UvPrime> {
    let value = &view.states.get(name)?.value;
    Some(UvPrime { u: value.u_prime?, v: value.v_prime? })
}

/// The spectral locus, tinted inside, with wavelengths outside.
fn locus(svg: &mut Svg, panel: &Panel) {
    let points: Vec<(f64, UvPrime)> =
        spectral_locus().filter_map(|(nm, xyz)| Some((nm, xyz.uv_prime()?))).collect();
    let outline: Vec<Point> = points.iter().map(|(_, uv)| panel.at(uv.u, uv.v)).collect();
    svg.clipped(&outline, 4.0, |svg| tint(svg, panel, &points));
    svg.outline(&outline, &Stroke::solid(SOFT, 1.2));
    for (around, (nm, _)) in outline.windows(3).zip(&points[1..]) {
        if NAMED_NM.contains(nm) {
            name_wavelength(svg, around, *nm);
        }
    }
}

/// A tick at the middle one of three points of the locus, and its wavelength outside.
fn name_wavelength(svg: &mut Svg, around: &[Point], nm: f64) {
    let &[before, here, after] = around else { return };
    // Outwards is to the left of the way from blue to red, seen on the page.
    let (dx, dy) = (after.0 - before.0, after.1 - before.1);
    let out = (dy / dx.hypot(dy), -dx / dx.hypot(dy));
    let step = |r: f64| (here.0 + r * out.0, here.1 + r * out.1);
    svg.line(here, step(5.0), &Stroke::solid(SOFT, 1.0));
    let anchor = match out.0 {
        x if x < -0.5 => Anchor::End,
        x if x > 0.5 => Anchor::Start,
        _ => Anchor::Middle,
    };
    let (x, y) = step(9.0);
    let style = Text::new(10.5, "#777777").anchor(anchor);
    svg.text((x, y + 4.0 + 4.0 * out.1), &format!("{nm:.0}"), style);
}

/// Cells in a light version of the most luminous screen colour of their chromaticity.
fn tint(svg: &mut Svg, panel: &Panel, locus: &[(f64, UvPrime)]) {
    const CELL: f64 = 0.02;
    let (Some((_, blue)), Some((_, red))) = (locus.first(), locus.last()) else { return };
    for (column, row) in (0..32).flat_map(|column| (0..31).map(move |row| (column, row))) {
        let (u, v) = (CELL * f64::from(column), CELL * f64::from(row));
        let beyond_purple = (red.u - blue.u) * (v + CELL - blue.v) < (red.v - blue.v) * (u - blue.u);
        let colour = UvPrime { u: u + CELL / 2.0, v: v + CELL / 2.0 }.with_luminance(1.0);
        let Some(colour) = colour.filter(|_| !beyond_purple) else { continue };
        let linear = colour.linear_srgb().map(|c| c.max(0.0));
        let brightest = linear.into_iter().fold(1e-9, f64::max);
        let channel = |c: f64| 255.0 * (1.0 - TINT + TINT * (c / brightest).powf(1.0 / 2.2));
        let (low, high) = (panel.at(u, v), panel.at(u + CELL, v + CELL));
        // Half a px more than the cell, or seams would show.
        let size = (high.0 - low.0 + 0.5, low.1 - high.1 + 0.5);
        svg.rect((low.0, high.1), size, 0.0, &hex(linear.map(|c| channel(c).round() as u8)), "");
    }
}

/// Discs, error crosses and names of the states, and the white of the light.
fn states(svg: &mut Svg, panel: &Panel, result: &RunResult, view: &View, triangles: &[[Point; 3]]) {
    let light = panel.at(result.illuminant.u_prime, result.illuminant.v_prime);
    let cross = Stroke::solid(INK, 1.4);
    svg.line((light.0 - 5.0, light.1), (light.0 + 5.0, light.1), &cross);
    svg.line((light.0, light.1 - 5.0), (light.0, light.1 + 5.0), &cross);
    let mut marks = vec![("light", light)];
    for (name, state) in view.states.iter() {
        let (Some(u), Some(v)) = (state.value.u_prime, state.value.v_prime) else { continue };
        let (at, stroke) = (panel.at(u, v), Stroke::solid(INK, 1.2));
        if !(DRAWN[0].0..=DRAWN[0].1).contains(&u) || !(DRAWN[1].0..=DRAWN[1].1).contains(&v) {
            continue; // Noise of a black state can leave the diagram.
        }
        panel.error_bars(svg, &[u], &[v], &[state.standard_error.v_prime.unwrap_or(f64::NAN)], &stroke);
        let wide = state.standard_error.u_prime.unwrap_or(f64::NAN);
        let (left, right) = (panel.at(u - wide, v), panel.at(u + wide, v));
        if right.0 - left.0 > 2.0 {
            svg.line(left, right, &stroke);
        }
        svg.circle(at, 5.5, &painted(&state.value, &result.illuminant), &Stroke::solid("#ffffff", 3.0));
        svg.circle(at, 5.5, &painted(&state.value, &result.illuminant), &stroke);
        marks.push((name, at));
    }
    let mut places = Places::around(marks.iter().map(|(_, at)| *at));
    for triangle in triangles {
        places.avoid(triangle);
    }
    for (name, at) in marks {
        let (corner, anchor) = places.find(at, name, SMALL);
        svg.text(corner, name, Text::new(SMALL, INK).anchor(anchor).halo());
    }
}

/// What the triangles are, and how large the display's is, in the empty corner below the purples.
fn legend(svg: &mut Svg, panel: &Panel, view: &View, has_gamut: bool) {
    let percent = |value: Option<f64>, error: Option<f64>, of: &str| {
        value.map_or_else(|| of.to_owned(), |v| format!("{} % of {of}", with_error(v, error, 1)))
    };
    let error = &view.standard_error;
    let mut lines = vec![
        (srgb_stroke(), percent(view.gamut_percent_srgb, error.gamut_percent_srgb, "sRGB")),
        (ebu_stroke(), percent(view.gamut_percent_ebu, error.gamut_percent_ebu, "EBU")),
    ];
    if has_gamut {
        lines.insert(0, (display_stroke(), "display".to_owned()));
    }
    let left = panel.right() - 185.0;
    let top = panel.bottom() - 14.0 - 19.0 * lines.len() as f64;
    for (i, (stroke, text)) in lines.iter().enumerate() {
        let y = top + 19.0 * (i + 1) as f64;
        svg.line((left, y - 4.0), (left + 26.0, y - 4.0), stroke);
        svg.text((left + 33.0, y), text, Text::new(SMALL, INK));
    }
}
