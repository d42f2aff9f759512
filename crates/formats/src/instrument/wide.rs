//! Tables of spectrophotometers: a row for each sample, a column for each wavelength.

use super::{Kind, Sample, SpectralFile};
use crate::error::FormatError;
use crate::table::quantities::{FRACTION, PHI, REFLECTANCE, STATE, THETA};
use crate::table::{ColumnName, Header, Quantity, Row, Table, Unit};

const FORMAT: &str = "table with a column for each wavelength";

/// Fewest columns of a spectrum.
const FEWEST: usize = 3;

/// Number of rows among which the header is searched.
const FIRST_ROWS: usize = 60;

/// Returns the wavelength of a column `400 nm`, `400`, `R_400`, `nm400` or `SPECTRAL_NM_400`, nm.
fn wavelength(name: &str) -> Option<f64> {
    // `R_400 (1)`: the unit of the values is no digit of the wavelength.
    let column = ColumnName::new(name);
    let name = if matches!(column.unit, Some(Ok(Unit::Fraction(_)))) { &column.text } else { name };
    let plain: String =
        name.chars().filter(|c| !c.is_whitespace() && !matches!(c, '[' | ']' | '(' | ')' | '_')).collect();
    let plain = plain.to_ascii_lowercase().replace(['%', ':'], "");
    let bare = plain.strip_suffix("nm").unwrap_or(&plain);
    let start = bare.rfind(|c: char| !c.is_ascii_digit() && c != '.').map_or(0, |at| at + 1);
    const BEFORE: [&str; 10] =
        ["", "r", "t", "nm", "spec", "spectral", "spectralnm", "wl", "sci", "reflectance"];
    let nm = bare.get(start..)?.parse().ok().filter(|nm: &f64| (200.0..3000.0).contains(nm))?;
    BEFORE.contains(&&bare[..start]).then_some(nm)
}

/// Returns the cells of the wavelengths, if the row is the header of such a table.
fn columns(row: &Row<'_>) -> Option<Vec<(usize, f64)>> {
    let cells = row.cells.iter().enumerate();
    let found: Vec<(usize, f64)> = cells.filter_map(|(k, cell)| Some((k, wavelength(&cell.text)?))).collect();
    let ascends = found.windows(2).all(|pair| pair[0].1 < pair[1].1);
    let descends = found.windows(2).all(|pair| pair[0].1 > pair[1].1);
    // Without a single name, or an empty cell above the names of the samples, it would be a row of numbers.
    let has_names = row.cells.iter().any(|cell| cell.text.parse::<f64>().is_err());
    (found.len() >= FEWEST && has_names && (ascends || descends)).then_some(found)
}

pub(super) fn read(table: Table<'_>) -> Result<Option<SpectralFile>, FormatError> {
    let mut rows = table.data();
    let mut above: Vec<Row<'_>> = Vec::new();
    let head = rows.by_ref().take(FIRST_ROWS).find_map(|row| {
        let found = columns(&row).filter(|_| above.iter().all(|other| is_title(other, row.cells.len())));
        match found {
            Some(columns) => Some((row, columns)),
            None => {
                above.push(row);
                None
            }
        }
    });
    let Some((head, columns)) = head else { return Ok(None) };
    let accepted: [&'static Quantity; 3] = [&STATE, &THETA, &PHI];
    let mut header = Header::of(&head, &accepted)?;
    header.others.retain(|other| columns.iter().all(|(cell, _)| *cell != other.cell));
    // Without a column of names, the first column with an unknown name holds them.
    let first =
        header.others.iter().position(|other| other.cell < columns[0].0 && header.get(&STATE).is_none());
    let state = match (header.get(&STATE), first) {
        (Some(column), _) => Some(column.cell),
        (None, Some(first)) => Some(header.others.remove(first).cell),
        (None, None) => None,
    };
    header.note_others();
    let of_columns = columns.iter().any(|(cell, _)| head.cells[*cell].text.contains('%'));
    let mut titles = head.cells.iter().chain(above.iter().flat_map(|row| &row.cells));
    let unit = (of_columns || titles.any(|cell| is_per_cent(&cell.text))).then_some(Unit::Fraction(1e-2));
    let mut samples = Vec::new();
    for (k, row) in rows.enumerate() {
        row.expect_cells(header.count, "as many columns as the header")?;
        let angle =
            |quantity: &'static Quantity| header.get(quantity).map(|column| column.number(&row)).transpose();
        let mut sample = Sample {
            name: state.map_or_else(|| (k + 1).to_string(), |cell| row.cells[cell].text.to_string()),
            theta_deg: angle(&THETA)?,
            phi_deg: angle(&PHI)?,
            at: row.bytes(),
            ..Sample::default()
        };
        for (cell, nm) in &columns {
            let value = row.number(*cell)?;
            let value = unit.map_or(value, |unit| unit.convert(value, crate::table::Dimension::Fraction));
            sample.spectrum.push((*nm, value, row.cells[*cell].bytes()));
        }
        samples.push(sample);
    }
    let mut file = SpectralFile::new(FORMAT, Kind::Unstated, samples, header.notes);
    file.has_scale = unit.is_some();
    file.divide_per_cent();
    Ok(Some(file))
}

/// Returns whether a title states that the values are in per cent: a part of it is this unit, or names the values in it.
/// Other titles and columns (`UV 100 %`, `Humidity (%)`) have nothing to do with the values.
fn is_per_cent(title: &str) -> bool {
    const VALUES: [&str; 4] = ["data", "values", "spectral_data", "unit"];
    let is_one = |part: &str| {
        let name = ColumnName::new(part);
        let quantity = ColumnName::new(name.text.trim().trim_end_matches(" in"));
        let is_alone = name.text.chars().all(|c| !c.is_alphanumeric());
        let is_named =
            || [REFLECTANCE.names, FRACTION.names, &VALUES].iter().any(|all| quantity.is_one_of(all, false));
        matches!(name.unit, Some(Ok(Unit::Fraction(scale))) if scale == 1e-2) && (is_alone || is_named())
    };
    title.split([':', ';', ',']).any(is_one)
}

/// Returns whether a row above the header is a title: it has fewer cells than the header, or mostly empty
/// ones.
fn is_title(row: &Row<'_>, count: usize) -> bool {
    let empty = row.cells.iter().filter(|cell| cell.text.trim().is_empty()).count();
    row.cells.len() < count || 2 * empty >= row.cells.len()
}
