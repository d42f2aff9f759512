//! Wyko ASCII of Vision: lines of the size, a table of named numbers, and the heights, a line for each place
//! along x.
//!
//! Lengths of pixels are in mm. Heights are in nm, or, where the second number of the first line is 0, in
//! wavelengths over Mult. Missing heights are `Bad`.

use papilio_diagnostics::Diagnostic;

use super::{HeightFile, damaged, sized};

pub(super) const WORDS: &str = "Wyko ASCII Data File Format";

pub(super) fn is_wyko(text: &str) -> bool {
    text.trim_start().starts_with(WORDS)
}

fn wrong(what: impl Into<String>) -> Diagnostic {
    damaged("Wyko ASCII", what)
}

/// Reads the first block of heights.
pub(super) fn read(text: &str) -> Result<HeightFile, Diagnostic> {
    let mut lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
    let first = lines.next().unwrap_or("");
    let is_in_nm = first[WORDS.len().min(first.len())..].split_whitespace().nth(1) == Some("1");
    let head: Vec<&str> = lines.by_ref().take_while(|line| !is_heights(line)).collect();
    let number = |name: &str| -> Option<f64> {
        let rest = head.iter().find_map(|line| line.strip_prefix(name))?;
        rest.split_whitespace().next_back()?.parse().ok()
    };
    let count = |name: &str| -> Result<usize, Diagnostic> {
        let count = number(name).filter(|number| number.fract() == 0.0 && (1.0..1e9).contains(number));
        Ok(count.ok_or_else(|| wrong(format!("it has no line `{name}`")))? as usize)
    };
    let (columns, rows) = (count("X Size")?, count("Y Size")?);
    let total = sized(columns, rows)?;
    let mut along_y = Vec::with_capacity(total);
    for line in lines.by_ref().take(columns) {
        for word in line.split_whitespace() {
            let height = if word.eq_ignore_ascii_case("bad") { Some(f64::NAN) } else { word.parse().ok() };
            along_y.push(
                height.ok_or_else(|| wrong(format!("`{}` is not a height", super::header::shown(word))))?,
            );
        }
    }
    if along_y.len() != total {
        return Err(wrong(format!("it has {} heights, and its header {total}", along_y.len())));
    }
    let height = |at: usize| along_y[at % columns * rows + at / columns];
    let mut map = HeightFile::plain(columns, (0..total).map(height).collect());
    map.unit_um = Some(match is_in_nm {
        true => 1e-3,
        false => {
            let wavelength_nm = number("Wavelength").ok_or_else(|| wrong("it has no line `Wavelength`"))?;
            1e-3 * wavelength_nm / number("Mult").filter(|mult| *mult > 0.0).unwrap_or(1.0)
        }
    });
    let aspect = number("Aspect").filter(|aspect| *aspect > 0.0).unwrap_or(1.0);
    map.pitch_um = number("Pixel_size").map(|mm| [1e3 * mm, 1e3 * mm * aspect]);
    if (aspect - 1.0).abs() > 1e-6 {
        map.warnings.push(format!(
            "the pixels are not square: Aspect {aspect} is taken as their length along y over that along x"
        ));
    }
    if lines.next().is_some() {
        map.warnings.push("further blocks of this Wyko ASCII file are not used".to_owned());
    }
    Ok(map)
}

/// Whether a line of the table is that of the heights: its block begins below.
fn is_heights(line: &str) -> bool {
    ["RAW_DATA", "RAW DATA", "OPD"].iter().any(|name| line.starts_with(name))
}
