//! Spectra: wavelength and value, in a table or in the files of instruments.

use std::ops::{Range, RangeInclusive};

use papilio_diagnostics::{Diagnostic, Warned};
use papilio_spectra::Tabulated;

use crate::error::{FormatError, Problem};
use crate::file::DataFile;
use crate::instrument::{self, Kind, Source, SpectralFile};
use crate::table::quantities::{FRACTION, LIGHT, WAVELENGTH};
use crate::table::{Column, Header, Quantity, Row, TableText, Unit, body};

/// Range of the largest value of a source's spectrum. The scale has no meaning, but
/// the squares of the values must remain finite.
const SOURCE_MAXIMUM: RangeInclusive<f64> = 1e-30..=1e30;

/// Largest negative value that is taken for the noise of a dark signal, relative to the largest value (or to
/// 1).
const NOISE: f64 = 0.02;

/// Wavelengths of the visible range, nm; the noise of an instrument at its ends has no meaning.
const VISIBLE_NM: RangeInclusive<f64> = 380.0..=780.0;

/// Reads a spectrum: wavelength and value.
///
/// A table has the columns that its header names, in any order and with their units (`wavelength_nm,value`),
/// or without a header wavelength in nm, value. `#` comments are permitted. Columns are separated by commas,
/// semicolons, tabs or blanks. Wavelengths increase or decrease. The [files of instruments](crate#) are read
/// too.
///
/// # Errors
/// With line and column: columns that are not understood, cells that are not finite numbers, rows without two
/// columns, wavelengths out of order or probably in micrometres.
///
/// ```
/// # use papilio_formats::{DataFile, read_spectrum};
/// let file = DataFile { name: "r.csv".into(), bytes: b"R,wavelength_um\n0.1,0.4\n0.3,0.5\n".to_vec() };
/// assert_eq!(read_spectrum(&file)?.at(450.0).unwrap(), 0.2);
/// # Ok::<(), papilio_formats::FormatError>(())
/// ```
pub fn read_spectrum(file: &DataFile) -> Result<Tabulated, FormatError> {
    points(file, &[&FRACTION, &LIGHT])?.tabulated().map(|read| read.value)
}

/// Reads a spectrum of fractions, each from 0 to 1: a reflectance, an absorptance or a transmittance. Small
/// negative values are noise, and are taken as 0 with a note.
///
/// # Errors
/// As [`read_spectrum`], and for values out of range, with their line.
pub fn read_fractions(file: &DataFile) -> Result<Tabulated, FormatError> {
    read_fractions_with_notes(file).map(|read| read.value)
}

/// Reads a spectrum as [`read_fractions`], with notes on how the file was read.
///
/// # Errors
/// As [`read_fractions`].
pub fn read_fractions_with_notes(file: &DataFile) -> Result<Warned<Tabulated>, FormatError> {
    let mut points = points(file, &[&FRACTION])?;
    points.must_be(
        &[Kind::Reflectance, Kind::Transmittance, Kind::Absorptance],
        "a reflectance or a transmittance",
    )?;
    points.drop_noise(1.0);
    points.refuse_values(0.0..=1.0, "the fraction", "a number from 0 to 1")?;
    points.tabulated()
}

/// Reads the relative spectrum of a light source: values of 0 or more, the largest between 1e-30 and 1e30.
/// Small negative values are noise, and are taken as 0.
///
/// # Errors
/// As [`read_spectrum`], and for values out of range, with their line.
pub fn read_light(file: &DataFile) -> Result<Tabulated, FormatError> {
    read_light_with_notes(file).map(|read| read.value)
}

