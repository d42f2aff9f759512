//! Reader of CSV files with the columns `theta_i,phi_i,theta_o,phi_o[,wavelength],value`, or
//! `theta_i,theta_o,dphi[,wavelength],value` for light from one azimuth; a column `error` is not read.
//!
//! Without a column `way`, inclinations are from 0 to 180 deg from the normal of the front: above 90 deg,
//! light comes from, or goes to, the back. A row at exactly 90 deg belongs to the side that has other rows; to the
//! front, if both have some. If the rows are all combinations of values of four axes, they form
//! a grid.

use std::ops::Range;

use papilio_goniometry::{Channel, MeasuredPart, Measurement, Provenance, ScatterMode};

use super::table_rows::{NAMED, Rows, WAYS};
use super::text::{Lines, Text};
use super::{BsdfFile, BsdfProblem};
use crate::error::{FormatError, Problem};
use crate::file::DataFile;
use crate::table::quantities::{
    BSDF, CHANNEL, D_PHI, ERROR, LIGHT, PHI_I, PHI_O, REMARK, THETA_I, THETA_O, WAVELENGTH, WAY,
};
use crate::table::{self, Dialect, Dimension, Header, Quantity, Row, Table, Unit};

/// The column with the meaning of a name, in its unit.
type Meaning = fn(Option<Unit>) -> Column;

/// Name of the format.
pub(super) const NAME: &str = "CSV";

/// Number of lines among which the header is searched.
const FIRST_LINES: usize = 60;

/// Quantity of a column.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Column {
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
pub(super) const ANGLES: [&str; 4] = ["theta_i", "phi_i", "theta_o", "phi_o"];

static ACCEPTED: [&Quantity; 12] =
    [&THETA_I, &PHI_I, &THETA_O, &PHI_O, &D_PHI, &CHANNEL, &WAVELENGTH, &BSDF, &WAY, &ERROR, &REMARK, &LIGHT];

const MISSING: &str =
    "the columns theta_i, phi_i, theta_o, phi_o (or theta_i, theta_o, dphi) and a value: bsdf, brdf or btdf";

/// Layout of the rows.
pub(super) struct Layout {
    pub(super) separator: Option<u8>,
    pub(super) columns: Vec<Column>,
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
    let mut continued = None;
    for comment in comments {
        // A line that ends with a comma or a semicolon goes on.
        let goes_on = comment.ends_with([',', ';']);
        let (sample, source) = (&mut provenance.sample, &mut provenance.source);
        if let Some(is_source) = continued {
            let text = if is_source { source } else { sample };
            *text = format!("{text} {comment}");
            continued = continued.filter(|_| goes_on);
            continue;
        }
        match comment.split_once(": ") {
            Some(("sample", text)) if sample.is_empty() => {
                text.clone_into(sample);
                continued = goes_on.then_some(false);
            }
            Some(("source", text)) if source.is_empty() => {
                text.clone_into(source);
                continued = goes_on.then_some(true);
            }
            _ => provenance.remarks.push(comment),
        }
    }
    provenance
}

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

pub(super) fn way_of(text: Text<'_>, cell: Range<usize>) -> Result<usize, FormatError> {
    let word = text.quote(cell.clone());
    let way = way_named(&word).and_then(|named| WAYS.iter().position(|way| *way == named));
    way.ok_or_else(|| {
        let expected = "`front reflection`, `front transmission`, `back transmission` or `back reflection`";
        text.error(cell, BsdfProblem::Unexpected { found: word, expected })
    })
}

pub(super) fn channel_of(
    text: Text<'_>,
    cell: Range<usize>,
    unit: Option<Unit>,
) -> Result<Channel, FormatError> {
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
