//! Reader of CSV files with the columns `theta_i,phi_i,theta_o,phi_o[,wavelength],value`, or
//! `theta_i,theta_o,dphi[,wavelength],value` for light from one azimuth; a column `error` is not read.
//!
//! Without a column `way`, inclinations are from 0 to 180 deg from the normal of the front: above 90 deg,
//! light comes from, or goes to, the back. If the rows are all combinations of values of four axes, they form
//! a grid.

use std::collections::HashMap;
use std::ops::Range;

use papilio_goniometry::{
    Channel, Direction, Geometry, MeasuredPart, Measurement, Provenance, ScatterMode, SphericalGrid,
};

use super::angles::Angles;
use super::text::{Lines, Text};
use super::{BsdfFile, BsdfProblem, MOST_CELLS};
use crate::error::{FormatError, Problem};
use crate::file::DataFile;
use crate::table::quantities::{
    BSDF, CHANNEL, D_PHI, ERROR, LIGHT, PHI_I, PHI_O, REMARK, THETA_I, THETA_O, WAVELENGTH, WAY,
};
use crate::table::rounding;
use crate::table::{self, Dialect, Dimension, Header, Quantity, Row, Table, Unit};

/// The column with the meaning of a name, in its unit.
type Meaning = fn(Option<Unit>) -> Column;

/// Name of the format.
pub(super) const NAME: &str = "CSV";

/// Largest number of values; sorting them into pairs of directions takes some hundred bytes each.
const MOST_ROWS: usize = 10_000_000;

/// Number of lines among which the header is searched.
const FIRST_LINES: usize = 60;

/// Quantity of a column.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Column {
    ScatterMode,
    /// One of the four angles of a row, with its unit if it is stated.
    Angle(usize, Option<Unit>),
    /// The name of a channel, or a wavelength in this unit (nm if it is not stated).
    Channel(Option<Unit>),
    Value,
    /// What is not read: an uncertainty, a remark.
    Other,
}

/// Names of the angles, in messages.
const ANGLES: [&str; 4] = ["theta_i", "phi_i", "theta_o", "phi_o"];

static ACCEPTED: [&Quantity; 12] =
    [&THETA_I, &PHI_I, &THETA_O, &PHI_O, &D_PHI, &CHANNEL, &WAVELENGTH, &BSDF, &WAY, &ERROR, &REMARK, &LIGHT];

const MISSING: &str =
    "the columns theta_i, phi_i, theta_o, phi_o (or theta_i, theta_o, dphi) and a value: bsdf, brdf or btdf";

/// Layout of the rows.
struct Layout {
    separator: Option<u8>,
    columns: Vec<Column>,
    has_header: bool,
    /// The part that the name of the value column states.
    way: Option<ScatterMode>,
    notes: Vec<String>,
}

pub(super) fn is_table(file: &DataFile) -> bool {
    find(file).is_some()
}

/// Returns the table of a file, the layout, and the line with which it begins: the header, or the first row
/// of numbers.
fn find(file: &DataFile) -> Option<(Text<'_>, Layout, Range<usize>)> {
    let (text, table) = table_of(file)?;
    let mut lines = Lines::new(text);
    for k in 0..FIRST_LINES {
        let line = lines.next().ok()??;
        if let Some(mut layout) = Layout::of(&table.row_at(line.clone())) {
            // Numbers below lines of text are those of another format.
            if k > 0 && !layout.has_header {
                return None;
            }
            if k > 0 {
                layout.notes.push("the lines above the names of the columns are not read".to_owned());
            }
            return Some((text, layout, line));
        }
    }
    None
}

/// Returns the text of a file with its dialect; `None` if it is not UTF-8.
pub(super) fn table_of(file: &DataFile) -> Option<(Text<'_>, Table<'_>)> {
    let text = Text::new(file);
    let content = std::str::from_utf8(text.bytes).ok()?;
    let dialect = Dialect::of(content);
    let text = Text { decimal_comma: dialect.decimal_comma, ..text };
    Some((text, Table { name: &file.name, text: content, dialect }))
}

