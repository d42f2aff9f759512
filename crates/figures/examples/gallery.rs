//! Writes all figures of a synthetic run into a folder, as SVG and PNG, for visual inspection:
//! `cargo run -p papilio-figures --example gallery -- DIR`.

use std::path::PathBuf;

use papilio_display::ConeGrid;
use papilio_figures::{
    AngleMetric, Diagram, PixelScan, against_angle, chromaticity, cone, overview, patches, pixel_scan, png,
    spectra,
};

#[path = "../tests/synthetic/mod.rs"]
#[allow(clippy::unwrap_used, reason = "the synthetic data are complete")]
mod synthetic;

const TITLE: &str = "Synthetic display";

fn main() -> std::io::Result<()> {
    let dir = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| ".".to_owned()));
    std::fs::create_dir_all(&dir)?;
    let write = |name: &str, svg: String| {
        std::fs::write(dir.join(format!("{name}.svg")), &svg)?;
        std::fs::write(dir.join(format!("{name}.png")), png(&svg, 2.0).map_err(std::io::Error::other)?.value)
    };
    for (suffix, error) in [("", 0.001), ("_noisy", 0.08)] {
        let run = synthetic::result(&[8.0, 0.0, 15.0, 30.0, 45.0, 60.0], error);
        for view in run.views.iter().take(1) {
            write(&format!("spectra{suffix}"), spectra(&run, view, TITLE))?;
            write(&format!("chromaticity{suffix}"), chromaticity(&run, view, Diagram::Uv, TITLE))?;
            write(&format!("patches{suffix}"), patches(&run, view, TITLE))?;
            write(&format!("overview{suffix}"), overview(&run, view, TITLE))?;
        }
        for metric in AngleMetric::ALL {
            if let Some(svg) = against_angle(&run, metric, TITLE) {
                write(&format!("{}{suffix}", metric.name()), svg)?;
            }
        }
    }
    let ConeGrid { theta_deg, phi_deg, .. } = ConeGrid::default();
    if let Some(svg) = cone(&synthetic::cone(&theta_deg, &phi_deg), TITLE) {
        write("cone", svg)?;
    }
    write("pixel_scan", scan())
}

/// A scan of three states from 0 to 90 degrees.
fn scan() -> String {
    let theta_deg: Vec<f64> = (0..=90).map(f64::from).collect();
    let run = synthetic::result(&theta_deg, 0.0);
    let states = ["red", "green", "blue"].map(str::to_owned);
    let spectra =
        states.iter().flat_map(|name| run.views.iter().filter_map(move |view| view.states.get(name)));
    let reflectance: Vec<f64> =
        spectra.flat_map(|state| state.value.reflectance_factor.clone().unwrap_or_default()).collect();
    let (theta_deg, wavelength_nm) = (&theta_deg, &run.wavelength_nm);
    let scan =
        PixelScan { states: &states, medium: "air", theta_deg, wavelength_nm, reflectance: &reflectance };
    pixel_scan(&scan, TITLE)
}
