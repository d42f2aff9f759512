//! Measured panels: spectra or colours of each state from each direction.

use papilio_colour::{Lab, Standard, Xyz};
use papilio_diagnostics::{Diagnostic, Warned};
use papilio_display::compare::{Measured, Quantity};

use crate::error::{FormatError, too_few};
use crate::file::DataFile;
use crate::states::{Accept, State, Value, read_states};

/// Least reflectance factor: that of a noisy measurement of black.
const LEAST: f64 = -0.05;

/// Reads the measurements of a panel, in the order of their first rows, with notes on how the file was read.
///
/// A table names its columns in its header, in any order and with their units: `state`; optionally
/// `theta_deg` and `phi_deg`; and either `wavelength_nm` and `reflectance_factor`, with one row per
/// wavelength, or `X`, `Y` and `Z` relative to a perfect white (Y = 1), or `L`, `a` and `b`, with one row per
/// state and direction. An optional column `standard_deviation` has the unit of the values. Tables with a column for each state or for each wavelength, and the files of
/// instruments (CGATS, CxF), are read too. Further columns are noted, so that `spectra.csv` and `states.csv`
/// of a run can also be read as measurements. Lines that begin with `#` are comments.
///
/// # Errors
/// With line and column: a header without the required columns, cells that are not numbers or out of range,
/// two rows for the same point, a spectrum with a single wavelength.
pub fn read_measured_panel(file: &DataFile) -> Result<Warned<Vec<Measured>>, FormatError> {
    let accept = Accept {
        factor: (LEAST, 1e4),
        factor_in_words: "a value from -0.05 (noise) to 1e4, where 1 is a perfect white",
        xyz: true,
        empty: too_few(0)
            .expected(
                "a first row with the names of the columns, and a row for each state and direction (for spectra, a row for each \
                 state, direction and wavelength)",
            )
            .into(),
        header: Diagnostic::new("this is not the header of a measured panel")
            .expected(
                "the columns `state`, optionally `theta_deg`, and `wavelength_nm`, `reflectance_factor` or `X`, `Y`, `Z` or `L`, `a`, `b`; \
                 or `wavelength_nm` and a column for each state; or `state` and a column for each wavelength",
            )
            .into(),
    };
    let mut read = read_states(file, &accept)?;
    let has_colours = read.states.iter().any(|state| !matches!(state.value, Value::Spectrum(_)));
    if has_colours && read.observer == Some(Standard::Cie1964) {
        read.notes.push(
            "the colours of the file are those of the 10 deg observer: compare them with a scenario of metrics.observer = \"1964\"".to_owned(),
        );
    }
    if let Some(illuminant) = read.illuminant.filter(|_| has_colours) {
        read.notes.push(format!(
            "the colours of the file are those in {illuminant}: compare them with a display in {illuminant}"
        ));
    }
    let measured = |State { name, theta_deg, phi_deg, value, deviation }: State| Measured {
        state: name,
        theta_deg,
        phi_deg,
        quantity: match value {
            Value::Spectrum(spectrum) => Quantity::Spectrum(spectrum),
            Value::Xyz([x, y, z]) => Quantity::Xyz(Xyz { x, y, z }),
            Value::Lab([l, a, b]) => Quantity::Lab(Lab { l, a, b }),
        },
        standard_deviation: deviation,
    };
    Ok(Warned { value: read.states.into_iter().map(measured).collect(), warnings: read.notes })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Vec<Measured>, FormatError> {
        let file = DataFile { name: "panel.csv".to_owned(), bytes: text.as_bytes().to_vec() };
        read_measured_panel(&file).map(|read| read.value)
    }

    #[test]
    fn panel_with_unsorted_spectra_or_with_colours_is_read() {
        let text = "# a panel\ntheta_deg,state,note,wavelength_nm,reflectance_factor\n8,white,x,700,0.3\n8,white,x,400,0.2\n8,black,,400,0.01\n8,black,,700,-0.001\n";
        let panel = read(text).unwrap();
        assert_eq!(panel.len(), 2);
        let Quantity::Spectrum(white) = &panel[0].quantity else { unreachable!() };
        assert!((white.at(550.0).unwrap() - 0.25).abs() < 1e-12);
        let panel = read("state;theta_deg;phi_deg;X;Y;Z\nwhite;-8;90;0.2;0.21;0.2\n").unwrap();
        assert_eq!((panel[0].theta_deg, panel[0].phi_deg), (Some(-8.0), 90.0));
        assert_eq!(panel[0].quantity, Quantity::Xyz(Xyz { x: 0.2, y: 0.21, z: 0.2 }));
        let panel = read("Sample,L*,a*,b*\nWhite,50,-1,2\n").unwrap();
        assert_eq!((panel[0].state.as_str(), panel[0].theta_deg), ("White", None));
        assert_eq!(panel[0].quantity, Quantity::Lab(Lab { l: 50.0, a: -1.0, b: 2.0 }));
    }

    #[test]
    fn malformed_panel_is_an_error_with_its_place() {
        for (text, place) in [
            ("", None),
            ("state,theta_deg,X,Y,Z\n", None),
            ("state,theta_deg,X,Y\nwhite,8,1,1\n", Some((1, 1))),
            ("theta_deg,X,Y,Z\n8,1,1,1\n", Some((1, 1))),
            ("state,theta_deg,X,Y,Z\nwhite,8,1,1\n", Some((2, 1))),
            ("state,theta_deg,X,Y,Z\nwhite,95,1,1,1\n", Some((2, 7))),
            ("state,theta_deg,X,Y,Z\nwhite,8,1,nan,1\n", Some((2, 11))),
            ("state,theta_deg,X,Y,Z\nwhite,8,1,21000,1\n", Some((2, 11))),
            ("state,theta_deg,X,Y,Z\nwhite,8,1,-0.01,1\n", Some((2, 11))),
            ("state,theta_deg,X,Y,Z\n,8,1,1,1\n", Some((2, 1))),
            ("state,theta_deg,X,Y,Z\nwhite,8,1,1,1\nwhite,8,1,1,1\n", Some((3, 1))),
            ("state,theta_deg,wavelength_nm,reflectance_factor\nwhite,8,500,1\n", Some((2, 1))),
            ("state,theta_deg,wavelength_nm,reflectance_factor\nw,8,500,1\nw,8,500,1\n", Some((3, 9))),
            ("state,theta_deg,wavelength_nm,reflectance_factor\nw,8,0.5,1\n", Some((2, 5))),
        ] {
            let error = read(text).unwrap_err();
            assert_eq!(error.place.line_column(), place, "{text:?}: {error}");
        }
    }

    #[test]
    fn arbitrary_text_never_panics() {
        let characters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_,;0123456789.\n# \"-%()\u{b5}";
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
