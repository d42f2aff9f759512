//! Standard output and standard error: everything that the program prints goes through here.
//!
//! Names of files, keys and cells of tables are quoted in what is printed, and may hold anything: characters that a terminal obeys are
//! shown and not sent. In JSON what stands for them means the same character.

use std::io::{self, Write};

use papilio_formats::words::visible;

/// Standard output.
pub(crate) fn stdout() -> impl Write {
    Plain { to: anstream::stdout().lock(), cut: Vec::new() }
}

/// Prints on standard error, where nobody may listen.
pub(crate) fn say(text: &dyn std::fmt::Display) {
    let _ = writeln!(anstream::stderr(), "{}", visible(&text.to_string()));
}

/// Text in which no character is obeyed.
struct Plain<W> {
    to: W,
    /// The bytes of a character that was cut off at the end of the last piece.
    cut: Vec<u8>,
}

impl<W: Write> Plain<W> {
    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        for chunk in bytes.utf8_chunks() {
            self.to.write_all(visible(chunk.valid()).as_bytes())?;
            if !chunk.invalid().is_empty() {
                self.to.write_all("\u{fffd}".as_bytes())?;
            }
        }
        Ok(())
    }
}

impl<W: Write> Write for Plain<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut all = std::mem::take(&mut self.cut);
        all.extend_from_slice(bytes);
        // A character may be cut at the end of a piece: by three bytes at most.
        let whole = match std::str::from_utf8(&all) {
            Err(error) if error.error_len().is_none() => error.valid_up_to(),
            _ => all.len(),
        };
        self.cut = all.split_off(whole);
        self.send(&all)?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.to.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// However a text is cut into pieces.
    #[test]
    fn no_piece_of_text_is_obeyed() {
        let text = "a\u{1b}[2J\tb\u{9b}c\u{202e}µ\n\r";
        let wanted = "a\\u001b[2J\tb\\u009bc\\u202eµ\n\\u000d";
        for size in 1..text.len() {
            let mut plain = Plain { to: Vec::new(), cut: Vec::new() };
            text.as_bytes().chunks(size).for_each(|piece| plain.write_all(piece).unwrap());
            assert_eq!(String::from_utf8(plain.to).unwrap(), wanted, "{size}");
        }
    }
}
