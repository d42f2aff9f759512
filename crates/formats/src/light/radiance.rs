//! Radiance pictures (.hdr, .pic): four bytes per pixel, three mantissas and an exponent, with run-length
//! encoding.
//!
//! G. Ward, *Real pixels*, Graphics Gems II (1991); the file format is described in Radiance's manual. The
//! factors of all `EXPOSURE` and `COLORCORR` lines are multiplied, and the pixels are divided by the product.
//! Scanlines may run in any of the eight orders of the resolution line. Colours are red, green and blue, in
//! W/(m2 sr), or X, Y and Z, in cd/m2. Without `PRIMARIES`, they are those of sRGB: photographs have these,
//! not the default of Radiance.

use papilio_diagnostics::Diagnostic;

use super::map::{LightMap, MapChannel, MapColour, Shape, not_a_map};
use super::primaries::{PICTURE_LM_PER_W, Primaries, XYZ};

pub(super) fn read(bytes: &[u8], shape: Shape) -> Result<(LightMap, Option<Primaries>), Diagnostic> {
    let header = Header::read(bytes, shape)?;
    let Header { order, start, scale, primaries, notes } = header;
    let Order { width, height, .. } = order;
    let mut input = &bytes[start..];
    let mut channels: [Vec<f32>; 3] = std::array::from_fn(|_| vec![0.0; width * height]);
    let (scans, length) = order.scans();
    let mut row = vec![[0_u8; 4]; length];
    for number in 0..scans {
        scanline(&mut input, &mut row).map_err(|error| match error {
            ScanlineError::End => damaged(format!("the file ends in row {} of {scans}", number + 1)),
            ScanlineError::Run => {
                damaged(format!("the data of row {} do not match the width in the header", number + 1))
            }
        })?;
        for (channel, (values, scale)) in channels.iter_mut().zip(scale).enumerate() {
            for (k, pixel) in row.iter().enumerate() {
                values[order.place(number, k)] = (value(pixel[channel], pixel[3]) / scale) as f32;
            }
        }
    }
    let colours = [MapColour::Red, MapColour::Green, MapColour::Blue];
    let channels = colours.into_iter().zip(channels);
    let channels = channels.map(|(colour, radiance)| MapChannel { colour, radiance }).collect();
    Ok((LightMap { width, height, channels, notes }, primaries))
}

/// Size of a picture and the order of its pixels: two axes, the slow one first, each with the sense in which
/// it runs. Y points up.
#[derive(Debug, Clone, Copy)]
struct Order {
    width: usize,
    height: usize,
    /// Whether scanlines are columns.
    by_columns: bool,
    /// Whether rows follow each other downwards, and columns to the right.
    down: bool,
    right: bool,
}

/// An error of data that do not match their header.
fn damaged(what: String) -> Diagnostic {
    Diagnostic::new(what).hint("the file is damaged or incomplete: download or copy it again")
}

impl Order {
    /// Reads a resolution line such as `-Y 512 +X 1024`.
    fn read(line: &str) -> Result<Self, Diagnostic> {
        let words: Vec<&str> = line.split_whitespace().collect();
        let other = || {
            let found: String = line.chars().take(40).collect();
            Diagnostic::new(format!("the scanlines of this file have the order `{found}`"))
                .expected("an order such as `-Y height +X width`")
        };
        let [first, slow, second, fast] = words[..] else { return Err(other()) };
        let by_columns = match (first, second) {
            ("-Y" | "+Y", "-X" | "+X") => false,
            ("-X" | "+X", "-Y" | "+Y") => true,
            _ => return Err(other()),
        };
        let [slow, fast] = [slow, fast].map(str::parse::<usize>);
        let (slow, fast) = (slow.map_err(|_| other())?, fast.map_err(|_| other())?);
        let ((vertical, height), (horizontal, width)) =
            if by_columns { ((second, fast), (first, slow)) } else { ((first, slow), (second, fast)) };
        Ok(Self { width, height, by_columns, down: vertical == "-Y", right: horizontal == "+X" })
    }

