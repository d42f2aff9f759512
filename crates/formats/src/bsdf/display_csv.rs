//! Writers of the display's BSDF as tables: `display-STATE.csv`, `display-mirror.csv`; and of its mirror part
//! as JSON, `display-mirror.json`.
//!
//! `docs/brdf.md` describes the columns and fields.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::{self, Write};

use papilio_display::{BrdfState, BrdfTable};
use serde::Serialize;

use super::display::BsdfSource;

/// Writes the scattered part of one state, number `state`, with one row for each pair of directions and
/// wavelength.
///
/// # Errors
/// Those of `out`, and if the lengths of the table's arrays do not match its grid.
pub fn write_bsdf_csv(mut out: impl Write, table: &BrdfTable, state: usize) -> io::Result<()> {
    let (grid, bins) = (&table.grid, table.wavelength_nm.len());
    let found = table.states.get(state).filter(|found| found.brdf.len() == grid.pairs() * bins);
    let errors = table.row_errors.relative.chunks(grid.pairs().max(1)).nth(state);
    let (Some(found), Some(errors)) = (found, errors.filter(|errors| errors.len() == grid.pairs())) else {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "the BSDF does not match its directions"));
    };
    let is_isotropic = grid.phi_i_deg.is_empty();
    let azimuth = if is_isotropic { "" } else { ",phi_i_deg" };
    writeln!(out, "theta_i_deg{azimuth},theta_o_deg,dphi_deg,wavelength_nm,brdf,error")?;
    let mut rows = found.brdf.chunks_exact(bins.max(1)).zip(errors);
    for [theta_i, phi_i] in grid.lights_deg() {
        let light = if is_isotropic { theta_i.to_string() } else { format!("{theta_i},{phi_i}") };
        for theta_o in &grid.theta_o_deg {
            for dphi in &grid.dphi_deg {
                let Some((spectrum, error)) = rows.next() else { continue };
                for (nm, f) in table.wavelength_nm.iter().zip(spectrum) {
                    writeln!(out, "{light},{theta_o},{dphi},{nm},{f},{error:.2e}")?;
                }
            }
        }
    }
    out.flush()
}

/// Writes the mirror part and the directional-hemispherical reflectance of all states.
///
/// # Errors
/// Those of `out`.
pub fn write_mirror_csv(out: impl Write, table: &BrdfTable) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(out);
    let is_isotropic = table.grid.phi_i_deg.is_empty();
    let titles =
        ["state", "theta_i_deg", "phi_i_deg", "wavelength_nm", "specular", "directional_hemispherical"];
    csv.write_record(titles.into_iter().filter(|title| !(is_isotropic && *title == "phi_i_deg")))?;
    for state in &table.states {
        let mut values = state.specular.iter().zip(&state.directional_hemispherical);
        for [theta, phi] in table.grid.lights_deg() {
            let azimuth = (!is_isotropic).then_some(phi);
            for nm in &table.wavelength_nm {
                let Some((specular, leaving)) = values.next() else { continue };
                let numbers = [Some(theta), azimuth, Some(*nm), Some(*specular), Some(*leaving)];
                let cells = numbers.into_iter().flatten().map(|number| number.to_string());
                csv.write_record(std::iter::once(state.name.clone()).chain(cells))?;
            }
        }
    }
    csv.flush()
}

const MIRROR: &str = "specular: fraction of a beam that leaves in the mirror direction; directional_hemispherical: fraction that \
                          leaves in any direction, scattered and mirrored; both [theta_i][wavelength]; directions in air; unpolarised";

const MIRROR_BY_AZIMUTH: &str = "specular: fraction of a beam that leaves in the mirror direction; directional_hemispherical: fraction that leaves in any \
     direction, scattered and mirrored; both [theta_i][wavelength], means over the azimuth of the light; specular_by_azimuth, \
     directional_hemispherical_by_azimuth: [theta_i][phi_i][wavelength]; directions in air; unpolarised";

