//! Pixel tables: reflectance by state, angle and wavelength, as `pixel.csv`.
//!
//! Other programs for pixels provide their results in this format: complete states (areas and fill
//! factor included), every angle at every wavelength, rows in any order. A table of a pixel that depends on
//! azimuth has a further column, and every inclination at every azimuth.

mod half_turn;

use std::collections::HashMap;
use std::io::{self, Write};

use csv::QuoteStyle;
use papilio_diagnostics::{Diagnostic, Warned};
use papilio_spectra::{Grid, SpectraError, Spectrum, Tabulated};

use crate::error::{FormatError, Problem};
use crate::file::DataFile;
use crate::table::quantities::{PHI, REFLECTANCE, STATE, THETA, WAVELENGTH};
use crate::table::{Column, Header, Quantity, Row, Table, TableText};
use crate::words::{is_formula, is_override};

/// The columns of `pixel.csv`, without that of the azimuth, `phi_deg`.
pub const PIXEL_COLUMNS: [&str; 4] = ["state", "theta_deg", "wavelength_nm", "reflectance"];

/// Range of a wavelength, nm.
pub(crate) const NM: (f64, f64) = (30.0, 1e6);

/// Reflectances of complete states on a rectangular grid of angles, azimuths and wavelengths.
#[derive(Debug, Clone, PartialEq)]
pub struct PixelTable {
    /// Angles, degrees, ascending from 0, at most 90.
    pub theta_deg: Vec<f64>,
    /// Azimuths to which light leaves, counter-clockwise as seen by the viewer, degrees, ascending; empty without that column.
    pub phi_deg: Vec<f64>,
    /// Wavelengths, nm, ascending.
    pub wavelength_nm: Vec<f64>,
    /// Name and reflectances (0 to 1) of each state, `[angle][wavelength]` or `[angle][azimuth][wavelength]`.
    pub states: Vec<(String, Vec<f64>)>,
}

impl PixelTable {
    /// Returns the reflectance spectra of state number `state` on `grid`, one for each angle (and azimuth), interpolated
    /// linearly in wavelength.
    ///
    /// # Errors
    /// If the table does not cover the grid, or its lengths are inconsistent.
    pub fn spectra(&self, state: usize, grid: &Grid) -> Result<Vec<Spectrum>, SpectraError> {
        self.rows(state)
            .map(|row| Tabulated::new(self.wavelength_nm.clone(), row.to_vec())?.on(grid))
            .collect()
    }

    /// Reflectance of a state in one direction, by its number in the table; `None` if there is none.
    pub fn spectrum(&self, state: usize, direction: usize) -> Option<Tabulated> {
        Tabulated::new(self.wavelength_nm.clone(), self.rows(state).nth(direction)?.to_vec()).ok()
    }

    /// Spectra of a state, one for each direction.
    fn rows(&self, state: usize) -> impl Iterator<Item = &[f64]> {
        let values = self.states.get(state).map_or(&[][..], |(_, values)| values);
        values.chunks(self.wavelength_nm.len().max(1))
    }

    /// Writes `state,theta_deg,wavelength_nm,reflectance`, with `phi_deg` if there are azimuths. Reading the numbers returns the same bits.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn write(&self, out: impl Write) -> io::Result<()> {
        // Without quotes, a reader would drop blanks around a name and split it at semicolons.
        let needs_quotes = self.states.iter().any(|(name, _)| name.trim() != name || name.contains(';'));
        let style = if needs_quotes { QuoteStyle::NonNumeric } else { QuoteStyle::Necessary };
        let mut csv = csv::WriterBuilder::new().quote_style(style).from_writer(out);
        let [first @ .., nm, reflectance] = PIXEL_COLUMNS;
        let phi = (!self.phi_deg.is_empty()).then_some("phi_deg");
        csv.write_record(first.into_iter().chain(phi).chain([nm, reflectance]))?;
        let azimuths = self.azimuths();
        for (state, values) in &self.states {
            let directions =
                self.theta_deg.iter().flat_map(|theta| azimuths.iter().map(move |phi| (theta, phi)));
            let points =
                directions.flat_map(|direction| self.wavelength_nm.iter().map(move |nm| (direction, nm)));
            for (((theta, phi), nm), value) in points.zip(values) {
                let [theta, nm, value] = [theta, nm, value].map(f64::to_string);
                let phi = phi.map(|phi| phi.to_string());
                csv.write_record([state.clone(), theta].into_iter().chain(phi).chain([nm, value]))?;
            }
        }
        csv.flush()
    }

    /// The azimuths; `None` alone without that column.
    fn azimuths(&self) -> Vec<Option<f64>> {
        match &self.phi_deg[..] {
            [] => vec![None],
            phi_deg => phi_deg.iter().copied().map(Some).collect(),
        }
    }
}

