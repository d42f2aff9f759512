//! Measured states of a panel: spectra or colours, in the tables and files that instruments write.
//!
//! A table has one row for each state, direction and wavelength
//! (`state,theta_deg,wavelength_nm,reflectance_factor`), one row for each state and direction with a colour
//! (`state,theta_deg,X,Y,Z` or `state,L,a,b`), a column for each state (`wavelength_nm,white,black`), or a
//! column for each wavelength. Columns may have any order.

use std::collections::{HashMap, HashSet};
use std::ops::Range;
use std::path::Path;

use papilio_colour::Standard;
use papilio_diagnostics::{Diagnostic, Place};
use papilio_display::compare::StandardDeviation;
use papilio_spectra::Tabulated;

use crate::error::{FormatError, Problem};
use crate::file::DataFile;
use crate::instrument::{self, Kind, SpectralFile};
use crate::is_name;
use crate::pixel_table::NM;
use crate::spectrum::missing;
use crate::table::quantities::{
    A_STAR, ABSORBANCE, B_STAR, EPS_1, EPS_2, K, L_STAR, LIGHT, N, PHI, REFLECTANCE, STANDARD_DEVIATION,
    STATE, THETA, WAVELENGTH, X, Y, Z,
};
use crate::table::{Column, ColumnName, Header, Quantity, Row, Table, TableText, body};

/// A measured state.
#[derive(Debug)]
pub(crate) struct State {
    pub(crate) name: String,
    /// Inclination of the meter, degrees, if the file states it.
    pub(crate) theta_deg: Option<f64>,
    /// Azimuth of the meter, degrees.
    pub(crate) phi_deg: f64,
    pub(crate) value: Value,
    /// Standard deviation of the value, if the file states it.
    pub(crate) deviation: Option<StandardDeviation>,
}

/// What was measured.
#[derive(Debug)]
pub(crate) enum Value {
    /// Reflectance factor against wavelength.
    Spectrum(Tabulated),
    /// L\*, a\*, b\*.
    Lab([f64; 3]),
    /// X, Y, Z relative to a perfect white (Y = 1).
    Xyz([f64; 3]),
}

/// The measured states of a file, in the order of their first rows, and notes on how it was read.
#[derive(Debug)]
pub(crate) struct States {
    pub(crate) states: Vec<State>,
    /// Observer of the colours, if the file states it.
    pub(crate) observer: Option<Standard>,
    /// Illuminant of the colours, if the file states it.
    pub(crate) illuminant: Option<String>,
    pub(crate) notes: Vec<String>,
}

/// What a reader accepts.
pub(crate) struct Accept {
    /// Least and largest reflectance factor. Values below 0 and above the least are kept if it is negative.
    pub(crate) factor: (f64, f64),
    /// The largest factor, in words.
    pub(crate) factor_in_words: &'static str,
    /// Whether X, Y, Z are accepted.
    pub(crate) xyz: bool,
    /// Error of a file without rows.
    pub(crate) empty: Problem,
    /// Error of a header without the required columns.
    pub(crate) header: Problem,
}

/// Values from here to 0 are the noise of a dark signal.
const NOISE: f64 = -0.02;

/// A panel that reflects like a mirror, or whose pixels gather light, has reflectance factors of up to about
/// this: larger ones, without a unit, are in per cent. Smaller ones above [`instrument::LARGEST_FRACTION`]
/// may be either.
const LARGEST_GAIN: f64 = 10.0;

/// Reads the states of a file.
///
/// # Errors
/// With line and column: columns that are not understood or missing, cells that are not numbers or out of
/// range, two values for the same point, a spectrum with a single wavelength, names that are not permitted.
pub(crate) fn read_states(file: &DataFile, accept: &Accept) -> Result<States, FormatError> {
    let points = match instrument::read(file)? {
        Some(read) => Points::of_instrument(file, read)?,
        None => {
            let text = TableText::new(file)?;
            Points::of_table(text.table(), accept)?
        }
    };
    points.finish(file, accept)
}

/// Values of a state in a direction, and the places of their cells.
struct Point {
    name: String,
    theta_deg: Option<f64>,
    phi_deg: f64,
    /// Wavelengths in nm, values, and their places.
    spectrum: Vec<(f64, f64, Range<usize>)>,
    /// Standard deviation at each of the wavelengths, if the file states it.
    spectrum_deviation: Vec<f64>,
    lab: Option<[f64; 3]>,
    xyz: Option<[f64; 3]>,
    /// Standard deviations of the three numbers of a colour, if the file states them.
    colour_deviation: Option<[f64; 3]>,
    /// Its first row.
    at: Range<usize>,
}

