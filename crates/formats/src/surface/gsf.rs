//! Gwyddion Simple Field, `.gsf`: lines `Key = value`, one to four zeros up to a multiple of 4 bytes, and
//! single-precision numbers, little-endian, by rows from the top.

use papilio_diagnostics::Diagnostic;

use super::bytes::{Bytes, Kind};
use super::units::um_of;
use super::{HeightFile, damaged, sized};

pub(super) const MAGIC: &[u8] = b"Gwyddion Simple Field 1.0\n";

fn wrong(what: impl Into<String>) -> Diagnostic {
    damaged("GSF", what)
}

/// Reads a map.
pub(super) fn read(bytes: &[u8]) -> Result<HeightFile, Diagnostic> {
    let end = bytes.iter().position(|byte| *byte == 0).ok_or_else(|| wrong("its header has no end"))?;
    let head = String::from_utf8_lossy(bytes.get(MAGIC.len()..end).unwrap_or_default()).into_owned();
    let word = |name: &str| {
        let mut lines = head.lines().filter_map(|line| line.split_once('='));
        lines.find(|(key, _)| key.trim() == name).map(|(_, value)| value.trim())
    };
    let number = |name: &str| match word(name) {
        None => Ok(None),
        Some(word) => match word.parse::<f64>().ok().filter(|number| number.is_finite() && *number > 0.0) {
            Some(number) => Ok(Some(number)),
            None => Err(wrong(format!("{name} is `{}` (expected a number above 0)", word.escape_debug()))),
        },
    };
    let count = |name: &str| match word(name).and_then(|word| word.parse::<usize>().ok()) {
        Some(count) => Ok(count),
        None => Err(wrong(format!("its header has no whole number {name}"))),
    };
    let (columns, rows) = (count("XRes")?, count("YRes")?);
    let total = sized(columns, rows)?;
    let mut warnings = Vec::new();
    let mut unit = |name: &str| match word(name) {
        Some(word) if !word.is_empty() => um_of(word).ok_or_else(|| {
            wrong(format!(
                "{name} is `{}` (expected a length: the field holds no heights)",
                word.escape_debug()
            ))
        }),
        _ => {
            warnings.push(format!("this GSF file has no {name}: metres are taken"));
            Ok(1e6)
        }
    };
    let (xy_um, z_um) = (unit("XYUnits")?, unit("ZUnits")?);
    let mut pitch = |name: &str, count: usize| -> Result<f64, Diagnostic> {
        let real = number(name)?.unwrap_or_else(|| {
            warnings.push(format!("this GSF file has no {name}: 1 is taken, as its format says"));
            1.0
        });
        Ok(real * xy_um / count as f64)
    };
    let pitch_um = [pitch("XReal", columns)?, pitch("YReal", rows)?];
    // At least one zero, up to a multiple of 4 bytes.
    let data = Bytes { all: bytes, format: "GSF" };
    let begins = 4 * (end / 4 + 1);
    let numbers = data.numbers(begins, total, Kind::F32)?;
    if bytes.len() != begins + 4 * total {
        return Err(wrong(format!(
            "it has {} bytes of heights, and its header {}",
            bytes.len() - begins,
            4 * total
        )));
    }
    let mut map = HeightFile::plain(columns, numbers).upside_down();
    (map.pitch_um, map.unit_um, map.warnings) = (Some(pitch_um), Some(z_um), warnings);
    Ok(map)
}
