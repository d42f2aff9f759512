//! Texts of the user's, as a terminal may have them.

use std::borrow::Cow;
use std::fmt::Write;

/// True of a character that a terminal obeys or that turns the order of what follows: a control character other than the end
/// of a line and a tab, or one of Unicode's embeddings, overrides and isolates.
fn is_obeyed(c: char) -> bool {
    (c.is_control() && c != '\n' && c != '\t') || is_override(c)
}

/// True of the characters that turn the direction of the text after them (Unicode, UAX #9): what is read is then not what stands there.
pub fn is_override(c: char) -> bool {
    matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// A text as a terminal may have it: in the place of a character that is obeyed stands `\u001b`, as JSON writes it.
pub fn visible(text: &str) -> Cow<'_, str> {
    if !text.chars().any(is_obeyed) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        if is_obeyed(c) {
            let _ = write!(shown, "\\u{:04x}", u32::from(c));
        } else {
            shown.push(c);
        }
    }
    Cow::Owned(shown)
}

/// [`visible`] text in one line.
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
