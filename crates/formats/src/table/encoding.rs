//! Encodings of text files: UTF-8, UTF-16, and Latin-1 as Windows writes it.

use std::borrow::Cow;

/// Characters of Windows-1252 from 0x80 to 0x9F; all other bytes are those of Latin-1. Undefined ones are
/// kept as control characters.
const WINDOWS: [char; 32] = [
    '\u{20AC}', '\u{81}', '\u{201A}', '\u{192}', '\u{201E}', '\u{2026}', '\u{2020}', '\u{2021}', '\u{2C6}',
    '\u{2030}', '\u{160}', '\u{2039}', '\u{152}', '\u{8D}', '\u{17D}', '\u{8F}', '\u{90}', '\u{2018}',
    '\u{2019}', '\u{201C}', '\u{201D}', '\u{2022}', '\u{2013}', '\u{2014}', '\u{2DC}', '\u{2122}', '\u{161}',
    '\u{203A}', '\u{153}', '\u{9D}', '\u{17E}', '\u{178}',
];

/// Returns the text of a file without its byte order mark, with lines that end with `\n` (or `\r\n`); `None`
/// if it is no text.
///
/// The encoding is that of the byte order mark. Without one, it is UTF-16 if every other byte is 0, UTF-8 if
/// the bytes are valid UTF-8, or else Windows-1252, which contains Latin-1.
pub(crate) fn decode(bytes: &[u8]) -> Option<Cow<'_, str>> {
    let text = match bytes {
        [0xEF, 0xBB, 0xBF, rest @ ..] => Cow::Borrowed(std::str::from_utf8(rest).ok()?),
        [0xFF, 0xFE, rest @ ..] => utf_16(rest, u16::from_le_bytes)?.into(),
        [0xFE, 0xFF, rest @ ..] => utf_16(rest, u16::from_be_bytes)?.into(),
        _ if is_zero(bytes, 1) => utf_16(bytes, u16::from_le_bytes)?.into(),
        _ if is_zero(bytes, 0) => utf_16(bytes, u16::from_be_bytes)?.into(),
        _ => match std::str::from_utf8(bytes) {
            Ok(text) => text.into(),
            Err(_) if bytes.iter().any(|byte| is_binary(*byte)) => return None,
            Err(_) => bytes.iter().map(|byte| windows_1252(*byte)).collect::<String>().into(),
        },
    };
    // Old programs of the Macintosh end lines with a carriage return.
    if text.contains('\r') && !text.contains('\n') {
        return Some(text.replace('\r', "\n").into());
    }
    Some(text)
}

/// Returns whether a content is a text in UTF-16.
pub(crate) fn is_utf_16(bytes: &[u8]) -> bool {
    let has_mark = bytes.starts_with(&[0xFF, 0xFE]) || bytes.starts_with(&[0xFE, 0xFF]);
    has_mark || is_zero(bytes, 0) || is_zero(bytes, 1)
}

/// Returns whether every other byte at the beginning is 0, from byte `first`, and the bytes between are not.
fn is_zero(bytes: &[u8], first: usize) -> bool {
    let (pairs, rest) = bytes.as_chunks::<2>();
    rest.is_empty()
        && pairs.len() > 1
        && pairs.iter().take(100).all(|pair| pair[first] == 0 && pair[1 - first] != 0)
}

fn utf_16(bytes: &[u8], unit: fn([u8; 2]) -> u16) -> Option<String> {
    let (pairs, rest) = bytes.as_chunks::<2>();
    if !rest.is_empty() {
        return None;
    }
    char::decode_utf16(pairs.iter().map(|pair| unit(*pair))).collect::<Result<_, _>>().ok()
}

/// Returns whether a byte does not occur in texts of one byte per character.
fn is_binary(byte: u8) -> bool {
    byte < 0x20 && !matches!(byte, b'\t' | b'\n' | b'\r' | 0x0B | 0x0C | 0x1A)
}

fn windows_1252(byte: u8) -> char {
    match byte {
        0x80..=0x9F => WINDOWS[usize::from(byte - 0x80)],
        byte => char::from(byte),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_in_any_encoding_is_decoded() {
        let text = "\u{3bb} (\u{b5}m);n\n0,5;1\n";
        let le: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
        let be: Vec<u8> = text.encode_utf16().flat_map(u16::to_be_bytes).collect();
        for bytes in [
            text.as_bytes().to_vec(),
            [b"\xEF\xBB\xBF", text.as_bytes()].concat(),
            [b"\xFF\xFE", &le[..]].concat(),
            [b"\xFE\xFF", &be[..]].concat(),
        ] {
            assert_eq!(decode(&bytes).unwrap(), text);
        }
        let plain: Vec<u8> = "nm,n\n4,1\n".encode_utf16().flat_map(u16::to_le_bytes).collect();
        assert_eq!(decode(&plain).unwrap(), "nm,n\n4,1\n");
        assert_eq!(decode(b"\xB5m \x96 \xE4\n").unwrap(), "\u{b5}m \u{2013} \u{e4}\n");
        assert_eq!(decode(b"a,b\r1,2\r").unwrap(), "a,b\n1,2\n");
        for binary in [&b"\xFF\xD8\x00\x01"[..], b"\xFF\xFEa", b"\xFE\xFF\xD8\x00"] {
            assert_eq!(decode(binary), None);
        }
    }
}
