//! The u'v' diagram: spectral locus, sRGB and EBU, the display's gamut, its states and its light.

use papilio_colour::{GamutReference, UvPrime};
use papilio_display::result::{RunResult, View};

use crate::axis::Axis;
use crate::locus;
use crate::marks::{Marks, Window};
use crate::panel::{Panel, SMALL};
use crate::style::{INK, caption, with_error};
use crate::svg::{Point, Stroke, Svg, Text};

/// Range of the diagram: u' and v', from and to.
const DRAWN: [(f64, f64); 2] = [(-0.05, 0.65), (0.0, 0.63)];
/// Colours of several displays' gamuts.
const HUES: [&str; 4] = ["#2b5fc7", "#c8321f", "#2c9a57", "#7a5bc0"];
/// Height of a line of the legend, px.
const LINE: f64 = 19.0;

/// Draws the states of a view in the u'v' diagram. Each is a disc in its own colour, with a cross of one standard
/// error where this is visible.
///
/// Where the states and the light are too close together for their marks and
/// names, an enlarged part of the diagram shows the names.
pub fn chromaticity(result: &RunResult, view: &View, title: &str) -> String {
    let width = 560.0;
    let mut svg = Svg::new(width + 90.0, height(width) + 72.0).titled(&caption(title, view));
    draw(&mut svg, result, view, (70.0, 20.0), width);
    svg.finish()
}

/// Draws the gamuts of several displays and of sRGB in one diagram, with percentages of sRGB in the legend.
pub fn gamuts(displays: &[(&str, &View)], title: &str) -> String {
    let width = 560.0;
    let mut svg = Svg::new(width + 90.0, height(width) + 72.0).titled(title);
    let panel = diagram(&mut svg, (70.0, 20.0), width);
    panel.triangle(&mut svg, GamutReference::Srgb.primaries_uv(), &srgb_stroke());
    let named: Vec<(Stroke, String)> = displays
        .iter()
        .enumerate()
        .map(|(i, (name, view))| {
            let stroke =
                Stroke::solid(HUES[i % HUES.len()], 1.8).dashed(if i >= HUES.len() { "6 3" } else { "" });
            if let Some(triangle) = display(view) {
                panel.triangle(&mut svg, triangle, &stroke);
            }
            let percent =
                view.metrics.gamut_percent_srgb.map_or(String::new(), |v| format!(", {v:.1} % of sRGB"));
            (stroke, format!("{name}{percent}"))
        })
        .chain([(srgb_stroke(), "sRGB".to_owned())])
        .collect();
    key(&mut svg, &named, (panel.right() - 235.0, panel.bottom() - LINE * (named.len() as f64 + 0.5)));
    svg.finish()
}

/// Draws a legend of strokes and their names.
fn key(svg: &mut Svg, lines: &[(Stroke, String)], (left, top): Point) {
    for (i, (stroke, text)) in lines.iter().enumerate() {
        let y = top + LINE * (i + 1) as f64;
        svg.line((left, y - 4.0), (left + 26.0, y - 4.0), stroke);
        svg.text((left + 33.0, y), text, Text::new(SMALL, INK));
    }
}

/// Draws an empty diagram with the spectral locus.
fn diagram(svg: &mut Svg, origin: Point, width: f64) -> Panel {
    let panel = self::panel(origin, (width, height(width)));
    panel.draw(svg);
    locus::draw(svg, &panel);
    panel
}

/// Draws the diagram within a page, `width` px wide and [`height`] px high.
pub(crate) fn draw(svg: &mut Svg, result: &RunResult, view: &View, origin: Point, width: f64) {
    let panel = diagram(svg, origin, width);
    let srgb = GamutReference::Srgb.primaries_uv();
    panel.triangle(svg, srgb, &srgb_stroke());
    panel.triangle(svg, GamutReference::Ebu.primaries_uv(), &ebu_stroke());
    let display = display(view);
    if let Some(display) = display {
        panel.triangle(svg, display, &display_stroke());
    }
    let marks = Marks::of(result, view, &panel);
    marks.draw(svg, &panel);
    match marks.crowded() {
        Some(window) => {
            inset(svg, &panel, &marks, window, display);
            legend(svg, panel.origin.1, &panel, view, display.is_some());
        }
        None => {
            marks.name(svg, &panel, &[Some(srgb), display]);
            legend(svg, panel.bottom() - 3.5 * LINE, &panel, view, display.is_some());
        }
    }
}

/// Returns the panel of the diagram with its axes.
pub(crate) fn panel(origin: Point, size: Point) -> Panel {
    Panel {
        origin,
        size,
        x: Axis::exact(DRAWN[0].0, DRAWN[0].1, 7, "u\u{2032}"),
        y: Axis::exact(DRAWN[1].0, DRAWN[1].1, 7, "v\u{2032}"),
    }
}

/// Returns the height of a diagram of this width for which u' and v' have the same scale.
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

/// Returns the gamut triangle of the display, if it has the three states.
fn display(view: &View) -> Option<[UvPrime; 3]> {
    let [red, green, blue] = ["red", "green", "blue"].map(|name| {
        let value = &view.states.get(name)?.value;
        let uv = UvPrime { u: value.u_prime?, v: value.v_prime? };
        (uv.u.is_finite() && uv.v.is_finite()).then_some(uv)
    });
    Some([red?, green?, blue?])
}

/// Draws the part of the diagram around the marks, enlarged and with names, in the empty corner below the purple line.
fn inset(svg: &mut Svg, panel: &Panel, marks: &Marks, window: Window, display: Option<[UvPrime; 3]>) {
    let side = 0.3 * panel.size.0;
    let origin = (panel.right() - side - 8.0, panel.bottom() - side - 34.0);
    let (thin, reach) = (Stroke::solid(INK, 0.8), window.side / 2.0);
    let axis = |middle: f64| Axis::exact(middle - reach, middle + reach, 3, "");
    let UvPrime { u, v } = window.middle;
    let enlarged = Panel { origin, size: (side, side), x: axis(u), y: axis(v) };
    svg.rect((origin.0 - 48.0, origin.1 - 8.0), (side + 56.0, side + 34.0), 4.0, "#ffffff", "");
    enlarged.draw(svg);
    let corners = [(-reach, -reach), (reach, -reach), (reach, reach), (-reach, reach)];
    for around in [panel, &enlarged] {
        svg.outline(&corners.map(|(du, dv)| around.at(u + du, v + dv)), &thin);
    }
    svg.line(panel.at(u + reach, v - reach), origin, &thin);
    if let Some(display) = display {
        enlarged.triangle(svg, display, &display_stroke());
    }
    marks.draw(svg, &enlarged);
    marks.name(svg, &enlarged, &[display]);
}

/// Draws the legend of the triangles, with the gamut area of the display, on the right, from `top` down.
fn legend(svg: &mut Svg, top: f64, panel: &Panel, view: &View, has_gamut: bool) {
    let percent = |value: Option<f64>, error: Option<f64>, of: &str| {
        value.map_or_else(|| of.to_owned(), |v| format!("{} % of {of}", with_error(v, error, 1)))
    };
    let error = &view.standard_error;
    let mut lines = vec![
        (srgb_stroke(), percent(view.metrics.gamut_percent_srgb, error.gamut_percent_srgb, "sRGB")),
        (ebu_stroke(), percent(view.metrics.gamut_percent_ebu, error.gamut_percent_ebu, "EBU")),
    ];
    if has_gamut {
        lines.insert(0, (display_stroke(), "display".to_owned()));
    }
    key(svg, &lines, (panel.right() - 185.0, top));
}