/// Reads a spectrum as [`read_light`], with notes on how the file was read.
///
/// # Errors
/// As [`read_light`].
pub fn read_light_with_notes(file: &DataFile) -> Result<Warned<Tabulated>, FormatError> {
    let mut points = points(file, &[&LIGHT])?;
    points.must_be(&[Kind::Light], "a light")?;
    let largest = points.all.iter().map(|point| point.value).fold(0.0, f64::max);
    points.drop_noise(largest);
    points.refuse_values(0.0..=*SOURCE_MAXIMUM.end(), "the spectral value", "a number from 0 to 1e30")?;
    let light = points.tabulated()?;
    if SOURCE_MAXIMUM.contains(&largest) {
        return Ok(light);
    }
    let problem = Problem::OutOfRange {
        what: "the largest value of the spectrum",
        value: largest,
        expected: "a largest value between 1e-30 and 1e30",
    };
    Err(FormatError::whole(&file.name, problem))
}

/// A point of a spectrum.
struct Point {
    nm: f64,
    value: f64,
    /// Row of a table, for errors.
    row: usize,
    /// Place of the value in the file of an instrument, bytes.
    at: Range<usize>,
}

/// The points of a spectrum as they stand in the file.
struct Points<'a> {
    file: &'a DataFile,
    all: Vec<Point>,
    /// The quantity that the format of an instrument states.
    kind: Kind,
    /// Columns of wavelength and value, if the file is a table.
    columns: Option<[Column; 2]>,
    notes: Vec<String>,
}

/// Reads the points of a table, whose value is one of `values`, or of the only sample of a file of an
/// instrument.
fn points<'a>(file: &'a DataFile, values: &[&'static Quantity]) -> Result<Points<'a>, FormatError> {
    if let Some(mut read) = instrument::read(file)? {
        if read.kind == Kind::Unstated && !values.contains(&&LIGHT) {
            read.divide_per_cent();
        }
        return of_instrument(file, read);
    }
    let text = TableText::new(file)?;
    let table = text.table();
    let accepted = [&[&WAVELENGTH], values].concat();
    let value_of = |header: &Header| values.iter().find_map(|value| header.get(value));
    let missing = "a column of wavelengths (`wavelength_nm`) and one of values (`value`)";
    let found = body(
        table,
        &accepted,
        |header| header.get(&WAVELENGTH).is_some() && value_of(header).is_some(),
        missing,
    )?;
    let mut notes = Vec::new();
    let (columns, count, expected) = match (found.header, &found.head) {
        (Some(mut header), Some(head)) => {
            header.refuse_others(head, &accepted)?;
            let columns = header.get(&WAVELENGTH).zip(value_of(&header));
            let (nm, value) = columns.ok_or_else(|| head.error(Problem::MissingColumn { missing }))?;
            check_density(head, nm, value)?;
            notes.append(&mut header.notes);
            if value.unit == Some(Unit::Counts) {
                notes.push(
                    "counts of a detector are a spectrum of light only if its sensitivity is corrected for"
                        .to_owned(),
                );
            }
            ([nm, value], header.count, "as many columns as the header")
        }
        _ => {
            let value = values.first().copied().unwrap_or(&FRACTION);
            ([Column::at(0, &WAVELENGTH), Column::at(1, value)], 2, "two columns: wavelength in nm, value")
        }
    };
    let mut all = Vec::with_capacity(found.rows.len());
    for (k, row) in found.rows.iter().enumerate() {
        row.expect_cells(count, expected)?;
        all.push(Point { nm: columns[0].number(row)?, value: columns[1].number(row)?, row: k, at: 0..0 });
    }
    Ok(Points { file, all, kind: Kind::Unstated, columns: Some(columns), notes })
}

/// A spectrum of light over photon energies or wavenumbers may be a density per eV or per nm, which differ.
fn check_density(head: &Row<'_>, nm: Column, value: Column) -> Result<(), FormatError> {
    let is_length = matches!(nm.unit, None | Some(Unit::Length(_)));
    if is_length || !std::ptr::eq(value.quantity, &LIGHT) {
        return Ok(());
    }
    let wrong =
        Diagnostic::new("this spectrum of light is given over photon energy, wavenumber or frequency")
            .expected("a wavelength")
            .hint(
                "power per eV (or per cm-1) is not power per nm: multiply the values by the square of the energy, and convert the \
                 energies to wavelengths (1239.84 nm eV)",
            );
    Err(head.cell_error(nm.cell, wrong.into()))
}

fn of_instrument(file: &DataFile, mut read: SpectralFile) -> Result<Points<'_>, FormatError> {
    let text = TableText::new(file)?;
    let source = Source { name: &file.name, text: text.table().text, format: read.format };
    if read.samples.len() > 1 {
        let names: Vec<&str> = read.samples.iter().take(6).map(|sample| sample.name.as_str()).collect();
        let more = if read.samples.len() > names.len() { ", ..." } else { "" };
        let count = read.samples.len();
        let what = format!("it has {count} samples ({}{more}); keep one of them", names.join(", "));
        return Err(source.at(read.samples[1].at.clone(), what));
    }
    let Some(sample) = read.samples.pop().filter(|sample| !sample.spectrum.is_empty()) else {
        return Err(source.whole("it has no spectrum"));
    };
    let all = sample.spectrum.into_iter().map(|(nm, value, at)| Point { nm, value, row: 0, at }).collect();
    Ok(Points { file, all, kind: read.kind, columns: None, notes: read.notes })
}

