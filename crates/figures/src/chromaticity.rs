//! A chromaticity diagram: spectral locus, standard gamuts, the display's gamut, its states and its light.

use papilio_colour::GamutReference;
use papilio_display::result::{RunResult, View};

use crate::axis::Axis;
use crate::diagram::{Coordinates, Diagram, REFERENCES};
use crate::locus;
use crate::marks::{Marks, Window};
use crate::panel::{Panel, SMALL};
use crate::style::{INK, caption, with_error};
use crate::svg::{Point, Stroke, Svg, Text};

/// Width of a diagram in a figure of its own, px.
pub(crate) const WIDTH: f64 = 560.0;
/// Colours of several displays' gamuts.
const HUES: [&str; 4] = ["#2b5fc7", "#c8321f", "#2c9a57", "#7a5bc0"];
/// Dash patterns of the standard gamuts, in the order of [`REFERENCES`].
const DASHES: [&str; REFERENCES.len()] = ["6 4", "1.5 3", "8 3 1.5 3"];
/// Height of a line of the legend, px.
const LINE: f64 = 19.0;
/// The same in a compact legend, px.
const COMPACT_LINE: f64 = 16.0;
/// Width of the legend, px.
const LEGEND: f64 = 185.0;

/// Draws the states of a view in a chromaticity diagram. Each is a disc in its own colour, with a cross of
/// one standard error where this is visible.
///
/// Where the states are too close together for their marks and
/// names, an enlarged part of the diagram shows the names.
pub fn chromaticity(result: &RunResult, view: &View, diagram: Diagram, title: &str) -> String {
    let size = (WIDTH + 90.0, diagram.height(WIDTH) + 72.0);
    let mut svg = Svg::new(size.0, size.1).titled(&caption(title, view));
    draw(&mut svg, result, view, diagram, (70.0, 20.0), WIDTH);
    svg.finish()
}

/// Draws the gamuts of several displays and of sRGB in one u'v' diagram, with percentages of sRGB in the
/// legend.
pub fn gamuts(displays: &[(&str, &View)], title: &str) -> String {
    let diagram = Diagram::Uv;
    let mut svg = Svg::new(WIDTH + 90.0, diagram.height(WIDTH) + 72.0).titled(title);
    let panel = with_locus(&mut svg, diagram, (70.0, 20.0), WIDTH);
    let srgb = reference_stroke(0);
    panel.triangle(&mut svg, diagram.primaries(GamutReference::Srgb), &srgb);
    let named: Vec<(Stroke, String)> = displays
        .iter()
        .enumerate()
        .map(|(i, (name, view))| {
            let stroke =
                Stroke::solid(HUES[i % HUES.len()], 1.8).dashed(if i >= HUES.len() { "6 3" } else { "" });
            if let Some(triangle) = diagram.display(view) {
                panel.triangle(&mut svg, triangle, &stroke);
            }
            let percent =
                view.metrics.gamut_percent_srgb.map_or(String::new(), |v| format!(", {v:.1} % of sRGB"));
            (stroke, format!("{name}{percent}"))
        })
        .chain([(srgb, "sRGB".to_owned())])
        .collect();
    key(&mut svg, &named, (panel.right() - 235.0, panel.bottom() - LINE * (named.len() as f64 + 0.5)), LINE);
    svg.finish()
}

/// Draws a legend of strokes and their names.
fn key(svg: &mut Svg, lines: &[(Stroke, String)], (left, top): Point, line: f64) {
    for (i, (stroke, text)) in lines.iter().enumerate() {
        let y = top + line * (i + 1) as f64;
        svg.line((left, y - 4.0), (left + 26.0, y - 4.0), stroke);
        svg.text((left + 33.0, y), text, Text::new(SMALL, INK));
    }
}

/// Draws an empty diagram with the spectral locus.
pub(crate) fn with_locus(svg: &mut Svg, diagram: Diagram, origin: Point, width: f64) -> Panel {
    let panel = diagram.panel(origin, width);
    panel.draw(svg);
    locus::draw(svg, &panel, diagram);
    panel
}

/// Draws the diagram within a page, `width` px wide.
pub(crate) fn draw(
    svg: &mut Svg,
    result: &RunResult,
    view: &View,
    diagram: Diagram,
    origin: Point,
    width: f64,
) {
    let panel = with_locus(svg, diagram, origin, width);
    for (k, (reference, _)) in REFERENCES.into_iter().enumerate() {
        panel.triangle(svg, diagram.primaries(reference), &reference_stroke(k));
    }
    let display = diagram.display(view);
    if let Some(display) = display {
        panel.triangle(svg, display, &display_stroke());
    }
    let marks = Marks::of(result, view, &panel, diagram);
    marks.draw(svg, &panel);
    let (empty, other) = corners(&panel, diagram, display.is_some());
    match marks.crowded() {
        Some(window) => {
            inset(svg, &panel, &marks, window, (display, empty));
            // Above the locus of u'v' there is room for few lines.
            let compact = diagram == Diagram::Uv;
            legend(svg, other, view, diagram, (display.is_some(), compact));
        }
        None => {
            let sides = REFERENCES.map(|(reference, _)| Some(diagram.primaries(reference)));
            marks.name(svg, &panel, &[sides[0], sides[1], sides[2], display]);
            let has_gamut = display.is_some();
            legend(svg, legend_place(&panel, diagram, has_gamut), view, diagram, (has_gamut, false));
        }
    }
}

