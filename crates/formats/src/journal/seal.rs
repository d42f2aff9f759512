//! Checksums of the lines of a journal. They detect lines that a disk, a copy or an edit has damaged, so that
//! these are not used as results.
//!
//! A line is a JSON object whose last member is `"crc"`: the CRC-32 (ISO-HDLC, as in zip and PNG), in eight
//! hexadecimal digits, of the line without that member. Lines of earlier versions have no checksum. A journal
//! whose first line has none may contain lines of both kinds.

const MARK: &[u8] = b",\"crc\":\"";
const DIGITS: usize = 8;
const END: &[u8] = b"\"}";

/// Result of the verification of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Checksum {
    /// The line has no checksum.
    Absent,
    /// The checksum matches the line.
    Correct,
    /// The checksum does not match the line.
    Wrong,
}

/// Returns the text of a JSON object with its checksum; any other text is returned unchanged.
pub(super) fn with_checksum(mut text: Vec<u8>) -> Vec<u8> {
    if text.len() > 2 && text.starts_with(b"{") && text.ends_with(b"}") {
        let sum = format!("{:08x}", crc_32(&text));
        text.pop();
        for part in [MARK, sum.as_bytes(), END] {
            text.extend_from_slice(part);
        }
    }
    text
}

/// Verifies the checksum of a line, with or without its newline.
pub(super) fn verify(line: &[u8]) -> Checksum {
    let line = line.trim_ascii_end();
    let at = line.len().saturating_sub(MARK.len() + DIGITS + END.len());
    let (content, rest) = line.split_at(at);
    let Some(sum) = rest.strip_prefix(MARK).and_then(|rest| rest.strip_suffix(END)) else {
        return Checksum::Absent;
    };
    let object = [content, b"}"].concat();
    if format!("{:08x}", crc_32(&object)).as_bytes() == sum { Checksum::Correct } else { Checksum::Wrong }
}

// Not a constant, of which a program that is not optimised makes a copy for each byte.
static TABLE: [u32; 256] = {
    let mut table = [0; 256];
    let mut byte = 0;
    while byte < 256 {
        let (mut rest, mut bit) = (byte as u32, 0);
        while bit < 8 {
            rest = if rest & 1 == 1 { 0xEDB8_8320 ^ (rest >> 1) } else { rest >> 1 };
            bit += 1;
        }
        table[byte] = rest;
        byte += 1;
    }
    table
};

fn crc_32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0, |rest: u32, byte| TABLE[usize::from(rest as u8 ^ byte)] ^ (rest >> 8))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Check value of the CRC catalogue.
    #[test]
    fn crc_32_of_the_check_string_is_the_check_value() {
        assert_eq!(crc_32(b"123456789"), 0xCBF4_3926);
    }

    #[test]
    fn line_with_any_changed_bit_is_not_correct() {
        let line = with_checksum(br#"{"row":3,"values":[1.5,null]}"#.to_vec());
        assert_eq!(verify(&line), Checksum::Correct);
        assert_eq!(verify(&[&line[..], b"\n"].concat()), Checksum::Correct);
        for at in 0..line.len() - MARK.len() - DIGITS - END.len() {
            for bit in 0..8 {
                let mut other = line.clone();
                other[at] ^= 1 << bit;
                assert_eq!(verify(&other), Checksum::Wrong, "{at} {bit}");
            }
        }
        // A change of the checksum itself makes it wrong or unrecognisable.
        for at in line.len() - MARK.len() - DIGITS - END.len()..line.len() {
            let mut other = line.clone();
            other[at] ^= 1;
            assert_ne!(verify(&other), Checksum::Correct, "{at}");
        }
        assert_eq!(verify(br#"{"row":3,"values":[1.5,null]}"#), Checksum::Absent);
        assert_eq!(with_checksum(b"\"head\"".to_vec()), b"\"head\"");
    }
}
