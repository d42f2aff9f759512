//! Writers of the display's BSDF as tables: `display-STATE.csv`, `display-mirror.csv`; and of its mirror part
//! as JSON, `display-mirror.json`.
//!
//! `docs/brdf.md` describes the columns and fields.

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
    writeln!(out, "theta_i_deg,theta_o_deg,dphi_deg,wavelength_nm,brdf,error")?;
    let mut rows = found.brdf.chunks_exact(bins.max(1)).zip(errors);
    for theta_i in &grid.theta_i_deg {
        for theta_o in &grid.theta_o_deg {
            for dphi in &grid.dphi_deg {
                let Some((spectrum, error)) = rows.next() else { continue };
                for (nm, f) in table.wavelength_nm.iter().zip(spectrum) {
                    writeln!(out, "{theta_i},{theta_o},{dphi},{nm},{f},{error:.2e}")?;
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
    csv.write_record(["state", "theta_i_deg", "wavelength_nm", "specular", "directional_hemispherical"])?;
    for state in &table.states {
        let mut values = state.specular.iter().zip(&state.directional_hemispherical);
        for theta in &table.grid.theta_i_deg {
            for nm in &table.wavelength_nm {
                let Some((specular, leaving)) = values.next() else { continue };
                let numbers = [theta, nm, specular, leaving].map(f64::to_string);
                csv.write_record(std::iter::once(state.name.clone()).chain(numbers))?;
            }
        }
    }
    csv.flush()
}

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
    wavelength_nm: &'a [f64],
    states: BTreeMap<&'a str, MirrorOfState<'a>>,
}

/// Mirror part of a state.
#[derive(Debug, Serialize)]
struct MirrorOfState<'a> {
    /// Name of the file with the scattered part.
    file: &'a str,
    specular: Vec<&'a [f64]>,
    directional_hemispherical: Vec<&'a [f64]>,
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
        let of_state = |(state, file): (&'a BrdfState, &'a String)| {
            let found = MirrorOfState {
                file,
                specular: state.specular.chunks(bins).collect(),
                directional_hemispherical: state.directional_hemispherical.chunks(bins).collect(),
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
            conventions: "specular: fraction of a beam that leaves in the mirror direction; directional_hemispherical: fraction that \
                          leaves in any direction, scattered and mirrored; both [theta_i][wavelength]; directions in air; unpolarised",
            theta_i_deg: &table.grid.theta_i_deg,
            wavelength_nm: &table.wavelength_nm,
            states: table.states.iter().zip(files).map(of_state).collect(),
        }
    }
}