/// Numbers of the points by state and direction.
type Numbers = HashMap<(String, Option<u64>, u64), usize>;

impl Point {
    /// A point without values.
    fn new(name: String, at: Range<usize>) -> Self {
        let (spectrum, spectrum_deviation) = (Vec::new(), Vec::new());
        let (theta_deg, lab, xyz, colour_deviation) = (None, None, None, None);
        Self { name, theta_deg, phi_deg: 0.0, spectrum, spectrum_deviation, lab, xyz, colour_deviation, at }
    }

    fn set_colour(&mut self, values: &Values, row: &Row<'_>, accept: &Accept) -> Result<(), FormatError> {
        match values {
            Values::Xyz(columns) => {
                let expected = "a number from 0 to 1e4, where 1 is a perfect white";
                let [x, y, z] = columns.map(|c| c.number_within(row, c.quantity.what, (0.0, 1e4), expected));
                self.xyz = Some([x?, y?, z?]);
            }
            Values::Lab([l, a, b]) => {
                // Above 100 what reflects more than a perfect white.
                let (lightness, expected) = match accept.xyz {
                    true => ((0.0, 1e3), "a lightness from 0 to 1000, where 100 is a perfect white"),
                    false => ((0.0, 100.0), "a lightness from 0 to 100"),
                };
                let l = l.number_within(row, "L*", lightness, expected)?;
                let expected = "a number from -200 to 200";
                let a = a.number_within(row, "a*", (-200.0, 200.0), expected)?;
                self.lab = Some([l, a, b.number_within(row, "b*", (-200.0, 200.0), expected)?]);
            }
            Values::Spectrum(..) | Values::Columns(..) => {}
        }
        Ok(())
    }
}

struct Points {
    all: Vec<Point>,
    notes: Vec<String>,
    /// Observer of the colours, if the file states it.
    observer: Option<Standard>,
    /// Illuminant of the colours, if the file states it.
    illuminant: Option<String>,
}

static ACCEPTED: [&Quantity; 12] = [
    &STATE,
    &THETA,
    &PHI,
    &WAVELENGTH,
    &REFLECTANCE,
    &X,
    &Y,
    &Z,
    &L_STAR,
    &A_STAR,
    &B_STAR,
    &STANDARD_DEVIATION,
];

/// The columns of values.
enum Values {
    Spectrum(Column, Column),
    Xyz([Column; 3]),
    Lab([Column; 3]),
    /// Wavelength, and cells and names of the states.
    Columns(Column, Vec<(Column, String)>),
}

impl Values {
    fn of(header: &Header, accept: &Accept) -> Option<Self> {
        let three = |all: [&'static Quantity; 3]| {
            let [a, b, c] = all.map(|quantity| header.get(quantity));
            Some([a?, b?, c?])
        };
        let nm = header.get(&WAVELENGTH);
        if header.get(&STATE).is_some() {
            let spectrum = nm.zip(header.get(&REFLECTANCE)).map(|(nm, factor)| Self::Spectrum(nm, factor));
            let xyz = || three([&X, &Y, &Z]).filter(|_| accept.xyz).map(Self::Xyz);
            return spectrum.or_else(xyz).or_else(|| three([&L_STAR, &A_STAR, &B_STAR]).map(Self::Lab));
        }
        let states = state_columns(header);
        let is_one_value = header.get(&REFLECTANCE).is_some() && states.len() == 1;
        // A table of n and k has no states, although a state may be called `K`.
        let others = [&N, &K, &EPS_1, &EPS_2, &ABSORBANCE, &LIGHT];
        let is_other = |name: &ColumnName| others.iter().any(|other| name.is_one_of(other.names, false));
        if states.iter().all(|(_, name)| is_other(&ColumnName::new(name))) {
            return None;
        }
        nm.filter(|_| !states.is_empty() && !is_one_value).map(|nm| Self::Columns(nm, states))
    }
}

