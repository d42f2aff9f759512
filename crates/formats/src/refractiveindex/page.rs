//! Layout of a page: the entries under `DATA:`, as uninterpreted text.
//!
//! Reads the subset of YAML that the pages use: a list of mappings with the same indentation, whose values
//! are plain text, text in quotes, or blocks (`|`, `>`). The other sections of a page (`REFERENCES`,
//! `COMMENTS`, `SPECS`, ...) are skipped. Other features of YAML (flow collections, anchors, tags) are
//! refused.

use std::borrow::Cow;
use std::ops::Range;

use papilio_diagnostics::Diagnostic;

use crate::error::{FormatError, Problem};
use crate::table::Table;

/// One element of the list under `DATA`.
pub(super) struct Entry<'a> {
    keys: Vec<(&'a str, Value<'a>)>,
    /// Start in the file, bytes.
    at: usize,
}

/// Value of a key.
pub(super) struct Value<'a> {
    pub(super) text: Cow<'a, str>,
    /// Place in the file, bytes.
    pub(super) place: Range<usize>,
}

/// Stands for a line break that was written as `\n`, until the other line breaks are folded; no page has this
/// character.
const BREAK: char = '\u{e000}';

/// A line without its newline, and its start in the file, bytes.
#[derive(Clone, Copy)]
struct Line<'a> {
    start: usize,
    text: &'a str,
}

/// Reader of the section under `DATA:`.
struct Section<'a> {
    file: Table<'a>,
    lines: Vec<Line<'a>>,
    next: usize,
}

/// Reads the entries of a page.
pub(super) fn entries(file: Table<'_>) -> Result<Vec<Entry<'_>>, FormatError> {
    let lines = file.text.split_inclusive('\n').scan(0, |next, text| {
        let start = *next;
        *next += text.len();
        Some(Line { start, text: text.trim_end_matches(['\n', '\r']) })
    });
    let mut lines = lines.skip_while(|line| !is_head(line));
    let Some(head) = lines.next() else { return Err(file.error(yaml("there is no key `DATA`"))) };
    let (section, rest): (Vec<_>, Vec<_>) = {
        let rest: Vec<_> = lines.collect();
        let end = rest.iter().position(Line::ends_section).unwrap_or(rest.len());
        (rest[..end].to_vec(), rest[end..].to_vec())
    };
    if let Some(second) = rest.iter().find(|line| is_head(line)) {
        return Err(fault(file, second.start, "the key `DATA` occurs twice"));
    }
    match without_comment(&head.text["DATA:".len()..]) {
        "" => Section { file, lines: section, next: 0 }.entries(),
        "[]" => Ok(vec![]),
        _ => Err(fault(
            file,
            head.start + "DATA:".len() + 1,
            "expected a list of entries `- type: ...` on the lines below `DATA:`",
        )),
    }
}

fn is_head(line: &Line<'_>) -> bool {
    line.text.strip_prefix("DATA:").is_some_and(|rest| rest.is_empty() || rest.starts_with([' ', '\t']))
}

impl<'a> Entry<'a> {
    /// Returns the value of a key.
    pub(super) fn get(&self, key: &str) -> Option<&Value<'a>> {
        self.keys.iter().find(|(known, _)| *known == key).map(|(_, value)| value)
    }

    /// Returns the value of `type`.
    pub(super) fn kind(&self, file: Table<'_>) -> Result<&Value<'a>, FormatError> {
        self.get("type").ok_or_else(|| fault(file, self.at, "this entry has no `type`"))
    }
}

impl Value<'_> {
    /// Returns the lines that are not blank, with their places in the file.
    pub(super) fn rows<'a>(&'a self, file: Table<'a>) -> impl Iterator<Item = (Range<usize>, &'a str)> {
        let rows = self.text.lines().map(str::trim).filter(|row| !row.is_empty());
        rows.scan(self.place.start, move |from, row| {
            // In folded text, a row may consist of several lines; it is then not found and gets the start of
            // the value as its place.
            let found = file.text.get(*from..).and_then(|rest| rest.find(row)).map(|at| *from + at);
            let start = found.filter(|start| *start < self.place.end).unwrap_or(self.place.start);
            *from = found.map_or(*from, |start| start + row.len());
            Some((start..start + row.len(), row))
        })
    }
}

