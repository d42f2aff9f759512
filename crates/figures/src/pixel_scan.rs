//! Pixel reflectance against wavelength at several angles, as in Feng 2012, fig. 3.13.

use crate::axis::Axis;
use crate::panel::{Panel, SMALL};
use crate::style::{INK, degrees, ramp};
use crate::svg::{Anchor, Stroke, Svg, Text};

/// Curves in a panel, at most.
const CURVES: usize = 7;
/// Panels in a row, at most.
const COLUMNS: usize = 3;

/// An angle scan of a pixel: the contents of `pixel.csv`.
#[derive(Debug, Clone, Copy)]
pub struct PixelScan<'a> {
    /// Names of the drive states; each has its own panel.
    pub states: &'a [String],
    /// Medium of the angles: `air` or `glass`.
    pub medium: &'a str,
    /// Inclinations in that medium, degrees.
    pub theta_deg: &'a [f64],
    /// Wavelengths, nm.
    pub wavelength_nm: &'a [f64],
    /// Reflectance by state, angle and wavelength, wavelength fastest; missing values are not drawn.
    pub reflectance: &'a [f64],
}

impl PixelScan<'_> {
    /// Returns the spectrum of a state at an angle; empty if it is missing.
    fn spectrum(&self, state: usize, angle: usize) -> &[f64] {
        let len = self.wavelength_nm.len();
        let start = (state * self.theta_deg.len() + angle) * len;
        self.reflectance.get(start..start + len).unwrap_or(&[])
    }
}

/// Draws a panel for each state with a curve for each of up to seven angles, dark (small) to light (large).
pub fn pixel_scan(scan: &PixelScan<'_>, title: &str) -> String {
    let count = scan.states.len().max(1);
    let (columns, rows) = (count.min(COLUMNS), count.div_ceil(COLUMNS));
    let (cell, legend) = ((318.0, 330.0), 84.0);
    let size = (70.0 + cell.0 * columns as f64 + legend, 20.0 + cell.1 * rows as f64);
    let mut svg = Svg::new(size.0, size.1).titled(title);
    let angles = chosen(scan.theta_deg.len());
    let drawn = (0..scan.states.len()).flat_map(|s| angles.iter().map(move |&a| (s, a)));
    let values = drawn.flat_map(|(s, a)| scan.spectrum(s, a).iter().copied());
    let y = Axis::covering(values.chain([0.0]), 6, "Reflectance");
    for (i, name) in scan.states.iter().enumerate() {
        let (column, row) = ((i % COLUMNS) as f64, (i / COLUMNS) as f64);
        let x = Axis::between(scan.wavelength_nm, 5, "Wavelength (nm)");
        let origin = (70.0 + cell.0 * column, 40.0 + cell.1 * row);
        // All panels have the same scale, so that only the first of each row has a title.
        let y = if column == 0.0 { y.clone() } else { y.clone().untitled() };
        let panel = Panel { origin, size: (cell.0 - 66.0, cell.1 - 86.0), x, y };
        panel.draw(&mut svg);
        svg.text((origin.0, origin.1 - 12.0), name, Text::new(13.0, INK).strong());
        for (k, &angle) in angles.iter().enumerate() {
            let points = panel.points(scan.wavelength_nm, scan.spectrum(i, angle));
            svg.polyline(&points, &Stroke::solid(&colour(k, angles.len()), 1.8));
        }
    }
    draw_legend(&mut svg, scan, &angles, 70.0 + cell.0 * columns as f64 - 36.0);
    svg.finish()
}

fn draw_legend(svg: &mut Svg, scan: &PixelScan<'_>, angles: &[usize], left: f64) {
    svg.text((left, 52.0), &format!("Angle in {}", scan.medium), Text::new(SMALL, INK).strong());
    for (k, &angle) in angles.iter().enumerate() {
        let y = 74.0 + 19.0 * k as f64;
        svg.line((left, y - 4.0), (left + 22.0, y - 4.0), &Stroke::solid(&colour(k, angles.len()), 2.4));
        let theta = scan.theta_deg.get(angle).copied().unwrap_or(f64::NAN);
        svg.text((left + 58.0, y), &degrees(theta), Text::new(SMALL, INK).anchor(Anchor::End));
    }
}

fn colour(k: usize, count: usize) -> String {
    ramp(k as f64 / (count.max(2) - 1) as f64)
}

/// Returns uniformly spaced indices below `len`, including the first and the last.
fn chosen(len: usize) -> Vec<usize> {
    let count = len.min(CURVES);
    (0..count).map(|k| (k * (len - 1) + (count.max(2) - 1) / 2) / (count.max(2) - 1)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chosen_angles_include_first_and_last() {
        assert_eq!(chosen(0), Vec::<usize>::new());
        assert_eq!(chosen(1), [0]);
        assert_eq!(chosen(3), [0, 1, 2]);
        assert_eq!(chosen(91), [0, 15, 30, 45, 60, 75, 90]);
    }
}