/// Returns the error about a file that is probably a table of this kind, but whose header is not understood.
pub(super) fn refusal(file: &DataFile) -> Option<FormatError> {
    let (_, table) = table_of(file)?;
    // A key of a scenario is no header: `incidence_deg = [0, 60]` names nothing else.
    let names = |row: &Row<'_>, quantity: &Quantity| {
        let is_name = |text: &str| table::ColumnName::new(text).is_one_of(quantity.names, quantity.with_case);
        row.cells.iter().any(|cell| is_name(&cell.text))
    };
    let is_header = |row: &Row<'_>| {
        let known = ACCEPTED[..9].iter().filter(|quantity| names(row, quantity)).count();
        row.cells.len() > 2 && names(row, &THETA_I) && known > 1
    };
    let row = table.data().take(FIRST_LINES).find(is_header)?;
    Some(match Header::of(&row, &ACCEPTED).map(|header| header.others.into_iter().next()) {
        Ok(Some(other)) => row.cell_error(other.cell, table::unknown(&other.name, &ACCEPTED[..9])),
        Ok(None) => row.error(Problem::MissingColumn { missing: MISSING }),
        Err(error) => error,
    })
}

impl Layout {
    /// Detects the layout from a header, or from the first row of numbers; `None` if the row is neither.
    fn of(row: &Row<'_>) -> Option<Self> {
        let separator = row.table.dialect.separator.and_then(|separator| u8::try_from(separator).ok());
        let count = row.cells.len();
        if (0..count).all(|cell| row.is_number(cell)) {
            use Column::{Angle, Channel, Value};
            let angles = [Angle(0, None), Angle(1, None), Angle(2, None), Angle(3, None)];
            let columns = match count {
                5 => [&angles[..], &[Value]].concat(),
                6 => [&angles[..], &[Channel(None), Value]].concat(),
                _ => return None,
            };
            return Some(Self { separator, columns, has_header: false, way: None, notes: Vec::new() });
        }
        let header = Header::of(row, &ACCEPTED).ok().filter(|header| header.others.is_empty())?;
        let has = |quantity| header.get(quantity).is_some();
        // The azimuth of the light is either stated, or it is that from which azimuths are counted.
        let azimuth = has(&PHI_I) != has(&D_PHI) && has(&PHI_O) != has(&D_PHI);
        let is_valued = has(&BSDF) != has(&LIGHT);
        if !(azimuth && has(&THETA_I) && has(&THETA_O) && is_valued) || (has(&CHANNEL) && has(&WAVELENGTH)) {
            return None;
        }
        let mut columns = vec![Column::Other; count];
        for (quantity, make) in Self::MEANINGS {
            if let Some(column) = header.get(quantity) {
                columns[column.cell] = make(column.unit);
            }
        }
        let unused = [&ERROR, &REMARK].into_iter().filter_map(|quantity| header.get(quantity));
        let mut notes: Vec<String> = unused
            .map(|column| format!("the column `{}` is not used", table::clip(&header.names[column.cell])))
            .collect();
        let value = header.get(&BSDF).or_else(|| header.get(&LIGHT));
        let value = value.map_or("", |column| &header.names[column.cell]);
        notes.extend(relative_note(value));
        Some(Self { separator, columns, has_header: true, way: way_of_name(value), notes })
    }

