//! Escaping of the user's texts for a terminal.

use std::borrow::Cow;
use std::fmt::Write;

/// Returns whether a character controls a terminal or the direction of the text after it: a control character
/// other than a newline or tab, or one of Unicode's embeddings, overrides and isolates.
fn is_control(c: char) -> bool {
    (c.is_control() && c != '\n' && c != '\t') || is_override(c)
}

/// Returns whether a character changes the direction of the text after it (Unicode, UAX #9), so that the
/// displayed order differs from the stored one.
pub fn is_override(c: char) -> bool {
    matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// Returns whether these bytes are printable ASCII, newlines and tabs, as in almost all long texts. Without
/// an early exit, this is tested for many bytes at once.
fn is_plain(bytes: &[u8]) -> bool {
    bytes.iter().fold(true, |all, byte| all & (matches!(byte, b' '..=b'~') | matches!(byte, b'\n' | b'\t')))
}

/// Number of bytes that are tested together.
const AT_ONCE: usize = 256;

/// Returns a text that is safe to print on a terminal: each control character is replaced by its escape as in
/// JSON, such as `\u001b`.
pub fn visible(text: &str) -> Cow<'_, str> {
    if text.as_bytes().chunks(AT_ONCE).all(is_plain) || !text.chars().any(is_control) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        if is_control(c) {
            let _ = write!(shown, "\\u{:04x}", u32::from(c));
        } else {
            shown.push(c);
        }
    }
    Cow::Owned(shown)
}

/// Returns the [`visible`] text on one line: newlines are escaped too.
pub fn in_one_line(text: &str) -> Cow<'_, str> {
    match visible(text) {
        shown if shown.contains('\n') => Cow::Owned(shown.replace('\n', "\\n")),
        shown => shown,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_are_shown_as_escapes() {
        let text = "\u{1b}]0;x\u{7}\u{9b}2J\u{202e}\u{2066}\r";
        assert_eq!(visible(text), "\\u001b]0;x\\u0007\\u009b2J\\u202e\\u2066\\u000d");
        assert_eq!(visible("a\n\tµ = \u{2265} 5"), "a\n\tµ = \u{2265} 5");
        assert_eq!(in_one_line("a\nerror: b"), "a\\nerror: b");
    }
}