/// Reads a pixel table, with its azimuths as [`PixelTable::over_half_turn`] returns them; the warnings are notes.
///
/// # Errors
/// As [`read_pixel_table`] and [`PixelTable::over_half_turn`].
pub fn read_pixel_over_half_turn(file: &DataFile) -> Result<Warned<PixelTable>, FormatError> {
    let whole = |wrong: Diagnostic| FormatError::whole(&file.name, wrong);
    read_pixel_table(file)?.over_half_turn().map_err(whole)
}

/// Reads a pixel table. Its first row holds the names of the columns, [`PIXEL_COLUMNS`] in any order and with
/// their units, and perhaps the azimuth.
///
/// # Errors
/// With line and column: cells that are not numbers, reflectances outside 0 to
/// 1, angles outside 0 to 90 deg, azimuths outside -360 to 360 deg, two rows or none for a point (every
/// state has the same angles, azimuths and wavelengths; along the normal, one azimuth suffices), a smallest angle other than 0,
/// states whose names are not [permitted](is_name).
pub fn read_pixel_table(file: &DataFile) -> Result<PixelTable, FormatError> {
    let text = TableText::new(file)?;
    let table = text.table();
    let mut rows = table.rows().filter(|row| !is_comment(row));
    let head = rows.next().ok_or_else(|| table.error(Problem::TooFew { rows: 0 }))?;
    let columns = PixelColumns::of(&head)?;
    let mut points = Points::default();
    for row in rows {
        points.push(&row, &columns)?;
    }
    points.into_table(table, columns.phi.is_some())
}

/// The columns of a pixel table.
struct PixelColumns {
    state: Column,
    theta: Column,
    phi: Option<Column>,
    wavelength: Column,
    reflectance: Column,
    count: usize,
}

impl PixelColumns {
    fn of(head: &Row<'_>) -> Result<Self, FormatError> {
        static ACCEPTED: [&Quantity; 5] = [&STATE, &THETA, &WAVELENGTH, &REFLECTANCE, &PHI];
        let mut header = Header::of(head, &ACCEPTED)?;
        header.refuse_others(head, &ACCEPTED)?;
        let [Some(state), Some(theta), Some(wavelength), Some(reflectance), phi] =
            ACCEPTED.map(|quantity| header.get(quantity))
        else {
            let wrong = Diagnostic::new("this is not the header of a pixel table");
            return Err(head.error(wrong.expected("`state,theta_deg,wavelength_nm,reflectance`").into()));
        };
        Ok(Self { state, theta, phi, wavelength, reflectance, count: header.count })
    }
}

/// Returns whether a state or sub-pixel may have this name: 1 to 64 characters without control characters or
/// characters that change the direction of a text, without blanks at the ends, and nothing that a spreadsheet
/// would read as a formula.
pub fn is_name(text: &str) -> bool {
    let length = text.chars().count();
    let is_forbidden = |c: char| c.is_control() || is_override(c);
    (1..=64).contains(&length) && text.trim() == text && !text.chars().any(is_forbidden) && !is_formula(text)
}

/// Returns whether a row is a comment. A state may be called `#1`: a row that begins with `#` is a comment
/// unless it could be a point.
fn is_comment(row: &Row<'_>) -> bool {
    row.is_comment()
        && !(row.cells.len() >= PIXEL_COLUMNS.len() && (1..row.cells.len()).any(|cell| row.is_number(cell)))
}