    /// The columns that are read.
    const MEANINGS: [(&'static Quantity, Meaning); 10] = [
        (&THETA_I, |unit| Column::Angle(0, unit)),
        (&PHI_I, |unit| Column::Angle(1, unit)),
        (&THETA_O, |unit| Column::Angle(2, unit)),
        (&PHI_O, |unit| Column::Angle(3, unit)),
        (&D_PHI, |unit| Column::Angle(3, unit)),
        (&CHANNEL, Column::Channel),
        (&WAVELENGTH, Column::Channel),
        (&WAY, |_| Column::ScatterMode),
        (&BSDF, |_| Column::Value),
        (&LIGHT, |_| Column::Value),
    ];

    /// Whether no angle states its unit.
    fn has_angles_without_unit(&self) -> bool {
        self.columns.iter().all(|column| !matches!(column, Column::Angle(_, Some(_))))
    }
}

/// Returns the part that the name of a column of values states.
pub(super) fn way_of_name(name: &str) -> Option<ScatterMode> {
    match table::ColumnName::new(name).name.as_str() {
        "btdf" | "f_t" | "ft" => Some(ScatterMode::FrontTransmission),
        "brdf" | "f_r" | "fr" => Some(ScatterMode::FrontReflection),
        _ => None,
    }
}

/// Returns a note if the name or unit of a column is not that of a BSDF in 1/sr.
pub(super) fn relative_note(name: &str) -> Option<String> {
    let column = table::ColumnName::new(name);
    let is_bsdf = column.is_one_of(BSDF.names, false) || matches!(column.unit, Some(Ok(Unit::PerSteradian)));
    let is_relative = !is_bsdf || matches!(column.unit, Some(Ok(Unit::Relative | Unit::Counts)));
    is_relative.then(|| {
        format!(
            "the column `{}` is read as a BSDF in relative units, proportional to the radiance; an intensity (W/sr) must be divided by the \
             cosine of the inclination first",
            table::clip(name)
        )
    })
}

/// Returns the cells of a line, without blanks and double quotes around them.
pub(super) fn cells(
    text: Text<'_>,
    line: Range<usize>,
    separator: Option<u8>,
) -> impl Iterator<Item = Range<usize>> {
    let bytes = text.bytes;
    let blanks = move |range: Range<usize>| {
        let cell = &bytes[range.clone()];
        let start = range.end - cell.trim_ascii_start().len();
        start..start + cell.trim_ascii().len()
    };
    let mut rest = Some(line);
    std::iter::from_fn(move || {
        let line = rest.clone()?;
        let ends = |b: &u8| separator.map_or(b.is_ascii_whitespace(), |s| *b == s);
        let begins = blanks(line.clone()).start;
        let quoted = bytes.get(begins) == Some(&b'"') && begins < line.end;
        // The separator is searched behind the second quote.
        let from = match quoted {
            true => bytes[begins + 1..line.end]
                .iter()
                .position(|b| *b == b'"')
                .map_or(line.end, |k| begins + k + 2),
            false => line.start,
        };
        let end = bytes[from..line.end].iter().position(ends).map(|length| from + length);
        let cell = blanks(line.start..end.unwrap_or(line.end));
        rest = end.map(|end| match separator {
            Some(_) => end + 1..line.end,
            None => blanks(end..line.end),
        });
        let inside = cell.start + 1..cell.end.max(cell.start + 2) - 1;
        Some(if quoted && cell.len() > 1 { blanks(inside) } else { cell })
    })
}

pub(super) fn read(file: &DataFile) -> Result<BsdfFile, FormatError> {
    let unknown = || Text::new(file).whole(BsdfProblem::Unknown);
    let (text, layout, first) = find(file).ok_or_else(unknown)?;
    let mut lines = Lines::new(text);
    while lines.expect("the first row of data")?.start < first.start {}
    let mut rows = Rows::default();
    if !layout.has_header {
        rows.take(text, &layout, first)?;
    }
    while let Some(line) = lines.next()? {
        rows.take(text, &layout, line)?;
    }
    if rows.count == 0 {
        return Err(text.ends("the first row of data"));
    }
    if layout.has_angles_without_unit() && rows.may_be_radians() {
        return Err(text.whole(Problem::Radians));
    }
    let mut parts = rows.parts(text)?;
    // Inclinations up to 90 deg only: a file that names its values `btdf` has them from the normal of their
    // own side.
    let has_ways = layout.columns.contains(&Column::ScatterMode);
    let (mut notes, one_side) = (layout.notes, !has_ways && is_front_reflection(&parts));
    if let ([part], true, Some(ScatterMode::FrontTransmission)) = (&mut parts[..], one_side, layout.way) {
        part.way = ScatterMode::FrontTransmission;
        notes.push(
            "the values are named `btdf`, and no inclination is above 90 deg: they are read as front transmission, with inclinations \
             from the normal of the far side"
                .to_owned(),
        );
    }
    let measurement = Measurement { provenance: provenance(lines.comments), media: [1.0, 1.0], parts };
    let states_part = !one_side || layout.way.is_some();
    Ok(BsdfFile { measurement, warnings: Vec::new(), notes, states_part, states_side: !one_side })
}

/// Returns whether all inclinations were up to 90 deg.
pub(super) fn is_front_reflection(parts: &[MeasuredPart]) -> bool {
    matches!(parts, [part] if part.way == ScatterMode::FrontReflection)
}

pub(super) fn provenance(comments: Vec<String>) -> Provenance {
    let mut provenance = Provenance { format: NAME.to_owned(), ..Provenance::default() };
    for comment in comments {
        match comment.split_once(": ") {
            Some(("sample", sample)) if provenance.sample.is_empty() => {
                sample.clone_into(&mut provenance.sample)
            }
            Some(("source", source)) if provenance.source.is_empty() => {
                source.clone_into(&mut provenance.source)
            }
            _ => provenance.remarks.push(comment),
        }
    }
    provenance
}

/// All rows, sorted by part.
#[derive(Default)]
pub(super) struct Rows {
    pub(super) count: usize,
    channels: Vec<Channel>,
    numbers: HashMap<u64, usize>,
    ways: [Pairs; 4],
    pub(super) angles: Angles,
}

/// The rows of one part.
#[derive(Default)]
struct Pairs {
    pairs: Vec<[f64; 4]>,
    numbers: HashMap<[u64; 4], u32>,
    /// Pair, channel, value and start of the row, bytes.
    entries: Vec<(u32, u32, f64, usize)>,
}

const WAYS: [ScatterMode; 4] = [
    ScatterMode::FrontReflection,
    ScatterMode::FrontTransmission,
    ScatterMode::BackTransmission,
    ScatterMode::BackReflection,
];

impl Rows {
    fn take(&mut self, text: Text<'_>, layout: &Layout, line: Range<usize>) -> Result<(), FormatError> {
        let count = layout.columns.len();
        let found = cells(text, line.clone(), layout.separator).take(count + 1).count();
        if found != count {
            let expected =
                "the columns theta_i,phi_i,theta_o,phi_o[,wavelength],value, or those of the header";
            return Err(text.error(line, Problem::Columns { count, expected, found }));
        }
        let mut angles = [0.0; 4];
        let (mut way, mut channel, mut value) = (None, Channel::Monochrome, f64::NAN);
        let most = if layout.columns.contains(&Column::ScatterMode) { 90.0 } else { 180.0 };
        for (cell, column) in cells(text, line.clone(), layout.separator).zip(&layout.columns) {
            match *column {
                Column::Angle(k, unit) => angles[k] = self.angle(text, cell, (k, unit), most)?,
                Column::ScatterMode => way = Some(way_of(text, cell)?),
                Column::Channel(unit) => channel = channel_of(text, cell, unit)?,
                // An empty cell was not measured.
                Column::Value if is_not_measured(text, &cell) => {}
                Column::Other => {}
                Column::Value => value = text.value(cell)?,
            }
        }
        let way = way.unwrap_or_else(|| unfold(&mut angles));
        self.add(text, line, way, angles, (channel, value))
    }

