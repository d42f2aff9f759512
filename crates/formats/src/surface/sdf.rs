//! Surface data files (SDF) in text and binary: BCR-1.0, and ISO 25178-71 in the revisions ISO-1.0 and
//! ISO-2.0.
//!
//! A header, the heights by profiles along x, and a free text. Lengths are in metres, and heights are numbers
//! times Zscale. ISO marks missing heights by the smallest number of their type, in a text by `BAD`, and
//! begins with the profile of the lowest y; BCR marks them by the largest number, and begins with that of the
//! highest y.

use papilio_diagnostics::Diagnostic;

use super::bytes::{Bytes, Kind};
use super::{HeightFile, UM, damaged, sized};

/// What a revision of the format has of its own.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Revision {
    Bcr,
    Iso1,
    Iso2,
}

/// Bytes of the first word, and of the three texts that follow in binary files.
const WORD: usize = 8;
const TEXTS: usize = 34;

/// Whether a file begins with the word of an SDF file, of any revision.
pub(super) fn is_sdf(bytes: &[u8]) -> bool {
    let is_family = matches!(bytes.get(1..5), Some(b"ISO-" | b"BCR-"));
    is_family && matches!(bytes.first(), Some(b'a' | b'A' | b'b' | b'B'))
}

/// Reads a map.
pub(super) fn read(bytes: &[u8]) -> Result<HeightFile, Diagnostic> {
    let revision = match bytes.get(1..WORD) {
        Some(b"BCR-1.0") => Revision::Bcr,
        Some(b"ISO-1.0") => Revision::Iso1,
        Some(b"ISO-2.0") => Revision::Iso2,
        other => {
            let word = String::from_utf8_lossy(other.unwrap_or_default()).into_owned();
            return Err(wrong(format!(
                "its revision is `{}` (expected BCR-1.0, ISO-1.0 or ISO-2.0)",
                word.escape_debug()
            )));
        }
    };
    match bytes[0] {
        b'a' | b'A' => of_text(&super::text::decoded(bytes)?, revision),
        _ => of_binary(Bytes { all: bytes, format: "SDF" }, revision),
    }
}

fn wrong(what: impl Into<String>) -> Diagnostic {
    damaged("SDF", what)
}

/// What the headers of both kinds state.
struct Head {
    columns: usize,
    rows: usize,
    /// Xscale, Yscale, Zscale, m.
    scales_m: [f64; 3],
    kind: Kind,
    revision: Revision,
    has_checksum: bool,
}

impl Head {
    /// The number that marks a missing height.
    fn is_missing(&self, number: f64) -> bool {
        let [smallest, largest] = self.kind.ends();
        match self.revision {
            // The largest number of a type is written with few digits.
            Revision::Bcr if self.kind == Kind::F32 => number >= 3.4e38,
            Revision::Bcr if self.kind == Kind::F64 => number >= 1.7e308,
            Revision::Bcr => number == largest,
            // The smallest unsigned number is 0, a height.
            Revision::Iso1 | Revision::Iso2 => smallest < 0.0 && number == smallest,
        }
    }

    fn map(self, numbers: Vec<f64>) -> Result<HeightFile, Diagnostic> {
        let count = sized(self.columns, self.rows)?;
        if numbers.len() != count {
            return Err(wrong(format!("it has {} heights, and its header {count}", numbers.len())));
        }
        let [x, y, z] = self.scales_m;
        if let Some(scale) = self.scales_m.into_iter().find(|scale| !(scale.is_finite() && *scale > 0.0)) {
            return Err(wrong(format!("a scale is {scale} m (expected Xscale, Yscale and Zscale above 0)")));
        }
        let numbers =
            numbers.into_iter().map(|number| if self.is_missing(number) { f64::NAN } else { number });
        let mut map = HeightFile::plain(self.columns, numbers.collect());
        (map.pitch_um, map.unit_um) = (Some([x * UM, y * UM]), Some(z * UM));
        if self.has_checksum {
            map.warnings.push("the checksum of this SDF file is not verified".to_owned());
        }
        Ok(if self.revision == Revision::Bcr { map.upside_down() } else { map })
    }
}

/// The type of numbers by its code.
fn kind_of(code: usize) -> Result<Kind, Diagnostic> {
    let kinds = [Kind::U8, Kind::U16, Kind::U32, Kind::F32, Kind::I8, Kind::I16, Kind::I32, Kind::F64];
    kinds.get(code).copied().ok_or_else(|| wrong(format!("its data type is {code} (expected 0 to 7)")))
}