    /// Returns the number of scanlines, and of pixels of each.
    fn scans(self) -> (usize, usize) {
        if self.by_columns { (self.width, self.height) } else { (self.height, self.width) }
    }

    /// Returns the place, by rows from the upper left, of a pixel of a scanline.
    fn place(self, scan: usize, pixel: usize) -> usize {
        let (row, column) = if self.by_columns { (pixel, scan) } else { (scan, pixel) };
        let row = if self.down { row } else { self.height - 1 - row };
        row * self.width + if self.right { column } else { self.width - 1 - column }
    }
}

/// Returns the value at the middle of the mantissa's step, as Radiance does.
fn value(mantissa: u8, exponent: u8) -> f64 {
    if exponent == 0 { 0.0 } else { (f64::from(mantissa) + 0.5) * 2.0_f64.powi(i32::from(exponent) - 136) }
}

struct Header {
    order: Order,
    /// Start of the pixels, bytes.
    start: usize,
    /// Factors by which the pixels were multiplied.
    scale: [f64; 3],
    /// The file's own primaries.
    primaries: Option<Primaries>,
    /// What is not used.
    notes: Vec<String>,
}

impl Header {
    fn read(bytes: &[u8], shape: Shape) -> Result<Self, Diagnostic> {
        let mut scale = [1.0; 3];
        let (mut primaries, mut notes) = (None, Vec::new());
        let mut at = 0;
        let (mut in_lines, mut is_xyz) = (true, false);
        for number in 1_usize.. {
            let rest = bytes.get(at..).unwrap_or_default();
            // Longest line of a header: 2048 bytes.
            let end = rest.iter().take(2048).position(|byte| *byte == b'\n');
            let wrong = |what| Diagnostic::new(format!("line {number} of the header: {what}"));
            let line = end.map(|end| &rest[..end]).ok_or(wrong(
                "it has no newline within 2048 bytes; expected an empty line after the header, and a line with the size, as -Y 512 +X 1024",
            ))?;
            // Comments and names of files may have any encoding.
            let line = String::from_utf8_lossy(line);
            let line = line.trim_end();
            at += end.unwrap_or_default() + 1;
            if !in_lines {
                let order = Order::read(line)?;
                shape.check_size(order.width, order.height)?;
                if is_xyz {
                    if primaries.replace(XYZ).is_some() {
                        notes.push("PRIMARIES is not used: the colours are X, Y and Z".to_owned());
                    }
                    if shape == Shape::Sphere {
                        notes.push("X, Y and Z are taken in cd/m2, 179 lm/W".to_owned());
                    }
                    scale.iter_mut().for_each(|scale| *scale *= PICTURE_LM_PER_W);
                }
                return Ok(Self { order, start: at.min(bytes.len()), scale, primaries, notes });
            }
            if line.is_empty() {
                in_lines = false;
            } else if Order::read(line).is_ok() {
                return Err(wrong("the size of the picture; expected an empty line before it"));
            } else if let Some(format) = line.strip_prefix("FORMAT=") {
                is_xyz = match format.trim() {
                    "32-bit_rle_rgbe" => false,
                    "32-bit_rle_xyze" => true,
                    _ => {
                        return Err(wrong(
                            "its FORMAT is not supported; expected 32-bit_rle_rgbe or 32-bit_rle_xyze",
                        ));
                    }
                };
            } else if let Some(exposure) = line.strip_prefix("EXPOSURE=") {
                let factor =
                    factors::<1>(exposure).ok_or(wrong("its EXPOSURE is not a number from 1e-12 to 1e12"))?;
                scale.iter_mut().for_each(|scale| *scale *= factor[0]);
            } else if let Some(correction) = line.strip_prefix("COLORCORR=") {
                let by = factors::<3>(correction)
                    .ok_or(wrong("its COLORCORR is not three numbers from 1e-12 to 1e12"))?;
                scale.iter_mut().zip(by).for_each(|(scale, by)| *scale *= by);
            } else if let Some(text) = line.strip_prefix("PRIMARIES=") {
                let numbers: Option<Vec<f64>> =
                    text.split_whitespace().map(|word| word.parse().ok()).collect();
                let [rx, ry, gx, gy, bx, by, wx, wy] = numbers.unwrap_or_default()[..] else {
                    return Err(wrong(
                        "its PRIMARIES are not eight numbers: x and y of red, green, blue and white",
                    ));
                };
                primaries = Some([[rx, ry], [gx, gy], [bx, by], [wx, wy]]);
            } else if let Some(text) = line.strip_prefix("PIXASPECT=") {
                if text.trim().parse() != Ok(1.0) {
                    let pixels = match shape {
                        Shape::Sphere => "cover the whole sphere",
                        Shape::Picture => "are taken as square",
                    };
                    notes.push(format!("PIXASPECT is not used: the pixels {pixels}"));
                }
            } else if let Some(text) = line.strip_prefix("GAMMA=") {
                if text.trim().parse() != Ok(1.0) {
                    notes.push("GAMMA is not used: the pixels are taken as linear".to_owned());
                }
            } else if let Some(text) = line.strip_prefix("VIEW=").filter(|_| shape == Shape::Sphere) {
                notes.push(format!(
                    "VIEW={} is not used: the map is taken as equirectangular",
                    text.trim_end()
                ));
            }
        }
        Err(not_a_map())
    }
}

