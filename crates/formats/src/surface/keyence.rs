//! Keyence, `.vk3`, `.vk4`, and `.vk6` and `.vk7`, which hold a `.vk4` in a zip archive.
//!
//! A table of places, the conditions of the measurement, and pictures. Lengths are in pm per pixel and per
//! step of height; heights are unsigned integers by rows from the top. The format has no mark of missing
//! heights.

use papilio_diagnostics::Diagnostic;

use super::bytes::{Bytes, Kind};
use super::{HeightFile, damaged, sized};

pub(super) const MAGICS: [&[u8]; 2] = [b"VK3_", b"VK4_"];

/// First bytes of the files that hold a zip archive, and the name in it.
pub(super) const PACKED: [&[u8]; 2] = [b"VK6", b"VK7"];
pub(super) const PACKED_NAME: &str = "Vk4File";

/// Where the table of places has those of the conditions and of the heights.
const CONDITIONS: usize = 12;
const HEIGHTS: usize = 36;

/// Bytes of the palette between the head of the heights and their numbers.
const PALETTE: usize = 768;

const UM_PER_PM: f64 = 1e-6;

/// Reads the heights.
pub(super) fn read(bytes: &[u8]) -> Result<HeightFile, Diagnostic> {
    let wrong = |what: String| damaged("Keyence VK", what);
    let file = Bytes { all: bytes, format: "Keyence VK" };
    let (conditions, head) = (file.u32(CONDITIONS)?, file.u32(HEIGHTS)?);
    // The last three of 45 numbers that come before the gamma of the pictures.
    let length = |number: usize| -> Result<f64, Diagnostic> {
        let pm = file.u32(conditions.saturating_add(4 * number))?;
        if pm > 0 {
            Ok(pm as f64 * UM_PER_PM)
        } else {
            Err(wrong("a length per pixel or per step is 0".to_owned()))
        }
    };
    let [x, y, z] = [length(42)?, length(43)?, length(44)?];
    let (columns, rows) = (file.u32(head)?, file.u32(head + 4)?);
    let count = sized(columns, rows)?;
    let kind = match file.u32(head + 8)? {
        8 => Kind::U8,
        16 => Kind::U16,
        32 => Kind::U32,
        other => return Err(wrong(format!("its heights have {other} bits (expected 16 or 32)"))),
    };
    if file.u32(head + 12)? != 0 || file.u32(head + 16)? != count * kind.size() {
        return Err(wrong("its heights are compressed, or have another size than it states".to_owned()));
    }
    let numbers = file.numbers(head + 28 + PALETTE, count, kind)?;
    let mut map = HeightFile::plain(columns, numbers).upside_down();
    (map.pitch_um, map.unit_um) = (Some([x, y]), Some(z));
    map.warnings.push(
        "the format of Keyence has no mark of missing heights: what was not measured is a height like any other; the slope, the colours and the \
         intensities of the file are not used"
            .to_owned(),
    );
    Ok(map)
}
