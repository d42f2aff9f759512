//! Writers of pictures: what a panel gets, and what a reader sees.

use std::collections::HashSet;
use std::io::{self, Write};

use png::{BitDepth, ColorType, DeflateCompression, Encoder, Filter, SrgbRenderingIntent};

/// Writes the states of a picture as an indexed PNG, 8 bits a pixel: `palette` has the encoded sRGB colour of
/// each state, and the pixels the number of their state. The first row is at the top.
///
/// # Errors
/// If the system reports an error, the picture does not consist of whole rows, or a state is not in the
/// palette.
pub fn write_indexed_png(
    out: &mut dyn Write,
    columns: usize,
    states: &[u8],
    palette: &[[u8; 3]],
) -> io::Result<()> {
    write_named_png(out, columns, states, palette, None)
}

/// The same, with a text of a keyword.
pub(crate) fn write_named_png(
    out: &mut dyn Write,
    columns: usize,
    states: &[u8],
    palette: &[[u8; 3]],
    text: Option<(&str, &str)>,
) -> io::Result<()> {
    if palette.is_empty()
        || palette.len() > 256
        || states.iter().any(|state| usize::from(*state) >= palette.len())
    {
        return Err(io::Error::other("a state of the picture is not in its palette of 1 to 256 colours"));
    }
    let [width, height] = size(columns, states.len())?;
    let mut encoder = Encoder::new(out, width, height);
    encoder.set_color(ColorType::Indexed);
    encoder.set_depth(BitDepth::Eight);
    // More effort takes four times as long for a tenth less.
    encoder.set_deflate_compression(DeflateCompression::Level(4));
    encoder.set_filter(Filter::NoFilter);
    encoder.set_palette(palette.concat());
    if let Some((keyword, text)) = text {
        encoder.add_itxt_chunk(keyword.to_owned(), text.to_owned())?;
    }
    encoder.set_source_srgb(SrgbRenderingIntent::RelativeColorimetric);
    finish(encoder, states)
}

/// Writes encoded red, green and blue as an 8-bit PNG that states its colour space: sRGB, or Display P3.
///
/// # Errors
/// If the system reports an error, or the picture does not consist of whole rows.
pub fn write_rgb_png(
    out: &mut dyn Write,
    columns: usize,
    pixels: &[[u8; 3]],
    is_display_p3: bool,
) -> io::Result<()> {
    let [width, height] = size(columns, pixels.len())?;
    let mut encoder = Encoder::new(out, width, height);
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(BitDepth::Eight);
    // More effort hardly makes halftones smaller.
    encoder.set_deflate_compression(DeflateCompression::Level(1));
    if has_few_colours(pixels) {
        encoder.set_filter(Filter::NoFilter);
    }
    if !is_display_p3 {
        encoder.set_source_srgb(SrgbRenderingIntent::RelativeColorimetric);
        return finish(encoder, pixels.as_flattened());
    }
    let mut writer = encoder.write_header()?;
    // ITU-T H.273: primaries of P3 under D65, transfer function of sRGB, RGB, full range.
    writer.write_chunk(png::chunk::ChunkType(*b"cICP"), &[12, 13, 0, 1])?;
    writer.write_image_data(pixels.as_flattened())?;
    Ok(writer.finish()?)
}

/// Pixels of which the colours are counted.
const SAMPLES: usize = 4096;

/// Whether a picture seems to have the colours of a few states only: such a file without differences of neighbours is smaller, and written
/// in half of the time.
fn has_few_colours(pixels: &[[u8; 3]]) -> bool {
    let samples = pixels.iter().step_by((pixels.len() / SAMPLES).max(1));
    samples.collect::<HashSet<_>>().len() <= 32
}

/// Writes rows of bytes with 1 bit for each pixel as a PNG of black (0) and white (1).
pub(crate) fn write_grey_bits(
    out: &mut dyn Write,
    [columns, rows]: [usize; 2],
    data: &[u8],
) -> io::Result<()> {
    let [width, height] = size(columns, columns * rows)?;
    let mut encoder = Encoder::new(out, width, height);
    encoder.set_color(ColorType::Grayscale);
    encoder.set_depth(BitDepth::One);
    finish(encoder, data)
}

fn finish(encoder: Encoder<'_, &mut dyn Write>, data: &[u8]) -> io::Result<()> {
    let mut writer = encoder.write_header()?;
    writer.write_image_data(data)?;
    Ok(writer.finish()?)
}