fn factors<const N: usize>(text: &str) -> Option<[f64; N]> {
    let numbers: Option<Vec<f64>> = text.split_whitespace().map(|word| word.parse().ok()).collect();
    let numbers: [f64; N] = numbers?.try_into().ok()?;
    numbers.iter().all(|number| (1e-12..=1e12).contains(number)).then_some(numbers)
}

/// Error of a scanline.
enum ScanlineError {
    /// The file ends.
    End,
    /// A run does not fit into the row.
    Run,
}

fn take<'a>(input: &mut &'a [u8], count: usize) -> Result<&'a [u8], ScanlineError> {
    let (taken, rest) = input.split_at_checked(count).ok_or(ScanlineError::End)?;
    *input = rest;
    Ok(taken)
}

/// Reads one row in any of the three encodings.
fn scanline(input: &mut &[u8], row: &mut [[u8; 4]]) -> Result<(), ScanlineError> {
    let begins = input.get(..4).ok_or(ScanlineError::End)?;
    let in_runs = (8..32768).contains(&row.len())
        && begins[..2] == [2, 2]
        && usize::from(begins[2]) << 8 | usize::from(begins[3]) == row.len();
    if !in_runs {
        return plain(input, row);
    }
    take(input, 4)?;
    for component in 0..4 {
        let mut at = 0;
        while at < row.len() {
            let count = usize::from(take(input, 1)?[0]);
            let (count, run) = if count > 128 { (count - 128, true) } else { (count, false) };
            let pixels =
                row.get_mut(at..at + count).filter(|pixels| !pixels.is_empty()).ok_or(ScanlineError::Run)?;
            let bytes = take(input, if run { 1 } else { count })?;
            for (k, pixel) in pixels.iter_mut().enumerate() {
                pixel[component] = bytes[if run { 0 } else { k }];
            }
            at += count;
        }
    }
    Ok(())
}

/// Reads a row pixel by pixel; a pixel 1, 1, 1, n repeats the previous one n times.
fn plain(input: &mut &[u8], row: &mut [[u8; 4]]) -> Result<(), ScanlineError> {
    let (mut at, mut shift) = (0, 0);
    while at < row.len() {
        let pixel = take(input, 4)?;
        let pixel = [pixel[0], pixel[1], pixel[2], pixel[3]];
        if pixel[..3] != [1, 1, 1] {
            (row[at], at, shift) = (pixel, at + 1, 0);
            continue;
        }
        let before = at.checked_sub(1).map(|k| row[k]).ok_or(ScanlineError::Run)?;
        let count = usize::from(pixel[3]).checked_shl(shift).ok_or(ScanlineError::Run)?;
        shift += 8;
        row.get_mut(at..at.saturating_add(count)).ok_or(ScanlineError::Run)?.fill(before);
        at += count;
        if shift > 24 {
            return Err(ScanlineError::Run);
        }
    }
    Ok(())
}
