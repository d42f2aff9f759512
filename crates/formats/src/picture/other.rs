//! Picture formats that are recognised, to be refused by their names.

/// A picture format, and the brand or first bytes of its files.
const BY_FIRST_BYTES: [(&str, &[u8]); 17] = [
    ("GIF", b"GIF87a"),
    ("GIF", b"GIF89a"),
    ("TIFF", b"II*\0"),
    ("TIFF", b"MM\0*"),
    ("TIFF", b"II+\0"),
    ("TIFF", b"MM\0+"),
    ("JPEG XL", b"\xff\x0a"),
    ("JPEG XL", b"\0\0\0\x0cJXL "),
    ("JPEG 2000", b"\0\0\0\x0cjP  "),
    ("JPEG 2000", b"\xff\x4f\xff\x51"),
    ("Photoshop", b"8BPS"),
    ("PDF", b"%PDF-"),
    ("Portable Anymap", b"P6\n"),
    ("Portable Anymap", b"P5\n"),
    ("Portable Float Map", b"PF\n"),
    ("PNG", b"\x89PNG\r\n\x1a\n"),
    ("JPEG", b"\xff\xd8\xff"),
];

/// Brands of the ISO base media file format.
const BRANDS: [(&str, &[u8; 4]); 9] = [
    ("AVIF", b"avif"),
    ("AVIF", b"avis"),
    ("HEIC", b"heic"),
    ("HEIC", b"heix"),
    ("HEIC", b"heim"),
    ("HEIC", b"heis"),
    ("HEIC", b"hevc"),
    ("HEIC", b"mif1"),
    ("HEIC", b"msf1"),
];

/// Returns the name of the format of a picture; `None` for other files, Radiance pictures and OpenEXR files.
pub fn picture_format(bytes: &[u8]) -> Option<&'static str> {
    if bytes.starts_with(b"RIFF") && bytes.get(8..12) == Some(b"WEBP") {
        return Some("WebP");
    }
    if bytes.get(4..8) == Some(b"ftyp") {
        let brand = bytes.get(8..12)?;
        return BRANDS.iter().find(|(_, known)| *known == brand).map(|(name, _)| *name);
    }
    if let Some(name) = text_format(bytes) {
        return Some(name);
    }
    // Two letters are no signature: the reserved bytes of the header are zero.
    if bytes.starts_with(b"BM") && bytes.get(6..10) == Some(&[0; 4]) {
        return Some("BMP");
    }
    BY_FIRST_BYTES.iter().find(|(_, first)| bytes.starts_with(first)).map(|(name, _)| *name)
}

/// Formats of whole pages, with text.
const PAGES: [&str; 2] = ["HTML", "PDF"];

/// First bytes of pictures that are read as maps of light, too.
const OF_LIGHT: [(&str, &[u8]); 3] =
    [("Radiance", b"#?RADIANCE"), ("Radiance", b"#?RGBE"), ("OpenEXR", b"\x76\x2f\x31\x01")];

/// The format of a picture that was given in place of a text; `None` for other files.
pub(crate) fn picture_for_text(bytes: &[u8]) -> Option<&'static str> {
    let of_light = OF_LIGHT.iter().find(|(_, first)| bytes.starts_with(first)).map(|(name, _)| *name);
    picture_format(bytes).or(of_light).filter(|format| !PAGES.contains(format))
}

/// Bytes at the beginning of a text in which its first element stands.
const HEAD_OF_TEXT: usize = 4096;

/// Elements of texts that browsers show as pictures; a page may contain a drawing.
const ELEMENTS: [(&str, &[u8]); 3] = [("HTML", b"<!doctype html"), ("HTML", b"<html"), ("SVG", b"<svg")];

/// The name of a text in XML or HTML: comments and a document type may be before its element.
fn text_format(bytes: &[u8]) -> Option<&'static str> {
    let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes).trim_ascii_start();
    let head = bytes[..bytes.len().min(HEAD_OF_TEXT)].to_ascii_lowercase();
    let has = |element: &[u8]| head.windows(element.len()).any(|part| part == element);
    let found = ELEMENTS.iter().find(|(_, element)| head.starts_with(b"<") && has(element));
    found.map(|(name, _)| *name)
}

/// A file of a format, with its article.
pub(crate) fn a_file(format: &str) -> String {
    let is_spoken_with_a_vowel = ["AVIF", "HTML", "OpenEXR", "SVG"].contains(&format);
    format!("{} {format} file", if is_spoken_with_a_vowel { "an" } else { "a" })
}

/// Formats whose files may have several pictures, of which the first is taken.
const WITH_SEVERAL: [&str; 4] = ["GIF", "PDF", "Photoshop", "TIFF"];

/// Endings of the names of files, where they are not the name of the format in small letters.
const ENDINGS: [(&str, &str); 8] = [
    ("JPEG XL", "jxl"),
    ("JPEG 2000", "jp2"),
    ("Photoshop", "psd"),
    ("Portable Anymap", "ppm"),
    ("Portable Float Map", "pfm"),
    ("Radiance", "hdr"),
    ("OpenEXR", "exr"),
    ("JPEG", "jpg"),
];

/// What to do with a picture of a format that is not read: the hint of an error, with the command of a common
/// tool.
pub(crate) fn convert_to(format: &str, target: &str) -> String {
    let ending = |format: &str| {
        let known = ENDINGS.iter().find(|(name, _)| *name == format);
        known.map_or(format.to_ascii_lowercase(), |(_, ending)| (*ending).to_owned())
    };
    let (from, to) = (ending(format), ending(target));
    let (tool, command) = match format {
        "SVG" => ("librsvg", format!("rsvg-convert --width 800 drawing.svg --output drawing.{to}")),
        "HTML" => (
            "Chromium",
            format!("chromium --headless --window-size=800,480 --screenshot=page.{to} page.html"),
        ),
        _ if WITH_SEVERAL.contains(&format) => {
            ("ImageMagick", format!("magick 'picture.{from}[0]' picture.{to}"))
        }
        _ => ("ImageMagick", format!("magick picture.{from} picture.{to}")),
    };
    let phone = if format == "HEIC" { "; telephones save JPEG by the setting `most compatible`" } else { "" };
    format!("convert it to {target}, for example by {tool}: {command}{phone}")
}
