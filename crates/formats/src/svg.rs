//! Drawings (SVG) as pixels: figures as PNG images, and drawings as pictures to show.
//!
//! Only the fonts of `papilio_imaging::text` are used, so that a drawing has the same pixels on every machine: all text is in Roboto, and
//! characters that it lacks are omitted, with a warning.
//!
//! The rasteriser is compiled with the feature `svg`, which builds of the programs have by default.

#[cfg(feature = "svg")]
use std::sync::atomic::{AtomicBool, Ordering};
#[cfg(feature = "svg")]
use std::sync::{Arc, OnceLock};

use papilio_diagnostics::Warned;
#[cfg(feature = "svg")]
use resvg::{
    tiny_skia::{Color, Pixmap, Transform},
    usvg::{self, fontdb},
};

/// Whether PNG images can be made, and drawings be read as pictures: the feature `svg`.
pub const HAS_PNG: bool = cfg!(feature = "svg");

/// Why a figure could not be rasterised.
#[derive(Debug, thiserror::Error)]
pub enum PngError {
    /// The feature `svg` is off.
    #[error(
        "this papilio was built without PNG pictures; `cargo build --release --package papilio` builds it with the feature `png` on"
    )]
    NotBuilt,
    /// The text is not SVG.
    #[cfg(feature = "svg")]
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
#[cfg(feature = "svg")]
const LARGEST: f32 = 16_384.0;

/// Pixels per px of an SVG in the images that Papilio's programs write.
pub const PNG_SCALE: f32 = 2.0;

/// Rasterises a figure as PNG, with `scale` pixels per px of the SVG (2 suits both paper and screens),
/// or fewer if the image would exceed 16384 pixels in width or height. A warning names the letters that the image lacks.
///
/// # Errors
/// If `svg` is not SVG, or the image would have no pixels; without the feature `svg`, always.
#[cfg(feature = "svg")]
pub fn png(svg: &str, scale: f32) -> Result<Warned<Vec<u8>>, PngError> {
    let (tree, lacks_letters) = tree_and_letters(svg)?;
    let [width, height] = [tree.size().width(), tree.size().height()];
    let scale = scale.min(LARGEST / width.max(height));
    let size = [width, height].map(|length| (scale * length).ceil() as u32);
    let value = rendered(&tree, size, scale, Color::TRANSPARENT)?;
    let left_out = if lacks_letters { letters_left_out(svg) } else { Vec::new() };
    let warning =
        || format!("letters that Roboto lacks are left out: {}; the SVG file has them", listed(&left_out));
    let warnings = (!left_out.is_empty()).then(warning).into_iter().collect();
    Ok(Warned { value, warnings })
}

/// Returns the error that the feature `svg` is off.
///
/// # Errors
/// Always.
#[cfg(not(feature = "svg"))]
pub fn png(_: &str, _: f32) -> Result<Warned<Vec<u8>>, PngError> {
    Err(PngError::NotBuilt)
}

#[cfg(feature = "svg")]
fn rendered(
    tree: &usvg::Tree,
    [width, height]: [u32; 2],
    scale: f32,
    background: Color,
) -> Result<Vec<u8>, PngError> {
    let mut pixels = Pixmap::new(width, height).ok_or(PngError::NoPixels { width, height })?;
    pixels.fill(background);
    resvg::render(tree, Transform::from_scale(scale, scale), &mut pixels.as_mut());
    pixels.encode_png().map_err(|error| PngError::Encoding(error.to_string()))
}

/// A drawing, and whether its text has letters that the fonts lack.
#[cfg(feature = "svg")]
fn tree_and_letters(svg: &str) -> Result<(usvg::Tree, bool), usvg::Error> {
    let lacks = AtomicBool::new(false);
    let usual = usvg::FontResolver::default_fallback_selector();
    let select_fallback = |letter: char, used: &[fontdb::ID], fonts: &mut Arc<fontdb::Database>| {
        let found = usual(letter, used, fonts);
        lacks.fetch_or(found.is_none(), Ordering::Relaxed);
        found
    };
    let font_resolver = usvg::FontResolver {
        select_font: usvg::FontResolver::default_font_selector(),
        select_fallback: Box::new(select_fallback),
    };
    let options = usvg::Options { fontdb: fonts(), font_resolver, ..usvg::Options::default() };
    let tree = usvg::Tree::from_str(svg, &options)?;
    drop(options);
    Ok((tree, lacks.into_inner()))
}

/// Most letters that a warning names.
#[cfg(feature = "svg")]
const MOST_LETTERS: usize = 20;

/// Letters in words.
#[cfg(feature = "svg")]
fn listed(letters: &[char]) -> String {
    let named: Vec<String> = letters.iter().take(MOST_LETTERS).map(char::to_string).collect();
    let more = letters.len().saturating_sub(MOST_LETTERS);
    let more = if more > 0 { format!(" and {more} others") } else { String::new() };
    format!("{}{more}", named.join(" "))
}

