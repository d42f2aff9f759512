//! Measured panels: spectra or colours of each state from each direction.
//!
//! The first row holds the names of the columns, in any order: `state`, `theta_deg`, optionally `phi_deg`, and either
//! `wavelength_nm` and `reflectance_factor`, with one row per wavelength, or `X`, `Y` and `Z`, with one row per state
//! and direction, relative to a perfect white (Y = 1). Other columns are ignored, so that `spectra.csv` and
//! `states.csv` of a run can also be read as measurements. Lines that begin with `#` are comments.

use std::collections::HashMap;

use papilio_colour::Xyz;
use papilio_display::compare::{Measured, Quantity};
use papilio_spectra::Tabulated;

use crate::error::{FormatError, Problem};
use crate::file::DataFile;
use crate::is_name;
use crate::pixel_table::in_range;
use crate::rows::{Row, Table};

/// Indices of the columns.
struct Columns {
    count: usize,
    state: usize,
    theta: usize,
    phi: Option<usize>,
    values: Values,
}

enum Values {
    /// Wavelength and reflectance factor.
    Spectrum([usize; 2]),
    /// X, Y and Z.
    Xyz([usize; 3]),
}

/// Reads the measurements of a panel, in the order of their first rows.
///
/// # Errors
/// With line and column: a header without the required columns, cells that are not numbers or out of range, two
/// rows for the same point, a spectrum with a single wavelength.
pub fn read_measured_panel(file: &DataFile) -> Result<Vec<Measured>, FormatError> {
    let table = Table::new(file)?;
    let mut rows = table.rows().filter(|row| !row.begins_with_hash());
    let header = rows.next().ok_or_else(|| table.error(Problem::EmptyPanel))?;
    let columns = Columns::of(&header).ok_or_else(|| header.error(Problem::PanelHeader))?;
    let mut panel = Panel::default();
    for row in rows {
        panel.push(&columns, &row)?;
    }
    if panel.measured.is_empty() {
        return Err(table.error(Problem::EmptyPanel));
    }
    panel.finish(table)
}

impl Columns {
    fn of(header: &Row<'_>) -> Option<Self> {
        let at = |name: &str| header.cells.iter().position(|cell| cell.text == name);
        let spectrum = at("wavelength_nm").zip(at("reflectance_factor"));
        let xyz = at("X").zip(at("Y")).zip(at("Z"));
        let values = match (spectrum, xyz) {
            (Some((nm, factor)), _) => Values::Spectrum([nm, factor]),
            (None, Some(((x, y), z))) => Values::Xyz([x, y, z]),
            (None, None) => return None,
        };
        let (state, theta) = (at("state")?, at("theta_deg")?);
        Some(Self { count: header.cells.len(), state, theta, phi: at("phi_deg"), values })
    }
}

/// The measurements of the rows read so far.
#[derive(Default)]
struct Panel {
    measured: Vec<Measured>,
    /// Wavelengths, values and places of the rows of each spectrum.
    spectra: Vec<Vec<(f64, f64, usize)>>,
    by_direction: HashMap<(String, u64, u64), usize>,
}

impl Panel {
    fn push(&mut self, columns: &Columns, row: &Row<'_>) -> Result<(), FormatError> {
        row.expect_cells(columns.count, "as many columns as the first row")?;
        let state = row.cells[columns.state].text.to_string();
        if !is_name(&state) {
            return Err(row.cell_error(columns.state, Problem::BadName));
        }
        let theta_deg = in_range(row, columns.theta, "an angle", -90.0, 90.0, "an angle from -90 to 90 deg")?;
        let phi_deg = match columns.phi {
            Some(phi) => in_range(row, phi, "an azimuth", -360.0, 360.0, "an azimuth from -360 to 360 deg")?,
            None => 0.0,
        };
        let key = (state.clone(), (theta_deg + 0.0).to_bits(), (phi_deg + 0.0).to_bits());
        let known = self.by_direction.get(&key).copied();
        let value = |cell| {
            in_range(row, cell, "the value", -1.0, 1e4, "a value from -1 to 1e4, where 1 is a perfect white")
        };
        let mut measured = |quantity| {
            self.by_direction.insert(key.clone(), self.measured.len());
            self.measured.push(Measured { state: state.clone(), theta_deg, phi_deg, quantity });
            self.spectra.push(Vec::new());
            self.measured.len() - 1
        };
        match columns.values {
            Values::Xyz([x, y, z]) => {
                let xyz = Xyz { x: value(x)?, y: value(y)?, z: value(z)? };
                if known.is_some() {
                    return Err(row.error(Problem::MeasuredTwice { state, theta_deg, phi_deg }));
                }
                measured(Quantity::Xyz(xyz));
            }
            Values::Spectrum([nm, factor]) => {
                let nm = in_range(row, nm, "a wavelength", 30.0, 1e6, "a wavelength in nm, 30 to 1e6")?;
                let point = (nm, value(factor)?, row.cells[0].start());
                // A placeholder; `finish` creates the spectrum from all of its rows.
                let placeholder = || Quantity::Xyz(Xyz { x: 0.0, y: 0.0, z: 0.0 });
                let at = known.unwrap_or_else(|| measured(placeholder()));
                self.spectra[at].push(point);
            }
        }
        Ok(())
    }

