//! The spectral locus in the u'v' diagram.

use papilio_colour::{UvPrime, spectral_locus};

use crate::panel::Panel;
use crate::style::SOFT;
use crate::svg::{Anchor, Point, Stroke, Svg, Text, hex};

/// Wavelengths with a label on the locus, nm.
const NAMED_NM: [f64; 12] =
    [440.0, 460.0, 470.0, 480.0, 490.0, 500.0, 520.0, 550.0, 580.0, 600.0, 620.0, 650.0];
/// Fraction of the screen's colours in the tint inside the locus; the rest is white.
const TINT: f64 = 0.30;

/// Draws the spectral locus, with a tint inside and wavelengths outside.
pub(crate) fn draw(svg: &mut Svg, panel: &Panel) {
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
        // Half a px larger than the cell, to avoid visible seams.
        let size = (high.0 - low.0 + 0.5, low.1 - high.1 + 0.5);
        svg.rect((low.0, high.1), size, 0.0, &hex(linear.map(|c| channel(c).round() as u8)), "");
    }
}
