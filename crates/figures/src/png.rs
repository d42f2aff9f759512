//! PNG images of the SVG figures.
//!
//! Only the fonts of `papilio_imaging::text` are used, so that a figure has the same pixels on
//! every machine. Characters that they lack are omitted.
//!
//! The rasteriser is compiled with the feature `png`, which builds of the programs have by default.

#[cfg(feature = "png")]
use std::sync::{Arc, OnceLock};

#[cfg(feature = "png")]
use resvg::{
    tiny_skia::{Pixmap, Transform},
    usvg::{self, fontdb},
};

/// Whether PNG images can be made: the feature `png`.
pub const HAS_PNG: bool = cfg!(feature = "png");

/// Why a figure could not be rasterised.
#[derive(Debug, thiserror::Error)]
pub enum PngError {
    /// The feature `png` is off.
    #[error(
        "this papilio was built without PNG pictures; `cargo build --release --package papilio` builds it with the feature `png` on"
    )]
    NotBuilt,
    /// The text is not SVG.
    #[cfg(feature = "png")]
    #[error("this is not an SVG figure: {0}")]
    NotSvg(#[from] usvg::Error),
    /// The image has no pixels, or there is not enough memory for them.
    #[error("cannot make an image of {width} x {height} pixels")]
    NoPixels {
        /// Width, px.
        width: u32,
        /// Height, px.
        height: u32,
    },
    /// The image could not be encoded.
    #[error("cannot encode the image: {0}")]
    Encoding(String),
}

/// Largest width and height of an image, pixels.
#[cfg(feature = "png")]
const LARGEST: f32 = 16_384.0;

/// Pixels per px of an SVG in the images that Papilio's programs write.
pub const PNG_SCALE: f32 = 2.0;

/// Rasterises a figure as PNG, with `scale` pixels per px of the SVG (2 suits both paper and screens),
/// or fewer if the image would exceed 16384 pixels in width or height.
///
/// # Errors
/// If `svg` is not SVG, or the image would have no pixels; without the feature `png`, always.
#[cfg(feature = "png")]
pub fn png(svg: &str, scale: f32) -> Result<Vec<u8>, PngError> {
    let options = usvg::Options { fontdb: fonts(), ..usvg::Options::default() };
    let tree = usvg::Tree::from_str(svg, &options)?;
    let size = tree.size();
    let scale = scale.min(LARGEST / size.width().max(size.height()));
    let [width, height] = [size.width(), size.height()].map(|length| (scale * length).ceil() as u32);
    let mut pixmap = Pixmap::new(width, height).ok_or(PngError::NoPixels { width, height })?;
    resvg::render(&tree, Transform::from_scale(scale, scale), &mut pixmap.as_mut());
    pixmap.encode_png().map_err(|error| PngError::Encoding(error.to_string()))
}

/// Returns the error that the feature `png` is off.
///
/// # Errors
/// Always.
#[cfg(not(feature = "png"))]
pub fn png(_: &str, _: f32) -> Result<Vec<u8>, PngError> {
    Err(PngError::NotBuilt)
}

/// Returns the font database, which is filled once.
#[cfg(feature = "png")]
fn fonts() -> Arc<fontdb::Database> {
    static FONTS: OnceLock<Arc<fontdb::Database>> = OnceLock::new();
    let fill = || {
        let mut fonts = fontdb::Database::new();
        fonts.load_font_data(papilio_imaging::text::ROBOTO.to_vec());
        fonts.load_font_data(papilio_imaging::text::ROBOTO_BOLD.to_vec());
        fonts.set_sans_serif_family("Roboto");
        Arc::new(fonts)
    };
    Arc::clone(FONTS.get_or_init(fill))
}
