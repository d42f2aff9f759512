//! Writers: BMP, C header, and the mask of changed pixels.

use std::io::{self, Write};

use papilio_display::result::Named;

use super::{FrameNumbers, PanelFrame, row_bytes};
use crate::picture::write_grey_bits;

/// Bytes of the two headers of a BMP file.
const BMP_HEADERS: usize = 14 + 40;

/// Writes a frame as an indexed BMP of the fewest bits for each pixel, 1, 4 or 8, that hold its codes and
/// `bits`: the number of a pixel is its code, whose colour is in `palette`.
///
/// # Errors
/// If the system reports an error, or the frame is too large for the format.
pub fn write_indexed_bmp(
    out: &mut dyn Write,
    frame: &PanelFrame,
    bits: u8,
    palette: &[(u8, [u8; 3])],
) -> io::Result<()> {
    let depth = match bits {
        1 => 1,
        2..=4 => 4,
        _ => 8,
    };
    let colours = 1usize << depth;
    let width = row_bytes(frame.size[0], depth).next_multiple_of(4);
    let start = BMP_HEADERS + 4 * colours;
    let too_large = |_| io::Error::other("this frame is too large for a BMP file");
    let number = |value: usize| u32::try_from(value).map_err(too_large);
    out.write_all(b"BM")?;
    // Size of the file, reserved, place of the pixels, size of the second header, columns and rows.
    let head = [start + width * frame.size[1], 0, start, 40, frame.size[0], frame.size[1]];
    for value in head {
        out.write_all(&number(value)?.to_le_bytes())?;
    }
    // One plane, bits of a pixel.
    out.write_all(&[1, 0, depth, 0])?;
    // No compression, size of the pixels, no resolution, colours, all of which are important.
    for value in [0, width * frame.size[1], 0, 0, colours, 0] {
        out.write_all(&number(value)?.to_le_bytes())?;
    }
    let mut table = vec![[0; 4]; colours];
    for (code, [red, green, blue]) in palette {
        if let Some(entry) = table.get_mut(usize::from(*code)) {
            *entry = [*blue, *green, *red, 0];
        }
    }
    out.write_all(table.as_flattened())?;
    let packed = frame.packed(super::Packing::Bits(depth));
    // The lowest row is the first.
    for row in packed.chunks(row_bytes(frame.size[0], depth).max(1)).rev() {
        out.write_all(row)?;
        out.write_all(&[0; 3][..width - row.len()])?;
    }
    Ok(())
}

/// Head of a C header: what its comment says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeaderHead<'a> {
    /// The program with its version.
    pub program: &'a str,
    /// Title of the scenario.
    pub title: &'a str,
    /// Layout and codes.
    pub numbers: &'a FrameNumbers,
}

/// Bytes in a line of a C header.
const IN_LINE: usize = 16;

/// Writes the bytes of a frame as a C header: `frame[]`, its sizes, and a comment with the layout.
///
/// # Errors
/// If the system reports an error.
pub fn write_frame_header(out: &mut dyn Write, head: HeaderHead<'_>, bytes: &[u8]) -> io::Result<()> {
    let HeaderHead { program, title, numbers } = head;
    let FrameNumbers { size: [columns, rows], bits, bytes_per_row, .. } = numbers;
    // A line that ends with a backslash would continue the comment.
    let title = title.replace('\\', "/");
    writeln!(out, "// {title}\n// Written by {program}.\n//\n// {}", layout(numbers))?;
    writeln!(out, "// Codes: {}.\n#ifndef FRAME_H\n#define FRAME_H\n", codes(&numbers.codes))?;
    writeln!(out, "#define FRAME_WIDTH {columns}\n#define FRAME_HEIGHT {rows}\n#define FRAME_BITS {bits}")?;
    writeln!(out, "#define FRAME_ROW_BYTES {bytes_per_row}\n")?;
    writeln!(out, "const unsigned char frame[{}] = {{", bytes.len())?;
    for line in bytes.chunks(IN_LINE) {
        let numbers: Vec<String> = line.iter().map(|byte| format!("0x{byte:02x}")).collect();
        writeln!(out, "    {},", numbers.join(", "))?;
    }
    writeln!(out, "}};\n\n#endif")
}

/// The layout of the bytes in words.
fn layout(numbers: &FrameNumbers) -> String {
    let FrameNumbers { size: [columns, rows], bits, planes, bytes_per_row, rotation_deg, mirrored, .. } =
        numbers;
    let packing = match (planes, bits) {
        (true, _) => format!("{bits} planes of 1 bit for each pixel, bit 0 of the codes first"),
        (false, 1) => "1 bit for each pixel".to_owned(),
        (false, _) => format!("{bits} bits for each pixel"),
    };
    let turned = match (rotation_deg, mirrored) {
        (0, false) => String::new(),
        (turn, false) => format!("; rotated by {turn} deg clockwise"),
        (0, true) => "; mirrored left to right".to_owned(),
        (turn, true) => format!("; rotated by {turn} deg clockwise, then mirrored left to right"),
    };
    format!(
        "{columns} x {rows} pixels, rows from the top; {packing}, the first pixel in the highest bits; {bytes_per_row} bytes in a \
         row{turned}."
    )
}

/// The codes in words: `black 0, white 1`.
fn codes(codes: &Named<u8>) -> String {
    let codes: Vec<String> = codes.iter().map(|(state, code)| format!("{state} {code}")).collect();
    codes.join(", ").replace('\\', "/")
}

/// Writes a mask as a PNG of 1 bit: white where `mask` is true.
///
/// # Errors
/// If the system reports an error, or the mask does not consist of whole rows.
pub fn write_mask_png(out: &mut dyn Write, columns: usize, mask: &[bool]) -> io::Result<()> {
    let rows = mask.len() / columns.max(1);
    let frame = PanelFrame { size: [columns, rows], codes: mask.iter().map(|one| u8::from(*one)).collect() };
    write_grey_bits(out, frame.size, &frame.packed(super::Packing::Bits(1)))
}
