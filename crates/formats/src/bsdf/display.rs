//! Writer of the display's BSDF, `display-bsdf.npz`, format "papilio-bsdf 1": NumPy arrays in a zip archive. With azimuths of the light,
//! for a display that depends on azimuth, it is "papilio-bsdf 2".
//!
//! `docs/brdf.md` describes the format.

use std::io::{self, Write};

use papilio_display::BrdfTable;
use serde::Serialize;
use zip::write::ZipWriter;

use crate::npy::{Items, stored, write_npy};

/// Origin of a BSDF.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BsdfSource<'a> {
    /// Version of the program.
    pub papilio: &'a str,
    /// Title of the scenario.
    pub title: &'a str,
    /// SHA-256 of the scenario and the bytes of its files.
    pub hash: &'a str,
}

/// Content of the array `about`, as JSON.
#[derive(Serialize)]
struct About<'a> {
    format: &'a str,
    version: u32,
    papilio: &'a str,
    title: &'a str,
    hash: &'a str,
    conventions: Conventions,
    solver: Solver,
}

#[derive(Serialize)]
struct Conventions {
    brdf: &'static str,
    specular: &'static str,
    directional_hemispherical: &'static str,
    directions: &'static str,
    medium: &'static str,
    transmission: &'static str,
    polarisation: &'static str,
}

const CONVENTIONS: Conventions = Conventions {
    brdf: "dL_o/dE_i in 1/sr of the scattered light, per wavelength, without a cosine; axes state, theta_i, theta_o, dphi, wavelength",
    specular: "fraction of a beam that leaves in the mirror direction (theta_o = theta_i, dphi = 180); axes state, theta_i, wavelength",
    directional_hemispherical: "fraction of a beam that leaves, scattered and mirrored; axes state, theta_i, wavelength",
    directions: "theta_i (light) and theta_o (viewer) from the normal, both pointing away from the display; dphi = phi_o - phi_i, the same values for -dphi; degrees",
    medium: "air (index 1) on the side of light and viewer",
    transmission: "none: the display is opaque",
    polarisation: "unpolarised",
};

/// The same with azimuths of the light.
const CONVENTIONS_BY_AZIMUTH: Conventions = Conventions {
    brdf: "dL_o/dE_i in 1/sr of the scattered light, per wavelength, without a cosine; axes state, theta_i, phi_i, theta_o, dphi, wavelength",
    specular: "fraction of a beam that leaves in the mirror direction (theta_o = theta_i, dphi = 180); axes state, theta_i, phi_i, wavelength",
    directional_hemispherical: "fraction of a beam that leaves, scattered and mirrored; axes state, theta_i, phi_i, wavelength",
    directions: "theta_i (light) and theta_o (viewer) from the normal, both pointing away from the display; phi_i counter-clockwise from x as seen \
                 by the viewer, the same values for phi_i + 180; dphi = phi_o - phi_i, over a whole turn; degrees",
    ..CONVENTIONS
};

#[derive(Serialize)]
struct Solver {
    method: &'static str,
    nodes: u64,
    discretisation_error: f64,
}

/// Writes `display-bsdf.npz`.
///
/// # Errors
/// Those of `out`, and if the lengths of the table's arrays do not match its grid.
pub fn write_bsdf(out: impl Write, source: &BsdfSource<'_>, table: &BrdfTable) -> io::Result<()> {
    let mut archive = ZipWriter::new_stream(out);
    let mut array = |name: &str, shape: &[usize], items: Items<'_>| {
        // Not compressed and without a date: equal tables give equal bytes.
        archive.start_file(format!("{name}.npy"), stored())?;
        write_npy(&mut archive, shape, items)
    };
    let grid = &table.grid;
    let axes = [
        ("theta_i_deg", &grid.theta_i_deg),
        ("phi_i_deg", &grid.phi_i_deg),
        ("theta_o_deg", &grid.theta_o_deg),
        ("dphi_deg", &grid.dphi_deg),
        ("wavelength_nm", &table.wavelength_nm),
    ];
    let is_isotropic = grid.phi_i_deg.is_empty();
    let axes: Vec<_> = axes.into_iter().filter(|(name, _)| !(is_isotropic && *name == "phi_i_deg")).collect();
    for (name, values) in &axes {
        array(name, &[values.len()], Items::Double(values))?;
    }
    let lengths: Vec<usize> = axes.iter().map(|(_, values)| values.len()).collect();
    let (of_pairs, of_light) = (&lengths[..lengths.len() - 1], &lengths[..lengths.len() - 3]);
    let bins = table.wavelength_nm.len();
    let states = table.states.len();
    let names: Vec<&str> = table.states.iter().map(|state| state.name.as_str()).collect();
    array("state", &[states], Items::Text(&names))?;
    let brdf: Vec<&[f32]> = table.states.iter().map(|state| state.brdf.as_slice()).collect();
    array("brdf", &[&[states], &lengths[..]].concat(), Items::Single(&brdf))?;
    let shape = [&[states], of_light, &[bins]].concat();
    let specular: Vec<f64> = table.states.iter().flat_map(|state| state.specular.iter().copied()).collect();
    array("specular", &shape, Items::Double(&specular))?;
    let leaving = table.states.iter().flat_map(|state| state.directional_hemispherical.iter().copied());
    array("directional_hemispherical", &shape, Items::Double(&leaving.collect::<Vec<f64>>()))?;
    if table.row_errors.allowed.is_some() {
        array("error", &[&[states], of_pairs].concat(), Items::Double(&table.row_errors.relative))?;
    }
    array("about", &[], Items::Text(&[&about(source, table)?]))?;
    archive.finish()?.into_inner().flush()
}

fn about(source: &BsdfSource<'_>, table: &BrdfTable) -> io::Result<String> {
    let (nodes, discretisation_error) = (table.nodes, table.discretisation_error);
    let is_isotropic = table.grid.phi_i_deg.is_empty();
    let about = About {
        format: "papilio-bsdf",
        version: if is_isotropic { 1 } else { 2 },
        papilio: source.papilio,
        title: source.title,
        hash: source.hash,
        conventions: if is_isotropic { CONVENTIONS } else { CONVENTIONS_BY_AZIMUTH },
        solver: Solver { method: "adding", nodes, discretisation_error },
    };
    Ok(serde_json::to_string(&about)?)
}
