//! The endpoint `/pixel`: the reflectance of the pixel alone, and the absorptance of its layers, as by `papilio pixel`.

use std::collections::BTreeMap;

use papilio_display::pixel::{absorption, scan_at, state_names};
use papilio_display::scene::{AngleMedium, Pixel, Scene};
use papilio_figures::{PixelScan as Drawing, pixel_scan};
use papilio_formats::{PixelTable, write_absorption, write_sub_pixels};
use papilio_scenario::Resolved;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::detail::Table;
use super::drawn::Figure;
use super::written::text;
use crate::fault::Fault;
use crate::reading::{Given, Solver};
use crate::site::Site;

/// Steps of the angles of the absorptance, degrees.
const ABSORPTION_STEPS: usize = 6;

/// Maximum of angles x states x wavelengths, and of the rows of absorption.csv.
const MOST_NUMBERS: usize = 1_000_000;

/// A request for the reflectance of the pixel alone.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct PixelOf {
    /// The scenario: TOML.
    scenario: String,
    /// Ids of uploaded files by their names in the scenario.
    #[serde(default)]
    files: BTreeMap<String, String>,
    /// Number of steps from 0 to 90 degrees.
    #[serde(default = "ninety")]
    steps: usize,
    /// Azimuth from which the pixel is seen, degrees.
    #[serde(default)]
    phi_deg: f64,
    /// Medium of the angles; null: that of the scenario.
    angles: Option<AnglesIn>,
    /// Whether the absorptance of each layer is computed.
    #[serde(default)]
    absorption: bool,
}

fn ninety() -> usize {
    90
}

/// Medium of the angles.
#[derive(Debug, Clone, Copy, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(super) enum AnglesIn {
    /// Air.
    Air,
    /// The glass above the pixel.
    Glass,
}

/// The reflectance of the pixel alone.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct PixelScanned {
    /// Medium of the angles: `air` or `glass`.
    angles: &'static str,
    /// The tables that the command writes.
    tables: Vec<Table>,
    /// The figures that it draws.
    figures: Vec<Figure>,
    /// Its warnings.
    warnings: Vec<String>,
    /// Its notes.
    notes: Vec<String>,
}

pub(super) async fn pixel(site: Site, request: PixelOf) -> Result<PixelScanned, Fault> {
    let server = site.clone();
    site.long()
        .work(move |_| {
            let PixelOf { scenario, files, steps, phi_deg, angles, absorption } = request;
            let given = Given { scenario, files };
            let resolved = given.scenario(&server, Solver::Adding)?.resolve_without_light()?;
            let mut scene = resolved.scene.clone();
            match angles {
                None => {}
                Some(AnglesIn::Air) => scene.solver.angle_medium = AngleMedium::Air,
                Some(AnglesIn::Glass) => scene.solver.angle_medium = AngleMedium::Glass,
            }
            scanned(&resolved, &scene, steps, phi_deg, absorption)
        })
        .await
}

/// Returns the angles from 0 to 90 degrees in equal steps.
fn angles(steps: usize) -> Vec<f64> {
    (0..=steps).map(|k| 90.0 * k as f64 / steps as f64).collect()
}

/// Refuses what is too large for the page.
fn check(numbers: usize) -> Result<(), Fault> {
    if numbers <= MOST_NUMBERS {
        return Ok(());
    }
    let message = format!("{numbers} numbers are too many for the page: at most {MOST_NUMBERS}");
    Err(Fault::too_much(
        message,
        "choose fewer angles or states or a larger spectrum.step_nm, or use `papilio pixel`",
    ))
}

fn scanned(
    resolved: &Resolved,
    scene: &Scene,
    steps: usize,
    phi_deg: f64,
    is_absorption: bool,
) -> Result<PixelScanned, Fault> {
    let fault = |error| Fault::of(resolved, error);
    let is_finite = phi_deg.is_finite() && (1..=900).contains(&steps);
    if !is_finite {
        return Err(Fault::malformed("`steps` must be 1 to 900, and `phi_deg` a number"));
    }
    check((steps + 1) * state_names(&scene.display.pixel).len() * scene.grid.len())?;
    let medium = if scene.solver.angle_medium == AngleMedium::Air { "air" } else { "glass" };
    let title = resolved.title.as_deref().unwrap_or_default();
    let scan = scan_at(scene, &angles(steps), &[phi_deg]).map_err(fault)?;
    let states: Vec<String> = scan.states.iter().map(|(name, _)| name.clone()).collect();
    let reflectance: Vec<f64> = scan.states.iter().flat_map(|(_, values)| values.iter().copied()).collect();
    let drawing = Drawing {
        states: &states,
        medium,
        theta_deg: &scan.theta_deg,
        wavelength_nm: &scan.wavelength_nm,
        reflectance: &reflectance,
    };
    let mut figures = vec![Figure { name: "pixel".to_owned(), svg: pixel_scan(&drawing, title) }];
    let table = PixelTable {
        theta_deg: scan.theta_deg.clone(),
        phi_deg: scan.phi_deg,
        wavelength_nm: scan.wavelength_nm.clone(),
        states: scan.states,
    };
    let mut tables = vec![Table { name: "pixel", csv: text(|out| table.write(out))? }];
    if is_absorption {
        if let Pixel::Film(film) = &scene.display.pixel {
            let parts = film.states.len() * film.sub_pixels.len() * (film.layers.len() + 1);
            check((ABSORPTION_STEPS + 1) * parts * scene.grid.len())?;
        }
        let absorbed = absorption(scene, &angles(ABSORPTION_STEPS)).map_err(fault)?;
        tables.push(Table { name: "absorption", csv: text(|out| write_absorption(out, &absorbed))? });
        tables.push(Table { name: "sub-pixels", csv: text(|out| write_sub_pixels(out, &absorbed))? });
        let svg = papilio_figures::absorption(&absorbed, medium, title);
        figures.push(Figure { name: "absorption".to_owned(), svg });
    }
    let (warnings, notes) = (resolved.warnings.clone(), resolved.notes.clone());
    Ok(PixelScanned { angles: medium, tables, figures, warnings, notes })
}
