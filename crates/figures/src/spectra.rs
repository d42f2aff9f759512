//! Reflectance factor of every state against wavelength, or radiance if the front light is the only light.

use papilio_display::result::{RunResult, StateValues, View};

use crate::axis::Axis;
use crate::labels::{EndLabel, end_labels};
use crate::panel::Panel;
use crate::style::{caption, is_self_lit, state_stroke};
use crate::svg::{Point, Svg};

/// Title of the axis of radiances.
const RADIANCE: &str = "Radiance (mW/(m\u{b2} sr nm))";

/// Draws the reflectance factors of all states of a view (or the radiances if there are none), with a band of
/// one standard error where it is wider than a line.
pub fn spectra(result: &RunResult, view: &View, title: &str) -> String {
    let mut svg = Svg::new(760.0, 440.0).titled(&caption(title, view));
    draw(&mut svg, result, view, (70.0, 24.0), (540.0, 350.0));
    svg.finish()
}

/// Draws the spectra in a rectangle of a page; labels need 150 px to its right.
pub(crate) fn draw(svg: &mut Svg, result: &RunResult, view: &View, origin: Point, size: Point) {
    let nm = &result.wavelength_nm;
    let all = view.states.iter().flat_map(|(_, state)| in_axis_unit(&state.value));
    let title = if is_self_lit(view) { RADIANCE } else { "Reflectance factor" };
    let x = Axis::between(nm, 8, "Wavelength (nm)");
    let panel = Panel { origin, size, x, y: Axis::covering(all.chain([0.0]), 6, title) };
    panel.draw(svg);
    let (mut labels, mut banded) = (vec![], false);
    for (i, (name, state)) in view.states.iter().enumerate() {
        let (stroke, values) = (state_stroke(name, i), in_axis_unit(&state.value));
        banded |= panel.error_band(svg, nm, &values, &in_axis_unit(&state.standard_error), &stroke);
        let points = panel.points(nm, &values);
        svg.polyline(&points, &stroke);
        if let Some(&end) = points.iter().rev().find(|point| point.1.is_finite()) {
            labels.push(EndLabel { end, text: name.to_owned(), stroke, marks: false });
        }
    }
    if banded {
        panel.note(svg, "bands: \u{b1} one standard error");
    }
    end_labels(svg, &panel, labels);
}

/// Returns the spectrum of a state in the unit of the axis.
fn in_axis_unit(values: &StateValues) -> Vec<f64> {
    match &values.reflectance_factor {
        Some(factor) => factor.clone(),
        None => values.radiance.iter().map(|radiance| 1e3 * radiance).collect(),
    }
}
