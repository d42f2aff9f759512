//! Standard output and standard error. Everything that the program prints passes through this module.
//!
//! Printed text quotes names of files, keys and cells of tables, which may contain control characters. These are escaped, so
//! that a terminal does not execute them. In JSON the escape sequence means the same character.

use std::io::{self, Write};
use std::sync::atomic::{AtomicBool, Ordering};

use papilio_formats::words::visible;

/// Set by `--quiet`.
static QUIET: AtomicBool = AtomicBool::new(false);

/// Beginnings of the messages that `--quiet` does not suppress.
const IMPORTANT: [&str; 3] = ["error", "warning", "interrupted"];

/// Suppresses reports, notes and progress from now on (`--quiet`).
pub(crate) fn be_quiet() {
    QUIET.store(true, Ordering::Relaxed);
}

/// Returns whether reports, notes and progress are suppressed.
pub(crate) fn is_quiet() -> bool {
    QUIET.load(Ordering::Relaxed)
}

/// Standard output for data that the user requested, with control characters escaped.
pub(crate) fn stdout() -> impl Write {
    output(true)
}

/// Standard output of a command that prints JSON (`json`), or a report, which `--quiet` suppresses.
pub(crate) fn output(json: bool) -> impl Write {
    let to: Box<dyn Write> =
        if json || !is_quiet() { Box::new(anstream::stdout().lock()) } else { Box::new(io::sink()) };
    EscapingWriter { to, incomplete: Vec::new() }
}

/// Prints a message on standard error; with `--quiet` only errors and warnings. Errors of the stream are ignored: standard error may be
/// closed.
pub(crate) fn print_message(text: &dyn std::fmt::Display) {
    let text = text.to_string();
    if !is_quiet() || IMPORTANT.iter().any(|word| text.starts_with(word)) {
        let _ = writeln!(anstream::stderr(), "{}", visible(&text));
    }
}

/// Prints notes on standard error.
pub(crate) fn print_notes(notes: &[String]) {
    notes.iter().for_each(|note| print_message(&format!("note: {note}")));
}

/// A writer that escapes control characters.
struct EscapingWriter<W> {
    to: W,
    /// First bytes of a character that was split at the end of the previous piece.
    incomplete: Vec<u8>,
}

impl<W: Write> EscapingWriter<W> {
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

impl<W: Write> Write for EscapingWriter<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut all = std::mem::take(&mut self.incomplete);
        all.extend_from_slice(bytes);
        // A piece may end within a character: at most three bytes remain.
        let complete = match std::str::from_utf8(&all) {
            Err(error) if error.error_len().is_none() => error.valid_up_to(),
            _ => all.len(),
        };
        self.incomplete = all.split_off(complete);
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

    #[test]
    fn control_characters_are_escaped_for_any_split() {
        let text = "a\u{1b}[2J\tb\u{9b}c\u{202e}µ\n\r";
        let expected = "a\\u001b[2J\tb\\u009bc\\u202eµ\n\\u000d";
        for size in 1..text.len() {
            let mut writer = EscapingWriter { to: Vec::new(), incomplete: Vec::new() };
            text.as_bytes().chunks(size).for_each(|piece| writer.write_all(piece).unwrap());
            assert_eq!(String::from_utf8(writer.to).unwrap(), expected, "{size}");
        }
    }
}