    /// Reads angle `k` of a row, in degrees.
    fn angle(
        &mut self,
        text: Text<'_>,
        cell: Range<usize>,
        (k, unit): (usize, Option<Unit>),
        most: f64,
    ) -> Result<f64, FormatError> {
        let unit = unit.unwrap_or(Unit::Angle(1.0));
        let value = self.angles.degrees(text, cell.clone(), unit)?;
        let (least, most) = if k.is_multiple_of(2) { (0.0, most) } else { (-360.0, 720.0) };
        if (least..=most).contains(&value) {
            return Ok(value);
        }
        let expected = match (k % 2, most) {
            (0, 90.0) => "an inclination from 0 to 90 deg, from the normal of its side",
            (0, _) => "an inclination from 0 to 180 deg, from the normal of the front",
            _ => "an azimuth from -360 to 720 deg",
        };
        Err(text.error(cell, Problem::OutOfRange { what: ANGLES[k], value, expected }))
    }

    /// Replaces angles that are multiples of a step but for their rounding by these.
    fn without_rounding(&mut self) {
        // Inclinations, then azimuths, of the light and of the viewer together.
        let steps = [0, 1].map(|first| {
            let pairs = self.ways.iter().flat_map(|way| &way.pairs);
            self.angles.step(pairs.flat_map(|pair| [pair[first], pair[first + 2]]))
        });
        let snapped = |pair: [f64; 4]| {
            let snap = |k: usize| steps[k % 2].map_or(pair[k], |step| rounding::nearest(pair[k], step));
            [snap(0), snap(1), snap(2), snap(3)]
        };
        for way in &mut self.ways {
            if way.pairs.iter().any(|pair| snapped(*pair) != *pair) {
                *way = way.with_angles(snapped);
            }
        }
    }

    /// Adds the value of a row.
    pub(super) fn add(
        &mut self,
        text: Text<'_>,
        line: Range<usize>,
        way: usize,
        angles: [f64; 4],
        (channel, value): (Channel, f64),
    ) -> Result<(), FormatError> {
        if self.count >= MOST_ROWS {
            return Err(text.error(line, BsdfProblem::TooManyCells { limit: MOST_ROWS }));
        }
        let channel = self.channel(text, &line, channel)?;
        self.count += 1;
        self.ways[way].take(angles, channel, value, line.start);
        Ok(())
    }