impl Values {
    /// Returns a note on the columns of other values of the states than these.
    fn unused(&self, header: &Header) -> Option<String> {
        let (used, read): (&[&Quantity], _) = match self {
            Self::Spectrum(..) => (&[&WAVELENGTH, &REFLECTANCE], "the spectra are read"),
            Self::Xyz(_) => (&[&X, &Y, &Z], "X, Y, Z are read"),
            Self::Lab(_) => (&[&L_STAR, &A_STAR, &B_STAR], "L*, a*, b* are read"),
            Self::Columns(..) => return None,
        };
        let is_in =
            |all: &[&Quantity], one: &Column| all.iter().any(|other| std::ptr::eq(*other, one.quantity));
        let all = [&WAVELENGTH, &REFLECTANCE, &X, &Y, &Z, &L_STAR, &A_STAR, &B_STAR];
        let others = header.columns.iter().filter(|one| is_in(&all, one) && !is_in(used, one));
        let names: Vec<&str> = others.map(|one| header.names[one.cell].trim()).collect();
        let are = if names.len() == 1 { "is" } else { "are" };
        (!names.is_empty()).then(|| {
            format!(
                "the column{} {} {are} not used: {read}",
                if names.len() == 1 { "" } else { "s" },
                names.join(", ")
            )
        })
    }
}

/// Returns the columns that are not angles or wavelengths, with their names without units.
fn state_columns(header: &Header) -> Vec<(Column, String)> {
    let of_known = header.columns.iter().filter(|column| {
        [&WAVELENGTH, &THETA, &PHI, &STANDARD_DEVIATION]
            .iter()
            .all(|other| !std::ptr::eq(column.quantity, *other))
    });
    let known = of_known.map(|column| column.cell);
    let mut cells: Vec<usize> = known.chain(header.others.iter().map(|other| other.cell)).collect();
    cells.sort_unstable();
    let column = |cell: usize| {
        let name = ColumnName::new(&header.names[cell]);
        let unit = name.unit.clone().and_then(Result::ok).filter(|unit| unit.fits(REFLECTANCE.dimension));
        let text = if unit.is_some() { name.text } else { header.names[cell].trim().to_owned() };
        (Column { unit, ..Column::at(cell, &REFLECTANCE) }, text)
    };
    cells.into_iter().map(column).filter(|(_, name)| !name.is_empty()).collect()
}

impl Points {
    fn of_table(table: Table<'_>, accept: &Accept) -> Result<Self, FormatError> {
        let is_complete = |header: &Header| Values::of(header, accept).is_some();
        // A palette has no directions, no X, Y, Z, and no deviations.
        let of_panel: [&Quantity; 6] = [&THETA, &PHI, &X, &Y, &Z, &STANDARD_DEVIATION];
        let is_of_panel = |one: &Quantity| of_panel.iter().any(|other| std::ptr::eq(*other, one));
        let accepted = ACCEPTED.iter().copied().filter(|one| accept.xyz || !is_of_panel(one));
        let found = body(table, &accepted.collect::<Vec<_>>(), is_complete, "a required column");
        let (mut header, head, rows) = match found {
            Ok(found) => match (found.header, found.head) {
                (Some(header), Some(head)) => (header, head, found.rows),
                _ => return Err(no_header(table, accept)),
            },
            Err(error) if matches!(error.problem, Problem::MissingColumn { .. }) => {
                return Err(no_header(table, accept));
            }
            Err(error) => return Err(error),
        };
        let values = Values::of(&header, accept).ok_or_else(|| head.error(accept.header.clone()))?;
        if !matches!(values, Values::Columns(..)) && !is_own(&head) {
            header.note_others();
            header.notes.extend(values.unused(&header));
        }
        if let (Values::Columns(_, states), Some(deviation)) = (&values, header.get(&STANDARD_DEVIATION))
            && states.len() > 1
        {
            let wrong = Diagnostic::new("the column of standard deviations does not tell of which state they are")
                .expected("one column of values beside it")
                .hint("write a row for each state and wavelength: `state,wavelength_nm,reflectance_factor,standard_deviation`");
            return Err(head.cell_error(deviation.cell, wrong.into()));
        }
        let notes = std::mem::take(&mut header.notes);
        let has_own_unit = header.get(&STANDARD_DEVIATION).is_some_and(|column| column.unit.is_some());
        let mut points = Self { all: Vec::new(), notes, observer: None, illuminant: None };
        let mut by_name = HashMap::new();
        for row in &rows {
            points.push(&header, &values, row, (accept, &mut by_name))?;
        }
        // Values of Papilio's own tables have their scale.
        let has_no_unit = match &values {
            Values::Columns(_, states) => states.iter().all(|(column, _)| column.unit.is_none()),
            Values::Spectrum(_, factor) => factor.unit.is_none() && !is_own(&head),
            Values::Xyz(columns) => columns.iter().all(|column| column.unit.is_none()) && !is_own(&head),
            Values::Lab(_) => false,
        };
        if has_no_unit {
            points.divide_per_cent(&head, accept, has_own_unit)?;
        }
        Ok(points)
    }