impl Line<'_> {
    fn body(&self) -> &str {
        self.text.trim_start_matches(' ')
    }

    fn indent(&self) -> usize {
        self.text.len() - self.body().len()
    }

    fn is_blank(&self) -> bool {
        self.text.trim().is_empty()
    }

    fn is_skipped(&self) -> bool {
        self.is_blank() || self.body().starts_with('#')
    }

    fn begins_entry(&self) -> bool {
        self.body() == "-" || self.body().starts_with("- ")
    }

    fn ends_section(&self) -> bool {
        self.indent() == 0 && !self.is_skipped() && !self.begins_entry() && !self.text.starts_with('\t')
    }
}

impl<'a> Section<'a> {
    fn entries(mut self) -> Result<Vec<Entry<'a>>, FormatError> {
        let mut entries = Vec::new();
        let mut column = None;
        while let Some(line) = self.next_content() {
            let indent = line.indent();
            if !line.begins_entry() || *column.get_or_insert(indent) != indent {
                let message = if line.body().starts_with('\t') {
                    "this line is indented with tabs; indent with spaces"
                } else {
                    "expected an entry that begins with `- type:`, with the indentation of the first entry"
                };
                return Err(self.fault(line, message));
            }
            entries.push(self.entry(line, indent)?);
        }
        Ok(entries)
    }

    /// Reads the entry whose dash is in column `dash`.
    fn entry(&mut self, first: Line<'a>, dash: usize) -> Result<Entry<'a>, FormatError> {
        let mut entry = Entry { keys: Vec::new(), at: first.start + dash };
        // The first key may follow the dash on the same line.
        let behind = &first.text[dash + 1..];
        let mut column = None;
        if without_comment(behind).is_empty() {
            self.next += 1;
        } else {
            column = Some(dash + 1 + behind.len() - behind.trim_start_matches(' ').len());
        }
        while let Some(line) = self.next_content() {
            let is_first = line.start == first.start;
            if !is_first && line.indent() <= dash {
                break;
            }
            let indent = *column.get_or_insert(line.indent());
            if !is_first && line.indent() != indent {
                return Err(self.fault(line, "the keys of an entry must have the same indentation"));
            }
            let (key, behind) = self.key(line, indent)?;
            if entry.get(key).is_some() {
                return Err(self.fault(line, &format!("the key `{key}` occurs twice in this entry")));
            }
            self.next += 1;
            let value = self.value(line, behind, indent)?;
            entry.keys.push((key, value));
        }
        Ok(entry)
    }

    /// Reads the key that begins at a column of a line. Returns it and the column after its colon.
    fn key(&self, line: Line<'a>, column: usize) -> Result<(&'a str, usize), FormatError> {
        let text = &line.text[column..];
        let ends =
            |(at, _): &(usize, &str)| text[at + 1..].is_empty() || text[at + 1..].starts_with([' ', '\t']);
        match text.match_indices(':').find(ends) {
            Some((at, _)) if !text.starts_with(['\t', '[', '{', '?']) => {
                Ok((text[..at].trim_end().trim_matches(['"', '\'']), column + at + 1))
            }
            _ => Err(self.fault(line, "expected a key followed by a colon, indented with spaces")),
        }
    }

    /// Reads the value after a colon, and on the following lines that are indented further than its key.
    fn value(&mut self, line: Line<'a>, behind: usize, indent: usize) -> Result<Value<'a>, FormatError> {
        let text = line.text[behind..].trim_start();
        let at = line.start + line.text.len() - text.len();
        match text.chars().next() {
            Some(style @ ('|' | '>')) => {
                let head = without_comment(&text[1..]);
                if !head.chars().all(|c| matches!(c, '+' | '-' | '1'..='9')) {
                    return Err(fault(
                        self.file,
                        at,
                        "expected the rows on the lines after `|`, not on the same line",
                    ));
                }
                let start = self.lines.get(self.next).map_or(self.file.text.len(), |line| line.start);
                // Without an indentation indicator, the first row defines the indentation.
                let first = self.lines[self.next..].iter().find(|line| !line.is_blank());
                let given = head.chars().find_map(|c| c.to_digit(10)).map(|more| indent + more as usize);
                let least = given.or(first.map(Line::indent)).unwrap_or_default().max(indent + 1);
                let rows = self.below(|line| line.is_blank() || line.indent() >= least);
                let end = rows.last().map_or(start, |line| line.start + line.text.len());
                let block = &self.file.text[start.min(end)..end];
                let text = if style == '|' { Cow::Borrowed(block) } else { Cow::Owned(folded(block)) };
                Ok(Value { text, place: start..end })
            }
            Some(quote @ ('"' | '\'')) => self.quoted(at, quote),
            Some('[' | '{' | '&' | '*' | '!' | '%' | '@' | '`') => Err(fault(
                self.file,
                at,
                "expected text or numbers; brackets, anchors and tags of YAML are not supported",
            )),
            _ => {
                let first = without_comment(text);
                let is_list =
                    |line: &Line<'_>| first.is_empty() && line.indent() == indent && line.begins_entry();
                let more = self.below(|line| line.is_blank() || line.indent() > indent || is_list(line));
                let place = at..at + first.len();
                let more =
                    more.iter().filter(|line| !line.is_skipped()).map(|line| without_comment(line.body()));
                let whole = [first].into_iter().chain(more).collect::<Vec<_>>().join(" ");
                Ok(Value { text: Cow::Owned(whole), place })
            }
        }
    }

    /// Reads text in quotes, which may span several lines.
    fn quoted(&mut self, at: usize, quote: char) -> Result<Value<'a>, FormatError> {
        let rest = &self.file.text[at + 1..];
        let mut inside = String::new();
        let mut characters = rest.char_indices().peekable();
        while let Some((i, c)) = characters.next() {
            match c {
                '\'' if quote == '\'' && characters.next_if(|(_, next)| *next == '\'').is_some() => {
                    inside.push('\'')
                }
                '\\' if quote == '"' => match characters.next() {
                    Some((_, 'n')) => inside.push(BREAK),
                    Some((_, 't')) => inside.push('\t'),
                    Some((_, same @ ('"' | '\\' | '/' | ' '))) => inside.push(same),
                    // An escaped line break joins the lines without a space.
                    Some((_, '\r' | '\n')) => {
                        while characters.next_if(|(_, next)| matches!(next, ' ' | '\n')).is_some() {}
                    }
                    _ => {
                        return Err(fault(
                            self.file,
                            at + 1 + i,
                            "unknown escape sequence; expected `\\n`, `\\t`, `\\\"`, `\\\\`, `\\/` or `\\ `",
                        ));
                    }
                },
                _ if c == quote => {
                    let end = at + 1 + i;
                    while self.lines.get(self.next).is_some_and(|line| line.start <= end) {
                        self.next += 1;
                    }
                    // An escaped `\n` is a line break regardless of folding.
                    let text = folded(&inside).replace(BREAK, "\n");
                    return Ok(Value { text: Cow::Owned(text), place: at..end });
                }
                _ => inside.push(c),
            }
        }
        Err(fault(self.file, at, "this quotation mark is not closed"))
    }

    /// Takes lines while a condition holds.
    fn below(&mut self, holds: impl Fn(&Line<'a>) -> bool) -> Vec<Line<'a>> {
        let lines: Vec<_> = self.lines[self.next..].iter().copied().take_while(|line| holds(line)).collect();
        self.next += lines.len();
        lines
    }

    /// Returns the next line that is neither blank nor a comment.
    fn next_content(&mut self) -> Option<Line<'a>> {
        self.below(Line::is_skipped);
        self.lines.get(self.next).copied()
    }

    fn fault(&self, line: Line<'_>, message: &str) -> FormatError {
        fault(self.file, line.start + line.indent(), message)
    }
}

/// Folds text as YAML does: lines are joined by spaces, and each blank line is a line break.
fn folded(text: &str) -> String {
    let mut whole = String::new();
    let mut breaks = 0;
    for (i, line) in text.lines().map(str::trim).enumerate() {
        match line {
            "" if i > 0 => breaks += 1,
            _ => {
                whole.push_str(if i == 0 || breaks > 0 { "" } else { " " });
                whole.extend(std::iter::repeat_n('\n', breaks));
                whole.push_str(line);
                breaks = 0;
            }
        }
    }
    whole
}

/// Returns the text before ` #`, without blanks around it.
fn without_comment(text: &str) -> &str {
    let comment = |(at, _): &(usize, &str)| *at == 0 || text[..*at].ends_with([' ', '\t']);
    let end = text.match_indices('#').find(comment).map_or(text.len(), |(at, _)| at);
    text[..end].trim()
}

/// The error of a page that is not YAML, or not in the layout of refractiveindex.info.
pub(super) fn yaml(message: &str) -> Problem {
    Diagnostic::new(format!("this page of refractiveindex.info cannot be read: {message}")).into()
}

/// Returns an error at a byte of the page.
pub(super) fn fault(file: Table<'_>, at: usize, message: &str) -> FormatError {
    file.error_at_line(at, yaml(message))
}
