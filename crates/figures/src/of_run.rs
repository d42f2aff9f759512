//! The figures of a run and their file names.

use papilio_display::result::{RunResult, View};
use papilio_display::{AmbientLight, ConeResult};

use crate::{
    AngleMetric, Diagram, against_angle, chromaticity, cone, cone_differences, gamut_rings, light, overview,
    patches, spectra,
};

/// Largest number of views that all have figures. With more views, only the view closest to the normal has
/// them, and metrics are drawn against the angle.
const VIEWS_WITH_FIGURES: usize = 6;

/// Returns the figures of `papilio run`: file names without extensions, and SVG texts.
pub fn of_run(result: &RunResult, title: &str) -> Vec<(String, String)> {
    let mut figures = Vec::new();
    let shown =
        if result.views.len() > VIEWS_WITH_FIGURES { nearest_to_normal(result) } else { &result.views };
    for view in shown {
        let at = if result.views.len() == 1 { String::new() } else { suffix(view) };
        figures.push((format!("overview{at}"), overview(result, view, title)));
        figures.push((format!("spectra{at}"), spectra(result, view, title)));
        figures.push((format!("chromaticity{at}"), chromaticity(result, view, Diagram::Uv, title)));
        figures.push((format!("chromaticity_xy{at}"), chromaticity(result, view, Diagram::Xy, title)));
        let rings = gamut_rings(result, view, title);
        figures.extend(rings.map(|svg| (format!("rings{at}"), svg)));
        figures.push((format!("patches{at}"), patches(result, view, title)));
    }
    if several_angles(result) {
        for metric in AngleMetric::ALL {
            let name = format!("{}_against_angle", metric.name());
            figures.extend(against_angle(result, metric, title).map(|svg| (name, svg)));
        }
    }
    figures
}

/// Returns the figures of [`of_run`], of the light by direction and of the maps over all viewing directions.
pub fn of_run_with_maps(
    result: &RunResult,
    by_direction: Option<&AmbientLight>,
    maps: Option<&ConeResult>,
    title: &str,
) -> Vec<(String, String)> {
    let named = |name: &str, svg: String| (name.to_owned(), svg);
    let mut figures = of_run(result, title);
    figures.extend(by_direction.map(|by_direction| named("light", light(by_direction, title))));
    if let Some(maps) = maps {
        figures.extend(cone(maps, title).map(|svg| named("cone", svg)));
        figures.extend(cone_differences(maps, title).map(|svg| named("cone_differences", svg)));
    }
    figures
}

/// Returns the first view of smallest inclination.
fn nearest_to_normal(result: &RunResult) -> &[View] {
    let inclination = |view: &View| view.theta_deg.abs();
    let least = result.views.iter().map(inclination).fold(f64::INFINITY, f64::min);
    let first = result.views.iter().position(|view| inclination(view) == least);
    first.map_or(&[], |at| &result.views[at..=at])
}

fn several_angles(result: &RunResult) -> bool {
    result.views.iter().any(|view| view.theta_deg != result.views[0].theta_deg)
}

fn suffix(view: &View) -> String {
    papilio_display::view_in_name(view.theta_deg, view.phi_deg)
}
