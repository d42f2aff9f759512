//! Text of the programs of ASD's spectroradiometers (ViewSpec Pro, RS3): lines of a head, then a row
//! `Wavelength` with the name of each spectrum, and rows of numbers.

use super::{Kind, Sample, Source, SpectralFile};
use crate::error::FormatError;
use crate::table::{Dialect, Row, Table};

const FORMAT: &str = "ASD text";

/// Line that begins the head of an exported file.
const BEGINS: &str = "Text conversion of header file";

/// Head of a file.
pub(super) struct Head {
    /// Where the row of names begins, bytes.
    names_at: usize,
}

/// Returns whether a column has the name of a file of the instrument: `leaf.asd`, `leaf.asd.ref`, `leaf.001`.
fn is_file(name: &str) -> bool {
    let last = name.rsplit('.').next().unwrap_or_default();
    name.contains(".asd")
        || (name.contains('.') && last.len() == 3 && last.bytes().all(|c| c.is_ascii_digit()))
}

/// Returns the head if the text is such a file.
pub(super) fn head(table: Table<'_>) -> Option<Head> {
    let begins = table.text.trim_start().starts_with(BEGINS);
    let line = |line: &&str| line.trim_start().to_ascii_lowercase().starts_with("wavelength");
    let names = table.text.split_inclusive('\n').find(line)?;
    let names_at = names.as_ptr() as usize - table.text.as_ptr() as usize;
    let mut cells =
        names.split([',', ';', '\t']).map(str::trim).filter(|cell| !cell.is_empty()).skip(1).peekable();
    let are_files = cells.peek().is_some() && cells.all(is_file);
    (begins || are_files).then_some(Head { names_at })
}

pub(super) fn read(table: Table<'_>, head: &Head) -> Result<SpectralFile, FormatError> {
    let (before, body) = table.text.split_at(head.names_at);
    let source = Source { name: table.name, text: table.text, format: FORMAT };
    let before_lower = before.to_ascii_lowercase();
    let says = |words: &str| before_lower.contains(words);
    let kind = match () {
        () if says("is reflectance data") => Kind::Reflectance,
        () if says("is transmittance data") => Kind::Transmittance,
        () if says("is radiance data") || says("is irradiance data") => Kind::Light,
        () => Kind::Unstated,
    };
    let table = Table { dialect: Dialect::of(body), ..table };
    let mut rows = table.data().skip_while(|row| row.bytes().start < head.names_at);
    let Some(names) = rows.next() else { return Err(source.whole("it has no row `Wavelength`")) };
    let count = names.cells.iter().rposition(|cell| !cell.text.is_empty()).map_or(0, |last| last + 1);
    let column = |cell: usize| Sample {
        name: names.cells[cell].text.trim().to_owned(),
        at: names.cells[cell].bytes(),
        ..Sample::default()
    };
    let mut samples: Vec<Sample> = (1..count).map(column).collect();
    for row in rows {
        let filled = |row: &Row<'_>| {
            row.cells.iter().rposition(|cell| !cell.text.is_empty()).map_or(0, |last| last + 1)
        };
        if filled(&row) != count {
            let what = format!("this row has {} columns, the row of names {count}", filled(&row));
            return Err(source.at(row.bytes(), what));
        }
        let nm = row.number(0)?;
        for (k, sample) in samples.iter_mut().enumerate() {
            sample.spectrum.push((nm, row.number(k + 1)?, row.cells[k + 1].bytes()));
        }
    }
    let mut file = SpectralFile::new(FORMAT, kind, samples, Vec::new());
    if says("is raw data") {
        file.notes.push(
            "raw counts of a detector are a spectrum only if its sensitivity is corrected for".to_owned(),
        );
    }
    if kind != Kind::Light && kind != Kind::Unstated {
        file.divide_per_cent();
    }
    Ok(file)
}