/// Returns the lines of the legend.
fn lines(has_gamut: bool) -> f64 {
    REFERENCES.len() as f64 + if has_gamut { 2.0 } else { 0.0 }
}

/// Returns the place of a legend in the empty corner: below the purple line in u'v', beyond x + y = 1 in xy.
fn legend_place(panel: &Panel, diagram: Diagram, has_gamut: bool) -> Point {
    let left = panel.right() - LEGEND;
    match diagram {
        Diagram::Uv => (left, panel.bottom() - (lines(has_gamut) + 0.5) * LINE),
        Diagram::Xy => (left, panel.origin.1),
    }
}

/// Returns the corner in which an enlarged part fits, and the place of a legend elsewhere.
fn corners(panel: &Panel, diagram: Diagram, has_gamut: bool) -> (Point, Point) {
    let (side, left) = (side_of_inset(panel), panel.right() - LEGEND);
    let right = panel.right() - side - 8.0;
    match diagram {
        Diagram::Uv => ((right, panel.bottom() - side - 34.0), (left, panel.origin.1)),
        Diagram::Xy => {
            ((right, panel.origin.1 + 12.0), (left, panel.bottom() - (lines(has_gamut) + 0.5) * LINE))
        }
    }
}

/// Side of an enlarged part, px.
fn side_of_inset(panel: &Panel) -> f64 {
    0.3 * panel.size.0
}

fn display_stroke() -> Stroke {
    Stroke::solid(INK, 1.8)
}

/// Returns the stroke of a standard gamut.
fn reference_stroke(k: usize) -> Stroke {
    Stroke::solid("#666666", 1.2).dashed(DASHES[k % DASHES.len()])
}

/// Draws the part of the diagram around the marks, enlarged and with names, at `origin`.
fn inset(
    svg: &mut Svg,
    panel: &Panel,
    marks: &Marks,
    window: Window,
    (display, origin): (Option<[Coordinates; 3]>, Point),
) {
    let side = side_of_inset(panel);
    let (thin, reach) = (Stroke::solid(INK, 0.8), window.side / 2.0);
    let axis = |middle: f64| Axis::exact(middle - reach, middle + reach, 3, "");
    let (x, y) = window.middle;
    let enlarged = Panel { origin, size: (side, side), x: axis(x), y: axis(y) };
    svg.rect((origin.0 - 48.0, origin.1 - 8.0), (side + 56.0, side + 34.0), 4.0, "#ffffff", "");
    enlarged.draw(svg);
    let corners = [(-reach, -reach), (reach, -reach), (reach, reach), (-reach, reach)];
    for around in [panel, &enlarged] {
        svg.outline(&corners.map(|(dx, dy)| around.at(x + dx, y + dy)), &thin);
    }
    // From the inset's corner that faces the window.
    let (corner, top) = (panel.at(x + reach, y - reach), origin.1 + side);
    svg.line(corner, (origin.0, if corner.1 > top { top } else { origin.1 }), &thin);
    if let Some(display) = display {
        enlarged.triangle(svg, display, &display_stroke());
    }
    marks.draw_within(svg, &enlarged);
    marks.name(svg, &enlarged, &[display]);
}

/// Draws the legend of the triangles, with the gamut area of the display relative to each, from `top` down. A
/// compact one has no line of its own for the name of the diagram.
fn legend(
    svg: &mut Svg,
    (left, top): Point,
    view: &View,
    diagram: Diagram,
    (has_gamut, compact): (bool, bool),
) {
    let line = |(k, (reference, name)): (usize, (GamutReference, &str))| {
        let value = diagram.percent(&view.metrics, reference);
        let error = diagram.percent(&view.standard_error, reference);
        let percent = value.map_or(String::new(), |v| format!(" (display: {} %)", with_error(v, error, 1)));
        (reference_stroke(k), format!("{name}{percent}"))
    };
    let mut lines: Vec<(Stroke, String)> = REFERENCES.into_iter().enumerate().map(line).collect();
    let name = format!("Gamut area in {}", diagram.name());
    match (has_gamut, compact) {
        (false, _) => key(svg, &lines, (left, top), LINE),
        (true, true) => {
            lines.insert(0, (display_stroke(), format!("display: {}", name.to_lowercase())));
            key(svg, &lines, (left, top - 6.0), COMPACT_LINE);
        }
        (true, false) => {
            lines.insert(0, (display_stroke(), "display".to_owned()));
            svg.text((left, top + LINE), &name, Text::new(SMALL, INK).strong());
            key(svg, &lines, (left, top + LINE), LINE);
        }
    }
}