/// Returns the letters of a drawing's texts that the fonts lack, each once, in their order; they are left out of the picture.
#[cfg(feature = "svg")]
fn letters_left_out(svg: &str) -> Vec<char> {
    let options = usvg::roxmltree::ParsingOptions { allow_dtd: true, ..Default::default() };
    let Ok(document) = usvg::roxmltree::Document::parse_with_options(svg, options) else { return Vec::new() };
    let texts = document.descendants().filter(|node| node.is_text());
    let shown = texts.filter(|node| node.ancestors().any(|above| above.has_tag_name((SVG, "text"))));
    let all: String = shown.filter_map(|node| node.text()).collect();
    papilio_imaging::text::Font::bundled().missing(&all)
}

/// The namespace of drawings.
#[cfg(feature = "svg")]
const SVG: &str = "http://www.w3.org/2000/svg";

/// Returns the font database, which is filled once.
#[cfg(feature = "svg")]
fn fonts() -> Arc<fontdb::Database> {
    static FONTS: OnceLock<Arc<fontdb::Database>> = OnceLock::new();
    let fill = || {
        let mut fonts = fontdb::Database::new();
        fonts.load_font_data(papilio_imaging::text::ROBOTO.to_vec());
        fonts.load_font_data(papilio_imaging::text::ROBOTO_BOLD.to_vec());
        // The family of text whose own one is missing.
        fonts.set_serif_family("Roboto");
        fonts.set_sans_serif_family("Roboto");
        Arc::new(fonts)
    };
    Arc::clone(FONTS.get_or_init(fill))
}

/// Drawings as pictures.
#[cfg(feature = "svg")]
pub(crate) mod picture {
    use papilio_diagnostics::{Diagnostic, Warned};
    use resvg::tiny_skia::Color;
    use resvg::usvg::{Group, Node};

    use super::{letters_left_out, listed, rendered, tree_and_letters};
    use crate::picture::{check_size, convert_to};

    /// A drawing that is shorter than this is rasterised at a multiple of its size, pixels.
    const SHORT: f32 = 600.0;

    /// Most memory that transparent groups, masks and filters within each other take at a time, bytes.
    const MOST_LAYERS: f64 = (256 << 20) as f64;

    /// Rasterises a drawing over white, as a browser shows it, at its own size in pixels or at a whole multiple of it: a PNG file.
    ///
    /// # Errors
    /// If the file is not SVG; if the picture has too many pixels, or its layers need too much memory.
    pub(crate) fn rasterised(bytes: &[u8]) -> Result<Warned<Vec<u8>>, Diagnostic> {
        let wrong = |why: String| {
            Diagnostic::new(format!("this SVG file cannot be drawn: {why}")).hint(convert_to("SVG", "PNG"))
        };
        let text = std::str::from_utf8(bytes).map_err(|error| wrong(error.to_string()))?;
        let (tree, lacks_letters) = tree_and_letters(text).map_err(|error| wrong(error.to_string()))?;
        let left_out = if lacks_letters { letters_left_out(text) } else { Vec::new() };
        let letters = listed(&left_out);
        if tree.root().children().is_empty() {
            let why = if left_out.is_empty() {
                String::new()
            } else {
                format!(": Roboto lacks its letters {letters}")
            };
            return Err(wrong(format!("it draws nothing{why}")));
        }
        let size = [tree.size().width(), tree.size().height()];
        let longest = size[0].max(size[1]);
        let scale = if longest < SHORT { (2.0 * SHORT / longest).floor() } else { 1.0 };
        let [width, height] = size.map(|length| f64::from(scale * length).ceil());
        check_size(width as usize, height as usize)?;
        let layers = layers(tree.root()) * f64::from(scale * scale);
        if layers > MOST_LAYERS {
            let need =
                format!("its transparent groups and filters would need {:.0} MB at a time", layers / 1e6);
            return Err(wrong(need));
        }
        let png = rendered(&tree, [width, height].map(|length| length as u32), scale, Color::WHITE);
        let value = png.map_err(|error| wrong(error.to_string()))?;
        let mut warnings =
            vec![format!("this drawing is rasterised as a picture of {width} x {height} pixels")];
        let has = |what: &str| text.contains(what);
        if has("<text") && !has("Roboto") {
            warnings.push("text in this drawing is drawn in Roboto".to_owned());
        }
        if !left_out.is_empty() {
            warnings.push(format!(
                "letters that Roboto lacks are left out: {letters} (draw them as paths in the program that created the drawing)"
            ));
        }
        if has("<image") {
            warnings.push("pictures in this drawing are left out".to_owned());
        }
        if has("<foreignObject") {
            warnings.push("HTML in this drawing is left out".to_owned());
        }
        Ok(Warned { value, warnings })
    }

    /// Returns the memory of the layers that a group needs at a time, bytes.
    fn layers(group: &Group) -> f64 {
        let area = group.layer_bounding_box();
        let buffers = match (group.should_isolate(), group.filters().is_empty()) {
            (_, false) => 4.0,
            (true, true) => 1.0,
            (false, true) => 0.0,
        };
        let own = buffers * 4.0 * f64::from(area.width()) * f64::from(area.height());
        let of_child = |node: &Node| match node {
            Node::Group(group) => layers(group),
            _ => 0.0,
        };
        own + group.children().iter().map(of_child).fold(0.0, f64::max)
    }
}