/// Names that BCR-1.0 permits for the codes of DataType, Compression and CheckType.
const NAMES: [(&str, usize); 11] = [
    ("UCHAR", 0),
    ("UINTEGER", 1),
    ("ULONGINT", 2),
    ("FLOAT", 3),
    ("CHAR", 4),
    ("INTEGER", 5),
    ("LONGINT", 6),
    ("DOUBLE", 7),
    ("NULL", 0),
    ("NONE", 0),
    ("RLL", 1),
];

/// Lines `Name = value`, a line `*`, the heights, a line `*`, and a free text.
fn of_text(text: &str, revision: Revision) -> Result<HeightFile, Diagnostic> {
    let [mut head, mut data] = [String::new(), String::new()];
    let mut records = 0;
    for line in text.split(['\n', '\r']).skip(1) {
        // BCR permits comments.
        let line = if revision == Revision::Bcr { line.split(';').next().unwrap_or("") } else { line };
        match (line.trim() == "*", records) {
            (true, _) => records += 1,
            (false, 0) => head.extend([line, "\n"]),
            (false, 1) => data.extend([line, "\n"]),
            _ => break,
        }
    }
    if records == 0 {
        return Err(wrong("the line `*` after its header is missing"));
    }
    let word = |name: &str| {
        let mut lines = head.lines().filter_map(|line| line.split_once('='));
        lines.find(|(key, _)| key.trim().eq_ignore_ascii_case(name)).map(|(_, value)| value.trim())
    };
    let value = |name: &str| {
        let number = word(name).and_then(|value| value.parse::<f64>().ok());
        number.ok_or_else(|| wrong(format!("its header has no number `{name}`")))
    };
    let count = |name: &str| {
        let number = value(name)?;
        let is_count = number.fract() == 0.0 && (0.0..=1e9).contains(&number);
        if is_count { Ok(number as usize) } else { Err(wrong(format!("`{name}` is {number}"))) }
    };
    let code = |name: &str| {
        let named =
            word(name).and_then(|word| NAMES.iter().find(|(known, _)| word.eq_ignore_ascii_case(known)));
        named.map_or_else(|| count(name), |(_, code)| Ok(*code))
    };
    if word("Compression").is_some() && code("Compression")? != 0 {
        return Err(wrong("its heights are compressed (expected Compression 0)"));
    }
    let head_of_map = Head {
        columns: count("NumPoints")?,
        rows: count("NumProfiles")?,
        scales_m: [value("Xscale")?, value("Yscale")?, value("Zscale")?],
        kind: kind_of(if word("DataType").is_some() { code("DataType")? } else { 7 })?,
        revision,
        has_checksum: word("CheckType").is_some_and(|word| !["0", "NULL", "NONE"].contains(&word)),
    };
    let most = sized(head_of_map.columns, head_of_map.rows)?;
    let number = |word: &str| match word {
        word if word.eq_ignore_ascii_case("BAD") => Ok(f64::NAN),
        word => word.parse::<f64>().map_err(|_| wrong(format!("`{}` is not a height", word.escape_debug()))),
    };
    let numbers = data.split_whitespace().take(most + 1).map(number).collect::<Result<Vec<f64>, _>>()?;
    head_of_map.map(numbers)
}

/// A header of 81 bytes, or 85 with the longer counts of ISO-2.0, and the heights.
fn of_binary(bytes: Bytes<'_>, revision: Revision) -> Result<HeightFile, Diagnostic> {
    let at = WORD + TEXTS;
    let (columns, rows, at) = match revision {
        Revision::Bcr | Revision::Iso1 => (bytes.u16(at)?, bytes.u16(at + 2)?, at + 4),
        Revision::Iso2 => (bytes.u32(at)?, bytes.u32(at + 4)?, at + 8),
    };
    let scales_m = [bytes.f64(at)?, bytes.f64(at + 8)?, bytes.f64(at + 16)?];
    // Zresolution stands between Zscale and three codes of a byte each.
    let codes = bytes.part(at + 32, 3)?;
    if codes[0] != 0 {
        return Err(wrong("its heights are compressed (expected Compression 0)"));
    }
    let kind = kind_of(usize::from(codes[1]))?;
    let numbers = bytes.numbers(at + 35, sized(columns, rows)?, kind)?;
    Head { columns, rows, scales_m, kind, revision, has_checksum: codes[2] != 0 }.map(numbers)
}