    /// Returns whether all angles could be in radians: inclinations up to 1.571, azimuths up to 6.284, and
    /// not only whole numbers.
    fn may_be_radians(&self) -> bool {
        let pairs = || self.ways.iter().flat_map(|way| &way.pairs);
        let most = |k: usize| pairs().map(|angles| angles[k].abs()).fold(0.0, f64::max);
        let is_whole = pairs().flatten().all(|angle| angle.fract() == 0.0);
        most(0).max(most(2)) <= 1.571 && most(1).max(most(3)) <= 6.284 && !is_whole
    }

    fn channel(&mut self, text: Text<'_>, line: &Range<usize>, channel: Channel) -> Result<u32, FormatError> {
        let key = match channel {
            Channel::Wavelength(nm) => nm.to_bits(),
            named => NAMED.iter().position(|known| *known == named).unwrap_or(0) as u64,
        };
        let next = self.channels.len();
        let number = *self.numbers.entry(key).or_insert(next);
        if number == next {
            self.channels.push(channel);
        }
        u32::try_from(number)
            .map_err(|_| text.error(line.clone(), BsdfProblem::TooManyCells { limit: MOST_CELLS }))
    }

    pub(super) fn parts(mut self, text: Text<'_>) -> Result<Vec<MeasuredPart>, FormatError> {
        self.without_rounding();
        let mut order: Vec<usize> = (0..self.channels.len()).collect();
        if self.channels.iter().all(|channel| matches!(channel, Channel::Wavelength(_))) {
            let nm = |k: usize| match self.channels[k] {
                Channel::Wavelength(nm) => nm,
                _ => 0.0,
            };
            order.sort_by(|&a, &b| nm(a).total_cmp(&nm(b)));
        }
        let mut parts = Vec::new();
        for (pairs, way) in self.ways.into_iter().zip(WAYS) {
            if !pairs.pairs.is_empty() {
                parts.push(pairs.part(text, way, &self.channels, &order)?);
            }
        }
        Ok(parts)
    }
}

/// The channels with a name.
const NAMED: [Channel; 8] = [
    Channel::Monochrome,
    Channel::X,
    Channel::Y,
    Channel::Z,
    Channel::Red,
    Channel::Green,
    Channel::Blue,
    Channel::Solar,
];

/// Returns whether a value is empty, or a mark of a missing value other than NaN, which is more often a fault
/// of the measurement.
pub(super) fn is_not_measured(text: Text<'_>, cell: &Range<usize>) -> bool {
    let begins = text.bytes[cell.clone()].first();
    match begins {
        None => true,
        Some(b'0'..=b'9' | b'.' | b'+') => false,
        Some(_) => {
            let word = text.quote(cell.clone());
            table::is_missing(&word) && !word.eq_ignore_ascii_case("nan")
        }
    }
}

/// Returns the part with this name.
pub(super) fn way_named(name: &str) -> Option<ScatterMode> {
    WAYS.into_iter().find(|way| way.name() == name)
}

/// Returns the channel with this name, or of this wavelength in nm.
pub(super) fn channel_named(name: &str) -> Option<Channel> {
    let named = NAMED.iter().find(|named| named.to_string().eq_ignore_ascii_case(name));
    named.copied().or_else(|| super::wavelength(name.parse().ok()?))
}

fn way_of(text: Text<'_>, cell: Range<usize>) -> Result<usize, FormatError> {
    let word = text.quote(cell.clone());
    let way = way_named(&word).and_then(|named| WAYS.iter().position(|way| *way == named));
    way.ok_or_else(|| {
        let expected = "`front reflection`, `front transmission`, `back transmission` or `back reflection`";
        text.error(cell, BsdfProblem::Unexpected { found: word, expected })
    })
}

fn channel_of(text: Text<'_>, cell: Range<usize>, unit: Option<Unit>) -> Result<Channel, FormatError> {
    let word = text.quote(cell.clone());
    if let Some(named) = NAMED.iter().find(|named| named.to_string().eq_ignore_ascii_case(&word)) {
        return Ok(*named);
    }
    let value = text.number(cell.clone())?;
    let value = unit.map_or(value, |unit| unit.convert(value, Dimension::Wavelength));
    super::wavelength(value).ok_or_else(|| {
        let expected = "the name of a channel, or a wavelength in nm of 30 or more";
        let out_of_range = Problem::OutOfRange { what: "a wavelength", value, expected };
        text.error(cell, if value > 0.0 { Problem::Micrometres } else { out_of_range })
    })
}

/// Converts inclinations from the normal of the front to inclinations from the normals of their own sides,
/// and returns the index of the part in [`WAYS`].
pub(super) fn unfold(angles: &mut [f64; 4]) -> usize {
    let from_back = angles[0] > 90.0;
    let to_back = angles[2] > 90.0;
    for (k, back) in [(0, from_back), (2, to_back)] {
        if back {
            angles[k] = 180.0 - angles[k];
        }
    }
    match (from_back, to_back) {
        (false, false) => 0,
        (false, true) => 1,
        (true, false) => 2,
        (true, true) => 3,
    }
}

impl Pairs {
    fn take(&mut self, angles: [f64; 4], channel: u32, value: f64, at: usize) {
        let next = self.pairs.len() as u32;
        let number = *self.numbers.entry(angles.map(f64::to_bits)).or_insert(next);
        if number == next {
            self.pairs.push(angles);
        }
        self.entries.push((number, channel, value, at));
    }

