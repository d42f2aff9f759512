//! Optical constants in the text files `.mat` of Woollam's programs (WVASE, CompleteEASE): a title, a line with
//! the unit, a line with the kind (`NK` or `e1e2`), and rows of a wavelength or an energy and two numbers.

use papilio_diagnostics::{Diagnostic, Place};

use crate::error::FormatError;
use crate::table::{Unit, unit};

/// Head of such a file.
pub(crate) struct Head {
    /// Unit of the wavelengths.
    pub(crate) unit: Unit,
    /// Whether the numbers are those of the permittivity.
    pub(crate) is_permittivity: bool,
    /// Where the rows begin, bytes.
    pub(crate) rows_at: usize,
}

/// Reads the head; `None` if the text is no such file.
///
/// # Errors
/// If its kind is not tabulated, with its place.
pub(crate) fn head(name: &str, text: &str) -> Result<Option<Head>, FormatError> {
    let mut lines = text.split_inclusive('\n');
    let (Some(title), Some(of_unit), Some(kind)) = (lines.next(), lines.next(), lines.next()) else {
        return Ok(None);
    };
    let unit_word = of_unit.trim();
    let unit = unit(unit_word).or_else(|| unit(unit_word.trim_end_matches(['s', 'S'])));
    let is_wavelength = |unit: &Unit| {
        matches!(unit, Unit::Length(_) | Unit::Energy(_) | Unit::Wavenumber(_)) && !unit_word.is_empty()
    };
    let is_word = |text: &str| text.starts_with(|c: char| c.is_ascii_alphabetic());
    let Some(unit) = unit.filter(is_wavelength).filter(|_| is_word(kind.trim())) else { return Ok(None) };
    let plain: String = kind.chars().filter(char::is_ascii_alphanumeric).collect();
    let is_permittivity = match plain.to_ascii_lowercase().as_str() {
        "nk" => false,
        "e1e2" | "eps1eps2" => true,
        _ => {
            let start = title.len() + of_unit.len();
            let wrong = Diagnostic::new(format!("`{}` is not a kind of tabulated constants", kind.trim()))
                .expected("NK, or e1e2")
                .hint("export the layer as tabulated optical constants");
            let place = Place::in_text(name, text, start..start + kind.len());
            return Err(FormatError { place, problem: wrong.into() });
        }
    };
    Ok(Some(Head { unit, is_permittivity, rows_at: title.len() + of_unit.len() + kind.len() }))
}
