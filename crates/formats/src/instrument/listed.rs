//! Tables of light meters (Sekonic, UPRtek): a row for each quantity, those of the spectrum named
//! `Spectral Data 380[nm]` or `380nm`.

use papilio_diagnostics::Diagnostic;

use super::{Kind, Sample, SpectralFile};
use crate::error::FormatError;
use crate::table::{Row, Table};

const FORMAT: &str = "table of a light meter";

/// Fewest values of a spectrum.
const FEWEST: usize = 10;

/// Returns the wavelength of a row `Spectral Data 380[nm]`, nm.
fn wavelength(row: &Row<'_>) -> Option<f64> {
    let name = row.cells.first()?.text.trim();
    let name = name.strip_suffix(']').unwrap_or(name).trim_end();
    let name = name.strip_suffix("nm").or_else(|| name.strip_suffix("NM"))?;
    let name = name.trim_end().trim_end_matches(['[', '(']).trim_end();
    let start = name.rfind(|c: char| !c.is_ascii_digit() && c != '.').map_or(0, |at| at + 1);
    let words = name[..start].trim();
    let is_spectrum = words.is_empty() || words.to_ascii_lowercase().contains("spectral");
    name.get(start..)?.parse().ok().filter(|nm: &f64| is_spectrum && (100.0..1e5).contains(nm))
}

pub(super) fn read(table: Table<'_>) -> Result<Option<SpectralFile>, FormatError> {
    let rows: Vec<(f64, Row<'_>)> = table.data().filter_map(|row| Some((wavelength(&row)?, row))).collect();
    if rows.len() < FEWEST {
        return Ok(None);
    }
    // The spectrum may be given twice, in steps of 5 nm and of 1 nm: the second one begins again at the first wavelength.
    let blocks = rows.chunk_by(|a, b| a.0 < b.0);
    if let Some(wrong) = blocks.clone().skip(1).find(|block| block[0].0 != rows[0].0) {
        let (nm, row) = &wrong[0];
        let problem = Diagnostic::new(format!("the wavelength {nm} nm is not above that of the row before"))
            .expected("the wavelengths of a spectrum in ascending order, each once")
            .hint("a second spectrum in other steps begins at the wavelength of the first one");
        return Err(row.error(problem.into()));
    }
    let Some(block) = blocks.max_by_key(|block| block.len()) else { return Ok(None) };
    let row_of =
        |name: &str| table.data().find(|row| row.cells.first().is_some_and(|cell| cell.text.trim() == name));
    let titles = row_of("Title");
    let count = block[0].1.cells.iter().skip(1).filter(|cell| !cell.text.trim().is_empty()).count();
    let mut samples = Vec::new();
    for column in 1..=count {
        let mut sample = Sample { at: block[0].1.bytes(), ..Sample::default() };
        let title =
            titles.as_ref().and_then(|row| row.cells.get(column)).map(|cell| cell.text.trim().to_owned());
        sample.name = title.filter(|title| !title.is_empty()).unwrap_or_else(|| column.to_string());
        for (nm, row) in block {
            sample.spectrum.push((*nm, row.number(column)?, row.cells[column].bytes()));
        }
        samples.push(sample);
    }
    Ok(Some(SpectralFile::new(FORMAT, Kind::Light, samples, Vec::new())))
}
