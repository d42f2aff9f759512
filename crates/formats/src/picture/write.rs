//! Writers of pictures: what a panel gets, and what a reader sees.

use std::io::{self, Cursor, Write};

use exr::prelude::{Encoding as ExrEncoding, Image, Layer, LayerAttributes, SpecificChannels, WritableImage};
use png::{BitDepth, ColorType, DeflateCompression, Encoder, SrgbRenderingIntent};

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
/// # Errors
/// If the system reports an error, or the picture does not consist of whole rows.
pub fn write_scene_exr(
    out: &mut dyn Write,
    columns: usize,
    pixels: usize,
    linear: impl Fn(usize) -> [f32; 3] + Sync,
    white_cd_m2: Option<f32>,
) -> io::Result<()> {
    let [width, height] = size(columns, pixels)?.map(|side| side as usize);
    let attributes = LayerAttributes { white_luminance: white_cd_m2, ..LayerAttributes::default() };
    let pixel = |at: exr::math::Vec2<usize>| {
        let [red, green, blue] = linear(at.y() * columns + at.x());
        (red, green, blue)
    };
    let layer =
        Layer::new((width, height), attributes, ExrEncoding::FAST_LOSSLESS, SpecificChannels::rgb(pixel));
    // Runs of equal bytes hardly make the numbers of a halftone fewer.
    let mut bytes = Cursor::new(Vec::with_capacity(13 * pixels));
    let written = Image::from_layer(layer).write().non_parallel().to_buffered(&mut bytes);
    written.map_err(|error| io::Error::other(error.to_string()))?;
    out.write_all(&bytes.into_inner())
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