    fn push(
        &mut self,
        header: &Header,
        values: &Values,
        row: &Row<'_>,
        (accept, by_name): (&Accept, &mut Numbers),
    ) -> Result<(), FormatError> {
        row.expect_cells(header.count, "as many columns as the header")?;
        let angle = |quantity: &'static Quantity, what, most: f64, expected| {
            let column = header.get(quantity);
            column.map(|column| column.number_within(row, what, (-most, most), expected)).transpose()
        };
        let theta_deg = angle(&THETA, "an angle", 90.0, "an angle from -90 to 90 deg")?;
        let phi_deg = angle(&PHI, "an azimuth", 360.0, "an azimuth from -360 to 360 deg")?.unwrap_or(0.0);
        let direction = (theta_deg, phi_deg);
        let wavelength =
            |column: &Column| column.number_within(row, "a wavelength", NM, "a wavelength in nm, 30 to 1e6");
        if let Values::Columns(nm, states) = values {
            let nm = wavelength(nm)?;
            for (column, name) in states {
                let (number, _) = self.number_of(name, direction, (row, column.cell), by_name)?;
                let value = column.number(row)?;
                self.all[number].spectrum.push((nm, value, row.cells[column.cell].bytes()));
                self.all[number].spectrum_deviation.extend(deviation(header, column, row)?);
            }
            return Ok(());
        }
        let Some(state) = header.get(&STATE) else { return Ok(()) };
        let (number, is_known) = self.number_of(state.text(row), direction, (row, state.cell), by_name)?;
        if let Values::Spectrum(nm, factor) = values {
            let (nm, value) = (wavelength(nm)?, factor.number(row)?);
            self.all[number].spectrum.push((nm, value, row.cells[factor.cell].bytes()));
            self.all[number].spectrum_deviation.extend(deviation(header, factor, row)?);
            return Ok(());
        }
        self.all[number].set_colour(values, row, accept)?;
        if let Values::Xyz([first, ..]) | Values::Lab([first, ..]) = values {
            self.all[number].colour_deviation = deviation(header, first, row)?.map(|one| [one; 3]);
        }
        if is_known {
            return Err(row.error(two_values(&self.all[number].name, theta_deg, None)));
        }
        Ok(())
    }

    /// Returns the number of the point of a state in a direction, and whether it is known from another row.
    fn number_of(
        &mut self,
        name: &str,
        (theta_deg, phi_deg): (Option<f64>, f64),
        (row, cell): (&Row<'_>, usize),
        by_name: &mut Numbers,
    ) -> Result<(usize, bool), FormatError> {
        if !is_name(name) {
            return Err(row.cell_error(cell, Problem::BadName));
        }
        let key = (name.to_owned(), theta_deg.map(f64::to_bits), phi_deg.to_bits());
        let next = self.all.len();
        let number = *by_name.entry(key).or_insert(next);
        if number == next {
            let (name, at) = (name.to_owned(), row.bytes());
            self.all.push(Point { theta_deg, phi_deg, ..Point::new(name, at) });
        }
        Ok((number, number != next))
    }

    fn of_instrument(file: &DataFile, mut read: SpectralFile) -> Result<Self, FormatError> {
        if matches!(read.kind, Kind::Light) {
            let wrong = Diagnostic::new("this file holds a light").expected("reflectances of states");
            return Err(FormatError { place: Place::whole(&file.name), problem: wrong.into() });
        }
        if read.kind == Kind::Unstated {
            read.divide_per_cent();
        }
        if let [only] = &mut read.samples[..]
            && only.name.is_empty()
            && let Some(stem) = Path::new(&file.name).file_stem().and_then(|stem| stem.to_str())
        {
            stem.clone_into(&mut only.name);
            read.notes.push(format!("the state is called `{stem}`, as its file: the spectrum has no name"));
        }
        let has_spectra = read.samples.iter().all(|sample| !sample.spectrum.is_empty());
        let point = |sample: instrument::Sample| Point {
            theta_deg: sample.theta_deg,
            phi_deg: sample.phi_deg.unwrap_or(0.0),
            spectrum: match has_spectra {
                true => sample.spectrum,
                false => Vec::new(),
            },
            lab: sample.lab,
            xyz: sample.xyz,
            colour_deviation: sample.deviation,
            ..Point::new(sample.name, sample.at)
        };
        let all = read.samples.into_iter().map(point).collect();
        Ok(Self { all, notes: read.notes, observer: read.observer, illuminant: read.illuminant })
    }

    /// Divides reflectances in per cent, or X, Y, Z of which white has Y = 100, by 100, with a note: columns
    /// that state no unit. Standard deviations that have a unit of their own are not concerned.
    fn divide_per_cent(
        &mut self,
        head: &Row<'_>,
        accept: &Accept,
        has_own_unit: bool,
    ) -> Result<(), FormatError> {
        let mut values: Vec<&mut f64> = Vec::new();
        for point in &mut self.all {
            values.extend(point.spectrum.iter_mut().map(|point| &mut point.1));
            values.extend(point.xyz.iter_mut().flatten());
        }
        let largest = values.iter().fold(0.0_f64, |most, value| most.max(**value));
        if largest <= instrument::LARGEST_FRACTION {
            return Ok(());
        }
        if largest <= LARGEST_GAIN && accept.factor.1 > 1.0 {
            let problem = Diagnostic::new(format!(
                "the values reach {largest}, and no column states whether a perfect white is 1 or 100"
            ))
            .expected("values of which a perfect white is 1, or a unit")
            .hint("write the unit in the names of the columns, such as `Y (1)` or `Y (%)`; without one, values above 10 are read as per cent");
            return Err(head.error(problem.into()));
        }
        values.into_iter().for_each(|value| *value /= 100.0);
        for point in self.all.iter_mut().filter(|_| !has_own_unit) {
            let colour = point.colour_deviation.iter_mut().flatten();
            point.spectrum_deviation.iter_mut().chain(colour).for_each(|one| *one /= 100.0);
        }
        self.notes.push(instrument::percent_note(largest));
        Ok(())
    }

    fn finish(mut self, file: &DataFile, accept: &Accept) -> Result<States, FormatError> {
        let error = |at: &Range<usize>, state: &str, problem: Problem| {
            let text = TableText::new(file).ok().filter(|_| !at.is_empty());
            match text {
                Some(text) => text.table().error_at(at.clone(), problem),
                None => {
                    let place = Place::whole(&format!("{}, sample `{state}`", file.name));
                    FormatError { place, problem }
                }
            }
        };
        if self.all.is_empty() {
            return Err(FormatError { place: Place::whole(&file.name), problem: accept.empty.clone() });
        }
        let (mut states, mut noise) = (Vec::new(), 0);
        // Names of states of a panel that differ in capital letters alone are one state.
        let in_small = |name: &str| if accept.xyz { name.to_lowercase() } else { name.to_owned() };
        let mut names: HashSet<(String, Option<u64>, u64)> = HashSet::new();
        for point in &self.all {
            let fault = |at: &Range<usize>, problem| Err(error(at, &point.name, problem));
            let key = (in_small(&point.name), point.theta_deg.map(f64::to_bits), point.phi_deg.to_bits());
            if point.name.is_empty() {
                let wrong =
                    Diagnostic::new("this sample has no name").expected("the name of a state of the display");
                return fault(&point.at, wrong.into());
            }
            if !is_name(&point.name) {
                return fault(&point.at, Problem::BadName);
            }
            if !names.insert(key) {
                return fault(&point.at, two_values(&point.name, point.theta_deg, None));
            }
            let value = match (point.spectrum.is_empty(), point.xyz.filter(|_| accept.xyz), point.lab) {
                (false, ..) => {
                    let (least, most) = accept.factor;
                    let mut spectrum = point.spectrum.clone();
                    for (_, value, at) in &mut spectrum {
                        if *value < 0.0 && *value >= NOISE && least == 0.0 {
                            *value = 0.0;
                            noise += 1;
                        }
                        if !(least..=most).contains(value) {
                            let (what, expected) = ("the reflectance factor", accept.factor_in_words);
                            return fault(at, Problem::OutOfRange { what, value: *value, expected });
                        }
                    }
                    let spectrum = tabulated(point, spectrum, &error)?;
                    let missing = missing(spectrum.wavelengths_nm());
                    self.notes.extend(missing.map(|note| format!("state `{}`: {note}", point.name)));
                    Value::Spectrum(spectrum)
                }
                (true, Some(xyz), _) => Value::Xyz(xyz),
                (true, None, Some(lab)) => Value::Lab(lab),
                (true, None, None) => return fault(&point.at, accept.header.clone()),
            };
            let deviation = match &value {
                Value::Spectrum(_) if point.spectrum_deviation.is_empty() => None,
                Value::Spectrum(_) => {
                    let deviations = point.spectrum.iter().zip(&point.spectrum_deviation);
                    let rows = deviations.map(|((nm, _, at), one)| (*nm, *one, at.clone())).collect();
                    Some(StandardDeviation::Spectrum(tabulated(point, rows, &error)?))
                }
                Value::Xyz(_) | Value::Lab(_) => point.colour_deviation.map(StandardDeviation::Colour),
            };
            let Point { name, theta_deg, phi_deg, .. } = point;
            let (name, theta_deg, phi_deg) = (name.clone(), *theta_deg, *phi_deg);
            states.push(State { name, theta_deg, phi_deg, value, deviation });
        }
        if noise > 0 {
            self.notes.push(format!("{noise} small negative reflectances are taken as 0 (noise)"));
        }
        Ok(States { states, notes: self.notes, observer: self.observer, illuminant: self.illuminant })
    }
}