/// Writes a scene-referred OpenEXR file: linear red, green and blue of sRGB's primaries as 32-bit numbers, 1
/// for a perfect white, whose luminance in cd/m2 is the attribute `whiteLuminance`.
///
/// Rows follow each other without compression, which hardly makes the numbers of a halftone fewer: nothing of the file is kept.
///
/// # Errors
/// If the system reports an error, or the picture does not consist of whole rows.
pub fn write_scene_exr(
    out: &mut dyn Write,
    columns: usize,
    pixels: usize,
    mut linear: impl FnMut(usize) -> [f32; 3],
    white_cd_m2: Option<f32>,
) -> io::Result<()> {
    let [width, height] = size(columns, pixels)?;
    let header = exr_header([width, height], white_cd_m2)?;
    out.write_all(&header)?;
    let row_bytes = 3 * size_of::<f32>() * columns;
    let block = 2 * size_of::<u32>() + row_bytes;
    let first = header.len() + size_of::<u64>() * height as usize;
    for row in 0..height as usize {
        out.write_all(&((first + row * block) as u64).to_le_bytes())?;
    }
    let mut bytes = vec![0; block];
    for row in 0..height {
        bytes[..4].copy_from_slice(&row.to_le_bytes());
        bytes[4..8].copy_from_slice(&(row_bytes as u32).to_le_bytes());
        // The channels of a row follow each other in alphabetical order.
        let (blue, rest) = bytes[8..].split_at_mut(row_bytes / 3);
        let (green, red) = rest.split_at_mut(row_bytes / 3);
        let [blue, green, red] = [blue, green, red].map(|channel| channel.as_chunks_mut().0);
        let first = row as usize * columns;
        for (at, ((red, green), blue)) in red.iter_mut().zip(green).zip(blue).enumerate() {
            [*red, *green, *blue] = linear(first + at).map(f32::to_le_bytes);
        }
        out.write_all(&bytes)?;
    }
    Ok(())
}

/// The first bytes of an OpenEXR file with rows of blue, green and red as 32-bit numbers, up to the table of the places of its rows
/// (openexr.com, *OpenEXR File Layout*).
fn exr_header([width, height]: [u32; 2], white_cd_m2: Option<f32>) -> io::Result<Vec<u8>> {
    let too_large = || io::Error::other("an OpenEXR file has at most 2^31 columns or rows");
    let last = |count: u32| i32::try_from(count - 1).map_err(|_| too_large());
    let window: Vec<u8> =
        [0, 0, last(width)?, last(height)?].iter().flat_map(|side| side.to_le_bytes()).collect();
    const FLOAT: u32 = 2;
    let channel = |name: u8| {
        // Perceived as linear, and three reserved bytes; then the steps of its samples.
        let numbers: [u32; 4] = [FLOAT, 0, 1, 1];
        [name, 0].into_iter().chain(numbers.into_iter().flat_map(u32::to_le_bytes))
    };
    let channels: Vec<u8> = b"BGR".iter().flat_map(|name| channel(*name)).chain([0]).collect();
    let one = 1.0_f32.to_le_bytes();
    let mut header = vec![0x76, 0x2f, 0x31, 0x01, 2, 0, 0, 0];
    let mut attribute = |name: &str, kind: &str, value: &[u8]| {
        for text in [name, kind] {
            header.extend(text.as_bytes());
            header.push(0);
        }
        header.extend((value.len() as u32).to_le_bytes());
        header.extend(value);
    };
    attribute("channels", "chlist", &channels);
    attribute("compression", "compression", &[0]);
    attribute("dataWindow", "box2i", &window);
    attribute("displayWindow", "box2i", &window);
    attribute("lineOrder", "lineOrder", &[0]);
    attribute("pixelAspectRatio", "float", &one);
    attribute("screenWindowCenter", "v2f", &[0; 8]);
    attribute("screenWindowWidth", "float", &one);
    if let Some(white) = white_cd_m2 {
        attribute("whiteLuminance", "float", &white.to_le_bytes());
    }
    header.push(0);
    Ok(header)
}

/// Columns and rows.
fn size(columns: usize, pixels: usize) -> io::Result<[u32; 2]> {
    let whole = columns > 0 && pixels > 0 && pixels.is_multiple_of(columns);
    let size = whole.then(|| [columns, pixels / columns].map(u32::try_from));
    match size {
        Some([Ok(columns), Ok(rows)]) => Ok([columns, rows]),
        _ => Err(io::Error::other(format!("a picture of {pixels} pixels has no rows of {columns}"))),
    }
}