/// The points of the rows read so far.
#[derive(Default)]
struct Points {
    names: Vec<String>,
    by_name: HashMap<String, usize>,
    points: Vec<Point>,
    /// Start of each point's row, bytes, for errors about pairs of rows.
    places: Vec<usize>,
}

#[derive(Clone, Copy)]
struct Point {
    state: usize,
    theta_deg: f64,
    /// 0 without a column of azimuths.
    phi_deg: f64,
    nm: f64,
    reflectance: f64,
    /// Index of the row, from 0 below the header.
    row: usize,
}

impl Points {
    fn push(&mut self, row: &Row<'_>, columns: &PixelColumns) -> Result<(), FormatError> {
        let expected = match columns.phi {
            None => "four columns: state, theta_deg, wavelength_nm, reflectance",
            Some(_) => "five columns: state, theta_deg, phi_deg, wavelength_nm, reflectance",
        };
        row.expect_cells(columns.count, expected)?;
        let name = columns.state.text(row);
        let state = match self.by_name.get(name) {
            Some(&state) => state,
            None if !is_name(name) => return Err(row.cell_error(columns.state.cell, Problem::BadName)),
            None => {
                self.by_name.insert(name.to_owned(), self.names.len());
                self.names.push(name.to_owned());
                self.names.len() - 1
            }
        };
        let PixelColumns { theta, phi, wavelength, reflectance, .. } = columns;
        let theta_deg = theta.number_within(row, "an angle", (0.0, 90.0), "an angle from 0 to 90 deg")?;
        let phi_deg = match phi {
            Some(phi) => {
                phi.number_within(row, "an azimuth", (-360.0, 360.0), "an azimuth from -360 to 360 deg")?
            }
            None => 0.0,
        };
        let nm = wavelength.number_within(row, "a wavelength", NM, "a wavelength in nm, 30 to 1e6")?;
        let reflectance =
            reflectance.number_within(row, "reflectance", (0.0, 1.0), "a reflectance from 0 to 1")?;
        self.points.push(Point { state, theta_deg, phi_deg, nm, reflectance, row: self.places.len() });
        self.places.push(row.cells[0].start());
        Ok(())
    }

    fn into_table(mut self, table: Table<'_>, has_azimuths: bool) -> Result<PixelTable, FormatError> {
        self.sort();
        self.check_duplicates(table)?;
        let phi_deg = if has_azimuths { self.spread_normal() } else { Vec::new() };
        let theta_deg = axis(self.points.iter().map(|p| p.theta_deg));
        let wavelength_nm = axis(self.points.iter().map(|p| p.nm));
        self.check_missing(table, [&theta_deg, &phi_deg, &wavelength_nm])?;
        match theta_deg.first() {
            Some(&first) if first == 0.0 && wavelength_nm.len() > 1 => {}
            Some(&first) if first > 0.0 => {
                let wrong = Diagnostic::new(format!("the smallest angle is {first} deg"))
                    .expected("0 deg as the smallest angle")
                    .hint("add rows for 0 deg, the normal of the display");
                return Err(table.error(wrong.into()));
            }
            _ => return Err(table.error(Problem::TooFew { rows: wavelength_nm.len() })),
        }
        let size = theta_deg.len() * phi_deg.len().max(1) * wavelength_nm.len();
        let values = self.points.chunks(size).map(|state| state.iter().map(|p| p.reflectance).collect());
        let states = self.names.into_iter().zip(values).collect();
        Ok(PixelTable { theta_deg, phi_deg, wavelength_nm, states })
    }

    fn sort(&mut self) {
        self.points.sort_by(|a, b| {
            let directions = a.theta_deg.total_cmp(&b.theta_deg).then(a.phi_deg.total_cmp(&b.phi_deg));
            a.state.cmp(&b.state).then(directions).then(a.nm.total_cmp(&b.nm)).then(a.row.cmp(&b.row))
        });
    }