impl Points<'_> {
    /// Fails if the file of an instrument states another quantity.
    fn must_be(&self, kinds: &[Kind], expected: &'static str) -> Result<(), FormatError> {
        if self.kind != Kind::Unstated && !kinds.contains(&self.kind) {
            let found = match self.kind {
                Kind::Light => "a light",
                Kind::Reflectance => "a reflectance",
                Kind::Transmittance => "a transmittance",
                Kind::Absorptance => "an absorptance",
                Kind::Unstated => "another quantity",
            };
            let wrong = Diagnostic::new(format!("this file holds {found}")).expected(expected);
            return Err(FormatError::whole(&self.file.name, wrong));
        }
        Ok(())
    }

    /// Sets negative values that are noise to 0, with a note.
    fn drop_noise(&mut self, scale: f64) {
        let is_noise = |point: &&mut Point| {
            point.value < 0.0 && (point.value >= -NOISE * scale || !VISIBLE_NM.contains(&point.nm))
        };
        let (mut count, mut least) = (0, 0.0_f64);
        for point in self.all.iter_mut().filter(is_noise) {
            count += 1;
            least = least.min(point.value);
            point.value = 0.0;
        }
        if count > 0 {
            let values = if count == 1 { "value is" } else { "values are" };
            self.notes
                .push(format!("{count} negative {values} taken as 0 (noise; the lowest was {least:.3e})"));
        }
    }

    /// Fails at the first value outside a range.
    fn refuse_values(
        &self,
        range: RangeInclusive<f64>,
        what: &'static str,
        expected: &'static str,
    ) -> Result<(), FormatError> {
        match self.all.iter().find(|point| !range.contains(&point.value)) {
            Some(point) => {
                let problem = Problem::OutOfRange { what, value: point.value, expected };
                Err(self.error(point, 1, problem))
            }
            None => Ok(()),
        }
    }

    /// Returns an error at the wavelength (0) or the value (1) of a row, or at the value in the file of an
    /// instrument.
    fn error(&self, point: &Point, column: usize, problem: Problem) -> FormatError {
        let whole = |problem| FormatError::whole(&self.file.name, problem);
        let Ok(text) = TableText::new(self.file) else { return whole(problem) };
        let Some(columns) = self.columns else {
            return if point.at.is_empty() {
                whole(problem)
            } else {
                text.table().error_at(point.at.clone(), problem)
            };
        };
        let accepted = [columns[0].quantity, columns[1].quantity];
        let found = body(text.table(), &accepted, |header| header.columns.len() == 2, "");
        match found.as_ref().ok().and_then(|body| body.rows.get(point.row)) {
            Some(row) => row.cell_error(columns[column].cell, problem),
            None => whole(problem),
        }
    }

    fn tabulated(self) -> Result<Warned<Tabulated>, FormatError> {
        let mut columns = Columns::<1>::default();
        for point in &self.all {
            columns.add(point.nm, [point.value]).map_err(|problem| self.error(point, 0, problem))?;
        }
        let whole = |problem| FormatError::whole(&self.file.name, problem);
        let [value] = columns.finish().map_err(whole)?;
        let warnings = self.notes.into_iter().chain(missing(value.wavelengths_nm())).collect();
        Ok(Warned { value, warnings })
    }
}

