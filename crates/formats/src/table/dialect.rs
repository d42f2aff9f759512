//! The separator of the cells of a table and the decimal mark of its numbers, found once for the whole file.

use super::rows::{cells, is_comment_line};

/// Number of lines that determine the separator.
const LINES: usize = 400;

/// Separator and decimal mark.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Dialect {
    /// Separator of the cells; `None` means blanks.
    pub(crate) separator: Option<char>,
    /// Whether numbers are written as `0,5`.
    pub(crate) decimal_comma: bool,
}

/// Separators in the order in which they are preferred if they split the lines equally well.
const SEPARATORS: [Option<char>; 4] = [Some(';'), Some('\t'), Some(','), None];

impl Dialect {
    /// Finds the dialect of a text: the separator that splits most lines into the same number of cells, of
    /// which none contains another separator. A comma inside numbers is a decimal comma if commas do not
    /// separate the cells and no number has a point.
    pub(crate) fn of(text: &str) -> Self {
        if let Some(separator) = stated(text) {
            return Self {
                separator: Some(separator),
                decimal_comma: has_decimal_commas(text, Some(separator)),
            };
        }
        let score = |separator| score(text, separator);
        let best = SEPARATORS.map(|separator| (score(separator), separator));
        // The first of several that are equally good.
        let best = best.into_iter().rev().max_by_key(|(score, _)| *score).unwrap_or((0, Some(',')));
        let separator = if best.0 == 0 { Some(',') } else { best.1 };
        Self { separator, decimal_comma: has_decimal_commas(text, separator) }
    }
}

/// Returns the lines with content that are no comments.
fn lines(text: &str) -> impl Iterator<Item = &str> {
    text.lines().filter(|line| !line.trim().is_empty() && !is_comment_line(line) && directive(line).is_none())
}

/// Returns the separator of a first line such as `sep=;`, which spreadsheets write and read.
pub(crate) fn directive(line: &str) -> Option<char> {
    let rest = line.trim_end_matches(['\r', '\n']).trim_matches('"').strip_prefix("sep=")?;
    let mut characters = rest.chars();
    characters.next().filter(|c| characters.next().is_none() && matches!(c, ';' | ',' | '\t' | '|'))
}

fn stated(text: &str) -> Option<char> {
    directive(text.lines().next()?)
}

/// Returns the number of lines that have the most frequent number of cells, at least 2, all of them without
/// another separator.
fn score(text: &str, separator: Option<char>) -> usize {
    let mut widths: Vec<usize> = lines(text)
        .take(LINES)
        .filter_map(|line| {
            let cells = cells(0, line, separator);
            let sound = cells.iter().all(|cell| cell.is_quoted || is_sound(&cell.text, separator));
            (sound && cells.len() > 1).then_some(cells.len())
        })
        .collect();
    widths.sort_unstable();
    widths.chunk_by(|a, b| a == b).map(<[usize]>::len).max().unwrap_or(0)
}

/// Returns whether a cell without quotes contains no other separator. The name of a state may: only what
/// begins as a number is no text.
fn is_sound(cell: &str, separator: Option<char>) -> bool {
    let is_number = |text: &str| number(text, false).is_some() || number(text, true).is_some();
    if number(cell, false).is_some() || (separator != Some(',') && number(cell, true).is_some()) {
        return true;
    }
    let begins_as_number = cell.starts_with(|c: char| c.is_ascii_digit() || matches!(c, '+' | '-' | '.'));
    let has_other = cell.contains([';', '\t', ',']) && (separator.is_none() || begins_as_number);
    let mut words = cell.split_whitespace();
    !(has_other || (words.clone().count() > 1 && words.all(is_number)))
}

/// Returns whether numbers have decimal commas. Numbers with a comma and others with a point contradict each
/// other: then they have not.
fn has_decimal_commas(text: &str, separator: Option<char>) -> bool {
    if !text.contains(',') {
        return false;
    }
    let (mut commas, mut points) = (false, false);
    for line in lines(text) {
        for cell in cells(0, line, separator) {
            // Without quotes, a comma that separates is in no cell.
            commas |= cell.text.contains(',') && number(&cell.text, true).is_some();
            points |= cell.text.contains('.') && number(&cell.text, false).is_some();
        }
        if points {
            return false;
        }
    }
    commas
}

/// Reads a number, which may be infinite or NaN. Fortran's `1D3` and a minus sign that is not ASCII's are
/// numbers too.
pub(crate) fn number(text: &str, decimal_comma: bool) -> Option<f64> {
    if !decimal_comma && let Ok(value) = text.parse() {
        return Some(value);
    }
    let is_part = |c: char| {
        c.is_ascii_digit() || matches!(c, '+' | '-' | '\u{2212}' | '.' | ',' | 'e' | 'E' | 'd' | 'D')
    };
    let has_point = decimal_comma && text.contains('.');
    if has_point || !text.contains(|c: char| c.is_ascii_digit()) || !text.chars().all(is_part) {
        return text.parse().ok().filter(|value: &f64| !value.is_finite());
    }
    let plain = text.replace('\u{2212}', "-").replace(['d', 'D'], "e");
    if decimal_comma { plain.replace(',', ".").parse().ok() } else { plain.parse().ok() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn separator_and_decimal_mark_are_found() {
        for (text, separator, decimal_comma) in [
            ("nm,R\n400,0.1\n", Some(','), false),
            ("nm,R\n400, 0.1\n410, 0.2\n", Some(','), false),
            ("nm;R\n400;0,1\n", Some(';'), true),
            ("nm;R\n400;0.1\n", Some(';'), false),
            ("400;0,1\n410;0.1\n", Some(';'), false),
            ("nm\tR\n400\t0,1\n", Some('\t'), true),
            ("nm R\n400 0,1\n410 0,2\n", None, true),
            ("nm R\n400\t0.1\n410\t0.2\n", None, false),
            ("Wavelength (nm)\tR\n400\t0.1\n410\t0.2\n", Some('\t'), false),
            ("400,5 0,1\n410,5 0,2\n", None, true),
            ("\"nm\",\"R\"\n\"400\",\"0,1\"\n", Some(','), true),
            ("sep=;\nnm;R\n400;0,1\n", Some(';'), true),
            ("state,note,X\nwhite,dim grey,0.1\n", Some(','), false),
            ("# a, b, c\n400 0.1\n", None, false),
            ("380\n390\n", Some(','), false),
            ("", Some(','), false),
        ] {
            assert_eq!(Dialect::of(text), Dialect { separator, decimal_comma }, "{text:?}");
        }
    }

    #[test]
    fn numbers_of_other_programs_are_read() {
        assert_eq!(number("1.5D+02", false), Some(150.0));
        assert_eq!(number("\u{2212}0,5", true), Some(-0.5));
        assert_eq!(number("1.000,5", true), None);
        assert_eq!(number("0,5", false), None);
        assert_eq!(number("d", false), None);
        assert!(number("nan", true).unwrap().is_nan());
    }
}