/// Standard deviation in a row of the value in a column, whose unit it has unless it states its own; `None`
/// if the table has no such column.
fn deviation(header: &Header, of: &Column, row: &Row<'_>) -> Result<Option<f64>, FormatError> {
    let column = header.get(&STANDARD_DEVIATION);
    column
        .map(|column| {
            let column = Column { unit: column.unit.or(of.unit), step: None, ..column };
            column.number_within(
                row,
                "a standard deviation",
                (1e-9, 1e4),
                "a number above 0, from 1e-9 to 10000",
            )
        })
        .transpose()
}

fn tabulated(
    point: &Point,
    mut spectrum: Vec<(f64, f64, Range<usize>)>,
    error: &impl Fn(&Range<usize>, &str, Problem) -> FormatError,
) -> Result<Tabulated, FormatError> {
    let fault = |at: &Range<usize>, problem| error(at, &point.name, problem);
    spectrum.sort_by(|a, b| a.0.total_cmp(&b.0));
    if let Some(pair) = spectrum.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        let at = if pair[0].2.start > pair[1].2.start { &pair[0].2 } else { &pair[1].2 };
        return Err(fault(at, two_values(&point.name, point.theta_deg, Some(pair[1].0))));
    }
    if spectrum.len() < 2 {
        return Err(fault(&point.at, Problem::TooFew { rows: spectrum.len() }));
    }
    let (nm, values) = spectrum.into_iter().map(|(nm, value, _)| (nm, value)).unzip();
    Tabulated::new(nm, values).map_err(|problem| fault(&point.at, problem.into()))
}

/// The error of two values for a state, a direction (inclination in degrees, if it is stated) and, for a
/// spectrum, a wavelength in nm.
pub(crate) fn two_values(state: &str, theta_deg: Option<f64>, nm: Option<f64>) -> Problem {
    let direction = theta_deg.map_or(String::new(), |theta| format!(" at {theta} deg"));
    let at = nm.map_or(String::new(), |nm| format!(" at {nm} nm"));
    Diagnostic::new(format!("state `{state}`{direction}{at} has two values"))
        .hint("remove one of the two")
        .into()
}

/// The error of a table without a header, or whose header lacks columns.
fn no_header(table: Table<'_>, accept: &Accept) -> FormatError {
    match table.data().next() {
        Some(row) => row.error(accept.header.clone()),
        None => table.error(accept.empty.clone()),
    }
}

/// Returns whether a table is the `spectra.csv` or `states.csv` of a run, whose further columns are known.
fn is_own(head: &Row<'_>) -> bool {
    let has = |name: &str| head.cells.iter().any(|cell| cell.text == name);
    has("radiance_se") || has("Y_se") || has("Y_de") || has("reflectance_factor_de")
}
