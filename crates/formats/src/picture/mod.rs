//! Pictures: PNG, JPEG, SVG, OpenEXR and Radiance files as linear light, and PNG and OpenEXR files of what a display shows.
//!
//! A picture in memory keeps the samples of its file; [`SourcePicture::row`] converts them to X, Y, Z row by
//! row, so that a picture of 64 megapixels never exists as three planes of real numbers.

mod colour_space;
mod exif;
mod icc;
mod icc_table;
mod jpeg;
mod other;
mod png_read;
mod scene;
mod source;
mod transfer;
mod write;

pub use colour_space::RgbSpace;
pub use other::picture_format;
pub(crate) use other::{a_file, convert_to, picture_for_text};
pub use source::SourcePicture;
pub use transfer::Transfer;
pub(crate) use write::{write_grey_bits, write_named_png};
pub use write::{write_indexed_png, write_rgb_png, write_scene_exr};

use papilio_diagnostics::{Diagnostic, Warned};

use crate::error::FormatError;
use crate::file::DataFile;
use crate::light::{Shape, read_linear};

/// Largest size of the file of a picture, bytes.
pub const LARGEST_PICTURE_FILE: u64 = 512 << 20;

/// Largest number of pixels of a picture.
pub const MOST_PICTURE_PIXELS: usize = 64_000_000;

/// Reads a PNG, JPEG, OpenEXR or Radiance file, or with the feature `svg` a drawing, detected from the content.
///
/// Pictures of high dynamic range (OpenEXR, Radiance) whose values exceed 1 have no white: `scene.rs` chooses one.
///
/// The colour space is that of the file: for PNG the first of its chunks cICP, iCCP, sRGB, gAMA with cHRM;
/// for JPEG its ICC profile. A file that states none is in `untagged`, usually [`RgbSpace::srgb`].
/// Transparent pixels of all formats are composited over white, in linear light (within a drawing, as browsers do); the orientation of EXIF is applied; of an
/// animation the first picture is read. Warnings report all of that.
///
/// # Errors
/// If the file is neither, is damaged or cut off, or has more than [`MOST_PICTURE_PIXELS`]; sizes are checked
/// before memory is allocated. If it is a PNG file whose encoding is one of high dynamic range.
pub fn read_picture(file: &DataFile, untagged: &RgbSpace) -> Result<Warned<SourcePicture>, FormatError> {
    crate::guard::read(file, |file| of_any_format(file, untagged))
}

fn of_any_format(file: &DataFile, untagged: &RgbSpace) -> Result<Warned<SourcePicture>, FormatError> {
    let picture = if file.bytes.starts_with(png_read::MAGIC) {
        png_read::read(&file.bytes, untagged)
    } else if file.bytes.starts_with(&jpeg::MAGIC) {
        jpeg::read(&file.bytes, untagged)
    } else if let Some(linear) = read_linear(&file.bytes, Shape::Picture) {
        linear.and_then(scene::developed)
    } else {
        #[cfg(feature = "svg")]
        if picture_format(&file.bytes) == Some("SVG") {
            return drawing(file);
        }
        Err(match picture_format(&file.bytes) {
            Some(format) => other_format(format),
            None if file.bytes.is_empty() => {
                Diagnostic::new("this file is empty").expected(SUPPORTED).hint("copy or download it again")
            }
            None => Diagnostic::new("this is not a picture in a supported format")
                .expected(SUPPORTED)
                .hint("save the picture as PNG in the program that created it"),
        })
    };
    picture.map_err(|problem| FormatError::whole(&file.name, problem))
}

/// The warning of a picture with transparent pixels.
const TRANSPARENT: &str = "transparent pixels are composited over white, in linear light";

/// Reads a drawing.
#[cfg(feature = "svg")]
fn drawing(file: &DataFile) -> Result<Warned<SourcePicture>, FormatError> {
    let drawn = crate::svg::picture::rasterised(&file.bytes);
    let picture = drawn.and_then(|png| {
        let picture = png_read::read(&png.value, &RgbSpace::srgb())?;
        Ok(Warned { warnings: png.warnings.into_iter().chain(picture.warnings).collect(), ..picture })
    });
    picture.map_err(|problem| FormatError::whole(&file.name, problem))
}

/// What is read.
const SUPPORTED: &str = if cfg!(feature = "svg") {
    "a PNG, JPEG, SVG, OpenEXR (.exr) or Radiance (.hdr) file"
} else {
    "a PNG, JPEG, OpenEXR (.exr) or Radiance (.hdr) file"
};

/// Fails unless a picture has a permitted size.
pub(crate) fn check_size(columns: usize, rows: usize) -> Result<(), Diagnostic> {
    let fits = columns.checked_mul(rows).is_some_and(|pixels| (1..=MOST_PICTURE_PIXELS).contains(&pixels));
    let wrong = || Diagnostic::new(format!("this picture has {columns} x {rows} pixels"));
    let hint = "reduce the picture: a panel has a few million pixels; for example by ImageMagick: magick picture.png -resize 4000x4000 small.png";
    if fits { Ok(()) } else { Err(wrong().expected("1 to 64 million pixels").hint(hint)) }
}

fn other_format(format: &'static str) -> Diagnostic {
    Diagnostic::new(format!("this is {}, which is not supported", a_file(format)))
        .expected(SUPPORTED)
        .hint(convert_to(format, "PNG"))
}

/// Hint for a damaged file.
const AGAIN: &str = "the file is damaged or incomplete: copy or download it again, or save it again in the program that created it";

fn damaged(format: &str, message: &str) -> Diagnostic {
    Diagnostic::new(format!("this {format} file cannot be decoded: {message}")).hint(AGAIN)
}

fn cut_off(format: &str) -> Diagnostic {
    Diagnostic::new(format!("this {format} file ends before its picture is complete")).hint(AGAIN)
}

fn unsupported(what: &str, expected: &str) -> Diagnostic {
    Diagnostic::new(format!("{what} is not supported")).expected(expected)
}
