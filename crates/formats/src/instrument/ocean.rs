//! Text of Ocean Optics' programs (SpectraSuite, OceanView): lines of a head, a line that begins the data,
//! and rows of two numbers.

use super::{Kind, Sample, Source, SpectralFile};
use crate::error::FormatError;
use crate::table::{Dialect, Table};

const FORMAT: &str = "Ocean Optics text";

fn is_begin(line: &str) -> bool {
    line.trim_start().starts_with(">>>>>Begin") && line.contains("Spectral Data")
}

pub(super) fn is_ocean(text: &str) -> bool {
    text.lines().any(is_begin)
}

pub(super) fn read(table: Table<'_>) -> Result<SpectralFile, FormatError> {
    let source = Source { name: table.name, text: table.text, format: FORMAT };
    let mut head = Vec::new();
    let mut first = 0;
    for (k, line) in table.text.lines().enumerate() {
        if is_begin(line) {
            first = k + 1;
            break;
        }
        head.push(line);
    }
    let axis = head.iter().find_map(|line| line.trim().strip_prefix("XAxis mode:")).map(str::trim);
    if let Some(axis) = axis.filter(|axis| !axis.to_ascii_lowercase().starts_with("wavelength")) {
        let what =
            format!("its axis is `{axis}` (expected Wavelengths: export the spectrum over wavelength)");
        return Err(source.at(source.range(axis), what));
    }
    let data = table.text.lines().enumerate().skip(first);
    let data: Vec<&str> = data
        .map(|(_, line)| line)
        .take_while(|line| !line.trim_start().starts_with(">>>>>End"))
        .filter(|line| !line.trim().is_empty())
        .collect();
    let text: String = data.iter().flat_map(|line| [*line, "\n"]).collect();
    let dialect = Dialect::of(&text);
    let mut sample = Sample::default();
    for line in data {
        let words: Vec<&str> = match dialect.separator {
            Some(separator) => line.split(separator).map(str::trim).filter(|word| !word.is_empty()).collect(),
            None => line.split_whitespace().collect(),
        };
        let numbers: Vec<f64> = words
            .iter()
            .filter_map(|word| crate::table::number(word, dialect.decimal_comma))
            .filter(|value| value.is_finite())
            .collect();
        match (&numbers[..], words.len()) {
            ([nm, value], 2) => sample.spectrum.push((*nm, *value, source.range(words[1]))),
            _ => {
                let what = format!("`{}` is not a wavelength and a value", crate::table::clip(line.trim()));
                return Err(source.at(source.range(line.trim()), what));
            }
        }
    }
    let (samples, notes) = (vec![sample], Vec::new());
    Ok(SpectralFile::new(FORMAT, Kind::Unstated, samples, notes))
}