    fn finish(mut self, table: Table<'_>) -> Result<Vec<Measured>, FormatError> {
        for (measured, mut points) in self.measured.iter_mut().zip(self.spectra) {
            let Some(&(_, _, first_row)) = points.first() else { continue };
            points.sort_by(|a, b| a.0.total_cmp(&b.0));
            if let Some(pair) = points.windows(2).find(|pair| pair[0].0 == pair[1].0) {
                let (state, theta_deg) = (measured.state.clone(), measured.theta_deg);
                let problem = Problem::Duplicate { state, theta_deg, nm: pair[1].0 };
                return Err(table.error_at_line(pair[0].2.max(pair[1].2), problem));
            }
            if points.len() < 2 {
                return Err(table.error_at_line(first_row, Problem::TooFew { rows: points.len() }));
            }
            let (nm, values) = points.into_iter().map(|(nm, value, _)| (nm, value)).unzip();
            let spectrum = Tabulated::new(nm, values);
            let spectrum = spectrum.map_err(|error| table.error_at_line(first_row, error.into()))?;
            measured.quantity = Quantity::Spectrum(spectrum);
        }
        Ok(self.measured)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Vec<Measured>, FormatError> {
        read_measured_panel(&DataFile { name: "panel.csv".to_owned(), bytes: text.as_bytes().to_vec() })
    }

    #[test]
    fn panel_with_unsorted_spectra_or_with_colours_is_read() {
        let text = "# a panel\ntheta_deg,state,note,wavelength_nm,reflectance_factor\n8,white,x,700,0.3\n8,white,x,400,0.2\n8,black,,400,0.01\n8,black,,700,-0.001\n";
        let panel = read(text).unwrap();
        assert_eq!(panel.len(), 2);
        let Quantity::Spectrum(white) = &panel[0].quantity else { unreachable!() };
        assert!((white.at(550.0).unwrap() - 0.25).abs() < 1e-12);
        let panel = read("state;theta_deg;phi_deg;X;Y;Z\nwhite;-8;90;0.2;0.21;0.2\n").unwrap();
        assert_eq!((panel[0].theta_deg, panel[0].phi_deg), (-8.0, 90.0));
        assert_eq!(panel[0].quantity, Quantity::Xyz(Xyz { x: 0.2, y: 0.21, z: 0.2 }));
    }

    #[test]
    fn malformed_panel_is_an_error_with_its_place() {
        for (text, place) in [
            ("", None),
            ("state,theta_deg,X,Y,Z\n", None),
            ("state,theta_deg,X,Y\nwhite,8,1,1\n", Some((1, 1))),
            ("state,X,Y,Z\nwhite,1,1,1\n", Some((1, 1))),
            ("state,theta_deg,X,Y,Z\nwhite,8,1,1\n", Some((2, 1))),
            ("state,theta_deg,X,Y,Z\nwhite,95,1,1,1\n", Some((2, 7))),
            ("state,theta_deg,X,Y,Z\nwhite,8,1,nan,1\n", Some((2, 11))),
            ("state,theta_deg,X,Y,Z\nwhite,8,1,21000,1\n", Some((2, 11))),
            ("state,theta_deg,X,Y,Z\n,8,1,1,1\n", Some((2, 1))),
            ("state,theta_deg,X,Y,Z\nwhite,8,1,1,1\nwhite,8,1,1,1\n", Some((3, 1))),
            ("state,theta_deg,wavelength_nm,reflectance_factor\nwhite,8,500,1\n", Some((2, 1))),
            ("state,theta_deg,wavelength_nm,reflectance_factor\nw,8,500,1\nw,8,500,1\n", Some((3, 1))),
            ("state,theta_deg,wavelength_nm,reflectance_factor\nw,8,0.5,1\n", Some((2, 5))),
        ] {
            let error = read(text).unwrap_err();
            assert_eq!(error.place.line_column(), place, "{text:?}: {error}");
        }
    }

    #[test]
    fn arbitrary_text_never_panics() {
        let characters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_,;0123456789.\n# \"-";
        papilio_testing::laws(
            300,
            |dice| dice.text(characters, 200),
            |text| {
                let _ = read(text);
                let _ = read(&format!("state,theta_deg,wavelength_nm,reflectance_factor\n{text}"));
            },
        );
    }
}
