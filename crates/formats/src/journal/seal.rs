//! The checksum of a journal's line: what became of a disk, a copy or a careless edit is found, and not taken for results.
//!
//! A line is a JSON object whose last member is `"crc"`: the CRC-32 (ISO-HDLC, as of zip and PNG), in eight hexadecimal digits, of
//! the line without that member. Lines of earlier versions have none; a journal that begins with such a line may
//! go on with either.

const MARK: &[u8] = b",\"crc\":\"";
const DIGITS: usize = 8;
const END: &[u8] = b"\"}";

/// What a line's checksum says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Seal {
    /// It has none.
    None,
    /// It is that of the line.
    Good,
    /// It is that of another line.
    Broken,
}

/// An object's text with its checksum; any other text as it is.
pub(super) fn sealed(mut text: Vec<u8>) -> Vec<u8> {
    if text.len() > 2 && text.starts_with(b"{") && text.ends_with(b"}") {
        let sum = format!("{:08x}", crc_32(&text));
        text.pop();
        for part in [MARK, sum.as_bytes(), END] {
            text.extend_from_slice(part);
        }
    }
    text
}

/// What the checksum of a line says, which may have its end.
pub(super) fn seal(line: &[u8]) -> Seal {
    let line = line.trim_ascii_end();
    let at = line.len().saturating_sub(MARK.len() + DIGITS + END.len());
    let (own, rest) = line.split_at(at);
    let Some(sum) = rest.strip_prefix(MARK).and_then(|rest| rest.strip_suffix(END)) else {
        return Seal::None;
    };
    let whole = [own, b"}"].concat();
    if format!("{:08x}", crc_32(&whole)).as_bytes() == sum { Seal::Good } else { Seal::Broken }
}

const TABLE: [u32; 256] = {
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

    /// The check value of the catalogue of CRCs.
    #[test]
    fn the_checksum_is_crc_32() {
        assert_eq!(crc_32(b"123456789"), 0xCBF4_3926);
    }

    #[test]
    fn any_change_of_a_line_is_found() {
        let line = sealed(br#"{"row":3,"values":[1.5,null]}"#.to_vec());
        assert_eq!(seal(&line), Seal::Good);
        assert_eq!(seal(&[&line[..], b"\n"].concat()), Seal::Good);
        for at in 0..line.len() - MARK.len() - DIGITS - END.len() {
            for bit in 0..8 {
                let mut other = line.clone();
                other[at] ^= 1 << bit;
                assert_eq!(seal(&other), Seal::Broken, "{at} {bit}");
            }
        }
        // In the checksum itself a change makes it another's, or none at all.
        for at in line.len() - MARK.len() - DIGITS - END.len()..line.len() {
            let mut other = line.clone();
            other[at] ^= 1;
            assert_ne!(seal(&other), Seal::Good, "{at}");
        }
        assert_eq!(seal(br#"{"row":3,"values":[1.5,null]}"#), Seal::None);
        assert_eq!(sealed(b"\"head\"".to_vec()), b"\"head\"");
    }
}