/// Content of `display-mirror.json`, for [`write_json`](crate::write_json).
#[derive(Debug, Serialize)]
pub struct MirrorFile<'a> {
    format: &'static str,
    version: u32,
    papilio: &'a str,
    title: &'a str,
    hash: &'a str,
    notes: &'a [String],
    warnings: &'a [String],
    conventions: &'static str,
    theta_i_deg: &'a [f64],
    /// Azimuths of the light, where the display depends on them.
    #[serde(skip_serializing_if = "<[f64]>::is_empty")]
    phi_i_deg: &'a [f64],
    wavelength_nm: &'a [f64],
    states: BTreeMap<&'a str, MirrorOfState<'a>>,
}

/// Mirror part of a state.
#[derive(Debug, Serialize)]
struct MirrorOfState<'a> {
    /// Name of the file with the scattered part.
    file: &'a str,
    specular: Vec<Cow<'a, [f64]>>,
    directional_hemispherical: Vec<Cow<'a, [f64]>>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    specular_by_azimuth: Vec<Vec<&'a [f64]>>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    directional_hemispherical_by_azimuth: Vec<Vec<&'a [f64]>>,
}

/// Spectra by inclination and azimuth of the light.
fn by_azimuth(values: &[f64], azimuths: usize, bins: usize) -> Vec<Vec<&[f64]>> {
    values.chunks((azimuths * bins).max(1)).map(|light| light.chunks(bins).collect()).collect()
}

/// Spectra by inclination of the light: their mean over its azimuths, whose last, half a turn from the first, is the same.
fn by_inclination<'a>(values: &'a [f64], phi_i_deg: &[f64], bins: usize) -> Vec<Cow<'a, [f64]>> {
    if phi_i_deg.is_empty() {
        return values.chunks(bins).map(Cow::Borrowed).collect();
    }
    let ends = phi_i_deg.last().zip(phi_i_deg.first()).map_or(0.0, |(last, first)| last - first);
    let count = phi_i_deg.len() - usize::from(ends >= 180.0 - 1e-9 && phi_i_deg.len() > 1);
    let mean = |light: &[&[f64]]| {
        let of = |bin: usize| light.iter().take(count).map(|row| row[bin]).sum::<f64>() / count as f64;
        Cow::Owned((0..bins).map(of).collect())
    };
    by_azimuth(values, phi_i_deg.len(), bins).iter().map(|light| mean(light)).collect()
}

impl<'a> MirrorFile<'a> {
    /// Mirror part of a table whose states have files of these names, with the notes and warnings on it.
    pub fn new(
        source: &BsdfSource<'a>,
        [notes, warnings]: [&'a [String]; 2],
        table: &'a BrdfTable,
        files: &'a [String],
    ) -> Self {
        let bins = table.wavelength_nm.len().max(1);
        let phi_i_deg = &table.grid.phi_i_deg[..];
        let each = |values: &'a [f64]| match phi_i_deg {
            [] => Vec::new(),
            azimuths => by_azimuth(values, azimuths.len(), bins),
        };
        let of_state = |(state, file): (&'a BrdfState, &'a String)| {
            let found = MirrorOfState {
                file,
                specular: by_inclination(&state.specular, phi_i_deg, bins),
                directional_hemispherical: by_inclination(&state.directional_hemispherical, phi_i_deg, bins),
                specular_by_azimuth: each(&state.specular),
                directional_hemispherical_by_azimuth: each(&state.directional_hemispherical),
            };
            (state.name.as_str(), found)
        };
        Self {
            format: "papilio-mirror",
            version: 1,
            papilio: source.papilio,
            title: source.title,
            hash: source.hash,
            notes,
            warnings,
            conventions: if phi_i_deg.is_empty() { MIRROR } else { MIRROR_BY_AZIMUTH },
            theta_i_deg: &table.grid.theta_i_deg,
            phi_i_deg,
            wavelength_nm: &table.wavelength_nm,
            states: table.states.iter().zip(files).map(of_state).collect(),
        }
    }
}
