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
    // Two letters are no signature: the reserved bytes of the header are zero.
    if bytes.starts_with(b"BM") && bytes.get(6..10) == Some(&[0; 4]) {
        return Some("BMP");
    }
    BY_FIRST_BYTES.iter().find(|(_, first)| bytes.starts_with(first)).map(|(name, _)| *name)
}

/// What to do with a picture of a format that is not read: the hint of an error.
pub(crate) fn convert_to(format: &str, target: &str) -> String {
    let phone = if format == "HEIC" { "; telephones save JPEG by the setting `most compatible`" } else { "" };
    format!("convert it to {target} in the program that created it or an image editor{phone}")
}
