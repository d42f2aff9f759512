//! Sizes of pictures: with them, a browser leaves the right space before it has the picture.

/// Width and height of a PNG or SVG file, in pixels; `None` if the file does not state them.
pub(crate) fn size(bytes: &[u8]) -> Option<(u32, u32)> {
    if bytes.starts_with(b"\x89PNG") {
        let number = |at: usize| Some(u32::from_be_bytes(bytes.get(at..at + 4)?.try_into().ok()?));
        return Some((number(16)?, number(20)?));
    }
    let text = std::str::from_utf8(bytes).ok()?;
    let start = text.find("<svg")?;
    let tag = &text[start..start + text[start..].find('>')?];
    Some((attribute(tag, "width")?, attribute(tag, "height")?))
}

fn attribute(tag: &str, name: &str) -> Option<u32> {
    let (_, value) = tag.split_once(&format!(" {name}=\""))?;
    let number: f64 = value.split('"').next()?.trim_end_matches("px").parse().ok()?;
    (1.0..1e5).contains(&number).then_some(number.round() as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn size_of_a_picture_is_read_from_its_header() {
        let mut png = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR".to_vec();
        png.extend([0, 0, 1, 0, 0, 0, 0, 9]);
        assert_eq!(size(&png), Some((256, 9)));
        assert_eq!(size(b"<?xml?><svg xmlns=\"x\" width=\"760\" height=\"468.4\">"), Some((760, 468)));
        for unknown in [&b"\x89PNG"[..], b"<svg width=\"100%\" height=\"1\">", b"\xff\xd8", b""] {
            assert_eq!(size(unknown), None);
        }
    }
}