/// Note on wavelengths that a spectrum seems to lack: a step of more than 50 nm, and of three times the usual one, where the eye sees.
pub(crate) fn missing(wavelengths_nm: &[f64]) -> Option<String> {
    const VISIBLE_NM: std::ops::Range<f64> = 400.0..700.0;
    let steps = || wavelengths_nm.windows(2).map(|pair| (pair[1] - pair[0], pair));
    let mut all: Vec<f64> = steps().map(|(step, _)| step).collect();
    all.sort_by(f64::total_cmp);
    let usual = *all.get(all.len() / 2)?;
    let is_gap = |(step, pair): &(f64, &[f64])| {
        *step > f64::max(50.0, 3.0 * usual) && pair[0] < VISIBLE_NM.end && pair[1] > VISIBLE_NM.start
    };
    steps().find(is_gap).map(|(_, pair)| {
        format!(
            "there are no values between {} and {} nm: the spectrum is interpolated there",
            pair[0], pair[1]
        )
    })
}

/// Wavelengths and `N` columns of values.
pub(crate) struct Columns<const N: usize> {
    nm: Vec<f64>,
    values: [Vec<f64>; N],
}

impl<const N: usize> Default for Columns<N> {
    fn default() -> Self {
        Self { nm: Vec::new(), values: std::array::from_fn(|_| Vec::new()) }
    }
}

impl<const N: usize> Columns<N> {
    /// Adds a wavelength and its values. All wavelengths must increase, or all decrease, as the first two do.
    pub(crate) fn add(&mut self, nm: f64, values: [f64; N]) -> Result<(), Problem> {
        if nm <= 0.0 || !nm.is_finite() {
            let expected = "a wavelength above 0";
            return Err(Problem::OutOfRange { what: "a wavelength", value: nm, expected });
        }
        if let Some(&before) = self.nm.last() {
            let reverses = self.nm.len() > 1 && (nm < before) != self.is_descending();
            if nm == before || reverses {
                return Err(Problem::OutOfOrder { nm, before });
            }
        }
        self.nm.push(nm);
        for (column, value) in self.values.iter_mut().zip(values) {
            column.push(value);
        }
        Ok(())
    }

    fn is_descending(&self) -> bool {
        self.nm.len() > 1 && self.nm[1] < self.nm[0]
    }

    /// Returns the columns of a file as tables; wavelengths that are probably in micrometres are an error.
    pub(crate) fn finish(self) -> Result<[Tabulated; N], Problem> {
        // Optical data of displays do not end at 30 nm; tables in um often end at 2 um.
        if !self.nm.is_empty() && self.nm.iter().all(|nm| *nm < 30.0) {
            return Err(Problem::Micrometres);
        }
        self.into_tables()
    }

    /// Returns the columns as tables with ascending wavelengths.
    pub(crate) fn into_tables(mut self) -> Result<[Tabulated; N], Problem> {
        if self.is_descending() {
            self.nm.reverse();
            self.values.iter_mut().for_each(|column| column.reverse());
        }
        if self.nm.len() < 2 {
            return Err(Problem::TooFew { rows: self.nm.len() });
        }
        let mut tables = Vec::with_capacity(N);
        for column in self.values {
            tables.push(Tabulated::new(self.nm.clone(), column)?);
        }
        tables.try_into().map_err(|_| Problem::TooFew { rows: 0 })
    }
}