    /// Returns the same rows with other angles, of which several may be the same.
    fn with_angles(&self, angles: impl Fn([f64; 4]) -> [f64; 4]) -> Self {
        let mut others = Self::default();
        for &(pair, channel, value, at) in &self.entries {
            others.take(angles(self.pairs[pair as usize]), channel, value, at);
        }
        others
    }

    fn part(
        self,
        text: Text<'_>,
        way: ScatterMode,
        channels: &[Channel],
        order: &[usize],
    ) -> Result<MeasuredPart, FormatError> {
        let present: Vec<usize> = {
            let mut used = vec![false; channels.len()];
            self.entries.iter().for_each(|entry| used[entry.1 as usize] = true);
            order.iter().copied().filter(|&k| used[k]).collect()
        };
        let cells = self.pairs.len();
        let all = cells.checked_mul(present.len()).filter(|all| *all <= MOST_CELLS);
        let all = all.ok_or_else(|| text.whole(BsdfProblem::TooManyCells { limit: MOST_CELLS }))?;
        if all > 4 * self.entries.len() + 1000 {
            return Err(text.whole(BsdfProblem::Missing {
                what: "value for most combinations of directions and wavelengths",
            }));
        }
        let (geometry, place) = self.geometry();
        let mut place_of_channel = vec![0; channels.len()];
        present.iter().enumerate().for_each(|(place, &k)| place_of_channel[k] = place);
        let mut values = vec![f64::NAN; all];
        let mut taken = vec![false; all];
        for &(pair, channel, value, at) in &self.entries {
            let cell = place_of_channel[channel as usize] * cells + place[pair as usize];
            if std::mem::replace(&mut taken[cell], true) {
                return Err(text.error(
                    at..text.bytes.len(),
                    BsdfProblem::Twice { what: "this pair of directions".to_owned() },
                ));
            }
            values[cell] = value;
        }
        let channels = present.iter().map(|&k| channels[k]).collect();
        Ok(MeasuredPart { way, channels, geometry, values, tis: Vec::new() })
    }

    /// Returns a grid if the pairs form one, otherwise the pairs, and the cell of each pair.
    fn geometry(&self) -> (Geometry, Vec<usize>) {
        let axes: [Vec<f64>; 4] = std::array::from_fn(|k| {
            let mut axis: Vec<f64> = self.pairs.iter().map(|pair| pair[k]).collect();
            axis.sort_by(f64::total_cmp);
            axis.dedup();
            axis
        });
        let product = axes.iter().try_fold(1_usize, |cells, axis| cells.checked_mul(axis.len()));
        if product != Some(self.pairs.len()) {
            let pairs =
                self.pairs.iter().map(|&[ti, pi, to, po]| [Direction::new(ti, pi), Direction::new(to, po)]);
            return (Geometry::Pairs(pairs.collect()), (0..self.pairs.len()).collect());
        }
        let cell = |pair: &[f64; 4]| {
            axes.iter().zip(pair).fold(0, |cell, (axis, angle)| {
                cell * axis.len() + axis.partition_point(|other| other < angle)
            })
        };
        let place = self.pairs.iter().map(cell).collect();
        let [theta_i_deg, phi_i_deg, theta_o_deg, phi_o_deg] = axes;
        (Geometry::Spherical(SphericalGrid { theta_i_deg, phi_i_deg, theta_o_deg, phi_o_deg }), place)
    }
}
