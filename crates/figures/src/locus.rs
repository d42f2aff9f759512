//! The spectral locus in a chromaticity diagram.

use papilio_colour::spectral_locus;

use crate::diagram::{Coordinates, Diagram};
use crate::panel::Panel;
use crate::style::SOFT;
use crate::svg::{Anchor, Point, Stroke, Svg, Text, hex};

/// Wavelengths with a label on the locus, nm.
const NAMED_NM: [f64; 12] =
    [440.0, 460.0, 470.0, 480.0, 490.0, 500.0, 520.0, 550.0, 580.0, 600.0, 620.0, 650.0];
/// Fraction of the screen's colours in the tint inside the locus; the rest is white.
const TINT: f64 = 0.30;
/// Side of a cell of the tint, in units of the diagram.
const CELL: f64 = 0.02;
/// Cells drawn beyond the purple line, so that the blur has colours on both of its sides.
const BEYOND: f64 = 2.0;

/// Draws the spectral locus, with a tint inside and wavelengths outside.
pub(crate) fn draw(svg: &mut Svg, panel: &Panel, diagram: Diagram) {
    let points: Vec<(f64, Coordinates)> =
        spectral_locus().filter_map(|(nm, xyz)| Some((nm, diagram.of(xyz)?))).collect();
    let outline: Vec<Point> = points.iter().map(|(_, (x, y))| panel.at(*x, *y)).collect();
    // Blurred by half a cell: without visible steps.
    let cell = panel.at(CELL, 0.0).0 - panel.at(0.0, 0.0).0;
    svg.clipped(&outline, 0.5 * cell, |svg| tint(svg, panel, diagram, &points));
    svg.outline(&outline, &Stroke::solid(SOFT, 1.2));
    for (around, (nm, _)) in outline.windows(3).zip(&points[1..]) {
        if NAMED_NM.contains(nm) {
            name_wavelength(svg, around, *nm);
        }
    }
}

/// Draws a tick at the middle one of three points of the locus, and its wavelength outside.
fn name_wavelength(svg: &mut Svg, around: &[Point], nm: f64) {
    let &[before, here, after] = around else { return };
    // On the page, the outside is to the left of the direction from blue to red.
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

/// Fills cells with a light version of the most luminous screen colour of their chromaticity.
fn tint(svg: &mut Svg, panel: &Panel, diagram: Diagram, locus: &[(f64, Coordinates)]) {
    let (Some((_, blue)), Some((_, red))) = (locus.first(), locus.last()) else { return };
    let ends = |of: fn(&Coordinates) -> f64| {
        let most = locus.iter().map(|(_, at)| of(at)).fold(0.0, f64::max);
        0..(most / CELL).ceil() as u32 + BEYOND as u32
    };
    let purple = (red.0 - blue.0, red.1 - blue.1);
    let reach = BEYOND * CELL * purple.0.hypot(purple.1);
    for (column, row) in ends(|at| at.0).flat_map(|column| ends(|at| at.1).map(move |row| (column, row))) {
        let (x, y) = (CELL * f64::from(column), CELL * f64::from(row));
        let middle = (x + CELL / 2.0, y + CELL / 2.0);
        let is_beyond = purple.0 * (middle.1 - blue.1) < purple.1 * (middle.0 - blue.0) - reach;
        let Some(colour) = diagram.xyz(middle).filter(|_| !is_beyond) else { continue };
        let linear = colour.linear_srgb().map(|c| c.max(0.0));
        let brightest = linear.into_iter().fold(1e-9, f64::max);
        let channel = |c: f64| 255.0 * (1.0 - TINT + TINT * (c / brightest).powf(1.0 / 2.2));
        let (low, high) = (panel.at(x, y), panel.at(x + CELL, y + CELL));
        // Half a px larger than the cell, to avoid visible seams.
        let size = (high.0 - low.0 + 0.5, low.1 - high.1 + 0.5);
        svg.rect((low.0, high.1), size, 0.0, &hex(linear.map(|c| channel(c).round() as u8)), "");
    }
}
