//! A measured palette: spectra, or L\*, a\*, b\*, of the states of a panel.
//!
//! The first row holds the names of the columns, in any order: `state`, and either `wavelength_nm` and `reflectance_factor`, with one row
//! per wavelength, or `L`, `a` and `b`, with one row per state. Other columns are ignored. Lines that begin with `#` are comments.

use papilio_colour::Lab;
use papilio_spectra::Tabulated;

use crate::error::{FormatError, Problem};
use crate::file::DataFile;
use crate::is_name;
use crate::pixel_table::in_range;
use crate::rows::{Row, Table};

/// A measured palette: names and colours of the states, in the order of their first rows.
#[derive(Debug, Clone, PartialEq)]
pub enum PaletteTable {
    /// Spectral reflectance factors.
    Spectra(Vec<(String, Tabulated)>),
    /// CIELAB.
    Lab(Vec<(String, Lab)>),
}

/// Wavelengths that are all shorter are in micrometres, nm.
const SHORTEST_NM: f64 = 20.0;

/// Indices of the columns.
struct Columns {
    count: usize,
    state: usize,
    values: Values,
}

enum Values {
    Spectrum([usize; 2]),
    Lab([usize; 3]),
}

/// A state, with its points and their places in the file.
struct Points {
    name: String,
    points: Vec<([f64; 3], usize)>,
}

/// Reads a measured palette.
///
/// # Errors
/// With line and column: a header without the required columns, cells that are not numbers or out of range, two rows for the same point, a
/// spectrum with a single wavelength, names that are not [permitted](is_name).
pub fn read_palette(file: &DataFile) -> Result<PaletteTable, FormatError> {
    crate::guard::read(file, of_table)
}

fn of_table(file: &DataFile) -> Result<PaletteTable, FormatError> {
    let table = Table::new(file)?;
    let mut rows = table.rows().filter(|row| !row.begins_with_hash());
    let header = rows.next().ok_or_else(|| table.error(Problem::EmptyPalette))?;
    let columns = Columns::of(&header).ok_or_else(|| header.error(Problem::PaletteHeader))?;
    let mut states: Vec<Points> = Vec::new();
    for row in rows {
        columns.push(&row, &mut states)?;
    }
    if states.is_empty() {
        return Err(table.error(Problem::EmptyPalette));
    }
    match columns.values {
        Values::Lab(_) => {
            let lab = |[l, a, b]: [f64; 3]| Lab { l, a, b };
            Ok(PaletteTable::Lab(states.into_iter().map(|one| (one.name, lab(one.points[0].0))).collect()))
        }
        Values::Spectrum(_) => {
            let spectra = states.into_iter().map(|one| one.spectrum(table));
            Ok(PaletteTable::Spectra(spectra.collect::<Result<_, _>>()?))
        }
    }
}

/// Whether two points of a state are the same.
type IsSame = fn(&[f64; 3], &[f64; 3]) -> bool;

impl Columns {
    fn of(header: &Row<'_>) -> Option<Self> {
        let at = |name: &str| header.cells.iter().position(|cell| cell.text == name);
        let spectrum = at("wavelength_nm").zip(at("reflectance_factor"));
        let lab = at("L").zip(at("a")).zip(at("b"));
        let values = match (spectrum, lab) {
            (Some((nm, factor)), _) => Values::Spectrum([nm, factor]),
            (None, Some(((l, a), b))) => Values::Lab([l, a, b]),
            (None, None) => return None,
        };
        Some(Self { count: header.cells.len(), state: at("state")?, values })
    }

    fn push(&self, row: &Row<'_>, states: &mut Vec<Points>) -> Result<(), FormatError> {
        row.expect_cells(self.count, "as many columns as the first row")?;
        let name = row.cells[self.state].text.to_string();
        if !is_name(&name) {
            return Err(row.cell_error(self.state, Problem::BadName));
        }
        let (point, is_same): ([f64; 3], IsSame) = match self.values {
            Values::Spectrum([nm, factor]) => {
                let nm = in_range(row, nm, "the wavelength", 0.1, 1e5, "a wavelength in nm")?;
                let expected = "a number from 0 to 1; fluorescence is not modelled";
                let factor = in_range(row, factor, "the reflectance factor", 0.0, 1.0, expected)?;
                ([nm, factor, 0.0], |a, b| a[0] == b[0])
            }
            Values::Lab([l, a, b]) => {
                let l = in_range(row, l, "L*", 0.0, 100.0, "a lightness from 0 to 100")?;
                let chroma =
                    |cell, what| in_range(row, cell, what, -200.0, 200.0, "a number from -200 to 200");
                ([l, chroma(a, "a*")?, chroma(b, "b*")?], |_, _| true)
            }
        };
        let place = row.cells[0].start();
        match states.iter_mut().find(|state| state.name == name) {
            Some(state) if state.points.iter().any(|known| is_same(&known.0, &point)) => {
                let value = matches!(self.values, Values::Spectrum(_)).then_some(point[0]);
                Err(row.error(Problem::PaletteTwice { state: name, nm: value }))
            }
            Some(state) => {
                state.points.push((point, place));
                Ok(())
            }
            None => {
                states.push(Points { name, points: vec![(point, place)] });
                Ok(())
            }
        }
    }
}

impl Points {
    fn spectrum(mut self, table: Table<'_>) -> Result<(String, Tabulated), FormatError> {
        let place = self.points[0].1;
        if self.points.iter().all(|(point, _)| point[0] < SHORTEST_NM) {
            return Err(table.error_at_line(place, Problem::Micrometres));
        }
        self.points.sort_by(|a, b| a.0[0].total_cmp(&b.0[0]));
        let (nm, factor) = self.points.iter().map(|(point, _)| (point[0], point[1])).unzip();
        let tabulated = Tabulated::new(nm, factor);
        let tabulated = tabulated.map_err(|error| table.error_at_line(place, error.into()))?;
        Ok((self.name, tabulated))
    }
}
