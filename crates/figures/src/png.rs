//! PNG: our own SVG, rasterised.
//!
//! The letters are those of `fonts/` and no others, so that a figure has the same pixels on
//! every machine; a character that they lack is left out.
//!
//! What does this is compiled with the feature `png`, which builds of the programs have unless it is turned off.

#[cfg(feature = "png")]
use std::sync::{Arc, OnceLock};

#[cfg(feature = "png")]
use resvg::{
    tiny_skia::{Pixmap, Transform},
    usvg::{self, fontdb},
};

/// Whether pictures can be made: the feature `png`.
pub const HAS_PNG: bool = cfg!(feature = "png");

/// Why a figure could not be rasterised.
#[derive(Debug, thiserror::Error)]
pub enum PngError {
    /// The feature is off.
    #[error(
        "this papilio was built without PNG pictures; `cargo build --release --package papilio` builds it with the feature `png` on"
    )]
    NotBuilt,
    /// The text is not SVG.
    #[cfg(feature = "png")]
    #[error("this is not an SVG figure: {0}")]
    NotSvg(#[from] usvg::Error),
    /// It has no pixel, or there is no memory for them.
    #[error("a picture of {width} x {height} pixels cannot be made")]
    NoPixels {
        /// px.
        width: u32,
        /// px.
        height: u32,
    },
    /// The pixels could not be packed.
    #[error("the picture cannot be encoded: {0}")]
    Encoding(String),
}

/// No picture is larger than this many pixels either way.
#[cfg(feature = "png")]
const LARGEST: f32 = 16_384.0;

/// Pixels for each px of an SVG, in the pictures that Papilio's programs write.
pub const PNG_SCALE: f32 = 2.0;

/// A figure as PNG, `scale` pixels for each px of its SVG (2 suits paper and screens alike),
/// less where it would be larger than 16384 pixels either way.
///
/// # Errors
/// If `svg` is not SVG, or not even a pixel large; without the feature, always.
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

/// Says that the feature `png` is off.
///
/// # Errors
/// Always.
#[cfg(not(feature = "png"))]
pub fn png(_: &str, _: f32) -> Result<Vec<u8>, PngError> {
    Err(PngError::NotBuilt)
}

/// The font database, filled once.
#[cfg(feature = "png")]
fn fonts() -> Arc<fontdb::Database> {
    static FONTS: OnceLock<Arc<fontdb::Database>> = OnceLock::new();
    let fill = || {
        let mut fonts = fontdb::Database::new();
        fonts.load_font_data(include_bytes!("../fonts/Roboto-Regular.ttf").to_vec());
        fonts.load_font_data(include_bytes!("../fonts/Roboto-Bold.ttf").to_vec());
        fonts.set_sans_serif_family("Roboto");
        Arc::new(fonts)
    };
    Arc::clone(FONTS.get_or_init(fill))
}
