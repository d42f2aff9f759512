//! A measured palette: spectra, or L\*, a\*, b\*, of the states of a panel.

use papilio_colour::{Lab, Standard};
use papilio_diagnostics::{Diagnostic, Warned};
use papilio_spectra::Tabulated;

use crate::error::{FormatError, Problem, too_few};
use crate::file::DataFile;
use crate::states::{Accept, Value, read_states, two_values};

/// A measured palette: names and colours of the states, in the order of their first rows.
#[derive(Debug, Clone, PartialEq)]
pub enum PaletteTable {
    /// Spectral reflectance factors.
    Spectra(Vec<(String, Tabulated)>),
    /// CIELAB.
    Lab {
        /// Colours by state.
        colours: Vec<(String, Lab)>,
        /// The observer, if the file states it.
        observer: Option<Standard>,
        /// The illuminant, such as `D50`, if the file states it.
        illuminant: Option<String>,
    },
}

/// Reads a measured palette, with notes on how the file was read.
///
/// A table names its columns in its header, in any order and with their units: `state`, and either
/// `wavelength_nm` and `reflectance_factor`, with one row per wavelength, or `L`, `a` and `b`, with one row
/// per state. Tables with a column for each state or for each wavelength, and the files of instruments
/// (CGATS, CxF), are read too. Further columns are noted. Lines that begin with `#` are comments.
///
/// # Errors
/// With line and column: a header without the required columns, cells that are not numbers or out of range,
/// two rows for the same point, a spectrum with a single wavelength, names that are not
/// [permitted](crate::is_name).
pub fn read_palette(file: &DataFile) -> Result<Warned<PaletteTable>, FormatError> {
    crate::guard::read(file, of_table)
}

fn wrong_header() -> Problem {
    let wrong = Diagnostic::new("this is not the header of a measured palette").expected(
        "the columns `state`, and `wavelength_nm`, `reflectance_factor` or `L`, `a`, `b`; or `wavelength_nm` and a column for each \
         state; or `state` and a column for each wavelength",
    );
    wrong.into()
}

fn of_table(file: &DataFile) -> Result<Warned<PaletteTable>, FormatError> {
    let accept = Accept {
        factor: (0.0, 1.0),
        factor_in_words: "a number from 0 to 1; fluorescence is not modelled",
        xyz: false,
        empty: too_few(0)
            .expected(
                "a first row with the names of the columns, and a row for each state (for spectra, for each state and wavelength)",
            )
            .into(),
        header: wrong_header(),
    };
    let read = read_states(file, &accept)?;
    let (mut spectra, mut colours) = (Vec::new(), Vec::new());
    let mut names: Vec<String> = Vec::new();
    for state in read.states {
        let whole = |problem| FormatError::whole(&file.name, problem);
        if names.contains(&state.name) {
            return Err(whole(two_values(&state.name, state.theta_deg, None)));
        }
        names.push(state.name.clone());
        match state.value {
            Value::Spectrum(spectrum) => spectra.push((state.name, spectrum)),
            Value::Lab([l, a, b]) => colours.push((state.name, Lab { l, a, b })),
            Value::Xyz(_) => return Err(whole(wrong_header())),
        }
    }
    let value = match spectra.is_empty() {
        true => PaletteTable::Lab { colours, observer: read.observer, illuminant: read.illuminant },
        false => PaletteTable::Spectra(spectra),
    };
    Ok(Warned { value, warnings: read.notes })
}