    /// Repeats, for all azimuths, rows of states with one azimuth along the normal, which is the same direction at all of them; returns the azimuths.
    /// The points are sorted and distinct.
    fn spread_normal(&mut self) -> Vec<f64> {
        let mut normal: Vec<Option<f64>> = vec![None; self.names.len()];
        let mut is_single = vec![true; self.names.len()];
        for point in self.points.iter().filter(|point| point.theta_deg == 0.0) {
            let first = *normal[point.state].get_or_insert(point.phi_deg);
            is_single[point.state] &= first == point.phi_deg;
        }
        let is_repeated = |point: &Point| point.theta_deg == 0.0 && is_single[point.state];
        let mut phi_deg = axis(self.points.iter().filter(|point| !is_repeated(point)).map(|p| p.phi_deg));
        if phi_deg.is_empty() {
            phi_deg = axis(self.points.iter().map(|p| p.phi_deg));
        }
        // In a complete table, other inclinations have at least as many rows.
        let repeated = self.points.iter().filter(|point| is_repeated(point)).count();
        if repeated.saturating_mul(phi_deg.len()) > self.points.len() {
            return phi_deg;
        }
        let points = std::mem::take(&mut self.points).into_iter();
        self.points = points
            .flat_map(|point| {
                let azimuths = if is_repeated(&point) { &phi_deg[..] } else { &[point.phi_deg] };
                azimuths.iter().map(|phi_deg| Point { phi_deg: *phi_deg, ..point }).collect::<Vec<_>>()
            })
            .collect();
        self.sort();
        phi_deg
    }

    fn check_duplicates(&self, table: Table<'_>) -> Result<(), FormatError> {
        for pair in self.points.windows(2) {
            let [a, b] = [pair[0], pair[1]];
            if a.state == b.state && a.theta_deg == b.theta_deg && a.phi_deg == b.phi_deg && a.nm == b.nm {
                let (state, theta_deg, nm) = (&self.names[b.state], b.theta_deg, b.nm);
                let azimuth =
                    if b.phi_deg == 0.0 { String::new() } else { format!(", azimuth {} deg", b.phi_deg) };
                let wrong = Diagnostic::new(format!(
                    "state `{state}` at {theta_deg} deg{azimuth} and {nm} nm has two rows"
                ));
                let wrong = wrong.hint("remove one of the two rows");
                return Err(table.error_at_line(self.places[b.row], wrong.into()));
            }
        }
        Ok(())
    }

    /// Fails if a point is missing. The points are sorted and distinct: the first one that differs from the
    /// rectangular grid follows a missing point.
    fn check_missing(
        &self,
        table: Table<'_>,
        [theta_deg, phi_deg, wavelength_nm]: [&[f64]; 3],
    ) -> Result<(), FormatError> {
        let mut points = self.points.iter();
        let azimuths = if phi_deg.is_empty() { &[0.0] } else { phi_deg };
        for (state, name) in self.names.iter().enumerate() {
            let directions =
                theta_deg.iter().flat_map(|theta| azimuths.iter().map(move |phi| (*theta, *phi)));
            for (theta, phi) in directions {
                for &nm in wavelength_nm {
                    let found = points.next();
                    let is_it =
                        |p: &Point| (p.state, p.theta_deg, p.phi_deg, p.nm) == (state, theta, phi, nm);
                    if !found.is_some_and(is_it) {
                        let azimuth = (!phi_deg.is_empty()).then_some(phi);
                        return Err(table.error(missing(name, theta, azimuth, nm).into()));
                    }
                }
            }
        }
        Ok(())
    }
}

/// Returns the error about a point without a row.
fn missing(name: &str, theta: f64, phi: Option<f64>, nm: f64) -> Diagnostic {
    match phi {
        None => Diagnostic::new(format!("state `{name}` has no row for {theta} deg and {nm} nm"))
            .expected("a row for every wavelength at every angle of every state")
            .hint("add the row, or remove the wavelength or the angle from all states"),
        Some(phi) => {
            Diagnostic::new(format!("state `{name}` has no row for {theta} deg, azimuth {phi} deg and {nm} nm"))
                .expected("a row for every wavelength at every angle and azimuth of every state (at 0 deg, one azimuth suffices)")
                .hint("add the row, or remove the wavelength, the angle or the azimuth from all states")
        }
    }
}

/// Returns the distinct values in ascending order.
fn axis(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    values
}
