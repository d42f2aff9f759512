//! Simulated and measured spectra with a small panel for each state, for states whose bands overlap.

use papilio_display::compare::{Comparison, SpectrumComparison, ViewComparison};

use crate::axis::Axis;
use crate::comparison::{MEASURED, caption, legend_entries, sides, states_of};
use crate::overlay::legend;
use crate::panel::{Panel, SMALL};
use crate::style::INK;
use crate::svg::{Stroke, Svg, Text};

/// Colour of simulated spectra.
const SIMULATED: &str = "#2b5fc7";
/// Panels in a row, the size of one, the space around it, and the place of the first, px.
const COLUMNS: usize = 3;
const SIZE: (f64, f64) = (210.0, 140.0);
const GAP: (f64, f64) = (38.0, 46.0);
const ORIGIN: (f64, f64) = (70.0, 52.0);

/// Draws the simulated and measured reflectance factors of a viewing direction, a panel for each state. Returns `None` if no
/// spectrum was measured there.
pub fn compared_panels(all: &Comparison, view: &ViewComparison, title: &str) -> Option<String> {
    let spectra: Vec<(&str, &SpectrumComparison)> = states_of(all, view)
        .iter()
        .filter_map(|one| Some((one.state.as_str(), one.spectrum.as_ref()?)))
        .collect();
    if spectra.is_empty() {
        return None;
    }
    let rows = spectra.len().div_ceil(COLUMNS);
    let columns = spectra.len().min(COLUMNS);
    let width = ORIGIN.0 + columns as f64 * (SIZE.0 + GAP.0);
    let height = ORIGIN.1 + rows as f64 * (SIZE.1 + GAP.1) + 14.0;
    let mut svg = Svg::new(width.max(460.0), height).titled(&caption(title, view));
    legend(&mut svg, legend_entries().map(|(name, stroke)| (name, of(name, stroke.width))));
    let y =
        Axis::covering(spectra.iter().flat_map(|(_, one)| sides(one)).chain([0.0]), 4, "Reflectance factor");
    let nm = || spectra.iter().flat_map(|(_, one)| one.wavelength_nm.iter().copied());
    let ends = [nm().fold(f64::INFINITY, f64::min), nm().fold(f64::NEG_INFINITY, f64::max)];
    let x = Axis::between(&ends, 4, "Wavelength (nm)");
    for (number, (name, one)) in spectra.iter().enumerate() {
        let (row, column) = (number / COLUMNS, number % COLUMNS);
        let panel = Panel {
            origin: (ORIGIN.0 + column as f64 * (SIZE.0 + GAP.0), ORIGIN.1 + row as f64 * (SIZE.1 + GAP.1)),
            size: SIZE,
            x: if number + COLUMNS < spectra.len() { x.clone().untitled() } else { x.clone() },
            y: if column == 0 { y.clone() } else { y.clone().untitled() },
        };
        panel.draw(&mut svg);
        svg.text((panel.origin.0, panel.origin.1 - 6.0), name, Text::new(SMALL, INK).strong());
        for (side, values, deviations) in [
            ("measured", &one.measured, &one.measured_deviation),
            ("simulated", &one.simulated, &one.simulated_deviation),
        ] {
            let stroke = of(side, 1.6);
            let band: Vec<f64> = deviations.iter().map(|deviation| 2.0 * deviation).collect();
            panel.error_band(&mut svg, &one.wavelength_nm, values, &band, &stroke);
            svg.polyline(&panel.points(&one.wavelength_nm, values), &stroke);
        }
    }
    Some(svg.finish())
}

/// The line of a side.
fn of(side: &str, width: f64) -> Stroke {
    if side == "measured" {
        Stroke::solid(INK, width).dashed(MEASURED)
    } else {
        Stroke::solid(SIMULATED, width)
    }
}
