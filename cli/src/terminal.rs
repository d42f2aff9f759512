//! Standard output and standard error. Everything that the program prints passes through this module.
//!
//! Printed text quotes names of files, keys and cells of tables, which may contain control characters. These
//! are escaped, so that a terminal does not execute them. In JSON the escape sequence means the same
//! character.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, Write};
use std::sync::atomic::{AtomicBool, Ordering};

use papilio_diagnostics::short_numbers;
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

/// Standard output of a command that prints JSON (`json`), or a report, which `--quiet` suppresses. It is
/// written in large pieces: the caller calls `flush` after the last one, to learn whether all could be
/// written.
pub(crate) fn output(json: bool) -> impl Write {
    let to: Box<dyn Write> =
        if json || !is_quiet() { Box::new(io::stdout().lock()) } else { Box::new(io::sink()) };
    EscapingWriter { to, waiting: Vec::new() }
}

/// Prints a message on standard error; with `--quiet` only errors and warnings. Errors of the stream are
/// ignored: standard error may be closed.
pub(crate) fn print_message(text: &dyn std::fmt::Display) {
    let text = short_numbers(&text.to_string()).into_owned();
    if !is_quiet() || IMPORTANT.iter().any(|word| text.starts_with(word)) {
        let _ = writeln!(anstream::stderr(), "{}", visible(&text));
    }
}

/// Prints notes on standard error.
pub(crate) fn print_notes(notes: &[String]) {
    notes.iter().for_each(|note| print_message(&format!("note: {note}")));
}

/// Prints warnings of a number of results, each once with how many of them it concerns.
pub(crate) fn print_counted<'a>(warnings: impl Iterator<Item = &'a str>, all: usize, what: &str) {
    // Those that differ in numbers and names alone are one.
    let mut counts: BTreeMap<String, (usize, BTreeSet<&str>)> = BTreeMap::new();
    for warning in warnings {
        let words = warning.split('`').step_by(2).collect::<String>();
        let words = words.split(|c: char| c.is_ascii_digit() || c == '.').collect::<String>();
        let (count, texts) = counts.entry(words).or_default();
        *count += 1;
        texts.insert(warning);
    }
    for (count, texts) in counts.into_values() {
        let (first, others) = (texts.first().copied().unwrap_or_default(), texts.len() - 1);
        let such_as = if others > 0 { ", such as" } else { "" };
        print_message(&format!("warning: at {count} of {all} {what}{such_as}: {first}"));
    }
}

/// Prints warnings on standard error.
pub(crate) fn print_warnings(warnings: &[String]) {
    warnings.iter().for_each(|warning| print_message(&format!("warning: {warning}")));
}

/// Those that are not among others, which were printed before.
pub(crate) fn not_in(all: &[String], others: &[String]) -> Vec<String> {
    all.iter().filter(|one| !others.contains(one)).cloned().collect()
}

/// A writer that escapes control characters, in pieces of at least [`PIECE`] bytes.
struct EscapingWriter<W: Write> {
    to: W,
    /// Text that is not written yet.
    waiting: Vec<u8>,
}

/// Least number of bytes that are written together.
const PIECE: usize = 1 << 16;

impl<W: Write> EscapingWriter<W> {
    /// Writes what is waiting. A character at its end that is not complete continues to wait, unless this is
    /// the last piece.
    fn send(&mut self, is_last: bool) -> io::Result<()> {
        let mut text = std::mem::take(&mut self.waiting);
        let complete = match std::str::from_utf8(&text) {
            Err(error) if error.error_len().is_none() && !is_last => error.valid_up_to(),
            _ => text.len(),
        };
        self.waiting.extend_from_slice(&text[complete..]);
        text.truncate(complete);
        match std::str::from_utf8(&text) {
            Ok(text) => self.to.write_all(visible(text).as_bytes())?,
            // Finds the invalid bytes, but takes ten times as long.
            Err(_) => {
                for chunk in text.utf8_chunks() {
                    self.to.write_all(visible(chunk.valid()).as_bytes())?;
                    if !chunk.invalid().is_empty() {
                        self.to.write_all("\u{fffd}".as_bytes())?;
                    }
                }
            }
        }
        // Its memory serves the next piece.
        text.clear();
        text.append(&mut self.waiting);
        self.waiting = text;
        Ok(())
    }
}

impl<W: Write> Write for EscapingWriter<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.waiting.extend_from_slice(bytes);
        if self.waiting.len() >= PIECE {
            self.send(false)?;
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.send(false)?;
        self.to.flush()
    }
}

impl<W: Write> Drop for EscapingWriter<W> {
    /// Writes the rest after an error of the command; a second error is ignored.
    fn drop(&mut self) {
        let _ = self.send(true);
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
            for is_flushed in [false, true] {
                let mut to = Vec::new();
                let mut writer = EscapingWriter { to: &mut to, waiting: Vec::new() };
                for piece in text.as_bytes().chunks(size) {
                    writer.write_all(piece).unwrap();
                    if is_flushed {
                        writer.flush().unwrap();
                    }
                }
                drop(writer);
                assert_eq!(String::from_utf8(to).unwrap(), expected, "{size}");
            }
        }
    }

    #[test]
    fn text_of_several_pieces_is_complete() {
        let text = "µ = 1\u{7}; ".repeat(PIECE / 4);
        let mut to = Vec::new();
        let mut writer = EscapingWriter { to: &mut to, waiting: Vec::new() };
        text.as_bytes().chunks(1001).for_each(|piece| writer.write_all(piece).unwrap());
        drop(writer);
        assert_eq!(String::from_utf8(to).unwrap(), visible(&text));
    }

    #[test]
    fn bytes_that_are_not_text_are_replaced() {
        let mut to = Vec::new();
        EscapingWriter { to: &mut to, waiting: Vec::new() }.write_all(b"a\xffb\xc2").unwrap();
        assert_eq!(String::from_utf8(to).unwrap(), "a\u{fffd}b\u{fffd}");
    }
}
