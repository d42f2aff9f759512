//! Digital Surf, `.sur` of MountainsMap: a header of 512 bytes, a comment, a private zone, and integers of 16
//! or 32 bits by rows from the top, as they are or compressed by zlib.
//!
//! Heights are numbers times the spacing of z, plus its offset. A missing height is the smallest number of
//! the header less 2.

use std::io::Read;

use papilio_diagnostics::Diagnostic;

use super::bytes::{Bytes, Kind};
use super::units::um_of;
use super::{HeightFile, damaged, sized};

pub(super) const MAGICS: [&[u8]; 2] = [b"DIGITAL SURF", b"DSCOMPRESSED"];

const HEAD: usize = 512;

/// Kinds of contents whose first object is a map of heights.
const SURFACE: i16 = 2;
const MULTILAYER: i16 = 8;
const INTENSITY_SURFACE: [i16; 3] = [11, 13, 16];

fn wrong(what: impl Into<String>) -> Diagnostic {
    damaged("SUR", what)
}

/// Reads the first map.
pub(super) fn read(bytes: &[u8]) -> Result<HeightFile, Diagnostic> {
    let head = Bytes { all: bytes, format: "SUR" };
    head.part(0, HEAD)?;
    let mut warnings = Vec::new();
    if head.i16(12)? != 0 {
        return Err(wrong("its numbers are big-endian (expected the format of the PC, 0)"));
    }
    let (columns, rows) = (count(head, 108)?, count(head, 112)?);
    check_kind(head, &mut warnings)?;
    let total = sized(columns, rows)?;
    if count(head, 116)? != total {
        return Err(wrong(format!("it states {} heights for {columns} x {rows}", count(head, 116)?)));
    }
    let kind = match head.i16(98)? {
        16 => Kind::I16,
        32 => Kind::I32,
        other => return Err(wrong(format!("its numbers have {other} bits (expected 16 or 32)"))),
    };
    let length = |at: usize| -> Result<usize, Diagnostic> { Ok(head.i16(at)?.max(0).unsigned_abs().into()) };
    let begins = HEAD + length(334)? + length(336)?;
    let numbers = if bytes.starts_with(MAGICS[1]) {
        let data = unpacked(head, begins, total * kind.size())?;
        Bytes { all: &data, format: "SUR" }.numbers(0, total, kind)?
    } else {
        head.numbers(begins, total, kind)?
    };
    let marker = (head.i16(86)? == 1).then_some(f64::from(head.i32(100)?) - 2.0);
    let axis = |axis: usize| -> Result<f64, Diagnostic> {
        let spacing = head.f32(120 + 4 * axis)?;
        let unit = head.text(180 + 16 * axis, 16)?;
        let um = um_of(&unit).ok_or_else(|| {
            wrong(format!(
                "the unit of {} is `{}` (expected a length)",
                ["x", "y", "z"][axis],
                unit.escape_debug()
            ))
        })?;
        if !(spacing.is_finite() && spacing > 0.0) {
            return Err(wrong(format!("the spacing of {} is {spacing}", ["x", "y", "z"][axis])));
        }
        Ok(spacing * um)
    };
    let [x, y, z] = [axis(0)?, axis(1)?, axis(2)?];
    if head.i16(288)? != 0 {
        warnings.push(
            "this SUR file is that of a replica: its heights are not turned into those of the original"
                .to_owned(),
        );
    }
    let (numbers, is_turned) = inverted(numbers, columns, marker, head.i16(290)?)?;
    let mut map = HeightFile::plain(columns, numbers);
    if !is_turned {
        map = map.upside_down();
    }
    (map.pitch_um, map.unit_um, map.warnings) = (Some([x, y]), Some(z), warnings);
    Ok(map)
}

fn count(head: Bytes<'_>, at: usize) -> Result<usize, Diagnostic> {
    usize::try_from(head.i32(at)?).map_err(|_| wrong("its size is negative"))
}

/// Fails for contents without a map of heights, and warns of those beside it.
fn check_kind(head: Bytes<'_>, warnings: &mut Vec<String>) -> Result<(), Diagnostic> {
    let kind = head.i16(18)?;
    // Gwyddion writes surfaces as profiles, with these names.
    let is_of_gwyddion = kind == 1 && head.text(20, 30)? == "SCRATCH" && head.text(50, 30)? == "csm";
    let is_surface = kind == SURFACE || is_of_gwyddion;
    if !is_surface && kind != MULTILAYER && !INTENSITY_SURFACE.contains(&kind) {
        let what = match kind {
            1 => "a profile",
            3 => "a binary picture",
            4 => "a series of profiles",
            5 => "a series of surfaces",
            10 | 12 => "a picture",
            _ => "no surface",
        };
        return Err(wrong(format!("it holds {what} (type {kind}; expected a surface)")));
    }
    if head.i16(14)? > 1 || !is_surface {
        warnings.push("this SUR file holds further layers, which are not used".to_owned());
    }
    Ok(())
}

/// Heights with their sign, left and right as on the surface, and missing ones; and whether the first row is
/// that of the lowest y.
fn inverted(
    numbers: Vec<f64>,
    columns: usize,
    marker: Option<f64>,
    inversion: i16,
) -> Result<(Vec<f64>, bool), Diagnostic> {
    let sign = if inversion == 0 { 1.0 } else { -1.0 };
    let height = |number: f64| if Some(number) == marker { f64::NAN } else { sign * number };
    let mut numbers: Vec<f64> = numbers.into_iter().map(height).collect();
    match inversion {
        0 | 1 => Ok((numbers, false)),
        2 => {
            numbers.chunks_exact_mut(columns).for_each(<[f64]>::reverse);
            Ok((numbers, false))
        }
        3 => Ok((numbers, true)),
        other => Err(wrong(format!("its inversion is {other} (expected 0 to 3)"))),
    }
}

/// Compressed numbers: a count of streams, the lengths of each unpacked and packed, and the streams.
fn unpacked(head: Bytes<'_>, begins: usize, size: usize) -> Result<Vec<u8>, Diagnostic> {
    let streams = head.u32(begins)?;
    // The list of lengths must be in the file.
    head.part(begins + 4, streams.saturating_mul(8))?;
    let mut at = begins + 4 + 8 * streams;
    let mut data = Vec::new();
    for stream in 0..streams {
        let packed = head.u32(begins + 8 + 8 * stream)?;
        let part = head.part(at, packed)?;
        at += packed;
        let most = (size - data.len().min(size)) as u64;
        flate2::read::ZlibDecoder::new(part)
            .take(most + 1)
            .read_to_end(&mut data)
            .map_err(|error| wrong(format!("its heights cannot be unpacked: {error}")))?;
    }
    if data.len() != size {
        return Err(wrong(format!("its heights unpack to {} bytes (expected {size})", data.len())));
    }
    Ok(data)
}
